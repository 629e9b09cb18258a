//! The PWM component: its duty and the feed of its watchdog come from registers or pins, one clock later. The pins of
//! the gates and of the raw faults are the block's own, without a register between.
//!
//! Its `clear_flags` is tied high: a flag is then high as long as its condition holds, and the register bank keeps
//! it.

use super::super::composition::Part;
use super::{ComponentPart, Wiring};

/// Input pins of the conduit.
const INPUTS: [&str; 6] = ["feed", "duty", "sync", "fault_n", "pll_locked", "filtered_fault_n"];
const OUTPUTS: [&str; 9] = [
    "a_high", "a_low", "b_high", "b_low", "running", "tripped", "valley", "peak", "trigger",
];
/// Width of a duty in bits.
pub(super) const DUTY_BITS: u32 = 17;

pub(super) fn wiring() -> Wiring<'static> {
    Wiring {
        part: Box::new(part),
        inputs: INPUTS.map(str::to_owned).to_vec(),
        outputs: OUTPUTS.map(str::to_owned).to_vec(),
    }
}

fn part(block: &ComponentPart, part: Part) -> Part {
    match block {
        ComponentPart::SampleSelect { .. } => part
            .on("pin_strobe", "feed")
            .on("pin_x_0", "duty")
            .on("strobe", "selected_feed")
            .on("x_0", "selected_duty")
            .tied("host_start", 0)
            .tied("pin_start", 0)
            .on("start", "no_start"),
        ComponentPart::Pwm(_) => part
            .on("feed", "selected_feed")
            .on("duty", "selected_duty")
            .tied("clear_flags", 1)
            .tied("mask_pins", 0),
        _ => part,
    }
}
