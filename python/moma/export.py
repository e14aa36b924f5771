"""Parquet files of a store: moma export DB --parquet FOLDER. Needs pyarrow (pip install "moma[parquet]")."""

from __future__ import annotations

import argparse
import json
import pathlib
import sys
from typing import Sequence

from .program import ProgramError
from .replace import check_replace
from .store import Store

TABLES = {
    "trials": "SELECT * FROM v_trials ORDER BY suite, controller, point, world",
    "pairs": "SELECT * FROM v_pairs ORDER BY suite, controller_a, point_a, controller_b, point_b, world",
    "summary": "@summary",
}
SAMPLES = "SELECT v.trial AS trial, s.* FROM v_trials AS v, samples(v.trial) AS s ORDER BY 1, s.step"


def write_parquet(store: Store, statement: str, path: pathlib.Path, force: bool = False) -> pathlib.Path:
    """One answer as one file. A column is of whole numbers, of numbers or of text as its values are, and where all are absent of
    numbers. It takes the place of an earlier file of the same columns, of others with `force` only: FileExistsError."""
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError as error:
        raise ImportError('Parquet needs pyarrow: pip install "moma[parquet]"') from error
    names, rows = store.rows(statement)
    columns = {}
    for name in names:
        values = [row[name] for row in rows]
        kinds = {type(value) for value in values if value is not None}
        if kinds <= {int, float}:
            kind = pyarrow.int64() if kinds == {int} else pyarrow.float64()
            columns[name] = pyarrow.array(values, kind)
        else:
            columns[name] = pyarrow.array([v if v is None or isinstance(v, str) else json.dumps(v) for v in values])

    def has_columns(file: pathlib.Path) -> bool:
        try:
            return pyarrow.parquet.read_schema(file).names == names
        except pyarrow.ArrowException:
            return False

    check_replace(path, "table of these columns", has_columns, force)
    pyarrow.parquet.write_table(pyarrow.table(columns), path)
    return path


def main(arguments: Sequence[str]) -> int:
    """The command; what it prints goes to standard error, as the program's does. Its exit code."""
    parser = argparse.ArgumentParser("moma export", description="Write a store as Parquet files")
    parser.add_argument("db", metavar="DB", help="Store")
    parser.add_argument("--parquet", required=True, metavar="FOLDER", help="Folder for the files, made if missing")
    parser.add_argument("--force", action="store_true", help="Replace files that are other tables or none; never a store")
    parser.add_argument("--samples", action="store_true", help="Also samples.parquet, the time series that are stored")
    options = parser.parse_args(arguments)
    folder = pathlib.Path(options.parquet)
    try:
        store = Store(options.db)
        folder.mkdir(parents=True, exist_ok=True)
        for name, statement in {**TABLES, **({"samples": SAMPLES} if options.samples else {})}.items():
            print("wrote", write_parquet(store, statement, folder / f"{name}.parquet", options.force), file=sys.stderr)
    except ProgramError as error:
        print(error, file=sys.stderr)
        return error.code
    except (ImportError, OSError) as error:
        print(f"moma export: {error}", file=sys.stderr)
        return 1
    return 0
