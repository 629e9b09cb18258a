"""@MACHINE@ in LiteX: its top modules on Wishbone. Written by posicast @VERSION@; do not edit.

With this folder in `sys.path`, in a SoC whose system clock is that of the machine file:

    from posicast_@MACHINE@ import @FIRST@

    @FIRST@.add_to_soc(soc, "@NAME@", pads=platform.request("@NAME@"))

The software finds @CAPITALS@_BASE in generated/mem.h, and @CAPITALS@_INTERRUPT in generated/soc.h.
"""

import os

from litex.gen import LiteXModule
from litex.soc.integration.soc import SoCRegion
from litex.soc.interconnect import wishbone
from migen import ClockSignal, Instance, Record, ResetSignal, Signal

# The folder of rtl/.
PACKAGE = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
# Clock of the machine file.
CLOCK_HZ = @CLOCK_HZ@


class Component(LiteXModule):
    """A top module with its bus, interrupt and pins. The classes below say which.

    `pads` has a signal per pin, named like it: the record of `platform.request`. `signals` is a dictionary with the signals or
    constants of pins that are no pads. Every input needs either; an output without one is in `self.pins` all the same. Lines that
    change at any time need no synchroniser: the module has one.
    """

    def __init__(self, platform, pads=None, signals=None):
        self.bus = wishbone.Interface(data_width=32, address_width=32, addressing="word")
        # LiteX takes the interrupt of a module from `ev.irq`. It is a level, which the registers enable and clear.
        self.ev = Record([("irq", 1)])
        self.pins = {name: Signal(width, name=name) for name, _, width in self.PINS}

        ports = {"i_clk": ClockSignal(), "i_rst": ResetSignal(), "p_PIPELINED": 0}
        for name, direction, width in self.BUS:
            # LiteX has no `stall`, which is for pipelined masters, and more bits of the address.
            signal = getattr(self.bus, name, Signal(width))
            ports[f"{direction}_wb_{name}"] = signal if len(signal) == width else signal[:width]
        if self.HAS_INTERRUPT:
            ports["o_irq"] = self.ev.irq
        for name, direction, _ in self.PINS:
            ports[f"{direction}_{name}"] = self.pins[name]
        self.specials += Instance(type(self).__name__, **ports)
        self.connect_pins(pads, signals or {})

        for source in self.SOURCES:
            platform.add_source(os.path.join(PACKAGE, source), "verilog")

    def connect_pins(self, pads, signals):
        """Connects the pins, or says which do not fit."""
        connected = dict(signals)
        for name, *_ in pads.layout if pads else []:
            if name in connected:
                raise ValueError(f"{type(self).__name__}: {name} is a pad and a signal; leave one out")
            connected[name] = getattr(pads, name)
        unknown = sorted(set(connected) - set(self.pins))
        if unknown:
            raise ValueError(f"{type(self).__name__} has no pin {', '.join(unknown)}; PINS lists them")
        missing = [name for name, direction, _ in self.PINS if direction == "i" and name not in connected]
        if missing:
            raise ValueError(f"{type(self).__name__}: no pad or signal for the inputs {', '.join(missing)}")
        for name, direction, width in self.PINS:
            if name not in connected:
                continue
            other = connected[name]
            if isinstance(other, Signal) and len(other) != width:
                raise ValueError(f"{type(self).__name__}: {name} has {width} bits, its pad or signal {len(other)}")
            self.comb += self.pins[name].eq(other) if direction == "i" else other.eq(self.pins[name])

    @classmethod
    def add_to_soc(cls, soc, name, origin=None, pads=None, signals=None):
        """Adds the module to a SoC as `soc.NAME`, with a region of the bus that is not cached, and an interrupt.

        LiteX chooses an `origin` where none is given.
        """
        if abs(soc.sys_clk_freq - CLOCK_HZ) >= 1:
            raise ValueError(
                f"{cls.__name__} is for a clock of {CLOCK_HZ} Hz, and the SoC has {soc.sys_clk_freq}: change either, "
                "in the machine file clock.frequency_hz"
            )
        component = cls(soc.platform, pads, signals)
        region = SoCRegion(origin=origin, size=cls.SPAN_BYTES, cached=False)
        soc.bus.add_slave(name, component.bus, region)
        soc.add_module(name, component)
        if cls.HAS_INTERRUPT and soc.irq.enabled:
            soc.irq.add(name, use_loc_if_exists=True)
        return component
