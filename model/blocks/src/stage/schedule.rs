//! The timing of a stage's computations within a tick.

use std::fmt;

use crate::divider_share::SHARE_CLOCKS;
use crate::linear_scale;
use crate::segments;
use crate::shaper::ShaperConfig;
use crate::sliding_mode::CONTROL_CLOCKS;

/// Clocks from the tick to the divider's first operands, plus a clock for the last velocity.
const CAPTURE_CLOCKS: u32 = 4;
/// Clocks from the tick to the shaper's sample and from its result on: the latency of the segments, the strobe, and
/// the test signal.
const GENERATE_CLOCKS: u32 = segments::LATENCY_CLOCKS + 3;
/// Clocks from the controller's `valid` to the duty at the PWM.
const OUTPUT_CLOCKS: u32 = 2;

/// The computations of a tick, in clocks after it. Shapers and divider work in parallel; all controllers start
/// together when the longest time of the slower one is over, always in the same clock.
///
/// ```text
/// tick ─┬─► capture ─► divide, one axis after the other ─► scale ─┬─► control ─► duty at the PWM, for its next boundary
///       ├─► generate ─► shape ────────────────────────────────────┤
///       └─► read the absolute encoders ───────────────────────────┘
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StageSchedule {
    divide: u32,
    /// Clocks to convert the last velocity to counts of the scale.
    scale: u32,
    /// With the error table's pass behind the shaper's.
    shape: u32,
    /// Clocks of the longest reading of an absolute encoder, and of what follows from it.
    read: u32,
    /// Whether an axis has a controller.
    controls: bool,
}

impl StageSchedule {
    /// Computes the schedule of axes with these shapers and clocks of the error tables behind them. `controls`: an axis has a
    /// controller; `on_scale`: the loop of an axis runs on its scale; `read`: clocks of the longest reading of an absolute encoder,
    /// or 0.
    pub fn of(axes: &[(&ShaperConfig, u32)], controls: bool, on_scale: bool, read: u32) -> Self {
        let passes = axes
            .iter()
            .map(|(shaper, table_clocks)| shaper.pass_clocks(shaper.most_products()) + table_clocks);
        Self {
            divide: axes.len() as u32 * SHARE_CLOCKS,
            scale: if on_scale { linear_scale::LATENCY_CLOCKS } else { 0 },
            shape: passes.max().unwrap_or(0),
            read,
            controls,
        }
    }

    /// Clocks from the tick to the start of controllers and step generators.
    pub fn control_clocks(&self) -> u32 {
        let measured = CAPTURE_CLOCKS + self.divide + self.scale;
        measured.max(GENERATE_CLOCKS + self.shape).max(self.read)
    }

    /// Clocks from the tick to the new duty, which the PWM takes at its next boundary; in a stage of steps alone, to the start of the
    /// step generators.
    pub fn duty_clocks(&self) -> u32 {
        self.control_clocks()
            + if self.controls {
                CONTROL_CLOCKS + OUTPUT_CLOCKS
            } else {
                0
            }
    }
}

impl fmt::Display for StageSchedule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "capture, divide and scale {CAPTURE_CLOCKS} + {} + {}, beside generate and shape {GENERATE_CLOCKS} + {}; ",
            self.divide, self.scale, self.shape,
        )?;
        if self.read > 0 {
            write!(f, "read {}; ", self.read)?;
        }
        let from = self.control_clocks();
        if self.controls {
            write!(
                f,
                "control from {from} on, {CONTROL_CLOCKS}; duty {OUTPUT_CLOCKS} later: "
            )?;
        } else {
            write!(f, "steps from {from} on: ")?;
        }
        write!(f, "{} clocks", self.duty_clocks())
    }
}
