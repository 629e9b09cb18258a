//! Position compare and capture in every case of the campaign: while faults happen, positions are passed and a probe touches.
//!
//! ```text
//!  HOLD ─► arm, enable ─► move, fault, touches at random clocks ─► a touch at rest ─► read ─► small move ─► judge the pulses
//! ```
//!
//! The oracle is a record of the pins, not the blocks: the count is that of the edges on the encoder's lines (or of the steps),
//! and the pulses and entries are those of the datasheets for this count, to the clock. An absolute encoder has no edges: there a
//! captured position must be one that the plant had within a tick and a reading.
//!
//! | part | what it is |
//! |---|---|
//! | `rows` | the kinds that happen to compare and capture themselves |
//! | `settings` | random rows of positions, filters, windows, and clocks of touches |
//! | `counted` | the count from the recorded lines |
//! | `passages`, `touches` | the pulses and the entries that must come of it |
//! | `judge` | compares them with the pins and the registers |

mod counted;
mod inject;
mod judge;
mod passages;
pub(super) mod rows;
mod settings;
mod touches;

use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;

use self::passages::Row;
use self::touches::Touched;
use super::case::Case;
use super::kind::FaultKind;
use super::machine::Bed;
use crate::stage_bench::StageBench;
use posicast_testbench::Error;

/// Pin of the probe.
const LINE: &str = "capture_line";
/// Clocks of a touch at rest, and after it: longer than any filter of a case and all latencies.
const REST_CLOCKS: u64 = 60;
/// Number of pins that are recorded in front of those of the axes: the reset and the probe.
const SHARED_PINS: usize = 2;
/// Pins of an axis that are recorded: its two lines, and the pulse.
const AXIS_PINS: usize = 3;

/// A row that a host armed.
#[derive(Debug, Clone)]
struct Armed {
    row: Row,
    /// Clock of the host's write.
    written: u64,
    /// Clock in which `compare_ready` rose.
    ready: u64,
    /// Clock of the write that ended it.
    ended: Option<u64>,
}

/// An entry as a host reads it.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Entry {
    counts: [i64; 2],
    stamp: u32,
    rising: bool,
}

/// What the registers showed at rest.
#[derive(Debug, Clone, Copy, Default)]
struct Flags {
    clock: u64,
    edges: u32,
    overflowed: bool,
    outside: bool,
    /// Of each axis: merged, jumped, refused.
    compare: [[bool; 3]; 2],
}

/// Compare and capture of a case.
pub(super) struct Positions {
    rng: Xoshiro256PlusPlus,
    kind: FaultKind,
    /// The rows of each axis; none if the machine has no compare.
    armed: [Vec<Armed>; 2],
    /// Clocks of the filter of each axis's encoder.
    encoder_filter_clocks: [u64; 2],
    touched: Touched,
    /// Clock before which no edge is wanted: the capture was enabled, or cleared by a host.
    from: u64,
    is_cleared: bool,
    /// Clock from which on the encoder of an axis is faulty for good, if it is.
    lost: [Option<u64>; 2],
    taken: Vec<Entry>,
    flags: Flags,
}

impl Positions {
    /// Arms rows of positions and enables the capture, in HOLD; `None` for a machine that has neither.
    pub(super) fn begin(bench: &mut StageBench, bed: &Bed, case: &Case) -> Result<Option<Self>, Error> {
        if !bench.has("capture_control") {
            return Ok(None);
        }
        let seed = u64::from(case.choice) ^ case.number << 32;
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        let touched = settings::touched(&mut rng, case);
        let mut found = Self {
            kind: case.row.kind,
            armed: [Vec::new(), Vec::new()],
            encoder_filter_clocks: [0, 1].map(|axis| bed.encoder_filter_clocks(axis)),
            touched,
            from: 0,
            is_cleared: false,
            lost: [None; 2],
            taken: Vec::new(),
            flags: Flags::default(),
            rng,
        };
        for axis in 0..2 {
            let name = bench.axes()[axis].clone();
            if bench.has(&format!("{name}_compare_control")) {
                let row = settings::row(&mut found.rng, case, axis);
                found.arm(bench, axis, row)?;
            }
        }
        found.enable(bench)?;
        Ok(Some(found))
    }

    /// Begins the record, before the reset of the bench is over or in the first clocks after it; a probe that is stuck touches
    /// already then.
    pub(super) fn record(bench: &mut StageBench, case: &Case) -> Result<(), Error> {
        if !bench.has("capture_control") {
            return Ok(());
        }
        let mut pins = vec!["rst".to_owned(), LINE.to_owned()];
        for name in bench.axes().to_vec() {
            if bench.has(&format!("{name}_compare_control")) {
                let lines = if bench.has(&format!("{name}_given_steps")) {
                    ["step", "direction"]
                } else {
                    ["a", "b"]
                };
                let own = [lines[0], lines[1], "compare"];
                pins.extend(own.map(|pin| format!("{name}_{pin}")));
            }
        }
        bench.record_pins(&pins)?;
        if case.row.kind == FaultKind::ProbeStuck {
            bench.set(LINE, 1)?;
        }
        // The record begins with the reset.
        bench.reset(2)
    }

