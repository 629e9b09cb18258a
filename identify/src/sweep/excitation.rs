//! The acceleration of an axis in a firmware's resonance test, as far as its description determines it.
//!
//! ```text
//!  +a ┌─┐     ┌───┐     ┌─        half periods of two quarters each: + −, then − +, then + − …
//!   0 ┘ │     │   │     │         f rises with every half period: f ← f + rate · 1/(2f)
//!  −a   └─────┘   └─────┘         a = acceleration_per_hz · f
//! ```
//!
//! It is constant between switching times, so that its samples, means and integrals are exact.

/// A resonance test with rising frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sweep {
    /// First frequency in Hz, above 0.
    pub start_hz: f64,
    /// Last frequency in Hz, above the first.
    pub end_hz: f64,
    /// Rise of the frequency in Hz per second, above 0.
    pub rate_hz_per_s: f64,
    /// Acceleration of the axis per frequency, in m/s² per Hz.
    pub acceleration_per_hz: f64,
}

impl Default for Sweep {
    /// The test of common 3D-printer firmware: 5 to 135 Hz at 1 Hz/s with 60 mm/s² per Hz.
    fn default() -> Self {
        Self {
            start_hz: 5.0,
            end_hz: 135.0,
            rate_hz_per_s: 1.0,
            acceleration_per_hz: 0.060,
        }
    }
}

/// Order of acceleration and deceleration in the quarter periods.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum QuarterOrder {
    /// `+ − − +`: forth and back in one period, as the firmware moves.
    Mirrored,
    /// `+ − + −`: always in one direction, twice as fast.
    Alternating,
    /// `+ + − −`: a square wave that begins with its full half.
    Square,
}

impl QuarterOrder {
    /// Every order.
    pub const ALL: [Self; 3] = [Self::Mirrored, Self::Alternating, Self::Square];

    /// The lowest frequency at which this order shakes the axis, as a multiple of that of its quarters.
    pub fn first_harmonic(self) -> f64 {
        match self {
            Self::Mirrored | Self::Square => 1.0,
            Self::Alternating => 2.0,
        }
    }

    fn sign(self, quarter: usize) -> f64 {
        let positive = match self {
            Self::Mirrored => matches!(quarter % 4, 0 | 3),
            Self::Alternating => quarter.is_multiple_of(2),
            Self::Square => quarter % 4 < 2,
        };
        if positive { 1.0 } else { -1.0 }
    }
}

/// Way in which the frequency of a sweep rises.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rise {
    /// With every half period, as the firmware does it.
    HalfPeriod,
    /// With every quarter period.
    QuarterPeriod,
    /// With every period.
    Period,
    /// Without steps: the phase is the integral of `f(t) = start + rate·t`.
    Continuous,
}

impl Rise {
    /// Every way.
    pub const ALL: [Self; 4] = [Self::HalfPeriod, Self::QuarterPeriod, Self::Period, Self::Continuous];
}

/// An interval of constant acceleration.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Stretch {
    begin_s: f64,
    acceleration: f64,
    /// Velocity at its start, which is the integral of the acceleration.
    velocity: f64,
}

/// The acceleration over time, from the start of the sweep on.
#[derive(Debug, Clone, PartialEq)]
pub struct SweptAcceleration {
    stretches: Vec<Stretch>,
    end_s: f64,
}

impl SweptAcceleration {
    /// The sweep with the given order of quarters and way of rising, in m/s².
    pub fn new(sweep: &Sweep, order: QuarterOrder, rise: Rise) -> Self {
        let (mut stretches, mut time_s, mut velocity) = (Vec::new(), 0.0, 0.0);
        let mut frequency = sweep.start_hz;
        for quarter in 0.. {
            let quarter_s = match rise {
                Rise::Continuous => {
                    // The phase start·t + rate·t²/2 grows by a quarter; this form of the root does not cancel.
                    frequency = sweep.start_hz + sweep.rate_hz_per_s * time_s;
                    0.5 / (frequency + (frequency * frequency + 0.5 * sweep.rate_hz_per_s).sqrt())
                }
                Rise::QuarterPeriod | Rise::HalfPeriod | Rise::Period => 0.25 / frequency,
            };
            if frequency > sweep.end_hz * (1.0 + 1e-9) && quarter % 4 == 0 {
                break;
            }
            let acceleration = order.sign(quarter) * sweep.acceleration_per_hz * frequency;
            stretches.push(Stretch {
                begin_s: time_s,
                acceleration,
                velocity,
            });
            velocity += acceleration * quarter_s;
            time_s += quarter_s;
            let quarters = match rise {
                Rise::QuarterPeriod => 1,
                Rise::HalfPeriod => 2,
                Rise::Period => 4,
                Rise::Continuous => continue,
            };
            if (quarter + 1) % quarters == 0 {
                frequency += sweep.rate_hz_per_s * quarter_s * quarters as f64;
            }
        }
        Self {
            stretches,
            end_s: time_s,
        }
    }

