"""A probe, axes and a host at the block capture, written from its datasheet alone.

POSICAST_CAPTURE is a JSON object: the number of touches and the seed. The probe's line bounces in real time, also for less than a
clock; the axes move, and a host takes entries, clears, and moves the window. The line's samples, positions and commands are recorded.
From the whole recording the bench finds the edges, then the entries, and compares each output in each clock.
"""

import json
import os
import random
from itertools import groupby

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge, RisingEdge, Timer
from cocotb.utils import get_sim_time

ASKED = json.loads(os.environ["POSICAST_CAPTURE"])
CLOCK_NS = 10
# The datasheet's constants.
LATENCY_CLOCKS = 2
ENTRIES = 16
AXES = 4

COMMANDS = ("enable", "rises", "falls", "stamp", "windowed", "window_axis", "take", "clear", "clear_flags")
SIGNED = ("window_first", "window_last") + tuple(f"count_{axis}" for axis in range(AXES))
OUTPUTS = ("level", "level_known", "captured", "entries", "edges", "entry_valid", "entry_stamp", "entry_rising", "overflowed", "outside")
ENTRY = tuple(f"entry_count_{axis}" for axis in range(AXES))


class Probe:
    """The line: it touches, bounces, stays, and is free again."""

    def __init__(self, dut, rng, filter_clocks):
        self.dut, self.rng, self.filter_ns = dut, rng, max(filter_clocks, 1) * CLOCK_NS
        self.touches = False
        dut.line.value = 0

    async def wait(self, least_ns, most_ns):
        """Time until the next change, which is never at the clock's edge."""
        change = round(get_sim_time("ns")) + self.rng.randint(least_ns, most_ns)
        change += int(change % CLOCK_NS == 0)
        await Timer(change - round(get_sim_time("ns")), unit="ns")

    async def run(self):
        while True:
            # The rest is about the filter's length as often as much longer.
            await self.wait(*self.rng.choice(((self.filter_ns, 40 * CLOCK_NS + 4 * self.filter_ns), (1, 2 * self.filter_ns))))
            for _ in range(self.rng.choice((0, 0, 1, 3, 8))):
                self.dut.line.value = int(not self.touches)
                await self.wait(1, self.rng.choice((8, self.filter_ns, self.filter_ns + 12)))
                self.dut.line.value = int(self.touches)
                await self.wait(1, self.rng.choice((8, self.filter_ns)))
            self.touches = not self.touches
            self.dut.line.value = int(self.touches)


