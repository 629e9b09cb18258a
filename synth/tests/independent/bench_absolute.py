"""Encoders of SSI and BiSS-C, written from the descriptions of the protocols, at the lines of the block absolute_encoder.

POSICAST_ENCODER is a JSON object with what the block was built for, and for how many readings it is tried. Delays there and back,
jitter, damaged frames, silence, a stuck line and jumps are chosen at random; each count must be the one that follows from what was sent.

Sources: SSI as in the manuals of makers of encoders (clock and data high at rest; the first falling edge holds the position; a bit
follows each rising edge, the highest first; low behind the last until the monoflop has run out). BiSS C-mode, unidirectional (MA and
SLO high at rest; the first rising edge holds the position; SLO falls at the second; start bit, a bit 0, position, nError, nWarning,
CRC of x^6 + x + 1, inverted; low until the time-out).
"""

import json
import os
import random

import cocotb
from cocotb.clock import Clock
from cocotb.queue import Queue
from cocotb.triggers import ClockCycles, First, ReadOnly, RisingEdge, Timer, ValueChange, select
from cocotb.utils import get_sim_time

BUILT = json.loads(os.environ["POSICAST_ENCODER"])
CLOCK_NS = 10
RANGE = 1 << BUILT["position"]
GENERATOR = 0x43
CHECK_BITS = {"crc6": 6, "even": 1, "odd": 1, "unchecked": 0}[BUILT["check"]]


def crc6(bits):
    """The remainder of the message times x^6: long division of the whole number."""
    rest = int("".join(map(str, bits)), 2) << 6
    while rest.bit_length() > 6:
        rest ^= GENERATOR << (rest.bit_length() - 7)
    return rest


def encoded(position, error, warning, rng):
    """The bits that an encoder at this position sends."""
    shown = position ^ (position >> 1) if BUILT["gray"] else position
    bits = [rng.randint(0, 1) for _ in range(BUILT["leading"])]
    bits += [int(digit) for digit in format(shown, f"0{BUILT['position']}b")]
    trailing = [rng.randint(0, 1) for _ in range(BUILT["trailing"])]
    for status, wrong in ((BUILT["error"], error), (BUILT["warning"], warning)):
        if status is not None:
            place, low = status
            trailing[place] = int(wrong != low)
    bits += trailing
    return bits + check_of(bits)


def check_of(bits):
    if BUILT["check"] == "crc6":
        return [int(digit) for digit in format(crc6(bits) ^ 0x3F, "06b")]
    if BUILT["check"] == "even":
        return [sum(bits) % 2]
    if BUILT["check"] == "odd":
        return [1 - sum(bits) % 2]
    return []


def decoded(bits):
    """What a frame says: whether its check holds, whether the error bit is on, and the position."""
    body = bits[: len(bits) - CHECK_BITS]
    checked = bits[len(body) :] == check_of(body)
    first = BUILT["leading"]
    word = int("".join(map(str, body[first : first + BUILT["position"]])), 2)
    if BUILT["gray"]:
        shift = 1
        while shift < BUILT["position"]:
            word ^= word >> shift
            shift *= 2
    error = False
    if BUILT["error"] is not None:
        place, low = BUILT["error"]
        error = body[first + BUILT["position"] + place] != int(low)
    return checked, error, word


class Encoder:
    """An encoder at the end of a cable."""

    def __init__(self, dut, rng):
        self.dut, self.rng = dut, rng
        self.position = 0
        self.frame = []
        self.there_ns = self.back_ns = 0
        self.jitter_ns = 0
        self.computes = 0
        self.silent = self.low = False
        # When the last reading held the position.
        self.latched_ns = None
        self.output = 1
        dut.data.value = 1
        self.edges = Queue()

    def start(self):
        cocotb.start_soon(self.cable())
        cocotb.start_soon(self.run())

    async def cable(self):
        """The clock's edges reach the encoder later."""
        while True:
            await ValueChange(self.dut.clock_out)
            cocotb.start_soon(self.arrive(int(self.dut.clock_out.value), self.there_ns))

    async def arrive(self, level, delay_ns):
        if delay_ns:
            await Timer(delay_ns, unit="ns")
        self.edges.put_nowait(level)

    def drive(self, level):
        if level != self.output:
            self.output = level
            jitter = self.rng.uniform(0, self.jitter_ns) if self.jitter_ns else 0
            cocotb.start_soon(self.leave(level, self.back_ns + round(jitter)))

    async def leave(self, level, delay_ns):
        if delay_ns:
            await Timer(delay_ns, unit="ns")
        self.dut.data.value = level

    async def next_edge(self, quiet_ns):
        """The level after the next edge, or None where there is none for that long."""
        which, level = await select(self.edges.get(), Timer(quiet_ns, unit="ns"))
        return level if which == 0 else None

    async def run(self):
        while True:
            level = await self.edges.get()
            if self.silent:
                while await self.next_edge(BUILT["ready_ns"]) is not None:
                    pass
                continue
            assert level == 0, "the first edge falls"
            self.begin()
            rises = 0
            while (level := await self.next_edge(BUILT["ready_ns"])) is not None:
                if level == 1:
                    rises += 1
                    self.rise(rises)
            self.drive(0 if self.low else 1)

    def release(self):
        self.low = False
        self.drive(1)


