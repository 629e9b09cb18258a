"""The command ``posicast``."""

import os
import sys

from . import _native


def main() -> None:
    """Run the command with the words of ``sys.argv``, and end the process with its exit status.

    The command handles signals itself: it removes its temporary files, ends the programs that it called, and exits with 130 after SIGINT and
    143 after SIGTERM.
    """
    status = _native.program(["posicast", *sys.argv[1:]])
    # Nothing of Python is left to finish, and the threads of the command must not outlive its end.
    os._exit(status)
