//! A feed hold on the example's stage, in lockstep with its Verilog: all axes stop in the same tick, on the path, and
//! continue from there.
#![allow(clippy::unwrap_used)] // helpers of tests, which clippy.toml exempts only inside of #[test]

use posicast_blocks::segments::{Entry, EntryMotion};
use posicast_closed_loop::stage_bench::{StageBench, state};
use posicast_machine::motion::{TickLimits, plan_move};
use posicast_machine::plant::axis::PlantOptions;

use crate::support::{XY, bench, machine, stage, verilated};

/// Corner of the path in counts: along X, then X and Y together.
const CORNER: i64 = 20;

struct Bed {
    bench: StageBench,
    limits: TickLimits,
    tick_clocks: u64,
}

fn bed() -> Bed {
    let machine = machine(XY);
    let stage = stage(&machine);
    let mut bench = bench(&machine, &stage, &PlantOptions::default(), Some(verilated(&stage)), 1);
    assert!(bench.switch_on(20_000_000).unwrap());
    Bed {
        bench,
        limits: TickLimits::of_axis(&machine.axes[0], &machine.clock),
        tick_clocks: stage.config.tick.tick_clocks().into(),
    }
}

impl Bed {
    /// Returns both commands in LSB of counts.
    fn at(&mut self) -> [i64; 2] {
        ["x", "y"].map(|axis| {
            let word = self.bench.read(&format!("{axis}_command_position")).unwrap();
            i64::from(word as i32)
        })
    }

    fn queue(&mut self, axis: &str, entries: &[Entry]) {
        for entry in entries {
            self.bench.segment(axis, entry).unwrap();
        }
    }

    /// Advances by a tick; returns whether the commands are on the path: along X to the corner, then equally fast in
    /// both, back and down.
    fn tick(&mut self) -> bool {
        self.bench.clocks(self.tick_clocks - 2).unwrap();
        let [x, y] = self.at();
        y == 0 || x - (CORNER << 8) == y
    }

    fn both(&mut self, register: &str, field: &str) -> [u32; 2] {
        ["x", "y"].map(|axis| self.bench.field(axis, register, field).unwrap())
    }
}

fn ticks(entries: &[Entry]) -> u32 {
    entries.iter().map(|entry| entry.ticks).sum()
}

#[test]
fn lockstep_a_feed_hold_keeps_path_and_queue() {
    let mut bed = bed();
    assert_eq!(bed.at(), [0, 0]);
    let out = plan_move(0, (CORNER << 8) as i32, &bed.limits).unwrap();
    let down = plan_move(0, (-CORNER << 8) as i32, &bed.limits).unwrap();
    let dwell = Entry {
        ticks: ticks(&out),
        motion: EntryMotion::Jerk(0),
        notify: false,
    };
    // X rests while Y dwells, but never the other way round: an axis that stopped by itself would leave the path.
    bed.queue("y", &[dwell]);
    bed.queue("y", &down);
    bed.queue("x", &out);
    let back = plan_move(CORNER << 32, 0, &bed.limits).unwrap();
    assert_eq!(ticks(&back), ticks(&down));
    bed.queue("x", &back);
    bed.bench.write("start", 3).unwrap();
    for _ in 0..ticks(&out) / 2 {
        assert!(bed.tick());
    }
    let [x, y] = bed.at();
    assert!(x > 0 && x < CORNER << 8 && y == 0, "in the first move: {x} {y}");
    bed.bench.write("feed_hold", 3).unwrap();
    for _ in 0..ticks(&out) {
        assert!(bed.tick());
    }
    // It is at the corner, with the second move in both FIFOs.
    assert_eq!(bed.at(), [CORNER << 8, 0]);
    assert_eq!(bed.both("fifo", "feed_held"), [1, 1]);
    assert_eq!(bed.both("status", "state"), [state::RUN; 2]);
    let left = bed.both("fifo", "fifo_level");
    assert!(left.iter().all(|level| *level > 0), "{left:?}");

    bed.bench.write("feed_hold", 0).unwrap();
    for _ in 0..ticks(&down) + 4 {
        assert!(bed.tick());
    }
    assert_eq!(bed.at(), [0, -CORNER << 8]);
    assert_eq!(bed.both("fifo", "feed_held"), [0, 0]);
    assert_eq!(bed.both("status", "state"), [state::HOLD; 2]);
    assert_eq!(bed.both("causes", "causes"), [0, 0]);
    assert_eq!(bed.bench.mismatches(), (0, None));
}
