//! The machine file: what an engineer knows of a machine, parsed and validated.
//!
//! The types here hold only values that passed validation; [`parse`] is the one way to make them from text. It reads
//! the whole schema of `docs/machine-file.md`, checks every value, and reports all problems of a file at once. A kind
//! of shaper that is known but not built in this version is checked as the others are, and then refused with
//! `not built in this version: NAME`: a machine never silently lacks what its file asks for.
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
//! let error = posicast_model::machine_file::parse("slide.toml", text).unwrap_err();
//! assert_eq!(
//!     error.to_string(),
//!     "slide.toml:13: axis.mode.damping of axis x, mode 1: found 1.3; allowed: at least 0, below 1"
//! );
//! ```
//!
//! [`crate::digitise`] and [`crate::rtl::shaper`] check whether tables and delays fit the hardware's sizes.

mod axis;
mod controller;
mod drive;
mod encoder;
mod error;
mod error_table;
mod hint;
mod key;
mod limits;
mod link;
mod machine;
mod mechanics;
mod mode;
mod moving;
mod names;
mod place;
mod pwm;
mod quantity;
mod range;
mod reader;
mod scale;
mod schema;
mod shaper;
mod stage;
mod table;
mod trace;

pub use controller::Controller;
pub use drive::{Drive, DriveMode};
pub use encoder::Encoder;
pub use error::{MAX_PROBLEMS, Problem, ProblemCause, SpecError};
pub use error_table::{ErrorTableSection, ErrorUse, STEEPEST_IN_FILE};
pub use limits::LimitsSection;
pub use link::{BridgeConfigError, LinkLine, LinkSection};
pub use machine::{BOARDS, FAMILIES};
pub(crate) use moving::MAX_TABLES;
pub use moving::{FamilySection, ModePoint};
pub use place::line_of;
pub use pwm::{PwmMode, PwmSection};
pub use scale::{Scale, ScaleUse};
pub use schema::schema;
pub use stage::StageSection;
pub use trace::TraceSection;

use std::cell::RefCell;
use toml::de::DeTable;

use crate::design::kind::ShaperKind;
use crate::link::Crc;
use crate::mechanics::ScrewDrive;
use crate::mode::{Mode, ModeBand};
use crate::unit::AxisUnit;
use posicast_optimal::{Command, Prefer};
use reader::Reader;
use table::Table;

/// Parses and validates a machine file. `file_name` appears in messages only: nothing is read from disk.
///
/// # Errors
/// [`SpecError`] lists every problem, up to [`MAX_PROBLEMS`], with file, line, key, what was found, what is allowed
/// and what to do. A feature that this version does not build is reported only where the file has no other problem.
pub fn parse(file_name: &str, text: &str) -> Result<Machine, SpecError> {
    parse_beside(file_name, text, &|_| {
        Err("files beside the machine file are not read here".to_owned())
    })
}

/// The same for a machine file with others beside it, such as an error table: `beside` gives the text of the file of that name, or says why
/// it cannot be read.
///
/// # Errors
/// As [`parse`], and for what is wrong in those files.
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
            let first = match error.message().contains("duplicate key") {
                true => hint::first_of_its_name(text, span.start),
                false => None,
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
    /// `[link]`: the line, serial or SPI, to the registers of the stage.
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

    /// Sample period in seconds.
    pub fn sample_period_s(&self) -> f64 {
        1.0 / self.sample_hz
    }
}

/// Ways to turn impulses between two samples into taps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Digitise {
    /// Two taps per impulse, exact at the mode's pole.
    #[default]
    Modal,
    /// Two taps per impulse, weighted by distance.
    Linear,
    /// One tap per impulse at the nearest sample.
    Nearest,
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
    /// Device family, one of [`FAMILIES`].
    pub family: String,
    /// Board, one of [`BOARDS`].
    pub board: Option<String>,
}

