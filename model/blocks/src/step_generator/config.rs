//! Build parameters of a step generator: ticks, the position's format, and what the drive asks of its lines.

/// Largest number of clocks per tick.
pub const MOST_TICK_CLOCKS: u64 = (1 << 17) - 1;
/// Largest number of fraction bits of the position.
pub const MOST_FRACTION_BITS: u32 = 16;
/// Largest time of a line in clocks.
pub const MOST_LINE_CLOCKS: u64 = u16::MAX as u64;
/// Largest limit of the steps that are owed.
pub const MOST_OWED_STEPS: u64 = (1 << 15) - 2;
/// Largest number of units per step; a unit is the smallest part of a step between two ticks.
const MOST_UNITS: u64 = 1 << 30;

/// What the two lines show.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum StepMode {
    /// A pulse of A is a step; B is its direction, on is up.
    #[default]
    StepDirection,
    /// A pulse of A is a step up, one of B a step down (CW and CCW).
    UpDown,
    /// Each edge is a step; A leads B when going up.
    Quadrature,
}

impl StepMode {
    /// Every mode.
    pub const ALL: [Self; 3] = [Self::StepDirection, Self::UpDown, Self::Quadrature];

    /// Name of the mode, in machine files and in Verilog.
    pub fn name(self) -> &'static str {
        match self {
            Self::StepDirection => "step_direction",
            Self::UpDown => "up_down",
            Self::Quadrature => "quadrature",
        }
    }

    /// Names of the lines A and B.
    pub fn line_names(self) -> [&'static str; 2] {
        match self {
            Self::StepDirection => ["step", "direction"],
            Self::UpDown => ["step_up", "step_down"],
            Self::Quadrature => ["step_a", "step_b"],
        }
    }
}

/// Times of the lines in clocks, all of them minima.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StepTimes {
    /// A pulse, at least 1.
    pub pulse_clocks: u64,
    /// From the end of a pulse to the next pulse, at least 1. Pulse and space are the shortest period.
    pub space_clocks: u64,
    /// From a change of direction to the next pulse; 0 counts as 1.
    pub direction_setup_clocks: u64,
    /// From the end of a pulse to a change of direction; 0 counts as 1.
    pub direction_hold_clocks: u64,
}

/// Times of the lines in seconds, as a drive's datasheet has them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepTimesInSeconds {
    /// As [`StepTimes::pulse_clocks`].
    pub pulse_s: f64,
    /// As [`StepTimes::space_clocks`].
    pub space_s: f64,
    /// As [`StepTimes::direction_setup_clocks`].
    pub direction_setup_s: f64,
    /// As [`StepTimes::direction_hold_clocks`].
    pub direction_hold_s: f64,
}

/// Why a step generator cannot be built.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum StepGeneratorConfigError {
    /// A time that is no number of seconds.
    #[error("`{name}` of {seconds} s at {clock_hz} Hz: a time is 0 s or more, and a clock above 0 Hz")]
    Seconds {
        /// Which of the times.
        name: &'static str,
        /// What was found.
        seconds: f64,
        /// The clock's frequency.
        clock_hz: f64,
    },
    /// A time of the lines that the timer does not hold.
    #[error("`{name}` takes {clocks} clocks: {least} to 65535 are allowed; check the unit, or choose a slower clock")]
    Clocks {
        /// Which of the times.
        name: &'static str,
        /// What was found.
        clocks: u64,
        /// Smallest number of clocks.
        least: u64,
    },
    /// The clocks per tick are 0 or too many.
    #[error("{0} clocks per tick: 1 to 131071 are allowed; choose a higher sample rate or a slower clock")]
    TickClocks(u64),
    /// More fraction bits than the position can use.
    #[error("{0} fraction bits of the position: 0 to 16 are allowed")]
    FractionBits(u32),
    /// A step has more parts than the accumulator holds.
    #[error(
        "{tick_clocks} clocks per tick and {fraction_bits} fraction bits: clocks · 2^bits may be at most 2^30; \
         choose fewer fraction bits or a higher sample rate"
    )]
    Units {
        /// Clocks per tick.
        tick_clocks: u64,
        /// Fraction bits of the position.
        fraction_bits: u32,
    },
    /// The shortest period is so long that a tick cannot move the position by its smallest part.
    #[error(
        "pulse and space take {period_clocks} clocks, and a tick of {tick_clocks} clocks moves the position by at least \
         2^-{fraction_bits} of a step, which is too fast: choose more fraction bits or a lower sample rate"
    )]
    NoRate {
        /// Clocks of pulse and space.
        period_clocks: u64,
        /// Clocks per tick.
        tick_clocks: u64,
        /// Fraction bits of the position.
        fraction_bits: u32,
    },
    /// The limit of the steps that are owed is 0, or the register does not hold it.
    #[error("at most {0} steps owed: 1 to 32766 are allowed; take a few more than a reversal owes")]
    OwedLimit(u64),
}

impl StepTimes {
    /// The times in clocks, rounded up. What is above a whole number of clocks by a millionth of a clock only counts as
    /// that number: 2.5 µs at 50 MHz are 125 clocks, although the product of the floating-point numbers is above.
    ///
    /// # Errors
    /// [`StepGeneratorConfigError::Seconds`] for a time or a clock that is negative or not finite.
    pub fn from_seconds(times: StepTimesInSeconds, clock_hz: f64) -> Result<Self, StepGeneratorConfigError> {
        let clocks = |name, seconds: f64| {
            let exact = seconds * clock_hz;
            if seconds.is_finite() && seconds >= 0.0 && exact.is_finite() && clock_hz > 0.0 {
                Ok((exact - 1e-6).ceil().max(0.0) as u64)
            } else {
                Err(StepGeneratorConfigError::Seconds {
                    name,
                    seconds,
                    clock_hz,
                })
            }
        };
        Ok(Self {
            pulse_clocks: clocks("pulse_s", times.pulse_s)?,
            space_clocks: clocks("space_s", times.space_s)?,
            direction_setup_clocks: clocks("direction_setup_s", times.direction_setup_s)?,
            direction_hold_clocks: clocks("direction_hold_s", times.direction_hold_s)?,
        })
    }
}