class Ssi(Encoder):
    def begin(self):
        self.latched_ns = get_sim_time("ns")
        self.sent = list(self.frame)

    def rise(self, number):
        self.drive(self.sent[number - 1] if number <= len(self.sent) else 0)


class Biss(Encoder):
    def begin(self):
        self.sent = list(self.frame)

    def rise(self, number):
        if number == 1:
            self.latched_ns = get_sim_time("ns")
            return
        before = [0] * (1 + self.computes) + [1, 0]
        stream = before + self.sent
        self.drive(stream[number - 2] if number - 2 < len(stream) else 0)


class Expected:
    """What the datasheet says of the count."""

    def __init__(self):
        self.known = self.lost = False
        self.missed = 0
        self.count = self.good = self.change = 0

    def reading(self, position):
        """A reading with this position, or a failed one (None). Returns whether there is a count, and whether it jumped."""
        jumped = False
        if position is not None and self.known:
            apart = (position - self.good) % RANGE
            apart = apart - RANGE if apart >= RANGE // 2 else apart
            jumped = abs(apart) > BUILT["largest"] * (self.missed + 1)
        if position is not None and not jumped:
            if self.known:
                self.good += apart
                self.change = apart if self.missed == 0 else self.change
            else:
                self.good, self.change, self.known = position, 0, True
            self.count, self.missed = self.good, 0
            return True, False
        if self.missed == BUILT["tolerated"]:
            self.lost, self.known = True, False
            return False, jumped
        self.missed += 1
        if self.known:
            self.count += self.change
        return self.known, jumped


