//! The hardware that is built for a machine, decided once from its file and its design.
//!
//! ```text
//! machine, design ─► shaper of each axis in the top module
//!                 ─► stage, where every loop is complete: schedule, lags, gains
//!                 ─► gains of an axis: those of the stage, or of its own components where there is no stage
//!                 ─► components, each a block behind registers of its own
//! ```
//!
//! Some parts can be impossible while others are not: a design can be studied even if a tick is too short for it. So
//! each part that cannot be built has its reason, a [`HardwareError`] with the key of the machine file to blame.

mod axis;
mod cascade;
mod error;
mod error_table;
mod inline;
mod stage;

pub use axis::{AxisComponent, AxisHardware, AxisLoop};
pub use cascade::{CascadeHardware, cascade};
pub use error::HardwareError;
pub use error_table::departure_counts as error_table_departure_counts;
pub use inline::{InlineFigures, InlineHardware};
pub use stage::{MachineStage, MachineStageError, TimedLoop, pwm_config, pwm_mode, stage};

use crate::machine_file::{AxisSection, Machine};
use crate::plan::MachineDesign;
use posicast_blocks::axis_shaper::AxisShaperConfig;
use posicast_blocks::component::Component;
use posicast_blocks::divider::DividerConfig;
use posicast_blocks::group::MOST_AXES;
use posicast_blocks::shaper::WORD_BITS;
use posicast_blocks::stage::StageError;

/// Key of the sample rate.
const SAMPLE_KEY: &str = "clock.sample_hz";
/// Key of the width of the command's words.
const WORD_KEY: &str = "fixed_point.command_bits";
/// Key of an axis's shaper.
const SHAPER_KEY: &str = "axis.shaper";
/// Key of an axis's name.
pub const NAME_KEY: &str = "axis.name";
/// Key of a PWM's frequency.
const PERIOD_KEY: &str = "axis.pwm.frequency_hz";

/// The hardware of a machine.
#[derive(Debug, Clone)]
pub struct Hardware<'a> {
    machine: &'a Machine,
    axes: Vec<AxisHardware>,
    stage: Result<Option<StageHardware>, HardwareError>,
    without_stage: Option<HardwareError>,
    inline: Result<Option<InlineHardware>, HardwareError>,
}

/// The stage of a machine, with its component.
#[derive(Debug, Clone)]
pub struct StageHardware {
    /// Settings of the stage, with the figures derived for its axes.
    pub of_machine: MachineStage,
    /// The stage behind its registers.
    pub component: Component,
}

impl<'a> Hardware<'a> {
    /// Decides what is built for a machine with this design.
    ///
    /// # Errors
    /// [`HardwareError`] for a controller or a supervisor that cannot be built.
    pub fn of(machine: &'a Machine, design: &MachineDesign) -> Result<Self, HardwareError> {
        let mut without_stage = None;
        let stage = complete_stage(machine, design, &mut without_stage);
        let of_stage = stage
            .as_ref()
            .ok()
            .and_then(Option::as_ref)
            .map(|stage| &stage.of_machine);
        let axes = machine.axes.iter().zip(&design.axes).enumerate();
        let axes = axes.map(|(index, (axis, tables))| {
            let timed = of_stage.and_then(|stage| stage.loops[index].clone());
            AxisHardware::of(machine, index, axis, (tables, design.family_of(index)), timed)
        });
        Ok(Self {
            machine,
            axes: axes.collect::<Result<_, _>>()?,
            stage,
            without_stage,
            inline: inline::inline(machine, design),
        })
    }

    /// The hardware of each axis, in the order of the machine file.
    pub fn axes(&self) -> &[AxisHardware] {
        &self.axes
    }

    /// The stage. `None` where a loop of the machine is incomplete, or its shapers do not suit a stage.
    ///
    /// # Errors
    /// [`HardwareError`] where the machine file asks for a stage that cannot be built.
    pub fn stage(&self) -> Result<Option<&StageHardware>, HardwareError> {
        self.stage.as_ref().map(Option::as_ref).map_err(Clone::clone)
    }

    /// The inline shaper. `None` where the commands do not come as step pulses.
    ///
    /// # Errors
    /// [`HardwareError`] where the machine file asks for an inline shaper that cannot be built.
    pub fn inline(&self) -> Result<Option<&InlineHardware>, HardwareError> {
        self.inline.as_ref().map(Option::as_ref).map_err(Clone::clone)
    }

    /// Why a machine whose loops are all complete has no stage: its shapers do not suit one. Else `None`.
    pub fn without_stage(&self) -> Option<&HardwareError> {
        self.without_stage.as_ref()
    }

    /// The shaper of each axis in the machine's top module.
    ///
    /// # Errors
    /// [`HardwareError`] of the first axis whose shaper cannot be built, or cannot run at the sample rate.
    pub fn shapers(&self) -> Result<Vec<AxisShaperConfig>, HardwareError> {
        self.axes.iter().map(|axis| axis.shaper.clone()).collect()
    }

    /// The divider for the machine's tick.
    ///
    /// # Errors
    /// [`HardwareError`] for a tick whose length the divider does not support.
    pub fn divider(&self) -> Result<DividerConfig, HardwareError> {
        let clocks = u64::from(self.machine.clock.clocks_per_sample());
        DividerConfig::new(clocks).map_err(|error| HardwareError::new(0, SAMPLE_KEY, error))
    }

