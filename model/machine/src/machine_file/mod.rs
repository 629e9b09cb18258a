//! Parses and validates the machine file, an engineer's description of a machine.
//!
//! The types here hold only values that passed validation; [`parse`] is the one way to make them from text. It reads
//! the whole schema of `docs/machine-file.md`, checks every value, and reports all problems of a file at once.
//!
//! ```
//! let text = r#"
//! name = "slide"
//! [clock]
//! frequency_hz = 50_000_000
//! sample_hz = 10_000
//! [[axis]]
//! name = "x"
//! counts_per_unit = 1_000_000
//! [axis.shaper]
//! kind = "zvd"
//! [[axis.mode]]
//! frequency_hz = 40.0
//! damping = 1.3
//! "#;
//! let error = posicast_machine::machine_file::parse("slide.toml", text).unwrap_err();
//! assert_eq!(
//!     error.to_string(),
//!     "slide.toml:13: axis.mode.damping of axis x, mode 1: found 1.3; allowed: at least 0, below 1"
//! );
//! ```
//!
//! [`posicast_shaper::digitise`] and [`posicast_blocks::shaper`] check whether tables and delays fit the hardware's sizes.

mod absolute;
mod axis;
mod capture;
mod compare;
mod controller;
mod correction;
mod drive;
mod encoder;
mod error;
mod error_table;
mod hint;
mod input;
mod key;
mod limits;
mod link;
mod machine;
mod mechanics;
mod mode;
mod moving;
mod names;
mod page;
mod place;
mod probe;
mod pwm;
mod quantity;
mod range;
mod reader;
mod scale;
mod schema;
mod shaper;
mod stage;
mod stepper;
mod steps;
mod table;
mod trace;

pub use absolute::{AbsoluteSection, CABLE_DELAY_S_PER_M};
pub use capture::{CaptureEdge, CaptureSection};
pub use compare::{CompareDirection, CompareSection};
pub use controller::Controller;
pub use correction::CorrectionSection;
pub use drive::{Drive, DriveMode};
pub use encoder::Encoder;
pub use error::{MAX_PROBLEMS, Problem, ProblemCause, SpecError};
pub use error_table::{ErrorTableSection, ErrorUse, STEEPEST_IN_FILE};
pub use input::{BeyondLimits, InputSection, MOST_INPUT_HZ};
pub use limits::LimitsSection;
pub use link::{BridgeConfigError, LinkLine, LinkSection};
pub use machine::{BOARDS, FAMILIES};
pub use moving::FamilySection;
pub(crate) use moving::MAX_TABLES;
pub use page::with_tables;
pub use place::line_of;
pub use probe::{ProbeSection, ProbeSide};
pub use pwm::{PwmMode, PwmSection};
pub use scale::{Scale, ScaleUse};
pub use schema::schema;
pub use stage::StageSection;
pub use stepper::StepperSection;
pub use steps::StepsSection;
pub use trace::TraceSection;

use std::cell::RefCell;
use toml::de::DeTable;

use crate::mechanics::ScrewDrive;
use crate::unit::AxisUnit;
use posicast_blocks::bus_component::BridgedBus;
use posicast_blocks::link::Crc;
use posicast_shaper::axis::{AxisMode, ShapedAxis, ShaperChoice};
use posicast_shaper::digitise::Digitise;
use range::RATIO_ROUNDING;
use reader::Reader;
use table::Table;

/// Parses and validates a machine file. `file_name` only appears in messages; the function does not read from disk.
///
/// # Errors
/// [`SpecError`] lists every problem, up to [`MAX_PROBLEMS`], with file, line, key, what was found, what is allowed
/// and what to do. A feature that this version does not build is reported only where the file has no other problem.
pub fn parse(file_name: &str, text: &str) -> Result<Machine, SpecError> {
    parse_beside(file_name, text, &|_| {
        Err("files beside the machine file are not read here".to_owned())
    })
}

