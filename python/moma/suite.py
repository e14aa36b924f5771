"""Suites, and their evaluation by the program."""

from __future__ import annotations

import contextlib
import inspect
import json
import os
import pathlib
import sys
import tempfile
from typing import Any, Callable, Iterator, Mapping

from .program import run
from .store import Store

Foreign = Callable[..., Any]


class Suite:
    """A suite: its file, or what would stand in one (relative paths are then relative to `directory`, the working folder
    unless told otherwise), with changes as `--set` takes them: {"simulation.mode": "kinematic", "trials": 20}."""

    def __init__(
        self,
        source: str | os.PathLike[str] | Mapping[str, Any],
        changes: Mapping[str, Any] | None = None,
        directory: str | os.PathLike[str] | None = None,
    ):
        self.source = dict(source) if isinstance(source, Mapping) else pathlib.Path(source)
        self.changes = dict(changes or {})
        self.directory = pathlib.Path(directory or ".")
        if isinstance(self.source, dict) and not isinstance(self.source.get("name"), str):
            raise ValueError("a suite that is a dict needs a name")

    @property
    def name(self) -> str:
        """Of the suite, where it is a dict; else that of its file, which it has unless it says otherwise."""
        return self.source["name"] if isinstance(self.source, dict) else self.source.stem

    def check(self) -> str:
        """What `moma check` says: what the suite would do. Raises ProgramError with what is wrong with it."""
        with self._arguments() as arguments:
            return run(["check", *arguments])

    def world(self, index: int) -> dict[str, Any]:
        """A world of the suite, as data."""
        with self._arguments() as arguments:
            return json.loads(run(["world", arguments[0], str(index), *arguments[1:], "--json"]))

    @contextlib.contextmanager
    def _arguments(self) -> Iterator[list[str]]:
        changes = [word for key, value in self.changes.items() for word in ("--set", f"{key}={_text(value)}")]
        if not isinstance(self.source, dict):
            yield [str(self.source), *changes]
            return
        # Beside what its paths are relative to; JSON is YAML.
        with tempfile.NamedTemporaryFile("w", dir=self.directory, prefix=".moma-", suffix=".yaml", encoding="utf-8") as file:
            json.dump(self.source, file)
            file.flush()
            yield [file.name, *changes]


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
    `keep_going`. Ctrl-C lets the trials in flight end and keeps what is done.
    """
    chosen = suite if isinstance(suite, Suite) else Suite(suite)
    added = {f"controllers.{name}": entry_of(controller) for name, controller in (controllers or {}).items()}
    every = {**chosen.changes, **dict(changes or {}), **added}
    whole = Suite(chosen.source, every, chosen.directory)
    file = pathlib.Path(store) if store is not None else pathlib.Path("results") / f"{whole.name}.db"
    file.parent.mkdir(parents=True, exist_ok=True)
    with whole._arguments() as arguments:
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
