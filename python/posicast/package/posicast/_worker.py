"""The process of a step that calls other programs: ``python -m posicast._worker``, with the request as its first line of input.

It ends itself when its input ends: when the process that waits for it is gone, nothing is left behind.
"""

import os
import signal
import sys
import threading

from . import _native


def _end_with_the_caller() -> None:
    sys.stdin.buffer.read()
    os.kill(os.getpid(), signal.SIGTERM)


def main() -> None:
    """Run one step."""
    request = sys.stdin.buffer.readline().decode()
    threading.Thread(target=_end_with_the_caller, daemon=True).start()
    os._exit(_native.worker(request))


if __name__ == "__main__":
    main()
