"""Shapers beside NumPy and SciPy: residual, convolution, digitising, the step response of a mode."""

from typing import Any, Tuple

import numpy as np
import posicast
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import signal

MODE = st.tuples(st.floats(2.0, 90.0), st.floats(0.0, 0.3))
SHAPED = settings(max_examples=40, deadline=None, derandomize=True)


def pole_sum(shaper: posicast.Shaper, frequency_hz: float, damping: float) -> float:
    """The residual after Singer and Seering (1990), equation 3, from the impulses alone."""
    omega = 2 * np.pi * frequency_hz
    decay = np.exp(damping * omega * (shaper.times - shaper.times[-1]))
    turn = np.exp(1j * omega * np.sqrt(1 - damping**2) * shaper.times)
    return float(abs(np.sum(shaper.amplitudes * decay * turn)))


@SHAPED
@given(mode=MODE, kind=st.sampled_from(["zv", "zvd", "mzv", "ei", "um-zv"]), ratio=st.floats(0.5, 2.0), damping=st.floats(0.0, 0.5))
def test_residual_is_the_pole_sum_of_the_impulses(mode: Tuple[float, float], kind: str, ratio: float, damping: float) -> None:
    shaper = posicast.design([mode], kind)
    assert shaper.amplitudes.sum() == pytest.approx(1, abs=1e-12)
    found = shaper.residual(np.array([[mode[0] * ratio]]), damping)
    assert found.shape == (1, 1)
    assert found[0, 0] == pytest.approx(pole_sum(shaper, mode[0] * ratio, damping), abs=1e-9)


@SHAPED
@given(mode=MODE, kind=st.sampled_from(["zv", "zvd", "zvdd"]))
def test_a_mode_stands_still_after_a_shaped_step(mode: Tuple[float, float], kind: str) -> None:
    """SciPy integrates the mode after each impulse's step, exactly: together they stand still after the last."""
    shaper = posicast.design([mode], kind)
    omega, damping = 2 * np.pi * mode[0], mode[1]
    system = signal.lti([omega**2], [1, 2 * damping * omega, omega**2])
    pause = np.arange(60) / (20 * mode[0])
    response = np.zeros(len(pause))
    for time, amplitude in shaper.impulses:
        _, _, states = signal.lsim(system, np.ones(3), np.linspace(0, shaper.duration - time + 1e-6, 3))
        _, step, _ = signal.lsim(system, np.ones(len(pause)), pause, X0=states[-1])
        response += amplitude * step
    assert np.abs(response - 1).max() < 1e-6
    _, unshaped, _ = signal.lsim(system, np.ones(len(pause)), pause)
    assert np.abs(unshaped - 1).max() > 0.5


@SHAPED
@given(modes=st.tuples(MODE, MODE), kind=st.sampled_from(["zv", "mzv"]))
def test_the_shaper_of_two_modes_is_the_convolution_of_theirs(modes: Tuple[Any, Any], kind: str) -> None:
    both = posicast.design(modes, kind)
    a, b = (posicast.design([mode], kind) for mode in modes)
    times = np.add.outer(a.times, b.times).ravel()
    amplitudes = np.multiply.outer(a.amplitudes, b.amplitudes).ravel()
    # As functions of time, because coincident impulses are merged.
    at = np.unique(np.round(times, 9)) + 1e-8
    expected = [(amplitudes[times < time]).sum() for time in at]
    found = [both.amplitudes[both.times < time].sum() for time in at]
    assert found == pytest.approx(expected, abs=1e-9)


@SHAPED
@given(mode=MODE, kind=st.sampled_from(["zv", "zvd", "ei", "um-zv"]), rate=st.floats(500.0, 5000.0), seed=st.integers(0, 2**32 - 1))
def test_float_shaping_is_an_fir_filter_of_scipy(mode: Tuple[float, float], kind: str, rate: float, seed: int) -> None:
    shaper = posicast.design([mode], kind)
    coefficients = shaper.to_fir(rate)
    command = np.random.default_rng(seed).normal(size=700)
    expected = signal.lfilter(coefficients, 1, command)
    assert shaper.apply(command, rate, start=0.0) == pytest.approx(expected, abs=1e-9)
    stream = shaper.stream(rate, start=0.0)
    pieces = [stream.apply(piece) for piece in np.split(command, [1, 2, 250, 250, 600])]
    assert np.array_equal(np.concatenate(pieces), shaper.apply(command, rate, start=0.0))


