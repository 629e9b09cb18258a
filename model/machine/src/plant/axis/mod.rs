//! An axis of the machine as the hardware sees it: PWM pins in, encoder pins out.
//!
//! ```text
//! gates ─► mean of a PWM period ─► drive (first order) ─┬─ velocity ───────────────┬─► x ─► modes ─► load y
//! drive_enable, brake_release ──────────────────────────┴─ force ─► mass, friction ┘   │               │
//!                                        A, B, index ◄── encoder ◄── velocity drive: x; torque drive: y
//!                                        A, B        ◄── scale   ◄───────────────────────────── y
//! ```
//!
//! | | velocity drive | torque drive |
//! |---|---|---|
//! | `x`, the driven coordinate | the motor; the drive is stiff, so nothing acts back on it | the centre of all that is moved |
//! | a mode | `y/x = ω²/(s² + 2ζωs + ω²)` | free vibration within the mass: `d″ + 2ζωd′ + ω²d = −x″`, `y = x + d` |
//! | the encoder sees | `x`: the modes for which the shaper is designed are outside the loop | `y`: the modes are inside the loop |
//! | friction | none: the drive overcomes it | viscous and Coulomb, on `x` |
//!
//! With `[axis.steps]` the pins are step lines, and the motor is that of `[axis.stepper]`, or is always at its steps; it drives the
//! load as a velocity drive does.
//!
//! Vibration is always measured at the load. `docs/plant.md` has the reasons, and the idealisations.
//!
//! **Time** counts in clocks and is divided into cells of [`AxisPlant::cell_clocks`]. At the end of a cell the drive
//! gets the mean of the pins over the last period of the PWM, the cell is integrated exactly, and the encoder moves
//! to the new position during the next cell. The division of a time into calls does not matter: 5,000 calls with a
//! clock each and one call with 5,000 clocks give the same edges, bit for bit.
//!
//! ```
//! use posicast_machine::plant::axis::{AxisPlant, DrivePins, PlantOptions};
//!
//! let text = r#"
//! name = "slide"
//! [clock]
//! frequency_hz = 50_000_000
//! sample_hz = 10_000
//! [[axis]]
//! name = "x"
//! counts_per_unit = 1_000_000
//! [axis.shaper]
//! kind = "none"
//! [axis.pwm]
//! mode = "locked-antiphase"
//! frequency_hz = 20_000
//! [axis.drive]
//! mode = "velocity"
//! full_scale_velocity = 0.5
//! "#;
//! let machine = posicast_machine::machine_file::parse("slide.toml", text)?;
//! let mut plant = AxisPlant::new(&machine.axes[0], &machine.clock, &PlantOptions::default())?;
//! let forward = DrivePins { a_high: true, b_low: true, drive_enable: true, brake_release: true, ..DrivePins::default() };
//! plant.clocks(forward, 50_000);
//! // A millisecond at 0.5 m/s, less half a period of 50 µs in which the mean grows.
//! assert!((plant.motion().load - 0.5 * (1e-3 - 24e-6)).abs() < 1e-12);
//! // The encoder is a cell behind, and a count is a micrometre.
//! assert_eq!(plant.count(), 487);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod absolute;
mod drive;
mod encoder;
mod figures;
mod friction;
mod modes;
mod pins;
mod step_lines;
mod stepper;
mod two_mass;

pub use absolute::AbsoluteFault;
pub use encoder::EncoderPins;
pub use figures::{ErrorFigures, contour_error, residual_vibration, tracking_error};
pub use pins::DrivePins;

use self::absolute::AbsoluteEncoder;
use self::drive::Driven;
use self::encoder::{Contact, Encoder};
use self::modes::LoadModes;
use self::pins::{Command, PinMean};
use self::step_lines::StepLines;
use self::stepper::Stepper;
use super::{Plant, PlantError};
use crate::machine_file::{AxisSection, ClockSection, Drive, DriveMode, ProbeSide, PwmSection, StepsSection};

/// Longest cell of the time grid, s: short compared with a tick and with the period of any mode.
const CELL_S: f64 = 2e-6;
/// Largest position in counts; up to it positions are exact to a small fraction of a count.
const COUNTS_MAX: f64 = (1u64 << 40) as f64;

