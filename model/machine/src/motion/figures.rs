//! Peak and root mean square of a command: the load that a shaper puts on the drive.
//!
//! Both are taken from the first jump of the command to the last, for the position or one of its derivatives. For a
//! shaped unit step the peak is the magnitude of the largest partial sum; that of negative shapers exceeds 1.

use crate::motion::{Cubic, Trajectory};

/// The quantity of a command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Position, in the unit of the command.
    Position,
    /// Velocity, in the unit of the command per second.
    Velocity,
    /// Acceleration, in the unit of the command per second².
    Acceleration,
}

/// Peak and rms of a command between its first and last jump.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CommandFigures {
    /// Largest magnitude, the value at the end included.
    pub peak: f64,
    /// Root mean square `√(1/T · ∫ q² dt)` over the `T` seconds from the first jump to the last; the magnitude itself
    /// where `T` is 0.
    pub rms: f64,
}

/// Nodes and weights of Gauss–Legendre quadrature on [−1, 1], which is exact to degree 7; the square of a cubic has
/// degree 6.
const GAUSS: [(f64, f64); 4] = [
    (-0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
    (-0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
];

/// Peak and rms of a command, computed exactly.
///
/// ```
/// use posicast_machine::motion::{Quantity, command_figures};
/// use posicast_machine::motion::Trajectory;
///
/// let trapezoid = Trajectory::trapezoid(0.3, 0.1, 2.0).unwrap();
/// let velocity = command_figures(&trapezoid, Quantity::Velocity);
/// assert!((velocity.peak - 0.1).abs() < 1e-15);
/// ```
pub fn command_figures(command: &Trajectory, quantity: Quantity) -> CommandFigures {
    let pieces = command.pieces();
    let (mut peak, mut square) = (0.0f64, 0.0);
    for (index, piece) in pieces.iter().enumerate() {
        let at = |time_s: f64| value(&piece.cubic.after(time_s), quantity);
        peak = peak.max(at(0.0).abs());
        let Some(next) = pieces.get(index + 1) else { break };
        let length_s = next.start_s - piece.start_s;
        peak = peak.max(at(length_s).abs());
        for time_s in stationary(&piece.cubic, quantity) {
            if time_s > 0.0 && time_s < length_s {
                peak = peak.max(at(time_s).abs());
            }
        }
        let half_s = length_s / 2.0;
        let nodes = GAUSS.iter();
        square += half_s
            * nodes
                .map(|(x, weight)| weight * at(half_s * (1.0 + x)).powi(2))
                .sum::<f64>();
    }
    let first_s = pieces.first().map_or(0.0, |p| p.start_s);
    let duration_s = command.end_s() - first_s;
    let rms = if duration_s > 0.0 {
        (square / duration_s).sqrt()
    } else {
        peak
    };
    CommandFigures { peak, rms }
}

fn value(cubic: &Cubic, quantity: Quantity) -> f64 {
    match quantity {
        Quantity::Position => cubic.position,
        Quantity::Velocity => cubic.velocity,
        Quantity::Acceleration => cubic.acceleration,
    }
}

/// Times at which the quantity is stationary: roots of `b + c·t + d·t²/2`. NaN where there is no such time.
fn stationary(cubic: &Cubic, quantity: Quantity) -> [f64; 2] {
    let (b, c, d) = match quantity {
        Quantity::Position => (cubic.velocity, cubic.acceleration, cubic.jerk),
        Quantity::Velocity => (cubic.acceleration, cubic.jerk, 0.0),
        Quantity::Acceleration => (cubic.jerk, 0.0, 0.0),
    };
    // Written so that neither root cancels; a vanishing d leaves the root of the line.
    let root = (c * c - 2.0 * b * d).sqrt().copysign(c);
    let sum = -(c + root);
    [sum / d, 2.0 * b / sum]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::Profile;
    use posicast_shaper::impulse::Impulse;

    #[test]
    fn a_shaped_step_peaks_at_its_largest_partial_sum() {
        let impulses = [(0.0, 1.0), (0.2, -2.0), (0.3, 2.0)].map(|(time_s, amplitude)| Impulse { time_s, amplitude });
        let figures = command_figures(&Trajectory::step(3.0).shaped(&impulses), Quantity::Position);
        assert_eq!((figures.peak, figures.rms), (3.0, 3.0));
        let halves = [(0.0, 0.5), (0.2, 0.5)].map(|(time_s, amplitude)| Impulse { time_s, amplitude });
        let figures = command_figures(&Trajectory::step(1.0).shaped(&halves), Quantity::Position);
        assert_eq!((figures.peak, figures.rms), (1.0, 0.5));
        assert_eq!(command_figures(&Trajectory::step(-2.0), Quantity::Position).rms, 2.0);
    }

    #[test]
    fn a_move_has_the_figures_of_its_samples() {
        let profile = Profile::new(0.0, 0.05, 0.3, 4.0, 90.0).unwrap();
        let shaped = Trajectory::of_profile(&profile)
            .shaped(&[(0.0, 1.0), (0.07, -2.0), (0.1, 2.0)].map(|(time_s, amplitude)| Impulse { time_s, amplitude }));
        let pieces = shaped.pieces();
        let samples = 100_000;
        for quantity in [Quantity::Position, Quantity::Velocity, Quantity::Acceleration] {
            let figures = command_figures(&shaped, quantity);
            let values = (0..samples).map(|k| {
                let time_s = shaped.end_s() * (f64::from(k) + 0.5) / f64::from(samples);
                let at = pieces.partition_point(|p| p.start_s <= time_s) - 1;
                value(&pieces[at].cubic.after(time_s - pieces[at].start_s), quantity)
            });
            let (peak, square) = values.fold((0.0f64, 0.0), |(p, s), v| (p.max(v.abs()), s + v * v));
            assert!((figures.peak - peak).abs() < 1e-3 * peak, "{quantity:?}");
            assert!((figures.rms - (square / f64::from(samples)).sqrt()).abs() < 1e-3 * figures.rms);
        }
    }
}
