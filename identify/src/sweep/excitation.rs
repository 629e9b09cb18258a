//! The acceleration of an axis in a firmware's resonance test, as far as its description determines it.
//!
//! ```text
//!  +a ┌─┐     ┌───┐     ┌─        half periods of two quarters each: + −, then − +, then + − …
//!   0 ┘ │     │   │     │         f rises with every half period: f ← f + rate · 1/(2f)
//!  −a   └─────┘   └─────┘         a = acceleration_per_hz · f
//! ```
//!
//! Klipper adds a slow square wave since December 2024 (`sweeping_accel`, `sweeping_period` of `resonance_tester.py`), which moves the axis
//! back and forth by centimetres:
//!
//! ```text
//!  +s ┐     ┌─────┐     ┌─        first edge after √2/8 periods, the second 1/4 + √2/8 later, then one every half period
//!  −s └─────┘     └─────┘
//! ```
//!
//! Both are constant between switching times, so that their samples, means and integrals are exact.

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
    /// Square wave beside it.
    pub sweeping: Sweeping,
}

/// The square wave of acceleration that is added to a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Sweeping {
    /// The log decides.
    #[default]
    FromLog,
    /// There is none, as in Klipper before December 2024 or with `sweeping_period: 0`.
    Off,
    /// This wave is added.
    Wave(SquareWave),
}

/// A slow square wave of acceleration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SquareWave {
    /// Its amplitude in m/s².
    pub acceleration: f64,
    /// Its period in seconds.
    pub period_s: f64,
}

impl Default for SquareWave {
    /// Klipper's wave: 400 mm/s² and 1.2 s.
    fn default() -> Self {
        Self {
            acceleration: 0.4,
            period_s: 1.2,
        }
    }
}

impl SquareWave {
    /// Times in seconds after the start of the sweep at which the acceleration changes its sign, first to negative.
    pub fn edges_s(&self) -> impl Iterator<Item = f64> {
        let first = std::f64::consts::SQRT_2 * 0.125;
        let second = 2.0 * first + 0.25;
        let later = (0u32..).map(move |n| second + 0.5 * f64::from(n));
        let period_s = self.period_s;
        std::iter::once(first).chain(later).map(move |edge| edge * period_s)
    }
}

