//! The blocks that get mutants.

use posicast_model::rtl::cascade::CascadeConfig;
use posicast_model::rtl::component::Component;
use posicast_model::rtl::divider::DividerConfig;
use posicast_model::rtl::pwm::{ActiveLow, BridgeMode, PwmConfig};
use posicast_model::rtl::schedule::ScheduleConfig;
use posicast_model::rtl::shaper::{ShaperConfig, ShaperMotion};
use posicast_model::rtl::sliding_mode::Settings;
use posicast_model::rtl::trace::TraceConfig;
use posicast_model::taps::{Tap, TapTable};

use crate::Error;
use crate::blocks::{
    AxisBlock, Block, CascadeBlock, DividerBlock, DriveCommandBlock, EncoderGeneratorBlock, ExcitationBlock,
    LinearScaleBlock, PartBlock, PulseCounterBlock, PwmBlock, RegistersBlock, SegmentsBlock, ShaperBlock,
    SlidingModeBlock, SmallPart, TraceBlock,
};
use crate::formal::{self, Task};

/// A block at one size, with its proofs.
pub struct Subject {
    block: Box<dyn Block>,
    size: &'static str,
    tasks: Vec<Task>,
}

impl Subject {
    /// The block.
    pub fn block(&self) -> &dyn Block {
        self.block.as_ref()
    }

    /// Description of its size.
    pub fn size(&self) -> &str {
        self.size
    }

    /// The tasks whose properties hold for this block at this size.
    pub(super) fn tasks(&self) -> &[Task] {
        &self.tasks
    }
}

/// A block with a description of its size.
type OfSize = (Box<dyn Block>, &'static str);

/// All blocks that get mutants.
///
/// # Errors
/// [`Error::Block`] where a block cannot be written as Verilog.
pub fn all() -> Result<Vec<Subject>, Error> {
    let tasks = formal::all()?;
    let subject = |(block, size): OfSize| {
        let modules = block.modules()?;
        Ok(Subject {
            tasks: tasks.iter().filter(|task| task.modules == modules).cloned().collect(),
            block,
            size,
        })
    };
    blocks()?.into_iter().map(subject).collect()
}

/// The subjects of one block.
///
/// # Errors
/// Those of [`all`], and [`Error::Option`] where there is no such block.
pub fn named(name: &str) -> Result<Vec<Subject>, Error> {
    let all = all()?;
    let names: Vec<String> = all.iter().map(|subject| subject.block.name().to_owned()).collect();
    if !names.iter().any(|found| found == name) {
        return Err(Error::Option(format!(
            "no mutants for `{name}`: there are some for {}",
            names.join(", ")
        )));
    }
    Ok(all.into_iter().filter(|subject| subject.block.name() == name).collect())
}

fn refused(error: impl std::fmt::Display) -> Error {
    Error::Option(error.to_string())
}

/// A small size of each block: enough for every path, with few mutants of wide words that only repeat each other.
fn blocks() -> Result<Vec<OfSize>, Error> {
    let alone = "alone";
    let pwm = PwmConfig::new(ActiveLow::default(), 2, 1).map_err(refused)?;
    let ticks = DividerConfig::new(97).map_err(refused)?;
    let part = |part| -> Box<dyn Block> { Box::new(PartBlock::new(part, "")) };
    let mut blocks: Vec<OfSize> = vec![
        (Box::new(PulseCounterBlock::new("", alone)), "32-bit count"),
        (Box::new(DividerBlock::new(ticks, "")), "97 clocks per tick"),
        (
            Box::new(PwmBlock::new(pwm, "", alone)),
            "16-bit period, all active high",
        ),
        (Box::new(SlidingModeBlock::new("", alone)), "all laws"),
        (Box::new(ShaperBlock::new(shaper(None)?, "", alone)?), "24 bits, 5 taps"),
        (
            Box::new(ShaperBlock::new(shaper(Some(3))?, "", alone)?),
            "the same for motion",
        ),
        (
            Box::new(CascadeBlock::new(
                CascadeConfig::new(16, vec![7, 3, 12]).map_err(refused)?,
                "",
            )),
            "16 bits, 3 stages",
        ),
        (Box::new(SegmentsBlock::new("", alone)), "64 entries"),
        (Box::new(AxisBlock::new("", alone)), "all inputs"),
        (Box::new(DriveCommandBlock::new("", alone)), "nothing tied"),
        (Box::new(LinearScaleBlock::new("", alone)), "nothing tied"),
        (
            Box::new(TraceBlock::new(TraceConfig::new(256).map_err(refused)?, "")),
            "256 samples",
        ),
        (Box::new(ExcitationBlock::new("", alone)), "32 bits"),
        (Box::new(EncoderGeneratorBlock::new("", alone)), "32 bits"),
        (
            part(SmallPart::Schedule(ScheduleConfig::new(37).map_err(refused)?)),
            "control after 37 clocks",
        ),
        (part(SmallPart::DividerShare(2)), "2 channels"),
        (part(SmallPart::Group(2)), "2 axes"),
        (
            part(SmallPart::TimeBase(DividerConfig::new(17).map_err(refused)?)),
            "17 clocks per tick",
        ),
        (
            part(SmallPart::SampleSelect {
                word_bits: 32,
                channels: 3,
            }),
            "3 channels of 32 bits",
        ),
        (part(SmallPart::SettingBanks(Settings::default())), "settings of 0"),
    ];
    let pwm = PwmConfig::new(ActiveLow::default(), 25, 50).map_err(refused)?;
    let component = Component::pwm(pwm, BridgeMode::Unipolar, 2500).map_err(refused)?;
    let bank = RegistersBlock::new(component.map().clone(), "");
    blocks.push((Box::new(bank), "bank of pwm"));
    Ok(blocks)
}

/// A shaper with three impulses, two of them on two taps each; with rates for this many channels.
fn shaper(channels: Option<u32>) -> Result<ShaperConfig, Error> {
    let taps = [(0, 400), (5, 280), (6, 180), (11, 110), (12, 54)].map(|(delay_samples, coefficient)| Tap {
        delay_samples,
        coefficient,
    });
    let table = TapTable::new(10, taps.to_vec()).map_err(refused)?;
    let config = ShaperConfig::new(24, table).map_err(refused)?;
    match channels {
        None => Ok(config),
        Some(channels) => config
            .for_motion(ShaperMotion {
                channels,
                modulo: false,
            })
            .map_err(refused),
    }
}
