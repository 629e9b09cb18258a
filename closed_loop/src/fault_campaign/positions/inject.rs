//! Injects what happens to compare and capture themselves.

use rand::RngExt;

use super::{Positions, settings};
use crate::fault_campaign::case::Case;
use crate::fault_campaign::kind::FaultKind;
use crate::fault_campaign::machine::FILTER_CLOCKS;
use crate::stage_bench::StageBench;
use posicast_machine::plant::axis::EncoderPins;
use posicast_testbench::Error;

/// Counts of a fast push. They come within 100 clocks, so that a line changes every 11 clocks, and its filter needs 9.
const FAST_COUNTS: f64 = 18.0;
/// Clocks until a push is over.
const PUSHED_CLOCKS: u64 = 400;
/// Clocks between two looks of a host that takes entries.
const LOOK_CLOCKS: u64 = 400;

impl Positions {
    /// Injects the case's kind, if it is one of compare or capture; returns whether it is.
    pub(in crate::fault_campaign) fn inject(&mut self, bench: &mut StageBench, case: &Case) -> Result<bool, Error> {
        match self.kind {
            FaultKind::ProbeBounces
            | FaultKind::ProbeShort
            | FaultKind::ProbeFull
            | FaultKind::ProbeWindow
            | FaultKind::ProbeStuck
            | FaultKind::CompareOverlaps => {}
            FaultKind::ProbeTaken => {
                for _ in 0..70 {
                    bench.clocks(LOOK_CLOCKS)?;
                    self.take(bench)?;
                }
            }
            FaultKind::ProbeCleared => {
                for _ in 0..3 {
                    bench.clocks(self.rng.random_range(1..20_000))?;
                    self.from = bench.now();
                    self.is_cleared = true;
                    bench.write("capture_clear", 0)?;
                }
            }
            FaultKind::CompareWritten => self.write_settings(bench)?,
            FaultKind::CompareArmed => {
                for axis in 0..2 {
                    let mut row = settings::row(&mut self.rng, case, axis);
                    // The list cannot be written while armed.
                    while row.in_list {
                        row = settings::row(&mut self.rng, case, axis);
                    }
                    self.arm(bench, axis, row)?;
                }
            }
            FaultKind::CompareDisarmed => {
                for axis in 0..2 {
                    let name = bench.axes()[axis].clone();
                    if let Some(armed) = self.armed[axis].last_mut() {
                        armed.ended = Some(bench.now());
                    }
                    bench.write(&format!("{name}_compare_disarm"), 0)?;
                }
            }
            FaultKind::CompareGlitch => self.glitches(bench)?,
            FaultKind::CompareReversal => self.reversals(bench)?,
            FaultKind::CompareFast => {
                for way in [1.0, -1.0, -1.0, 1.0] {
                    (0..2).for_each(|axis| bench.displace(axis, way * FAST_COUNTS));
                    bench.clocks(PUSHED_CLOCKS)?;
                }
            }
            _ => {
                let is_lost = !case.row.expects.position_known;
                let now = bench.now();
                self.lost = [0, 1].map(|axis| (is_lost && case.hits(axis)).then_some(now));
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Writes every register of the compare but those that arm and disarm.
    fn write_settings(&mut self, bench: &mut StageBench) -> Result<(), Error> {
        for name in bench.axes().to_vec() {
            for register in [
                "first",
                "spacing",
                "positions",
                "pulse",
                "control",
                "entry",
                "entry",
                "clear",
            ] {
                bench.write(&format!("{name}_compare_{register}"), self.rng.random())?;
                bench.clocks(self.rng.random_range(0..200))?;
            }
        }
        Ok(())
    }

    /// Inverts A or B for a short time, again and again.
    fn glitches(&mut self, bench: &mut StageBench) -> Result<(), Error> {
        for _ in 0..40 {
            for axis in 0..2 {
                let (lines, of_a) = (bench.plant(axis).encoder(), self.rng.random::<bool>());
                let (a, b) = (lines.a ^ of_a, lines.b ^ !of_a);
                bench.force_encoder(axis, Some(EncoderPins { a, b, ..lines }));
            }
            bench.clocks(self.rng.random_range(1..=FILTER_CLOCKS))?;
            (0..2).for_each(|axis| bench.force_encoder(axis, None));
            bench.clocks(self.rng.random_range(3 * FILTER_CLOCKS..300))?;
        }
        Ok(())
    }

    /// Pushes both axes to and fro.
    fn reversals(&mut self, bench: &mut StageBench) -> Result<(), Error> {
        for _ in 0..24 {
            for axis in 0..2 {
                bench.displace(axis, f64::from(self.rng.random_range(-3..=3)));
            }
            bench.clocks(self.rng.random_range(150..1500))?;
        }
        Ok(())
    }
}
