"""Suites, and their evaluation by the program."""

from __future__ import annotations

import contextlib
import inspect
import json
import os
import pathlib
import sys
import tempfile
from typing import Any, Callable, Iterator, Mapping, Sequence

from . import _core
from .program import refuse_in_worker, run
from .store import Store
from .world import World, frozen_set

Foreign = Callable[..., Any]


class Suite:
    """A suite: its file, or what would stand in one (relative paths are then relative to `directory`, the working folder
    unless told otherwise), with changes as `--set` takes them: {"simulation.mode": "kinematic", "trials": 20}. `worlds`, a
    list of worlds as data, stand in for those that the suite would draw."""

    def __init__(
        self,
        source: str | os.PathLike[str] | Mapping[str, Any],
        changes: Mapping[str, Any] | None = None,
        directory: str | os.PathLike[str] | None = None,
        worlds: Sequence[Mapping[str, Any]] | None = None,
    ):
        self.source = dict(source) if isinstance(source, Mapping) else pathlib.Path(source)
        self.changes = dict(changes or {})
        self.directory = pathlib.Path(directory or ".")
        self.worlds = None if worlds is None else [World(world) for world in worlds]
        if self.worlds is not None and not self.worlds:
            raise ValueError("worlds: found none, expected at least one")
        self._loaded: Any = None
        if isinstance(self.source, dict) and not isinstance(self.source.get("name"), str):
            raise ValueError("a suite that is a dict needs a name")

    @property
    def name(self) -> str:
        """Of the suite, where it is a dict; else that of its file, which it has unless it says otherwise."""
        return self.source["name"] if isinstance(self.source, dict) else self.source.stem

    def changed(self, changes: Mapping[str, Any]) -> Suite:
        """A copy with further changes."""
        return Suite(self.source, {**self.changes, **changes}, self.directory, self.worlds)

    def check(self) -> str:
        """What `moma check` says: what the suite would do. Raises ProgramError with what is wrong with it."""
        with self.arguments() as arguments:
            return run(["check", *arguments])

    def load(self) -> Any:
        """Read in this process, once, for Env and worlds. Raises ConfigError."""
        if self._loaded is None:
            with self._files() as (file, changes):
                self._loaded = _core.Suite.load(file, [(key, _text(value)) for key, value in changes.items()])
        return self._loaded

    @property
    def points(self) -> list[tuple[str, str]]:
        """Controller and label ("" without a sweep) of each point."""
        return list(self.load().points)

    def world(self, index: int, point: int = 0) -> World:
        """A world of the suite, as data."""
        return World(json.loads(self.load().world(point, index)))

    @contextlib.contextmanager
    def arguments(self) -> Iterator[list[str]]:
        """Of the program, for it; files that it needs are there as long as the context lasts."""
        with self._files() as (file, changes):
            yield [file, *(word for key, value in changes.items() for word in ("--set", f"{key}={_text(value)}"))]

    @contextlib.contextmanager
    def _files(self) -> Iterator[tuple[str, dict[str, Any]]]:
        with contextlib.ExitStack() as stack:

            def write(text: str, suffix: str) -> str:
                # Beside what a suite's paths are relative to.
                file = stack.enter_context(
                    tempfile.NamedTemporaryFile("w", dir=self.directory, prefix=".moma-", suffix=suffix, encoding="utf-8")
                )
                file.write(text)
                file.flush()
                return file.name

            source, changes = self.source, dict(self.changes)
            if self.worlds is not None:
                changes["worlds"] = {"frozen": os.path.abspath(write(frozen_set(self.worlds), ".jsonl"))}
                changes.setdefault("trials", len(self.worlds))
            # JSON is YAML.
            yield (write(json.dumps(source), ".yaml") if isinstance(source, dict) else str(source)), changes


def evaluate(
    suite: Suite | str | os.PathLike[str] | Mapping[str, Any],
    controllers: Mapping[str, Foreign | tuple[Foreign, Mapping[str, Any]] | str | Mapping[str, Any]] | None = None,
    *,
    store: str | os.PathLike[str] | None = None,
    trials: int | None = None,
    seed: int | None = None,
    changes: Mapping[str, Any] | None = None,
    threads: int | None = None,
    keep_going: bool = False,
    progress: bool = True,
) -> Store:
    """Evaluates a suite into a store as `moma run` does, going on from what is there, and gives the store.

    `controllers` are added to the suite's own, by name: a class with reset(robot, objects) and step(seen), or a function that
    returns such an object, of a file that can be read again (not of a notebook or a prompt); with its parameters as
    (class, {...}); or whatever a suite may say, a file's path or a dict. Classes run in processes of their own by
    this interpreter. A controller whose first trials all end by the same error raises ProgramError, unless told to
    `keep_going`. Ctrl-C lets the trials in flight end and keeps what is done. The processes read the class's file anew, so that
    a script evaluates under `if __name__ == "__main__":`; RuntimeError where one of them evaluates again.
    """
    refuse_in_worker("moma.evaluate()")
    chosen = suite if isinstance(suite, Suite) else Suite(suite)
    added = {f"controllers.{name}": entry_of(controller) for name, controller in (controllers or {}).items()}
    whole = chosen.changed({**dict(changes or {}), **added})
    file = pathlib.Path(store) if store is not None else pathlib.Path("results") / f"{whole.name}.db"
    file.parent.mkdir(parents=True, exist_ok=True)
    with whole.arguments() as arguments:
        words = ["run", *arguments, "-o", str(file)]
        for option, value in (("--trials", trials), ("--seed", seed), ("--threads", threads)):
            if value is not None:
                words += [option, str(value)]
        words += ["--keep-going"] * keep_going + ["--quiet"] * (not progress)
        run(words, show=progress)
    return Store(file)


def entry_of(controller: Any) -> Any:
    """A controller as a suite says it."""
    parameters: Mapping[str, Any] = {}
    if isinstance(controller, tuple):
        controller, parameters = controller
    if isinstance(controller, (str, os.PathLike)):
        return str(pathlib.Path(controller).absolute())
    if isinstance(controller, Mapping):
        return dict(controller)
    if not callable(controller):
        raise TypeError(f"found {controller!r}, expected a class, a function that makes a controller, a path or a dict")
    name = controller.__qualname__
    try:
        file = inspect.getsourcefile(controller)
    except TypeError:
        file = None
    if not file or not os.path.isfile(file):
        raise ValueError(f"{name} is of no file; its workers read it again, so write it into one")
    if not name.isidentifier():
        raise ValueError(f"{name} is inside of something else; its workers look for it in the file itself")
    return {
        "method": "python",
        "path": os.path.abspath(file),
        "class": name,
        "python": sys.executable,
        "parameters": dict(parameters),
    }


def _text(value: Any) -> str:
    return value if isinstance(value, str) else json.dumps(value)
