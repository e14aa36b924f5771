"""One control step from a case file, as `moma solve` shows it."""

from __future__ import annotations

import json
import os
from typing import Any, Mapping

from . import _core


def solve(case: str | os.PathLike[str] | Mapping[str, Any]) -> dict[str, Any]:
    """Everything that `moma solve` prints of a case (a file, or what would stand in one): every matrix of the QP, its
    solution, distances. Raises ConfigError."""
    return json.loads(_core.solve(*_core_arguments(case)))


def explain(case: str | os.PathLike[str] | Mapping[str, Any]) -> str:
    """The same in words: which constraints hold the command, which rows contradict each other."""
    return _core.explain(*_core_arguments(case))


def _core_arguments(source: str | os.PathLike[str] | Mapping[str, Any]) -> tuple[str, str]:
    """A file's name and a text, one of them empty."""
    return ("", json.dumps(dict(source))) if isinstance(source, Mapping) else (os.fspath(source), "")
