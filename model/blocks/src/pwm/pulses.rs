//! The pin rule: the edges of half a period as a function of what is latched at its start, without stepping clocks.
//!
//! ```text
//! leg duty   direction, unipolar: |duty|;  half bridge: duty;  locked: (period + duty) / 2, rounded down
//!            |duty| at most max_duty
//! width  W = leg duty − dead time D            low side's pulse  L = period − W − 2 D
//! pattern    W < minimum pulse: low (none)     L < minimum pulse: high (full)     else: pulse
//!
//!            valley                    peak                      valley
//! low side   ‾‾‾‾‾‾‾‾‾\________________._______________/‾‾‾‾‾‾‾‾‾‾
//! high side  ___________________/‾‾‾‾‾‾.‾‾‾‾‾\_____________________
//!            |← h−D−⌊W/2⌋ →|← D →|←⌊W/2⌋ → ← ⌈W/2⌉ →|← D →|          h = ⌊period / 2⌋
//! ```
//!
//! With the patterns none and full there are no edges. Where one pattern follows another, the leg always obeys its
//! rules: a side stays on for the minimum pulse, then both are off for the dead time, then the other comes on, and so
//! on until the pattern is reached.
//!
//! Two boundaries are special. A new mode keeps everything off until the next update. A new direction waits, with the
//! pattern low, for a boundary before which the low side is on: then the legs change over without an edge at a pin.
//!
//! ```
//! use posicast_blocks::pwm::BridgeMode;
//! use posicast_blocks::pwm::pulses::{Bridge, Half, Latched, Timing};
//!
//! let timing = Timing { period: 100, dead_time: 4, minimum_pulse: 6 };
//! let latched = Latched { mode: BridgeMode::HalfBridge, duty: 41, max_duty: 100 };
//! let mut bridge = Bridge::default();
//! let mut edges = |half, latched| -> Vec<i64> {
//!     bridge.half(&timing, half, latched).iter().map(|edge| edge.clock).collect()
//! };
//! edges(Half::Rising, Some(&latched));
//! edges(Half::Falling, None);
//! // Low side off, high side on; then high side off, low side on: 18 + 19 clocks high.
//! assert_eq!(edges(Half::Rising, Some(&latched)), [28, 32]);
//! assert_eq!(edges(Half::Falling, None), [19, 23]);
//! ```

use super::ports::{BridgeMode, Gates};

/// Times that are taken while the outputs are off, in clocks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Timing {
    /// Clocks from valley to valley, 1 to 65,536.
    pub period: i64,
    /// Dead time from one side's off to the other's on, at least 1.
    pub dead_time: i64,
    /// Minimum pulse of a side, at least 1.
    pub minimum_pulse: i64,
}

/// Values that are latched at a boundary with an update.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Latched {
    /// Use of the pins.
    pub mode: BridgeMode,
    /// Duty in clocks, signed.
    pub duty: i64,
    /// Largest |duty|.
    pub max_duty: i64,
}

/// A half period, which begins at a boundary.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Half {
    /// From the valley to the peak: ⌊period / 2⌋ clocks.
    Rising,
    /// From the peak to the valley: the rest of the period.
    Falling,
}

/// A change of the gates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PulseEdge {
    /// Clocks since the boundary.
    pub clock: i64,
    /// The gates from this clock on.
    pub gates: Gates,
}

/// Pattern of the leg for a half or for both halves of a period.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pattern {
    /// Both sides are off.
    Off,
    /// None: the low side is on.
    Low,
    /// Full: the high side is on.
    High,
    /// The high side is on for this many clocks about the peak.
    Pulse(i64),
}

/// State of the leg. Times are in clocks since the boundary, negative before it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
enum Leg {
    #[default]
    Off,
    /// Dead time until `until`. Then the high or the low side comes on; after `Off` the one that is commanded then.
    Dead { until: i64, high: Option<bool> },
    /// A side has been on since `since`.
    On { since: i64, high: bool },
}

/// State of a bridge at a boundary, which one half hands to the next. By default everything is off.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Bridge {
    mode: BridgeMode,
    negative: bool,
    pattern: Option<Pattern>,
    leg: Leg,
    gates: Gates,
}

impl Timing {
    /// The pattern for a pulse of this many clocks.
    pub fn pattern(&self, width: i64) -> Pattern {
        let low_side_width = self.period - width - 2 * self.dead_time;
        if width < self.minimum_pulse {
            Pattern::Low
        } else if low_side_width < self.minimum_pulse {
            Pattern::High
        } else {
            Pattern::Pulse(width)
        }
    }

