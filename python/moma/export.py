"""Parquet files of a store: moma export DB --parquet FOLDER."""

from __future__ import annotations

import argparse
import pathlib
import sys
from typing import Sequence

from .parquet import write_parquet
from .program import ProgramError
from .store import Store

TABLES = {
    "trials": "SELECT * FROM v_trials ORDER BY suite, controller, point, world",
    "pairs": "SELECT * FROM v_pairs ORDER BY suite, controller_a, point_a, controller_b, point_b, world",
    "summary": "@summary",
}
SAMPLES = "SELECT v.trial AS trial, s.* FROM v_trials AS v, samples(v.trial) AS s ORDER BY 1, s.step"


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
            print("wrote", write_parquet(*store.rows(statement), folder / f"{name}.parquet", options.force), file=sys.stderr)
    except ProgramError as error:
        print(error, file=sys.stderr)
        return error.code
    except (ImportError, OSError) as error:
        print(f"moma export: {error}", file=sys.stderr)
        return 1
    return 0
