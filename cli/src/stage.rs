//! The stage of a machine: all axes whose loops are complete, behind one Avalon-MM agent.

use crate::blocks::has_loop;
use crate::failure::Failure;
use crate::machine::{SAMPLE_KEY, at_key};
use crate::output;
use posicast_hdl::emit::Module;
use posicast_model::control::{self, MachineStage, MachineStageError};
use posicast_model::design::MachineDesign;
use posicast_model::rtl::component::Component;
use posicast_model::rtl::stage::{StageConfig, StageError};
use posicast_model::spec::Machine;
use posicast_testbench::blocks::{Block, ComponentBlock};
use std::path::Path;

/// What the name of a stage's top module ends with.
pub(crate) const STAGE_SUFFIX: &str = "_stage";
/// The key of an axis's name.
const NAME_KEY: &str = "axis.name";
/// The key of a PWM's period.
const PERIOD_KEY: &str = "axis.pwm.frequency_hz";

/// A stage: from the machine file, and as hardware.
pub(crate) struct Stage {
    /// Its settings, and what was derived for them.
    pub(crate) of_machine: MachineStage,
    /// Its top module is `<machine>_stage`.
    pub(crate) block: ComponentBlock,
}

/// The stage of the machine that the file at `path` describes; none where a loop is not complete, or where the shapers do not
/// suit one, which is said as a warning.
pub(crate) fn of_machine(machine: &Machine, design: &MachineDesign, path: &Path) -> Result<Option<Stage>, Failure> {
    // A machine of shapers alone has words and delays that a stage does not; it wants none.
    if !machine.axes.iter().all(has_loop) {
        return Ok(None);
    }
    let of_machine = match control::stage(machine, design) {
        Ok(Some(stage)) => stage,
        Ok(None) => return Ok(None),
        Err(error @ MachineStageError::Shaper { .. }) => return Ok(without(&error)),
        Err(error) => {
            let (axis, key) = error.key();
            return Err(at_key(path, axis, &key, &error));
        }
    };
    let component = match Component::stage(&of_machine.config) {
        Ok(component) => component,
        Err(error @ (StageError::Axes(_) | StageError::Channels { .. })) => return Ok(without(&error)),
        Err(error) => {
            let (axis, key) = to_blame(&of_machine.config, &error);
            return Err(at_key(path, axis, key, &error));
        }
    };
    let axes: Vec<&str> = machine.axes.iter().map(|axis| axis.name.as_str()).collect();
    let top = format!("{}{STAGE_SUFFIX}", machine.name);
    let block = ComponentBlock::new(component, &top, &axes.join(", ")).with_prefix(&machine.name);
    Ok(Some(Stage { of_machine, block }))
}

impl Stage {
    /// Its Verilog modules. Names of axes that make two modules of one name are an error of the machine file at `path`.
    pub(crate) fn modules(&self, path: &Path) -> Result<Vec<Module>, Failure> {
        self.block.modules().map_err(|error| {
            let modules = |config: &StageConfig| {
                let component = Component::stage(config).ok()?;
                self.block.like(component).modules().ok()
            };
            let axis = clashing(&self.of_machine.config, |config| modules(config).is_some());
            at_key(path, axis, NAME_KEY, format_args!("{error}; rename the axis"))
        })
    }
}

fn without(reason: &dyn std::error::Error) -> Option<Stage> {
    output::say(&format!(
        "warning: no stage is built, its blocks are components of their own: {reason}"
    ));
    None
}

/// Axis and key of the machine file that an error of a stage comes from.
fn to_blame(config: &StageConfig, error: &StageError) -> (usize, &'static str) {
    let of_axis = |name: &String| config.axes.iter().position(|axis| axis.name == *name).unwrap_or(0);
    match error {
        StageError::Period { axis, .. } => (of_axis(axis), PERIOD_KEY),
        StageError::Map(_) | StageError::Composition(_) | StageError::Component(_) => {
            let axis = clashing(config, |config| Component::stage(config).is_ok());
            (axis, NAME_KEY)
        }
        _ => (0, SAMPLE_KEY),
    }
}

/// The axis whose name clashes: the first without which, under another name, there is no clash.
fn clashing(config: &StageConfig, builds: impl Fn(&StageConfig) -> bool) -> usize {
    let renamed = |axis: &usize| {
        let mut config = config.clone();
        config.axes[*axis].name = "posicast".to_owned();
        builds(&config)
    };
    (0..config.axes.len()).find(renamed).unwrap_or(0)
}
