"""Wrong input: an exception with the place and the remedy, never a panic, and nothing that Ctrl-C does not end."""

import os
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any, Callable, List

import numpy as np
import posicast
import pytest
from support import XY_STAGE

DESIGN = [
    lambda: posicast.design([(-3.0, 0.1)], "zv"),
    lambda: posicast.design([(0.0, 0.1)], "zv"),
    lambda: posicast.design([(40.0, 1.0)], "zv"),
    lambda: posicast.design([(40.0, -0.1)], "zv"),
    lambda: posicast.design([(float("nan"), 0.1)], "zv"),
    lambda: posicast.design([(40.0, float("inf"))], "zv"),
    lambda: posicast.design([("forty", 0.1)], "zv"),  # type: ignore[list-item]
    lambda: posicast.design([], "zv"),
    lambda: posicast.design([40.0], "zv"),  # type: ignore[list-item]
    lambda: posicast.design([{"frequency": 40.0}], "zv"),
    lambda: posicast.design([(40.0, 0.1)], "zw"),
    lambda: posicast.design([(40.0, 0.1)], 'zv"\nx = "'),
    lambda: posicast.design([(40.0, 0.1)], "zv", sample_hz=-1.0),
    lambda: posicast.design([(40.0, 0.1)], "zv", sample_hz=float("nan")),
    lambda: posicast.design([(40.0, 0.1)], "ei", tolerance=2.0),
    lambda: posicast.design([(40.0, 0.1)], "zv", no_such_key=1),
    lambda: posicast.design([(40.0, 0.1)], "zv", tolerance=True),
    lambda: posicast.design([(40.0, 0.1)], "zv", tolerance=object()),  # type: ignore[arg-type]
    lambda: posicast.design([(600.0, 0.1)], "zv", sample_hz=1000.0),
    lambda: posicast.design([(1e-6, 0.1)], "zv", sample_hz=1000.0),
    lambda: posicast.optimal([(40.0, 0.02)], sample_hz=1000.0, frequency_band=3.0),
    lambda: posicast.compare([(40.0, 0.02)], band=2.0),
    lambda: posicast.compare([(40.0, 0.02)], tolerance=-1.0),
    lambda: posicast.schema("no-such-schema"),
]


@pytest.mark.parametrize("call", DESIGN)
def test_wrong_designs(call: Callable[[], Any]) -> None:
    with pytest.raises(posicast.InputError) as raised:
        call()
    error = raised.value
    assert error.remedy and error.message and error.file is None and "posicast.design" not in str(error)


SHAPER = posicast.design([(40.0, 0.05)], "zvd")
TABLE = SHAPER.taps()
ARRAYS: List[Callable[[], Any]] = [
    lambda: SHAPER.residual(-1.0, 0.1),
    lambda: SHAPER.residual(40.0, 1.0),
    lambda: SHAPER.residual([1.0, 2.0], [0.1, 0.1, 0.1]),
    lambda: SHAPER.residual([1.0, np.nan], 0.1),
    lambda: SHAPER.residual(["a"], 0.1),
    lambda: SHAPER.residual([[1.0], [1.0, 2.0]], 0.1),
    lambda: SHAPER.sensitivity(3),
    lambda: SHAPER.sensitivity(low=2.0, high=1.0),
    lambda: SHAPER.sensitivity(points=10**9),
    lambda: SHAPER.insensitivity(tolerance=0.0),
    lambda: SHAPER.taps(-5.0),
    lambda: SHAPER.taps(fraction_bits=40),
    lambda: SHAPER.taps(digitise="wrong"),
    lambda: SHAPER.apply(np.zeros((3, 3))),
    lambda: SHAPER.apply([0.0, float("nan")]),
    lambda: SHAPER.apply(np.zeros(3, dtype=complex)),
    lambda: SHAPER.apply([0.0], start=float("inf")),
    lambda: TABLE.apply([0.5, 1.5]),
    lambda: TABLE.apply([True, False]),
    lambda: TABLE.apply(np.zeros((2, 2), dtype=np.int32)),
    lambda: TABLE.apply([1 << 40]),
    lambda: TABLE.apply(np.array([1 << 31], dtype=np.uint32)),
    lambda: TABLE.apply([1 << 63]),
    lambda: TABLE.apply([1], word_bits=7),
    lambda: TABLE.apply([1], word_bits=64),
    lambda: TABLE.apply(np.array([40000], dtype=np.int32), word_bits=16),
    lambda: TABLE.apply([1], start=1 << 70),
    lambda: TABLE.apply([1], start=0.5),  # type: ignore[arg-type]
    lambda: TABLE.apply([[1], [1, 2]]),
    lambda: posicast.TapTable([0, 1], [1 << 15, 1 << 15], 16, -1.0),
    lambda: posicast.TapTable([0, 1], [1 << 15, 1 << 15], -1, 1000.0),
    lambda: TABLE.stream(word_bits=16, start=1 << 20),
    lambda: posicast.TapTable([0, 0], [1 << 15, 1 << 15], 16, 1000.0),
    lambda: posicast.TapTable([0], [1 << 15, 1 << 15], 16, 1000.0),
    lambda: posicast.TapTable([0, 1], [1, 2], 16, 1000.0),
    lambda: posicast.TapTable([-1, 1], [1 << 15, 1 << 15], 16, 1000.0),
    lambda: posicast.TapTable([0, 1], [1 << 40, 1 << 15], 16, 1000.0),
    lambda: posicast.TapTable([0, 1 << 20], [1 << 15, 1 << 15], 16, 1000.0).apply([1]),
]


@pytest.mark.parametrize("call", ARRAYS)
def test_wrong_arrays_and_numbers(call: Callable[[], Any]) -> None:
    with pytest.raises(posicast.InputError) as raised:
        call()
    assert raised.value.remedy