/// Settings of the simulation that the machine file does not have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlantOptions {
    /// Factor on all mode frequencies: 0.9 is a machine 10 % slower than its file. More than 0, at most 10.
    pub frequency_factor: f64,
    /// Initial position, m or rad.
    pub position: f64,
    /// Position that the encoder measures; `None`: the driven coordinate of a velocity drive, the load of a torque
    /// drive.
    pub encoder_at: Option<Coordinate>,
    /// Count at which the index is, if the encoder has one.
    pub index_at: i64,
    /// Position of the contact of a probe, if the axis has one, m or rad.
    pub contact_at: f64,
}

impl Default for PlantOptions {
    fn default() -> Self {
        Self {
            frequency_factor: 1.0,
            position: 0.0,
            encoder_at: None,
            index_at: 0,
            contact_at: 0.0,
        }
    }
}

/// A point of the machine whose position can be measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coordinate {
    /// The coordinate that the drive moves, without the modes.
    Driven,
    /// The load, with the modes.
    Load,
}

/// Why an axis cannot be simulated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AxisPlantError {
    /// A table of the axis is missing.
    #[error(
        "axis {axis} has no [axis.{table}]: a simulated axis needs [axis.pwm] and [axis.drive], or [axis.steps]; add it"
    )]
    Missing {
        /// Name of the axis.
        axis: String,
        /// Name of the missing table.
        table: &'static str,
    },
    /// The modes are invalid.
    #[error("axis {axis}: {source}")]
    Modes {
        /// Name of the axis.
        axis: String,
        /// Why they are invalid.
        source: PlantError,
    },
    /// The frequency factor is invalid.
    #[error(
        "a frequency factor of {0}: allowed is more than 0, at most 10; 0.9 is a machine 10 % slower than its file"
    )]
    FrequencyFactor(f64),
    /// The initial position is outside the range of the simulation.
    #[error(
        "axis {axis}: a start at {position} is {counts:e} counts: at most 2^40 either way can be simulated; start nearer to 0"
    )]
    Position {
        /// Name of the axis.
        axis: String,
        /// Initial position, m or rad.
        position: f64,
        /// Initial position in counts.
        counts: f64,
    },
    /// The axis can be faster than one edge per clock.
    #[error(
        "axis {axis}: {what} is {found:e} counts per clock, and an encoder gives at most 1: use coarser counts per unit, \
         a faster clock, or a smaller full scale"
    )]
    TooFast {
        /// Name of the axis.
        axis: String,
        /// The fast quantity: the velocity drive's full scale, or the velocity that a torque drive gains within a
        /// tick.
        what: &'static str,
        /// Counts per clock.
        found: f64,
    },
}

/// Motion of an axis at the end of the last whole cell. Lengths are in m or rad.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct AxisMotion {
    /// Position of the driven coordinate.
    pub position: f64,
    /// Velocity of the driven coordinate, per s.
    pub velocity: f64,
    /// Position of the load.
    pub load: f64,
    /// Sum of the amplitudes with which the modes ring: if the driven coordinate keeps its velocity, the load is
    /// never farther than this from where it would be without ringing.
    pub vibration: f64,
    /// Mean command of the pins over the last period of the PWM, as a fraction of full scale, −1 to 1.
    pub command: f64,
    /// Output of the drive: current in A, or velocity per s.
    pub drive: f64,
}

/// What the drive makes of its pins.
#[derive(Debug, Clone, PartialEq)]
enum DriveInput {
    Pwm(PinMean),
    Steps(StepLines),
}

impl DriveInput {
    #[inline]
    fn add(&mut self, pins: &DrivePins, clocks: u32) {
        match self {
            Self::Pwm(mean) => mean.add(pins, clocks),
            Self::Steps(lines) => lines.add(pins, clocks),
        }
    }

    fn take(&mut self) -> Command {
        match self {
            Self::Pwm(mean) => mean.take(),
            Self::Steps(lines) => lines.take(),
        }
    }
}

/// The simulation of an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisPlant {
    cell_clocks: u32,
    cell_s: f64,
    /// Clocks of the present cell that have passed.
    passed: u32,
    input: DriveInput,
    command: f64,
    driven: Driven,
    modes: LoadModes,
    encoder_at: Coordinate,
    encoder: Encoder,
    absolute: Option<AbsoluteEncoder>,
    scale: Option<Encoder>,
}

