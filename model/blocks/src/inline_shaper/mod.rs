//! The inline shaper: one to four axes between a controller with step outputs and drives with step inputs, without
//! software. [`InlineShaper`] has no registers; [`Component::inline_shaper`] has them, for a host that looks on.
//!
//! ```text
//! tick ─► time_base, schedule, inline_group                                   one of each
//!
//! per axis: pins ─► inline_axis ─► pulse_counter ─► inline_axis ─► shaper ─► inline_axis ─► step_generator ─► pins
//!                   a flip-flop    counts           samples                  or unshaped
//! ```
//!
//! It is a composition of blocks, from which the model here and the Verilog in `posicast_hdl::inline_shaper` are made. The
//! page is `docs/inline.md`.
//!
//! Every axis shapes modulo 2^24 steps, so an axis may turn without end. The step generator takes only changes of the
//! position, so nothing is lost at the wrap.
//!
//! With registers an axis is settled only after the longest delay of any table that a host can load; all else at the pins is as
//! without them. No register stops an axis, and none starts it.

mod registers;

use crate::component::{Component, ComponentError, ComponentPart, JoinedBlocks, Wiring};
use crate::composition::{Composed, CompositionError, Part};
use crate::divider::DividerConfig;
use crate::group::MOST_AXES;
use crate::inline_axis::{INLINE_FRACTION, InlineAxisConfig, LATENCY_CLOCKS};
use crate::inline_group::InlineGroupConfig;
use crate::pulse_counter::FILTER_CLOCKS_MAX;
use crate::registers::{MapError, RegisterMap, trace};
use crate::schedule::{ScheduleConfig, ScheduleConfigError};
use crate::shaper::{ShaperConfig, ShaperMotion};
use crate::step_generator::{self, StepGeneratorConfig, StepMode};
use crate::trace::TraceConfig;

/// The shaper that an axis needs: only the position, which wraps.
pub const INLINE_MOTION: ShaperMotion = ShaperMotion {
    channels: 1,
    modulo: true,
};

/// Name of the component with registers.
pub const INLINE_SHAPER: &str = "inline_shaper";

/// Clocks from a pin to the count, in addition to the filter: a flip-flop, and the pulse counter's.
const INPUT_CLOCKS: u32 = 1 + 4;
/// Clocks from a strobe for which the signals of a trace must stand.
const TRACE_CLOCKS: u32 = 16;
/// Pins that all axes share, after `rst`.
const SHARED_INPUTS: [&str; 5] = ["rst", "enable", "emergency_stop_n", "bypass", "clear_faults"];
const SHARED_OUTPUTS: [&str; 4] = ["drive_enable", "settled", "bypassed", "fault"];
/// Why an axis has stopped: pins of every axis.
const CAUSES: [&str; 3] = ["input_too_fast", "steps_stopped", "input_illegal"];
/// Nets of the whole that every axis reads.
const SHARED_NETS: [&str; 6] = ["rst", "tick", "control", "run", "clear", "bypassed"];

/// An inline shaper of one to four axes.
#[derive(Debug, Clone, PartialEq)]
pub struct InlineConfig {
    /// Clocks per tick.
    pub tick: DividerConfig,
    /// Its axes.
    pub axes: Vec<InlineShaperAxis>,
}

/// One axis of an inline shaper.
#[derive(Debug, Clone, PartialEq)]
pub struct InlineShaperAxis {
    /// Name of the axis, with which its pins begin.
    pub name: String,
    /// What the lines of the command show.
    pub input: StepMode,
    /// Pulses of up to this many clocks on a line of the command are ignored, 0 to 63.
    pub filter_clocks: u32,
    /// The limit of the input, the time until it is settled, the lines that are active low.
    pub follower: InlineAxisConfig,
    /// Its shaper, with [`INLINE_MOTION`].
    pub shaper: ShaperConfig,
    /// The lines to the drive.
    pub steps: StepGeneratorConfig,
    /// A memory that records its positions; only registers reach it, and without them it is not built.
    pub trace: Option<TraceConfig>,
}

