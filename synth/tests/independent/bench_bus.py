"""Accesses registers through AXI4-Lite or Wishbone with the masters of cocotbext-axi and cocotbext-wishbone, and writes down what was asked and
answered, for the test to compare with the model.

POSICAST_BUS is axi, wishbone or pipelined; POSICAST_WORDS the number of addresses; POSICAST_PINS has the other inputs, which are low;
POSICAST_ACCESSES is the number of accesses, and POSICAST_LOG the file, a line per access:

    w ADDRESS DATA BYTES FAILED
    r ADDRESS DATA FAILED
"""

import itertools
import os
import random

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, Combine
from cocotbext.axi import AxiLiteBus, AxiLiteMaster, AxiResp
from cocotbext.wishbone import driver
from cocotbext.wishbone.driver import WBOp, WishboneMaster

BUS = os.environ["POSICAST_BUS"]
ACCESSES = int(os.environ["POSICAST_ACCESSES"])
WORDS = int(os.environ["POSICAST_WORDS"])
# The first words are constants of the component.
MAGIC, VERSION = 0, 1

# In Icarus 11 a net that was deposited to at once confuses what reads it.
driver.set_immediate = lambda signal, value: setattr(signal, "value", value)


class Axi:
    """A manager whose channels pause at random."""

    def __init__(self, dut, rng):
        self.master = AxiLiteMaster(AxiLiteBus.from_prefix(dut, "s_axi"), dut.clk, dut.rst)
        write, read = self.master.write_if, self.master.read_if
        for channel in (write.aw_channel, write.w_channel, write.b_channel, read.ar_channel, read.r_channel):
            chance = rng.choice((0.0, 0.2, 0.6))
            channel.set_pause_generator(rng.random() < chance for _ in itertools.count())

    async def write(self, word, first, data):
        answer = await self.master.write(4 * word + first, data)
        return answer.resp != AxiResp.OKAY

    async def read(self, word):
        answer = await self.master.read(4 * word, 4)
        return int.from_bytes(answer.data, "little"), answer.resp != AxiResp.OKAY

    async def at_once(self):
        """Many accesses that are open together: each gets its own answer."""
        magic, _ = await self.read(MAGIC)
        version, _ = await self.read(VERSION)
        expected = [(magic, MAGIC), (version, VERSION)] * 100
        found = []

        async def one(word):
            found.append((await self.read(word), word))

        tasks = [cocotb.start_soon(one(word)) for _, word in expected]
        tasks += [cocotb.start_soon(self.write(WORDS - 1, 0, bytes(4))) for _ in range(50)]
        await Combine(*tasks)
        assert sorted(found) == sorted(((value, False), word) for value, word in expected)


class Wishbone:
    """A master that waits at random before a request."""

    def __init__(self, dut, rng):
        names = ["cyc", "stb", "we", "adr", "sel", "ack", "err"] + (["stall"] if BUS == "pipelined" else [])
        signals = {name: name for name in names} | {"datwr": "dat_w", "datrd": "dat_r"}
        # It takes a bus on which it finds a stall for a pipelined one.
        WishboneMaster._optional_signals = []
        self.rng = rng
        self.master = WishboneMaster(dut, "wb", dut.clk, timeout=100, width=32, signals_dict=signals)

    async def access(self, **how):
        [answer] = await self.master.send_cycle([WBOp(idle=self.rng.choice((0, 0, 1, 5)), **how)])
        return answer

    async def write(self, word, first, data):
        value = int.from_bytes(bytes(first) + data, "little")
        sel = ((1 << len(data)) - 1) << first
        return (await self.access(adr=word, dat=value, sel=sel)).ack != 1

    async def read(self, word):
        answer = await self.access(adr=word)
        return int(answer.datrd), answer.ack != 1

    async def at_once(self):
        """Several accesses in one cycle."""
        answers = await self.master.send_cycle([WBOp(adr=MAGIC), WBOp(adr=VERSION), WBOp(adr=WORDS - 1), WBOp(adr=MAGIC)])
        assert [answer.ack for answer in answers] == [1, 1, 2, 1]
        assert int(answers[0].datrd) == int(answers[3].datrd) != 0


@cocotb.test()
async def accesses(dut):
    rng = random.Random(24)
    cocotb.start_soon(Clock(dut.clk, 20, unit="ns").start())
    for pin in os.environ["POSICAST_PINS"].split(","):
        getattr(dut, pin).value = 0
    dut.rst.value = 1
    bus = (Axi if BUS == "axi" else Wishbone)(dut, rng)
    await ClockCycles(dut.clk, 4)
    dut.rst.value = 0
    await ClockCycles(dut.clk, 4)
    await bus.at_once()
    with open(os.environ["POSICAST_LOG"], "w") as log:
        for _ in range(ACCESSES):
            word = rng.randrange(WORDS)
            # Half of them are where the registers are.
            word = rng.choice((word, word % 256 % 96))
            if rng.random() < 0.5:
                first = rng.choice((0, 0, 0, 1, 2, 3))
                data = rng.randbytes(rng.choice((4, 1, 2, 3)) if first == 0 else rng.randint(1, 4 - first))
                failed = await bus.write(word, first, data)
                value = int.from_bytes(bytes(first) + data, "little")
                print("w", word, value, ((1 << len(data)) - 1) << first, int(failed), file=log)
            else:
                value, failed = await bus.read(word)
                print("r", word, value, int(failed), file=log)
