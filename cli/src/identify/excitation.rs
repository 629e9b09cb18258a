//! Options that describe the excitation of an accelerometer's log.

use posicast_identify::sweep::Sweep;

#[derive(clap::Args, Default)]
pub(super) struct ExcitationFlags {
    /// Sweep of the resonance test: first and last frequency in Hz, Hz per second, mm/s² per Hz
    #[arg(long, value_name = "START:END:RATE:ACCEL", default_value = "5:135:1:60", value_parser = sweep)]
    pub(super) sweep: Sweep,
    /// The excitation is not known: look for modes in the spectrum alone, as if it were even
    #[arg(long, conflicts_with = "sweep")]
    pub(super) output_only: bool,
    /// The log of an accelerometer is of a stop: look for modes in what rings after it
    #[arg(long, conflicts_with_all = ["sweep", "output_only"])]
    pub(super) ring_down: bool,
}

/// Parses a positive number.
pub(super) fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err("a number above 0".into()),
    }
}

fn sweep(text: &str) -> Result<Sweep, String> {
    let numbers: Vec<f64> = text.split(':').map(positive).collect::<Result<_, _>>()?;
    match numbers[..] {
        [start_hz, end_hz, rate_hz_per_s, per_hz] if end_hz > start_hz => Ok(Sweep {
            start_hz,
            end_hz,
            rate_hz_per_s,
            acceleration_per_hz: 1e-3 * per_hz,
        }),
        _ => Err("four numbers as 5:135:1:60, the second above the first".into()),
    }
}
