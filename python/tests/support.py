"""Paths and helpers of the tests."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples"
XY_STAGE = EXAMPLES / "xy-stage.toml"
STEP_LOG = ROOT / "docs" / "tutorial" / "arm-step.csv"


def run(program: str, *words: object, **variables: str) -> subprocess.CompletedProcess[str]:
    """Run ``posicast`` or ``wavecmp`` of the package under test, with further environment variables."""
    return subprocess.run(
        [sys.executable, "-m", program, *map(str, words)],
        capture_output=True,
        text=True,
        timeout=300,
        env={**os.environ, **variables},
    )


def started(program: str, *words: object, **options: Any) -> subprocess.Popen[str]:
    """Start ``posicast`` or ``wavecmp``, without waiting for its end."""
    return subprocess.Popen([sys.executable, "-m", program, *map(str, words)], text=True, **options)


def vcd(value: str) -> str:
    """A recording of a clock and of one word, with this value in binary digits."""
    return (
        "$timescale 1ns $end $scope module top $end $var wire 1 ! clk $end $var wire 4 # word $end $upscope $end\n"
        f"$enddefinitions $end\n#0\n0!\nb{value} #\n#5\n1!\n#10\n0!\n#15\n1!\n"
    )
