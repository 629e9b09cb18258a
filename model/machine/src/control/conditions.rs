//! Checks the conditions under which the control laws keep their promises (the notes on the XY stage, 8.2 and 8.4),
//! and warns where one does not hold.

use super::law::Gains;
use super::linear::{FACTORS, has_modes};
use super::sampled::{LinearLaw, SampledLoop};
use crate::machine_file::{AxisSection, ClockSection, Controller, Drive, DriveMode, LimitsSection};
use crate::unit::AxisUnit;
use posicast_blocks::sliding_mode::{SettingRow, Settings};
use posicast_shaper::unit::{short, show_seconds};

/// Largest product of gains and lag.
const GAIN_LAG_MAX: f64 = 0.5;
/// Relative error of a gain above which it is reported.
const COARSE: f64 = 1e-3;
/// Largest reference velocity in counts/T and acceleration in counts/T² that the words hold.
const WORD_MAX: [f64; 2] = [32_768.0, 128.0];

/// A condition that does not hold. Fields are in m (or rad) and s; the text is in `unit`, the axis's unit in the
/// file.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ControlWarning {
    /// The switching term is too small to overcome friction.
    #[error(
        "epsilon = {} does not overcome friction, which decelerates by {}: raise epsilon",
        .unit.as_in_file(*.epsilon, "/s²"), .unit.as_in_file(*.disturbance, "/s²")
    )]
    WeakSwitching {
        /// Unit of the axis.
        unit: AxisUnit,
        /// Strength ε of the switching term, m/s².
        epsilon: f64,
        /// Deceleration by Coulomb friction, m/s².
        disturbance: f64,
    },
    /// The switching term alone needs more than the current limit.
    #[error(
        "epsilon = {} alone takes {needed_a:.3} A of {limit_a} A: the command saturates; lower epsilon",
        .unit.as_in_file(*.epsilon, "/s²")
    )]
    SwitchingSaturates {
        /// Unit of the axis.
        unit: AxisUnit,
        /// Strength ε of the switching term, m/s².
        epsilon: f64,
        /// Current in A that it needs.
        needed_a: f64,
        /// Current limit in A.
        limit_a: f64,
    },
    /// The gains are too high for the lag of the loop.
    #[error("{what}·lag = {found:.3} with a lag of {}, and must not exceed {allowed}: lower the gains or the lag", show_seconds(*.lag_s, 3))]
    GainTimesLag {
        /// The gains in the product.
        what: &'static str,
        /// Product of gains and lag.
        found: f64,
        /// Lag of the loop in s.
        lag_s: f64,
        /// Largest product that is allowed.
        allowed: f64,
    },
    /// The loop is stable, but close to instability.
    #[error(
        "the loop's margins on the machine of this file are thin: gain margin {gain_margin_db:.1} dB, phase margin \
         {phase_margin_deg:.0}°, modulus margin {modulus_margin:.2}; a sound loop has at least 6 dB, 30° and 0.5: lower {gains}, or \
         leave them out: the defaults have these margins"
    )]
    ThinMargin {
        /// Smallest distance of the open loop from −1.
        modulus_margin: f64,
        /// Gain margin in dB.
        gain_margin_db: f64,
        /// Phase margin in degrees.
        phase_margin_deg: f64,
        /// Keys of the gains to lower.
        gains: &'static str,
    },
    /// The loop is stable on the machine of the file, but not on one whose frequencies differ a little.
    #[error(
        "the loop is unstable on a machine whose modes are at {percent} % of their frequencies: lower the gains, or leave them \
         out: the defaults hold from 80 to 120 %"
    )]
    UnstableNearby {
        /// Frequencies of that machine, in percent of those in the file.
        percent: f64,
    },
    /// The acceleration limit needs more than the current limit.
    #[error(
        "an acceleration of {} takes {needed_a:.3} A of {limit_a} A: lower the limit of the acceleration",
        .unit.as_in_file(*.acceleration, "/s²")
    )]
    Acceleration {
        /// Unit of the axis.
        unit: AxisUnit,
        /// Acceleration limit in m/s².
        acceleration: f64,
        /// Current in A that it needs, with friction.
        needed_a: f64,
        /// Current limit in A.
        limit_a: f64,
    },
    /// The velocity limit exceeds full scale of the drive.
    #[error(
        "a velocity limit of {} exceeds the drive's full scale of {}: lower one, or raise the other",
        .unit.as_in_file(*.velocity, "/s"), .unit.as_in_file(*.full_scale, "/s")
    )]
    Velocity {
        /// Unit of the axis.
        unit: AxisUnit,
        /// Velocity limit in m/s.
        velocity: f64,
        /// Full scale of the drive in m/s.
        full_scale: f64,
    },
    /// A motion limit exceeds the word of its reference.
    #[error(
        "the limit of the {what} is {} counts per tick or tick², its word holds {largest}: raise sample_hz, or use coarser counts",
        short(*.found)
    )]
    Word {
        /// `velocity` or `acceleration`.
        what: &'static str,
        /// The limit in counts per tick, or tick².
        found: f64,
        /// Largest value that the word holds.
        largest: f64,
    },
    /// The mantissa of a gain has so few bits that the gain is inaccurate.
    #[error("the gain of row {row:?} is {actual:.4e} instead of {wanted:.4e}: its mantissa has few bits")]
    CoarseGain {
        /// Row of the gain.
        row: SettingRow,
        /// Gain as derived.
        wanted: f64,
        /// Gain as quantised.
        actual: f64,
    },
}

