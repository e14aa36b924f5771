"""A store of trials, as tables of pandas."""

from __future__ import annotations

import csv
import json
import os
import pathlib
from typing import TYPE_CHECKING, Any, NamedTuple

from .parquet import write_parquet
from .program import run

if TYPE_CHECKING:
    import pandas


class Comparison(NamedTuple):
    """B against A on the worlds that both met; docs/explanation/statistics.md."""

    rates: pandas.DataFrame  #: of success and collision (and of success without errors, where there are any), with intervals and p
    metrics: pandas.DataFrame  #: means, and the mean difference with its paired bootstrap interval
    text: str  #: as `moma compare` prints it

    def __str__(self) -> str:
        return self.text


class Store:
    """A store that `moma run` or evaluate() has written; it is only read. docs/reference/store.md has tables, views and columns.

    Every answer is the program's own: `sql()` takes what `moma query` takes.
    """

    def __init__(self, path: str | os.PathLike[str]):
        self.path = pathlib.Path(path)
        if not self.path.is_file():
            raise FileNotFoundError(f"no store {self.path}")

    def __repr__(self) -> str:
        return f"<moma.Store {self.path}>"

    def sql(self, statement: str) -> pandas.DataFrame:
        """The answer to one SQL statement, or to a named query (@summary, @list, @failures, @pairs, @worst)."""
        import pandas

        columns, rows = self.rows(statement)
        return pandas.DataFrame(rows, columns=columns)

    def rows(self, statement: str) -> tuple[list[str], list[dict[str, Any]]]:
        """The same as its columns' names and its rows."""
        query = ["query", str(self.path), statement, "--format"]
        rows = json.loads(run([*query, "json"]))
        return list(rows[0]) if rows else next(csv.reader([run([*query, "csv"])])), rows

    def trials(self, where: str = "1") -> pandas.DataFrame:
        """One row per trial, metrics and what they belong to; `where` is SQL over the columns of v_trials."""
        return self.sql(f"SELECT * FROM v_trials WHERE {where}")

    def summary(self) -> pandas.DataFrame:
        """Rates with Wilson's 95 % interval, and metrics, per controller, point, family and mode."""
        return self.sql("@summary")

    def pairs(self) -> pandas.DataFrame:
        """Each pair of points on the same worlds: n, both, only_a, only_b, neither."""
        return self.sql("@pairs")

    def samples(self, trial: str) -> pandas.DataFrame:
        """The time series of a trial, named by any unique beginning of its name."""
        if not trial or not all(c in "0123456789abcdef" for c in trial):
            raise ValueError(f"found {trial!r}, expected (the beginning of) a trial's name, hexadecimal digits")
        return self.sql(f"SELECT * FROM samples('{trial}') ORDER BY step")

    def compare(self, a: str, b: str, suite: str | None = None) -> Comparison:
        """Two controllers (NAME under equal conditions, or NAME:POINT) on the same worlds, paired: what `moma compare` says."""
        import pandas

        words = ["compare", str(self.path), a, b, *(["--suite", suite] if suite else [])]
        found = json.loads(run([*words, "--json"]))
        return Comparison(pandas.DataFrame(found["rates"]), pandas.DataFrame(found["metrics"]), run(words))

    def replay(self, trial: str, *, allow_plugins: bool = False) -> dict[str, Any]:
        """The trial simulated again from the store alone, with its samples. `allow_plugins` lets it run the code that the
        store names."""
        allow = ["--allow-plugins"] if allow_plugins else []
        return json.loads(run(["replay", str(self.path), trial, "--json", *allow]))

    def report(self, output: str | os.PathLike[str] | None = None, force: bool = False) -> pathlib.Path:
        """Writes the report page, beside the store unless told otherwise; over a file that is no such page with `force` only."""
        page = pathlib.Path(output) if output is not None else self.path.with_suffix(".html")
        run(["report", str(self.path), "-o", str(page), *["--force"] * force])
        return page

    def to_parquet(self, output: str | os.PathLike[str], statement: str = "SELECT * FROM v_trials", force: bool = False) -> pathlib.Path:
        """Writes an answer as a Parquet file, by pyarrow, which has to be installed; a whole store: moma export --parquet."""
        return write_parquet(*self.rows(statement), pathlib.Path(output), force)
