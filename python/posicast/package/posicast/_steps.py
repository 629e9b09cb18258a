"""Generating Verilog, comparing it with the model, and the whole way from a machine file to a verdict."""

from __future__ import annotations

import json
import logging
import os
import subprocess
import sys
from dataclasses import dataclass
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple, Union

from . import _errors
from ._errors import CheckFailed, PosicastError
from ._machine import Machine, Path

#: Called with the name of the current work, the number of its steps that are done, and of all its steps; ``None`` if that is unknown.
Progress = Callable[[str, int, Optional[int]], None]

_LOG = logging.getLogger("posicast")
#: Time in s in which an interrupted step must remove its files and end its programs.
_PATIENCE_S = 20.0


@dataclass(frozen=True)
class Result:
    """The result of a step; a check that fails is a result, too."""

    #: All figures, as the command with ``--json`` prints them.
    document: Dict[str, Any]
    #: Why a check failed; ``None`` if all hold.
    failed: Optional[str]
    #: Warnings and notes, which the logger ``posicast`` gets as well.
    messages: List[str]

    @property
    def passed(self) -> bool:
        """Whether every check holds."""
        return self.failed is None

    def require(self) -> "Result":
        """Return this result.

        Raises
        ------
        CheckFailed
            If a check failed.
        """
        if self.failed is not None:
            raise CheckFailed(self.failed, remedy="`document` has the details")
        return self


def generate(
    machine: Union[Machine, Path],
    output: Optional[Path] = None,
    *,
    servo_hz: Optional[float] = None,
    progress: Optional[Progress] = None,
) -> Result:
    """Write the Verilog of a machine, with its projects, drivers and documents, into a folder.

    Parameters
    ----------
    machine
        A machine, or its file.
    output
        Folder: new, empty, or written by posicast before; by default the machine's name.
    servo_hz
        Rate of LinuxCNC's servo thread in Hz, for files of LinuxCNC.
    progress
        Called while it works, in this thread.

    Raises
    ------
    InputError
        For files that cannot be read, designed or written.
    KeyboardInterrupt
        On Ctrl-C; nothing is left behind.
    """
    return _step("generate", {"machine": _file(machine), "output": _folder(output), "servo_hz": servo_hz}, progress)


def verify(
    source: Union[Machine, Path],
    *,
    simulator: Optional[str] = None,
    blocks: Sequence[str] = (),
    cycles: Optional[int] = None,
    seed: Optional[int] = None,
    edited: bool = False,
    progress: Optional[Progress] = None,
) -> Result:
    """Compare the Verilog of a machine, or of a generated folder, with the bit-exact model in every clock.

    Parameters
    ----------
    source
        A machine, its file, or a folder that :func:`generate` or :func:`run` wrote.
    simulator
        ``verilator``, ``icarus`` or ``rusthdl``; by default Verilator, or RustHDL's own, the weaker check, where that is missing.
    blocks
        Only these blocks, such as ``["shaper"]``.
    cycles
        Clocks to compare.
    seed
        Seed of the stimuli.
    edited
        Whether edited Verilog of the folder is judged.
    progress
        Called while it works, in this thread.

    Raises
    ------
    InputError
        For a source or options that are wrong.
    MissingTool
        If the simulator is not installed.
    """
    request = {
        "source": _file(source),
        "simulator": simulator,
        "blocks": [str(block) for block in blocks],
        "cycles": _count("cycles", cycles, 1),
        "seed": _count("seed", seed, 0),
        "edited": bool(edited),
    }
    return _step("verify", request, progress)