impl ControlWarning {
    /// Dotted key of the machine file that the condition concerns.
    pub fn key(&self) -> &'static str {
        match self {
            Self::WeakSwitching { .. } | Self::SwitchingSaturates { .. } => "axis.controller.epsilon",
            Self::GainTimesLag { .. }
            | Self::ThinMargin { .. }
            | Self::UnstableNearby { .. }
            | Self::CoarseGain { .. } => "axis.controller",
            Self::Word { what: "velocity", .. } | Self::Velocity { .. } => "axis.limits.velocity",
            Self::Word { .. } | Self::Acceleration { .. } => "axis.limits.acceleration",
        }
    }
}

/// The figures of a loop that the conditions use.
pub(super) struct Loop<'a> {
    pub(super) unit: AxisUnit,
    pub(super) controller: &'a Controller,
    pub(super) drive: &'a Drive,
    /// Sum of the closed loop's poles of PD and PID, 1/s.
    pub(super) linear_poles: f64,
    pub(super) lag_s: f64,
    pub(super) tick_s: f64,
    /// Length of a count, m.
    pub(super) count: f64,
    pub(super) limits: Option<&'a LimitsSection>,
}

impl Loop<'_> {
    /// All conditions that do not hold.
    pub(super) fn warnings(&self) -> Vec<ControlWarning> {
        let mut warnings = self.law();
        warnings.extend(self.reach());
        let limits = [
            ("velocity", self.limits.and_then(|l| l.velocity), self.tick_s),
            (
                "acceleration",
                self.limits.and_then(|l| l.acceleration),
                self.tick_s * self.tick_s,
            ),
        ];
        for ((what, limit, per), largest) in limits.into_iter().zip(WORD_MAX) {
            let found = limit.unwrap_or(0.0) * per / self.count;
            if found >= largest {
                warnings.push(ControlWarning::Word { what, found, largest });
            }
        }
        warnings
    }

    fn law(&self) -> Vec<ControlWarning> {
        let mut warnings = Vec::new();
        let (what, poles) = match *self.controller {
            Controller::SlidingMode {
                c,
                k,
                epsilon,
                boundary,
            } => {
                let reaching = k + epsilon / boundary;
                warnings.extend(self.switching(epsilon));
                ("(c + k + epsilon/boundary)", c + reaching)
            }
            _ => match self.drive.mode {
                DriveMode::Torque { .. } => ("derivative", self.linear_poles),
                DriveMode::Velocity { .. } => ("proportional", self.linear_poles),
            },
        };
        let found = poles * self.lag_s;
        if found > GAIN_LAG_MAX {
            warnings.push(ControlWarning::GainTimesLag {
                what,
                found,
                lag_s: self.lag_s,
                allowed: GAIN_LAG_MAX,
            });
        }
        warnings
    }

    fn switching(&self, epsilon: f64) -> Vec<ControlWarning> {
        let DriveMode::Torque {
            equivalent_mass,
            force_constant,
            current_limit_a: limit_a,
            ..
        } = self.drive.mode
        else {
            return Vec::new();
        };
        let unit = self.unit;
        let disturbance = self.drive.coulomb / equivalent_mass;
        let needed_a = equivalent_mass * epsilon / force_constant;
        let weak = (epsilon <= disturbance).then_some(ControlWarning::WeakSwitching {
            unit,
            epsilon,
            disturbance,
        });
        let saturates = (needed_a >= limit_a).then_some(ControlWarning::SwitchingSaturates {
            unit,
            epsilon,
            needed_a,
            limit_a,
        });
        weak.into_iter().chain(saturates).collect()
    }

    /// Conditions on the limits of the axis that the drive does not reach.
    fn reach(&self) -> Option<ControlWarning> {
        let limits = self.limits?;
        match self.drive.mode {
            DriveMode::Torque {
                equivalent_mass,
                force_constant,
                current_limit_a: limit_a,
                ..
            } => {
                let acceleration = limits.acceleration?;
                let friction = self.drive.coulomb + self.drive.viscous * limits.velocity.unwrap_or(0.0);
                let needed_a = (equivalent_mass * acceleration + friction) / force_constant;
                (needed_a > limit_a).then_some(ControlWarning::Acceleration {
                    unit: self.unit,
                    acceleration,
                    needed_a,
                    limit_a,
                })
            }
            DriveMode::Velocity { full_scale_velocity } => {
                let velocity = limits.velocity?;
                (velocity > full_scale_velocity).then_some(ControlWarning::Velocity {
                    unit: self.unit,
                    velocity,
                    full_scale: full_scale_velocity,
                })
            }
        }
    }

    /// Reference velocity at which the Coulomb term reaches its full value: the velocity that the largest
    /// acceleration gains in one lag, so that the term does not change faster than the loop follows.
    pub(super) fn fade_counts_per_tick(&self) -> f64 {
        let by_drive = match self.drive.mode {
            DriveMode::Torque {
                equivalent_mass,
                force_constant,
                current_limit_a,
                ..
            } => current_limit_a * force_constant / equivalent_mass,
            DriveMode::Velocity { full_scale_velocity } => full_scale_velocity / self.lag_s,
        };
        let acceleration = self.limits.and_then(|l| l.acceleration).unwrap_or(by_drive);
        acceleration * self.lag_s * self.tick_s / self.count
    }

    /// Position error in m that Coulomb friction leaves: `d/(c·(k + ε/φ))` within the boundary layer, `d/P` for a PD,
    /// 0 for a PID.
    pub(super) fn steady_error(&self, proportional: &f64) -> f64 {
        let disturbance = match self.drive.mode {
            DriveMode::Torque { equivalent_mass, .. } => self.drive.coulomb / equivalent_mass,
            DriveMode::Velocity { .. } => 0.0,
        };
        match *self.controller {
            Controller::SlidingMode {
                c,
                k,
                epsilon,
                boundary,
            } => disturbance / (c * (k + epsilon / boundary)),
            Controller::Pd { .. } => disturbance / proportional,
            Controller::Pid { .. } => 0.0,
        }
    }
}

