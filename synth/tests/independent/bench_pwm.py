"""Tests the PWM component with cocotb and cocotb-bus; word addresses and constants come from its SVD."""

import os
from xml.etree import ElementTree

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, ReadOnly, RisingEdge
from cocotb_bus.drivers.avalon import AvalonMaster

CLOCK_NS = 20
PERIOD = 2500
DEAD_TIME = 25
DUTY = 600


class Registers:
    """Registers by name."""

    def __init__(self, dut):
        self.bus = AvalonMaster(dut, "avs", dut.clk)
        self.reset = {}
        self.address = {}
        for register in ElementTree.parse(os.environ["POSICAST_SVD"]).iter("register"):
            name = register.findtext("name")
            self.address[name] = int(register.findtext("addressOffset"), 0) // 4
            self.reset[name] = int(register.findtext("resetValue"), 0)

    async def read(self, name):
        return int(await self.bus.read(self.address[name]))

    async def write(self, name, value):
        await self.bus.write(self.address[name], value)


async def begin(dut):
    """Resets for four clocks, with all lines healthy."""
    cocotb.start_soon(Clock(dut.clk, CLOCK_NS, unit="ns").start())
    for pin in (dut.feed, dut.duty, dut.sync):
        pin.value = 0
    dut.fault_n.value = 1
    dut.pll_locked.value = 1
    dut.filtered_fault_n.value = 3
    dut.rst.value = 1
    registers = Registers(dut)
    await ClockCycles(dut.clk, 4)
    dut.rst.value = 0
    await ClockCycles(dut.clk, 4)
    return registers


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def constants_and_configuration(dut):
    """Constants read as the document says, configuration reads as it was written, commands and holes read as 0."""
    registers = await begin(dut)
    assert (await registers.read("MAGIC")).to_bytes(4, "little") == b"PWM1"
    for name in ("MAGIC", "VERSION", "CONTROL", "PERIOD", "TIMES", "MAX_DUTY"):
        assert await registers.read(name) == registers.reset[name], name
    await registers.write("DUTY", 0x1FFFF)
    assert await registers.read("DUTY") == 0x1FFFF
    await registers.write("PHASE", 0x12345678)
    assert await registers.read("PHASE") == 0x12345678
    assert await registers.read("CLEAR_TRIP") == 0
    assert int(await registers.bus.read(0xF0)) == 0
    # A value below its floor is refused and flagged.
    await registers.write("TIMES", 0)
    assert await registers.read("TIMES") == registers.reset["TIMES"]
    assert await registers.read("FLAGS") == 1 << 5
    await registers.write("FLAGS", 1 << 5)
    assert await registers.read("FLAGS") == 0


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def a_period(dut):
    """After reset it is tripped; then leg A is high for duty less dead time, and low for the rest less two dead times."""
    registers = await begin(dut)
    assert await registers.read("STATUS") & 2
    await registers.write("CLEAR_TRIP", 0)
    await registers.write("DUTY", DUTY)
    control = registers.reset["CONTROL"]
    await registers.write("CONTROL", control | 1)
    # The first period after the start begins with both sides off.
    for _ in range(3):
        await RisingEdge(dut.valley)
    high = low = both = 0
    for _ in range(PERIOD):
        await RisingEdge(dut.clk)
        await ReadOnly()
        a_high, a_low = int(dut.a_high.value), int(dut.a_low.value)
        high, low, both = high + a_high, low + a_low, both + (a_high & a_low)
    expected = DUTY - DEAD_TIME
    assert (high, low, both) == (expected, PERIOD - expected - 2 * DEAD_TIME, 0), (high, low, both)
    assert await registers.read("STATUS") & 3 == 1


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def a_raw_fault(dut):
    """The fault turns the pins off without a clock; the trip stays until it is cleared."""
    registers = await begin(dut)
    await registers.write("CLEAR_TRIP", 0)
    await registers.write("DUTY", DUTY)
    await registers.write("CONTROL", registers.reset["CONTROL"] | 1)
    await RisingEdge(dut.a_low)
    await cocotb.triggers.Timer(3, "ns")
    dut.fault_n.value = 0
    await cocotb.triggers.Timer(1, "ns")
    assert int(dut.a_low.value) == 0 and int(dut.a_high.value) == 0
    dut.fault_n.value = 1
    await ClockCycles(dut.clk, 8)
    assert await registers.read("STATUS") & 3 == 2
