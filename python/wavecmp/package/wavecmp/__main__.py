"""`python -m wavecmp` runs the command."""

from ._program import main

main()
