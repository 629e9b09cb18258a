//! A machine's top module: one shaper per axis, side by side.
//!
//! The top is named after the machine and has `clk`, `rst` and `strobe` (the sample tick) for all axes; every other
//! port is `<axis>_<port>`. Sizes are types in RustHDL, so a machine of arbitrary sizes cannot be one RustHDL block.
//! The top is composed from the port lists of the emitted modules instead ([`compose`]).

use crate::emit::{EmitError, Header, Module, ModuleInstance, Parameter, add, compose};
use crate::shaper;
use posicast_blocks::shaper::ShaperConfig;

/// Inputs of the top that all axes share, in addition to `clk`.
pub const SHARED_INPUTS: [&str; 2] = ["rst", "strobe"];

/// The shaper of one axis.
#[derive(Debug, Clone)]
pub struct AxisShaper {
    /// Name of the axis.
    pub axis: String,
    /// Build parameters of its shaper.
    pub config: ShaperConfig,
}

impl AxisShaper {
    /// Name of the top's port for the shaped position.
    pub fn output(&self) -> String {
        let port = if self.config.motion().is_some() { "y_0" } else { "y" };
        format!("{}_{port}", self.axis)
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
        let of_axis = shaper::emit(&shaper.config, &format!("{name}_{}", shaper.axis))?;
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
    let parameters = shapers.iter().map(|shaper| Parameter {
        name: format!("{} taps", shaper.axis),
        value: shaper.config.table().taps().len().to_string(),
        meaning: format!(
            "longest delay {} samples",
            shaper.config.table().longest_delay_samples()
        ),
    });
    let header = Header {
        about: format!("Input shapers of {name}. `strobe` is high for one clock per sample."),
        ports: Vec::new(),
        parameters: parameters.collect(),
    };
    modules.push(compose(name, &header, &SHARED_INPUTS, &instances)?);
    Ok(modules)
}
