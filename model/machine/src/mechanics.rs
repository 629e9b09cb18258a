//! Stiffness, inertia and modes of a ball-screw axis from its data sheets: the formulas of chapter 2 of the thesis on
//! the XY stage, with its errors corrected.
//!
//! ```text
//! motor ─── coupling K1 ─── screw in torsion K2 ─── screw in tension, nut, bearings ─── table
//!           └─ · (2π/P)² ──────────┘                       in series, N/m
//! ```
//!
//! | quantity | formula | error in the thesis |
//! |---|---|---|
//! | torsion of a shaft | `G J_p/L`, `J_p = π d⁴/32` | the thesis prints N/m for N·mm/rad, and radius for diameter |
//! | the same at the table | `K (2π/P)²` | K1 was added as it was: 33.94 in the place of 34.21 N/µm for X |
//! | tension of the screw | `E A/L` | a factor of 10; X and Y took each other's length |
//! | springs in series | `1/K = Σ 1/K_i` | |
//!
//! Everything is in m, kg, N, rad and s.
//!
//! ```
//! use posicast_machine::mechanics::{SHEAR_MODULUS, torsion_at_table, torsional_stiffness};
//!
//! // The coupling of the XY stage: 8 mm of steel over 25 mm, 1303 N·m/rad, is 2057 N/µm at a lead of 5 mm.
//! let coupling = torsional_stiffness(SHEAR_MODULUS, 8e-3, 25e-3);
//! assert!((coupling - 1302.88).abs() < 0.01);
//! assert!((torsion_at_table(coupling, 5e-3) / 1e6 - 2057.4).abs() < 0.1);
//! ```

use std::f64::consts::{PI, TAU};

use posicast_shaper::mode::Mode;

/// Shear modulus of steel in Pa: 81 GPa, as in the thesis.
pub const SHEAR_MODULUS: f64 = 81e9;
/// Young's modulus of steel in Pa: 207 GPa, as in the thesis.
pub const YOUNGS_MODULUS: f64 = 207e9;
/// Density of steel in kg/m³: 7.8e3, as in the thesis's text; its table has 7.8e4.
pub const DENSITY: f64 = 7.8e3;
/// Fraction of a nut's catalogue stiffness that remains under preload, eq (2-28).
const NUT_PART: f64 = 0.8;

/// Polar area moment of a round shaft in m⁴: `π d⁴/32`.
pub fn polar_area_moment(diameter_m: f64) -> f64 {
    PI * diameter_m.powi(4) / 32.0
}

/// Torsional stiffness of a round shaft in N·m/rad, from its shear modulus in Pa: `G J_p/L`.
pub fn torsional_stiffness(shear_modulus: f64, diameter_m: f64, length_m: f64) -> f64 {
    shear_modulus * polar_area_moment(diameter_m) / length_m
}

/// Stiffness of a round rod in tension in N/m, from its Young's modulus in Pa: `E A/L`.
pub fn axial_stiffness(youngs_modulus: f64, diameter_m: f64, length_m: f64) -> f64 {
    youngs_modulus * (PI * diameter_m * diameter_m / 4.0) / length_m
}

/// A torsional stiffness in N·m/rad, converted by a screw to the table's coordinate in N/m: `K (2π/P)²` with the lead
/// P in m per turn.
pub fn torsion_at_table(stiffness: f64, lead_m: f64) -> f64 {
    let lead_per_radian = lead_m / TAU;
    stiffness / (lead_per_radian * lead_per_radian)
}

/// Stiffness of springs in series, all in one unit: `1/Σ(1/K_i)`; infinite without springs.
pub fn in_series(stiffnesses: &[f64]) -> f64 {
    1.0 / stiffnesses.iter().map(|stiffness| 1.0 / stiffness).sum::<f64>()
}

/// Stiffness of a preloaded nut from that of the catalogue, both in N/m: 0.8 times, eq (2-28).
pub fn preloaded_nut(catalogue: f64) -> f64 {
    NUT_PART * catalogue
}

/// Inertia of a round shaft about its axis in kg·m²: `m r²/2`, from its density in kg/m³.
pub fn shaft_inertia(density: f64, diameter_m: f64, length_m: f64) -> f64 {
    density * length_m * polar_area_moment(diameter_m)
}

