//! The controller component: reference and measurement come from registers or pins, one clock later; its settings
//! come from the active bank.

use super::super::composition::Part;
use super::{ComponentPart, Wiring};

/// Reference and measurement of a tick: pins of the component, and ports of the controller.
pub(super) const MOTION: [&str; 5] = [
    "position_reference",
    "velocity_reference",
    "acceleration_reference",
    "position",
    "velocity",
];
/// Output pins of the conduit.
const OUTPUTS: [&str; 3] = ["command", "duty", "valid"];

pub(super) fn wiring() -> Wiring<'static> {
    Wiring {
        part: Box::new(part),
        inputs: ["start"].into_iter().chain(MOTION).map(str::to_owned).collect(),
        outputs: OUTPUTS.map(str::to_owned).to_vec(),
    }
}

fn part(block: &ComponentPart, part: Part) -> Part {
    let motion = MOTION.iter().enumerate();
    match block {
        ComponentPart::SampleSelect { .. } => {
            let part = part
                .on("pin_strobe", "start")
                .on("strobe", "selected_start")
                .tied("host_start", 0)
                .tied("pin_start", 0)
                .on("start", "no_start");
            motion.fold(part, |part, (channel, name)| {
                part.on(&format!("pin_x_{channel}"), name)
                    .on(&format!("x_{channel}"), &format!("selected_{name}"))
            })
        }
        ComponentPart::SettingBanks(_) => part.on("row", "setting_address"),
        ComponentPart::SlidingMode => motion.fold(part.on("start", "selected_start"), |part, (_, name)| {
            part.on(name, &format!("selected_{name}"))
        }),
        _ => part,
    }
}