/// Parses a machine file with other files beside it, such as an error table. `beside` returns the text of the file of that name, or the
/// reason why it cannot be read.
///
/// # Errors
/// As [`parse`], and for problems in those files.
pub fn parse_beside(
    file_name: &str,
    text: &str,
    beside: &dyn Fn(&str) -> Result<String, String>,
) -> Result<Machine, SpecError> {
    let files = RefCell::new(vec![(String::new(), text.to_owned())]);
    let beside = |name: &str| {
        let text = beside(name)?;
        let mut files = files.borrow_mut();
        if files.iter().all(|(other, _)| other != name) {
            files.push((name.to_owned(), text.clone()));
        }
        Ok(text)
    };
    let reader = Reader::new(file_name, text, &beside);
    let whole_file = |span: std::ops::Range<usize>, cause, remedy: &str| {
        let span = span.start.min(text.len())..span.end.min(text.len());
        reader.report(reader.problem(span, String::new(), "", cause, remedy.to_owned()));
        None
    };
    let machine = match DeTable::parse(text) {
        Err(error) => {
            let span = error.span().unwrap_or(text.len()..text.len());
            let line = reader.quote(reader.line_span(span.start));
            let remedy = hint::of_syntax(error.message(), &line);
            let first = if error.message().contains("duplicate key") {
                hint::first_of_its_name(text, span.start)
            } else {
                None
            };
            let first = first.map_or_else(String::new, |first| format!(", which line {first} has already"));
            let cause = ProblemCause::Syntax(format!("{}{first}, in `{}`", error.message(), line.trim()));
            whole_file(span, cause, &remedy)
        }
        Ok(document) if document.get_ref().is_empty() => {
            let allowed = "the keys name, [clock] and [[axis]]".to_owned();
            let cause = ProblemCause::Empty { allowed };
            whole_file(
                0..0,
                cause,
                "`posicast new FILE` writes a file to start from; examples/ has others",
            )
        }
        Ok(document) => machine::read(&Table::root(&reader, document.get_ref())),
    };
    let mut machine = reader.finish(machine)?;
    if let Some(link) = &mut machine.link {
        let files = files.borrow();
        let bytes: Vec<u8> = files.iter().flat_map(|(_, text)| text.bytes()).collect();
        link.machine_crc = Crc::of(&bytes);
    }
    Ok(machine)
}

/// A whole machine file.
#[derive(Debug, Clone, PartialEq)]
pub struct Machine {
    /// Name of the machine, from which Verilog names derive: `[a-z][a-z0-9_]*`, no keyword.
    pub name: String,
    /// Clock and sample tick.
    pub clock: ClockSection,
    /// Number formats and method of digitising.
    pub fixed_point: FixedPoint,
    /// Device for the synthesis estimate.
    pub target: Option<Target>,
    /// The axes, one to four, with unique names.
    pub axes: Vec<AxisSection>,
    /// `[stage]`: settings of all axes together.
    pub stage: Option<StageSection>,
    /// `[capture]`: the line whose edges take the positions of all axes; only with a stage.
    pub capture: Option<CaptureSection>,
    /// `[link]`: the line, serial or SPI, to the registers of the stage or the inline shaper.
    pub link: Option<LinkSection>,
}

/// `[clock]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClockSection {
    /// Fabric clock in Hz.
    pub frequency_hz: f64,
    /// Sample tick in Hz; divides `frequency_hz`.
    pub sample_hz: f64,
}

impl ClockSection {
    /// Fabric clocks per sample. The quotient is exact: validation makes sure of it.
    pub fn clocks_per_sample(&self) -> u32 {
        (self.frequency_hz / self.sample_hz).round() as u32
    }

    /// The smallest whole number of clocks that lasts at least `seconds`. A decimal such as `500e-9`, which binary
    /// fractions only approximate, does not gain a clock by its rounding.
    pub fn clocks_up(&self, seconds: f64) -> u32 {
        let clocks = seconds * self.frequency_hz;
        (clocks * (1.0 - RATIO_ROUNDING)).ceil() as u32
    }

    /// Sample period in seconds.
    pub fn sample_period_s(&self) -> f64 {
        1.0 / self.sample_hz
    }
}

/// `[fixed_point]`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FixedPoint {
    /// Width of a command word in bits: 8 to 32.
    pub command_bits: u32,
    /// Fraction bits of position, in encoder counts.
    pub command_fraction: u32,
    /// Fraction bits of velocity, in counts per sample.
    pub velocity_fraction: u32,
    /// Fraction bits of acceleration, in counts per sample².
    pub acceleration_fraction: u32,
    /// Fraction bits of the coefficients; `None`: the largest number that fits is chosen.
    pub coefficient_fraction: Option<u32>,
    /// Method of digitising.
    pub digitise: Digitise,
}