/// Why an inline shaper cannot be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum InlineError {
    /// The number of axes is 0 or too large.
    #[error("an inline shaper has 1 to {MOST_AXES} axes, not {0}")]
    Axes(usize),
    /// The filter of an axis.
    #[error("axis {axis}: a filter of {clocks} clocks: 0 to {FILTER_CLOCKS_MAX} are possible")]
    Filter {
        /// Name of the axis.
        axis: String,
        /// Clocks of the filter.
        clocks: u32,
    },
    /// The shaper is not of the kind that an axis needs.
    #[error("axis {axis}: an inline shaper shapes one position of 32 bits that wraps")]
    Shaper {
        /// Name of the axis.
        axis: String,
    },
    /// The step generator has other ticks or other positions.
    #[error(
        "axis {axis}: the step generator must have ticks of {tick_clocks} clocks and {INLINE_FRACTION} fraction bits"
    )]
    Steps {
        /// Name of the axis.
        axis: String,
        /// Clocks of a tick.
        tick_clocks: u32,
    },
    /// The computations of a tick take longer than a tick.
    #[error(
        "a tick of {available} clocks is too short: the longest shaper takes {needed}; choose a lower sample rate or a faster clock"
    )]
    Schedule {
        /// Clocks from the tick to the step generator's.
        needed: u32,
        /// Clocks of a tick.
        available: u32,
    },
    /// The schedule block cannot be built.
    #[error(transparent)]
    ScheduleBlock(#[from] ScheduleConfigError),
    /// The register map has an error.
    #[error("the registers of the inline shaper clash, rename an axis: {0}")]
    Map(#[from] MapError),
    /// The component cannot be made.
    #[error("the ports of the inline shaper clash, rename an axis: {0}")]
    Component(#[from] ComponentError),
    /// The wiring has an error.
    #[error("the ports of the inline shaper clash, rename an axis: {0}")]
    Composition(#[from] CompositionError),
}

/// The mode of the pulse counter that reads these lines.
pub fn counter_mode(mode: StepMode) -> u64 {
    match mode {
        StepMode::Quadrature => 0,
        StepMode::StepDirection => 3,
        StepMode::UpDown => 4,
    }
}

impl InlineShaperAxis {
    /// Clocks of the shaper's pass.
    fn pass_clocks(&self) -> u32 {
        self.shaper.pass_clocks(self.shaper.table().taps().len() as u32)
    }
}

impl InlineConfig {
    /// Clocks from the tick to the tick of the step generators: after the longest pass, always the same.
    pub fn control_clocks(&self) -> u32 {
        let longest = self.axes.iter().map(InlineShaperAxis::pass_clocks).max().unwrap_or(0);
        longest + 2 * LATENCY_CLOCKS + 1
    }

    /// Clocks from an edge of a line of the command to the edge of its step, for an even speed and without shaping: the
    /// input, the wait for the step generator, a tick of interpolation, the step generator.
    pub fn unshaped_clocks(&self, axis: &InlineShaperAxis) -> u32 {
        let input = INPUT_CLOCKS + axis.filter_clocks;
        input + self.control_clocks() + self.tick.tick_clocks() + step_generator::LATENCY_CLOCKS as u32
    }

    fn check(&self) -> Result<(), InlineError> {
        if !(1..=MOST_AXES).contains(&self.axes.len()) {
            return Err(InlineError::Axes(self.axes.len()));
        }
        let tick_clocks = self.tick.tick_clocks();
        for axis in &self.axes {
            let name = || axis.name.clone();
            if axis.filter_clocks > FILTER_CLOCKS_MAX {
                return Err(InlineError::Filter {
                    axis: name(),
                    clocks: axis.filter_clocks,
                });
            }
            if axis.shaper.motion() != Some(INLINE_MOTION) || axis.shaper.word_bits() != 32 {
                return Err(InlineError::Shaper { axis: name() });
            }
            if (axis.steps.tick_clocks(), axis.steps.fraction_bits()) != (tick_clocks, INLINE_FRACTION) {
                return Err(InlineError::Steps {
                    axis: name(),
                    tick_clocks,
                });
            }
        }
        let traced = self.axes.iter().any(|axis| axis.trace.is_some());
        let needed = self.control_clocks() + if traced { TRACE_CLOCKS } else { 0 };
        if needed < tick_clocks {
            Ok(())
        } else {
            Err(InlineError::Schedule {
                needed,
                available: tick_clocks,
            })
        }
    }
}

/// An inline shaper: its blocks, joined.
#[derive(Debug, Clone, PartialEq)]
pub struct InlineShaper {
    config: InlineConfig,
    joined: JoinedBlocks,
}

impl InlineShaper {
    /// Joins the blocks.
    ///
    /// # Errors
    /// [`InlineError`] for no axis or more than four, for ticks that are too short, and for names that clash.
    pub fn new(config: &InlineConfig) -> Result<Self, InlineError> {
        config.check()?;
        let blocks = blocks(config, Registers::Without)?;
        Ok(Self {
            joined: JoinedBlocks::new(INLINE_SHAPER, blocks, wiring(config))?,
            config: config.clone(),
        })
    }

    /// Its configuration.
    pub fn config(&self) -> &InlineConfig {
        &self.config
    }

    /// Its blocks, joined.
    pub fn whole(&self) -> &JoinedBlocks {
        &self.joined
    }

    /// The model of the whole after reset. `seed` determines the arbitrary contents of its memories.
    pub fn model(&self, seed: u64) -> Composed {
        self.joined.model(seed)
    }
}

/// Whether an inline shaper has registers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Registers {
    With,
    Without,
}

impl Component {
    /// The inline shaper behind registers, for a host that looks on: status, counts, tables, and a request for no shaping.
    /// `machine_crc` identifies the machine file; `None` leaves out its register.
    ///
    /// # Errors
    /// [`InlineError`] as [`InlineShaper::new`], and for names of registers that clash.
    pub fn inline_shaper(config: &InlineConfig, machine_crc: Option<u32>) -> Result<Self, InlineError> {
        config.check()?;
        let config = config.for_any_table();
        let map = RegisterMap::new(registers::description(&config, machine_crc))?;
        let blocks = blocks(&config, Registers::With)?;
        let mut wiring = wiring(&config);
        // The bus of the component has the reset.
        wiring.inputs.retain(|pin| pin != "rst");
        Ok(Self::joined(map, INLINE_SHAPER, blocks, wiring)?)
    }
}

impl InlineConfig {
    /// The same, where an axis is settled after the longest delay that the shaper's memory allows: a table that a host loads may
    /// have it.
    #[must_use]
    pub fn for_any_table(&self) -> Self {
        let mut config = self.clone();
        for axis in &mut config.axes {
            let ticks = (1_u64 << axis.shaper.ring_address_bits()) - 1;
            axis.follower = axis.follower.settles_after(ticks);
        }
        config
    }
}

/// The blocks of an inline shaper, each with the name of its part.
fn blocks(config: &InlineConfig, registers: Registers) -> Result<Vec<(String, ComponentPart)>, InlineError> {
    let mut blocks = vec![
        ComponentPart::TimeBase(config.tick),
        ComponentPart::Schedule(ScheduleConfig::new(config.control_clocks())?),
        ComponentPart::InlineGroup(InlineGroupConfig {
            axes: config.axes.len(),
            with_registers: registers == Registers::With,
        }),
    ];
    for axis in &config.axes {
        blocks.push(ComponentPart::Joined(Box::new(join(axis, registers)?)));
    }
    Ok(blocks
        .into_iter()
        .map(|block| (block.name().to_owned(), block))
        .collect())
}

/// The pins of an inline shaper, and the connections of its parts.
fn wiring(config: &InlineConfig) -> Wiring<'_> {
    Wiring {
        part: Box::new(|block, part| wire(config, block, part)),
        inputs: pins(config, &SHARED_INPUTS, |axis| input_pins(axis).to_vec()),
        outputs: pins(config, &SHARED_OUTPUTS, |axis| {
            let lines = axis.steps.mode().line_names().map(str::to_owned);
            [lines.to_vec(), CAUSES.map(str::to_owned).to_vec()].concat()
        }),
    }
}

/// The input pins of an axis: the lines of the command.
fn input_pins(axis: &InlineShaperAxis) -> [String; 2] {
    axis.input.line_names().map(|line| format!("{line}_in"))
}

/// The shared pins, then those of each axis.
fn pins(config: &InlineConfig, shared: &[&str], of_axis: fn(&InlineShaperAxis) -> Vec<String>) -> Vec<String> {
    let mut pins: Vec<String> = shared.iter().map(|pin| (*pin).to_owned()).collect();
    for axis in &config.axes {
        pins.extend(of_axis(axis).iter().map(|pin| format!("{}_{pin}", axis.name)));
    }
    pins
}

fn wire(config: &InlineConfig, block: &ComponentPart, part: Part) -> Part {
    match block {
        ComponentPart::InlineGroup(group) => {
            let part = (0..group.requests()).fold(part, |part, _| part.on("bypass_request_0", "bypass_request"));
            config.axes.iter().enumerate().fold(part, |part, (index, axis)| {
                ["settled", "fault"].iter().fold(part, |part, port| {
                    part.on(&format!("axis_{port}_{index}"), &format!("{}_{port}", axis.name))
                })
            })
        }
        ComponentPart::Joined(joined) => {
            let ports = part.ports().to_vec();
            let own = ports.iter().filter(|port| !SHARED_NETS.contains(&port.name.as_str()));
            own.fold(part, |part, port| {
                part.on(&port.name, &format!("{}_{}", joined.name(), port.name))
            })
        }
        _ => part,
    }
}

/// Names of the nets of an axis that only registers read.
struct Counts {
    input: &'static str,
    given: &'static str,
    owed: &'static str,
}

/// Joins the blocks of an axis.
fn join(axis: &InlineShaperAxis, registers: Registers) -> Result<JoinedBlocks, CompositionError> {
    // Without registers the nets have the names of the ports.
    let (counts, driven, read) = match registers {
        Registers::Without => {
            let counts = Counts {
                input: "count",
                given: "given",
                owed: "owed",
            };
            (counts, Vec::new(), Vec::new())
        }
        Registers::With => {
            let counts = Counts {
                input: registers::INPUT_STEPS,
                given: registers::GIVEN_STEPS,
                owed: registers::OWED_STEPS,
            };
            let (driven, read) = registers::hardware(axis);
            (counts, driven, read)
        }
    };
    let mut blocks = vec![
        ComponentPart::InlineAxis(axis.follower),
        ComponentPart::PulseCounter,
        ComponentPart::Shaper(Box::new(axis.shaper.clone())),
        ComponentPart::StepGenerator(axis.steps),
    ];
    if let (Some(trace), Registers::With) = (axis.trace, registers) {
        blocks.push(ComponentPart::Trace(trace));
    }
    let blocks = blocks.into_iter().map(|block| (block.name().to_owned(), block));
    let [pin_a, pin_b] = input_pins(axis);
    let [line_a, line_b] = axis.steps.mode().line_names();
    let owned = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
    let outputs = [owned(&[line_a, line_b, "settled", "fault"]), owned(&CAUSES)].concat();
    let read: Vec<String> = read.into_iter().filter(|net| !outputs.contains(net)).collect();
    let outputs = outputs.into_iter();
    let wiring = Wiring {
        part: Box::new(|block, part| match block {
            ComponentPart::InlineAxis(_) => part
                .on("pin_a", &pin_a)
                .on("pin_b", &pin_b)
                .on("unshaped", "bypassed")
                .on("a", "counter_a")
                .on("b", "counter_b")
                .on("count", counts.input)
                .on("given", counts.given),
            ComponentPart::PulseCounter => counter(axis, part).on("count", counts.input),
            ComponentPart::Shaper(_) => match registers {
                Registers::Without => shaper(part),
                Registers::With => of_shaper(part).on("bank", "table_bank").on("refused", "table_refused"),
            },
            ComponentPart::StepGenerator(_) => part
                .on("enable", "follow")
                .on("tick", "control")
                .tied("clear_flags", 1)
                .on("a", line_a)
                .on("b", line_b)
                .on("count", counts.given)
                .on("owed", counts.owed),
            // The positions have changed at the tick: they stand while a row is taken.
            ComponentPart::Trace(_) => trace::connect(part, registers::TRACED_NETS.map(Some))
                .on("strobe", "control")
                .on("trigger_event", "follow"),
            _ => part,
        }),
        inputs: [owned(&SHARED_NETS), vec![pin_a.clone(), pin_b.clone()], driven].concat(),
        outputs: outputs.chain(read).collect(),
    };
    JoinedBlocks::new(&axis.name, blocks.collect(), wiring)
}

/// The pulse counter only counts: whatever measures a velocity is tied, and left out in synthesis.
fn counter(axis: &InlineShaperAxis, part: Part) -> Part {
    let tied = [
        "z",
        "a_n",
        "b_n",
        "z_n",
        "differential",
        "swap",
        "invert",
        "index_arm",
        "index_always",
        "index_presets",
        "index_gate",
        "preset",
        "preset_value",
        "tick",
        "time_stamp",
        "velocity_m",
        "smoothing",
        "timeout",
        "quotient_valid",
        "quotient",
    ];
    let part = tied.iter().fold(part, |part, port| part.tied(port, 0));
    part.tied("filter_clocks", axis.filter_clocks.into())
        .tied("mode", counter_mode(axis.input))
        .tied("clear_flags", 1)
        .on("a", "counter_a")
        .on("b", "counter_b")
        .on("position", "counter_position")
}

/// The shaper has its table in a ROM: no other is ever loaded.
fn shaper(part: Part) -> Part {
    let tied = [
        "tap_write",
        "tap_bank",
        "tap_index",
        "tap_coefficient",
        "tap_delay",
        "tap_read",
        "swap",
        "swap_bank",
        "swap_how",
    ];
    of_shaper(tied.iter().fold(part, |part, port| part.tied(port, 0)))
}

fn of_shaper(part: Part) -> Part {
    part.on("x_0", "x").on("y_0", "shaped").tied("clear_flags", 1)
}
