//! Knowledge about the excitation of an accelerometer's log.

use posicast_identify::sweep::{SquareWave, Sweep, Sweeping};

/// Knowledge about the excitation of an accelerometer's log.
#[derive(Debug, Clone, Default)]
pub struct LogExcitation {
    /// The sweep of the resonance test; `None`: it is found in the log.
    pub sweep: Option<Sweep>,
    /// The excitation is unknown: modes are sought in the spectrum alone, as if the excitation were even.
    pub output_only: bool,
    /// The log is of a stop: modes are sought in the decay after it.
    pub ring_down: bool,
}

/// Parses a positive number.
///
/// # Errors
/// Returns the allowed values for any other text.
pub fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err("a number above 0".into()),
    }
}

/// Parses a sweep: first and last frequency in Hz, Hz per second, mm/s² per Hz, and with two more numbers the square wave beside it, in
/// mm/s² and s (a period of 0: none).
///
/// # Errors
/// Returns the required form for any other text.
pub fn sweep(text: &str) -> Result<Sweep, String> {
    let fields: Vec<&str> = text.split(':').collect();
    let numbers: Vec<f64> = fields
        .iter()
        .take(4)
        .map(|field| positive(field))
        .collect::<Result<_, _>>()?;
    let sweeping = match fields[..] {
        [_, _, _, _, _, "0"] => Sweeping::Off,
        [_, _, _, _, acceleration, period] => Sweeping::Wave(SquareWave {
            acceleration: 1e-3 * positive(acceleration)?,
            period_s: positive(period)?,
        }),
        _ => Sweeping::FromLog,
    };
    match numbers[..] {
        [start_hz, end_hz, rate_hz_per_s, per_hz] if end_hz > start_hz && matches!(fields.len(), 4 | 6) => Ok(Sweep {
            start_hz,
            end_hz,
            rate_hz_per_s,
            acceleration_per_hz: 1e-3 * per_hz,
            sweeping,
        }),
        _ => Err("four numbers as 5:135:1:60, the second above the first, or six as 5:135:1:60:400:1.2".into()),
    }
}
