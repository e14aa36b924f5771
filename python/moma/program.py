"""The program `moma`: what evaluates, and what reads stores."""

from __future__ import annotations

import codecs
import os
import pathlib
import re
import shutil
import subprocess
import sys
import threading
from typing import IO, Sequence


PROGRESS = re.compile(r"\d+ of \d+ trials")  # what a line of it begins with


class ProgramError(RuntimeError):
    """The program ended with an exit code other than 0; the text is what it said."""

    def __init__(self, text: str, code: int):
        super().__init__(text)
        self.code = code


def program() -> str:
    """Where it is: $MOMA_PROGRAM, the one that came with this package, or that of PATH."""
    named = os.environ.get("MOMA_PROGRAM")
    if named:
        return named
    own = pathlib.Path(__file__).parent / "bin" / "moma"
    if own.is_file():
        return str(own)
    found = shutil.which("moma")
    # The package's own command only leads here.
    if found and pathlib.Path(found).read_bytes()[:4] == b"\x7fELF":
        return found
    raise FileNotFoundError("there is no program moma: not in the package, not in PATH; set MOMA_PROGRAM to where it is")


def refuse_in_worker(what: str) -> None:
    """Raises RuntimeError in a process that moma started for a controller: what evaluates as a file is read for its class would
    start such processes without end."""
    if os.environ.get("MOMA_WORKER"):
        raise RuntimeError(
            f"{what} is called as a process of a controller reads the controller's file; in a script, put the call under: "
            'if __name__ == "__main__":'
        )


def run(arguments: Sequence[str], *, show: bool = False) -> str:
    """What it prints. `show`: its progress and remarks go to this process's standard error as well. Ctrl-C reaches it as well; it
    stops as it does in a terminal, with what is done saved. Raises ProgramError."""
    said: list[str] = []
    with subprocess.Popen(
        [program(), *arguments], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as child:
        assert child.stdout is not None
        listener = threading.Thread(target=_listen, args=(child.stderr, said, show))
        listener.start()
        try:
            out = child.stdout.read()
        finally:  # Ctrl-C reaches the program, which ends by itself
            child.wait()
            listener.join()
    if child.returncode != 0:
        lines = [line for line in re.split(r"[\r\n]+", "".join(said)) if line and not PROGRESS.match(line)]
        raise ProgramError("\n".join(lines) or f"moma {arguments[0]} ended with exit code {child.returncode}", child.returncode)
    return out.decode("utf-8", "replace")


def _listen(stream: IO[bytes], said: list[str], show: bool) -> None:
    decode = codecs.getincrementaldecoder("utf-8")("replace").decode
    while chunk := stream.read1(4096):  # type: ignore[attr-defined]
        said.append(decode(chunk))
        if show:
            print(said[-1], end="", file=sys.stderr, flush=True)
