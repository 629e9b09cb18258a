//! What a stage does within a tick, and in which clocks.

use std::fmt;

use crate::rtl::divider_share::SHARE_CLOCKS;
use crate::rtl::shaper::ShaperConfig;
use crate::rtl::sliding_mode::CONTROL_CLOCKS;

/// Clocks from the tick to the divider's first operands, and a clock for the last velocity.
const CAPTURE_CLOCKS: u32 = 4;
/// Clocks from the tick to the shaper's sample, and one to its end: the segments' five, and the strobe.
const GENERATE_CLOCKS: u32 = 7;
/// Clocks from the controller's `valid` to the duty at the PWM.
const OUTPUT_CLOCKS: u32 = 2;

/// The passes of a tick, in clocks after it. Shapers and divider work side by side; all controllers start together when the
/// slower of them is over at its longest, always in the same clock.
///
/// ```text
/// tick ─┬─► capture ─► divide, one pulse counter after the other ─┬─► control ─► duty at the PWM, for its next boundary
///       └─► generate ─► shape ────────────────────────────────────┘
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Schedule {
    divide: u32,
    shape: u32,
}

impl Schedule {
    /// Of axes with these shapers, and so many pulse counters.
    pub fn of(shapers: &[&ShaperConfig], counters: u32) -> Self {
        let passes = shapers.iter().map(|shaper| shaper.pass_clocks(shaper.most_products()));
        Self {
            divide: counters * SHARE_CLOCKS,
            shape: passes.max().unwrap_or(0),
        }
    }

    /// Clocks from the tick to the start of the controllers.
    pub fn control_clocks(&self) -> u32 {
        (CAPTURE_CLOCKS + self.divide).max(GENERATE_CLOCKS + self.shape)
    }

    /// Clocks from the tick to the new duty, which the PWM takes at its next boundary.
    pub fn duty_clocks(&self) -> u32 {
        self.control_clocks() + CONTROL_CLOCKS + OUTPUT_CLOCKS
    }
}

impl fmt::Display for Schedule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "capture and divide {CAPTURE_CLOCKS} + {}, beside generate and shape {GENERATE_CLOCKS} + {}; control from {} on, \
             {CONTROL_CLOCKS}; duty {OUTPUT_CLOCKS} later: {} clocks",
            self.divide,
            self.shape,
            self.control_clocks(),
            self.duty_clocks()
        )
    }
}
