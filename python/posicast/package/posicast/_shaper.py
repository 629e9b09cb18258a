"""Shapers: their impulses, figures and taps."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, Callable, Dict, List, Optional, Tuple

import numpy as np

from . import _native
from ._arrays import pairs, real, samples
from ._errors import InputError, MissingTool
from ._taps import TapTable

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

#: Designs the same shaper for another sample rate, width of the coefficients, and method of digitising.
Redesign = Callable[[float, Optional[int], Optional[str]], "_native.Design"]

#: Kinds whose impulses lie on the samples for which they were designed.
_ON_SAMPLES = ("optimal", "smooth")


class Shaper:
    """The input shaper of an axis: impulses that cancel the vibration of its modes.

    :func:`design`, :func:`optimal` and :meth:`Machine.shapers` make it.

    Examples
    --------
    >>> import posicast
    >>> zv = posicast.design([(40.0, 0.0)], "zv")
    >>> zv.times.tolist(), zv.amplitudes.tolist()
    ([0.0, 0.0125], [0.5, 0.5])
    >>> float(zv.residual(40.0, 0.0)) < 1e-12
    True
    """

    def __init__(self, native: _native.Design, redesign: Optional[Redesign]) -> None:
        self._native = native
        self._redesign = redesign
        self._others: Dict[Tuple[float, Optional[int], Optional[str]], _native.Design] = {}

    @property
    def kind(self) -> str:
        """Kind of the shaper; kinds of several modes are joined by ``+``."""
        return self._native.kind

    @property
    def modes(self) -> List[Tuple[float, float]]:
        """Frequency in Hz and damping ratio of each mode that it is designed for."""
        return self._native.modes

    @property
    def times(self) -> NDArray[np.float64]:
        """Times of the impulses in s, shape ``(impulses,)``, the first 0."""
        return self._native.impulses()[0]

    @property
    def amplitudes(self) -> NDArray[np.float64]:
        """Amplitudes of the impulses, shape ``(impulses,)``; they sum to 1."""
        return self._native.impulses()[1]

    @property
    def impulses(self) -> NDArray[np.float64]:
        """Times in s and amplitudes, shape ``(impulses, 2)``."""
        return np.column_stack(self._native.impulses())

    @property
    def duration(self) -> float:
        """Time of the last impulse in s: a move ends that much later."""
        return self._native.duration

    @property
    def delay(self) -> float:
        """Mean delay in s, by which a shaped ramp lags."""
        return self._native.delay

    @property
    def sample_hz(self) -> float:
        """Samples per second for which it was designed."""
        return self._native.sample_hz

    def __repr__(self) -> str:
        return f"<Shaper {self.kind}: {len(self.times)} impulses in {1e3 * self.duration:.4g} ms>"

    def residual(self, frequency_hz: ArrayLike, damping: ArrayLike) -> NDArray[np.float64]:
        """Return the residual vibration of a step, as a fraction of the unshaped one: 0 for a perfect shaper.

        Parameters
        ----------
        frequency_hz
            Undamped natural frequencies in Hz, any shape.
        damping
            Damping ratios in [0, 1), of a shape that broadcasts with the frequencies.

        Returns
        -------
        numpy.ndarray
            The residuals, in the shape of both.

        Raises
        ------
        InputError
            For values outside those ranges, and for shapes that do not fit.

        Notes
        -----
        ``V = |sum(A_i exp(zeta*w*(t_i - t_n) + 1j*w_d*t_i))|`` with the last impulse at ``t_n`` (Singer and Seering 1990).

        Examples
        --------
        >>> import numpy as np, posicast
        >>> zvd = posicast.design([(40.0, 0.02)], "zvd")
        >>> zvd.residual(np.array([38.0, 40.0, 42.0]), 0.02).round(4).tolist()
        [0.0058, 0.0, 0.0058]
        """
        frequencies, dampings, shape = pairs(frequency_hz, damping)
        return self._native.residual(frequencies, dampings).reshape(shape)

    def sensitivity(
        self, mode: int = 0, *, low: float = 0.5, high: float = 1.5, points: int = 601
    ) -> Tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the residual over the true frequency of a mode.

        Parameters
        ----------
        mode
            Index of the mode, from 0.
        low, high
            Range of the true frequency relative to the mode's, above 0.
        points
            Number of points, 2 to 1,000,000.

        Returns
        -------
        ratios, residuals : numpy.ndarray
            Two arrays of shape ``(points,)``.

        Raises
        ------
        InputError
            For a mode that does not exist, and for other ranges.
        """
        if not (0 < low < high and 2 <= points <= 1_000_000):
            raise InputError(
                f"found low {low}, high {high}, points {points}; allowed: 0 < low < high, and 2 to 1000000 points",
                remedy="leave them out for 0.5 to 1.5 in 601 points",
            )
        return self._native.sensitivity(self._mode(mode), float(low), float(high), int(points))

    def insensitivity(self, mode: int = 0, *, tolerance: float = 0.05) -> Optional[Tuple[float, float]]:
        """Return the range of the true frequency, relative to a mode's, in which at most ``tolerance`` remains.

        Returns
        -------
        tuple of float or None
            Lower and upper end, the upper one ``inf`` beyond ten times the frequency; ``None`` if more remains at the mode itself.

        Raises
        ------
        InputError
            For a mode that does not exist, and for a tolerance outside (0, 1).

        Examples
        --------
        >>> import posicast
        >>> low, high = posicast.design([(40.0, 0.0)], "zv").insensitivity(tolerance=0.05)
        >>> round(high - low, 3)
        0.064
        """
        if not 0 < tolerance < 1:
            raise InputError(f"tolerance: found {tolerance}; allowed: above 0, below 1", remedy="5 % is 0.05")
        found = self._native.insensitivity(self._mode(mode), tolerance)
        if found is None:
            return None
        low, high = found
        return low, float("inf") if high is None else high

    def _mode(self, index: int) -> Tuple[float, float]:
        modes = self.modes
        if not 0 <= index < len(modes):
            raise InputError(f"mode: found {index}; the shaper has {len(modes)} modes", remedy=f"give an index from 0 to {len(modes) - 1}")
        return modes[index]

    def certify(self) -> Dict[str, Any]:
        """Return upper bounds of the residual of the integer table over the whole band of every mode.

        Returns
        -------
        dict
            ``modes``: for each mode its band, ``tolerance``, ``certified_residual``, ``found_residual``, and whether the bound ``holds``;
            for ``optimal`` also ``shorter``: whether it is ``proven`` that no shorter shaper exists, with the points of the proof. The keys
            are those of ``certificate`` in ``posicast design --certify --json``.

        Examples
        --------
        >>> import posicast
        >>> ei = posicast.design([(40.0, 0.02)], "ei", frequency_band=0.05)
        >>> [mode["holds"] for mode in ei.certify()["modes"]]
        [True]
        """
        certificate: Dict[str, Any] = json.loads(self._native.document(True))["certificate"]
        return certificate

    def document(self) -> Dict[str, Any]:
        """Return all figures, as an axis in ``posicast design --json`` has them."""
        document: Dict[str, Any] = json.loads(self._native.document(False))
        return document

    def taps(
        self, sample_hz: Optional[float] = None, *, fraction_bits: Optional[int] = None, digitise: Optional[str] = None
    ) -> TapTable:
        """Return the integer tap table of the hardware, the same that ``posicast generate`` writes.

        Parameters
        ----------
        sample_hz
            Samples per second; by default those of the design.
        fraction_bits
            Fraction bits of a coefficient, 1 to 16; by default the most that fit.
        digitise
            ``modal`` (two taps for an impulse, exact at the mode's pole: the default), ``linear`` or ``nearest``.

        Raises
        ------
        InputError
            For a shaper that is too long for the hardware, a mode above half the sample rate, and for a rate that differs from the design's
            if the kind has its impulses on the samples.

        Examples
        --------
        >>> import posicast
        >>> table = posicast.design([(40.0, 0.0)], "zv").taps(1000.0)
        >>> table.delays.tolist(), int(table.coefficients.sum())
        ([0, 12, 13], 65536)
        """
        return TapTable._of(self._at(sample_hz, fraction_bits, digitise).taps())

    def _at(self, sample_hz: Optional[float], fraction_bits: Optional[int] = None, digitise: Optional[str] = None) -> _native.Design:
        """The design at another rate."""
        rate = self.sample_hz if sample_hz is None else float(sample_hz)
        if rate == self.sample_hz and fraction_bits is None and digitise is None:
            return self._native
        if self._redesign is None:
            raise InputError(
                "the rate, the coefficients and the method of digitising are those of the machine file",
                key="clock.sample_hz",
                remedy="call taps() without arguments, or change `[clock]` and `[fixed_point]` of the machine file",
            )
        if rate != self.sample_hz and any(kind in self.kind for kind in _ON_SAMPLES):
            raise InputError(
                f"sample_hz: found {rate:g}; the impulses of {self.kind} lie on samples at {self.sample_hz:g} Hz",
                remedy=f"design it again with sample_hz={rate:g}",
            )
        key = (rate, fraction_bits, digitise)
        if key not in self._others:
            self._others[key] = self._redesign(*key)
        return self._others[key]

    def apply(self, command: ArrayLike, sample_hz: Optional[float] = None, *, start: Optional[float] = None) -> NDArray[np.float64]:
        """Shape samples in floating point, before the taps are rounded; :meth:`TapTable.apply` is the hardware's integers.

        Parameters
        ----------
        command
            Positions, velocities or the like, shape ``(samples,)``, all finite.
        sample_hz
            Samples per second; by default those of the design.
        start
            Value before the first sample; by default the first one: the machine is at rest there.

        Returns
        -------
        numpy.ndarray
            The shaped samples, shape ``(samples,)``.

        Raises
        ------
        InputError
            For another shape, and for NaN.

        Examples
        --------
        >>> import posicast
        >>> zv = posicast.design([(250.0, 0.0)], "zv")
        >>> zv.apply([0.0, 1.0, 1.0, 1.0], 1000.0).tolist()
        [0.0, 0.5, 0.5, 1.0]
        """
        return self.stream(sample_hz, start=start).apply(command)

    def stream(self, sample_hz: Optional[float] = None, *, start: Optional[float] = None) -> "Stream":
        """Return the shaper in floating point with its history, for a command that comes in pieces."""
        value = None if start is None else float(real("start", start, "the start"))
        return Stream(self._at(sample_hz).stream(value))

    def to_fir(self, sample_hz: Optional[float] = None) -> NDArray[np.float64]:
        """Return the taps before rounding as coefficients of an FIR filter, such as ``b`` of ``scipy.signal.lfilter(b, 1, x)``.

        Returns
        -------
        numpy.ndarray
            Shape ``(longest delay + 1,)``; the coefficients sum to 1.

        Examples
        --------
        >>> import posicast
        >>> posicast.design([(250.0, 0.0)], "zv").to_fir(1000.0).tolist()
        [0.5, 0.0, 0.5]
        """
        delays, weights = self._at(sample_hz).real_taps()
        coefficients = np.zeros(int(delays[-1]) + 1)
        coefficients[delays] = weights
        return coefficients

    def to_lti(self, sample_hz: Optional[float] = None) -> Any:
        """Return the digitised shaper as a discrete ``control.TransferFunction``; needs the package ``control``.

        Raises
        ------
        MissingTool
            If ``control`` is not installed.
        """
        try:
            import control
        except ImportError as error:
            raise MissingTool("to_lti needs the package control", remedy="pip install 'posicast[control]'") from error
        rate = self.sample_hz if sample_hz is None else float(sample_hz)
        numerator = self.to_fir(rate)
        denominator = np.zeros(len(numerator))
        denominator[0] = 1.0
        return control.TransferFunction(numerator, denominator, 1.0 / rate)


class Stream:
    """A shaper in floating point with its history: :meth:`Shaper.stream` makes it. Threads may share it; each piece is shaped as a whole."""

    def __init__(self, native: _native.RealStream) -> None:
        self._native = native

    def apply(self, command: ArrayLike) -> NDArray[np.float64]:
        """Shape the samples that follow; parameters, result and errors as in :meth:`Shaper.apply`."""
        return self._native.apply(samples("command", command))
