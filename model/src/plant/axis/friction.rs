//! A mass under a constant force, viscous and Coulomb friction: closed forms between its stops.
//!
//! ```text
//! v' = a − β·v − f·sgn(v)      at v = 0: it stays for |a| ≤ f
//! ```
//!
//! Where the velocity would change its sign, the instant of the stop is computed, and from there the mass either stays or
//! slides on the other way. So there is no chatter at rest, and no threshold of velocity that would have to be chosen.

/// How a mass has moved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Slide {
    /// At the end, m/s.
    pub(super) velocity: f64,
    /// Way, m.
    pub(super) distance: f64,
}

/// A mass with friction, over cells of one length.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sliding {
    /// β: viscous friction per mass, 1/s.
    viscous: f64,
    /// f: Coulomb friction per mass, m/s².
    coulomb: f64,
    cell: Decay,
}

/// `e^{−βt}`, its integral and the integral of that.
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
        // (1 − e^−z)/z and (z − 1 + e^−z)/z², by their series where the differences would cancel.
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

    /// A cell from this velocity, with what the drive gives per mass.
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

    /// From rest.
    fn leave(&self, drive: f64, decay: &Decay) -> Slide {
        if drive.abs() <= self.coulomb {
            return Slide {
                velocity: 0.0,
                distance: 0.0,
            };
        }
        decay.slide(0.0, drive - self.coulomb.copysign(drive))
    }

    /// When a velocity is 0 that an acceleration works against, at most a cell.
    fn stop_s(&self, velocity: f64, acceleration: f64) -> f64 {
        let ratio = -velocity / acceleration;
        let stop_s = if self.viscous * ratio < 1e-9 {
            ratio
        } else {
            (self.viscous * ratio).ln_1p() / self.viscous
        };
        // Also where it is viscous friction alone that makes the last of the velocity vanish.
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

    /// The same by small steps.
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
    fn unit_closed_forms_equal_small_steps() {
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
    fn unit_a_mass_at_rest_stays_there() {
        let sliding = Sliding::new(3.0, 2.0, 1e-6);
        let mut velocity = 1e-4;
        for _ in 0..200 {
            velocity = sliding.slide(velocity, 1.0).velocity;
        }
        assert_eq!(velocity, 0.0);
        assert_eq!(sliding.slide(0.0, 1.999).distance, 0.0);
    }

    #[test]
    fn unit_the_series_meets_the_exponential() {
        let [below, above] = [0.999e-3, 1.001e-3].map(|viscous| Decay::new(viscous, 1.0));
        assert!((below.once - above.once - 1e-6).abs() < 1e-9);
        assert!((below.twice - above.twice - 2e-6 / 6.0).abs() < 1e-9);
    }
}
