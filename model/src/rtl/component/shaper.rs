//! The shaper: its samples come from registers or from the pins `strobe`, `start` and `x`, one clock later.
//!
//! Its `clear_flags` is tied high. A flag is then high for the one clock after what it tells of, and the bank keeps it.

use super::super::registers::maps::word_name;
use super::super::shaper::ShaperConfig;
use super::{Block, Wiring};

pub(super) fn wiring(config: &ShaperConfig) -> Wiring {
    let words = |name: &str| -> Vec<String> {
        (0..config.channels())
            .map(|channel| word_name(config, name, channel))
            .collect()
    };
    let xs = words("x");
    let pins = xs.clone();
    Wiring {
        part: Box::new(move |block, part| match block {
            Block::SampleSelect(_) => {
                let part = part
                    .on("pin_strobe", "strobe")
                    .on("pin_start", "start")
                    .on("strobe", "sample_strobe")
                    .on("start", "sample_start");
                pins.iter().enumerate().fold(part, |part, (channel, pin)| {
                    part.on(&format!("pin_x_{channel}"), pin)
                        .on(&format!("x_{channel}"), &format!("sample_x_{channel}"))
                })
            }
            Block::Shaper(_) => {
                let part = part
                    .on("strobe", "sample_strobe")
                    .on("start", "sample_start")
                    .tied("clear_flags", 1);
                pins.iter().enumerate().fold(part, |part, (channel, port)| {
                    part.on(port, &format!("sample_x_{channel}"))
                })
            }
            _ => part,
        }),
        inputs: ["strobe".to_owned(), "start".to_owned()]
            .into_iter()
            .chain(xs)
            .collect(),
        outputs: words("y").into_iter().chain(["valid".to_owned()]).collect(),
    }
}