class Axes:
    """Four axes at changing speeds, in counts per clock."""

    def __init__(self, rng):
        self.rng = rng
        self.place = [rng.randint(-1 << 30, 1 << 30) * 1.0 for _ in range(AXES)]
        self.speed = [0.0] * AXES

    def move(self):
        for axis in range(AXES):
            if self.rng.random() < 0.01:
                self.speed[axis] = self.rng.choice((0, 0.1, -0.1, 1, -1, self.rng.uniform(-1, 1)))
            self.place[axis] += self.speed[axis]
        return [int(place // 1) for place in self.place]


def drive(dut, values):
    for name, value in values.items():
        getattr(dut, name).value = value


def read(dut):
    """The outputs of this clock; a bit that is x or z is an error."""
    shown = {name: int(getattr(dut, name).value) for name in OUTPUTS}
    shown.update({name: getattr(dut, name).value.to_signed() for name in ENTRY})
    return shown


def edges_of(samples, filter_clocks):
    """When the level is known, and the edges: (clock, level). A run of equal samples of the length of the filter counts."""
    least = max(filter_clocks, 1)
    known, edges, level, clock = None, [], None, 0
    for value, run in groupby(samples):
        length = len(list(run))
        if length >= least and value != level:
            at = clock + LATENCY_CLOCKS + least
            if level is None:
                known = (at, value)
            else:
                edges.append((at, value))
            level = value
        clock += length
    return known, edges


def wanted(now, rising):
    return bool(now["enable"] and (now["rises"] if rising else now["falls"]))


def in_window(now):
    return not now["windowed"] or now["window_first"] <= now[f"count_{now['window_axis']}"] <= now["window_last"]


def compare(recording, filter_clocks, tally):
    """Compares the recording of a run from one reset to the next with the datasheet."""
    known, edges = edges_of([now["line"] for now, _ in recording], filter_clocks)
    edge_at = dict(edges)
    level, level_known = 0, 0
    # Entries in the memory, each with the first clock in which it may be shown.
    memory, counted, captured, flags = [], 0, 0, {"overflowed": 0, "outside": 0}
    for clock, (now, shown) in enumerate(recording):
        if known and clock == known[0]:
            level_known, level = 1, known[1]
            tally["known_high"] += level
        if clock in edge_at:
            level = edge_at[clock]
        oldest = memory[0][1] if memory and memory[0][0] <= clock else None
        expected = {"level": level, "level_known": level_known, "captured": captured, "entries": len(memory), "edges": counted, **flags}
        expected["entry_valid"] = int(oldest is not None)
        expected.update(oldest or dict.fromkeys(("entry_stamp", "entry_rising") + ENTRY, 0))
        wrong = {name: (shown[name], value) for name, value in expected.items() if shown[name] != value}
        assert not wrong, f"clock {clock} of {len(recording)}, filter {filter_clocks}: (shown, expected) {wrong}"

        # What this clock does: the host first, then the edge.
        if now["clear_flags"]:
            flags = {"overflowed": 0, "outside": 0}
        if now["clear"]:
            tally["cleared"] += len(memory)
            memory, counted = [], 0
        elif now["take"] and oldest is not None:
            memory.pop(0)
            tally["taken"] += 1
        captured = 0
        if clock in edge_at and wanted(now, edge_at[clock]):
            counted += 1
            if not in_window(now):
                flags["outside"] = 1
                tally["outside"] += 1
            elif len(memory) == ENTRIES:
                flags["overflowed"] = 1
                tally["overflowed"] += 1
            else:
                captured = 1
                tally["captured"] += 1
                entry = {"entry_stamp": now["stamp"], "entry_rising": edge_at[clock]}
                entry.update({f"entry_count_{axis}": now[f"count_{axis}"] for axis in range(AXES)})
                memory.append((clock + 2, entry))
        elif clock in edge_at:
            tally["unwanted"] += 1
    # Samples of the line that changed it without becoming a level.
    runs = len(list(groupby(now["line"] for now, _ in recording)))
    tally["ignored"] += runs - 1 - len(edges)


def choose(rng, now, places):
    """Sometimes changes a setting."""
    if rng.random() < 0.02:
        now["enable"] = int(rng.random() < 0.9)
        now["rises"], now["falls"] = (int(rng.random() < 0.8) for _ in range(2))
    if rng.random() < 0.03:
        axis = rng.randrange(AXES)
        now["windowed"], now["window_axis"] = rng.choice((0, 0, 1)), axis
        now["window_first"] = places[axis] + rng.choice((-500, -20, 0, 1, 20))
        now["window_last"] = places[axis] + rng.choice((-20, -1, 0, 20, 500))


@cocotb.test()
async def captures_follow_the_probe(dut):
    rng = random.Random(ASKED["seed"])
    cocotb.start_soon(Clock(dut.clk, CLOCK_NS, unit="ns").start())
    drive(dut, dict.fromkeys(COMMANDS + SIGNED + ("line", "filter_clocks"), 0))
    names = ("captured", "taken", "cleared", "outside", "overflowed", "unwanted", "ignored", "known_high")
    tally = dict.fromkeys(names, 0)
    axes, stamp = Axes(rng), rng.getrandbits(32)
    for _ in range(ASKED["runs"]):
        filter_clocks = rng.choice((0, 1, 1, 2, 3, 5, 17))
        dut.filter_clocks.value, dut.rst.value = filter_clocks, 1
        probe = Probe(dut, rng, filter_clocks)
        if rng.random() < 0.5:
            probe.touches = True
            dut.line.value = 1
        await ClockCycles(dut.clk, 4)
        moving = cocotb.start_soon(probe.run())
        now = dict.fromkeys(COMMANDS + SIGNED, 0)
        now.update(enable=1, rises=1, falls=1)
        recording = []
        pace = 1.0
        for clock in range(ASKED["clocks"]):
            if clock % 300 == 0:
                pace = rng.choice((0.002, 0.05, 0.3, 1.0))
            places = axes.move()
            stamp = (stamp + 1) % (1 << 32)
            now.update({f"count_{axis}": place for axis, place in enumerate(places)}, stamp=stamp)
            choose(rng, now, places)
            now.update(take=int(rng.random() < pace), clear=int(rng.random() < 0.003), clear_flags=int(rng.random() < 0.05))
            dut.rst.value = 0
            drive(dut, now)
            await FallingEdge(dut.clk)
            shown = read(dut)
            await RisingEdge(dut.clk)
            # The line does not change in this moment: this is its sample.
            recording.append(({**now, "line": int(dut.line.value)}, shown))
        moving.cancel()
        compare(recording, filter_clocks, tally)
    print("tally", json.dumps(tally))
