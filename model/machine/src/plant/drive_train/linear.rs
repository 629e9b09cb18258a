//! The linear part of the drive, without dry friction and limits, as matrices: `s′ = A s + b u` with
//! `s = (i, θ, ω, x, v)`.

use nalgebra::{Complex, DMatrix, Matrix2, Matrix5, Matrix6, Vector5, Vector6};
use std::f64::consts::TAU;

use super::{Amplifier, DriveTrain, Winding};
use posicast_shaper::mode::Mode;

/// Newton steps on an eigenvalue; each doubles its digits.
const POLISH: usize = 3;
/// A pole whose magnitude relative to the fastest is below this counts as a pole at 0.
const AT_REST: f64 = 1e-5;

impl Amplifier {
    /// Rates of change of the current due to the current itself, the motor's speed and the command.
    pub(super) fn rates(&self) -> [f64; 3] {
        let of_winding = |winding: &Winding, current_gain: f64, per_command: f64, velocity_gain: f64| {
            [
                -(current_gain + winding.resistance_ohm) / winding.inductance_h,
                -(winding.back_emf + current_gain * velocity_gain) / winding.inductance_h,
                per_command / winding.inductance_h,
            ]
        };
        match self {
            Self::TunedCurrent { bandwidth_rad_s } => [-bandwidth_rad_s, 0.0, *bandwidth_rad_s],
            Self::ProportionalCurrent { winding, current_gain } => {
                of_winding(winding, *current_gain, *current_gain, 0.0)
            }
            Self::Velocity {
                winding,
                current_gain,
                velocity_gain,
            } => of_winding(winding, *current_gain, current_gain * velocity_gain, *velocity_gain),
            Self::Voltage { winding, gain } => of_winding(winding, 0.0, *gain, 0.0),
        }
    }
}

impl DriveTrain {
    /// `A` and `b` of `s′ = A s + b u`, with the states current, angle, speed, position, velocity, without dry
    /// friction and limits.
    pub fn matrices(&self) -> (Matrix5<f64>, Vector5<f64>) {
        let [by_current, by_speed, by_command] = self.amplifier.rates();
        let (lead, inertia, mass) = (self.lead_per_radian, self.motor_inertia, self.load_mass);
        let (stiffness, damping) = (self.stiffness, self.damping);
        let [motor, load] = [self.motor_friction, self.load_friction].map(|friction| friction.stribeck.viscous);
        #[rustfmt::skip]
        let matrix = Matrix5::new(
            by_current, 0.0, by_speed, 0.0, 0.0,
            0.0, 0.0, 1.0, 0.0, 0.0,
            self.torque_constant / inertia, -lead * lead * stiffness / inertia, -(lead * lead * damping + motor) / inertia, lead * stiffness / inertia, lead * damping / inertia,
            0.0, 0.0, 0.0, 0.0, 1.0,
            0.0, lead * stiffness / mass, lead * damping / mass, -stiffness / mass, -(damping + load) / mass,
        );
        (matrix, Vector5::new(by_command, 0.0, 0.0, 0.0, 0.0))
    }

    /// Exact `A_d` and `b_d` for a command that is held for this many seconds.
    pub fn held_matrices(&self, time_s: f64) -> (Matrix5<f64>, Vector5<f64>) {
        let (matrix, input) = self.matrices();
        let mut generator = Matrix6::zeros();
        generator.fixed_view_mut::<5, 5>(0, 0).copy_from(&(matrix * time_s));
        generator.fixed_view_mut::<5, 1>(0, 5).copy_from(&(input * time_s));
        // With the motor's displacement in place of its angle all entries are of similar size, so that small ones
        // keep their digits.
        let lead = self.lead_per_radian;
        let to_ways = Vector6::new(1.0, lead, lead, 1.0, 1.0, 1.0);
        let scaled = generator.map_with_location(|row, column, entry| entry * to_ways[row] / to_ways[column]);
        let held = scaled
            .exp()
            .map_with_location(|row, column, entry| entry * to_ways[column] / to_ways[row]);
        (
            held.fixed_view::<5, 5>(0, 0).into_owned(),
            held.fixed_view::<5, 1>(0, 5).into_owned(),
        )
    }

    /// The poles in 1/s, in no particular order.
    pub fn poles(&self) -> Vec<Complex<f64>> {
        let (matrix, _) = self.matrices();
        polished(DMatrix::from_column_slice(5, 5, matrix.as_slice()))
    }

    /// The modes, which are the pairs of complex poles, lowest frequency first.
    pub fn modes(&self) -> Vec<Mode> {
        modes_of(&self.poles())
    }

    /// `A` of current and speed alone, with the table fixed to the motor: the loop for which a drive is tuned.
    pub fn rigid_matrix(&self) -> Matrix2<f64> {
        let [by_current, by_speed, _] = self.amplifier.rates();
        let lead = self.lead_per_radian;
        let inertia = self.motor_inertia + self.load_mass * lead * lead;
        let viscous = self.motor_friction.stribeck.viscous + self.load_friction.stribeck.viscous * lead * lead;
        Matrix2::new(by_current, by_speed, self.torque_constant / inertia, -viscous / inertia)
    }

    /// The mode with the table fixed to the motor, if there is one.
    pub fn rigid_mode(&self) -> Option<Mode> {
        let matrix = self.rigid_matrix();
        let poles = polished(DMatrix::from_column_slice(2, 2, matrix.as_slice()));
        modes_of(&poles).into_iter().next()
    }

    /// Magnitude of the fastest pole, rad/s; a step must be short compared with its inverse.
    pub(super) fn fastest(&self) -> f64 {
        self.poles().iter().map(|pole| pole.norm()).fold(0.0, f64::max)
    }
}

/// Pairs of complex poles as modes, lowest frequency first. The double pole at 0 of free masses may come out as a
/// pair, which is not a mode.
fn modes_of(poles: &[Complex<f64>]) -> Vec<Mode> {
    let fastest = poles.iter().map(|pole| pole.norm()).fold(0.0, f64::max);
    let above = poles
        .iter()
        .filter(|pole| pole.im > 0.0 && pole.norm() > AT_REST * fastest);
    let mut modes: Vec<Mode> = above
        .map(|pole| Mode {
            frequency_hz: pole.norm() / TAU,
            damping: -pole.re / pole.norm(),
        })
        .collect();
    modes.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
    modes
}

/// Eigenvalues, refined by Newton's steps on `det(sI − A)` to the precision of the matrix: its entries span ten
/// decades, so the plain iteration gives only four digits. The slope over the value is the trace of `(sI − A)⁻¹`.
fn polished(matrix: DMatrix<f64>) -> Vec<Complex<f64>> {
    let size = matrix.nrows();
    let complex = matrix.map(Complex::from);
    let mut poles: Vec<Complex<f64>> = matrix.complex_eigenvalues().iter().copied().collect();
    for pole in &mut poles {
        for _ in 0..POLISH {
            let shifted = DMatrix::from_diagonal_element(size, size, *pole) - &complex;
            // Where the matrix cannot be inverted the pole is exact.
            let Some(inverse) = shifted.try_inverse() else { break };
            let moved = *pole - inverse.trace().inv();
            if !(moved.re.is_finite() && moved.im.is_finite()) {
                break;
            }
            *pole = moved;
        }
    }
    poles
}
