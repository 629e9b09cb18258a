"""Machine files, logs, simulation, the steps and waveforms."""

import json
from pathlib import Path
from typing import Callable, List, Optional, Tuple

import numpy as np
import posicast
import pytest
import wavecmp
from support import EXAMPLES, STEP_LOG, XY_STAGE, run, vcd


def test_a_machine_has_the_shapers_of_the_command() -> None:
    machine = posicast.Machine.load(XY_STAGE)
    assert (machine.name, machine.axes, machine.sample_hz) == ("xy_stage", {"x": "m", "y": "m"}, 10_000.0)
    printed = json.loads(run("posicast", "design", XY_STAGE, "--json").stdout)
    assert machine.design() == printed
    for axis in printed["axes"]:
        shaper = machine.shapers()[axis["name"]]
        assert shaper.times.tolist() == [impulse["time_s"] for impulse in axis["impulses"]]
        table = shaper.taps()
        assert table.coefficients.tolist() == [tap["coefficient"] for tap in axis["quantised"]["taps"]]
        assert table.delays.tolist() == [tap["delay_samples"] for tap in axis["quantised"]["taps"]]
    with pytest.raises(posicast.InputError, match="machine file"):
        machine.shapers()["x"].taps(5000.0)


def test_the_same_modes_give_the_same_taps_without_a_file() -> None:
    of_file = posicast.Machine.load(XY_STAGE).shapers()["x"]
    alone = posicast.design(of_file.modes, "zvd", sample_hz=10_000.0)
    assert np.array_equal(alone.impulses, of_file.impulses)
    assert alone.taps().coefficients.sum() == 1 << alone.taps().fraction_bits


def test_every_example_loads() -> None:
    for path in sorted(EXAMPLES.glob("*.toml")):
        machine = posicast.Machine.load(path)
        assert machine.axes and len(machine.shapers()) == len(machine.axes), path


def test_simulation_is_the_model_and_the_command(tmp_path: Path) -> None:
    machine = posicast.Machine.load(XY_STAGE)
    time = np.arange(4000) / machine.sample_hz
    ramp = np.minimum(time * 0.05, 0.01)
    moved = posicast.simulate(machine, {"x": ramp, "y": 0 * ramp})
    x = moved["x"]
    assert x.command == pytest.approx(ramp, abs=x.command[-1] / x.command_words[-1])
    assert x.shaped == pytest.approx(x.shaped_words * (x.command[-1] / x.command_words[-1]), rel=1e-12)
    assert np.array_equal(x.shaped_words, machine.shapers()["x"].taps().apply(x.command_words))
    assert np.abs(x.shaped_words - x.float_words).max() <= x.bound_lsb
    assert x.ringing < 0.05 * x.ringing_unshaped
    assert x.position[-1] == pytest.approx(0.01, rel=1e-4)
    by_default = posicast.simulate(XY_STAGE)
    printed = json.loads(run("posicast", "simulate", XY_STAGE, "-o", tmp_path / "move.vcd", "--json").stdout)
    for axis in printed["axes"]:
        assert by_default[axis["name"]].ringing == pytest.approx(axis["residual_displacement"], rel=1e-9)
    with pytest.raises(posicast.InputError, match="axes"):
        posicast.simulate(machine, {"x": ramp})
    with pytest.raises(posicast.InputError, match="32 bits"):
        posicast.simulate(machine, {"x": ramp + 1e6, "y": ramp})


