"""One control step from a case file, as `moma solve` shows it."""

from __future__ import annotations

import json
import os
from typing import Any, Mapping

from . import _core


def solve(case: str | os.PathLike[str] | Mapping[str, Any]) -> dict[str, Any]:
    """Everything that `moma solve` prints of a case (a file, or what would stand in one): every matrix of the QP, its
    solution, distances. Raises ConfigError."""
    if isinstance(case, Mapping):
        return json.loads(_core.solve_json(json.dumps(case)))
    return json.loads(_core.solve_file(os.fspath(case)))


def explain(case: str | os.PathLike[str] | Mapping[str, Any]) -> str:
    """The same in words: which constraints hold the command, which rows contradict each other."""
    if isinstance(case, Mapping):
        return _core.explain_json(json.dumps(case))
    return _core.explain_file(os.fspath(case))