impl Default for Sweep {
    /// The test of common 3D-printer firmware: 5 to 135 Hz at 1 Hz/s with 60 mm/s² per Hz.
    fn default() -> Self {
        Self {
            start_hz: 5.0,
            end_hz: 135.0,
            rate_hz_per_s: 1.0,
            acceleration_per_hz: 0.060,
            sweeping: Sweeping::FromLog,
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
    /// `+ + − −`: a square wave that begins with a full half period.
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

/// Frequency in Hz by which the last half period may exceed the end of the sweep, as in the firmware.
const END_HZ: f64 = 1e-6;

impl SweptAcceleration {
    /// The sweep alone, with the given order of quarters and way of rising, in m/s².
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
            // The firmware ends with a complete half period.
            let quarters_at_end = match rise {
                Rise::HalfPeriod => 2,
                _ => 4,
            };
            if frequency > sweep.end_hz + END_HZ && quarter % quarters_at_end == 0 {
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

    /// A square wave that ends with a sweep, after `end_s`.
    pub fn square_wave(wave: &SquareWave, end_s: f64) -> Self {
        let (mut stretches, mut velocity, mut begin_s) = (Vec::new(), 0.0, 0.0);
        let mut acceleration = wave.acceleration;
        for edge_s in wave.edges_s() {
            stretches.push(Stretch {
                begin_s,
                acceleration,
                velocity,
            });
            if edge_s >= end_s {
                break;
            }
            velocity += acceleration * (edge_s - begin_s);
            (begin_s, acceleration) = (edge_s, -acceleration);
        }
        Self { stretches, end_s }
    }

    /// The sum of this and another acceleration.
    #[must_use]
    pub fn beside(&self, other: &Self) -> Self {
        let mut begins_s: Vec<f64> = [self, other]
            .iter()
            .flat_map(|part| part.pieces().map(|(begin_s, _)| begin_s))
            .collect();
        begins_s.sort_by(f64::total_cmp);
        begins_s.dedup();
        let end_s = begins_s.pop().unwrap_or(0.0);
        let mut walks = [Walk::new(self), Walk::new(other)];
        let stretches = begins_s.iter().map(|&begin_s| Stretch {
            begin_s,
            acceleration: walks.iter_mut().map(|walk| walk.acceleration(begin_s)).sum(),
            velocity: walks.iter_mut().map(|walk| walk.velocity(begin_s)).sum(),
        });
        Self {
            stretches: stretches.collect(),
            end_s,
        }
    }

    /// Returns the same acceleration, followed by a stop at this deceleration in m/s² if it ends in motion.
    #[must_use]
    pub fn with_stop(mut self, deceleration: f64) -> Self {
        let velocity = Walk::new(&self).velocity(self.end_s);
        if velocity.abs() > 1e-9 {
            self.stretches.push(Stretch {
                begin_s: self.end_s,
                acceleration: -deceleration.copysign(velocity),
                velocity,
            });
            self.end_s += velocity.abs() / deceleration;
        }
        self
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
        let mut walk = Walk::new(self);
        (0..samples)
            .map(|n| walk.acceleration(start_s + n as f64 * sample_s))
            .collect()
    }

    /// The integral of the acceleration at these instants, and the integral of that, in m/s and m.
    pub fn integrals(&self, start_s: f64, sample_s: f64, samples: usize) -> [Vec<f64>; 2] {
        let mut walk = Walk::new(self);
        let velocities: Vec<f64> = (0..samples)
            .map(|n| walk.velocity(start_s + n as f64 * sample_s))
            .collect();
        let (mut now_s, mut velocity, mut position) = (start_s, 0.0, 0.0);
        let mut pieces = self.pieces().peekable();
        let mut acceleration = 0.0;
        let positions = (0..samples).map(|n| {
            let at_s = start_s + n as f64 * sample_s;
            while let Some((begin_s, next)) = pieces.next_if(|(begin_s, _)| *begin_s <= at_s) {
                let step_s = (begin_s - now_s).max(0.0);
                position += step_s * (velocity + 0.5 * step_s * acceleration);
                velocity += step_s * acceleration;
                (now_s, acceleration) = (now_s.max(begin_s), next);
            }
            let step_s = at_s - now_s;
            position += step_s * (velocity + 0.5 * step_s * acceleration);
            velocity += step_s * acceleration;
            now_s = at_s;
            position
        });
        let positions = positions.collect();
        [velocities, positions]
    }

    /// Means of the acceleration over the sample around each of these instants. They contain almost none of the aliases that the samples
    /// have in the band.
    pub fn means(&self, start_s: f64, sample_s: f64, samples: usize) -> Vec<f64> {
        let mut walk = Walk::new(self);
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

impl<'a> Walk<'a> {
    fn new(excitation: &'a SweptAcceleration) -> Self {
        Self { excitation, index: 0 }
    }

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
    fn the_firmwares_sweep_rises_by_its_rate() {
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

    /// End in s and acceleration in mm/s² of each segment, printed by `SweepingVibrationsTestGenerator.gen_test` of Klipper
    /// (`klippy/extras/resonance_tester.py`, commit 84104bbbd of August 2026) with `max_freq: 6.5`.
    const KLIPPER: [(f64, f64); 39] = [
        (0.05, 700.0),
        (0.1, 100.0),
        (0.14901960784313728, 94.0),
        (0.19803921568627453, 706.0),
        (0.21213203435596423, 711.8823529411764),
        (0.24613427415477698, -88.1176470588236),
        (0.29422933262327944, -711.8823529411764),
        (0.3414505586588591, -717.6537599573967),
        (0.38867178469443875, -82.34624004260326),
        (0.4350654063490514, -76.67969291833373),
        (0.481459028003664, -723.3203070816662),
        (0.5270673229344116, -728.8875416802198),
        (0.5726756178651592, -71.11245831978022),
        (0.6175373713823633, -65.6394629280905),
        (0.6623991248995674, -734.3605370719094),
        (0.7065500218048495, -739.743947493974),
        (0.7242640687119285, -60.25605250602598),
        (0.7507009187101316, 739.743947493974),
        (0.7941738802732369, 745.0420551226078),
        (0.8376468418363422, 54.95794487739215),
        (0.8804723170275337, 49.741189489819476),
        (0.9232977922187252, 750.2588105101805),
        (0.9655040105737129, 755.3978675331235),
        (1.0077102289287005, 44.60213246687647),
        (1.0493234210557416, 39.537386264277984),
        (1.0909366131827827, 760.462613735722),
        (1.131981203838827, 765.4561967909669),
        (1.1730257944948714, 34.543803209033),
        (1.213524572294075, 29.61845233030772),
        (1.2540233500932787, 770.3815476696923),
        (1.2939976172178604, 775.2414010055968),
        (1.3242640687119285, 24.758598994403258),
        (1.3339718843424422, -775.2414010055968),
        (1.3734415890656348, -780.0383130605464),
        (1.4129112937888275, -19.9616869394535),
        (1.4518951481643176, -15.225322372670348),
        (1.4908790025398078, -784.7746776273297),
        (1.5293945872398427, -789.4527401523885),
        (1.5679101719398776, -10.547259847611542),
    ];

    #[test]
    fn sweep_and_square_wave_match_klippers_generator() {
        let sweep = Sweep {
            end_hz: 6.5,
            ..Sweep::default()
        };
        let pulses = SweptAcceleration::new(&sweep, QuarterOrder::Mirrored, Rise::HalfPeriod);
        let wave = SweptAcceleration::square_wave(&SquareWave::default(), pulses.duration_s());
        let both = pulses.beside(&wave);
        // A row of Klipper ends where a piece of ours begins.
        let pieces: Vec<(f64, f64)> = both.pieces().collect();
        assert_eq!(pieces.len(), KLIPPER.len() + 1);
        for (n, (end_s, acceleration)) in KLIPPER.iter().enumerate() {
            assert!(
                (pieces[n].1 - 1e-3 * acceleration).abs() < 1e-12,
                "{n}: {:?}",
                pieces[n]
            );
            assert!((pieces[n + 1].0 - end_s).abs() < 1e-12, "{n}: {:?}", pieces[n + 1]);
        }
        assert_eq!(pieces[KLIPPER.len()].1, 0.0);
        // The stop brings the axis to rest.
        let velocity = |e: &SweptAcceleration| Walk::new(e).velocity(f64::INFINITY);
        assert!(velocity(&both).abs() > 1e-3);
        assert!(velocity(&both.clone().with_stop(3.0)).abs() < 1e-12);
    }

    #[test]
    fn means_are_the_integral_of_the_samples() {
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
                // An edge may be off its place by up to half a fine sample.
                assert!(
                    (direct - mean).abs() < 0.02 * sweep.end_hz * 0.06,
                    "{rise:?} {n} {direct} {mean}"
                );
            }
        }
    }
}
