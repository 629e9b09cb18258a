//! The hardware's controller on the same machine, with integers as inputs and outputs.

use super::run::{Law, Seen};
use super::{CURRENT_LIMIT_A, CURRENT_LOOP, ControllerCase, ControllerLaw, RATE, SLOPE, VISCOUS, nominal};
use posicast_blocks::sliding_mode::{self, SettingRow, Settings, TickController, TickMotion};
use posicast_machine::control::{COMMAND_FRACTION, Gains};
use posicast_machine::plant::drive_train::Amplifier;

/// Size of a count per tick in m/s that replaces ideal feedback: 10 nm at 10 kHz. A finer one would leave no room for
/// r″ in its word.
const FINE_COUNT_M_S: f64 = 1e-4;
/// Number of command units per A.
const MILLIAMPERES: f64 = 1e3;
/// The steepest slope that a row of this exponent can hold; it replaces a sign function.
const STEEPEST: f64 = 255.0;

/// The controller with its settings.
pub(super) struct ExactLaw {
    law: sliding_mode::Law,
    settings: Settings,
    controller: TickController,
    count_m: f64,
    tick_s: f64,
}

impl ExactLaw {
    pub(super) fn new(case: &ControllerCase) -> Option<Self> {
        if case.voltage_mode_h.is_some() {
            return None;
        }
        let (count_m, tick_s) = (case.scale_m.unwrap_or(FINE_COUNT_M_S * case.tick_s), case.tick_s);
        let (law, gains) = gains(&case.law, count_m, tick_s)?;
        Some(Self {
            law,
            settings: gains.quantise().ok()?,
            controller: TickController::default(),
            count_m,
            tick_s,
        })
    }
}

/// Returns the law of the hardware with its gains in counts, ticks and mA; `None` for a law that the hardware does
/// not have.
fn gains(law: &ControllerLaw, count_m: f64, tick_s: f64) -> Option<(sliding_mode::Law, Gains)> {
    let known = nominal(Amplifier::TunedCurrent {
        bandwidth_rad_s: CURRENT_LOOP,
    });
    let per_force = MILLIAMPERES / known.force_constant();
    let per_acceleration = per_force * known.equivalent_mass() * count_m / (tick_s * tick_s);
    let common = Gains::default().with(&[
        (SettingRow::Feedback, per_acceleration),
        (SettingRow::Limit, MILLIAMPERES * CURRENT_LIMIT_A),
        (SettingRow::Surface, SLOPE * tick_s),
    ]);
    match *law {
        ControllerLaw::Linear { integral, acceleration } => {
            let law = if integral > 0.0 {
                sliding_mode::Law::Pid
            } else {
                sliding_mode::Law::Pd
            };
            let forward = if acceleration { per_acceleration } else { 0.0 };
            let gains = common.with(&[
                (SettingRow::Acceleration, forward),
                (SettingRow::Derivative, (SLOPE + RATE) * tick_s),
                (SettingRow::Proportional, SLOPE * RATE * tick_s.powi(2)),
                (SettingRow::Integral, integral * tick_s.powi(3)),
            ]);
            Some((law, gains))
        }
        ControllerLaw::Sliding {
            epsilon,
            boundary,
            integral,
            coulomb,
        } => {
            let slope = (count_m / (boundary * tick_s)).min(STEEPEST);
            let friction = if coulomb { known.coulomb_force() } else { 0.0 };
            let gains = common.with(&[
                (SettingRow::Acceleration, per_acceleration),
                (SettingRow::Boundary, slope),
                (SettingRow::Damping, SLOPE * tick_s),
                (SettingRow::Reaching, RATE * tick_s),
                (SettingRow::Switching, epsilon * tick_s * tick_s / count_m),
                (SettingRow::Viscous, per_force * VISCOUS * count_m / tick_s),
                (SettingRow::Coulomb, per_force * friction),
                (SettingRow::Fade, STEEPEST),
            ]);
            (integral == 0.0).then_some((sliding_mode::Law::SlidingMode, gains))
        }
        ControllerLaw::Equation { .. } => None,
    }
}

/// Rounds to the nearest word with this many fraction bits.
fn word(value: f64, fraction: i32) -> i32 {
    (value * f64::from(fraction).exp2()).round() as i32
}

impl Law for ExactLaw {
    fn surface(&self, error: f64, rate: f64) -> f64 {
        SLOPE * error + rate
    }

    fn command(&mut self, seen: &Seen) -> f64 {
        let (count, tick_s) = (self.count_m, self.tick_s);
        let motion = TickMotion {
            position_reference: word(seen.reference[0] / count, 8),
            velocity_reference: word(seen.reference[1] * tick_s / count, 16),
            acceleration_reference: word(seen.reference[2] * tick_s * tick_s / count, 24),
            position: word(seen.position / count, 0),
            velocity: word(seen.velocity * tick_s / count, 16),
        };
        let outputs = self.controller.control(self.law, false, &motion, &self.settings);
        f64::from(outputs.command) / f64::from(1u32 << COMMAND_FRACTION) / MILLIAMPERES
    }
}
