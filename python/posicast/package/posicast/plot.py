"""Plots by Matplotlib: ``pip install 'posicast[plot]'``.

Each function draws into ``axes``, or into new ones, and returns them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional

import numpy as np

from ._errors import MissingTool

if TYPE_CHECKING:
    from ._identify import Panel
    from ._machine import AxisMotion
    from ._shaper import Shaper


def _axes(axes: Optional[Any]) -> Any:
    if axes is not None:
        return axes
    try:
        from matplotlib import pyplot
    except ImportError as error:
        raise MissingTool("plots need Matplotlib", remedy="pip install 'posicast[plot]'") from error
    return pyplot.subplots()[1]


def impulses(shaper: Shaper, axes: Optional[Any] = None) -> Any:
    """Draw the impulses over the time."""
    axes = _axes(axes)
    axes.stem(1e3 * shaper.times, shaper.amplitudes, basefmt=" ")
    axes.set(xlabel="time, ms", ylabel="amplitude", title=shaper.kind)
    return axes


def sensitivity(shaper: Shaper, mode: int = 0, axes: Optional[Any] = None, **range: Any) -> Any:
    """Draw the residual vibration over the true frequency of a mode; ``range`` is that of :meth:`Shaper.sensitivity`."""
    axes = _axes(axes)
    ratios, residuals = shaper.sensitivity(mode, **range)
    axes.plot(ratios, 100 * residuals, label=shaper.kind)
    axes.set(xlabel="true frequency / modelled", ylabel="residual vibration, %", ylim=(0, None))
    axes.legend()
    return axes


def motion(motion: AxisMotion, axes: Optional[Any] = None) -> Any:
    """Draw a command, the shaped one, and the machine with and without the shaper."""
    axes = _axes(axes)
    for name in ("command", "shaped", "position", "position_unshaped"):
        axes.plot(motion.time, getattr(motion, name), label=name.replace("_", " "))
    axes.set(xlabel="time, s", ylabel="position")
    axes.legend()
    return axes


def panel(panel: Panel, axes: Optional[Any] = None) -> Any:
    """Draw the curves of a panel of :func:`posicast.identify`."""
    axes = _axes(axes)
    for name, (x, y) in panel.curves.items():
        axes.plot(np.asarray(x), np.asarray(y), label=name)
    axes.set(xlabel=panel.x_label, ylabel=panel.y_label, title=panel.title)
    axes.legend()
    return axes
