//! The controller's laws in floating point, and its gains from the machine file.
//!
//! ```text
//! [axis.drive], [axis.controller], counts per unit q, tick T, loop lag
//!     └─► Gains (counts, ticks, command units) ─► Settings (mantissa and shift, the words of the hardware)
//!     └─► ControlWarning where a condition of the notes does not hold
//! ```
//!
//! A command unit is a thousandth of the drive's unit: mA of a torque drive, mm/s (mrad/s) of a velocity drive. Unit
//! conversions are in the gains, so that the hardware counts in counts and ticks.
//!
//! | drive | command | law |
//! |---|---|---|
//! | torque | `(M·a + b·v + F_c·sat(dr/fade)) / k_f` | a = ddr + feedback, m/s² |
//! | velocity, PD and PID | u | u = dr + feedback, m/s |
//! | velocity, sliding mode | `v + a/ω_b` | a = ddr + feedback; the drive is `v' = ω_b (u − v)` |
//!
//! [`gains`] does it all for an axis; [`supervision`] does the same for the words of its supervisor. [`FloatController`] is the law that the fixed-point controller
//! ([`crate::rtl::sliding_mode`]) approximates.

mod conditions;
mod culprit;
mod derive;
mod law;
mod linear;
mod reach;
pub mod sampled;
mod schedule;
mod supervision;
mod supervision_error;

pub use conditions::ControlWarning;
pub use culprit::Culprit;
pub use derive::{Derived, gains, loop_lag_s};
pub use law::{COMMAND_FRACTION, FloatController, Gains, Response, Tracking};
pub use linear::DEFAULT_MARGIN;
pub use reach::{NoTravel, TableBounds, no_travel};
pub use schedule::{CAPTURE_CLOCKS, ControlSchedule, ScheduleError, schedule_delay_s};
pub use supervision::{LostSign, Supervision, lost_sign, supervision};
pub use supervision_error::SupervisionError;

use crate::rtl::sliding_mode::{GainError, SettingRow};

/// Why an axis has no gains.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ControlError {
    /// A table is missing.
    #[error(
        "axis {axis} has no [axis.{table}]: a controller needs [axis.drive], [axis.controller] and [axis.pwm]; add it"
    )]
    Missing {
        /// The axis.
        axis: String,
        /// The table.
        table: &'static str,
    },
    /// A velocity drive whose dynamics the sliding-mode law must know.
    #[error(
        "axis {axis}: the sliding-mode law gives an acceleration, and a velocity drive follows it by its bandwidth: \
         give bandwidth_hz in [axis.drive], or choose kind = \"pd\" or \"pid\""
    )]
    Bandwidth {
        /// The axis.
        axis: String,
    },
    /// An invalid lag.
    #[error(
        "a loop lag of {0:e} s: it must be a finite time above 0, the schedule's delay and the drive's 1/(2π·bandwidth)"
    )]
    Lag(f64),
    /// A loop that is unstable on the machine of the file.
    #[error(
        "axis {axis}: the loop is unstable on the machine of this file{}",
        remedy(*.gain_margin_db, *.largest_factor, .gains)
    )]
    Unstable {
        /// The axis.
        axis: String,
        /// The key of the machine file.
        key: &'static str,
        /// By how many dB the gains are too high, as a negative number; none where lower gains do not make it stable.
        gain_margin_db: Option<f64>,
        /// The same as a factor on all gains.
        largest_factor: Option<f64>,
        /// The gains of the law.
        gains: &'static str,
    },
    /// A gain that the hardware does not hold.
    #[error("axis {axis}: {source}; {culprit}")]
    Gain {
        /// The axis.
        axis: String,
        /// What does not fit.
        source: GainError,
        /// The number of the file that it comes from.
        culprit: Culprit,
    },
    /// A gain that is not 0 and would be in the hardware.
    #[error(
        "axis {axis}: the gain {row:?} is {found:.3e}, and its smallest in the hardware is {smallest:.3e}: it would be 0; \
         {culprit}"
    )]
    Lost {
        /// The axis.
        axis: String,
        /// The gain.
        row: SettingRow,
        /// As derived.
        found: f64,
        /// The smallest that is not 0.
        smallest: f64,
        /// The number of the file that it comes from.
        culprit: Culprit,
    },
}

/// What to do about an unstable loop.
fn remedy(gain_margin_db: Option<f64>, largest_factor: Option<f64>, gains: &str) -> String {
    match (gain_margin_db, largest_factor) {
        (Some(margin), Some(factor)) => format!(
            ", gain margin {margin:.1} dB: multiply {gains} by less than {factor:.2e}, or leave the gains of pd and pid out: the defaults \
             leave a margin"
        ),
        _ => format!(
            ", whatever the factor on {gains}: leave the gains of pd and pid out, raise damping where a mode has none, or choose \
             a velocity drive, whose encoder does not feel the modes"
        ),
    }
}

impl ControlError {
    /// The key of the machine file that is to blame, dotted: `axis.drive.bandwidth_hz`, for example.
    pub fn key(&self) -> String {
        match self {
            Self::Missing { .. } => "axis.controller".to_owned(),
            Self::Bandwidth { .. } | Self::Lag(_) => "axis.drive.bandwidth_hz".to_owned(),
            Self::Unstable { key, .. } => (*key).to_owned(),
            Self::Gain { culprit, .. } | Self::Lost { culprit, .. } => culprit.key.to_owned(),
        }
    }
}
