"""Parquet files. They need pyarrow (pip install "moma[parquet]")."""

from __future__ import annotations

import json
import pathlib
from typing import Any

from .replace import check_replace


def write_parquet(names: list[str], rows: list[dict[str, Any]], path: pathlib.Path, force: bool = False) -> pathlib.Path:
    """A table as a file. A column is of whole numbers, of numbers or of text as its values are, and where all are absent of
    numbers. It takes the place of an earlier file of the same columns, of others with `force` only: FileExistsError."""
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError as error:
        raise ImportError('Parquet needs pyarrow: pip install "moma[parquet]"') from error
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
