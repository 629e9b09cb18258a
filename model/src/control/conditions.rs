//! Conditions under which the laws do what they promise (the notes on the XY stage, 8.2 and 8.4), as warnings.

use super::law::Gains;
use crate::rtl::sliding_mode::{Row, Settings};
use crate::spec::{Controller, Drive, DriveMode, Limits};

/// The largest product of gains and lag.
const GAIN_LAG_MAX: f64 = 0.5;
/// Relative error of a gain that is not worth a word.
const COARSE: f64 = 1e-3;
/// Largest reference velocity in counts/T, and acceleration in counts/T².
const WORD_MAX: [f64; 2] = [32_768.0, 128.0];

/// A condition that does not hold. Everything is in the units of the machine file.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ControlWarning {
    /// The switching term does not overcome friction.
    #[error(
        "epsilon = {epsilon} m/s² does not overcome friction, which decelerates by {disturbance} m/s²: raise epsilon"
    )]
    WeakSwitching {
        /// ε.
        epsilon: f64,
        /// Coulomb friction over mass.
        disturbance: f64,
    },
    /// The switching term alone is more than the drive gives.
    #[error("epsilon = {epsilon} m/s² alone takes {needed_a} A of {limit_a} A: the command saturates; lower epsilon")]
    SwitchingSaturates {
        /// ε.
        epsilon: f64,
        /// Current that it takes.
        needed_a: f64,
        /// Largest current.
        limit_a: f64,
    },
    /// The boundary layer is crossed within a tick.
    #[error("(k + epsilon/boundary)·T = {found}, and must be below 1: widen boundary, or raise sample_hz")]
    SampledReaching {
        /// The product.
        found: f64,
    },
    /// Gains too high for the lag of the loop.
    #[error("{what}·lag = {found} with a lag of {lag_s} s, and must not exceed {allowed}: lower the gains or the lag")]
    GainTimesLag {
        /// The gains that count.
        what: &'static str,
        /// The product.
        found: f64,
        /// Lag in s.
        lag_s: f64,
        /// Largest product.
        allowed: f64,
    },
    /// Gains of PD or PID whose loop is not stable even without what the model leaves out.
    #[error(
        "proportional, derivative and integral make an unstable loop: lower integral (velocity drive: derivative below 1)"
    )]
    Unstable,
    /// A loop on the scale has the flexibility between motor and load inside, which only its damping keeps quiet.
    #[error(
        "the loop on the scale has the axis's modes in it: proportional is {found}/s, and must not exceed {allowed}/s, half of \
         2·damping·ω of the mode that allows least; lower proportional"
    )]
    ModesInLoop {
        /// The proportional gain in 1/s.
        found: f64,
        /// Largest gain in 1/s.
        allowed: f64,
    },
    /// The acceleration limit asks for more than the drive gives.
    #[error(
        "an acceleration of {acceleration} m/s² takes {needed_a} A of {limit_a} A: lower the limit of the acceleration"
    )]
    Acceleration {
        /// Of [axis.limits].
        acceleration: f64,
        /// Current with friction.
        needed_a: f64,
        /// Largest current.
        limit_a: f64,
    },
    /// The velocity limit is more than full scale.
    #[error(
        "a velocity limit of {velocity} m/s exceeds the drive's full scale of {full_scale} m/s: lower one, or raise the other"
    )]
    Velocity {
        /// Of [axis.limits].
        velocity: f64,
        /// Of the drive.
        full_scale: f64,
    },
    /// A reference that its word does not hold.
    #[error(
        "the limit of the {what} is {found} counts per tick or tick², its word holds {largest}: raise sample_hz, or use coarser counts"
    )]
    Word {
        /// `velocity` or `acceleration`.
        what: &'static str,
        /// In counts and ticks.
        found: f64,
        /// Largest.
        largest: f64,
    },
    /// A gain whose mantissa has few bits.
    #[error("the gain of row {row:?} is {actual:.4e} instead of {wanted:.4e}: its mantissa has few bits")]
    CoarseGain {
        /// The row.
        row: Row,
        /// As derived.
        wanted: f64,
        /// As quantised.
        actual: f64,
    },
}

/// What the conditions are about.
pub(super) struct Loop<'a> {
    pub(super) controller: &'a Controller,
    pub(super) drive: &'a Drive,
    /// Sum of the closed loop's poles of PD and PID, 1/s.
    pub(super) linear_poles: f64,
    pub(super) stable: bool,
    pub(super) lag_s: f64,
    pub(super) tick_s: f64,
    /// m per count.
    pub(super) count: f64,
    pub(super) limits: Option<&'a Limits>,
}

impl Loop<'_> {
    /// Every condition that does not hold.
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
                if reaching * self.tick_s >= 1.0 {
                    let found = reaching * self.tick_s;
                    warnings.push(ControlWarning::SampledReaching { found });
                }
                warnings.extend(self.switching(epsilon));
                ("(c + k + epsilon/boundary)", c + reaching)
            }
            _ => {
                if !self.stable {
                    warnings.push(ControlWarning::Unstable);
                }
                match self.drive.mode {
                    DriveMode::Torque { .. } => ("derivative", self.linear_poles),
                    DriveMode::Velocity { .. } => ("proportional", self.linear_poles),
                }
            }
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
        let disturbance = self.drive.coulomb / equivalent_mass;
        let needed_a = equivalent_mass * epsilon / force_constant;
        let weak = (epsilon <= disturbance).then_some(ControlWarning::WeakSwitching { epsilon, disturbance });
        let saturates = (needed_a >= limit_a).then_some(ControlWarning::SwitchingSaturates {
            epsilon,
            needed_a,
            limit_a,
        });
        weak.into_iter().chain(saturates).collect()
    }

    /// Limits of the axis that the drive does not reach.
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
                    acceleration,
                    needed_a,
                    limit_a,
                })
            }
            DriveMode::Velocity { full_scale_velocity } => {
                let velocity = limits.velocity?;
                (velocity > full_scale_velocity).then_some(ControlWarning::Velocity {
                    velocity,
                    full_scale: full_scale_velocity,
                })
            }
        }
    }

    /// Reference velocity at which the Coulomb term is whole: that of the largest acceleration after one lag, so that the
    /// term does not change faster than the loop follows.
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

    /// Error in m that Coulomb friction leaves: `d/(c·(k + ε/φ))` within the boundary layer, `d/P` of a PD, 0 of a PID.
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

/// Gains that lost more than a thousandth to their mantissa.
pub(super) fn coarse_gains(gains: &Gains, settings: &Settings) -> Vec<ControlWarning> {
    let actual = Gains::of_settings(settings);
    let coarse = Row::ALL.into_iter().filter_map(|row| {
        let (wanted, actual) = (gains.get(row), actual.get(row));
        let lost = (actual - wanted).abs() > COARSE * wanted.abs();
        lost.then_some(ControlWarning::CoarseGain { row, wanted, actual })
    });
    coarse.collect()
}
