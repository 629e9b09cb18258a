"""Compiles SystemRDL with systemrdl-compiler and prints one line per field, as the test expects them."""

import sys

from systemrdl import RDLCompiler
from systemrdl.node import RegNode

compiler = RDLCompiler()
compiler.compile_file(sys.argv[1])
top = compiler.elaborate().top
for register in top.descendants(unroll=True):
    if not isinstance(register, RegNode):
        continue
    for field in register.fields():
        reset = field.get_property("reset")
        clears = field.get_property("onwrite") is not None
        print(
            register.absolute_address,
            register.inst_name,
            field.inst_name,
            field.low,
            field.width,
            "rw1c" if clears else field.get_property("sw").name,
            "-" if reset is None else reset,
        )
