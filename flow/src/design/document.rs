//! `design --json`: the document of the command line's contract.

use super::certificate::Certificate;
use super::delay::{DelayParts, EqualDelays};
use super::error_table::DesignErrorTable;
use super::family::DesignFamily;
use super::front::Front;
use super::given_move::ComparedMove;
use crate::control::Control;
use crate::text::UnitDocument;
use posicast_machine::mechanics::ScrewDrive;
use posicast_shaper::design::{periodic, ratios};
use posicast_taps::TapTable;
use schemars::JsonSchema;
use serde::Serialize;

/// `design --json`: the command line's contract.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "Design")]
pub struct Document {
    /// Name of the machine.
    pub name: String,
    /// The clock and the words of the machine; for people, because each axis has what matters of it.
    #[serde(skip)]
    pub clocking: Clocking,
    /// The axes of the machine, in the order of the file.
    pub axes: Vec<DesignAxis>,
    /// What longer durations buy, if that was asked for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub fronts: Vec<Front>,
    /// The moves that were asked for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub moves: Vec<ComparedMove>,
    /// The delays of the axes, if the machine file has `[stage]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stage: Option<EqualDelays>,
    /// Delays and rates of the axes, if their commands come as step pulses.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub inline: Vec<InlineAxisDocument>,
}

/// Delays and rates of an axis of an inline shaper.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct InlineAxisDocument {
    /// Name of the axis.
    pub axis: String,
    /// Largest rate of the command that does not stop the axis, in steps per second.
    pub input_hz: f64,
    /// Largest rate of the drive's lines, in steps per second.
    pub output_hz: f64,
    /// Largest speed of the output over that of the command: 1 with positive taps.
    pub overshoot: f64,
    /// Delay of an even speed with shaping.
    pub shaped_s: f64,
    /// Delay of an even speed without shaping.
    pub unshaped_s: f64,
    /// Longest time from the last step of the command until every step has come out.
    pub settle_s: f64,
}

/// The clock and the words of a machine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clocking {
    /// Frequency of the hardware's clock.
    pub clock_hz: f64,
    /// Rate of the samples.
    pub sample_hz: f64,
    /// Fraction bits of the coefficients.
    pub coefficient_fraction: u32,
}

/// The shaper of an axis.
#[derive(Serialize, JsonSchema)]
pub struct DesignAxis {
    /// Name of the axis.
    pub name: String,
    /// Its unit.
    #[serde(flatten)]
    pub unit: UnitDocument,
    /// Kind of its shaper; kinds that are convolved are joined by `+`.
    pub kind: String,
    /// Of `periodic`: the intervals of frequencies that it may take.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub solutions: Option<Vec<PeriodicSolution>>,
    /// Of `periodic`: the frequency of the whole system.
    #[serde(skip)]
    pub system_hz: Option<f64>,
    /// Of `antisymmetric`: the modes by antiperiod.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub classes: Option<Vec<ModeClass>>,
    /// Of the kinds that treat all modes together: whether no command within the same bounds is shorter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_optimal: Option<bool>,
    /// The impulses, before they are rounded.
    pub impulses: Vec<DesignImpulse>,
    /// From the first to the last impulse.
    pub duration_s: f64,
    /// Mean delay of a command.
    pub delay_s: f64,
    /// The least of the shaped unit step.
    pub partial_sum_min: f64,
    /// The most of the shaped unit step.
    pub partial_sum_max: f64,
    /// Largest magnitude of the shaped unit step.
    pub peak_command: f64,
    /// Residual of the shaper for each mode at the other modes.
    pub cross_gains: Vec<ShaperCrossGain>,
    /// Bounds that convolving the modes' shapers breaks.
    pub warnings: Vec<String>,
    /// The same, each with its place in the machine file.
    #[serde(skip)]
    pub placed_warnings: Vec<String>,
    /// The modes, in the order of the file.
    pub modes: Vec<DesignMode>,
    /// The shaper in integers.
    pub quantised: Quantised,
    /// The certified residual, if it was asked for or the kind is `optimal`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub certificate: Option<Certificate>,
    /// The table family, if the modes move.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub family: Option<DesignFamily>,
    /// The error table of the hardware.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error_table: Option<DesignErrorTable>,
    /// The parts of the delay, if the machine file has `[stage]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delay: Option<DelayParts>,
    /// The controller.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub control: Option<Control>,
}

/// An interval of frequencies that `periodic` may take.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "Solution")]
pub struct PeriodicSolution {
    /// Its lower end.
    pub low_hz: f64,
    /// Its upper end.
    pub high_hz: f64,
    /// For each mode the n of the odd multiple 2n + 1.
    pub n: Vec<u32>,
}

impl PeriodicSolution {
    pub(super) fn new(solution: &periodic::Solution) -> Self {
        Self {
            low_hz: solution.low_hz,
            high_hz: solution.high_hz,
            n: solution.n.clone(),
        }
    }
}

