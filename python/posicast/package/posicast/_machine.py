"""Machine files, their shapers, and the simulation of their axes."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Dict, List, Mapping, Optional, Union

import numpy as np

from . import _native
from ._arrays import samples
from ._design import Comparison
from ._errors import InputError
from ._shaper import Shaper

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

Path = Union[str, "os.PathLike[str]"]


class Machine:
    """A machine file that was read and checked: :meth:`load` makes it.

    Examples
    --------
    >>> import posicast
    >>> posicast.Machine.load("none.toml")
    Traceback (most recent call last):
    posicast.InputError: cannot read the machine file `none.toml`: No such file or directory (os error 2)
    help: name a machine file, such as examples/xy-stage.toml; `posicast new FILE` writes one
    """

    def __init__(self, path: str, native: _native.MachineFile) -> None:
        self.path = path
        self._native = native

    @classmethod
    def load(cls, path: Path) -> "Machine":
        """Read and check a machine file.

        Raises
        ------
        InputError
            With file, line, key and remedy: for a file that is missing or wrong.
        """
        name = os.fspath(path)
        return cls(name, _native.MachineFile(name))

    @property
    def name(self) -> str:
        """Name of the machine, which is the prefix of its Verilog."""
        return self._native.name

    @property
    def sample_hz(self) -> float:
        """Samples per second."""
        return self._native.sample_hz

    @property
    def axes(self) -> Dict[str, str]:
        """Unit of each axis by its name, in the order of the file."""
        return dict(self._native.axes)

    def __repr__(self) -> str:
        return f"<Machine {self.name}: axes {', '.join(self.axes)}>"

    def shapers(self) -> Dict[str, Shaper]:
        """Design the shaper of each axis.

        Raises
        ------
        InputError
            With the key of the file that causes it: for a shaper that does not exist.
        """
        return {native.axis: Shaper(native, None) for native in self._native.designs()}

    def design(self, *, certify: bool = False) -> Dict[str, Any]:
        """Return all figures of the shapers, as ``posicast design --json`` has them."""
        document: Dict[str, Any] = json.loads(self._native.document(certify))
        return document

    def compare(self, *, band: float = 0.1) -> Dict[str, Comparison]:
        """Compare every kind of shaper on each axis, for frequencies that are off by up to ``band``."""
        if not 0 <= band <= 0.9:
            raise InputError(f"band: found {band}; allowed: 0 to 0.9", remedy="10 % is 0.1")
        axes: List[Dict[str, Any]] = json.loads(self._native.compare(100 * band))["axes"]
        missing = ({row["kind"]: row["reason"] for row in axis["missing"]} for axis in axes)
        return {axis["name"]: Comparison(axis["kinds"], reasons, band) for axis, reasons in zip(axes, missing)}


@dataclass(frozen=True)
class AxisMotion:
    """An axis that followed its command; all arrays have the shape ``(samples,)``."""

    #: Times in s.
    time: NDArray[np.float64]
    #: The command in the axis's unit, as the words have it.
    command: NDArray[np.float64]
    #: The shaped command in the axis's unit, from the words of the bit-exact model.
    shaped: NDArray[np.float64]
    #: Position of the simulated machine that follows the shaped command, in the axis's unit.
    position: NDArray[np.float64]
    #: Position of the machine that follows the command itself.
    position_unshaped: NDArray[np.float64]
    #: Amplitude of the ringing after the end of the command, with the shaper and without it, in the axis's unit.
    ringing: float
    ringing_unshaped: float
    #: Input and output of the shaper in words of the hardware.
    command_words: NDArray[np.int64]
    shaped_words: NDArray[np.int64]
    #: The floating-point design in words, and the largest difference from ``shaped_words`` that rounding explains.
    float_words: NDArray[np.float64]
    bound_lsb: float


def simulate(machine: Union[Machine, Path], command: Optional[Mapping[str, ArrayLike]] = None) -> Dict[str, AxisMotion]:
    """Pass a command through the bit-exact model and the floating-point design to the simulated machine.

    Parameters
    ----------
    machine
        A machine, or its file.
    command
        Positions of each axis by its name, in the axis's unit, one per sample; shorter ones stand at their end. By default the move of
        each axis that ``posicast simulate`` makes.

    Returns
    -------
    dict of AxisMotion
        The motion of each axis by its name.

    Raises
    ------
    InputError
        For axes that do not exist or lack a command, for NaN, and for positions beyond the range of a word.
    """
    if not isinstance(machine, Machine):
        machine = Machine.load(machine)
    positions = None
    if command is not None:
        names = list(machine.axes)
        if set(command) != set(names):
            raise InputError(f"command: found the axes {sorted(command)}; allowed: {names}", remedy="give the positions of every axis by its name")
        positions = [samples(f"command[{name!r}]", command[name]) for name in names]
    moved = machine._native.simulate(positions)
    return {name: _motion(motion, machine.sample_hz) for name, motion in moved.items()}


def _motion(motion: Dict[str, Any], sample_hz: float) -> AxisMotion:
    lsb = motion["lsb"]
    words = motion["command_words"]
    return AxisMotion(
        time=np.arange(len(words)) / sample_hz,
        command=words * lsb,
        shaped=motion["shaped_words"] * lsb,
        position=motion["position_lsb"] * lsb,
        position_unshaped=motion["unshaped_lsb"] * lsb,
        ringing=motion["ringing_lsb"] * lsb,
        ringing_unshaped=motion["ringing_unshaped_lsb"] * lsb,
        command_words=words,
        shaped_words=motion["shaped_words"],
        float_words=motion["float_words"],
        bound_lsb=motion["bound_lsb"],
    )
