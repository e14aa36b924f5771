"""The search for gains, by the program."""

from __future__ import annotations

import json
import os
import pathlib
import re
from typing import Any, Mapping, NamedTuple

from . import _core
from .program import refuse_in_worker, run
from .store import Store
from .suite import Suite, entry_of


class Tuned(NamedTuple):
    store: Store  #: every trial of the search and of the verdict
    gains: pathlib.Path  #: the controller's file with what was found
    controller: dict[str, Any]  #: and what stands in it
    text: str  #: what the program says: the gains, how much each matters, the verdict


def tune(
    suite: Suite | str | os.PathLike[str] | Mapping[str, Any],
    controllers: Mapping[str, Any] | None = None,
    *,
    tune: Mapping[str, Any] | None = None,
    store: str | os.PathLike[str] | None = None,
    gains: str | os.PathLike[str] | None = None,
    changes: Mapping[str, Any] | None = None,
    threads: int | None = None,
    verdict: bool = True,
    progress: bool = True,
) -> Tuned:
    """Searches gains as `moma tune` does, going on from what the store has, and judges them on worlds of their own.

    `tune` is the suite's section of that name, or what of it is other than in the suite: {"controller": "mine", "variables":
    {"controller.parameters.gain": {"range": [0.1, 5], "scale": "log"}}, "budget": {"trials": 1000}} (docs/reference/tuning.md).
    `controllers` are those of evaluate(): classes of one's own are tuned by their parameters. `gains` is the file for what is
    found, beside the store unless told otherwise; it gets a name of its own where the verdict is that it is worse.
    """
    refuse_in_worker("moma.tune()")
    chosen = suite if isinstance(suite, Suite) else Suite(suite)
    if controllers:
        chosen = _with_controllers(chosen, {name: entry_of(controller) for name, controller in controllers.items()})
    section = {f"tune.{key}": value for key, value in (tune or {}).items()}
    whole = chosen.changed({**dict(changes or {}), **section})
    file = pathlib.Path(store) if store is not None else pathlib.Path("results") / f"{whole.name}.db"
    file.parent.mkdir(parents=True, exist_ok=True)
    found = pathlib.Path(gains) if gains is not None else file.with_suffix(".yaml")
    with whole.arguments() as arguments:
        words = ["tune", *arguments, "-o", str(file), "--gains", str(found)]
        if threads is not None:
            words += ["--threads", str(threads)]
        words += ["--no-verdict"] * (not verdict) + ["--quiet"] * (not progress)
        text = run(words, show=progress)
    said = re.search(r"^the found gains are in (.*?)(?:, under a name of their own.*)?$", text, re.M)
    if said is None:
        raise RuntimeError(f"moma tune did not say where the gains are:\n{text}")
    path = pathlib.Path(said.group(1))
    return Tuned(Store(file), path, json.loads(_core.read_file(str(path))), text)


def _with_controllers(suite: Suite, entries: Mapping[str, Any]) -> Suite:
    """The search looks for its controller in what the suite says, not among changes."""
    if isinstance(suite.source, dict):
        data, directory = suite.source, suite.directory
    else:
        data, directory = json.loads(_core.read_file(str(suite.source))), suite.source.parent
    every = {**data, "name": data.get("name", suite.name), "controllers": {**data.get("controllers", {}), **entries}}
    return Suite(every, suite.changes, directory, suite.worlds)
