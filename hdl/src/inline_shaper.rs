//! Verilog of the inline shaper: blocks between a controller with step outputs and drives with step inputs.
//!
//! `posicast_blocks::inline_shaper` defines the parts and their connections.

use crate::component::{Of, joined};
use crate::emit::{EmitError, Header, Module, Parameter};
use posicast_blocks::inline_shaper::InlineShaper;

/// All Verilog modules of an inline shaper, sub-modules first, the top last. The top is called `name`. The names of modules
/// whose contents depend on the machine begin with `prefix`, to which the modules of an axis add the axis's name.
///
/// # Errors
/// [`EmitError`] where `name` or `prefix` is not a valid Verilog name.
pub fn emit(shaper: &InlineShaper, name: &str, prefix: &str) -> Result<Vec<Module>, EmitError> {
    let config = shaper.config();
    let mut parameters = vec![Parameter::new(
        "tick_clocks",
        config.tick.tick_clocks(),
        "from tick to tick",
    )];
    for axis in &config.axes {
        parameters.push(Parameter::new(
            format!("{} filter_clocks", axis.name),
            axis.filter_clocks,
            "longest pulse of the command that is ignored",
        ));
        parameters.push(Parameter::new(
            format!("{} unshaped_clocks", axis.name),
            config.unshaped_clocks(axis),
            "from an edge of the command to its step, at an even speed and without shaping",
        ));
        parameters.push(Parameter::new(
            format!("{} longest_delay", axis.name),
            axis.shaper.table().longest_delay_samples(),
            "ticks that the shaper takes longer to come to rest",
        ));
    }
    let header = Header {
        about: "Inline shaper: from the step pulses of a controller to the shaped step pulses of the drives.\n\
                See docs/inline.md."
            .to_owned(),
        ports: Vec::new(),
        parameters,
    };
    joined(shaper.whole(), name, prefix, &header, Of::InlineShaper)
}
