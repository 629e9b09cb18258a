//! The bench of the small blocks that connect others: schedule, absolute feedback, divider share, group, inline group, time base, sample
//! select, setting banks, lasting deviation, probe line, realign.

pub(crate) mod proofs;
pub(crate) mod stimuli;
mod trials;

pub use self::stimuli::{LastingRandom, PartRandom};

use posicast_blocks::component::ComponentPart as Model;
use posicast_blocks::divider::DividerConfig;
use posicast_blocks::inline_group::InlineGroupConfig;
use posicast_blocks::schedule::ScheduleConfig;
use posicast_blocks::shaper::MOTION_WORD_BITS;
use posicast_blocks::sliding_mode::Settings;
use posicast_blocks::{ClockedBlock, Port};
use posicast_hdl::emit::{EmitError, Module};
use posicast_hdl::{
    SimulationError, absolute_feedback, divider_share, group, inline_group, lasting_deviation, probe_line, realign,
    sample_select, schedule, setting_banks, time_base,
};

use crate::blocks::changes::Changes;
use crate::blocks::registry::{AreaRow, RegistryRow, one, small};
use crate::blocks::{Bins, Block};
use crate::formal::refused;
use crate::shaper::MOTION;
use crate::stimuli::Stimuli;

/// The rows of these blocks in the registry.
pub(crate) const ABSOLUTE_FEEDBACK: RegistryRow = RegistryRow {
    name: "absolute_feedback",
    benches: |sizes| Ok(one(PartBlock::new(SmallPart::AbsoluteFeedback, &sizes.prefix))),
    small: || Ok(small(PartBlock::new(SmallPart::AbsoluteFeedback, ""), "")),
    proofs: || Ok(vec![proofs::absolute_feedback()?]),
    trials: || Ok(vec![trials::trial(SmallPart::AbsoluteFeedback, "")]),
    mutants: trials::ABSOLUTE_FEEDBACK,
    proof_mutants: trials::ABSOLUTE_FEEDBACK_PROOFS,
    areas: || Ok(vec![AreaRow::new("", absolute_feedback::emit("")?)]),
};
pub(crate) const TIME_BASE: RegistryRow = RegistryRow {
    name: "time_base",
    benches: |sizes| Ok(one(PartBlock::new(SmallPart::TimeBase(sizes.tick), &sizes.prefix))),
    small: || {
        let ticks = DividerConfig::new(17).map_err(refused)?;
        Ok(small(
            PartBlock::new(SmallPart::TimeBase(ticks), ""),
            "17 clocks per tick",
        ))
    },
    proofs: || {
        let begins = [(17, "32'd0"), (127, "32'd0"), (17, "32'hfffffff0")];
        begins
            .map(|(ticks, begin)| proofs::time_base(ticks, begin))
            .into_iter()
            .collect()
    },
    trials: || {
        Ok(vec![trials::trial(
            SmallPart::TimeBase(DividerConfig::new(17).map_err(refused)?),
            "",
        )])
    },
    proof_mutants: trials::TIME_BASE_PROOFS,
    ..RegistryRow::EMPTY
};
pub(crate) const SCHEDULE: RegistryRow = RegistryRow {
    name: "schedule",
    benches: |sizes| {
        let config = ScheduleConfig::new(500).map_err(refused)?;
        Ok(one(PartBlock::new(SmallPart::Schedule(config), &sizes.prefix)))
    },
    small: || {
        let config = ScheduleConfig::new(37).map_err(refused)?;
        Ok(small(
            PartBlock::new(SmallPart::Schedule(config), ""),
            "control after 37 clocks",
        ))
    },
    proofs: || [2, 400].map(proofs::schedule).into_iter().collect(),
    trials: || {
        Ok(vec![trials::trial(
            SmallPart::Schedule(ScheduleConfig::new(37).map_err(refused)?),
            "",
        )])
    },
    mutants: trials::SCHEDULE,
    proof_mutants: trials::SCHEDULE_PROOFS,
    ..RegistryRow::EMPTY
};
pub(crate) const DIVIDER_SHARE: RegistryRow = RegistryRow {
    name: "divider_share",
    benches: |sizes| Ok(one(PartBlock::new(SmallPart::DividerShare(sizes.axes), &sizes.prefix))),
    small: || Ok(small(PartBlock::new(SmallPart::DividerShare(2), ""), "2 channels")),
    proofs: || [1, 2, 3, 8].map(proofs::divider_share).into_iter().collect(),
    trials: || {
        Ok(vec![
            trials::trial(SmallPart::DividerShare(2), "2 channels"),
            trials::trial(SmallPart::DividerShare(1), "1 channel"),
            trials::trial(SmallPart::DividerShare(8), "8 channels"),
        ])
    },
    mutants: trials::DIVIDER_SHARE,
    proof_mutants: trials::DIVIDER_SHARE_PROOFS,
    ..RegistryRow::EMPTY
};
pub(crate) const GROUP: RegistryRow = RegistryRow {
    name: "group",
    benches: |sizes| Ok(one(PartBlock::new(SmallPart::Group(sizes.axes), &sizes.prefix))),
    small: || Ok(small(PartBlock::new(SmallPart::Group(2), ""), "2 axes")),
    proofs: || [2, 4].map(proofs::group).into_iter().collect(),
    trials: || {
        Ok(vec![
            trials::trial(SmallPart::Group(2), "2 axes"),
            trials::trial(SmallPart::Group(4), "4 axes"),
        ])
    },
    mutants: trials::GROUP,
    proof_mutants: trials::GROUP_PROOFS,
    ..RegistryRow::EMPTY
};
/// Sizes of the group that are compared and proven.
const INLINE_GROUPS: [InlineGroupConfig; 3] = [
    InlineGroupConfig::without_registers(2),
    InlineGroupConfig::without_registers(4),
    InlineGroupConfig {
        axes: 2,
        with_registers: true,
    },
];
pub(crate) const INLINE_GROUP: RegistryRow = RegistryRow {
    name: "inline_group",
    benches: |sizes| {
        let Some(shaper) = &sizes.inline else {
            return Ok(Vec::new());
        };
        let axes = shaper.config().axes.len();
        let config = InlineGroupConfig::without_registers(axes);
        Ok(one(PartBlock::new(SmallPart::InlineGroup(config), &sizes.prefix)))
    },
    small: || {
        let part = SmallPart::InlineGroup(InlineGroupConfig::without_registers(2));
        Ok(small(PartBlock::new(part, ""), "2 axes"))
    },
    proofs: || INLINE_GROUPS.map(proofs::inline_group).into_iter().collect(),
    trials: || {
        Ok(vec![
            trials::trial(SmallPart::InlineGroup(INLINE_GROUPS[0]), "2 axes"),
            trials::trial(SmallPart::InlineGroup(INLINE_GROUPS[1]), "4 axes"),
            trials::trial(SmallPart::InlineGroup(INLINE_GROUPS[2]), "2 axes with registers"),
        ])
    },
    mutants: trials::INLINE_GROUP,
    proof_mutants: trials::INLINE_GROUP_PROOFS,
    ..RegistryRow::EMPTY
};
pub(crate) const LASTING_DEVIATION: RegistryRow = RegistryRow {
    name: "lasting_deviation",
    benches: |sizes| Ok(one(PartBlock::new(SmallPart::LastingDeviation, &sizes.prefix))),
    small: || Ok(small(PartBlock::new(SmallPart::LastingDeviation, ""), "")),
    proofs: || Ok(vec![proofs::lasting_deviation()?]),
    trials: || Ok(vec![trials::trial(SmallPart::LastingDeviation, "")]),
    mutants: trials::LASTING_DEVIATION,
    proof_mutants: trials::LASTING_DEVIATION_PROOFS,
    areas: || Ok(vec![AreaRow::new("", lasting_deviation::emit("")?)]),
};
pub(crate) const PROBE_LINE: RegistryRow = RegistryRow {
    name: "probe_line",
    benches: |sizes| Ok(one(PartBlock::new(SmallPart::ProbeLine, &sizes.prefix))),
    small: || Ok(small(PartBlock::new(SmallPart::ProbeLine, ""), "")),
    proofs: || Ok(vec![proofs::probe_line()?]),
    trials: || Ok(vec![trials::trial(SmallPart::ProbeLine, "")]),
    mutants: trials::PROBE_LINE,
    proof_mutants: trials::PROBE_LINE_PROOFS,
    areas: || Ok(vec![AreaRow::new("", probe_line::emit("")?)]),
};
pub(crate) const REALIGN: RegistryRow = RegistryRow {
    name: "realign",
    benches: |sizes| Ok(one(PartBlock::new(SmallPart::Realign, &sizes.prefix))),
    small: || Ok(small(PartBlock::new(SmallPart::Realign, ""), "")),
    proofs: || Ok(vec![proofs::realign()?]),
    trials: || Ok(vec![trials::trial(SmallPart::Realign, "")]),
    mutants: trials::REALIGN,
    proof_mutants: trials::REALIGN_PROOFS,
    areas: || Ok(vec![AreaRow::new("", realign::emit("")?)]),
};
pub(crate) const SAMPLE_SELECT: RegistryRow = RegistryRow {
    name: "sample_select",
    benches: |sizes| Ok(one(PartBlock::new(WIDE_SAMPLES, &sizes.prefix))),
    small: || Ok(small(PartBlock::new(WIDE_SAMPLES, ""), "3 channels of 32 bits")),
    proofs: || [1, 3].map(proofs::sample_select).into_iter().collect(),
    trials: || Ok(vec![trials::trial(WIDE_SAMPLES, "")]),
    proof_mutants: trials::SAMPLE_SELECT_PROOFS,
    ..RegistryRow::EMPTY
};
pub(crate) const SETTING_BANKS: RegistryRow = RegistryRow {
    name: "setting_banks",
    benches: |sizes| {
        Ok(one(PartBlock::new(
            SmallPart::SettingBanks(sizes.settings),
            &sizes.prefix,
        )))
    },
    small: || {
        let part = SmallPart::SettingBanks(Settings::default());
        Ok(small(PartBlock::new(part, ""), "settings of 0"))
    },
    proofs: || Ok(vec![proofs::setting_banks()?]),
    trials: || {
        let words = std::array::from_fn(|row| 0x1234_5678_u32.rotate_left(row as u32));
        Ok(vec![trials::trial(SmallPart::SettingBanks(Settings(words)), "")])
    },
    mutants: trials::SETTING_BANKS,
    proof_mutants: trials::SETTING_BANKS_PROOFS,
    ..RegistryRow::EMPTY
};