    /// The blocks of the machine's axes as components, each behind its own registers, axis by axis. A machine that
    /// has only shapers has none.
    ///
    /// # Errors
    /// [`HardwareError`] for a block that the machine file asks for and that cannot be built.
    pub fn components(&self) -> Result<Vec<AxisComponent>, HardwareError> {
        let mut components = Vec::new();
        if !self.machine.axes.iter().any(AxisSection::has_loop) {
            return Ok(components);
        }
        for (index, (axis, built)) in self.machine.axes.iter().zip(&self.axes).enumerate() {
            let made = built.components(axis, self.machine, || self.divider());
            let made = made.map_err(|error| HardwareError { axis: index, ..error })?;
            components.extend(
                made.into_iter()
                    .map(|component| AxisComponent { axis: index, component }),
            );
        }
        Ok(components)
    }
}

/// Whether only a stage operates the axis: it gives steps, and reads absolute encoders.
fn needs_stage(axis: &AxisSection) -> bool {
    axis.steps.is_some() || axis.absolute_encoder().is_some()
}

/// The axis to blame if a machine has an axis that only a stage operates, and another one with neither steps nor a whole loop: `None` if
/// there is no such axis, or all can be in one stage.
fn without_loop(machine: &Machine) -> Option<HardwareError> {
    let needing = machine.axes.iter().find(|axis| needs_stage(axis))?;
    let lacks = |axis: &AxisSection| {
        let looped = axis.encoder.is_some() && axis.pwm.is_some() && axis.drive.is_some() && axis.controller.is_some();
        axis.steps.is_none() && !looped
    };
    let index = machine.axes.iter().position(lacks)?;
    let reason = format!(
        "axis `{}` has neither [axis.steps] nor a whole loop, so there is no stage that {} axis `{}`",
        machine.axes[index].name,
        if needing.steps.is_some() {
            "gives the steps of"
        } else {
            "reads the encoder of"
        },
        needing.name
    );
    let help = "add [axis.steps], or [axis.encoder], [axis.pwm], [axis.drive] and [axis.controller]; or describe the axis in a file of \
                its own";
    Some(HardwareError::new(index, "axis", reason).with_help(help.to_owned()))
}

/// Makes the stage with its component. If the machine's shapers do not suit a stage, it returns `None` and sets `reason`; with an
/// axis that only a stage operates, that is an error.
fn complete_stage(
    machine: &Machine,
    design: &MachineDesign,
    reason: &mut Option<HardwareError>,
) -> Result<Option<StageHardware>, HardwareError> {
    let needs_stage = machine.axes.iter().any(needs_stage);
    if let Some(error) = without_loop(machine) {
        return Err(error);
    }
    // A machine with only shapers may have words and delays that a stage does not allow; it needs no stage.
    if !machine.axes.iter().all(AxisSection::has_loop) {
        return Ok(None);
    }
    let of_machine = match stage(machine, design) {
        Ok(Some(stage)) => stage,
        Ok(None) => return Ok(None),
        Err(error @ MachineStageError::Shaper { .. }) => {
            let (axis, key) = error.key();
            let refused = HardwareError::new(axis, &key, error);
            if needs_stage {
                return Err(refused);
            }
            *reason = Some(refused);
            return Ok(None);
        }
        Err(error) => {
            let (axis, key) = error.key();
            let refused = HardwareError::new(axis, &key, &error);
            return Err(match error.remedy() {
                Some(remedy) => refused.with_help(remedy),
                None => refused,
            });
        }
    };
    match Component::stage(&of_machine.config) {
        Ok(component) => Ok(Some(StageHardware { of_machine, component })),
        Err(error @ (StageError::Axes(_) | StageError::Channels { .. })) => {
            let (axis, key) = to_blame(&of_machine, &error);
            let refused = HardwareError::new(axis, key, error);
            if needs_stage {
                return Err(refused);
            }
            *reason = Some(refused);
            Ok(None)
        }
        Err(error) => {
            let (axis, key) = to_blame(&of_machine, &error);
            Err(HardwareError::new(axis, key, error))
        }
    }
}

/// Axis and key of the machine file that are to blame for an error of a stage.
fn to_blame(stage: &MachineStage, error: &StageError) -> (usize, &'static str) {
    let of = |name: &str| stage.config.axes.iter().position(|axis| axis.name == name).unwrap_or(0);
    match error {
        StageError::Period { axis, .. } => (of(axis), PERIOD_KEY),
        StageError::Channels { axis, word_bits, .. } if *word_bits < *WORD_BITS.end() => (of(axis), WORD_KEY),
        StageError::Channels { axis, .. } => (of(axis), SHAPER_KEY),
        StageError::Axes(_) => (MOST_AXES, "axis"),
        StageError::Map(_) | StageError::Composition(_) | StageError::Component(_) => {
            let axis = stage.clashing_axis(|config| Component::stage(config).is_ok());
            (axis, NAME_KEY)
        }
        _ => (0, SAMPLE_KEY),
    }
}
