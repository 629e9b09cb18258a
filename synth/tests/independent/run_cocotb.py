"""Builds Verilog with Icarus and runs a cocotb bench on it: run_cocotb.py BENCH TOP FOLDER VERILOG...

The bench is a module in this folder. POSICAST_PARAMETERS, if it is set, has NAME=VALUE of the top, separated by commas.
"""

import os
import sys
from pathlib import Path

from cocotb_tools.runner import get_results, get_runner

bench, top, folder, *verilog = sys.argv[1:]
sys.path.insert(0, str(Path(__file__).parent))
given = os.environ.get("POSICAST_PARAMETERS", "")
parameters = dict(one.split("=") for one in given.split(",") if one)
runner = get_runner("icarus")
runner.build(
    sources=verilog, hdl_toplevel=top, build_dir=folder, always=True, timescale=("1ns", "1ps"), parameters=parameters
)
results = runner.test(hdl_toplevel=top, test_module=bench, build_dir=folder, test_dir=folder)
ran, failed = get_results(results)
print(f"{ran} tests, {failed} failed")
sys.exit(0 if ran > 0 and failed == 0 else 1)
