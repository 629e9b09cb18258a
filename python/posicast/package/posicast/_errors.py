"""The exceptions of the package."""

from __future__ import annotations

from typing import Optional

__all__ = ["CheckFailed", "InputError", "MissingTool", "PosicastError"]


class PosicastError(Exception):
    """Why a function stopped: what was found, what is allowed, and what to do.

    Attributes
    ----------
    message
        What was found, and what is allowed.
    file
        The file that it is about; ``None`` if there is none.
    line
        The line in that file, from 1.
    key
        The dotted key of the machine file, such as ``clock.sample_hz``.
    remedy
        What to do, in one line or several.
    """

    def __init__(
        self,
        message: str,
        file: Optional[str] = None,
        line: Optional[int] = None,
        key: Optional[str] = None,
        remedy: Optional[str] = None,
    ) -> None:
        super().__init__(message, file, line, key, remedy)
        self.message = message
        self.file = file
        self.line = line
        self.key = key
        self.remedy = remedy

    def __str__(self) -> str:
        return self.message if self.remedy is None else f"{self.message}\nhelp: {self.remedy}"


class InputError(PosicastError, ValueError):
    """A wrong argument, or a file that cannot be read, understood or written."""


class CheckFailed(PosicastError):
    """A check does not hold: the Verilog differs from the model, or no mode was found."""


class MissingTool(PosicastError):
    """A program that the step calls is not installed."""


for _class in (PosicastError, InputError, CheckFailed, MissingTool):
    # Where users import it from, and so what a traceback shows.
    _class.__module__ = "posicast"