async def times_of_the_line(dut, seen):
    """Shortest times of the clock line in ns: low, high within a reading, high between two."""
    last = None
    while True:
        await ValueChange(dut.clock_out)
        now = get_sim_time("ns")
        if last is not None:
            rose = int(dut.clock_out.value)
            lasted = now - last
            kind = "low" if rose else ("high" if lasted < BUILT["pause_clocks"] * CLOCK_NS // 2 else "pause")
            seen[kind] = min(seen.get(kind, lasted), lasted)
        last = now


def delays(rng):
    """Delays there and back in ns that the protocol allows: SSI less than a period, BiSS several."""
    total = rng.randint(0, BUILT["most_delay_ns"])
    there = rng.randint(0, total)
    return there, total - there


@cocotb.test()
async def counts_follow_the_encoder(dut):
    rng = random.Random(BUILT["seed"])
    cocotb.start_soon(Clock(dut.clk, CLOCK_NS, unit="ns").start())
    dut.rst.value, dut.tick.value, dut.clear_flags.value = 1, 0, 0
    encoder = (Biss if BUILT["protocol"] == "biss_c" else Ssi)(dut, rng)
    await ClockCycles(dut.clk, 4)
    dut.rst.value = 0
    encoder.start()
    seen = {}
    cocotb.start_soon(times_of_the_line(dut, seen))
    await ClockCycles(dut.clk, 4)

    expected = Expected()
    position, speed, slip = RANGE - 2, 1, 0
    tally = dict.fromkeys(("good", "extrapolated", "lost", "check", "error", "silent", "stuck", "jumped", "delayed"), 0)
    for number in range(BUILT["readings"]):
        if number % 16 == 0:
            encoder.there_ns, encoder.back_ns = delays(rng)
            encoder.jitter_ns = rng.choice((0, 0, BUILT["jitter_ns"]))
            encoder.computes = rng.choice((0, 0, 1, 5))
        if number % 5 == 0:
            speed = rng.choice((BUILT["largest"], -BUILT["largest"], rng.randint(-BUILT["largest"], BUILT["largest"]), 0, 1))
        position = (position + speed) % RANGE

        fault = rng.choice(("silent", "bits", "error", "far", "jump", "low")) if number > 8 and rng.random() < 0.25 else "none"
        fault = "none" if fault == "error" and BUILT["error"] is None else fault
        error, warning = fault == "error", rng.random() < 0.1
        far = rng.randrange(RANGE) if fault == "far" else position
        if fault == "jump":
            # One count more than allowed, either way; it comes back.
            far = (expected.good + rng.choice((1, -1)) * (BUILT["largest"] * (expected.missed + 1) + 1)) % RANGE
        encoder.frame = encoded(far, error, warning, rng)
        if fault == "bits":
            for _ in range(rng.choice((1, 1, 2, 3, 6))):
                encoder.frame[rng.randrange(len(encoder.frame))] ^= 1
        encoder.silent = fault == "silent"
        stuck = encoder.low
        was_lost = expected.lost
        if was_lost:
            dut.clear_flags.value = 1
            await RisingEdge(dut.clk)
            dut.clear_flags.value = 0
            expected = Expected()

        encoder.latched_ns = None
        dut.tick.value = 1
        await RisingEdge(dut.clk)
        ticked_ns = get_sim_time("ns")
        dut.tick.value = 0
        encoder.low = fault == "low" and not stuck
        rest = Timer(BUILT["tick_clocks"] * CLOCK_NS, unit="ns")
        strobe = await First(rest, RisingEdge(dut.valid))
        came = strobe is not rest
        await ReadOnly()
        shown = {name: int(getattr(dut, name).value) for name in ("extrapolated", "known", "line_delay")}
        count = dut.count.value.to_signed()

        checked, is_error, word = decoded(encoder.frame)
        good = checked and not is_error and not (encoder.silent or stuck)
        has_count, jumped = expected.reading(word if good else None)
        extrapolated = int(has_count and (not good or jumped))
        where = f"reading {number}, fault {fault}, stuck {stuck}, delays {encoder.there_ns} + {encoder.back_ns} ns"
        assert came == has_count, where
        if has_count:
            wrapped = (expected.count + (1 << 31)) % (1 << 32) - (1 << 31)
            assert (count, shown["extrapolated"]) == (wrapped, extrapolated), f"{where}: {count}, not {wrapped}"
            if not extrapolated:
                assert count % RANGE == word % (1 << 32), where
        if came and not stuck and not encoder.silent:
            held = (encoder.latched_ns - ticked_ns - encoder.there_ns) / CLOCK_NS
            assert held == BUILT["latch_clocks"] - 1, f"{where}: held {held} clocks after the tick"
            if BUILT["protocol"] == "biss_c" and encoder.jitter_ns == 0:
                delay = (encoder.there_ns + encoder.back_ns) / CLOCK_NS
                assert delay - 1 <= shown["line_delay"] <= delay, f"{where}: line_delay {shown['line_delay']}"
                tally["delayed"] += delay > BUILT["period_clocks"]
        await Timer(1, unit="ns")
        if came:
            await rest_of(ticked_ns)
        await ReadOnly()
        flags = {name: int(getattr(dut, name).value) for name in ("check_failed", "silent", "stuck", "error_bit", "jumped", "lost", "overrun")}
        wanted = {
            "check_failed": int(not checked and not (encoder.silent or stuck)),
            "silent": int(encoder.silent and not stuck),
            "stuck": int(stuck),
            "error_bit": int(checked and is_error and not (encoder.silent or stuck)),
            "jumped": int(jumped),
            "lost": int(expected.lost),
            "overrun": 0,
        }
        assert flags == wanted, f"{where}: {flags}, not {wanted}"
        await RisingEdge(dut.clk)
        # Only `lost` stays for the next reading.
        if not expected.lost:
            dut.clear_flags.value = 1
            await RisingEdge(dut.clk)
            dut.clear_flags.value = 0
        if stuck:
            encoder.release()
            await Timer(4 * CLOCK_NS + encoder.back_ns + encoder.jitter_ns, unit="ns")
            await RisingEdge(dut.clk)
        for name, flag in (("check", "check_failed"), ("error", "error_bit"), ("silent", "silent"), ("stuck", "stuck"), ("jumped", "jumped"), ("lost", "lost")):
            tally[name] += flags[flag]
        tally["good"] += int(has_count and not extrapolated)
        tally["extrapolated"] += extrapolated
    half_ns = BUILT["period_clocks"] * CLOCK_NS // 2
    assert seen["low"] == half_ns and seen["high"] >= half_ns, seen
    assert seen["pause"] >= BUILT["pause_clocks"] * CLOCK_NS, seen
    print("tally", json.dumps(tally))


async def rest_of(ticked_ns):
    left = ticked_ns + BUILT["tick_clocks"] * CLOCK_NS - get_sim_time("ns")
    if left > 0:
        await Timer(left, unit="ns")
