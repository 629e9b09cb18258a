//! A mass with viscous and Coulomb friction under a constant force: closed forms between its stops.
//!
//! ```text
//! v' = a − β·v − f·sgn(v)      at v = 0: it stays for |a| ≤ f
//! ```
//!
//! Where the velocity would change its sign, the instant of the stop is computed, and from there the mass either
//! stays or slides in the other direction. So there is no chatter at rest, and no velocity threshold that would have
//! to be chosen.

/// Motion of a mass in a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Slide {
    /// Velocity at the end, m/s.
    pub(super) velocity: f64,
    /// Distance, m.
    pub(super) distance: f64,
}

/// A mass with friction, for cells of one length.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sliding {
    /// Viscous friction per mass β, 1/s.
    viscous: f64,
    /// Coulomb friction per mass f, m/s².
    coulomb: f64,
    cell: Decay,
}

/// The function `e^{−βt}`, its integral and the integral of that.
#[derive(Debug, Clone, PartialEq)]
struct Decay {
    time_s: f64,
    left: f64,
    once: f64,
    twice: f64,
}

impl Decay {
    fn new(viscous: f64, time_s: f64) -> Self {
        let z = viscous * time_s;
        // The terms are (1 − e^−z)/z and (z − 1 + e^−z)/z², by their series where the differences would cancel.
        let (once, twice) = if z < 1e-3 {
            let once = 1.0 - z / 2.0 * (1.0 - z / 3.0 * (1.0 - z / 4.0));
            (once, 0.5 - z / 6.0 * (1.0 - z / 4.0 * (1.0 - z / 5.0)))
        } else {
            let once = -(-z).exp_m1() / z;
            (once, (1.0 - once) / z)
        };
        Self {
            time_s,
            left: (-z).exp(),
            once: once * time_s,
            twice: twice * time_s * time_s,
        }
    }

    fn slide(&self, velocity: f64, acceleration: f64) -> Slide {
        Slide {
            velocity: velocity * self.left + acceleration * self.once,
            distance: velocity * self.once + acceleration * self.twice,
        }
    }
}

impl Sliding {
    pub(super) fn new(viscous: f64, coulomb: f64, cell_s: f64) -> Self {
        Self {
            viscous,
            coulomb,
            cell: Decay::new(viscous, cell_s),
        }
    }

    /// Moves for a cell, starting with this velocity; `drive` is the drive's force per mass.
    pub(super) fn slide(&self, velocity: f64, drive: f64) -> Slide {
        if velocity == 0.0 {
            return self.leave(drive, &self.cell);
        }
        let acceleration = drive - self.coulomb.copysign(velocity);
        let whole = self.cell.slide(velocity, acceleration);
        if whole.velocity * velocity.signum() > 0.0 {
            return whole;
        }
        let stop_s = self.stop_s(velocity, acceleration);
        let before = Decay::new(self.viscous, stop_s).slide(velocity, acceleration);
        let after = self.leave(drive, &Decay::new(self.viscous, self.cell.time_s - stop_s));
        Slide {
            velocity: after.velocity,
            distance: before.distance + after.distance,
        }
    }

    /// Moves for a cell from rest.
    fn leave(&self, drive: f64, decay: &Decay) -> Slide {
        if drive.abs() <= self.coulomb {
            return Slide {
                velocity: 0.0,
                distance: 0.0,
            };
        }
        decay.slide(0.0, drive - self.coulomb.copysign(drive))
    }

    /// Time in s, at most a cell, at which an acceleration against the velocity has reduced it to 0.
    fn stop_s(&self, velocity: f64, acceleration: f64) -> f64 {
        let ratio = -velocity / acceleration;
        let stop_s = if self.viscous * ratio < 1e-9 {
            ratio
        } else {
            (self.viscous * ratio).ln_1p() / self.viscous
        };
        // This is also reached where viscous friction alone makes the last of the velocity vanish.
        if stop_s >= 0.0 {
            stop_s.min(self.cell.time_s)
        } else {
            self.cell.time_s
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Simulates the motion by small steps instead.
    fn by_steps(viscous: f64, coulomb: f64, drive: f64, mut velocity: f64, time_s: f64) -> Slide {
        let steps = 1_000_000;
        let step = time_s / f64::from(steps);
        let mut distance = 0.0;
        for _ in 0..steps {
            let before = velocity;
            if velocity == 0.0 && drive.abs() <= coulomb {
                break;
            }
            let sign = if velocity == 0.0 {
                drive.signum()
            } else {
                velocity.signum()
            };
            velocity += step * (drive - coulomb * sign - viscous * velocity);
            if before * velocity < 0.0 && drive.abs() <= coulomb {
                velocity = 0.0;
            }
            distance += step * (before + velocity) / 2.0;
        }
        Slide { velocity, distance }
    }

    #[test]
    fn closed_forms_equal_small_steps() {
        for viscous in [0.0, 3.0, 400.0] {
            let sliding = Sliding::new(viscous, 2.0, 0.01);
            for (velocity, drive) in [
                (0.03, 5.0),
                (0.03, -5.0),
                (0.01, 1.0),
                (-0.01, -1.9),
                (0.0, 2.0),
                (0.0, -2.5),
            ] {
                let found = sliding.slide(velocity, drive);
                let expected = by_steps(viscous, 2.0, drive, velocity, 0.01);
                assert!(
                    (found.velocity - expected.velocity).abs() < 1e-7,
                    "{viscous} {velocity} {drive}"
                );
                assert!(
                    (found.distance - expected.distance).abs() < 1e-9,
                    "{viscous} {velocity} {drive}"
                );
            }
        }
    }

    #[test]
    fn a_mass_at_rest_stays_there() {
        let sliding = Sliding::new(3.0, 2.0, 1e-6);
        let mut velocity = 1e-4;
        for _ in 0..200 {
            velocity = sliding.slide(velocity, 1.0).velocity;
        }
        assert_eq!(velocity, 0.0);
        assert_eq!(sliding.slide(0.0, 1.999).distance, 0.0);
    }

    #[test]
    fn the_series_meets_the_exponential() {
        let [below, above] = [0.999e-3, 1.001e-3].map(|viscous| Decay::new(viscous, 1.0));
        assert!((below.once - above.once - 1e-6).abs() < 1e-9);
        assert!((below.twice - above.twice - 2e-6 / 6.0).abs() < 1e-9);
    }
}
