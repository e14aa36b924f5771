"""The command `moma` of the package: the program, and what only Python's libraries do."""

import os
import sys

from .export import main as export
from .program import program


def main() -> None:
    if "export" in sys.argv[1:2]:
        sys.exit(export(sys.argv[2:]))
    path = program()
    os.execv(path, [path, *sys.argv[1:]])


if __name__ == "__main__":
    main()