impl AxisPlant {
    /// Makes the axis of the machine file, at rest. `[axis.encoder]` says whether there is an index, and in which
    /// direction the lines count.
    ///
    /// # Errors
    /// [`AxisPlantError`] for an axis without PWM and drive, or steps, for invalid options, and for speeds above a count per
    /// clock.
    pub fn new(axis: &AxisSection, clock: &ClockSection, options: &PlantOptions) -> Result<Self, AxisPlantError> {
        let name = || axis.name.clone();
        let missing = |table| AxisPlantError::Missing { axis: name(), table };
        let motor = match &axis.steps {
            Some(steps) => Motor::Steps(steps),
            None => Motor::Pwm(
                axis.pwm.as_ref().ok_or_else(|| missing("pwm"))?,
                axis.drive.as_ref().ok_or_else(|| missing("drive"))?,
            ),
        };
        let factor = options.frequency_factor;
        if !(factor > 0.0 && factor <= 10.0) {
            return Err(AxisPlantError::FrequencyFactor(factor));
        }
        // The scale is a second encoder, at the load.
        let scale = axis.scale.map(|scale| scale.counts_per_unit);
        let scales = [Some(axis.counts_per_unit), scale];
        let absolute = axis.encoder.as_ref().and_then(|encoder| {
            let section = encoder.absolute.as_ref()?;
            Some(AbsoluteEncoder::new(section, encoder.invert, clock))
        });
        // An absolute encoder has no edges that could be too fast.
        for counts_per_unit in scales.into_iter().flatten().filter(|_| absolute.is_none()) {
            check(axis, &motor, clock, counts_per_unit, options.position)?;
        }
        let plant = Plant::of_axis(axis).map_err(|source| AxisPlantError::Modes { axis: name(), source })?;
        let period_clocks = match motor {
            Motor::Pwm(pwm, _) => pwm.period_clocks(clock).max(1),
            Motor::Steps(_) => clock.clocks_per_sample(),
        };
        let cell_clocks = cell_clocks(clock, period_clocks);
        let cell_s = f64::from(cell_clocks) / clock.frequency_hz;
        let stiff = match motor {
            Motor::Pwm(_, drive) => matches!(drive.mode, DriveMode::Velocity { .. }),
            Motor::Steps(_) => true,
        };
        let encoder =
            |counts_per_unit, index_at| Encoder::new(counts_per_unit, cell_clocks, index_at, options.position);
        // If the machine file states that the wiring counts down, the hardware inverts it.
        let is_reversed = axis.encoder.as_ref().is_some_and(|encoder| encoder.invert);
        let is_scale_reversed = axis.scale.is_some_and(|scale| scale.invert);
        let has_index = axis.encoder.as_ref().is_some_and(|encoder| encoder.index);
        let contact = axis.probe.map(|probe| Contact {
            at: (options.contact_at * axis.counts_per_unit).round() as i64,
            below: probe.side == ProbeSide::Minus,
            active_low: probe.active_low,
        });
        let driven = match motor {
            Motor::Pwm(_, drive) => Driven::new(drive, cell_s, options.position),
            Motor::Steps(_) => {
                let stepper = Stepper::new(axis.stepper.as_ref(), axis.counts_per_unit, cell_s, options.position);
                Driven::of_stepper(stepper, cell_s, options.position)
            }
        };
        // Motor and table with stick-slip friction contain their mode.
        let screw = axis
            .mechanics
            .as_ref()
            .and_then(|screw| Some((screw, screw.stiction?, motor.drive()?)));
        let (driven, plant) = match screw {
            Some((screw, stiction, drive)) => {
                let softer = screw.with_frequency_factor(factor);
                (
                    driven.with_stiction(drive, &softer, &stiction),
                    Plant::of_shares(Vec::new()),
                )
            }
            None => (driven, plant),
        };
        Ok(Self {
            cell_clocks,
            cell_s,
            passed: 0,
            input: match motor {
                Motor::Pwm(pwm, _) => {
                    let cells = period_clocks / cell_clocks;
                    DriveInput::Pwm(PinMean::new(pwm.mode, pwm.active_low, cell_clocks, cells))
                }
                Motor::Steps(steps) => DriveInput::Steps(StepLines::new(steps, cell_clocks)),
            },
            command: 0.0,
            driven,
            modes: LoadModes::new(&plant.scaled(factor), cell_s, stiff).along(axis, factor, options.position),
            encoder_at: options
                .encoder_at
                .unwrap_or(if stiff { Coordinate::Driven } else { Coordinate::Load }),
            encoder: encoder(axis.counts_per_unit, has_index.then_some(options.index_at))
                .reversed(is_reversed)
                .with_contact(contact),
            absolute,
            scale: scale.map(|counts_per_unit| encoder(counts_per_unit, None).reversed(is_scale_reversed)),
        })
    }