/// A motor that moves a table by a ball screw.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScrewDrive {
    /// Lead P of the screw, m per turn. Above 0.
    pub lead_m: f64,
    /// Diameter of the screw, m; the root diameter where it is known. Above 0.
    pub screw_diameter_m: f64,
    /// Length of the screw under torsion, m. Above 0.
    pub screw_length_m: f64,
    /// Length of the screw under tension, from bearing to nut, m. Above 0.
    pub loaded_length_m: f64,
    /// Torsional stiffness of the coupling, N·m/rad; infinite for a rigid one.
    pub coupling_stiffness: f64,
    /// Stiffness of the preloaded nut, N/m; infinite for a rigid one.
    pub nut_stiffness: f64,
    /// Axial stiffness of the bearings, N/m; infinite for rigid ones.
    pub bearing_stiffness: f64,
    /// Inertia of the motor's rotor and what is fixed to it, kg·m², without the screw's own, which is computed. Above
    /// 0.
    pub motor_inertia: f64,
    /// Moved mass of the table, kg. Above 0.
    pub table_mass: f64,
    /// Damping ratio of the table on the screw while the motor is held: at least 0, below 1. No data sheet states it.
    pub damping: f64,
    /// Stick-slip friction of the simulated machine; `None`: the simulated machine has the mode alone.
    pub stiction: Option<Stiction>,
}

/// Friction of a simulated table that sticks, in addition to the Coulomb and viscous friction of `[axis.drive]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stiction {
    /// Dry friction at rest, N: at least the friction while it slides.
    pub breakaway: f64,
    /// Stribeck velocity over which friction falls from breakaway to Coulomb, m/s. Above 0.
    pub stribeck_velocity: f64,
}

impl ScrewDrive {
    /// Axial stiffness of screw, nut and bearings, N/m: K_ax of the thesis.
    pub fn axial_stiffness(&self) -> f64 {
        let screw = axial_stiffness(YOUNGS_MODULUS, self.screw_diameter_m, self.loaded_length_m);
        in_series(&[screw, self.nut_stiffness, self.bearing_stiffness])
    }

    /// Axial stiffness with the screw's torsion, N/m: eq (2-35).
    pub fn screw_stiffness(&self) -> f64 {
        let torsion = torsional_stiffness(SHEAR_MODULUS, self.screw_diameter_m, self.screw_length_m);
        in_series(&[self.axial_stiffness(), torsion_at_table(torsion, self.lead_m)])
    }

    /// Stiffness between motor and table at the table, N/m: that of the screw in series with the coupling.
    pub fn stiffness(&self) -> f64 {
        let coupling = torsion_at_table(self.coupling_stiffness, self.lead_m);
        in_series(&[self.screw_stiffness(), coupling])
    }

    /// Inertia that turns with the motor, kg·m²: rotor and screw.
    pub fn turning_inertia(&self) -> f64 {
        self.motor_inertia + shaft_inertia(DENSITY, self.screw_diameter_m, self.screw_length_m)
    }

    /// The turning inertia as a mass at the table, kg: `J (2π/P)²`.
    pub fn motor_mass(&self) -> f64 {
        torsion_at_table(self.turning_inertia(), self.lead_m)
    }

    /// Damping in parallel with the spring, on the relative velocity of motor and table, N·s/m: `2ζ√(K m)`.
    pub fn relative_damping(&self) -> f64 {
        2.0 * self.damping * (self.stiffness() * self.table_mass).sqrt()
    }

    /// The drive with its frequencies multiplied by this factor, as a machine that differs from its file: the
    /// stiffness changes by the factor's square, and the damping ratio stays.
    pub fn with_frequency_factor(&self, factor: f64) -> Self {
        let square = factor * factor;
        // Longer lengths make the screw softer; the inertia of the longer screw is taken off again.
        let longer = Self {
            screw_length_m: self.screw_length_m / square,
            loaded_length_m: self.loaded_length_m / square,
            coupling_stiffness: self.coupling_stiffness * square,
            nut_stiffness: self.nut_stiffness * square,
            bearing_stiffness: self.bearing_stiffness * square,
            ..*self
        };
        Self {
            motor_inertia: self.motor_inertia + self.turning_inertia() - longer.turning_inertia(),
            ..longer
        }
    }

