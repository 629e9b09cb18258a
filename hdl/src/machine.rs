//! A machine's top module: one shaper per axis, side by side.
//!
//! The top is named after the machine and has `clk`, `rst` and `strobe` (the sample tick) for all axes; every other
//! port is `<axis>_<port>`. Sizes are types in RustHDL, so a machine of arbitrary sizes cannot be one RustHDL block.
//! The top is composed from the port lists of the emitted modules instead ([`compose`]).

use crate::SimulationError;
use crate::emit::{EmitError, Header, Module, ModuleInstance, Parameter, add, compose};
use crate::{cascade, shaper};
use posicast_blocks::ClockedBlock;
use posicast_blocks::axis_shaper::AxisShaperConfig;

/// Inputs of the top that all axes share, in addition to `clk`.
pub const SHARED_INPUTS: [&str; 2] = ["rst", "strobe"];

/// The shaper of one axis.
#[derive(Debug, Clone)]
pub struct AxisShaper {
    /// Name of the axis.
    pub axis: String,
    /// Build parameters of its shaper.
    pub config: AxisShaperConfig,
}

impl AxisShaper {
    /// Name of the top's port for the shaped position.
    pub fn output(&self) -> String {
        format!("{}_{}", self.axis, self.config.position("y"))
    }

    fn emit(&self, prefix: &str) -> Result<Vec<Module>, EmitError> {
        match &self.config {
            AxisShaperConfig::Taps(config) => shaper::emit(config, prefix),
            AxisShaperConfig::Cascade(config) => cascade::emit(config, prefix),
        }
    }

    /// The shaper in RustHDL's simulator.
    ///
    /// # Errors
    /// [`SimulationError`] for a size that is not compiled, or a fault of the description.
    pub fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        match &self.config {
            AxisShaperConfig::Taps(config) => shaper::simulate(config),
            AxisShaperConfig::Cascade(config) => cascade::simulate(config),
        }
    }

    /// The compiled size that stands for this one in RustHDL's simulator; `None` where it has the size itself.
    pub fn simulated_as(&self) -> Option<String> {
        match &self.config {
            AxisShaperConfig::Taps(config) => shaper::simulated_as(config),
            AxisShaperConfig::Cascade(config) => cascade::simulated_as(config),
        }
    }

    /// The axis in the header of the top.
    fn parameter(&self) -> Parameter {
        let longest = self.config.longest_delay_samples();
        let (name, value) = match &self.config {
            AxisShaperConfig::Taps(config) => ("taps", config.table().taps().len() as u32),
            AxisShaperConfig::Cascade(config) => ("half sums", config.stages()),
        };
        Parameter {
            name: format!("{} {name}", self.axis),
            value: value.to_string(),
            meaning: format!("longest delay {longest} samples"),
        }
    }
}

/// All Verilog modules of a machine, sub-modules first, the top last.
///
/// # Errors
/// [`EmitError`] for a construct that cannot be expressed exactly, and where names of machine and axes collide.
pub fn emit_machine(name: &str, shapers: &[AxisShaper]) -> Result<Vec<Module>, EmitError> {
    let mut modules = Vec::new();
    let mut tops = Vec::new();
    for shaper in shapers {
        let of_axis = shaper.emit(&format!("{name}_{}", shaper.axis))?;
        tops.extend(of_axis.last().cloned());
        add(&mut modules, of_axis)?;
    }
    let instances: Vec<_> = shapers
        .iter()
        .zip(&tops)
        .map(|(shaper, module)| ModuleInstance {
            name: &shaper.axis,
            module,
        })
        .collect();
    let parameters = shapers.iter().map(AxisShaper::parameter);
    let header = Header {
        about: format!("Input shapers of {name}. `strobe` is high for one clock per sample."),
        ports: Vec::new(),
        parameters: parameters.collect(),
    };
    modules.push(compose(name, &header, &SHARED_INPUTS, &instances)?);
    Ok(modules)
}
