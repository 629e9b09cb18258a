//! The shaper: its samples come from registers or from the pins `strobe`, `start` and `x`, one clock later.
//!
//! Its `clear_flags` is tied high. A flag is then high for the one clock after what it tells of, and the bank keeps it.

use super::super::composition::Part;
use super::super::registers::maps::word_name;
use super::super::shaper::ShaperConfig;
use super::{Block, Wiring};

pub(super) fn wiring(config: &ShaperConfig) -> Wiring {
    let strobes = ["strobe", "start"].map(str::to_owned);
    Wiring {
        part,
        inputs: [strobes.to_vec(), words(config, "x")].concat(),
        outputs: [words(config, "y"), vec!["valid".to_owned()]].concat(),
    }
}

fn words(config: &ShaperConfig, name: &str) -> Vec<String> {
    let channels = 0..config.channels();
    channels.map(|channel| word_name(config, name, channel)).collect()
}

fn part(block: &Block, part: Part) -> Part {
    match block {
        Block::SampleSelect(config) => {
            let part = part
                .on("pin_strobe", "strobe")
                .on("pin_start", "start")
                .on("strobe", "sample_strobe")
                .on("start", "sample_start");
            let pins = words(config, "x").into_iter().enumerate();
            pins.fold(part, |part, (channel, pin)| {
                part.on(&format!("pin_x_{channel}"), &pin)
                    .on(&format!("x_{channel}"), &format!("sample_x_{channel}"))
            })
        }
        Block::Shaper(config) => {
            let part = part
                .on("strobe", "sample_strobe")
                .on("start", "sample_start")
                .tied("clear_flags", 1);
            let ports = words(config, "x").into_iter().enumerate();
            ports.fold(part, |part, (channel, port)| {
                part.on(&port, &format!("sample_x_{channel}"))
            })
        }
        _ => part,
    }
}
