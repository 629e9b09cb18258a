"""Builds the Verilog with Icarus and runs the cocotb bench on it: run_cocotb.py TOP SVD FOLDER VERILOG..."""

import os
import sys
from pathlib import Path

from cocotb_tools.runner import get_results, get_runner

top, svd, folder, *verilog = sys.argv[1:]
os.environ["POSICAST_SVD"] = svd
sys.path.insert(0, str(Path(__file__).parent))
runner = get_runner("icarus")
runner.build(sources=verilog, hdl_toplevel=top, build_dir=folder, always=True, timescale=("1ns", "1ps"))
results = runner.test(hdl_toplevel=top, test_module="bench_pwm", build_dir=folder, test_dir=folder)
ran, failed = get_results(results)
print(f"{ran} tests, {failed} failed")
sys.exit(0 if ran > 0 and failed == 0 else 1)
