//! Blocks of any kind joined to one, as needed for the model and the Verilog of the whole.

use crate::Moore;
use crate::absolute_encoder::{AbsoluteEncoder, AbsoluteEncoderConfig};
use crate::absolute_feedback::AbsoluteFeedback;
use crate::axis::Axis;
use crate::capture::Capture;
use crate::compare::Compare;
use crate::composition::{Composed, Composition, CompositionError, Part};
use crate::divider::{Divider, DividerConfig};
use crate::divider_share::DividerShare;
use crate::drive_command::DriveCommand;
use crate::encoder_generator::EncoderGenerator;
use crate::error_table::{ErrorTable, ErrorTableConfig};
use crate::excitation::Excitation;
use crate::group::Group;
use crate::inline_axis::{InlineAxis, InlineAxisConfig};
use crate::inline_group::{InlineGroup, InlineGroupConfig};
use crate::lasting_deviation::LastingDeviation;
use crate::linear_scale::LinearScale;
use crate::probe_line::ProbeLine;
use crate::pulse_counter::PulseCounter;
use crate::pwm::{Pwm, PwmConfig};
use crate::realign::Realign;
use crate::registers::{RegisterBank, RegisterMap};
use crate::sample_select::SampleSelect;
use crate::schedule::{Schedule, ScheduleConfig};
use crate::segments::Segments;
use crate::setting_banks::SettingBanks;
use crate::shaper::{Shaper, ShaperConfig};
use crate::sliding_mode::{Settings, SlidingMode};
use crate::step_generator::{StepGenerator, StepGeneratorConfig};
use crate::time_base::TimeBase;
use crate::trace::{Trace, TraceConfig};

/// A block in a component, with its build parameters.
#[derive(Debug, Clone, PartialEq)]
pub enum ComponentPart {
    /// The register bank.
    Registers(Box<RegisterMap>),
    /// The shaper.
    Shaper(Box<ShaperConfig>),
    /// The selection of samples from registers or pins.
    SampleSelect {
        /// Width of a word in bits.
        word_bits: u32,
        /// Number of words per sample.
        channels: usize,
    },
    /// The pulse counter.
    PulseCounter,
    /// The absolute encoder.
    AbsoluteEncoder(AbsoluteEncoderConfig),
    /// What an axis takes from its absolute encoder.
    AbsoluteFeedback,
    /// The divider.
    Divider(DividerConfig),
    /// The time base.
    TimeBase(DividerConfig),
    /// The PWM.
    Pwm(PwmConfig),
    /// The step generator.
    StepGenerator(StepGeneratorConfig),
    /// The controller.
    SlidingMode,
    /// The settings of the controller, with the machine's in bank 0.
    SettingBanks(Box<Settings>),
    /// The segments.
    Segments,
    /// The supervisor of an axis.
    Axis,
    /// The drive command, which selects what the PWM gets.
    DriveCommand,
    /// The linear scale, which compares motor and scale.
    LinearScale,
    /// What passes the deviation from a scale on once it has lasted.
    LastingDeviation,
    /// What a correction of missing steps does.
    Realign,
    /// The line of a probe.
    ProbeLine,
    /// The position compare.
    Compare,
    /// The position capture, which all axes share.
    Capture,
    /// A measured error over position, the machine's in bank 0.
    ErrorTable(Box<ErrorTableConfig>),
    /// A source of encoder edges in front of the pulse counter.
    EncoderGenerator,
    /// The test signal behind the shaper.
    Excitation,
    /// The trace memory.
    Trace(TraceConfig),
    /// The share of one divider among this many pulse counters.
    DividerShare(usize),
    /// The schedule, which starts the controllers.
    Schedule(ScheduleConfig),
    /// The group, which couples this many axes.
    Group(usize),
    /// An axis of the inline shaper: samples the command, and selects what the steps follow.
    InlineAxis(InlineAxisConfig),
    /// What the axes of the inline shaper share.
    InlineGroup(InlineGroupConfig),
    /// Blocks joined to one.
    Joined(Box<JoinedBlocks>),
}

impl ComponentPart {
    /// Name of the block, as in the Verilog.
    pub fn name(&self) -> &str {
        match self {
            Self::Registers(_) => "registers",
            Self::Shaper(_) => "shaper",
            Self::SampleSelect { .. } => "sample_select",
            Self::Pwm(_) => "pwm",
            Self::StepGenerator(_) => "step_generator",
            Self::SlidingMode => "sliding_mode",
            Self::SettingBanks(_) => "setting_banks",
            Self::PulseCounter => "pulse_counter",
            Self::AbsoluteEncoder(_) => "absolute_encoder",
            Self::AbsoluteFeedback => "absolute_feedback",
            Self::Divider(_) => "divider",
            Self::TimeBase(_) => "time_base",
            Self::Segments => "segments",
            Self::Axis => "axis",
            Self::DriveCommand => "drive_command",
            Self::LinearScale => "linear_scale",
            Self::LastingDeviation => "lasting_deviation",
            Self::Realign => "realign",
            Self::ProbeLine => "probe_line",
            Self::Compare => "compare",
            Self::Capture => "capture",
            Self::ErrorTable(_) => "error_table",
            Self::EncoderGenerator => "encoder_generator",
            Self::Excitation => "excitation",
            Self::Trace(_) => "trace",
            Self::DividerShare(_) => "divider_share",
            Self::Schedule(_) => "schedule",
            Self::Group(_) => "group",
            Self::InlineAxis(_) => "inline_axis",
            Self::InlineGroup(_) => "inline_group",
            Self::Joined(joined) => joined.name(),
        }
    }