/// `[target]`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Target {
    /// Device family, one of [`FAMILIES`]; always there beside a board.
    pub family: Option<String>,
    /// Board, one of [`BOARDS`].
    pub board: Option<String>,
    /// Bus of the registers, if it is not Avalon-MM.
    pub bus: Option<BridgedBus>,
}

/// `[[axis]]`.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisSection {
    /// Name, unique in the machine; Verilog names derive from it.
    pub name: String,
    /// Unit of the axis's figures in the file; the values here are in m, rad and s.
    pub unit: AxisUnit,
    /// Encoder counts, or steps, per m or rad.
    pub counts_per_unit: f64,
    /// Whether the position wraps modulo `2^command_bits`, as on a rotary axis without end stops.
    pub modulo: bool,
    /// `[axis.shaper]`; absent only if every mode names its own shaper.
    pub shaper: Option<ShaperChoice>,
    /// Modes in the order of the file; empty only for the kinds `custom` and `none`.
    pub modes: Vec<AxisMode>,
    /// `[axis.mechanics]`; the axis's only mode is then computed from it.
    pub mechanics: Option<ScrewDrive>,
    /// The variable with which the modes move; `None` where no mode has `points`. `modes` then holds the modes at its
    /// nominal value.
    pub family: Option<FamilySection>,
    /// `[axis.encoder]`.
    pub encoder: Option<Encoder>,
    /// `[axis.pwm]`.
    pub pwm: Option<PwmSection>,
    /// `[axis.drive]`; only with `[axis.pwm]`.
    pub drive: Option<Drive>,
    /// `[axis.controller]`; only with encoder, PWM and drive.
    pub controller: Option<Controller>,
    /// `[axis.steps]`; only without encoder, PWM, drive and controller, and with limits.
    pub steps: Option<StepsSection>,
    /// `[axis.stepper]`; only with steps.
    pub stepper: Option<StepperSection>,
    /// `[axis.probe]`; only with steps, and without an input.
    pub probe: Option<ProbeSection>,
    /// `[axis.input]`; only with steps, and on every axis or none.
    pub input: Option<InputSection>,
    /// `[axis.limits]`.
    pub limits: Option<LimitsSection>,
    /// `[axis.scale]`; only with an encoder or steps.
    pub scale: Option<Scale>,
    /// `[axis.compare]`; only with a controller or steps, and without an input.
    pub compare: Option<CompareSection>,
    /// `[axis.correction]`; only with steps and a scale.
    pub correction: Option<CorrectionSection>,
    /// `[axis.error_table]`; only with a controller or steps.
    pub error_table: Option<ErrorTableSection>,
    /// `[axis.trace]`; only with a controller or steps.
    pub trace: Option<TraceSection>,
}

impl AxisSection {
    /// Whether the axis has more than a shaper, for a host to operate. An axis whose command comes as step pulses has no host.
    pub fn has_loop(&self) -> bool {
        self.input.is_none()
            && (self.encoder.is_some() || self.pwm.is_some() || self.controller.is_some() || self.steps.is_some())
    }

    /// The absolute encoder, if the axis has one: the stage reads it, and the axis needs no homing.
    pub fn absolute_encoder(&self) -> Option<&AbsoluteSection> {
        self.encoder.as_ref()?.absolute.as_ref()
    }

    /// Counts per m or rad of the counter that the position loop runs on: the encoder's, or the scale's where that is
    /// the loop's position. Commands, errors and distances of the hardware are in these counts.
    pub fn loop_counts_per_unit(&self) -> f64 {
        match self.scale {
            Some(scale) if scale.usage == ScaleUse::Position => scale.counts_per_unit,
            _ => self.counts_per_unit,
        }
    }

    /// The axis as the design of its shaper sees it.
    pub fn shaped(&self) -> ShapedAxis<'_> {
        ShapedAxis {
            name: &self.name,
            shaper: self.shaper.as_ref(),
            modes: &self.modes,
        }
    }

    /// Counts of the loop per unit of the machine file.
    pub fn loop_counts_per_file_unit(&self) -> f64 {
        self.unit.counts_in_file(self.loop_counts_per_unit())
    }
}
