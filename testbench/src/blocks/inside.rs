//! The blocks inside a component or a stage, each alone, with the modules from its own files.
//!
//! Stimuli made for a block reach corner cases that traffic on the bus hardly ever does, and the ports of a block alone
//! show what a stage shows only on request, or not at all.

use posicast_blocks::component::{Component, ComponentPart as Part, JoinedBlocks};

use super::Block;
use crate::Error;
use crate::absolute_encoder::AbsoluteEncoderBlock;
use crate::axis::AxisBlock;
use crate::capture::CaptureBlock;
use crate::compare::CompareBlock;
use crate::divider::DividerBlock;
use crate::drive_command::DriveCommandBlock;
use crate::encoder_generator::EncoderGeneratorBlock;
use crate::error_table::ErrorTableBlock;
use crate::excitation::ExcitationBlock;
use crate::inline_axis::InlineAxisBlock;
use crate::linear_scale::LinearScaleBlock;
use crate::parts::PartBlock;
use crate::parts::SmallPart as Small;
use crate::pulse_counter::PulseCounterBlock;
use crate::pwm::PwmBlock;
use crate::registers::RegistersBlock;
use crate::segments::SegmentsBlock;
use crate::shaper::ShaperBlock;
use crate::sliding_mode::SlidingModeBlock;
use crate::step_generator::StepGeneratorBlock;
use crate::trace::TraceBlock;

/// Names of blocks: the prefix of the modules whose contents depend on the machine, and the instance in a report.
struct Place<'a> {
    prefix: &'a str,
    instance: &'a str,
}

/// Returns the blocks of the component of `axis`; names of modules that depend on the machine begin with `prefix`. The
/// blocks that only connect others (sample select, setting banks, time base) are left out: the component's row covers
/// them.
///
/// # Errors
/// As [`ShaperBlock::new`].
pub(crate) fn of_component(component: &Component, prefix: &str, axis: &str) -> Result<Vec<Box<dyn Block>>, Error> {
    let instance = format!("{axis}, in the {} component", component.name());
    let place = Place {
        prefix,
        instance: &instance,
    };
    let mut blocks = Vec::new();
    for part in component.blocks() {
        let joins = matches!(
            part,
            Part::SampleSelect { .. } | Part::SettingBanks(_) | Part::TimeBase(_)
        );
        if !joins {
            blocks.extend(block_of_part(part, &place)?);
        }
    }
    Ok(blocks)
}

/// Returns the blocks of the stage, including those of its axes; names of modules that depend on the machine begin with
/// `prefix`. A block that is the same for all axes is included once; one that can differ from axis to axis is included
/// for each, even if the modules are equal.
///
/// # Errors
/// As [`ShaperBlock::new`].
pub(crate) fn of_stage(component: &Component, prefix: &str) -> Result<Vec<Box<dyn Block>>, Error> {
    of_joined(component.whole(), prefix, "in the stage")
}

/// As [`of_stage`], for blocks joined without registers; `instance` names the whole.
///
/// # Errors
/// As [`ShaperBlock::new`].
pub(crate) fn of_joined(whole: &JoinedBlocks, prefix: &str, instance: &str) -> Result<Vec<Box<dyn Block>>, Error> {
    let shared = Place { prefix, instance };
    let mut blocks: Vec<Box<dyn Block>> = Vec::new();
    let mut add = |part: &Part, place: &Place<'_>| -> Result<(), Error> {
        let is_there = |block: &dyn Block| {
            let mut there = blocks.iter();
            there.any(|there| there.top() == block.top() && there.instance() == block.instance())
        };
        if let Some(block) = block_of_part(part, place)?.filter(|block| !is_there(block.as_ref())) {
            blocks.push(block);
        }
        Ok(())
    };
    for part in whole.blocks() {
        match part {
            Part::Joined(axis) => {
                let own = Place {
                    prefix: &format!("{prefix}_{}", axis.name()),
                    instance: &format!("{}, {instance}", axis.name()),
                };
                axis.blocks()
                    .try_for_each(|part| add(part, if part.is_common() { &shared } else { &own }))?;
            }
            part => add(part, &shared)?,
        }
    }
    Ok(blocks)
}

fn block_of_part(part: &Part, place: &Place<'_>) -> Result<Option<Box<dyn Block>>, Error> {
    let Place { prefix, instance } = *place;
    let small = |part| -> Box<dyn Block> { Box::new(PartBlock::new(part, prefix).called(instance)) };
    Ok(Some(match part {
        Part::Registers(map) => Box::new(RegistersBlock::new(map.as_ref().clone(), prefix).called(instance)),
        Part::Shaper(config) => Box::new(ShaperBlock::new(config.as_ref().clone(), prefix, instance)?),
        Part::PulseCounter => Box::new(PulseCounterBlock::new(prefix, instance)),
        Part::AbsoluteEncoder(config) => Box::new(AbsoluteEncoderBlock::new(*config, prefix).called(instance)),
        Part::AbsoluteFeedback => small(Small::AbsoluteFeedback),
        Part::Divider(config) => Box::new(DividerBlock::new(*config, prefix).called(instance)),
        Part::Pwm(config) => Box::new(PwmBlock::new(*config, prefix, instance)),
        Part::StepGenerator(config) => Box::new(StepGeneratorBlock::new(*config, prefix).called(instance)),
        Part::SlidingMode => Box::new(SlidingModeBlock::new(prefix, instance)),
        Part::Segments => Box::new(SegmentsBlock::new(prefix, instance)),
        Part::Axis => Box::new(AxisBlock::new(prefix, instance)),
        Part::DriveCommand => Box::new(DriveCommandBlock::new(prefix, instance)),
        Part::LinearScale => Box::new(LinearScaleBlock::new(prefix, instance)),
        Part::Realign => small(Small::Realign),
        Part::ProbeLine => small(Small::ProbeLine),
        Part::Compare => Box::new(CompareBlock::new(prefix, instance)),
        Part::Capture => Box::new(CaptureBlock::new(prefix, instance)),
        Part::LastingDeviation => small(Small::LastingDeviation),
        Part::ErrorTable(config) => Box::new(ErrorTableBlock::new(config.as_ref().clone(), prefix, instance)),
        Part::EncoderGenerator => Box::new(EncoderGeneratorBlock::new(prefix, instance)),
        Part::Excitation => Box::new(ExcitationBlock::new(prefix, instance)),
        Part::Trace(config) => Box::new(TraceBlock::new(*config, prefix).called(instance)),
        Part::DividerShare(channels) => small(Small::DividerShare(*channels)),
        Part::Schedule(config) => small(Small::Schedule(*config)),
        Part::Group(axes) => small(Small::Group(*axes)),
        Part::InlineAxis(config) => Box::new(InlineAxisBlock::new(*config, prefix, instance)),
        Part::InlineGroup(axes) => small(Small::InlineGroup(*axes)),
        Part::TimeBase(config) => small(Small::TimeBase(*config)),
        Part::SettingBanks(settings) => small(Small::SettingBanks(**settings)),
        Part::SampleSelect { word_bits, channels } => small(Small::SampleSelect {
            word_bits: *word_bits,
            channels: *channels,
        }),
        // The component's blocks were added above.
        Part::Joined(_) => return Ok(None),
    }))
}