/// `[[axis]]`.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisSection {
    /// Name, unique in the machine; Verilog names derive from it.
    pub name: String,
    /// Unit of the axis's figures in the file; the values here are in m, rad and s.
    pub unit: AxisUnit,
    /// Encoder counts per m or rad.
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
    /// `[axis.limits]`.
    pub limits: Option<LimitsSection>,
    /// `[axis.scale]`; only with an encoder.
    pub scale: Option<Scale>,
    /// `[axis.error_table]`; only with a controller.
    pub error_table: Option<ErrorTableSection>,
    /// `[axis.trace]`; only with a controller.
    pub trace: Option<TraceSection>,
}

/// Default of the residual that an EI kind tolerates, as a fraction of the unshaped vibration.
pub const DEFAULT_TOLERANCE: f64 = 0.05;
/// Default of the residual bound of `vibrationless`.
const DEFAULT_EPSILON: f64 = 0.05;
/// Default number of zero pairs of `chebyshev-ei`.
pub(crate) const DEFAULT_CHEBYSHEV_ORDER: u32 = 3;
/// Default number of frequencies per mode of `vibrationless`.
const DEFAULT_VIBRATIONLESS_ORDER: u32 = 2;

impl AxisSection {
    /// Whether the axis has more than a shaper.
    pub fn has_loop(&self) -> bool {
        self.encoder.is_some() || self.pwm.is_some() || self.controller.is_some()
    }

    /// Counts per m or rad of the counter that the position loop runs on: the encoder's, or the scale's where that is
    /// the loop's position. Commands, errors and distances of the hardware are in these counts.
    pub fn loop_counts_per_unit(&self) -> f64 {
        match self.scale {
            Some(scale) if scale.usage == ScaleUse::Position => scale.counts_per_unit,
            _ => self.counts_per_unit,
        }
    }

    /// Counts of the loop per unit of the machine file.
    pub fn loop_counts_per_file_unit(&self) -> f64 {
        self.unit.counts_in_file(self.loop_counts_per_unit())
    }

    /// The kind that treats all modes of this axis together, or `None` where each mode has a shaper of its own and the
    /// axis gets their convolution.
    pub fn joint_kind(&self) -> Option<ShaperKind> {
        let kind = self.shaper.as_ref()?.kind;
        kind.treats_modes_together().then_some(kind)
    }

    /// Kind of a mode's shaper: the mode's own; else `zv` under `simultaneous`; else the axis's.
    pub fn kind_of(&self, mode: &AxisMode) -> ShaperKind {
        let axis_kind = self.shaper.as_ref().map_or(ShaperKind::None, |s| s.kind);
        let inherited = if axis_kind == ShaperKind::Simultaneous {
            ShaperKind::Zv
        } else {
            axis_kind
        };
        mode.shaper.unwrap_or(inherited)
    }

    /// Tolerance at a mode, for the EI kinds and for every insensitivity: the mode's, else the axis's, else
    /// [`DEFAULT_TOLERANCE`].
    pub fn tolerance_of(&self, mode: &AxisMode) -> f64 {
        let of_axis = self.shaper.as_ref().and_then(|s| s.tolerance);
        mode.tolerance.or(of_axis).unwrap_or(DEFAULT_TOLERANCE)
    }

    /// Order at a mode: the mode's, else the axis's, else the default of the mode's kind; 1 for a kind without order.
    pub fn order_of(&self, mode: &AxisMode) -> u32 {
        let of_axis = self.shaper.as_ref().and_then(|s| s.order);
        mode.order.or(of_axis).unwrap_or(match self.kind_of(mode) {
            ShaperKind::ChebyshevEi => DEFAULT_CHEBYSHEV_ORDER,
            ShaperKind::Vibrationless => DEFAULT_VIBRATIONLESS_ORDER,
            _ => 1,
        })
    }

    /// Residual bound of `vibrationless`, default 0.05.
    pub fn epsilon(&self) -> f64 {
        self.shaper.as_ref().and_then(|s| s.epsilon).unwrap_or(DEFAULT_EPSILON)
    }

    /// Search limit of `periodic` in Hz: the file's, else a tenth of the lowest mode's frequency.
    pub fn lowest_frequency_hz(&self) -> f64 {
        let given = self.shaper.as_ref().and_then(|s| s.lowest_frequency_hz);
        let modes = self.modes.iter().map(|m| m.mode.frequency_hz);
        given.unwrap_or_else(|| modes.fold(f64::INFINITY, f64::min) / 10.0)
    }

