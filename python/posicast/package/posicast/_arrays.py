"""What functions accept as arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional, Tuple

import numpy as np

from ._errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


def real(name: str, values: ArrayLike, what: str) -> NDArray[np.float64]:
    """Return values as contiguous 64-bit floats of any shape, all of them finite.

    Raises
    ------
    InputError
        For values that are no real numbers, and for NaN and infinity.
    """
    try:
        array = np.asarray(values)
    except ValueError as error:
        raise InputError(f"{name}: {error}", remedy=f"give {what} as one array of numbers") from error
    if array.dtype.kind not in "fiu":
        raise InputError(f"{name}: found the type {array.dtype}; allowed: real numbers", remedy=f"give {what} as floats or integers")
    array = np.ascontiguousarray(array, dtype=np.float64) if array.ndim else array.astype(np.float64)
    if not np.isfinite(array).all():
        index = np.argwhere(~np.isfinite(np.atleast_1d(array)))[0].tolist()
        found = np.atleast_1d(array)[tuple(index)]
        raise InputError(f"{name}: found {found} at index {index}; allowed: finite numbers", remedy="remove the value, or replace it")
    return array


def samples(name: str, values: ArrayLike) -> NDArray[np.float64]:
    """Return samples as a contiguous array of one dimension.

    Raises
    ------
    InputError
        As :func:`real`, and for another number of dimensions.
    """
    array = real(name, values, "the samples")
    one_dimension(name, array)
    return array


def one_dimension(name: str, array: NDArray[Any]) -> None:
    """Refuse an array that does not have one dimension."""
    if array.ndim != 1:
        raise InputError(f"{name}: found the shape {array.shape}; allowed: one dimension", remedy=f"shape each column by itself, such as {name}[:, 0]")


def words(name: str, values: ArrayLike, word_bits: int) -> NDArray[Any]:
    """Return command words as a contiguous array of ``int32`` or ``int64``, without a copy where it is one already.

    Raises
    ------
    InputError
        For values that are no integers, that a word of this width does not hold, or that have another number of dimensions.
    """
    try:
        array = np.asarray(values)
    except ValueError as error:
        raise InputError(f"{name}: {error}", remedy="give one array of integers") from error
    if array.size == 0:
        array = array.astype(np.int64)
    if array.dtype == object and all(isinstance(value, int) for value in array.flat):
        raise InputError(
            f"{name}: found an integer beyond 64 bits; a word has {word_bits} bits", remedy="use fewer counts, or a larger word_bits (at most 32)"
        )
    if array.dtype.kind not in "iu":
        raise InputError(
            f"{name}: found the type {array.dtype}; allowed: integers, the words of the hardware",
            remedy=f"round to words, such as numpy.rint(256 * {name}).astype(numpy.int32), or use Shaper.apply for floats",
        )
    one_dimension(name, array)
    wide = array.dtype.itemsize * 8 > word_bits or (array.dtype.kind == "u" and array.dtype.itemsize * 8 >= word_bits)
    if wide and array.size:
        least, most = int(array.min()), int(array.max())
        limit = 1 << (word_bits - 1)
        if least < -limit or most >= limit:
            found = least if least < -limit else most
            raise InputError(
                f"{name}: found {found}; a word of {word_bits} bits holds {-limit} to {limit - 1}",
                remedy="use fewer counts, or a larger word_bits (at most 32)",
            )
    kept = array.dtype if array.dtype in (np.dtype(np.int32), np.dtype(np.int64)) else np.dtype(np.int64)
    return np.ascontiguousarray(array, dtype=kept)


def pairs(
    frequency_hz: ArrayLike, damping: ArrayLike
) -> Tuple[NDArray[np.float64], NDArray[np.float64], Tuple[int, ...]]:
    """Return frequencies and damping ratios, broadcast against each other and flat, and their shape.

    Raises
    ------
    InputError
        For frequencies that are not above 0, damping ratios outside [0, 1), and shapes that do not fit.
    """
    frequencies = real("frequency_hz", frequency_hz, "the frequencies in Hz")
    dampings = real("damping", damping, "the damping ratios")
    wrong = frequencies[frequencies <= 0]
    if wrong.size:
        raise InputError(f"frequency_hz: found {wrong.flat[0]}; allowed: above 0 Hz", remedy="give natural frequencies in Hz")
    wrong = dampings[(dampings < 0) | (dampings >= 1)]
    if wrong.size:
        raise InputError(f"damping: found {wrong.flat[0]}; allowed: 0 to below 1", remedy="a damping of 5 % is 0.05")
    try:
        frequencies, dampings = np.broadcast_arrays(frequencies, dampings)
    except ValueError:
        raise InputError(
            f"frequency_hz has the shape {frequencies.shape}, damping {dampings.shape}: NumPy cannot broadcast them",
            remedy="give both the same shape, or one of them as a number",
        ) from None
    return np.ascontiguousarray(frequencies).ravel(), np.ascontiguousarray(dampings).ravel(), frequencies.shape


def start_word(start: Optional[int], command: NDArray[Any], word_bits: int) -> int:
    """Return the word before the first one: ``start``, or the first one itself.

    Raises
    ------
    InputError
        For a start that is no integer, or that a word of this width does not hold.
    """
    if start is None:
        return int(command[0]) if command.size else 0
    return int(words("start", [start], word_bits)[0])
