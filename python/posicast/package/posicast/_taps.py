"""The integer tap table of the hardware, and the shaping of command words."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional, Sequence

import numpy as np

from . import _native
from ._arrays import pairs, real, start_word, words
from ._errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

#: Default width of a command word in bits, as in a machine file.
WORD_BITS = 32
_COEFFICIENT_BITS = 18


class TapTable:
    """Integer taps on the sample grid: what the hardware computes with.

    ``y[n] = saturate((sum(c_i * x[n - d_i]) + 2**(F-1)) >> F)``. The coefficients sum to exactly ``2**F``, so a constant command passes
    unchanged. :meth:`Shaper.taps` designs one; the constructor takes one that exists already.

    Parameters
    ----------
    delays
        Delays in samples, increasing.
    coefficients
        Integers of 18 bits in units of ``2**-fraction_bits``, none of them 0.
    fraction_bits
        F, 1 to 16.
    sample_hz
        Samples per second.

    Raises
    ------
    InputError
        If the lists are no table, such as for coefficients that sum to another number.

    Examples
    --------
    >>> from posicast import TapTable
    >>> table = TapTable([0, 2], [1 << 15, 1 << 15], 16, 1000.0)
    >>> table.apply([0, 1000, 1000, 1000]).tolist()
    [0, 500, 500, 1000]
    """

    def __init__(self, delays: Sequence[int], coefficients: Sequence[int], fraction_bits: int, sample_hz: float) -> None:
        if len(delays) != len(coefficients):
            raise InputError(
                f"{len(delays)} delays, but {len(coefficients)} coefficients", remedy="give a coefficient for each delay"
            )
        rate = float(real("sample_hz", sample_hz, "the rate"))
        if rate <= 0:
            raise InputError(f"sample_hz: found {rate}; allowed: above 0", remedy="give the samples per second")
        late = [int(delay) for delay in words("delays", delays, 32)]
        weights = [int(coefficient) for coefficient in words("coefficients", coefficients, _COEFFICIENT_BITS)]
        if min(late, default=0) < 0 or not 0 <= fraction_bits <= 32:
            raise InputError(
                f"found the delays {late} and {fraction_bits} fraction bits; allowed: delays from 0 on, 1 to 16 fraction bits",
                remedy="give delays in samples, in increasing order",
            )
        self._native = _native.Taps(late, weights, fraction_bits, rate)

    @classmethod
    def _of(cls, native: _native.Taps) -> "TapTable":
        table = cls.__new__(cls)
        table._native = native
        return table

    @property
    def delays(self) -> NDArray[np.int64]:
        """Delays in samples, shape ``(taps,)``."""
        return self._native.delays()

    @property
    def coefficients(self) -> NDArray[np.int64]:
        """Coefficients in units of ``2**-fraction_bits``, shape ``(taps,)``."""
        return self._native.coefficients()

    @property
    def fraction_bits(self) -> int:
        """Fraction bits F of a coefficient."""
        return self._native.fraction_bits

    @property
    def sample_hz(self) -> float:
        """Samples per second."""
        return self._native.sample_hz

    @property
    def delay(self) -> float:
        """Mean delay in s, by which a shaped ramp lags."""
        return self._native.mean_delay / self.sample_hz

    def __len__(self) -> int:
        return len(self.delays)

    def __repr__(self) -> str:
        return f"<TapTable of {len(self)} taps at {self.sample_hz:g} Hz, {self.fraction_bits} fraction bits>"

    def residual(self, frequency_hz: ArrayLike, damping: ArrayLike) -> NDArray[np.float64]:
        """Return the residual vibration that the integer table leaves, as a fraction of the unshaped one.

        Parameters, result and errors are those of :meth:`Shaper.residual`.
        """
        frequencies, dampings, shape = pairs(frequency_hz, damping)
        return self._native.residual(frequencies, dampings).reshape(shape)

    def apply(self, command: ArrayLike, *, word_bits: int = WORD_BITS, start: Optional[int] = None) -> NDArray[Any]:
        """Shape command words as the hardware does, bit for bit.

        Parameters
        ----------
        command
            Integers, shape ``(samples,)``. Arrays of ``int32`` and ``int64`` are read in place, others are copied.
        word_bits
            Width of a command word, 8 to 32.
        start
            Word before the first one, as after a start of the hardware; by default the first one: the machine is at rest there.

        Returns
        -------
        numpy.ndarray
            The shaped words, as long and of the same type; ``int64`` for other types than those two.

        Raises
        ------
        InputError
            For another type or shape, and for words that ``word_bits`` do not hold.

        Examples
        --------
        >>> import numpy as np, posicast
        >>> table = posicast.design([(40.0, 0.05)], "zv").taps(1000.0)
        >>> bool((table.apply(np.full(9, 77, dtype=np.int32)) == 77).all())
        True
        """
        array = words("command", command, word_bits)
        stream = self._native.stream(word_bits, start_word(start, array, word_bits))
        return _applied(stream, array)

    def stream(self, *, word_bits: int = WORD_BITS, start: int = 0) -> "TapStream":
        """Return the shaper with its history, for a command that comes in pieces; ``start`` is the word before the first one.

        Examples
        --------
        >>> import posicast
        >>> stream = posicast.TapTable([0, 2], [1 << 15, 1 << 15], 16, 1000.0).stream()
        >>> [stream.apply([1000]).tolist() for _ in range(3)]
        [[500], [500], [1000]]
        """
        word = start_word(start, np.zeros(0, dtype=np.int64), word_bits)
        return TapStream(self._native.stream(word_bits, word), word_bits)


class TapStream:
    """The hardware's shaper with its history: :meth:`TapTable.stream` makes it. Threads may share it; each piece is shaped as a whole."""

    def __init__(self, native: _native.Stream, word_bits: int) -> None:
        self._native = native
        self._word_bits = word_bits

    def apply(self, command: ArrayLike) -> NDArray[Any]:
        """Shape the words that follow; parameters, result and errors as in :meth:`TapTable.apply`."""
        return _applied(self._native, words("command", command, self._word_bits))

    @property
    def saturated(self) -> bool:
        """Whether a shaped word was clamped to the range of a word."""
        return self._native.saturated


def _applied(stream: _native.Stream, array: NDArray[Any]) -> NDArray[Any]:
    return stream.apply32(array) if array.dtype == np.int32 else stream.apply64(array)