@SHAPED
@given(mode=MODE, kind=st.sampled_from(["zv", "zvd", "mzv"]), rate=st.floats(500.0, 5000.0))
def test_digitised_taps_keep_the_zero_at_the_pole_and_round_once(mode: Tuple[float, float], kind: str, rate: float) -> None:
    shaper = posicast.design([mode], kind)
    coefficients, table = shaper.to_fir(rate), shaper.taps(rate)
    omega, damping = 2 * np.pi * mode[0], mode[1]
    pole = np.exp((-damping * omega + 1j * omega * np.sqrt(1 - damping**2)) / rate)
    last = len(coefficients) - 1
    assert abs(np.polyval(coefficients, pole)) < 1e-9 * max(1.0, abs(pole) ** -last)
    assert table.coefficients.sum() == 1 << table.fraction_bits
    dense = np.zeros(int(max(table.delays[-1], last)) + 1)
    dense[table.delays] = table.coefficients / 2.0**table.fraction_bits
    dense[: len(coefficients)] -= coefficients
    assert np.abs(dense).max() <= 2.0**-table.fraction_bits


@SHAPED
@given(mode=MODE, kind=st.sampled_from(["zv", "ei", "um-zv"]), bits=st.sampled_from([16, 24, 32]), seed=st.integers(0, 2**32 - 1), wide=st.booleans())
def test_integer_shaping_is_exact_arithmetic(mode: Tuple[float, float], kind: str, bits: int, seed: int, wide: bool) -> None:
    table = posicast.design([mode], kind).taps(1000.0)
    limit = 1 << (bits - 1)
    words = np.random.default_rng(seed).integers(-limit, limit, 400).astype(np.int64 if wide else np.int32)
    history = [int(words[0])] * int(table.delays[-1]) + [int(word) for word in words]
    reach, half = int(table.delays[-1]), 1 << (table.fraction_bits - 1)
    taps = list(zip(table.delays.tolist(), table.coefficients.tolist()))
    expected = [
        min(max((sum(c * history[reach + n - d] for d, c in taps) + half) >> table.fraction_bits, -limit), limit - 1)
        for n in range(len(words))
    ]
    shaped = table.apply(words, word_bits=bits)
    assert shaped.dtype == words.dtype and shaped.tolist() == expected
    stream = table.stream(word_bits=bits, start=int(words[0]))
    pieces = [stream.apply(piece) for piece in np.split(words, [3, 100, 101])]
    assert np.concatenate(pieces).tolist() == expected


def test_figures_agree_with_each_other() -> None:
    shaper = posicast.design([(40.0, 0.02)], "ei", tolerance=0.05)
    assert float(shaper.residual(40.0, 0.02)) == pytest.approx(0.05, abs=1e-9)
    ratios, residuals = shaper.sensitivity(low=0.8, high=1.2, points=41)
    assert residuals == pytest.approx(shaper.residual(40.0 * ratios, 0.02), abs=1e-12)
    found = shaper.insensitivity(tolerance=0.05)
    assert found is not None
    low, high = found
    assert shaper.residual([40.0 * low, 40.0 * high], 0.02) == pytest.approx([0.05, 0.05], abs=1e-6)
    assert shaper.delay == pytest.approx(float(shaper.times @ shaper.amplitudes))
    assert shaper.duration == shaper.times[-1]


def test_optimal_is_the_shortest_and_proves_it() -> None:
    shaper = posicast.optimal([(40.0, 0.02)], sample_hz=1000.0, frequency_band=0.1, tolerance=0.05)
    certificate = shaper.certify()
    assert certificate["shorter"]["proven"] and certificate["modes"][0]["holds"]
    edges = shaper.taps().residual(np.linspace(36, 44, 200), 0.02)
    assert edges.max() <= certificate["modes"][0]["certified_residual"] <= 0.05
    with pytest.raises(posicast.InputError, match="design it again"):
        shaper.taps(2000.0)


def test_the_comparison_is_that_of_the_kinds() -> None:
    table = posicast.compare([(40.0, 0.02)], band=0.1)
    zvd = posicast.design([(40.0, 0.02)], "zvd")
    assert table["zvd"]["duration_s"] == pytest.approx(zvd.duration)
    assert [row["duration_s"] for row in table.rows] == sorted(row["duration_s"] for row in table.rows)
    assert "zvd" in str(table) and "<td>zvd</td>" in table._repr_html_()
    with pytest.raises(KeyError):
        table["none of them"]


def test_control_and_plots() -> None:
    import control
    import matplotlib

    matplotlib.use("Agg")
    from posicast import plot

    shaper = posicast.design([(40.0, 0.05)], "zvd")
    filtered = shaper.to_lti()
    assert control.dcgain(filtered) == pytest.approx(1.0) and filtered.dt == pytest.approx(1e-3)
    pole = np.exp((-0.05 * 2 * np.pi * 40 + 1j * 2 * np.pi * 40 * np.sqrt(1 - 0.05**2)) / 1000)
    assert abs(filtered(pole)) < 1e-9
    assert plot.sensitivity(shaper).get_ylabel() == "residual vibration, %"
    assert plot.impulses(shaper).get_title() == "zvd"
