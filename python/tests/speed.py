"""Measures how fast four taps shape, beside NumPy's convolution of the same samples: `python speed.py`. It needs the release build."""

import time
from typing import Callable

import numpy as np
import posicast

SAMPLES = 2_000_000


def speed(work: Callable[[], object]) -> float:
    """Samples per second, the best of 20 runs, by the time of this thread on a processor: other work of the machine does not lengthen it."""
    seconds = []
    for _ in range(20):
        begun = time.thread_time()
        work()
        seconds.append(time.thread_time() - begun)
    return SAMPLES / min(seconds)


def main() -> None:
    table = posicast.TapTable([0, 12, 13, 25], [16384, 16384, 16384, 16384], 16, 1000.0)
    taps = np.zeros(26)
    taps[[0, 12, 13, 25]] = 0.25
    words = np.random.default_rng(1).integers(-(1 << 30), 1 << 30, SAMPLES).astype(np.int32)
    floats = words.astype(np.float64)
    shaper = posicast.design([(40.0, 0.0)], "zv")
    for name, work in (
        ("words of 32 bits, bit for bit as the hardware", lambda: table.apply(words)),
        ("floats", lambda: shaper.apply(floats)),
        ("numpy.convolve, floats", lambda: np.convolve(floats, taps)),
    ):
        print(f"{name}: {speed(work):.3g} samples/s")


if __name__ == "__main__":
    main()