/// Build parameters of a step generator.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StepGeneratorConfig {
    tick_clocks: u32,
    fraction_bits: u32,
    mode: StepMode,
    times: StepTimes,
    active_low: StepLinesActiveLow,
    owed_limit: u16,
}

/// The lines that are active low. Such a line is off at a high level, in reset too.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct StepLinesActiveLow {
    /// Line A.
    pub a: bool,
    /// Line B.
    pub b: bool,
}

impl StepGeneratorConfig {
    /// A step generator for ticks that are `tick_clocks` apart, a position with `fraction_bits`, and lines of a mode with
    /// these times. More than `owed_limit` steps owed are a cause. The lines are active high.
    ///
    /// # Errors
    /// [`StepGeneratorConfigError`] for what does not fit the registers, and for a largest rate of 0.
    pub fn new(
        tick_clocks: u64,
        fraction_bits: u32,
        mode: StepMode,
        times: StepTimes,
        owed_limit: u64,
    ) -> Result<Self, StepGeneratorConfigError> {
        use StepGeneratorConfigError as Wrong;

        if fraction_bits > MOST_FRACTION_BITS {
            return Err(Wrong::FractionBits(fraction_bits));
        }
        if !(1..=MOST_TICK_CLOCKS).contains(&tick_clocks) {
            return Err(Wrong::TickClocks(tick_clocks));
        }
        if tick_clocks << fraction_bits > MOST_UNITS {
            return Err(Wrong::Units {
                tick_clocks,
                fraction_bits,
            });
        }
        let listed = [
            ("pulse", times.pulse_clocks, 1),
            ("space", times.space_clocks, 1),
            ("direction setup", times.direction_setup_clocks, 0),
            ("direction hold", times.direction_hold_clocks, 0),
        ];
        for (name, clocks, least) in listed {
            if !(least..=MOST_LINE_CLOCKS).contains(&clocks) {
                return Err(Wrong::Clocks { name, clocks, least });
            }
        }
        if !(1..=MOST_OWED_STEPS).contains(&owed_limit) {
            return Err(Wrong::OwedLimit(owed_limit));
        }
        let config = Self {
            tick_clocks: tick_clocks as u32,
            fraction_bits,
            mode,
            times: StepTimes {
                direction_setup_clocks: times.direction_setup_clocks.max(1),
                direction_hold_clocks: times.direction_hold_clocks.max(1),
                ..times
            },
            active_low: StepLinesActiveLow::default(),
            owed_limit: owed_limit as u16,
        };
        match config.largest_difference() {
            0 => Err(Wrong::NoRate {
                period_clocks: config.period_clocks(),
                tick_clocks,
                fraction_bits,
            }),
            _ => Ok(config),
        }
    }

    /// The same with these lines active low.
    #[must_use]
    pub fn active_low(self, active_low: StepLinesActiveLow) -> Self {
        Self { active_low, ..self }
    }

    /// Clocks from tick to tick.
    pub fn tick_clocks(&self) -> u32 {
        self.tick_clocks
    }

    /// Fraction bits of the position.
    pub fn fraction_bits(&self) -> u32 {
        self.fraction_bits
    }

    /// What the lines show.
    pub fn mode(&self) -> StepMode {
        self.mode
    }

    /// Times of the lines in clocks, as they are built: direction setup and hold are at least 1.
    pub fn times(&self) -> StepTimes {
        self.times
    }

    /// The lines that are active low.
    pub fn lines_active_low(&self) -> StepLinesActiveLow {
        self.active_low
    }

    /// Largest number of steps that may be owed.
    pub fn owed_limit(&self) -> u16 {
        self.owed_limit
    }

    /// Units per step: a step is divided by the fraction of the position, and that by the clocks of a tick.
    pub fn step_units(&self) -> u32 {
        self.tick_clocks << self.fraction_bits
    }

    /// Shortest time from step to step in one direction, in clocks.
    pub fn period_clocks(&self) -> u64 {
        self.times.pulse_clocks + self.times.space_clocks
    }

    /// Largest change of the position from tick to tick that is not `too_fast`, in units of its last fraction bit.
    pub fn largest_difference(&self) -> u32 {
        (u64::from(self.step_units()) / self.period_clocks()) as u32
    }

    /// From a change of direction to the next pulse, in clocks: a space is kept even if the hold is shorter.
    pub fn turned_clocks(&self) -> u64 {
        self.times.direction_setup_clocks.max(self.times.space_clocks)
    }

    /// Largest number of steps that a reversal at the largest rate leaves owed: a limit below stops such a reversal.
    pub fn reversal_steps(&self) -> u64 {
        let waits = self.times.pulse_clocks + self.times.direction_hold_clocks + self.turned_clocks();
        waits.div_ceil(self.period_clocks()) + 1
    }

    /// Width of the accumulator in bits: it holds −units ‥ units − 1.
    pub fn accumulator_bits(&self) -> u32 {
        33 - (self.step_units() - 1).leading_zeros()
    }
}
