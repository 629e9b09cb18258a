"""`python -m posicast` runs the command."""

from ._program import main

main()
