"""Worlds as data."""

from __future__ import annotations

import json
import os
import pathlib
from typing import Any, Iterable, Iterator, Mapping

from . import _core
from .replace import check_replace


class World(Mapping[str, Any]):
    """A problem as plain numbers: start, goal, objects and how they move (docs/reference/worlds.md, "World files"). From a
    file, or from what stands in one; Suite.world() draws one, and a changed copy is World({**world, "goal": {...}}).

    It is read strictly: ConfigError says what is wrong. As a mapping it has the keys of the file, in its format, bit for
    bit.
    """

    def __init__(self, source: str | os.PathLike[str] | Mapping[str, Any]):
        if isinstance(source, Mapping):
            text, name = json.dumps(dict(source)), "world"
        else:
            name = os.fspath(source)
            text = pathlib.Path(name).read_text(encoding="utf-8")
        self._data: dict[str, Any] = json.loads(_core.read_world(text, name))

    def __getitem__(self, key: str) -> Any:
        return self._data[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._data)

    def __len__(self) -> int:
        return len(self._data)

    def __repr__(self) -> str:
        return f"<moma.World {self['index']} of family {self['family']}: {len(self['objects'])} objects>"

    @property
    def objects(self) -> list[dict[str, Any]]:
        """As Robot.distances() takes them."""
        return [
            {key: item[key] for key in ("name", "shape", "size", "position", "quaternion")} for item in self["objects"]
        ]

    def save(self, path: str | os.PathLike[str], force: bool = False) -> None:
        """Writes a file that World() reads back to the same bits; what it replaces is as for save_worlds()."""
        save_worlds([self], path, force)


def frozen_set(worlds: Iterable[Mapping[str, Any]]) -> str:
    """The text of a frozen set, one world a line."""
    return "".join(json.dumps(dict(world), separators=(",", ":")) + "\n" for world in worlds)


def save_worlds(worlds: Iterable[Mapping[str, Any]], path: str | os.PathLike[str], force: bool = False) -> None:
    """Writes a frozen set: what a suite's `worlds: {frozen: PATH}` reads. It takes the place of an earlier one; a file that
    begins by no world is replaced with `force` only, a store never: FileExistsError."""
    file, text = pathlib.Path(path), frozen_set(worlds)
    check_replace(file, "set of worlds", _begins_by_world, force)
    file.write_text(text, encoding="utf-8")


def _begins_by_world(file: pathlib.Path) -> bool:
    try:
        with file.open(encoding="utf-8") as lines:
            _core.read_world(lines.readline(), str(file))
    except (_core.ConfigError, UnicodeDecodeError):
        return False
    return True
