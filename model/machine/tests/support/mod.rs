//! Machines for the tests of the mathematics, written as machine files.

pub(crate) mod golden;

use posicast_machine::machine_file::{Machine, parse};

/// Returns one axis `x` at `sample_hz`: `shaper` has the lines under `[axis.shaper]`; each mode has a frequency, a
/// damping and further lines.
pub(crate) fn machine(sample_hz: u32, digitise: &str, shaper: &str, modes: &[(f64, f64, &str)]) -> Machine {
    let clock_hz = sample_hz * 1000;
    let mut text = format!(
        "name = \"test\"\n[clock]\nfrequency_hz = {clock_hz}\nsample_hz = {sample_hz}\n[fixed_point]\n\
         digitise = \"{digitise}\"\n[[axis]]\nname = \"x\"\ncounts_per_unit = 1_000_000\n[axis.shaper]\n{shaper}\n"
    );
    for (frequency_hz, damping, more) in modes {
        text += &format!("[[axis.mode]]\nfrequency_hz = {frequency_hz:?}\ndamping = {damping:?}\n{more}\n");
    }
    parse("test.toml", &text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// Returns `kind = "…"` with the tolerance that EI kinds need.
pub(crate) fn shaper(kind: &str, tolerance: f64) -> String {
    let tolerance = if kind.ends_with("ei") {
        format!("tolerance = {tolerance:?}")
    } else {
        String::new()
    };
    format!("kind = \"{kind}\"\n{tolerance}")
}
