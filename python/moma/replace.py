"""What a file that is written may take the place of; as the program has it (files/output_file.h)."""

from __future__ import annotations

import pathlib
from typing import Callable


def check_replace(file: pathlib.Path, kind: str, own: Callable[[pathlib.Path], bool], force: bool) -> None:
    """Raises FileExistsError where `file` is a store, or without `force` where it is not empty and none of moma's `own`."""
    if not file.is_file() or file.stat().st_size == 0:
        return
    with file.open("rb") as beginning:
        head = beginning.read(72)
    database = head.startswith(b"SQLite format 3\0")
    if database and (head[68:] == b"moma" or pathlib.Path(f"{file}-wal").exists()):
        raise FileExistsError(f"{file}: is a store of moma's, which nothing else replaces; name another file")
    if not force and not own(file):
        raise FileExistsError(f"{file}: is another file, no {kind}; name another file, or replace it with force")