    /// Time from start to end in seconds.
    pub fn duration_s(&self) -> f64 {
        self.end_s
    }

    /// Intervals of constant acceleration, each as its start time in seconds and its acceleration in m/s²; the last
    /// is the rest after the sweep.
    pub fn pieces(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let moving = self
            .stretches
            .iter()
            .map(|stretch| (stretch.begin_s, stretch.acceleration));
        moving.chain([(self.end_s, 0.0)])
    }

    /// The acceleration at the instants `start_s + n·sample_s`, in m/s².
    pub fn samples(&self, start_s: f64, sample_s: f64, samples: usize) -> Vec<f64> {
        let mut walk = Walk {
            excitation: self,
            index: 0,
        };
        (0..samples)
            .map(|n| walk.acceleration(start_s + n as f64 * sample_s))
            .collect()
    }

    /// Means of the acceleration over the sample around each of these instants, which contain hardly anything of what
    /// the samples alias into the band.
    pub fn means(&self, start_s: f64, sample_s: f64, samples: usize) -> Vec<f64> {
        let mut walk = Walk {
            excitation: self,
            index: 0,
        };
        let mut before = walk.velocity(start_s - 0.5 * sample_s);
        let mut mean = |n: usize| {
            let after = walk.velocity(start_s + (n as f64 + 0.5) * sample_s);
            let mean = (after - before) / sample_s;
            before = after;
            mean
        };
        (0..samples).map(&mut mean).collect()
    }
}

/// A position in an excitation that only moves forward.
struct Walk<'a> {
    excitation: &'a SweptAcceleration,
    index: usize,
}

impl Walk<'_> {
    /// The interval that contains a time of the sweep.
    fn stretch(&mut self, time_s: f64) -> Option<&Stretch> {
        let stretches = &self.excitation.stretches;
        if time_s < 0.0 || time_s >= self.excitation.end_s {
            return None;
        }
        while stretches.get(self.index + 1).is_some_and(|next| next.begin_s <= time_s) {
            self.index += 1;
        }
        stretches.get(self.index)
    }

    fn acceleration(&mut self, time_s: f64) -> f64 {
        self.stretch(time_s).map_or(0.0, |stretch| stretch.acceleration)
    }

    fn velocity(&mut self, time_s: f64) -> f64 {
        let end_s = self.excitation.end_s;
        if time_s >= end_s {
            let last = self.excitation.stretches.last();
            return last.map_or(0.0, |s| s.velocity + s.acceleration * (end_s - s.begin_s));
        }
        self.stretch(time_s)
            .map_or(0.0, |s| s.velocity + s.acceleration * (time_s - s.begin_s))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_the_firmwares_sweep_rises_by_its_rate() {
        let sweep = Sweep::default();
        let excitation = SweptAcceleration::new(&sweep, QuarterOrder::Mirrored, Rise::HalfPeriod);
        // The duration is 130 Hz at 1 Hz/s, plus the last period.
        assert!(
            (excitation.duration_s() - 130.0).abs() < 0.05,
            "{}",
            excitation.duration_s()
        );
        let firsts: Vec<f64> = excitation.stretches.iter().take(5).map(|s| s.acceleration).collect();
        assert_eq!(firsts[..4], [0.3, -0.3, -0.06 * 5.1, 0.06 * 5.1]);
        assert!(firsts[4] > 0.06 * 5.1);
        // The velocity returns to zero after every half period.
        for stretch in excitation.stretches.iter().step_by(2) {
            assert!(stretch.velocity.abs() < 1e-12);
        }
    }

    #[test]
    fn unit_means_are_the_integral_of_the_samples() {
        let sweep = Sweep {
            end_hz: 20.0,
            ..Sweep::default()
        };
        for rise in Rise::ALL {
            let excitation = SweptAcceleration::new(&sweep, QuarterOrder::Square, rise);
            let fine = excitation.samples(-0.01, 1e-5, 100_000);
            let coarse = excitation.means(-0.01 + 0.5e-5 * 99.0, 1e-3, 900);
            for (n, mean) in coarse.iter().enumerate() {
                let direct: f64 = fine[n * 100..(n + 1) * 100].iter().sum::<f64>() / 100.0;
                // An edge may be up to half a fine sample away from its place.
                assert!(
                    (direct - mean).abs() < 0.02 * sweep.end_hz * 0.06,
                    "{rise:?} {n} {direct} {mean}"
                );
            }
        }
    }
}