    /// Clocks of a cell: the largest divisor of the PWM period that lasts at most 2 µs.
    pub fn cell_clocks(&self) -> u32 {
        self.cell_clocks
    }

    /// Simulates this many clocks with these pins.
    #[inline]
    pub fn clocks(&mut self, pins: DrivePins, clocks: u64) {
        if let Some(absolute) = &mut self.absolute {
            absolute.pass(clocks);
        }
        let mut left = clocks;
        while left > 0 {
            let now = left.min(u64::from(self.cell_clocks - self.passed)) as u32;
            left -= u64::from(now);
            self.input.add(&pins, now);
            self.passed += now;
            if self.absolute.is_none() {
                self.encoder.pass(self.passed);
            }
            if let Some(scale) = &mut self.scale {
                scale.pass(self.passed);
            }
            if self.passed == self.cell_clocks {
                self.end_cell();
            }
        }
    }

    /// Shows an absolute encoder the level of its line's clock in this clock, before [`quiet_clocks`](Self::quiet_clocks) and
    /// [`clocks`](Self::clocks). An axis without one ignores it.
    pub fn encoder_clock(&mut self, level: bool) {
        let count = self.count();
        if let Some(absolute) = &mut self.absolute {
            absolute.see(level, count);
        }
    }

    /// The data line of an absolute encoder in this clock; low without one.
    pub fn encoder_data(&self) -> bool {
        self.absolute.as_ref().is_some_and(AbsoluteEncoder::data)
    }

    /// Whether the axis has an absolute encoder.
    pub fn is_absolute(&self) -> bool {
        self.absolute.is_some()
    }

    /// Gives the absolute encoder a fault, or mends it. An axis without one ignores it.
    pub fn set_absolute_fault(&mut self, fault: Option<AbsoluteFault>) {
        if let Some(absolute) = &mut self.absolute {
            absolute.set_fault(fault);
        }
    }

    /// Displaces the whole axis by this many counts of the encoder, as a hand or a shock would. The lines follow in
    /// the cell after the present one.
    pub fn displace(&mut self, counts: f64) {
        self.driven.displace(self.encoder.length(counts));
    }

    fn end_cell(&mut self) {
        let command = self.input.take();
        let before = self.driven.position;
        self.driven.cell(&command);
        self.modes
            .cell((self.driven.position - before) / self.cell_s, self.driven.position);
        self.command = command.share;
        self.passed = 0;
        let load = self.load();
        self.encoder.move_to(match self.encoder_at {
            Coordinate::Driven => self.driven.position,
            Coordinate::Load => load,
        });
        if let Some(scale) = &mut self.scale {
            scale.move_to(load);
        }
    }

    fn load(&self) -> f64 {
        self.driven
            .load()
            .map_or_else(|| self.driven.position + self.modes.deflection(), |(load, _)| load)
    }

    /// The encoder's lines in the next clock.
    #[inline]
    pub fn encoder(&self) -> EncoderPins {
        self.encoder.pins()
    }

    /// The scale's lines in the next clock; without a scale they are low.
    #[inline]
    pub fn scale(&self) -> EncoderPins {
        self.scale.as_ref().map_or_else(EncoderPins::default, Encoder::pins)
    }

    /// Number of clocks from now on, at least one, in which the lines of encoder and scale do not change, whatever
    /// the pins do. It is at most a cell and a clock, because later motion is not yet known.
    #[inline]
    pub fn quiet_clocks(&self) -> u64 {
        if let Some(absolute) = &self.absolute {
            return absolute
                .quiet_clocks()
                .min(u64::from(self.cell_clocks + 1 - self.passed));
        }
        let scale = self.scale.as_ref().map_or(u32::MAX, Encoder::quiet_until);
        u64::from(self.encoder.quiet_until().min(scale) - self.passed)
    }

