//! Proofs of the trace memory, and of the selection between two sources of samples.

use posicast_hdl::{sample_select, trace};
use posicast_model::rtl::sample_select as select_model;
use posicast_model::rtl::trace::{SIGNALS, TraceConfig, ports};

use super::task::{INDUCTION, Task, refused};
use crate::Error;

/// Tasks for the smallest and the largest memory, and for one and three channels.
pub(super) fn tasks() -> Result<Vec<Task>, Error> {
    let traces = [256, 2048].map(trace_task);
    let selections = [1, 3].map(select_task);
    traces.into_iter().chain(selections).collect()
}

fn trace_task(samples: u64) -> Result<Task, Error> {
    let config = TraceConfig::new(samples).map_err(refused)?;
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
    Ok(Task::new("trace", &format!("{samples} words"), INDUCTION, block)
        .properties(&macros, include_str!("../../formal/trace.sv")))
}

fn select_task(channels: usize) -> Result<Task, Error> {
    const WORD_BITS: u32 = 32;
    let words = |before: &str| -> Vec<String> {
        (0..channels)
            .rev()
            .map(|channel| format!("{before}x_{channel}"))
            .collect()
    };
    let ports = [
        "input wire [31:0] host_",
        "input wire [31:0] pin_",
        "input wire [31:0] ",
    ]
    .map(|kind| words(kind).join(", "));
    let list = |before: &str| format!("{{{}}}", words(before).join(", "));
    let macros = [
        ("WORD_BITS", WORD_BITS.to_string()),
        ("CHANNELS", channels.to_string()),
        ("WORD_PORTS", ports.join(", ")),
        ("HOST_WORDS", list("host_")),
        ("PIN_WORDS", list("pin_")),
        ("WORDS", list("")),
    ];
    let block = (
        sample_select::emit(WORD_BITS, channels, "")?,
        select_model::ports(WORD_BITS as usize, channels),
    );
    let size = format!("{WORD_BITS} bits, {channels} channels");
    Ok(Task::new("sample_select", &size, INDUCTION, block)
        .properties(&macros, include_str!("../../formal/sample_select.sv")))
}
