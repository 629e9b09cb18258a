"""Compare two waveforms, VCD or FST, of any tools: which signals differ, since when, and how often.

>>> import pathlib, tempfile, wavecmp
>>> def recording(word):
...     return ("$scope module top $end $var wire 1 ! clk $end $var wire 4 # y $end $upscope $end $enddefinitions $end\\n"
...             f"#0\\n0!\\nb{word} #\\n#5\\n1!\\n#10\\n0!\\n#15\\n1!\\n")
>>> folder = pathlib.Path(tempfile.mkdtemp())
>>> a, b = folder / "a.vcd", folder / "b.vcd"
>>> _ = a.write_text(recording("1010")), b.write_text(recording("1011"))
>>> result = wavecmp.compare(a, b)
>>> result.verdict, [difference["signal"] for difference in result.differences]
('different', ['top.y'])
>>> bool(wavecmp.compare(a, b, tolerance="1"))
True
"""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union

from . import _native

__all__ = ["Comparison", "WaveError", "compare", "schema"]
__version__ = _native.version()

Path = Union[str, "os.PathLike[str]"]


class WaveError(ValueError):
    """A file cannot be read, or an option is wrong; the message says what is allowed."""


@dataclass(frozen=True)
class Comparison:
    """The result of a comparison; it is true if the files are equal."""

    #: All figures, as ``wavecmp --json`` prints them; :func:`schema` describes them.
    document: Dict[str, Any]

    @property
    def verdict(self) -> str:
        """``equal``, ``different``, or ``incomparable`` for files with nothing in common."""
        return str(self.document["result"])

    @property
    def differences(self) -> List[Dict[str, Any]]:
        """The signals that differ: ``signal``, the first difference and its time, how many samples differ, and the values."""
        differences: List[Dict[str, Any]] = self.document["differences"]
        return differences

    def __bool__(self) -> bool:
        return self.verdict == "equal"


def compare(
    a: Path,
    b: Path,
    *,
    clock: Optional[str] = None,
    edge: Optional[str] = None,
    reset: Optional[str] = None,
    raw: bool = False,
    start: Optional[str] = None,
    end: Optional[str] = None,
    time_tolerance: Optional[str] = None,
    glitch: Optional[str] = None,
    latency: Optional[Mapping[str, Union[int, str]]] = None,
    map: Union[None, Mapping[str, str], Sequence[Tuple[str, str]]] = None,
    root_a: Optional[str] = None,
    root_b: Optional[str] = None,
    only: Sequence[str] = (),
    ignore: Sequence[str] = (),
    require_all: bool = False,
    tolerance: Union[None, float, str, Mapping[str, Union[float, str]]] = None,
    view: Optional[Mapping[str, str]] = None,
    unknown: Optional[str] = None,
    allow_truncated: bool = False,
    first: bool = False,
    explain: bool = False,
) -> Comparison:
    """Compare two recordings, sampled at the clock, or at every change without one.

    Parameters
    ----------
    a, b
        VCD, also in gzip, xz or zstd, or FST.
    clock, edge
        Sample at the edges of this signal, ``rising`` or ``falling``; by default the rising edges of the only clock.
    reset
        Compare from the release of this signal on, ``NAME`` or ``NAME=0``; ``none``: from the start.
    raw
        Compare at every change, also where there is a clock.
    start, end, time_tolerance, glitch
        Times such as ``"10ns"``: the range of the first file, differences that last no longer, and pulses that are removed.
    latency
        Delay of signals in the second file, in samples or as a time.
    map
        Scopes or signals of the first file, and what they are called in the second.
    root_a, root_b
        Scopes below which to compare.
    only, ignore
        Signals that are compared, and that are not: names, their ends, or patterns.
    require_all
        Whether a signal that only one file has is a difference.
    tolerance
        Largest difference that counts as equal, of all signals or of each by its name: ``2`` LSB, ``"0.01abs"`` or ``"0.1%"``.
    view
        How bits are read as numbers: ``signed``, ``unsigned``, ``q15.16``.
    unknown
        How X and Z are compared.
    allow_truncated
        Whether a file may end in the middle.
    first
        Stop at the first difference.
    explain
        Whether the document has how each signal was matched.

    Raises
    ------
    WaveError
        For files that cannot be read, and for wrong options.
    KeyboardInterrupt
        On Ctrl-C.
    """
    words = ["wavecmp"]
    options = {
        "clock": clock, "edge": edge, "reset": reset, "start": start, "end": end, "time-tolerance": time_tolerance, "glitch": glitch,
        "root-a": root_a, "root-b": root_b, "unknown": unknown,
    }  # fmt: skip
    words += [f"--{name}={value}" for name, value in options.items() if value is not None]
    flags = {"raw": raw, "require-all": require_all, "allow-truncated": allow_truncated, "first": first, "explain": explain}
    words += [f"--{name}" for name, is_set in flags.items() if is_set]
    maps = list(map.items()) if isinstance(map, Mapping) else list(map or ())
    pairs: List[Tuple[str, List[Tuple[str, Any]]]] = [
        ("latency", list((latency or {}).items())),
        ("map", maps),
        ("view", list((view or {}).items())),
    ]
    words += [f"--{name}={signal}={value}" for name, values in pairs for signal, value in values]
    if isinstance(tolerance, Mapping):
        words += [f"--tolerance={signal}={amount}" for signal, amount in tolerance.items()]
    elif tolerance is not None:
        words.append(f"--tolerance={tolerance}")
    words += [f"--only={signal}" for signal in _listed("only", only)]
    words += [f"--ignore={signal}" for signal in _listed("ignore", ignore)]
    files = [os.fspath(path) for path in (a, b)]
    if "-" in files:
        raise WaveError("-: the standard input belongs to Python: save it in a file")
    document, error = _native.compare([*words, "--", *files])
    if document is None:
        raise WaveError(error)
    return Comparison(json.loads(document))


def _listed(name: str, signals: Sequence[str]) -> Sequence[str]:
    if isinstance(signals, str):
        raise WaveError(f"{name}: found the text {signals!r}; allowed: a list of names, such as [{signals!r}]")
    return signals


def schema() -> Dict[str, Any]:
    """Return the JSON Schema of :attr:`Comparison.document`."""
    found: Dict[str, Any] = json.loads(_native.schema())
    return found