def test_a_log_gives_the_modes_of_the_command(tmp_path: Path) -> None:
    found = posicast.identify(STEP_LOG)
    printed = json.loads(run("posicast", "identify", STEP_LOG, "--json").stdout)
    assert found.document == printed
    first = found.modes[0]
    assert first.frequency_interval_hz[0] < 6.8 < first.frequency_interval_hz[1]
    assert 0.02 < found.shaper("ei").residual(first.frequency_hz, first.damping) <= 0.05
    assert found.shaper().kind == found.recommended[0]["kind"]
    assert any("fit" in name or "measured" in name for panel in found.panels for name in panel.curves)
    table = np.loadtxt(STEP_LOG, delimiter=",", skiprows=1)
    of_array = posicast.identify(table, columns=["time_s", "command_rad", "response_rad"])
    assert [mode.frequency_hz for mode in of_array.modes] == [mode.frequency_hz for mode in found.modes]
    quiet = table.copy()
    quiet[:, 2] = 1e-6 * np.random.default_rng(3).normal(size=len(quiet))
    with pytest.raises((posicast.CheckFailed, posicast.InputError)):
        posicast.identify(quiet, columns=["time_s", "command_rad", "response_rad"])


def test_generate_and_verify_with_progress(tmp_path: Path) -> None:
    written = posicast.generate(XY_STAGE, tmp_path / "xy")
    assert written.passed and (tmp_path / "xy" / "posicast.json").is_file()
    assert written.document["name"] == "xy_stage"
    parts: List[Tuple[str, int, Optional[int]]] = []
    compared = posicast.verify(
        XY_STAGE, simulator="rusthdl", blocks=["shaper"], cycles=20_000, seed=3, progress=lambda *part: parts.append(part)
    )
    assert compared.require().document["result"] == "match" and compared.document["seed"] == 3
    assert parts and all(total is None or done <= total for _, done, total in parts)
    with pytest.raises(posicast.InputError, match="allowed: verilator, icarus, rusthdl"):
        posicast.verify(XY_STAGE, simulator="modelsim")
    with pytest.raises(posicast.InputError, match="cycles"):
        posicast.verify(XY_STAGE, cycles=-1)


def test_an_edited_folder_fails_and_an_error_of_the_callback_ends_the_step(tmp_path: Path) -> None:
    folder = tmp_path / "xy"
    posicast.generate(XY_STAGE, folder)
    rom = next((folder / "rtl").glob("*_x_*taps.v"))
    text = rom.read_text()
    rom.write_text(text.replace("'h", "'h0", 1) if text.count("'h") else text + "\n// edited\n")
    result = posicast.verify(folder, simulator="icarus", blocks=["shaper"], cycles=2000)
    assert not result.passed
    with pytest.raises(posicast.CheckFailed):
        result.require()

    def broken(what: str, done: int, steps: Optional[int]) -> None:
        raise ZeroDivisionError(what)

    with pytest.raises(ZeroDivisionError):
        posicast.verify(XY_STAGE, simulator="rusthdl", cycles=10**10, progress=broken)


def test_a_missing_tool_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("VERILATOR", "/no/such/verilator")
    with pytest.raises(posicast.MissingTool, match="/no/such/verilator"):
        posicast.run(XY_STAGE, tmp_path / "xy", simulator="verilator")
    assert not (tmp_path / "xy").exists()


def test_waveforms_as_data(tmp_path: Path) -> None:
    a, b = tmp_path / "a.vcd", tmp_path / "b.vcd"
    a.write_text(vcd("1010"))
    b.write_text(vcd("1011"))
    assert wavecmp.compare(a, a)
    result = wavecmp.compare(a, b)
    assert not result and result.verdict == "different" and result.differences[0]["signal"] == "top.word"
    assert wavecmp.compare(a, b, tolerance={"top.word": 1}) and wavecmp.compare(a, b, tolerance="1")
    assert wavecmp.compare(a, b, ignore=["word"]).verdict in ("equal", "incomparable")
    printed = json.loads(run("wavecmp", a, b, "--json").stdout)
    assert result.document == printed
    refused: List[Callable[[], object]] = [
        lambda: wavecmp.compare(a, tmp_path / "none.vcd"),
        lambda: wavecmp.compare(a, b, only="word"),
        lambda: wavecmp.compare(a, b, edge="sideways"),
        lambda: wavecmp.compare(a, "-"),
        lambda: wavecmp.compare(a, b, clock="no_such_clock"),
    ]
    for wrong in refused:
        with pytest.raises(wavecmp.WaveError):
            wrong()
    assert wavecmp.schema()["type"] == "object"
