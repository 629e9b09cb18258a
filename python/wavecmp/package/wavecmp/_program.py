"""The command ``wavecmp``."""

import signal
import sys

from . import _native


def main() -> None:
    """Run the command with the words of ``sys.argv``, and end the process with its exit status: 0 equal, 1 different, 2 not comparable."""
    # Python's own handler waits for the end of the native function.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.exit(_native.program(["wavecmp", *sys.argv[1:]]))
