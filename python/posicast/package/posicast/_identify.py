"""Modes from a measured log."""

from __future__ import annotations

import json
import os
import tempfile
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Dict, List, Optional, Sequence, Tuple, Union

import numpy as np

from . import _native
from ._arrays import real
from ._design import SAMPLE_HZ, design
from ._errors import CheckFailed, InputError
from ._shaper import Shaper

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class FoundMode:
    """A mode of a log, with its uncertainty."""

    #: Undamped natural frequency in Hz.
    frequency_hz: float
    #: Damping ratio.
    damping: float
    #: 95 % interval of the frequency in Hz.
    frequency_interval_hz: Tuple[float, float]
    #: 95 % interval of the damping ratio.
    damping_interval: Tuple[float, float]
    #: Share in the static displacement; the shares of all modes sum to 1.
    participation: float
    #: Share in the ringing after a jump of the acceleration.
    ringing_share: float


@dataclass(frozen=True)
class Panel:
    """Curves of one picture: what ``posicast identify --plot`` draws."""

    title: str
    x_label: str
    y_label: str
    #: Arrays x and y, each of shape ``(points,)``, by the name of the curve.
    curves: Dict[str, Tuple[NDArray[np.float64], NDArray[np.float64]]]


@dataclass(frozen=True)
class Identification:
    """The modes of a log, and shapers for them."""

    modes: List[FoundMode]
    #: Shapers for all modes, the best first: kind, ``duration_s``, ``residual_displacement_m``, ``is_enough`` and others.
    recommended: List[Dict[str, Any]]
    #: The measured response, the fitted one and what shapers leave.
    panels: List[Panel]
    #: Name of the method by which the modes were found.
    method: str
    #: Samples per second of the log.
    sample_hz: float
    #: Problems of the log, and what it lacks.
    remarks: List[str]
    #: All figures, as ``posicast identify --json`` has them.
    document: Dict[str, Any]

    def shaper(self, kind: Optional[str] = None, *, sample_hz: float = SAMPLE_HZ, **keys: Any) -> Shaper:
        """Design a shaper for the modes: of the first recommended kind, or of another; ``keys`` are those of :func:`posicast.design`."""
        if kind is None:
            if not self.recommended:
                raise InputError("no shaper is recommended for these modes", remedy="name a kind")
            kind = str(self.recommended[0]["kind"])
        modes = [(mode.frequency_hz, mode.damping) for mode in self.modes]
        return design(modes, kind, sample_hz=sample_hz, **keys)


def identify(
    log: Union[str, "os.PathLike[str]", ArrayLike],
    *,
    columns: Optional[Sequence[str]] = None,
    rate_hz: Optional[float] = None,
    direction: Optional[str] = None,
    sweep: Optional[str] = None,
    output_only: bool = False,
    ring_down: bool = False,
    acceleration: float = 5.0,
    margin: float = 0.05,
) -> Identification:
    """Find the modes of a machine in a log, with their 95 % intervals, and shapers that suit them.

    Parameters
    ----------
    log
        A CSV file, or an array of shape ``(samples, columns)``.
    columns
        Names of the columns in order, such as ``["time", "command", "response"]`` or ``["time", "accel_x", "accel_y", "accel_z"]``, ``-``
        for an unused one. An array needs them; a file has them in its header.
    rate_hz
        Samples per second, for a log without times.
    direction
        ``x``, ``y`` or ``z`` of an accelerometer; by default the strongest.
    sweep
        Sweep of a printer's resonance test, ``START:END:RATE:ACCEL``; by default estimated from the log.
    output_only
        Whether the excitation is unknown.
    ring_down
        Whether the log shows the ringing after a stop.
    acceleration
        Jump of the acceleration by which shapers are judged, in m/s² or rad/s².
    margin
        Relative change of the frequencies that a shaper must tolerate in addition to the intervals.

    Raises
    ------
    InputError
        For a log that cannot be read or understood, such as one without time and ``rate_hz``.
    CheckFailed
        If no mode was found.

    Notes
    -----
    The page `identify <https://github.com/posicast/posicast/blob/main/docs/identify.md>`_ has the methods with their sources, and the units
    of the columns.

    Examples
    --------
    >>> import numpy as np, posicast
    >>> time = np.arange(0, 4, 1e-3)
    >>> ringing = np.where(time < 0.1, 0.0, 1 - np.exp(-2 * (time - 0.1)) * np.cos(60 * (time - 0.1)))
    >>> log = np.column_stack([time, time >= 0.1, ringing])
    >>> found = posicast.identify(log, columns=["time", "command", "response"])
    >>> round(found.modes[0].frequency_hz, 1)
    9.6
    """
    if not 0 <= margin <= 0.9:
        raise InputError(f"margin: found {margin}; allowed: 0 to 0.9", remedy="5 % is 0.05")
    for name, value in (("acceleration", acceleration), ("rate_hz", rate_hz)):
        if value is not None and not (0 < value < float("inf")):
            raise InputError(f"{name}: found {value}; allowed: a number above 0", remedy=f"leave {name} out, or give it in SI units")
    names = None if columns is None else [str(column) for column in columns]
    options = (names, rate_hz, direction, sweep, output_only, ring_down, float(acceleration), 100 * margin)
    if isinstance(log, (str, os.PathLike)):
        return _identification(os.fspath(log), *_native.identify_log(os.fspath(log), *options))
    array = real("log", log, "the log")
    if array.ndim != 2 or names is None or array.shape[1] != len(names):
        raise InputError(
            f"log: found the shape {array.shape} and the columns {names}; allowed: shape (samples, columns), and a name for each column",
            remedy='name them, such as columns=["time", "command", "response"]',
        )
    with tempfile.TemporaryDirectory(prefix="posicast-") as folder:
        path = os.path.join(folder, "log.csv")
        np.savetxt(path, array, delimiter=",", header=",".join(names), comments="", fmt="%.17g")
        try:
            return _identification("the array", *_native.identify_log(path, *options))
        except InputError as error:
            message = error.message.replace(f"{path}: ", "").replace(path, "the array")
            raise InputError(message, line=error.line, key=error.key, remedy=error.remedy) from None


def _identification(name: str, document: str, failed: Optional[str], panels: List[_native.Panel]) -> Identification:
    figures: Dict[str, Any] = json.loads(document)
    if failed is not None:
        remarks = "; ".join(figures["remarks"])
        raise CheckFailed(
            f"{name}: no mode was found" + (f": {remarks}" if remarks else ""),
            file=name,
            remedy="log a step, a stop or a sweep that makes the machine ring, with its command; docs/identify.md has the columns",
        )
    modes = [
        FoundMode(
            frequency_hz=mode["frequency_hz"],
            damping=mode["damping"],
            frequency_interval_hz=tuple(mode["frequency_interval_hz"]),
            damping_interval=tuple(mode["damping_interval"]),
            participation=mode["participation"],
            ringing_share=mode["ringing_share"],
        )
        for mode in figures["modes"]
    ]
    drawn = [Panel(title, x, y, {curve: (xs, ys) for curve, xs, ys in curves}) for title, x, y, curves in panels]
    return Identification(
        modes=modes,
        recommended=figures["recommended"],
        panels=drawn,
        method=figures["method"],
        sample_hz=figures["sample_hz"],
        remarks=figures["remarks"],
        document=figures,
    )
