//! The shaper component: its samples come from registers or from the pins `strobe`, `start` and `x`, one clock later.
//!
//! Its `clear_flags` is tied high: a flag is then high for the one clock after its event, and the register bank keeps
//! it.

use super::super::composition::Part;
use super::super::registers::maps::word_name;
use super::super::shaper::ShaperConfig;
use super::{ComponentPart, Wiring};

pub(super) fn wiring(config: &ShaperConfig) -> Wiring<'static> {
    let strobes = ["strobe", "start"].map(str::to_owned);
    Wiring {
        part: Box::new(rewire(words(config, "x"))),
        inputs: [strobes.to_vec(), words(config, "x")].concat(),
        outputs: [words(config, "y"), vec!["valid".to_owned()]].concat(),
    }
}

fn words(config: &ShaperConfig, name: &str) -> Vec<String> {
    let channels = 0..config.channels();
    channels.map(|channel| word_name(config, name, channel)).collect()
}

/// Connects the words; `xs` has their pins, which are also the shaper's ports.
fn rewire(xs: Vec<String>) -> impl Fn(&ComponentPart, Part) -> Part {
    move |block, part| {
        let words = xs.iter().enumerate();
        match block {
            ComponentPart::SampleSelect { .. } => {
                let part = part
                    .on("pin_strobe", "strobe")
                    .on("pin_start", "start")
                    .on("strobe", "sample_strobe")
                    .on("start", "sample_start");
                words.fold(part, |part, (channel, x)| {
                    part.on(&format!("pin_x_{channel}"), x)
                        .on(&format!("x_{channel}"), &format!("sample_x_{channel}"))
                })
            }
            ComponentPart::Shaper(_) => {
                let part = part
                    .on("strobe", "sample_strobe")
                    .on("start", "sample_start")
                    .tied("clear_flags", 1);
                words.fold(part, |part, (channel, x)| part.on(x, &format!("sample_x_{channel}")))
            }
            _ => part,
        }
    }
}