/// Position, velocity and acceleration, in the widest words.
const WIDE_SAMPLES: SmallPart = SmallPart::SampleSelect {
    word_bits: *MOTION_WORD_BITS.end(),
    channels: MOTION.channels as usize,
};

/// A block that connects others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SmallPart {
    /// `absolute_feedback`: what an axis takes from its absolute encoder.
    AbsoluteFeedback,
    /// `schedule`: decides when the controllers start.
    Schedule(ScheduleConfig),
    /// `divider_share`: one divider for this many pulse counters.
    DividerShare(usize),
    /// `group`: couples this many axes.
    Group(usize),
    /// `inline_group`: what the axes of the inline shaper share.
    InlineGroup(InlineGroupConfig),
    /// `lasting_deviation`: passes a deviation on once it has lasted.
    LastingDeviation,
    /// `probe_line`: polarity and filter of a probe.
    ProbeLine,
    /// `realign`: the deviation counts anew.
    Realign,
    /// `time_base`: makes ticks of this length.
    TimeBase(DividerConfig),
    /// `sample_select`: selects the source of samples.
    SampleSelect {
        /// Width of a word.
        word_bits: u32,
        /// Number of words per sample.
        channels: usize,
    },
    /// `setting_banks`: the settings of a controller, with these in bank 0.
    SettingBanks(Settings),
}

