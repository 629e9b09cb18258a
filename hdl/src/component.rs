//! Blocks behind registers on an Avalon-MM agent: those that stand alone, and the stage.
//!
//! What is in a component and how it is joined says `posicast_model::rtl::component`; here are the modules and the top
//! around them.

use crate::emit::{EmitError, Header, Module, add, connect};
use crate::{
    axis, divider, divider_share, drive_command, encoder_generator, excitation, group, linear_scale, pulse_counter,
    pwm, registers, sample_select, schedule, segments, setting_banks, shaper, sliding_mode, time_base, trace,
};
use posicast_model::rtl::component::{Block, Component, Joined};

/// All Verilog modules of a component, sub-modules first, the top last. The top is called `name`; modules that hold something of
/// a machine begin with `prefix`: of a component the machine's and axis's names, of a stage the machine's, behind which it
/// puts those of its axes.
///
/// # Errors
/// [`EmitError`] where `name` or `prefix` makes no Verilog name.
pub fn emit(component: &Component, name: &str, prefix: &str) -> Result<Vec<Module>, EmitError> {
    let map = component.map();
    let header = Header {
        about: format!("{}\nAvalon-MM agent avs_*: see docs/registers.md.", map.about()),
        parameters: registers::parameters(map),
    };
    joined(component.whole(), name, prefix, &header)
}

/// The modules of blocks joined to the module `top`, each once.
fn joined(whole: &Joined, top: &str, prefix: &str, header: &Header) -> Result<Vec<Module>, EmitError> {
    let mut modules: Vec<Module> = Vec::new();
    let mut tops = Vec::new();
    for block in whole.blocks() {
        let of_block = self::block(block, top, prefix)?;
        tops.extend(of_block.last().cloned());
        add(&mut modules, of_block)?;
    }
    modules.push(connect(
        top,
        header,
        whole.composition(),
        &tops.iter().collect::<Vec<_>>(),
    )?);
    Ok(modules)
}

/// The modules of one block, its top last.
fn block(block: &Block, top: &str, prefix: &str) -> Result<Vec<Module>, EmitError> {
    match block {
        Block::Registers(map) => Ok(vec![registers::emit(map, prefix)?]),
        Block::Shaper(config) => shaper::emit(config, prefix),
        Block::SampleSelect { word_bits, channels } => sample_select::emit(*word_bits, *channels, prefix),
        Block::Pwm(config) => pwm::emit(config, prefix),
        Block::SlidingMode => sliding_mode::emit(prefix),
        Block::SettingBanks(machine) => setting_banks::emit(machine, prefix),
        Block::PulseCounter => pulse_counter::emit(prefix),
        Block::Divider(config) => divider::emit(config, prefix),
        Block::TimeBase(config) => time_base::emit(config, prefix),
        Block::Segments => segments::emit(prefix),
        Block::Axis => axis::emit(prefix),
        Block::DriveCommand => drive_command::emit(prefix),
        Block::LinearScale => linear_scale::emit(prefix),
        Block::EncoderGenerator => encoder_generator::emit(prefix),
        Block::Excitation => excitation::emit(prefix),
        Block::Trace(config) => trace::emit(config, prefix),
        Block::DividerShare(channels) => divider_share::emit(*channels, prefix),
        Block::Schedule(config) => schedule::emit(config, prefix),
        Block::Group(axes) => group::emit(*axes, prefix),
        Block::Joined(whole) => {
            let header = Header {
                about: format!("Axis {} of the stage, without its registers.", whole.name()),
                parameters: Vec::new(),
            };
            let of_axis = |owner: &str| format!("{owner}_{}", whole.name());
            joined(whole, &of_axis(top), &of_axis(prefix), &header)
        }
    }
}
