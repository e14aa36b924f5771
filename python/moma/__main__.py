"""python3 -m moma: the command `moma` of the package."""

from .program import main

main()
