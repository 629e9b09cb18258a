"""The console scripts: exit status, output, signals, and what they find without the source tree."""

import json
import os
import signal
import subprocess
import time
from pathlib import Path

import pytest
from support import STEP_LOG, XY_STAGE, run, started, vcd

NO_PROGRAM = "/no/such/program"


def test_first_steps_of_the_tutorial(tmp_path: Path) -> None:
    found = run("posicast", "identify", STEP_LOG, "--joint", "--plot", tmp_path / "modes.svg")
    assert found.returncode == 0, found.stderr
    assert "6.8" in found.stdout and (tmp_path / "modes.svg").read_text().startswith("<svg")
    machine = tmp_path / "arm.toml"
    assert run("posicast", "new", "--joint", "--from-log", STEP_LOG, machine).returncode == 0
    design = run("posicast", "design", machine)
    assert "axis elbow: mzv, 9 impulses, duration 149.2251 ms" in design.stdout
    generated = run("posicast", "generate", machine, "-o", tmp_path / "arm")
    assert generated.returncode == 0, generated.stderr
    assert list((tmp_path / "arm" / "rtl").glob("arm_*taps.v"))


def test_help_version_and_usage() -> None:
    shown = run("posicast", "--version")
    assert (shown.returncode, shown.stdout.split()[0]) == (0, "posicast")
    usage = run("posicast", "--help")
    assert usage.returncode == 0 and "Usage: posicast [OPTIONS] <COMMAND>" in usage.stdout
    wrong = run("posicast", "desing", XY_STAGE)
    assert wrong.returncode == 2 and "design" in wrong.stderr and wrong.stdout == ""


def test_exit_status_of_input_checks_and_missing_tools(tmp_path: Path) -> None:
    missing_file = run("posicast", "design", tmp_path / "none.toml")
    assert missing_file.returncode == 2 and "help: name a machine file" in missing_file.stderr
    noise = tmp_path / "noise.csv"
    noise.write_text("time_s,command,response\n" + "".join(f"{i / 100},{int(i > 9)},0\n" for i in range(200)))
    assert run("posicast", "identify", noise).returncode in (1, 2)
    doctor = run("posicast", "doctor", "--json", VERILATOR=NO_PROGRAM)
    assert doctor.returncode == 1 and "verilator" in json.loads(doctor.stdout)["missing"]
    wanted = run("posicast", "run", XY_STAGE, "-o", tmp_path / "xy", "--simulator", "verilator", VERILATOR=NO_PROGRAM)
    assert wanted.returncode == 3 and NO_PROGRAM in wanted.stderr and not (tmp_path / "xy").exists()


def test_missing_simulator_is_named_with_its_package(tmp_path: Path) -> None:
    empty = tmp_path / "empty"
    empty.mkdir()
    wanted = run("posicast", "run", XY_STAGE, "-o", tmp_path / "xy", "--simulator", "verilator", PATH=str(empty), VERILATOR="")
    assert wanted.returncode == 3 and "apt-get install" in wanted.stderr and "verilator" in wanted.stderr


def test_a_closed_pipe_is_no_error() -> None:
    design = started("posicast", "schema", "report", stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert design.stdout is not None and design.stderr is not None
    design.stdout.close()
    assert design.stderr.read() == "" and design.wait(timeout=60) == 0


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_the_program_and_leaves_nothing(number: signal.Signals, tmp_path: Path) -> None:
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    words = ["verify", XY_STAGE, "--simulator", "rusthdl", "--cycles", 10**10]
    process = started("posicast", *words, stderr=subprocess.PIPE, env={**os.environ, "TMPDIR": str(scratch)})
    catches(process.pid, signal.SIGTERM)
    time.sleep(0.3)
    process.send_signal(number)
    _, message = process.communicate(timeout=20)
    assert process.returncode == 128 + number and f"ended by {number.name}" in message
    assert list(scratch.iterdir()) == []


def catches(pid: int, number: signal.Signals) -> None:
    """Wait until a process has a handler for a signal, which Python itself does not have for SIGTERM."""
    for _ in range(600):
        status = Path(f"/proc/{pid}/status").read_text()
        caught = next(line for line in status.splitlines() if line.startswith("SigCgt:"))
        if int(caught.split()[1], 16) >> (number - 1) & 1:
            return
        time.sleep(0.05)
    raise TimeoutError(f"no handler for {number.name}")


def test_wavecmp(tmp_path: Path) -> None:
    a, b, other = tmp_path / "a.vcd", tmp_path / "b.vcd", tmp_path / "other.vcd"
    a.write_text(vcd("1010"))
    b.write_text(vcd("1011"))
    other.write_text(vcd("1010").replace("top", "bench").replace("word", "sum"))
    assert run("wavecmp", a, a).returncode == 0
    differs = run("wavecmp", a, b, "--json")
    assert differs.returncode == 1 and json.loads(differs.stdout)["differences"][0]["signal"] == "top.word"
    assert run("wavecmp", a, other).returncode == 2
    assert run("wavecmp", a, tmp_path / "none.vcd").returncode == 2
    assert run("wavecmp", "--schema").stdout.rstrip().endswith("}")
    assert run("wavecmp", "--version").stdout.startswith("wavecmp ")


def test_wavecmp_ends_at_ctrl_c(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    process = started("wavecmp", pipe, pipe)
    # Nobody writes: it waits for the file.
    while os.readlink(f"/proc/{process.pid}/exe").find("python") < 0:
        time.sleep(0.05)
    time.sleep(1)
    process.send_signal(signal.SIGINT)
    assert process.wait(timeout=10) == -signal.SIGINT
