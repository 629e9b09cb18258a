//! The control laws in floating point, and the gains of the controller from the machine file.
//!
//! ```text
//! [axis.drive], [axis.controller], counts per unit q, tick T, loop lag
//!     └─► Gains (counts, ticks, command units) ─► Settings (mantissa and shift, the words of the hardware)
//!     └─► ControlWarning where a condition of the notes does not hold
//! ```
//!
//! A command unit is a thousandth of the drive's unit: mA for a torque drive, mm/s (mrad/s) for a velocity drive. The
//! gains contain the unit conversions, so that the hardware computes in counts and ticks.
//!
//! | drive | command | law |
//! |---|---|---|
//! | torque | `(M·a + b·v + F_c·sat(dr/fade)) / k_f` | a = ddr + feedback, m/s² |
//! | velocity, PD and PID | u | u = dr + feedback, m/s |
//! | velocity, sliding mode | `v + a/ω_b` | a = ddr + feedback; the drive is `v' = ω_b (u − v)` |
//!
//! [`gains`] derives the whole controller of an axis; [`supervision`] does the same for the words of its supervisor.
//! [`FloatController`] is the law that the fixed-point controller ([`posicast_blocks::sliding_mode`]) approximates.

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
pub use supervision::{LostSign, lost_sign, supervision};
pub use supervision_error::SupervisionError;

use posicast_blocks::sliding_mode::{GainError, SettingRow};

/// Why an axis has no valid gains.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ControlError {
    /// A table of the axis is missing.
    #[error(
        "axis {axis} has no [axis.{table}]: a controller needs [axis.drive], [axis.controller] and [axis.pwm]; add it"
    )]
    Missing {
        /// Name of the axis.
        axis: String,
        /// Name of the missing table.
        table: &'static str,
    },
    /// The sliding-mode law needs the bandwidth of a velocity drive.
    #[error(
        "axis {axis}: the sliding-mode law outputs an acceleration, which a velocity drive follows only with a known bandwidth: give \
         bandwidth_hz in [axis.drive], or choose kind = \"pd\" or \"pid\""
    )]
    Bandwidth {
        /// Name of the axis.
        axis: String,
    },
    /// The lag of the loop is not a finite time above 0.
    #[error(
        "a loop lag of {0:e} s: it must be a finite time above 0, the schedule's delay and the drive's 1/(2π·bandwidth)"
    )]
    Lag(f64),
    /// The loop is unstable on the machine of the file.
    #[error(
        "axis {axis}: the loop is unstable on the machine of this file{}",
        remedy(*.gain_margin_db, *.largest_factor, .gains)
    )]
    Unstable {
        /// Name of the axis.
        axis: String,
        /// Key of the machine file to blame.
        key: &'static str,
        /// Gain margin in dB, which is negative; `None` where lower gains do not make the loop stable.
        gain_margin_db: Option<f64>,
        /// The same margin as a factor on all gains.
        largest_factor: Option<f64>,
        /// Names of the law's gains.
        gains: &'static str,
    },
    /// The hardware cannot represent a gain.
    #[error("axis {axis}: {source}; {culprit}")]
    Gain {
        /// Name of the axis.
        axis: String,
        /// Why the gain does not fit.
        source: GainError,
        /// The number of the file that is to blame.
        culprit: Culprit,
    },
    /// A gain that is not 0 would be 0 in the hardware.
    #[error(
        "axis {axis}: the gain {row:?} is {found:.3e}, but the smallest in the hardware is {smallest:.3e}: it would be 0; {culprit}"
    )]
    Lost {
        /// Name of the axis.
        axis: String,
        /// Row of the gain.
        row: SettingRow,
        /// Gain as derived.
        found: f64,
        /// Smallest gain of the row that is not 0.
        smallest: f64,
        /// The number of the file that is to blame.
        culprit: Culprit,
    },
}

/// Returns the remedy for an unstable loop.
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
    /// The key of the machine file that is to blame, dotted, such as `axis.drive.bandwidth_hz`.
    pub fn key(&self) -> String {
        match self {
            Self::Missing { .. } => "axis.controller".to_owned(),
            Self::Bandwidth { .. } | Self::Lag(_) => "axis.drive.bandwidth_hz".to_owned(),
            Self::Unstable { key, .. } => (*key).to_owned(),
            Self::Gain { culprit, .. } | Self::Lost { culprit, .. } => culprit.key.to_owned(),
        }
    }
}
