"""From the modes of a flexible machine to verified input-shaper hardware.

>>> import posicast
>>> shaper = posicast.design([(40.0, 0.05)], "zvd", sample_hz=2000.0)
>>> table = shaper.taps()
>>> table.apply([0, 0, 1000, 1000])[-1] < 1000
np.True_

Floating point: :func:`design`, :func:`optimal`, :func:`compare`, :func:`identify`. The hardware's integers: :class:`TapTable`. Machine files:
:class:`Machine`, :func:`simulate`, :func:`generate`, :func:`verify`, :func:`run`. Errors are :class:`PosicastError`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ._errors import CheckFailed, InputError, MissingTool, PosicastError
from ._native import version as _version

if TYPE_CHECKING:
    from . import plot
    from ._design import Comparison, compare, design, optimal
    from ._identify import FoundMode, Identification, Panel, identify
    from ._machine import AxisMotion, Machine, simulate
    from ._schema import schema
    from ._shaper import Shaper, Stream
    from ._steps import Result, generate, run, verify
    from ._taps import TapStream, TapTable

__version__ = _version()

#: Where each name is defined. It is imported at its first use: the command `posicast` needs none of them, and NumPy takes a tenth of a second.
_HOMES = {
    "Comparison": "_design",
    "compare": "_design",
    "design": "_design",
    "optimal": "_design",
    "FoundMode": "_identify",
    "Identification": "_identify",
    "Panel": "_identify",
    "identify": "_identify",
    "AxisMotion": "_machine",
    "Machine": "_machine",
    "simulate": "_machine",
    "schema": "_schema",
    "Shaper": "_shaper",
    "Stream": "_shaper",
    "Result": "_steps",
    "generate": "_steps",
    "run": "_steps",
    "verify": "_steps",
    "TapStream": "_taps",
    "TapTable": "_taps",
}

__all__ = [
    "AxisMotion",
    "CheckFailed",
    "Comparison",
    "FoundMode",
    "Identification",
    "InputError",
    "Machine",
    "MissingTool",
    "Panel",
    "PosicastError",
    "Result",
    "Shaper",
    "Stream",
    "TapStream",
    "TapTable",
    "compare",
    "design",
    "generate",
    "identify",
    "optimal",
    "plot",
    "run",
    "schema",
    "simulate",
    "verify",
]


def __getattr__(name: str) -> Any:
    from importlib import import_module

    if name == "plot":
        return import_module(f"{__name__}.plot")
    home = _HOMES.get(name)
    if home is None:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f"{__name__}.{home}"), name)
    globals()[name] = value
    return value


def __dir__() -> "list[str]":
    return sorted({*globals(), *_HOMES, "plot"})
