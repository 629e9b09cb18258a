//! Finds the number of the machine file that is to blame for a gain that the hardware cannot represent.
//!
//! A gain is a product of powers of a few numbers of the file. It misses its range by decades, so the number to blame
//! is the one that is most decades away from what machines have.

use std::fmt;

use crate::machine_file::{AxisSection, ClockSection, Controller, DriveMode, ScaleUse};
use posicast_blocks::sliding_mode::SettingRow;

/// A number of the machine file that makes a gain too large or too small.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Culprit {
    /// Dotted key, such as `axis.drive.force_constant`.
    pub key: &'static str,
    /// Its value in the file.
    pub found: f64,
    /// Typical value of machines, to the order of magnitude.
    pub usual: f64,
}

impl Culprit {
    /// Distance from the typical value, in decades.
    fn decades(&self) -> f64 {
        (self.found.log10() - self.usual.log10()).abs()
    }
}

impl fmt::Display for Culprit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let change = if self.found < self.usual { "raise" } else { "lower" };
        write!(f, "it comes from {} = {:e}: {change} it", self.key, self.found)
    }
}

/// The numbers of the machine file that an axis's gains are products of.
pub(super) struct Numbers<'a> {
    pub(super) axis: &'a AxisSection,
    pub(super) clock: ClockSection,
}

impl Numbers<'_> {
    /// Finds the number to blame for the gain of `row`.
    pub(super) fn culprit(&self, row: SettingRow) -> Culprit {
        let sample = Culprit {
            key: "clock.sample_hz",
            found: self.clock.sample_hz,
            usual: 1e4,
        };
        let made_of = self.made_of(row).into_iter();
        let given = made_of.filter_map(|(key, found, usual)| {
            let found = found.filter(|value| *value > 0.0)?;
            Some(Culprit { key, found, usual })
        });
        let worst = given.fold(
            sample,
            |worst, next| if next.decades() > worst.decades() { next } else { worst },
        );
        self.in_file(worst)
    }

    /// Converts the figures to the file's unit.
    fn in_file(&self, culprit: Culprit) -> Culprit {
        let unit = self.axis.unit;
        let of_file = |figure| match culprit.key {
            "axis.counts_per_unit" | "axis.scale.counts_per_unit" => unit.counts_in_file(figure),
            "axis.limits.acceleration"
            | "axis.controller.epsilon"
            | "axis.controller.boundary"
            | "axis.drive.full_scale_velocity" => unit.in_file(figure),
            _ => figure,
        };
        Culprit {
            key: culprit.key,
            found: of_file(culprit.found),
            usual: of_file(culprit.usual),
        }
    }

    /// Keys, values and typical values of the numbers in the gain of `row`.
    fn made_of(&self, row: SettingRow) -> Vec<(&'static str, Option<f64>, f64)> {
        let key = match self.axis.scale {
            Some(scale) if scale.usage == ScaleUse::Position => "axis.scale.counts_per_unit",
            _ => "axis.counts_per_unit",
        };
        let counts = (key, Some(self.axis.loop_counts_per_unit()), 1e6);
        let mut numbers = match row {
            SettingRow::Limit | SettingRow::Duty | SettingRow::Viscous | SettingRow::Coulomb => Vec::new(),
            _ => vec![counts],
        };
        let follows = matches!(
            row,
            SettingRow::Damping
                | SettingRow::Reaching
                | SettingRow::Switching
                | SettingRow::Derivative
                | SettingRow::Proportional
                | SettingRow::Integral
        );
        if follows || matches!(row, SettingRow::Surface | SettingRow::Boundary) {
            numbers.extend(self.law());
        }
        if row == SettingRow::Fade {
            let acceleration = self.axis.limits.as_ref().and_then(|limits| limits.acceleration);
            numbers.push(("axis.limits.acceleration", acceleration, 1.0));
        }
        // These rows contain the scale of the feedback too.
        if !matches!(row, SettingRow::Surface | SettingRow::Boundary) {
            numbers.extend(self.drive(row));
        }
        numbers
    }

    fn law(&self) -> Vec<(&'static str, Option<f64>, f64)> {
        let (p, d, i) = match self.axis.controller {
            Some(Controller::SlidingMode {
                c,
                k,
                epsilon,
                boundary,
            }) => {
                return vec![
                    ("axis.controller.c", Some(c), 1e2),
                    ("axis.controller.k", Some(k), 1e2),
                    ("axis.controller.epsilon", Some(epsilon), 1.0),
                    ("axis.controller.boundary", Some(boundary), 1e-2),
                ];
            }
            Some(Controller::Pd {
                proportional,
                derivative,
            }) => (proportional, derivative, None),
            Some(Controller::Pid {
                proportional,
                derivative,
                integral,
            }) => (proportional, derivative, integral),
            None => (None, None, None),
        };
        let bandwidth_hz = self.axis.drive.as_ref().and_then(|drive| drive.bandwidth_hz);
        vec![
            ("axis.controller.proportional", p, 1e3),
            ("axis.controller.derivative", d, 1e1),
            ("axis.controller.integral", i, 1e4),
            ("axis.drive.bandwidth_hz", bandwidth_hz, 1e2),
        ]
    }

    fn drive(&self, row: SettingRow) -> Vec<(&'static str, Option<f64>, f64)> {
        let Some(drive) = &self.axis.drive else {
            return Vec::new();
        };
        let bandwidth = ("axis.drive.bandwidth_hz", drive.bandwidth_hz, 1e2);
        match drive.mode {
            DriveMode::Torque {
                equivalent_mass,
                force_constant,
                current_limit_a,
                full_scale_a,
            } => {
                let mass = ("axis.drive.equivalent_mass", Some(equivalent_mass), 1.0);
                let force = ("axis.drive.force_constant", Some(force_constant), 1.0);
                let limit = ("axis.drive.current_limit_a", Some(current_limit_a), 1.0);
                match row {
                    SettingRow::Limit => vec![limit],
                    SettingRow::Duty => vec![("axis.drive.full_scale_a", Some(full_scale_a), 1.0)],
                    SettingRow::Viscous => vec![("axis.drive.viscous", Some(drive.viscous), 1.0), force],
                    SettingRow::Coulomb => vec![("axis.drive.coulomb", Some(drive.coulomb), 1.0), force],
                    _ => vec![mass, force, limit, bandwidth],
                }
            }
            DriveMode::Velocity { full_scale_velocity } => {
                let velocity = ("axis.drive.full_scale_velocity", Some(full_scale_velocity), 1.0);
                match row {
                    SettingRow::Limit | SettingRow::Duty => vec![velocity],
                    _ => vec![velocity, bandwidth],
                }
            }
        }
    }
}
