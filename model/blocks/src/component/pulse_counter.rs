//! The pulse counter component: the time base makes ticks, and one clock after each the divider divides the counter's
//! operands.

use super::{ComponentPart, Wiring};

/// Input pins of the conduit.
const INPUTS: [&str; 6] = ["a", "b", "z", "a_n", "b_n", "z_n"];
const OUTPUTS: [&str; 4] = ["tick", "position", "velocity", "velocity_valid"];

pub(super) fn wiring() -> Wiring<'static> {
    Wiring {
        part: Box::new(|block, part| match block {
            ComponentPart::PulseCounter => part.on("time_stamp", "edge_stamp"),
            ComponentPart::Divider(_) => part
                .on("start", "divide")
                .on("done", "quotient_valid")
                .on("busy", "divider_busy")
                .on("overrun", "divider_overrun")
                .tied("clear_flags", 1),
            _ => part,
        }),
        inputs: INPUTS.map(str::to_owned).to_vec(),
        outputs: OUTPUTS.map(str::to_owned).to_vec(),
    }
}