    /// The mode of the table on the screw while the motor is held, which rings in front of a stiff velocity drive.
    pub fn held_mode(&self) -> Mode {
        Mode::of_spring(self.stiffness(), self.relative_damping(), self.table_mass)
    }

    /// The mode of motor against table, both free, which rings behind a torque drive.
    pub fn free_mode(&self) -> Mode {
        let motor = self.motor_mass();
        let reduced = self.table_mass * motor / (self.table_mass + motor);
        Mode::of_spring(self.stiffness(), self.relative_damping(), reduced)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The axes X and Y of the thesis: bearings as printed, damping as identified.
    fn axes() -> [ScrewDrive; 2] {
        [
            (340e-3, 350e-3, 133.4873e6, 50.0, 0.157_799_066),
            (440e-3, 340e-3, 140.3455e6, 100.0, 0.153_542_487),
        ]
        .map(|(screw, loaded, bearing, table_mass, damping)| ScrewDrive {
            lead_m: 5e-3,
            screw_diameter_m: 12e-3,
            screw_length_m: screw,
            loaded_length_m: loaded,
            coupling_stiffness: torsional_stiffness(SHEAR_MODULUS, 8e-3, 25e-3),
            nut_stiffness: preloaded_nut(250e6),
            bearing_stiffness: bearing,
            motor_inertia: 0.0364e-4,
            table_mass,
            damping,
            stiction: None,
        })
    }

    #[track_caller]
    fn digits(found: f64, expected: f64, half_digit: f64) {
        assert!((found - expected).abs() <= half_digit, "{found} instead of {expected}");
    }

    #[test]
    fn golden_stiffness_of_the_xy_stage() {
        let [x, y] = axes();
        digits(x.axial_stiffness() / 1e6, 36.4412, 5e-5);
        digits(y.axial_stiffness() / 1e6, 37.5259, 5e-5);
        digits(x.screw_stiffness() / 1e6, 34.7860, 5e-5);
        digits(x.stiffness() / 1e6, 34.2076, 5e-5);
        // The thesis continues from K_ax as it is printed, for X with four digits.
        for (axis, printed, screw, whole) in [(x, 36.44, 34.7849, 34.2066), (y, 37.5258, 35.2882, 34.6932)] {
            let torsion = torsional_stiffness(SHEAR_MODULUS, axis.screw_diameter_m, axis.screw_length_m);
            let of_screw = in_series(&[printed, torsion_at_table(torsion, axis.lead_m) / 1e6]);
            digits(of_screw, screw, 5e-5);
            let coupling = torsion_at_table(axis.coupling_stiffness, axis.lead_m) / 1e6;
            digits(in_series(&[of_screw, coupling]), whole, 5e-5);
            digits(axis.stiffness() / 1e6, whole, 1.1e-3);
        }
    }

    #[test]
    fn golden_inertia_and_modes_of_the_xy_stage() {
        let [x, _] = axes();
        digits(x.turning_inertia() * 1e6, 9.038_814_408_823_444, 1e-12);
        digits(x.motor_mass(), 14.274, 1e-3);
        // √(34.2076e6/50)/2π, and with both masses larger by √(1 + 50/14.274).
        let [held, free] = [x.held_mode(), x.free_mode()];
        digits(held.frequency_hz, 131.6426, 2e-4);
        digits(free.frequency_hz, 131.6426 * (1.0 + 50.0 / 14.2737f64).sqrt(), 2e-3);
        digits(held.damping, x.damping, 1e-15);
        let back = free.with_motor_held(x.motor_mass(), x.table_mass);
        digits(back.frequency_hz, held.frequency_hz, 1e-10);
        digits(back.damping, held.damping, 1e-14);
    }

    #[test]
    fn a_rigid_part_in_series_adds_no_compliance() {
        let [x, _] = axes();
        let rigid = ScrewDrive {
            coupling_stiffness: f64::INFINITY,
            ..x
        };
        assert_eq!(rigid.stiffness(), rigid.screw_stiffness());
        assert_eq!(in_series(&[3.0, 6.0]), 2.0);
    }
}