    /// Whether it is the same for every axis of a stage, so that one module serves all.
    pub fn is_common(&self) -> bool {
        !matches!(
            self,
            Self::Registers(_)
                | Self::Shaper(_)
                | Self::SettingBanks(_)
                | Self::Pwm(_)
                | Self::StepGenerator(_)
                | Self::AbsoluteEncoder(_)
                | Self::ErrorTable(_)
                | Self::Trace(_)
                | Self::InlineAxis(_)
                | Self::Joined(_)
        )
    }

    /// Its model after reset. `seed` determines the arbitrary contents of memories.
    pub fn model(&self, seed: u64) -> Box<dyn Moore> {
        match self {
            Self::Registers(map) => Box::new(RegisterBank::new(map)),
            Self::Shaper(config) => Box::new(Shaper::new(config, seed)),
            Self::SampleSelect { word_bits, channels } => Box::new(SampleSelect::new(*word_bits, *channels)),
            Self::Pwm(config) => Box::new(Pwm::new(config)),
            Self::StepGenerator(config) => Box::new(StepGenerator::new(config)),
            Self::SlidingMode => Box::new(SlidingMode::new()),
            Self::SettingBanks(machine) => Box::new(SettingBanks::new(machine)),
            Self::PulseCounter => Box::new(PulseCounter::new()),
            Self::AbsoluteEncoder(config) => Box::new(AbsoluteEncoder::new(config)),
            Self::AbsoluteFeedback => Box::new(AbsoluteFeedback::new()),
            Self::Divider(config) => Box::new(Divider::new(config)),
            Self::TimeBase(config) => Box::new(TimeBase::new(config)),
            Self::Segments => Box::new(Segments::new(seed)),
            Self::Axis => Box::new(Axis::new()),
            Self::DriveCommand => Box::new(DriveCommand::new()),
            Self::LinearScale => Box::new(LinearScale::new()),
            Self::LastingDeviation => Box::new(LastingDeviation::new()),
            Self::Realign => Box::new(Realign::new()),
            Self::ProbeLine => Box::new(ProbeLine::new()),
            Self::Compare => Box::new(Compare::new(seed)),
            Self::Capture => Box::new(Capture::new()),
            Self::ErrorTable(config) => Box::new(ErrorTable::new(config)),
            Self::EncoderGenerator => Box::new(EncoderGenerator::new()),
            Self::Excitation => Box::new(Excitation::new()),
            Self::Trace(config) => Box::new(Trace::new(config)),
            Self::DividerShare(channels) => Box::new(DividerShare::new(*channels)),
            Self::Schedule(config) => Box::new(Schedule::new(config)),
            Self::Group(axes) => Box::new(Group::new(*axes)),
            Self::InlineAxis(config) => Box::new(InlineAxis::new(config)),
            Self::InlineGroup(config) => Box::new(InlineGroup::new(*config)),
            Self::Joined(joined) => Box::new(joined.model(seed)),
        }
    }
}

/// Blocks joined to one, as parts of a composition.
#[derive(Debug, Clone, PartialEq)]
pub struct JoinedBlocks {
    name: String,
    blocks: Vec<ComponentPart>,
    composition: Composition,
}

/// Puts ports of a block on nets with other names.
type Rewire<'a> = Box<dyn Fn(&ComponentPart, Part) -> Part + 'a>;

/// Connections that do not follow from names alone, and the ports of the whole.
pub(crate) struct Wiring<'a> {
    pub(crate) part: Rewire<'a>,
    pub(crate) inputs: Vec<String>,
    pub(crate) outputs: Vec<String>,
}

impl JoinedBlocks {
    /// Joins the blocks, each under the name of its part.
    pub(crate) fn new(
        name: &str,
        blocks: Vec<(String, ComponentPart)>,
        wiring: Wiring<'_>,
    ) -> Result<Self, CompositionError> {
        let part =
            |(name, block): &(String, ComponentPart)| (wiring.part)(block, Part::new(name, block.model(0).ports()));
        let parts = blocks.iter().map(part).collect();
        let inputs: Vec<&str> = wiring.inputs.iter().map(String::as_str).collect();
        let outputs: Vec<&str> = wiring.outputs.iter().map(String::as_str).collect();
        Ok(Self {
            name: name.to_owned(),
            composition: Composition::new(parts, &inputs, &outputs)?,
            blocks: blocks.into_iter().map(|(_, block)| block).collect(),
        })
    }

    /// Name of the whole.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its blocks, in the order of the composition's parts.
    pub fn blocks(&self) -> impl Iterator<Item = &ComponentPart> {
        self.blocks.iter()
    }

    /// Connections of the blocks.
    pub fn composition(&self) -> &Composition {
        &self.composition
    }

    /// The model of the whole after reset. `seed` determines the arbitrary contents of its memories. Nested
    /// compositions are flattened: a level between them would cost time and change nothing.
    pub fn model(&self, seed: u64) -> Composed {
        let (composition, blocks) = self.flattened(seed);
        Composed::new(composition, blocks)
    }

    fn flattened(&self, seed: u64) -> (Composition, Vec<Box<dyn Moore>>) {
        let (mut inner, mut models) = (Vec::new(), Vec::new());
        for block in &self.blocks {
            if let ComponentPart::Joined(joined) = block {
                let (composition, blocks) = joined.flattened(seed);
                inner.push(Some(composition));
                models.extend(blocks);
            } else {
                inner.push(None);
                models.push(block.model(seed));
            }
        }
        (self.composition.flattened(&inner), models)
    }
}