    /// Schedules the touches of the probe; the fault is at about this clock.
    pub(super) fn schedule(&mut self, bench: &mut StageBench, fault: u64) -> Result<(), Error> {
        let changes = settings::changes(&mut self.rng, self.kind, bench.now(), fault);
        for (at, clock) in changes.into_iter().enumerate() {
            bench.schedule(LINE, clock, u64::from(at % 2 == 0))?;
        }
        Ok(())
    }

    /// Enables the capture with the settings of the case.
    fn enable(&mut self, bench: &mut StageBench) -> Result<(), Error> {
        let of = &self.touched;
        let mut control = 1 | u32::from(of.wanted[0]) << 1 | u32::from(of.wanted[1]) << 2;
        if let Some((axis, first, last)) = of.window {
            control |= 1 << 3 | (axis as u32) << 4;
            bench.write("capture_window_first", first as u32)?;
            bench.write("capture_window_last", last as u32)?;
        }
        bench.write("capture_clear", 0)?;
        bench.write("capture_control", control | (of.filter_clocks as u32) << 16)?;
        self.from = bench.now();
        Ok(())
    }

    /// Arms a row, and waits until it is ready.
    fn arm(&mut self, bench: &mut StageBench, axis: usize, row: Row) -> Result<(), Error> {
        let name = bench.axes()[axis].clone();
        let register = |register: &str| format!("{name}_compare_{register}");
        if row.in_list {
            bench.write(&register("clear"), 0)?;
            for position in &row.positions {
                bench.write(&register("entry"), *position as u32)?;
            }
        } else {
            let first = row.positions.first().copied().unwrap_or(0);
            bench.write(&register("first"), first as u32)?;
            bench.write(&register("spacing"), row.spacing as u32)?;
            bench.write(&register("positions"), row.positions.len() as u32)?;
        }
        bench.write(&register("pulse"), row.pulse_clocks as u32)?;
        let flags = [row.wanted[0], row.wanted[1], row.in_list].map(u32::from);
        let control = flags[0] | flags[1] << 1 | flags[2] << 2 | (row.hysteresis as u32) << 16;
        bench.write(&register("control"), control)?;
        let written = bench.now();
        bench.write(&register("arm"), 0)?;
        let ready = bench.probe(&register("ready"))?;
        // The write takes a few clocks to the block, which may still be ready from the row before.
        bench.clocks(judge::WRITE_CLOCKS)?;
        let most = written + judge::ready_clocks(&row);
        while bench.at(ready) == 0 && bench.now() <= most {
            bench.clocks(1)?;
        }
        if let Some(before) = self.armed[axis].last_mut() {
            before.ended.get_or_insert(written);
        }
        self.armed[axis].push(Armed {
            row,
            written,
            ready: bench.now(),
            ended: None,
        });
        Ok(())
    }

    /// A touch at rest, with whatever the fault left; then reads all entries and flags.
    pub(super) fn read(&mut self, bench: &mut StageBench) -> Result<(), Error> {
        bench.drop_schedule();
        bench.clocks(REST_CLOCKS)?;
        let level = bench.net(LINE)?;
        for (at, changed) in [(1, 1 - level), (1 + REST_CLOCKS, level)] {
            bench.schedule(LINE, bench.now() + at, changed)?;
        }
        bench.clocks(3 * REST_CLOCKS)?;
        self.flags.clock = bench.now();
        self.flags.edges = bench.read("capture_edges")?;
        let state = bench.read("capture_state")?;
        self.flags.overflowed = state >> 10 & 1 != 0;
        self.flags.outside = state >> 11 & 1 != 0;
        while self.take(bench)? {}
        for axis in 0..2 {
            let name = bench.axes()[axis].clone();
            if self.armed[axis].is_empty() {
                continue;
            }
            let state = bench.read(&format!("{name}_compare_state"))?;
            self.flags.compare[axis] = [2, 3, 4].map(|bit| state >> bit & 1 != 0);
        }
        Ok(())
    }

    /// Takes the oldest entry, if there is one.
    fn take(&mut self, bench: &mut StageBench) -> Result<bool, Error> {
        let state = bench.read("capture_state")?;
        if state >> 8 & 1 == 0 {
            return Ok(false);
        }
        let mut counts = [0; 2];
        for (axis, count) in counts.iter_mut().enumerate() {
            *count = i64::from(bench.read(&format!("capture_count_{axis}"))? as i32);
        }
        self.taken.push(Entry {
            counts,
            stamp: bench.read("capture_stamp")?,
            rising: state >> 9 & 1 != 0,
        });
        bench.write("capture_take", 0)?;
        bench.clocks(judge::WRITE_CLOCKS)?;
        Ok(true)
    }
}
