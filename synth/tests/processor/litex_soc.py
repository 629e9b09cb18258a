"""A LiteX SoC with a VexRiscv and a machine's stage: litex_soc.py FOLDER_OF_THE_MODULE MODULE CLASS OUTPUT.

Writes the SoC's Verilog and the headers for its software, as LiteX makes them, and prints the Verilog files and where the headers
are.

The pins of the top, beside those of the stage: clock, reset, the program's way into the memory, LiteX's stream of the console,
and for the test a copy of the stage's bus and interrupt, and a mark that the software sets in its handler.
"""

import importlib
import logging
import sys
from pathlib import Path

logging.basicConfig(level=logging.WARNING)

import litex
from litex.build.generic_platform import Pins, Subsignal
from litex.build.sim import SimPlatform
from litex.gen import ClockDomain, LiteXModule
from litex.soc.cores.gpio import GPIOOut
from litex.soc.integration.builder import Builder
from litex.soc.integration.soc_core import SoCCore

folder, module, name, output = sys.argv[1:]
sys.path.append(folder)
stage = getattr(importlib.import_module(module), name)
RAM_BYTES = 0x8000

CONSOLE = [("source_valid", 1), ("source_ready", 1), ("source_data", 8), ("sink_valid", 1), ("sink_ready", 1), ("sink_data", 8)]
SEEN = [(f"wb_{port}", width) for port, _, width in stage.BUS if port != "stall"] + [("irq", 1)]


def record(name, signals):
    return (name, 0, *(Subsignal(signal, Pins(width)) for signal, width in signals))


class Clock(LiteXModule):
    def __init__(self, platform):
        self.cd_sys = ClockDomain()
        self.comb += self.cd_sys.clk.eq(platform.request("clk")), self.cd_sys.rst.eq(platform.request("rst"))


class SoC(SoCCore):
    def __init__(self, platform):
        self.crg = Clock(platform)
        super().__init__(
            platform,
            importlib.import_module(module).CLOCK_HZ,
            cpu_type="vexriscv",
            cpu_reset_address=0x4000_0000,
            integrated_sram_size=0,
            integrated_main_ram_size=RAM_BYTES,
            integrated_main_ram_init=None,
            uart_name="sim",
        )
        stage.add_to_soc(self, "stage", pads=platform.request("stage"))

        # The program comes while the reset holds the processor.
        port = self.main_ram.mem.get_port(write_capable=True)
        self.specials += port
        ways = [(port.we, "load"), (port.adr, "load_word"), (port.dat_w, "load_data")]
        self.comb += [way.eq(platform.request(name)) for way, name in ways]

        self.handler = GPIOOut(platform.request("in_interrupt"))
        for name, _ in SEEN:
            port = getattr(self.stage.bus, name.removeprefix("wb_"), self.stage.ev.irq)
            self.comb += platform.request(f"stage_{name}").eq(port)


class Platform(SimPlatform):
    """Writes the Verilog for LiteX's simulation, and leaves the building to others."""

    def build(self, soc, build_dir, **_):
        fragment = soc.get_fragment()
        self.finalize(fragment)
        made = self.get_verilog(fragment, name="sim")
        # Without the date, the same SoC is the same text.
        lines = [line for line in made.main_source.splitlines() if not line.startswith("// Date")]
        path = Path(build_dir, "sim.v")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("\n".join(lines) + "\n")
        self.add_source(path)
        return made.ns


platform = Platform(
    "SIM",
    [
        ("clk", 0, Pins(1)),
        ("rst", 0, Pins(1)),
        ("in_interrupt", 0, Pins(1)),
        ("load", 0, Pins(1)),
        ("load_word", 0, Pins(13)),
        ("load_data", 0, Pins(32)),
        record("serial", CONSOLE),
        record("stage", [(pin, width) for pin, _, width in stage.PINS]),
        *((f"stage_{name}", 0, Pins(width)) for name, width in SEEN),
    ],
)
soc = SoC(platform)
Builder(soc, output_dir=output, compile_software=False, compile_gateware=False).build()
for source, *_ in platform.sources:
    print("source", source)
software = Path(litex.__file__).parent / "soc"
for include in Path(output, "software/include"), software / "software/include", software / "cores/cpu/vexriscv":
    print("include", include)
