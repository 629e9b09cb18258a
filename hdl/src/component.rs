//! Verilog of components: blocks behind registers on an Avalon-MM agent, and the stage.
//!
//! `posicast_blocks::component` defines the parts of a component and their connections; this file adds the
//! modules and the top around them.

use crate::emit::{EmitError, Header, Module, add, connect};
use crate::{
    absolute_encoder, absolute_feedback, axis, capture, compare, divider, divider_share, drive_command,
    encoder_generator, error_table, excitation, group, inline_axis, inline_group, lasting_deviation, linear_scale,
    probe_line, pulse_counter, pwm, realign, registers, sample_select, schedule, segments, setting_banks, shaper,
    sliding_mode, step_generator, time_base, trace,
};
use posicast_blocks::component::{Component, ComponentPart, JoinedBlocks};
use posicast_blocks::inline_shaper::INLINE_SHAPER;

/// All Verilog modules of a component, sub-modules first, the top last. The top is called `name`. The names of modules
/// whose contents depend on the machine begin with `prefix`: for a component the names of machine and axis; for a
/// stage the name of the machine, to which the modules of an axis add the axis's name.
///
/// # Errors
/// [`EmitError`] where `name` or `prefix` is not a valid Verilog name.
pub fn emit(component: &Component, name: &str, prefix: &str) -> Result<Vec<Module>, EmitError> {
    let map = component.map();
    let header = Header {
        about: format!("{}\nAvalon-MM agent avs_*: see docs/registers.md.", map.about()),
        ports: Vec::new(),
        parameters: registers::parameters(map),
    };
    let of = match component.name() {
        INLINE_SHAPER => Of::InlineShaper,
        _ => Of::Stage,
    };
    joined(component.whole(), name, prefix, &header, of)
}

/// What the axes are a part of.
#[derive(Clone, Copy)]
pub(crate) enum Of {
    Stage,
    InlineShaper,
}

/// The modules of blocks joined to the module `top`, without duplicates.
pub(crate) fn joined(
    whole: &JoinedBlocks,
    top: &str,
    prefix: &str,
    header: &Header,
    of: Of,
) -> Result<Vec<Module>, EmitError> {
    let mut modules: Vec<Module> = Vec::new();
    let mut tops = Vec::new();
    for block in whole.blocks() {
        let of_block = self::block(block, top, prefix, of)?;
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

/// The modules of one block; its top comes last.
fn block(block: &ComponentPart, top: &str, prefix: &str, of: Of) -> Result<Vec<Module>, EmitError> {
    match block {
        ComponentPart::Registers(map) => Ok(vec![registers::emit(map, prefix)?]),
        ComponentPart::Shaper(config) => shaper::emit(config, prefix),
        ComponentPart::SampleSelect { word_bits, channels } => sample_select::emit(*word_bits, *channels, prefix),
        ComponentPart::Pwm(config) => pwm::emit(config, prefix),
        ComponentPart::StepGenerator(config) => step_generator::emit(config, prefix),
        ComponentPart::SlidingMode => sliding_mode::emit(prefix),
        ComponentPart::SettingBanks(machine) => setting_banks::emit(machine, prefix),
        ComponentPart::PulseCounter => pulse_counter::emit(prefix),
        ComponentPart::AbsoluteEncoder(config) => absolute_encoder::emit(config, prefix),
        ComponentPart::AbsoluteFeedback => absolute_feedback::emit(prefix),
        ComponentPart::Divider(config) => divider::emit(config, prefix),
        ComponentPart::TimeBase(config) => time_base::emit(config, prefix),
        ComponentPart::Segments => segments::emit(prefix),
        ComponentPart::Axis => axis::emit(prefix),
        ComponentPart::DriveCommand => drive_command::emit(prefix),
        ComponentPart::LinearScale => linear_scale::emit(prefix),
        ComponentPart::Realign => realign::emit(prefix),
        ComponentPart::ProbeLine => probe_line::emit(prefix),
        ComponentPart::Compare => compare::emit(prefix),
        ComponentPart::Capture => capture::emit(prefix),
        ComponentPart::LastingDeviation => lasting_deviation::emit(prefix),
        ComponentPart::ErrorTable(config) => error_table::emit(config, prefix),
        ComponentPart::EncoderGenerator => encoder_generator::emit(prefix),
        ComponentPart::Excitation => excitation::emit(prefix),
        ComponentPart::Trace(config) => trace::emit(config, prefix),
        ComponentPart::DividerShare(channels) => divider_share::emit(*channels, prefix),
        ComponentPart::Schedule(config) => schedule::emit(config, prefix),
        ComponentPart::Group(axes) => group::emit(*axes, prefix),
        ComponentPart::InlineAxis(config) => inline_axis::emit(config, prefix),
        ComponentPart::InlineGroup(config) => inline_group::emit(*config, prefix),
        ComponentPart::Joined(whole) => {
            let name = whole.name();
            let header = Header {
                about: match of {
                    Of::Stage => format!("Axis {name} of the stage, without its registers."),
                    Of::InlineShaper => format!("Axis {name} of the inline shaper."),
                },
                ports: Vec::new(),
                parameters: Vec::new(),
            };
            let of_axis = |owner: &str| format!("{owner}_{}", whole.name());
            joined(whole, &of_axis(top), &of_axis(prefix), &header, of)
        }
    }
}