def test_arrays_of_any_layout_are_taken() -> None:
    words = np.arange(40, dtype=np.int32)
    assert TABLE.apply(words[::2]).tolist() == TABLE.apply(words[::2].copy()).tolist()
    assert TABLE.apply(words[::-1]).tolist() == TABLE.apply(words[::-1].tolist()).tolist()
    assert TABLE.apply(words.astype(">i4")).tolist() == TABLE.apply(words.astype(np.uint8)).tolist()
    frozen = words.copy()
    frozen.flags.writeable = False
    assert TABLE.apply(frozen).tolist() == TABLE.apply(words).tolist()
    assert TABLE.apply([]).tolist() == [] and SHAPER.apply([]).tolist() == []
    matrix = np.arange(12.0).reshape(3, 4)
    assert SHAPER.apply(matrix[:, 1]).tolist() == SHAPER.apply(matrix[:, 1].copy()).tolist()


def test_a_machine_file_is_refused_with_its_line(tmp_path: Path) -> None:
    path = tmp_path / "bad.toml"
    path.write_text(XY_STAGE.read_text().replace("sample_hz = 10_000", "sample_hz = -3"))
    with pytest.raises(posicast.InputError) as raised:
        posicast.Machine.load(path)
    error = raised.value
    assert (error.file, error.line, error.key) == (str(path), 13, "clock.sample_hz")
    assert error.remedy is not None and "minus sign" in error.remedy
    for call in (posicast.generate, posicast.run, posicast.verify):
        with pytest.raises(posicast.InputError) as of_step:
            call(path)
        assert (of_step.value.file, of_step.value.line, of_step.value.key) == (str(path), 13, "clock.sample_hz")


def test_a_missing_file_and_a_log_without_time(tmp_path: Path) -> None:
    for call in (posicast.Machine.load, posicast.identify, posicast.run, posicast.simulate):
        with pytest.raises(posicast.InputError, match="no-such-file"):
            call(tmp_path / "no-such-file.toml")
    log = tmp_path / "log.csv"
    log.write_text("command,response\n" + "1,2\n" * 50)
    with pytest.raises(posicast.InputError) as raised:
        posicast.identify(log)
    assert "time" in str(raised.value)
    with pytest.raises(posicast.InputError, match="time"):
        posicast.identify(np.ones((50, 2)), columns=["command", "response"])
    with pytest.raises(posicast.InputError, match="columns"):
        posicast.identify(np.ones((50, 2)))
    with pytest.raises(posicast.InputError, match="nan"):
        posicast.identify(np.full((50, 2), np.nan), columns=["time", "response"])
    with pytest.raises(posicast.InputError, match="margin"):
        posicast.identify(log, margin=-1.0)


def test_two_threads_at_once() -> None:
    command = np.random.default_rng(1).integers(-1000, 1000, 300_000).astype(np.int32)
    expected = TABLE.apply(command)
    results: List[Any] = [None] * 4

    def work(index: int) -> None:
        shapers = [posicast.design([(20.0 + index, 0.05)], "ei") for _ in range(20)]
        results[index] = (TABLE.apply(command), {shaper.duration for shaper in shapers})

    threads = [threading.Thread(target=work, args=(index,)) for index in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for shaped, durations in results:
        assert np.array_equal(shaped, expected) and len(durations) == 1


LONG = """
import posicast, wavecmp, signal, threading, os, time
# A shell starts jobs in the background with Ctrl-C ignored.
signal.signal(signal.SIGINT, signal.default_int_handler)
threading.Timer({pause}, os.kill, (os.getpid(), signal.SIGINT)).start()
begun = time.monotonic()
try:
    {call}
except KeyboardInterrupt:
    print("interrupted", flush=True)
    os._exit(0 if time.monotonic() - begun < {pause} + 15 else 1)
print("not interrupted")
"""


@pytest.mark.parametrize(
    "call",
    [
        # Nobody writes into the pipe, so they wait for ever.
        "posicast.identify({pipe!r})",
        "wavecmp.compare({pipe!r}, {pipe!r})",
        f"posicast.verify({str(XY_STAGE)!r}, simulator='rusthdl', cycles=10**10)",
    ],
)
def test_ctrl_c_ends_long_work(call: str, tmp_path: Path) -> None:
    pipe, scratch = tmp_path / "pipe", tmp_path / "scratch"
    scratch.mkdir()
    os.mkfifo(pipe)
    ended = subprocess.run(
        [sys.executable, "-c", LONG.format(call=call.format(pipe=str(pipe)), pause=2.0)],
        capture_output=True,
        text=True,
        timeout=120,
        env=_scratch(scratch),
    )
    assert (ended.returncode, ended.stdout) == (0, "interrupted\n"), ended.stderr
    assert list(scratch.iterdir()) == []


def test_a_step_ends_with_its_caller(tmp_path: Path) -> None:
    code = f"import posicast; posicast.verify({str(XY_STAGE)!r}, simulator='rusthdl', cycles=10**10, progress=lambda *part: print(*part, flush=True))"
    caller = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True, env=_scratch(tmp_path))
    assert caller.stdout is not None and caller.stdout.readline()
    workers = Path(f"/proc/{caller.pid}/task/{caller.pid}/children").read_text().split()
    assert len(workers) == 1
    caller.kill()
    caller.wait()
    for _ in range(200):
        if not Path(f"/proc/{workers[0]}").exists() or "\nState:\tZ" in Path(f"/proc/{workers[0]}/status").read_text():
            break
        time.sleep(0.1)
    else:
        pytest.fail("the step goes on")
    assert list(tmp_path.iterdir()) == []


def _scratch(folder: Path) -> "dict[str, str]":
    return {**os.environ, "TMPDIR": str(folder)}