    /// Kind as reports and JSON name it: the axis's where every mode follows it, else those of the modes joined by
    /// `+` in the order of the file.
    pub fn kind_name(&self) -> String {
        match &self.shaper {
            Some(shaper)
                if self.joint_kind().is_some() || self.modes.iter().all(|m| self.kind_of(m) == shaper.kind) =>
            {
                shaper.kind.to_string()
            }
            _ => {
                let kinds: Vec<&str> = self.modes.iter().map(|m| self.kind_of(m).name()).collect();
                kinds.join("+")
            }
        }
    }
}

/// `[axis.shaper]`: the kind, and the parameters that the file gives for it.
#[derive(Debug, Clone, PartialEq)]
pub struct ShaperChoice {
    /// Kind of shaper.
    pub kind: ShaperKind,
    /// Residual vibration that an EI kind tolerates at the mode, in (0, 1); default 0.05.
    pub tolerance: Option<f64>,
    /// Zero pairs of `chebyshev-ei`, or frequencies per mode of `vibrationless`: 1..=5.
    pub order: Option<u32>,
    /// Residual bound of `vibrationless`.
    pub epsilon: Option<f64>,
    /// Base shaper of `periodic`.
    pub base: Option<ShaperKind>,
    /// Search limit of `periodic` in Hz.
    pub lowest_frequency_hz: Option<f64>,
    /// Amplitudes of `simultaneous`: `ps` or `um`.
    pub amplitude: Option<String>,
    /// Method of `antisymmetric`: `exact`, `two-impulse`, `three-impulse`.
    pub method: Option<String>,
    /// Tolerance of the frequency ratios of `antisymmetric`.
    pub ratio_tolerance: Option<f64>,
    /// What the shaped command may do, of `optimal`.
    pub command: Option<Command>,
    /// Most taps, of `optimal`.
    pub taps: Option<u32>,
    /// Which of the shortest shapers `optimal` takes.
    pub prefer: Option<Prefer>,
    /// Impulses of `custom`, as `(time_s, amplitude)`.
    pub impulses: Vec<(f64, f64)>,
}

impl ShaperChoice {
    /// Makes a choice of this kind with every other key left out.
    pub fn of_kind(kind: ShaperKind) -> Self {
        Self {
            kind,
            tolerance: None,
            order: None,
            epsilon: None,
            base: None,
            lowest_frequency_hz: None,
            amplitude: None,
            method: None,
            ratio_tolerance: None,
            command: None,
            taps: None,
            prefer: None,
            impulses: Vec::new(),
        }
    }
}

/// `[[axis.mode]]`.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisMode {
    /// Frequency and damping ratio with the motor held, for which the shaper is designed.
    pub mode: Mode,
    /// The mode as the file gives it, where it was measured with the motor free and converted to `mode`.
    pub free: Option<Mode>,
    /// The mode's own kind, instead of the axis's.
    pub shaper: Option<ShaperKind>,
    /// The mode's own tolerance, instead of the axis's.
    pub tolerance: Option<f64>,
    /// The mode's own order, instead of the axis's.
    pub order: Option<u32>,
    /// By how much the frequency may be off, relative and to either side.
    pub frequency_band: Option<f64>,
    /// Lowest and highest damping ratio that the mode may have.
    pub damping_band: Option<[f64; 2]>,
    /// Share of the mode in the axis's response; only ratios count. Default 1.
    pub participation: f64,
    /// For a mode that moves, its frequency and damping at values of the variable in increasing order; else empty.
    pub points: Vec<ModePoint>,
}

impl AxisMode {
    /// The frequencies and damping ratios that the mode may have: just its own where the file gives no band. The own ones always belong to it.
    pub fn band(&self) -> ModeBand {
        let Mode { frequency_hz, damping } = self.mode;
        let band = self.frequency_band.unwrap_or(0.0);
        let [low, high] = self.damping_band.unwrap_or([damping; 2]);
        ModeBand {
            frequency_hz: [frequency_hz * (1.0 - band), frequency_hz * (1.0 + band)],
            damping: [low.min(damping), high.max(damping)],
        }
    }
}