/// Modes of `antisymmetric` that share an antiperiod; modes are counted from 1.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "Class")]
pub struct ModeClass {
    /// The modes.
    pub modes: Vec<usize>,
    /// The frequency of which they are multiples.
    pub divisor_hz: f64,
    /// The odd multiple of each mode.
    pub multiples: Vec<u64>,
    /// Largest relative distance of a mode from its multiple.
    pub ratio_error: f64,
}

impl ModeClass {
    pub(super) fn new(class: &ratios::Class) -> Self {
        Self {
            modes: class.members.iter().map(|index| index + 1).collect(),
            divisor_hz: class.multiples.divisor,
            multiples: class.multiples.multiples.clone(),
            ratio_error: class.multiples.error,
        }
    }
}

/// An impulse of a shaper.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "Impulse")]
pub struct DesignImpulse {
    /// Time after the first impulse.
    pub time_s: f64,
    /// Part of the command; the sum of all is 1.
    pub amplitude: f64,
}

/// Residual of the shaper for one mode at another mode.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "CrossGain")]
pub struct ShaperCrossGain {
    /// Kind of the shaper.
    pub kind: &'static str,
    /// Frequency of the mode that the shaper is for.
    pub shaper_hz: f64,
    /// Frequency of the other mode.
    pub at_hz: f64,
    /// The residual there.
    pub gain: f64,
}

/// A mode of an axis, and what the shaper leaves of it.
#[derive(Serialize, JsonSchema)]
pub struct DesignMode {
    /// Natural frequency.
    pub frequency_hz: f64,
    /// Damping ratio.
    pub damping: f64,
    /// The mode as it was measured with the motor free.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub free: Option<FreeMode>,
    /// What `[axis.mechanics]` makes it from.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mechanics: Option<Mechanics>,
    /// Residual vibration of a step, before the impulses are rounded.
    pub residual: f64,
    /// Largest residual that the machine file allows.
    #[serde(skip)]
    pub tolerance: f64,
    /// Range of the true frequency, relative to the mode's, in which the residual is allowed; null above the searched range.
    pub insensitivity: Option<(f64, Option<f64>)>,
}

/// A mode from data sheets.
#[derive(Serialize, JsonSchema)]
pub struct Mechanics {
    /// Whether the motor is `held` or `free` in this mode.
    pub motor: &'static str,
    /// Stiffness between motor and table.
    pub stiffness_n_per_m: f64,
    /// Mass of the table.
    pub table_mass_kg: f64,
    /// Inertia of motor and screw.
    pub turning_inertia_kg_m2: f64,
    /// The mass at the table to which it is equivalent.
    pub motor_mass_kg: f64,
    /// The mode with the motor the other way.
    #[serde(skip)]
    pub other_way: FreeMode,
}

impl Mechanics {
    pub(super) fn new(screw: &ScrewDrive, is_motor_free: bool) -> Self {
        let other_way = if is_motor_free {
            screw.held_mode()
        } else {
            screw.free_mode()
        };
        Self {
            motor: if is_motor_free { "free" } else { "held" },
            stiffness_n_per_m: screw.stiffness(),
            table_mass_kg: screw.table_mass,
            turning_inertia_kg_m2: screw.turning_inertia(),
            motor_mass_kg: screw.motor_mass(),
            other_way: FreeMode {
                frequency_hz: other_way.frequency_hz,
                damping: other_way.damping,
            },
        }
    }
}

/// A mode that is not the one that the shaper is for.
#[derive(Serialize, JsonSchema)]
pub struct FreeMode {
    /// Natural frequency.
    pub frequency_hz: f64,
    /// Damping ratio.
    pub damping: f64,
}

/// A shaper in integers.
#[derive(Serialize, JsonSchema)]
pub struct Quantised {
    /// Rate of the samples.
    pub sample_hz: f64,
    /// Fraction bits of the coefficients.
    pub coefficient_fraction: u32,
    /// How the impulses were moved to samples.
    pub digitise: String,
    /// Whether it can be built and can run at the sample rate.
    pub fits: bool,
    /// Why it cannot.
    #[serde(skip)]
    pub misfit: Option<String>,
    /// Delays in samples of the half sums that compute the shaper, if it is a cascade.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub half_sums_samples: Vec<u32>,
    /// The taps; of a cascade those of a table with the same results.
    pub taps: Vec<TableTap>,
    /// What the integer taps leave of each mode, in the order of the file.
    pub modes: Vec<Residual>,
}

/// A tap of a table.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "Tap")]
pub struct TableTap {
    /// Delay in samples.
    pub delay_samples: u32,
    /// Weight, times 2 to the power of the fraction bits.
    pub coefficient: i32,
}

impl TableTap {
    /// The taps of a table.
    pub(super) fn of(table: &TapTable) -> Vec<Self> {
        let taps = table.taps().iter();
        taps.map(|tap| Self {
            delay_samples: tap.delay_samples,
            coefficient: tap.coefficient,
        })
        .collect()
    }
}

/// What the integer taps leave of a mode.
#[derive(Serialize, JsonSchema)]
pub struct Residual {
    /// Residual vibration of a step.
    pub residual: f64,
    /// Upper bound over the whole band of the mode.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub certified_residual: Option<f64>,
}