/// The first frequency factor between 80 and 120 % at which the loop is unstable, for a loop that contains the modes.
pub(super) fn unstable_nearby(
    axis: &AxisSection,
    clock: ClockSection,
    lag_s: f64,
    law: &LinearLaw,
) -> Option<ControlWarning> {
    let drive = axis.drive.as_ref()?;
    if !has_modes(axis, drive) {
        return None;
    }
    let unstable = |factor: &&f64| {
        let sampled = SampledLoop::new(axis, clock, lag_s, **factor);
        sampled.is_some_and(|sampled| !sampled.is_stable(law))
    };
    let factor = FACTORS.iter().find(unstable)?;
    Some(ControlWarning::UnstableNearby {
        percent: 100.0 * factor,
    })
}

/// Key of the machine file that is to blame for an unstable loop.
pub(super) fn gain_key(controller: &Controller) -> &'static str {
    match controller {
        Controller::SlidingMode { .. } => "axis.controller.c",
        Controller::Pd {
            derivative: Some(_),
            proportional: None,
        }
        | Controller::Pid {
            derivative: Some(_),
            proportional: None,
            ..
        } => "axis.controller.derivative",
        Controller::Pd {
            proportional: Some(_), ..
        }
        | Controller::Pid {
            proportional: Some(_), ..
        } => "axis.controller.proportional",
        Controller::Pid { integral: Some(_), .. } => "axis.controller.integral",
        Controller::Pd { .. } | Controller::Pid { .. } => "axis.controller.kind",
    }
}

/// Names of a law's gains, for messages.
pub(super) fn gain_names(controller: &Controller) -> &'static str {
    match controller {
        Controller::SlidingMode { .. } => "c, k or epsilon",
        Controller::Pd { .. } => "proportional and derivative",
        Controller::Pid { .. } => "proportional, derivative and integral",
    }
}

/// Warnings for gains that lost more than a thousandth to their mantissa.
pub(super) fn coarse_gains(gains: &Gains, settings: &Settings) -> Vec<ControlWarning> {
    let actual = Gains::of_settings(settings);
    let coarse = SettingRow::ALL.into_iter().filter_map(|row| {
        let (wanted, actual) = (gains.get(row), actual.get(row));
        let lost = (actual - wanted).abs() > COARSE * wanted.abs();
        lost.then_some(ControlWarning::CoarseGain { row, wanted, actual })
    });
    coarse.collect()
}
