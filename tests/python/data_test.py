"""A store in the hands of others: Parquet by the package, and what docs/how-to/data.md shows for pandas, Polars and DuckDB, run as
it stands there."""

import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

try:
    import duckdb
    import polars
    import pyarrow.parquet
except ImportError as error:
    print(f"skipped: {error.name} is not installed (python/requirements-tests.txt)")
    sys.exit(77)

import moma

ROOT = pathlib.Path(os.environ["MOMA_SOURCE_DIR"])
SUITE = {
    "name": "demo",
    "robot": str(ROOT / "configs/robots/panda.yaml"),
    "controllers": {name: str(ROOT / f"configs/controllers/{name}.yaml") for name in ("rrmc", "neo")},
    "worlds": {"seed": 5, "families": {"open": {}, "clutter": {"objects": 2}}},
    "simulation": {"mode": "kinematic", "time_limit": 3},
    "trials": 4,
    "samples": "all",
}


class DataTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.scratch.name)
        cls.store = moma.evaluate(SUITE, store=cls.folder / "results/demo.db", progress=False)
        cls.parquet = cls.folder / "results/demo-parquet"
        command = [sys.executable, "-m", "moma", "export", "results/demo.db", "--parquet", "results/demo-parquet", "--samples"]
        cls.said = subprocess.run(command, cwd=cls.folder, check=True, capture_output=True, text=True).stderr

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def test_parquet_has_what_the_store_has(self):
        self.assertEqual(sorted(f.name for f in self.parquet.iterdir()),
                         ["pairs.parquet", "samples.parquet", "summary.parquet", "trials.parquet"])
        self.assertIn("trials.parquet", self.said)
        table = pyarrow.parquet.read_table(self.parquet / "trials.parquet")
        trials = self.store.sql("SELECT * FROM v_trials ORDER BY suite, controller, point, world")
        self.assertEqual(table.num_rows, 8)
        self.assertEqual(table.column_names, list(trials.columns))
        kinds = {field.name: str(field.type) for field in table.schema}
        self.assertEqual((kinds["trial"], kinds["world"], kinds["path_ee_m"], kinds["outcome"], kinds["energy_j"]),
                         ("string", "int64", "double", "string", "double"))
        for name in ("trial", "outcome", "path_ee_m", "manip_mean", "steps"):
            self.assertEqual(table[name].to_pylist(), list(trials[name]))
        samples = pyarrow.parquet.read_table(self.parquet / "samples.parquet").to_pandas()
        self.assertEqual(len(samples), trials.steps.sum())
        first = trials.trial[0]
        again = self.store.samples(first)
        self.assertEqual(list(samples[samples.trial == first].q0), list(again.q0))

    def test_says_what_is_wrong(self):
        done = subprocess.run([sys.executable, "-m", "moma", "export", "none.db", "--parquet", "x"], cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, 1)
        self.assertIn("no store none.db", done.stderr)

    def test_what_the_page_shows_runs(self):
        page = (ROOT / "docs/how-to/data.md").read_text()
        blocks = re.findall(r"```python\n(.*?)```", page, re.S)
        self.assertEqual(len(blocks), 3)
        here = os.getcwd()
        os.chdir(self.folder)
        self.addCleanup(os.chdir, here)
        found = []
        for block in blocks:
            names = {}
            exec(compile(block, "docs/how-to/data.md", "exec"), names)
            table = names["rates"]
            rows = table.fetchall() if hasattr(table, "fetchall") else table.reset_index(drop=True).values.tolist() if hasattr(table, "values") else table.rows()
            found.append(sorted((row[0], row[1], round(float(row[2]), 9)) for row in rows))
        self.assertEqual(found[0], found[1])
        self.assertEqual(found[0], found[2])
        self.assertEqual(len(found[0]), 4, "two controllers in two families")
        self.assertTrue(polars.__version__ and duckdb.__version__)

    def test_datasettes_file_names_tables_and_columns_that_are_there(self):
        meta = json.loads((ROOT / "examples/data/datasette.json").read_text())
        tables = meta["databases"]["demo"]["tables"]
        self.assertGreater(len(tables), 2)
        for table, about in tables.items():
            columns = set(self.store.sql(f"SELECT * FROM {table} LIMIT 1").columns)
            self.assertLessEqual(set(about.get("columns", {})), columns, table)
            if "sort" in about:
                self.assertIn(about["sort"], columns)
        for query in meta["databases"]["demo"]["queries"].values():
            self.assertGreater(len(self.store.sql(query["sql"])), 0)


if __name__ == "__main__":
    unittest.main()