/// A block that connects others, with its name; its stimuli change slowly and fast.
#[derive(Debug, Clone)]
pub struct PartBlock {
    part: SmallPart,
    model: Model,
    prefix: String,
    instance: String,
}

impl PartBlock {
    /// Creates the block with the module `PREFIX_NAME`.
    pub fn new(part: SmallPart, prefix: &str) -> Self {
        let (model, instance) = match part {
            SmallPart::Schedule(config) => {
                let clocks = format!("{} clocks to control", config.control_clocks());
                (Model::Schedule(config), clocks)
            }
            SmallPart::DividerShare(channels) => (Model::DividerShare(channels), format!("{channels} channels")),
            SmallPart::Group(axes) => (Model::Group(axes), format!("{axes} axes")),
            SmallPart::InlineGroup(config) => (Model::InlineGroup(config), proofs::group_size(config)),
            SmallPart::AbsoluteFeedback => (Model::AbsoluteFeedback, "alone".to_owned()),
            SmallPart::LastingDeviation => (Model::LastingDeviation, "alone".to_owned()),
            SmallPart::ProbeLine => (Model::ProbeLine, "alone".to_owned()),
            SmallPart::Realign => (Model::Realign, "alone".to_owned()),
            SmallPart::TimeBase(config) => {
                let clocks = format!("{} clocks per tick", config.tick_clocks());
                (Model::TimeBase(config), clocks)
            }
            SmallPart::SampleSelect { word_bits, channels } => (
                Model::SampleSelect { word_bits, channels },
                format!("{channels} x {word_bits} bits"),
            ),
            SmallPart::SettingBanks(settings) => (Model::SettingBanks(Box::new(settings)), "alone".to_owned()),
        };
        Self {
            part,
            model,
            prefix: prefix.to_owned(),
            instance,
        }
    }