def run(
    machine: Union[Machine, Path],
    output: Optional[Path] = None,
    *,
    move: Union[None, float, Mapping[str, float]] = None,
    speed: Union[None, float, Mapping[str, float]] = None,
    command: Optional[Path] = None,
    contour: Optional[Path] = None,
    radius: Optional[float] = None,
    simulator: Optional[str] = None,
    cycles: Optional[int] = None,
    seed: Optional[int] = None,
    progress: Optional[Progress] = None,
) -> Result:
    """Go the whole way from a machine file to a verdict: design, Verilog, simulation, comparison, estimate.

    Parameters
    ----------
    machine, output, progress
        As for :func:`generate`; the folder also has the evidence, with ``report.html``.
    move, speed
        Distance and speed of the move, in the axes' units: one number, or one for each axis by its name.
    command
        A CSV file with the columns ``time_s`` and ``position``, instead of a move.
    contour, radius
        Path of the closed loop instead of the circle: ``circle``, ``square``, a CSV file of points, or G-code; and its radius.
    simulator, cycles, seed
        As for :func:`verify`.

    Raises
    ------
    InputError
        For files and options that are wrong.
    MissingTool
        If a simulator that was asked for is not installed.
    KeyboardInterrupt
        On Ctrl-C; nothing is left behind.
    """
    request = {
        "machine": _file(machine),
        "output": _folder(output),
        "distance": _per_axis(move),
        "speed": _per_axis(speed),
        "command": _folder(command),
        "contour": _folder(contour),
        "radius": radius,
        "simulator": simulator,
        "cycles": _count("cycles", cycles, 1),
        "seed": _count("seed", seed, 0),
    }
    return _step("run", request, progress)


def _file(source: Union[Machine, Path]) -> str:
    return source.path if isinstance(source, Machine) else os.fspath(source)


def _folder(path: Optional[Path]) -> Optional[str]:
    return None if path is None else os.fspath(path)


def _count(name: str, value: Optional[int], least: int) -> Optional[int]:
    if value is not None and not (isinstance(value, int) and least <= value < 1 << 63):
        raise _errors.InputError(f"{name}: found {value!r}; allowed: a whole number from {least} on", remedy=f"leave {name} out for its default")
    return value


def _per_axis(figures: Union[None, float, Mapping[str, float]]) -> Optional[str]:
    if figures is None:
        return None
    if isinstance(figures, Mapping):
        return ",".join(f"{axis}={float(figure)!r}" for axis, figure in figures.items())
    return repr(float(figures))


def _step(name: str, request: Dict[str, Any], progress: Optional[Progress]) -> Result:
    """Run a step in a process of its own, so that Ctrl-C can end the simulators that it calls and remove its files."""
    process = subprocess.Popen(
        [sys.executable, "-m", "posicast._worker"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        encoding="utf-8",
        # A terminal sends Ctrl-C to its whole group, and a second signal would end the step before it has tidied up.
        start_new_session=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(path or os.getcwd() for path in sys.path)},
    )
    try:
        return _followed(process, json.dumps({"step": name, **request}), progress)
    except BaseException:
        if process.poll() is None:
            process.terminate()
        raise
    finally:
        try:
            process.wait(_PATIENCE_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        for pipe in (process.stdin, process.stdout):
            if pipe is not None:
                pipe.close()


def _followed(process: "subprocess.Popen[str]", request: str, progress: Optional[Progress]) -> Result:
    assert process.stdin is not None and process.stdout is not None
    process.stdin.write(request + "\n")
    process.stdin.flush()
    messages: List[str] = []
    parts: Dict[int, Tuple[str, int, Optional[int]]] = {}
    for text in process.stdout:
        try:
            line: Dict[str, Any] = json.loads(text)
        except ValueError:
            # A program that the step called wrote on its standard output.
            _LOG.info("%s", text.rstrip())
            continue
        if "say" in line:
            messages.append(line["say"])
            _LOG.log(logging.WARNING if line["say"].startswith("warning:") else logging.INFO, "%s", line["say"])
        elif "result" in line:
            return Result(line["result"], line["failed"], messages)
        elif "error" in line:
            error: Dict[str, Any] = line["error"]
            raised = getattr(_errors, error.pop("class"))
            raise raised(**error)
        elif progress is not None:
            part = _part(parts, line)
            if part is not None:
                progress(*part)
    status = process.wait(_PATIENCE_S)
    raise PosicastError(
        f"the process of the step ended with status {status} and no result", remedy="run the same command of `posicast`, and report the bug"
    )


def _part(parts: Dict[int, Tuple[str, int, Optional[int]]], line: Dict[str, Any]) -> Optional[Tuple[str, int, Optional[int]]]:
    """Keep the parts of the work that have begun; return the one that a line is about."""
    if "begin" in line:
        number, part = line["begin"], (line["what"], 0, line["steps"])
    elif "reach" in line:
        number = line["reach"]
        part = (parts[number][0], line["done"], parts[number][2])
    elif "rename" in line:
        number = line["rename"]
        part = (line["what"], parts[number][1], parts[number][2])
    else:
        what, done, steps = parts.pop(line["end"])
        return (what, steps, steps) if steps is not None else None
    parts[number] = part
    return part
