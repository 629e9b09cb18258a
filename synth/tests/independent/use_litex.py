"""Uses a module that posicast wrote for LiteX: use_litex.py read|build|refuse MODULE …; prints what LiteX makes of it."""

import importlib
import logging
import sys
from pathlib import Path

logging.basicConfig(level=logging.ERROR)

from litex.build.generic_platform import GenericPlatform, Pins, Subsignal
from litex.gen import ClockDomain, LiteXModule
from litex.soc.integration.soc_core import SoCCore
from litex.soc.interconnect import wishbone
from migen import Signal

what, path, *rest = sys.argv[1:]
sys.path.append(str(Path(path).parent))
module = importlib.import_module(Path(path).stem)
classes = [of for of in vars(module).values() if isinstance(of, type) and module.Component in of.__bases__]


def platform_for(*components):
    """Clock and reset, and the pins of these modules."""
    pins = [(name, 0, *(Subsignal(pin, Pins(width)) for pin, _, width in of.PINS)) for name, of in components]
    return GenericPlatform("device", [("clk", 0, Pins(1)), ("rst", 0, Pins(1)), *pins], name="soc")


class Clock(LiteXModule):
    def __init__(self, platform):
        self.cd_sys = ClockDomain()
        self.comb += self.cd_sys.clk.eq(platform.request("clk")), self.cd_sys.rst.eq(platform.request("rst"))


def soc_on(platform, clock_hz=module.CLOCK_HZ):
    """A SoC with a master of the bus instead of a processor."""
    soc = SoCCore(platform, clock_hz, cpu_type=None, with_uart=False, with_timer=False)
    soc.crg = Clock(platform)
    soc.bus.add_master("host", wishbone.Interface(data_width=32, address_width=32, addressing="word"))
    return soc


def read():
    print("clock", module.CLOCK_HZ)
    sources = set()
    for of in classes:
        print("class", of.__name__, of.SPAN_BYTES, of.HAS_INTERRUPT)
        for prefix, ports in ("wb_", of.BUS), ("", of.PINS):
            for name, direction, width in ports:
                print("port", prefix + name, direction, width)
        for register, offset in of.REGISTERS.items():
            print("register", register, offset)
        sources.update(of.SOURCES)
    for source in sorted(sources):
        print("source", Path(module.PACKAGE, source))


def build(folder):
    components = [(of.__name__.split("_")[-2], of) for of in classes]
    platform = platform_for(*components)
    soc = soc_on(platform)
    for place, (name, of) in enumerate(components):
        of.add_to_soc(soc, name, origin=0x8000_0000 + place * 0x1000_0000, pads=platform.request(name))
    soc.finalize()
    for name, _ in components:
        print(f"{name.upper()}_BASE {soc.mem_regions[name].origin:#x}")
    fragment = soc.get_fragment()
    platform.finalize(fragment)
    made = Path(folder, "soc.v")
    made.write_text(platform.get_verilog(fragment, name="soc").main_source)
    print(*(source for source, *_ in platform.sources), made)


def refuse():
    (of,) = classes
    inputs = {name: width for name, direction, width in of.PINS if direction == "i"}
    (name, *_) = inputs

    def refused(kind, clock_hz=module.CLOCK_HZ, pads=None, signals=None):
        platform = platform_for(("x", of), ("y", of))
        try:
            of.add_to_soc(soc_on(platform, clock_hz), "x", pads=pads and platform.request(pads), signals=signals)
        except ValueError as error:
            print(f"{kind}: {error}")

    refused("clock", clock_hz=25_000_000, pads="x")
    refused("missing")
    refused("unknown", signals={"folt_n": 1})
    refused("twice", pads="x", signals={name: 1})
    refused("width", signals={**{pin: Signal(width) for pin, width in inputs.items()}, name: Signal(inputs[name] + 1)})


{"read": read, "build": build, "refuse": refuse}[what](*rest)
