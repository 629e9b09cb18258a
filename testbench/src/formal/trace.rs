//! The proofs of the trace memory.

use posicast_hdl::trace;
use posicast_model::rtl::trace::{SIGNALS, TraceConfig, ports};

use super::task::{Engine, Task};
use crate::Error;

/// The smallest memory and the largest.
pub(super) fn tasks() -> Result<Vec<Task>, Error> {
    [256, 2048].map(task).into_iter().collect()
}

fn task(samples: u64) -> Result<Task, Error> {
    let config = TraceConfig::new(samples).map_err(|error| Error::Option(error.to_string()))?;
    let signals = |separator: &str, before: &str| {
        let names = (0..SIGNALS).rev().map(|signal| format!("{before}signal_{signal}"));
        names.collect::<Vec<String>>().join(separator)
    };
    let macros = [
        ("SAMPLES", format!("12'd{samples}")),
        ("ADDRESS_BITS", config.address_bits().to_string()),
        ("SIGNAL_PORTS", signals(", ", "input wire [31:0] ")),
        ("ALL_SIGNALS", format!("{{{}}}", signals(", ", ""))),
    ];
    let block = (trace::emit(&config, "")?, ports());
    Ok(Task::new(
        "trace",
        &format!("{samples} words"),
        Engine::Induction { clocks: 1 },
        block,
    )
    .properties(&macros, include_str!("../../formal/trace.sv")))
}
