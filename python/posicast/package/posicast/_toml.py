"""A machine file of one axis as text: the native functions check it as they check a file."""

from __future__ import annotations

import json
import math
from numbers import Integral, Real
from typing import Any, Iterable, List, Mapping, Optional, Sequence, Tuple, Union

from ._errors import InputError

Mode = Union[Tuple[float, float], Sequence[float], Mapping[str, Any]]

#: Clocks of a sample: more than the longest table needs, so that only a real machine has a limit there.
_CLOCKS_PER_SAMPLE = 10_000
_MODE_KEYS = ("frequency_hz", "damping", "shaper", "tolerance", "order", "frequency_band", "damping_band", "participation")


def machine_text(
    modes: Iterable[Mode],
    shaper: Mapping[str, Any],
    sample_hz: float,
    fixed_point: Mapping[str, Any],
    frequency_band: Optional[float],
    damping_band: Optional[Sequence[float]],
) -> str:
    """Return the text of a machine file with one axis of these modes and this shaper."""
    rate = _finite("sample_hz", sample_hz)
    lines = ['name = "shaper_design"', "[clock]", f"frequency_hz = {rate * _CLOCKS_PER_SAMPLE!r}", f"sample_hz = {rate!r}"]
    lines += ["[fixed_point]", *_keys(fixed_point)]
    lines += ["[[axis]]", 'name = "x"', 'unit = "m"', "counts_per_unit = 1000000", "[axis.shaper]", *_keys(shaper)]
    for index, mode in enumerate(_listed(modes)):
        keys = _mode(index, mode)
        if frequency_band is not None:
            keys.setdefault("frequency_band", frequency_band)
        if damping_band is not None:
            keys.setdefault("damping_band", list(damping_band))
        lines += ["[[axis.mode]]", *_keys(keys)]
    return "\n".join(lines) + "\n"


def _listed(modes: Iterable[Mode]) -> List[Mode]:
    """The modes, also if one alone was given."""
    if isinstance(modes, Mapping):
        return [modes]
    listed: List[Any] = list(modes)
    if len(listed) == 2 and all(isinstance(number, Real) for number in listed):
        return [(float(listed[0]), float(listed[1]))]
    return listed


def _mode(index: int, mode: Mode) -> "dict[str, Any]":
    if isinstance(mode, Mapping):
        unknown = [key for key in mode if key not in _MODE_KEYS]
        if unknown:
            raise InputError(f"modes[{index}]: found the key {unknown[0]!r}; allowed: {', '.join(_MODE_KEYS)}", remedy="remove the key")
        return dict(mode)
    frequency_hz = getattr(mode, "frequency_hz", None)
    if frequency_hz is not None:
        return {"frequency_hz": frequency_hz, "damping": getattr(mode, "damping", None)}
    try:
        frequency_hz, damping = mode
    except (TypeError, ValueError):
        raise InputError(
            f"modes[{index}]: found {mode!r}; allowed: a pair of frequency in Hz and damping ratio, or a mapping with those keys",
            remedy="write [(40.0, 0.05), (90.0, 0.02)]",
        ) from None
    return {"frequency_hz": frequency_hz, "damping": damping}


def _keys(keys: Mapping[str, Any]) -> List[str]:
    return [f"{key} = {_value(key, value)}" for key, value in keys.items() if value is not None]


def _value(key: str, value: Any) -> str:
    if isinstance(value, str):
        return json.dumps(value)
    if isinstance(value, bool):
        raise InputError(f"{key}: found {value}; allowed: a number or a word", remedy=f"leave {key} out for its default")
    if isinstance(value, Integral):
        return str(int(value))
    if isinstance(value, Real):
        return repr(_finite(key, value))
    if hasattr(value, "__iter__"):
        return "[" + ", ".join(_value(key, item) for item in value) + "]"
    raise InputError(f"{key}: found {value!r}; allowed: a number, a word, or a list of them", remedy=f"leave {key} out for its default")


def _finite(key: str, value: Any) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise InputError(f"{key}: found {value!r}; allowed: a number", remedy=f"give {key} as a number") from None
    if not math.isfinite(number):
        raise InputError(f"{key}: found {number}; allowed: a finite number", remedy=f"give {key} a finite value")
    return number
