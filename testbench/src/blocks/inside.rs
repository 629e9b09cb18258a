//! The blocks inside a component, each alone, as the modules that stand in the component's own files.
//!
//! Stimuli made for a block get to corners that traffic on the bus hardly ever sets up, and a block alone shows at its ports
//! what a stage shows only on request, or not at all.

use posicast_model::rtl::component::{Block as Part, Component};

use super::part::Part as Small;
use super::{
    AxisBlock, Block, DividerBlock, DriveCommandBlock, EncoderGeneratorBlock, ExcitationBlock, LinearScaleBlock,
    PartBlock, PulseCounterBlock, PwmBlock, RegistersBlock, SegmentsBlock, ShaperBlock, SlidingModeBlock, TraceBlock,
};
use crate::Error;

/// Where blocks stand: the prefix of the modules that each axis has for itself, that of those all axes share, and the
/// instances of both.
struct Place<'a> {
    own: &'a str,
    shared: &'a str,
    instance: String,
    shared_instance: String,
}

/// The blocks of the component with the top `top` that serves `axis`. What only joins them (sample select, setting banks,
/// time base) has no row: the component's covers it.
///
/// # Errors
/// As [`ShaperBlock::new`].
pub(super) fn of_component(component: &Component, top: &str, axis: &str) -> Result<Vec<Box<dyn Block>>, Error> {
    let instance = format!("{axis}, in the {} component", component.name());
    let place = Place {
        own: top,
        shared: top,
        shared_instance: instance.clone(),
        instance,
    };
    let mut blocks = Vec::new();
    for part in component.blocks() {
        let joins = matches!(
            part,
            Part::SampleSelect { .. } | Part::SettingBanks(_) | Part::TimeBase(_)
        );
        if !joins {
            blocks.extend(of_part(part, &place)?);
        }
    }
    Ok(blocks)
}

/// The blocks of the stage with the top `top`, those of each axis too; a module that several axes share is there once.
///
/// # Errors
/// As [`ShaperBlock::new`].
pub(super) fn of_stage(component: &Component, top: &str) -> Result<Vec<Box<dyn Block>>, Error> {
    let shared_instance = "in the stage".to_owned();
    let mut blocks: Vec<Box<dyn Block>> = Vec::new();
    let mut add = |part: &Part, place: &Place<'_>| -> Result<(), Error> {
        if let Some(block) = of_part(part, place)?
            && blocks.iter().all(|there| there.top() != block.top())
        {
            blocks.push(block);
        }
        Ok(())
    };
    for part in component.blocks() {
        match part {
            Part::Joined(axis) => {
                let own = format!("{top}_{}", axis.name());
                let place = Place {
                    own: &own,
                    shared: top,
                    instance: format!("{}, in the stage", axis.name()),
                    shared_instance: shared_instance.clone(),
                };
                axis.blocks().try_for_each(|part| add(part, &place))?;
            }
            part => {
                let place = Place {
                    own: top,
                    shared: top,
                    instance: shared_instance.clone(),
                    shared_instance: shared_instance.clone(),
                };
                add(part, &place)?;
            }
        }
    }
    Ok(blocks)
}

fn of_part(part: &Part, place: &Place<'_>) -> Result<Option<Box<dyn Block>>, Error> {
    let (prefix, instance) = match part.is_common() {
        true => (place.shared, place.shared_instance.as_str()),
        false => (place.own, place.instance.as_str()),
    };
    let small = |part| -> Box<dyn Block> { Box::new(PartBlock::new(part, prefix).called(instance)) };
    Ok(Some(match part {
        Part::Registers(map) => Box::new(RegistersBlock::new(map.as_ref().clone(), prefix).called(instance)),
        Part::Shaper(config) => Box::new(ShaperBlock::new(config.as_ref().clone(), prefix, instance)?),
        Part::PulseCounter => Box::new(PulseCounterBlock::new(prefix, instance)),
        Part::Divider(config) => Box::new(DividerBlock::new(*config, prefix).called(instance)),
        Part::Pwm(config) => Box::new(PwmBlock::new(*config, prefix, instance)),
        Part::SlidingMode => Box::new(SlidingModeBlock::new(prefix, instance)),
        Part::Segments => Box::new(SegmentsBlock::new(prefix, instance)),
        Part::Axis => Box::new(AxisBlock::new(prefix, instance)),
        Part::DriveCommand => Box::new(DriveCommandBlock::new(prefix, instance)),
        Part::LinearScale => Box::new(LinearScaleBlock::new(prefix, instance)),
        Part::EncoderGenerator => Box::new(EncoderGeneratorBlock::new(prefix, instance)),
        Part::Excitation => Box::new(ExcitationBlock::new(prefix, instance)),
        Part::Trace(config) => Box::new(TraceBlock::new(*config, prefix).called(instance)),
        Part::DividerShare(channels) => small(Small::DividerShare(*channels)),
        Part::Schedule(config) => small(Small::Schedule(*config)),
        Part::Group(axes) => small(Small::Group(*axes)),
        Part::TimeBase(config) => small(Small::TimeBase(*config)),
        Part::SettingBanks(settings) => small(Small::SettingBanks(**settings)),
        Part::SampleSelect { word_bits, channels } => small(Small::SampleSelect {
            word_bits: *word_bits,
            channels: *channels,
        }),
        // Its blocks are taken out of it above.
        Part::Joined(_) => return Ok(None),
    }))
}
