//! Input shapers of printer firmware, as the firmware computes them from what its user writes.
//!
//! An export writes numbers, but a printer moves by the impulses that its firmware computes from them. These modules repeat the
//! computation, so that an export can report the printer's residual, and can search for the best of a firmware's own shapers if the
//! firmware cannot take a design:
//!
//! | module | firmware | takes |
//! |---|---|---|
//! | [`klipper`] | Klipper, its branch `advanced-features`, Kalico | the name of a kind, undamped frequency, damping ratio; the branches also impulses and a polynomial |
//! | [`marlin`] | Marlin, `M593` and `M493` | the frequency and damping ratio of a kind |
//! | [`reprapfirmware`] | RepRapFirmware, `M593 P"custom"` | impulses |
//!
//! What a firmware takes depends on its version ([`version`]). The sources, with their dates, are in docs/exports.md.

mod classic_ei;
pub mod closest;
pub mod klipper;
pub mod marlin;
pub mod merge;
pub mod reprapfirmware;
pub mod smoother;
pub mod version;

use crate::impulse::{Impulse, ImpulseSequence};

/// Impulses of amplitudes that need not sum to one; `None` where they are no shaper.
fn normalised(times_s: &[f64], amplitudes: &[f64]) -> Option<ImpulseSequence> {
    let sum: f64 = amplitudes.iter().sum();
    let impulses = times_s.iter().zip(amplitudes).map(|(time_s, amplitude)| Impulse {
        time_s: *time_s,
        amplitude: amplitude / sum,
    });
    ImpulseSequence::new(impulses.collect()).ok()
}
