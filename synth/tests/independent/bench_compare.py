"""A count that walks, at the block compare; what must come is worked out from the datasheet, over the whole walk at once.

POSICAST_COMPARE is a JSON object with the number of walks and the seed. Each walk is armed with a row or a list of positions, a
direction, a hysteresis and a width of the pulse, all chosen at random; the count runs, turns, stands and jitters.
"""

import json
import os
import random

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ReadOnly, RisingEdge

ASKED = json.loads(os.environ["POSICAST_COMPARE"])
LATENCY_CLOCKS = 2
LIST_STEP_CLOCKS = 3


def walk_from(start, positions, rng, steps):
    """Counts that change by one at most; at a position the walk often jitters for a while."""
    counts, count, heading = [], start, 1
    for _ in range(steps):
        if rng.random() < 0.05:
            heading = rng.choice([1, -1])
        elif count in positions and rng.random() < 0.1:
            heading = 0
        count += rng.choice([-1, 1]) if heading == 0 else heading if rng.random() < 0.8 else 0
        counts.append(count)
    return counts


def expected_passes(start, counts, positions, directions, hysteresis):
    """(index of the count, upward) of each pulse."""
    passes, last, since = [], None, []
    before = start
    for index, count in enumerate(counts):
        if count != before:
            edge = max(count, before)
            upward = count > before
            wanted = directions["rises"] if upward else directions["falls"]
            if edge in positions and wanted:
                # The way from the edge between edge - 1 and edge, seen from either side.
                away = max((c - edge if c >= edge else edge - 1 - c for c in since), default=0)
                if last != edge or away >= hysteresis:
                    passes.append((index, upward))
                    last, since = edge, []
        since.append(count)
        before = count
    return passes


async def clocked(dut, **values):
    for name, value in values.items():
        getattr(dut, name).value = value
    await RisingEdge(dut.clk)


@cocotb.test()
async def walks_pass_their_positions(dut):
    rng = random.Random(ASKED["seed"])
    cocotb.start_soon(Clock(dut.clk, 10, unit="ns").start())
    for name in ("count", "arm", "disarm", "use_list", "first", "spacing", "positions", "rises", "falls", "hysteresis", "pulse_clocks", "entry", "entry_write", "entries_clear", "clear_flags"):
        getattr(dut, name).value = 0
    await clocked(dut, rst=1)
    await clocked(dut, rst=0)
    tally = {"row": 0, "list": 0, "upward": 0, "downward": 0, "merged": 0, "held": 0}
    for number in range(ASKED["walks"]):
        start = rng.choice([0, rng.randint(-200, 200), rng.randint(-(1 << 31) + 2000, (1 << 31) - 2000)])
        from_list = rng.random() < 0.5
        first = start + rng.randint(-40, 40)
        if from_list:
            positions = [first]
            for _ in range(rng.choice([0, 1, 3, 10, 60])):
                positions.append(positions[-1] + rng.choice([4, 4, 5, 7, 20]))
        else:
            spacing = rng.choice([1, 1, 2, 3, 4, 10, 50])
            positions = [first + k * spacing for k in range(rng.choice([1, 1, 2, 5, 30]))]
        directions = rng.choice([{"rises": 1, "falls": 1}, {"rises": 1, "falls": 1}, {"rises": 1, "falls": 0}, {"rises": 0, "falls": 1}])
        hysteresis = rng.choice([0, 0, 1, 2, 5])
        width = rng.choice([1, 1, 2, 3, 8, 30])

        await clocked(dut, disarm=1, entries_clear=0)
        await clocked(dut, disarm=0, entries_clear=1, count=start)
        await clocked(dut, entries_clear=0)
        if from_list:
            for entry in positions:
                await clocked(dut, entry=entry, entry_write=1)
            dut.entry_write.value = 0
        else:
            dut.spacing.value = spacing
        settings = {"use_list": int(from_list), "first": first, "positions": len(positions), "hysteresis": hysteresis, "pulse_clocks": width}
        await clocked(dut, arm=1, **settings, **directions)
        # The settings count in the clock of arm alone.
        await clocked(dut, arm=0, first=0, positions=0, hysteresis=0, pulse_clocks=0, rises=0, falls=0, use_list=0)
        for _ in range(LIST_STEP_CLOCKS * len(positions) + 10):
            await clocked(dut)
        await ReadOnly()
        assert dut.ready.value == 1, f"walk {number}: not ready"
        await RisingEdge(dut.clk)

        counts = walk_from(start, set(positions), rng, 600)
        passes = expected_passes(start, counts, set(positions), directions, hysteresis)
        at = dict(passes)
        seen, high = [], []
        for index in range(len(counts) + LATENCY_CLOCKS + width):
            dut.count.value = counts[min(index, len(counts) - 1)]
            await RisingEdge(dut.clk)
            # The count of this index is taken at this edge.
            await ReadOnly()
            if dut.passed.value == 1:
                seen.append((index - LATENCY_CLOCKS + 1, dut.passed_upward.value == 1))
            high.append(int(dut.pulse.value))
            await cocotb.triggers.Timer(1, unit="ns")
        where = f"walk {number}, {'list' if from_list else 'row'} of {len(positions)}"
        assert seen == passes, f"{where}: {seen[:5]}, not {passes[:5]}"
        wanted = [int(any(index - k - LATENCY_CLOCKS + 1 in at for k in range(width))) for index in range(len(high))]
        assert high == wanted, f"{where}: the pulses differ"
        assert int(dut.passes.value) == len(passes), where
        tally["list" if from_list else "row"] += len(passes)
        tally["upward"] += sum(upward for _, upward in passes)
        tally["downward"] += sum(not upward for _, upward in passes)
        tally["merged"] += sum(1 for (a, _), (b, _) in zip(passes, passes[1:]) if b - a < width)
        plain = expected_passes(start, counts, set(positions), directions, 0)
        tally["held"] += len(plain) - len(passes)
    print("tally", json.dumps(tally))
