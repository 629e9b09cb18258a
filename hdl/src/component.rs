//! The blocks that stand alone, each with its registers on an Avalon-MM agent.
//!
//! What is in a component and how it is joined says `posicast_model::rtl::component`; here are the modules and the top
//! around them.

use crate::emit::{EmitError, Header, Module, connect};
use crate::{divider, pulse_counter, pwm, registers, sample_select, setting_banks, shaper, sliding_mode, time_base};
use posicast_model::rtl::component::{Block, Component};

/// All Verilog modules of a component, sub-modules first, the top last. The top is called `name`, the others begin with it.
///
/// # Errors
/// [`EmitError`] where `name` makes no Verilog name.
pub fn emit(component: &Component, name: &str) -> Result<Vec<Module>, EmitError> {
    let mut modules: Vec<Module> = Vec::new();
    let mut tops = Vec::new();
    for block in component.blocks() {
        let of_block = match block {
            Block::Registers => vec![registers::emit(component.map(), name)?],
            Block::Shaper(config) => shaper::emit(config, name)?,
            Block::SampleSelect { word_bits, channels } => sample_select::emit(*word_bits, *channels, name)?,
            Block::Pwm(config) => pwm::emit(config, name)?,
            Block::SlidingMode => sliding_mode::emit(name)?,
            Block::SettingBanks(machine) => setting_banks::emit(machine, name)?,
            Block::PulseCounter => pulse_counter::emit(name)?,
            Block::Divider(config) => divider::emit(config, name)?,
            Block::TimeBase(config) => time_base::emit(config, name)?,
        };
        tops.extend(of_block.last().cloned());
        modules.extend(of_block);
    }
    let top = connect(
        name,
        &header(component),
        component.composition(),
        &tops.iter().collect::<Vec<_>>(),
    )?;
    modules.push(top);
    Ok(modules)
}

fn header(component: &Component) -> Header {
    let map = component.map();
    Header {
        about: format!("{}\nAvalon-MM agent avs_*: see docs/registers.md.", map.about()),
        parameters: registers::parameters(map),
    }
}