    /// Renames the block to `instance` in the report.
    pub fn called(self, instance: &str) -> Self {
        Self {
            instance: instance.to_owned(),
            ..self
        }
    }

    fn ports(&self) -> Vec<Port> {
        self.model.model(0).ports().to_vec()
    }
}

impl Block for PartBlock {
    fn name(&self) -> &str {
        self.model.name()
    }

    fn instance(&self) -> &str {
        &self.instance
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        let prefix = self.prefix.as_str();
        match &self.part {
            SmallPart::Schedule(config) => schedule::emit(config, prefix),
            SmallPart::DividerShare(channels) => divider_share::emit(*channels, prefix),
            SmallPart::Group(axes) => group::emit(*axes, prefix),
            SmallPart::InlineGroup(config) => inline_group::emit(*config, prefix),
            SmallPart::AbsoluteFeedback => absolute_feedback::emit(prefix),
            SmallPart::LastingDeviation => lasting_deviation::emit(prefix),
            SmallPart::ProbeLine => probe_line::emit(prefix),
            SmallPart::Realign => realign::emit(prefix),
            SmallPart::TimeBase(config) => time_base::emit(config, prefix),
            SmallPart::SampleSelect { word_bits, channels } => sample_select::emit(*word_bits, *channels, prefix),
            SmallPart::SettingBanks(settings) => setting_banks::emit(settings, prefix),
        }
    }

    fn top(&self) -> String {
        let prefix = self.prefix.as_str();
        match &self.part {
            SmallPart::Schedule(config) => schedule::name(config, prefix),
            SmallPart::DividerShare(channels) => divider_share::name(*channels, prefix),
            SmallPart::Group(axes) => group::name(*axes, prefix),
            SmallPart::InlineGroup(config) => inline_group::name(*config, prefix),
            SmallPart::AbsoluteFeedback => absolute_feedback::name(prefix),
            SmallPart::LastingDeviation => lasting_deviation::name(prefix),
            SmallPart::ProbeLine => probe_line::name(prefix),
            SmallPart::Realign => realign::name(prefix),
            SmallPart::TimeBase(config) => time_base::name(config, prefix),
            SmallPart::SampleSelect { word_bits, channels } => sample_select::name(*word_bits, *channels, prefix),
            SmallPart::SettingBanks(_) => setting_banks::name(prefix),
        }
    }

    fn model(&self, seed: u64) -> Box<dyn ClockedBlock> {
        self.model.model(seed)
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        match &self.part {
            SmallPart::Schedule(config) => schedule::simulate(config),
            SmallPart::DividerShare(channels) => divider_share::simulate(*channels),
            SmallPart::Group(axes) => group::simulate(*axes),
            SmallPart::InlineGroup(config) => inline_group::simulate(*config),
            SmallPart::AbsoluteFeedback => absolute_feedback::simulate(),
            SmallPart::LastingDeviation => lasting_deviation::simulate(),
            SmallPart::ProbeLine => probe_line::simulate(),
            SmallPart::Realign => realign::simulate(),
            SmallPart::TimeBase(config) => time_base::simulate(config),
            SmallPart::SampleSelect { word_bits, channels } => sample_select::simulate(*word_bits, *channels),
            SmallPart::SettingBanks(settings) => setting_banks::simulate(settings),
        }
    }

    fn stimuli(&self, _cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        match self.part {
            SmallPart::LastingDeviation => Box::new(LastingRandom::new(seed)),
            _ => Box::new(PartRandom::new(&self.ports(), seed)),
        }
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(Changes::new(&self.ports()))
    }

    fn fixed(&self) -> Vec<(String, &'static str)> {
        match self.part {
            SmallPart::Group(1) => vec![("group_stop_0".to_owned(), "no other axis can stop a single one")],
            _ => Vec::new(),
        }
    }
}
