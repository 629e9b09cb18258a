"""Design of shapers from modes."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any, Dict, Iterable, List, Mapping, Optional, Sequence, Union

from . import _native
from ._shaper import Shaper
from ._toml import Mode, machine_text

#: Default samples per second of a design; they matter only to its taps, and to kinds that have their impulses on the samples.
SAMPLE_HZ = 1000.0


def design(
    modes: Iterable[Mode],
    kind: str,
    *,
    tolerance: Optional[float] = None,
    command: Optional[Union[str, Sequence[float]]] = None,
    sample_hz: float = SAMPLE_HZ,
    frequency_band: Optional[float] = None,
    damping_band: Optional[Sequence[float]] = None,
    fraction_bits: Optional[int] = None,
    digitise: Optional[str] = None,
    **keys: Any,
) -> Shaper:
    """Design the shaper of an axis.

    Parameters
    ----------
    modes
        Pairs of undamped natural frequency in Hz and damping ratio, or mappings with the keys of ``[[axis.mode]]`` of a machine file,
        or modes of :func:`identify`.
    kind
        Kind of the shaper, such as ``zv``, ``zvd``, ``ei``, ``optimal``: the `kinds
        <https://github.com/posicast/posicast/blob/main/docs/shaper-design.md#the-kinds>`_ with their sources.
    tolerance
        Residual that the kinds with a tolerance leave at the mode, and for which insensitivities are computed; default 0.05.
    command
        Of ``optimal``: bounds of the shaped unit step, ``"positive"`` or lowest and highest partial sum.
    sample_hz
        Samples per second of the taps. The impulses of ``optimal`` and of the smooth kinds lie on these samples.
    frequency_band
        Largest relative error of every mode's frequency, such as 0.1.
    damping_band
        Lowest and highest damping ratio that every mode may have.
    fraction_bits
        Fraction bits of a coefficient, 1 to 16; by default the most that fit.
    digitise
        ``modal`` (the default), ``linear`` or ``nearest``.
    **keys
        Further keys of ``[axis.shaper]``: ``order``, ``epsilon``, ``base``, ``lowest_frequency_hz``, ``amplitude``, ``method``,
        ``ratio_tolerance``, ``taps``, ``prefer``, ``amplitude_bounds``, ``impulses``.

    Raises
    ------
    InputError
        With the key, what is allowed and the remedy: for a mode, a kind or a key that is wrong, and for a shaper that does not exist.

    Examples
    --------
    >>> import posicast
    >>> shaper = posicast.design([(131.1, 0.158)], "zvd")
    >>> shaper
    <Shaper zvd: 3 impulses in 7.725 ms>
    >>> posicast.design([(-3.0, 0.1)], "zv")
    Traceback (most recent call last):
    posicast.InputError: axis.mode.frequency_hz of axis x, mode 1: found -3.0; allowed: at least 0.001, at most 1e9 Hz
    help: give `frequency_hz` a value in this range, without the minus sign
    """
    listed = list(modes) if not isinstance(modes, Mapping) else [modes]
    shaper: Dict[str, Any] = {"kind": kind, "tolerance": tolerance, "command": command, **keys}

    def at(rate: float, bits: Optional[int], method: Optional[str]) -> _native.Design:
        fixed_point = {
            "coefficient_fraction": fraction_bits if bits is None else bits,
            "digitise": digitise if method is None else method,
        }
        text = machine_text(listed, shaper, rate, fixed_point, frequency_band, damping_band)
        return _native.design_text(text)

    return Shaper(at(sample_hz, None, None), at)


def optimal(
    modes: Iterable[Mode],
    *,
    sample_hz: float,
    frequency_band: Optional[float] = None,
    damping_band: Optional[Sequence[float]] = None,
    tolerance: Optional[float] = None,
    command: Optional[Union[str, Sequence[float]]] = None,
    **keys: Any,
) -> Shaper:
    """Design the shortest shaper on the sample grid for modes that are not known exactly.

    Parameters and errors are those of :func:`design`. ``shaper.certify()["shorter"]`` is the proof that no shorter one exists: the dual
    solution of the cone program, checked in exact arithmetic; ``points`` are the points of the bands with their weights.

    Examples
    --------
    >>> import posicast
    >>> shaper = posicast.optimal([(40.0, 0.02)], sample_hz=1000.0, frequency_band=0.1, tolerance=0.05)
    >>> shaper.certify()["shorter"]["proven"]
    True
    """
    return design(
        modes,
        "optimal",
        tolerance=tolerance,
        command=command,
        sample_hz=sample_hz,
        frequency_band=frequency_band,
        damping_band=damping_band,
        **keys,
    )


def compare(
    modes: Iterable[Mode],
    *,
    band: float = 0.1,
    tolerance: Optional[float] = None,
    sample_hz: float = SAMPLE_HZ,
) -> "Comparison":
    """Design every kind of shaper for the same modes, and compare duration, worst residual and taps.

    Parameters
    ----------
    modes
        As for :func:`design`.
    band
        Relative error of every frequency within which the worst residual is taken, 0 to 0.9.
    tolerance
        Residual that counts as small enough; default 0.05.
    sample_hz
        Samples per second of the taps.

    Raises
    ------
    InputError
        For modes, bands and tolerances that are wrong.

    Examples
    --------
    >>> import posicast
    >>> table = posicast.compare([(40.0, 0.02)])
    >>> table["zvd"]["taps"], table.shortest["kind"]
    (5, 'optimal ±1')
    """
    if not 0 <= band <= 0.9:
        from ._errors import InputError

        raise InputError(f"band: found {band}; allowed: 0 to 0.9", remedy="10 % is 0.1")
    listed = list(modes) if not isinstance(modes, Mapping) else [modes]
    text = machine_text(listed, {"kind": "zv", "tolerance": tolerance}, sample_hz, {}, None, None)
    (axis,) = json.loads(_native.compare_text(text, 100 * band))["axes"]
    return Comparison(rows=axis["kinds"], missing={row["kind"]: row["reason"] for row in axis["missing"]}, band=band)


@dataclass(frozen=True)
class Comparison:
    """Every kind of shaper for the same modes, the shortest first.

    ``rows`` can be given to ``pandas.DataFrame``; their keys are ``kind``, ``duration_s``, ``delay_s``, ``worst_residual``, ``taps``,
    ``partial_sum_min``, ``partial_sum_max``, ``pareto``, ``keeps_tolerance`` and ``shortest``. ``missing`` has the reason for each kind
    that cannot be designed.
    """

    rows: List[Dict[str, Any]]
    missing: Dict[str, str]
    band: float

    def __getitem__(self, kind: str) -> Dict[str, Any]:
        """The row of a kind."""
        for row in self.rows:
            if row["kind"] == kind:
                return row
        raise KeyError(self.missing.get(kind, kind))

    @property
    def shortest(self) -> Optional[Dict[str, Any]]:
        """The row of the shortest kind that keeps the tolerance in the whole band; ``None`` if none does."""
        return next((row for row in self.rows if row["shortest"]), None)

    def _cells(self) -> List[List[str]]:
        heading = ["", "kind", "duration ms", "worst residual %", "taps", "partial sums", "delay ms"]
        return [heading] + [
            [
                "*" if row["pareto"] else "",
                row["kind"],
                f"{1e3 * row['duration_s']:.4f}",
                f"{100 * row['worst_residual']:.3f}",
                str(row["taps"]),
                f"{row['partial_sum_min']:.3f} … {row['partial_sum_max']:.3f}",
                f"{1e3 * row['delay_s']:.4f}",
            ]
            for row in self.rows
        ]

    def __str__(self) -> str:
        cells = self._cells()
        widths = [max(len(row[column]) for row in cells) for column in range(len(cells[0]))]
        lines = [
            "  ".join(cell.ljust(width) if column < 2 else cell.rjust(width) for column, (cell, width) in enumerate(zip(row, widths)))
            for row in cells
        ]
        return "\n".join(line.rstrip() for line in lines)

    def _repr_html_(self) -> str:
        """The table in a notebook."""
        from html import escape

        head, *rows = self._cells()
        body = "".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
        return "<table><tr>" + "".join(f"<th>{escape(cell)}</th>" for cell in head) + f"</tr>{body}</table>"