    /// The encoder's count, as a counter that missed nothing shows it, counted from the initial position; on an axis with
    /// steps, those that the drive has taken.
    pub fn count(&self) -> i64 {
        match &self.input {
            DriveInput::Pwm(_) if self.absolute.is_some() => self.encoder.sampled(self.passed),
            DriveInput::Pwm(_) => self.encoder.count(),
            DriveInput::Steps(lines) => lines.steps(),
        }
    }

    /// The scale's count, if there is a scale.
    pub fn scale_count(&self) -> Option<i64> {
        self.scale.as_ref().map(Encoder::count)
    }

    /// Motion of the axis at the end of the last whole cell.
    pub fn motion(&self) -> AxisMotion {
        AxisMotion {
            position: self.driven.position,
            velocity: self.driven.velocity,
            load: self.load(),
            vibration: self.driven.load().map_or_else(
                || self.modes.vibration(self.driven.velocity),
                |(_, amplitude)| amplitude,
            ),
            command: self.command,
            drive: self.driven.output(),
        }
    }

    /// Number of clocks in which both sides of a leg were on: a short circuit, which a PWM must never make.
    pub fn shorted_clocks(&self) -> u64 {
        match &self.input {
            DriveInput::Pwm(mean) => mean.shorted(),
            DriveInput::Steps(_) => 0,
        }
    }

    /// Whether the pins are step lines.
    pub fn has_steps(&self) -> bool {
        matches!(self.input, DriveInput::Steps(_))
    }

    /// Number of steps that came while the drive was disabled, which it does not make; 0 with a PWM.
    pub fn ignored_steps(&self) -> u64 {
        match &self.input {
            DriveInput::Pwm(_) => 0,
            DriveInput::Steps(lines) => lines.ignored_steps(),
        }
    }

    /// Steps that the motor has lost, because it was pulled over: multiples of four full steps; 0 with a PWM.
    pub fn lost_steps(&self) -> i64 {
        match &self.input {
            DriveInput::Pwm(_) => 0,
            DriveInput::Steps(lines) => self.driven.lost_steps(lines.steps()),
        }
    }
}

/// The longest cell that divides a period of the PWM.
fn cell_clocks(clock: &ClockSection, period_clocks: u32) -> u32 {
    let longest = ((clock.frequency_hz * CELL_S) as u32).clamp(1, period_clocks);
    let divides = |cell: &u32| period_clocks.is_multiple_of(*cell);
    (1..=longest).rev().find(divides).unwrap_or(1)
}

/// What moves an axis.
#[derive(Clone, Copy)]
enum Motor<'a> {
    Pwm(&'a PwmSection, &'a Drive),
    Steps(&'a StepsSection),
}

impl<'a> Motor<'a> {
    fn drive(self) -> Option<&'a Drive> {
        match self {
            Self::Pwm(_, drive) => Some(drive),
            Self::Steps(_) => None,
        }
    }
}

/// Checks that an encoder with this many counts per unit can follow the axis.
fn check(
    axis: &AxisSection,
    motor: &Motor<'_>,
    clock: &ClockSection,
    counts_per_unit: f64,
    position: f64,
) -> Result<(), AxisPlantError> {
    let counts = position * counts_per_unit;
    if counts.is_nan() || counts.abs() > COUNTS_MAX {
        return Err(AxisPlantError::Position {
            axis: axis.name.clone(),
            position,
            counts,
        });
    }
    let Some(drive) = motor.drive() else {
        // The step generator is far below a step per clock.
        return Ok(());
    };
    let (what, speed) = match drive.mode {
        DriveMode::Velocity { full_scale_velocity } => ("full scale", full_scale_velocity),
        DriveMode::Torque {
            equivalent_mass,
            force_constant,
            current_limit_a,
            ..
        } => {
            let acceleration = force_constant / equivalent_mass * current_limit_a;
            (
                "the velocity gained within a tick",
                acceleration * clock.sample_period_s(),
            )
        }
    };
    let found = speed * counts_per_unit / clock.frequency_hz;
    if found <= 1.0 {
        return Ok(());
    }
    Err(AxisPlantError::TooFast {
        axis: axis.name.clone(),
        what,
        found,
    })
}

#[cfg(test)]
mod tests;