    /// Width of the high side's pulse before the minimum pulse and full are applied; it may have any value.
    pub fn width(&self, latched: &Latched) -> i64 {
        let duty = latched.duty.clamp(-latched.max_duty, latched.max_duty);
        let of_leg = match latched.mode {
            BridgeMode::Direction | BridgeMode::Unipolar => duty.abs(),
            BridgeMode::HalfBridge => duty.max(0),
            BridgeMode::Locked => (self.period + duty).div_euclid(2),
        };
        of_leg - self.dead_time
    }
}

impl Bridge {
    /// The edges of half a period. `latched` has the values taken at its boundary; without them the last values hold.
    pub fn half(&mut self, timing: &Timing, half: Half, latched: Option<&Latched>) -> Vec<PulseEdge> {
        if let Some(latched) = latched {
            self.pattern = Some(self.take(timing, latched));
        }
        let rising_clocks = timing.period / 2;
        let (clocks, before, after) = match half {
            Half::Rising => (rising_clocks, false, true),
            Half::Falling => (timing.period - rising_clocks, true, false),
        };
        let mut edges = Vec::new();
        match (self.pattern.unwrap_or(Pattern::Off), half) {
            (Pattern::Off, _) => {
                self.leg = Leg::Off;
                self.show(0, &mut edges);
            }
            (Pattern::Low, _) => self.drive(timing, 0..clocks, false, &mut edges),
            (Pattern::High, _) => self.drive(timing, 0..clocks, true, &mut edges),
            (Pattern::Pulse(width), half) => {
                let changes_over = match half {
                    Half::Rising => rising_clocks - timing.dead_time - width / 2,
                    Half::Falling => width - width / 2,
                };
                self.drive(timing, 0..changes_over, before, &mut edges);
                self.drive(timing, changes_over..clocks, after, &mut edges);
            }
        }
        self.leg = match self.leg {
            Leg::Off => Leg::Off,
            Leg::Dead { until, high } => Leg::Dead {
                until: until - clocks,
                high,
            },
            Leg::On { since, high } => Leg::On {
                since: since - clocks,
                high,
            },
        };
        edges
    }

    /// Switches everything off at once, as a trip or the end of `enable` does.
    pub fn switch_off(&mut self) {
        (self.leg, self.pattern, self.gates) = (Leg::Off, None, Gates::default());
    }

    /// Whether `negative` applies now.
    pub fn negative(&self) -> bool {
        self.negative
    }

    fn take(&mut self, timing: &Timing, latched: &Latched) -> Pattern {
        let pattern = timing.pattern(timing.width(latched));
        let changes_mode = self.pattern.is_some() && latched.mode != self.mode;
        self.mode = latched.mode;
        let has_direction = matches!(latched.mode, BridgeMode::Direction | BridgeMode::Unipolar);
        let turns = has_direction && pattern != Pattern::Low && (latched.duty < 0) != self.negative;
        let may_turn = match self.leg {
            Leg::Off | Leg::Dead { high: None, .. } => true,
            Leg::On { high, .. } => !high,
            Leg::Dead { .. } => false,
        };
        self.negative ^= turns && may_turn;
        match (changes_mode, turns && !may_turn) {
            (true, _) => Pattern::Off,
            (_, true) => Pattern::Low,
            _ => pattern,
        }
    }

    /// Commands a side to be on for a span of time.
    fn drive(&mut self, timing: &Timing, span: std::ops::Range<i64>, wants_high: bool, edges: &mut Vec<PulseEdge>) {
        if span.is_empty() {
            return;
        }
        let mut now = span.start;
        if self.leg == Leg::Off {
            self.leg = Leg::Dead {
                until: now + timing.dead_time,
                high: None,
            };
        }
        self.show(now, edges);
        loop {
            let (at, leg) = match self.leg {
                Leg::Dead { until, high } => {
                    let high = high.unwrap_or(wants_high && self.mode != BridgeMode::Direction);
                    (until, Leg::On { since: until, high })
                }
                Leg::On { since, high } if high != wants_high => {
                    let at = now.max(since + timing.minimum_pulse);
                    let until = at + timing.dead_time;
                    let high = Some(!high);
                    (at, Leg::Dead { until, high })
                }
                Leg::On { .. } | Leg::Off => break,
            };
            if at >= span.end {
                break;
            }
            now = at;
            self.leg = leg;
            self.show(now, edges);
        }
    }

    /// Records the gates from a clock on, if they differ.
    fn show(&mut self, clock: i64, edges: &mut Vec<PulseEdge>) {
        let (awake, sides) = match self.leg {
            Leg::Off | Leg::Dead { high: None, .. } => (false, (false, false)),
            Leg::Dead { .. } => (true, (false, false)),
            Leg::On { high, .. } => (true, (high, !high)),
        };
        let gates = Gates::of(self.mode, self.negative, awake, sides);
        if gates != self.gates {
            self.gates = gates;
            edges.push(PulseEdge { clock, gates });
        }
    }
}
