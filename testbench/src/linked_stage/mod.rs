//! The benches of a stage, or of an inline shaper, with its line, whose stimuli are a driver at the line, and lines and encoders at the
//! pins.
//!
//! | row | constants |
//! |---|---|
//! | [`LinkedStageBlock`] | those of the machine: its baud rate, its ticks |
//! | [`DenseLinkBlock`] | the fastest line that the bridge receives, 8 clocks per bit, and the shortest ticks of the schedule |
//!
//! At 3,000,000 baud and 50 MHz a driver writes some 700 words in a million clocks, and the stage has 200 ticks. The dense row has as many
//! scenes as the row of the stage on its bus.

pub(crate) mod inline;
pub(crate) mod stimuli;

pub use self::stimuli::LinkedStageRandom;

use posicast_blocks::component::Component;
use posicast_blocks::inline_shaper::{InlineConfig, InlineError};
use posicast_blocks::linked_stage::{BridgeConfig, LinkedStage, ports};
use posicast_blocks::stage::{StageConfig, StageError};
use posicast_blocks::uart_bridge::UartBridgeConfig;
use posicast_blocks::{ClockedBlock, Direction};
use posicast_hdl::SimulationError;
use posicast_hdl::emit::{EmitError, Module};
use posicast_hdl::linked_stage::emit;

use crate::Error;
use crate::blocks::changes::Changes;
use crate::blocks::levels::Levels;
use crate::blocks::reached::InsideAStage;
use crate::blocks::{Bins, Block, Exercise, Reach, Sources, inside, not_in_rusthdl};
use crate::inline_shaper::stimuli::first_acts_clocks;
use crate::spi_bridge::SpiBridgeBlock;
use crate::stage::FEW_TICKS_BARS;
use crate::stage::short_ticks::{adapted, pairs, shortened};
use crate::stimuli::Stimuli;
use crate::uart_bridge::UartBridgeBlock;

/// Number of bytes on the line that a run must have at least.
const LEAST_BYTES: f64 = 1000.0;
/// Ticks that the first scene takes to start a move, in addition to those in which the brake opens.
const MOVE_TICKS: u64 = 60;
/// A run at the machine's own ticks waits at most this many ticks for a brake to open.
const MOST_BRAKE_TICKS: u64 = 20;
/// Clocks in which every tried seed of the dense row moved each axis and loaded a table.
const DENSE_LEAST_CLOCKS: u64 = 300_000;
/// Bars of the dense row: moves and taps of each axis, and per cent of the registers. The write to every register already counts as one
/// tap, so two prove that a table was loaded. In its least clocks the row wrote 71 words (67 are writable, some writes went to random
/// addresses) and read 63 to 65 of 98 registers as words other than 0.
const DENSE_BARS: [u64; 3] = [1, 2, 60];
/// The fastest serial line: a baud rate and a clock with eight clocks per bit, and a time-out in seconds.
const FASTEST: (u64, u32, f64) = (24_000_000, 3_000_000, 0.01);

/// A stage with its line, and the names of its modules.
#[derive(Debug, Clone)]
pub struct LinkedStageBlock {
    stage: Component,
    config: BridgeConfig,
    clock_hz: f64,
    axes: Vec<String>,
    instance: String,
    names: [String; 3],
    /// Ticks in which the slowest brake opens.
    brake_ticks: u64,
    tick_clocks: u64,
    /// The inline shaper that is in the place of a stage.
    inline: Option<InlineConfig>,
}

impl LinkedStageBlock {
    /// Creates the top `names[0]` with the inline shaper `names[1]`, which has these settings and this checksum of its machine file;
    /// modules whose contents depend on the machine begin with `names[2]`.
    ///
    /// # Errors
    /// As [`Component::inline_shaper`].
    pub fn of_inline(
        (shaper, machine_crc): (&InlineConfig, Option<u32>),
        (config, clock_hz): (BridgeConfig, f64),
        names: [&str; 3],
    ) -> Result<Self, InlineError> {
        let axes: Vec<String> = shaper.axes.iter().map(|axis| axis.name.clone()).collect();
        Ok(Self {
            instance: format!("{}, {} without time-outs", axes.join(", "), config.line()),
            stage: Component::inline_shaper(shaper, machine_crc)?,
            config,
            clock_hz,
            axes,
            names: names.map(str::to_owned),
            brake_ticks: 0,
            tick_clocks: shaper.tick.tick_clocks().into(),
            inline: Some(shaper.for_any_table()),
        })
    }

    /// The inline shaper or the stage, with its registers.
    pub fn component(&self) -> &Component {
        &self.stage
    }

    /// Name of the module of the stage or the inline shaper.
    pub fn inside(&self) -> &str {
        &self.names[1]
    }

    /// The blocks in the inline shaper or the stage, each alone.
    ///
    /// # Errors
    /// As [`crate::shaper::ShaperBlock::new`].
    pub fn inner(&self) -> Result<Vec<Box<dyn Block>>, Error> {
        let instance = match self.inline {
            Some(_) => "in the inline shaper",
            None => "in the stage",
        };
        inside::of_joined(self.stage.whole(), &self.names[2], instance)
    }

    /// Creates the top `names[0]` with the stage `names[1]`, which has these settings; modules whose contents depend on the machine begin
    /// with `names[2]`.
    ///
    /// # Errors
    /// As [`Component::stage`].
    pub fn new(
        stage: &StageConfig,
        (config, clock_hz): (BridgeConfig, f64),
        names: [&str; 3],
    ) -> Result<Self, StageError> {
        let axes: Vec<String> = stage.axes.iter().map(|axis| axis.name.clone()).collect();
        let brakes = stage.axes.iter().map(|axis| axis.supervision.brake_release_ticks);
        Ok(Self {
            instance: format!("{}, {} without time-outs", axes.join(", "), config.line()),
            stage: Component::stage(stage)?,
            config,
            clock_hz,
            axes,
            names: names.map(str::to_owned),
            brake_ticks: brakes.max().unwrap_or(0).into(),
            tick_clocks: stage.tick.tick_clocks().into(),
            inline: None,
        })
    }

    /// The constants of its bridge.
    pub fn config(&self) -> &BridgeConfig {
        &self.config
    }

    /// The bridge alone, with the modules of the machine.
    pub fn bridge(&self) -> Box<dyn Block> {
        let (prefix, instance) = (self.names[2].as_str(), "in the link");
        match self.config {
            BridgeConfig::Uart(_) => Box::new(UartBridgeBlock::new(prefix, instance)),
            BridgeConfig::Spi(_) => Box::new(SpiBridgeBlock::new(prefix, instance)),
        }
    }

    fn waits_for_a_move(&self) -> bool {
        self.brake_ticks <= MOST_BRAKE_TICKS
    }

    fn driver(&self, with_borders: bool, seed: u64) -> LinkedStageRandom {
        let line = (&self.config, self.clock_hz);
        let pins = match &self.inline {
            Some(config) => inline::pins(config, self.stage.map(), seed),
            None => stimuli::pins(&self.stage, &self.axes, seed),
        };
        LinkedStageRandom::new((&self.stage, pins), &self.axes, line, with_borders, seed)
    }

    fn reach_with(&self, bars: [u64; 3]) -> InsideAStage {
        InsideAStage::new(&self.instance, &self.axes, self.stage.map(), bars)
    }
}

impl Block for LinkedStageBlock {
    fn name(&self) -> &str {
        match self.inline {
            Some(_) => "linked_inline_shaper",
            None => "linked_stage",
        }
    }

    fn instance(&self) -> &str {
        &self.instance
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        let [top, stage, prefix] = &self.names;
        emit(&self.stage, &self.config, (top, stage, prefix))
    }

    fn top(&self) -> String {
        self.names[0].clone()
    }

    fn model(&self, seed: u64) -> Box<dyn ClockedBlock> {
        Box::new(LinkedStage::new(&self.stage, &self.config, seed))
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        Err(not_in_rusthdl("linked_stage"))
    }

    fn in_rusthdl(&self) -> bool {
        false
    }

    fn stimuli(&self, _cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        Box::new(self.driver(false, seed))
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        let ports = ports(&self.stage, &self.config);
        match &self.inline {
            Some(config) => Box::new(inline::InlineChanges::new(config, &ports)),
            None => Box::new(Changes::new(&ports)),
        }
    }

    fn least_clocks(&self) -> u64 {
        let line = (LEAST_BYTES * LinkedStageRandom::byte_clocks(&self.config, self.clock_hz)) as u64;
        if let Some(config) = &self.inline {
            return line.max(first_acts_clocks(config));
        }
        if self.waits_for_a_move() {
            line.max((self.brake_ticks + MOVE_TICKS) * self.tick_clocks)
        } else {
            line
        }
    }

    /// A move of each axis, unless its brake opens too late: then the dense row has it.
    fn reach(&self) -> Box<dyn Reach + '_> {
        let [_, taps, per_cent] = FEW_TICKS_BARS;
        if self.inline.is_some() {
            return Box::new(InsideAStage::of_inline(
                &self.instance,
                &self.axes,
                self.stage.map(),
                [inline::LEAST_TAPS, per_cent],
            ));
        }
        Box::new(self.reach_with([self.waits_for_a_move().into(), taps, per_cent]))
    }

    /// Only the line: the dense row and the stage's own rows exercise the pins. Time-outs are as long as a run; the bench of the bridge
    /// has them.
    fn exercise(&self) -> Option<Box<dyn Exercise + '_>> {
        let mut ports = ports(&self.stage, &self.config);
        ports.retain(|port| port.direction == Direction::Output);
        Some(Box::new(Levels::new(&self.instance, &ports[..1], &[])))
    }
}

/// A stage with its line, on the machine's Verilog with other constants: a line and ticks that are as fast as they can be.
#[derive(Debug, Clone)]
pub struct DenseLinkBlock {
    machine: LinkedStageBlock,
    dense: LinkedStageBlock,
}

impl DenseLinkBlock {
    /// Creates the dense row of a stage with these settings and its line; `None` if other constants would change the list of modules.
    ///
    /// # Errors
    /// As [`Component::stage`].
    pub fn new(stage: &StageConfig, machine: &LinkedStageBlock) -> Result<Option<Self>, StageError> {
        let short = shortened(stage).unwrap_or_else(|| stage.clone());
        let (clock_hz, baud, silence_s) = FASTEST;
        let line = match machine.config {
            BridgeConfig::Uart(config) => {
                let fastest = UartBridgeConfig::new(clock_hz, baud, silence_s, config.address_limit());
                (BridgeConfig::Uart(fastest.unwrap_or(config)), clock_hz as f64)
            }
            config @ BridgeConfig::Spi(_) => (config, machine.clock_hz),
        };
        let names = machine.names.each_ref().map(String::as_str);
        let mut dense = LinkedStageBlock::new(&short, line, names)?;
        dense.instance = format!(
            "{}, {} clocks per byte, {} per tick",
            dense.instance,
            LinkedStageRandom::byte_clocks(&dense.config, dense.clock_hz),
            short.tick.tick_clocks()
        );
        // A stage that cannot be emitted is an error of the machine's own row.
        let count = |block: &LinkedStageBlock| block.modules().map(|modules| modules.len()).ok();
        let fits = count(machine) == count(&dense);
        Ok(fits.then(|| Self {
            machine: machine.clone(),
            dense,
        }))
    }
}

impl Block for DenseLinkBlock {
    fn name(&self) -> &str {
        self.dense.name()
    }

    fn instance(&self) -> &str {
        &self.dense.instance
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        self.dense.modules()
    }

    fn top(&self) -> String {
        self.dense.top()
    }

    fn adapted(&self, sources: Sources) -> Result<Sources, Error> {
        adapted(&sources, &pairs(&self.machine, &self.dense)?)
    }

    fn model(&self, seed: u64) -> Box<dyn ClockedBlock> {
        self.dense.model(seed)
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        self.dense.simulate()
    }

    fn in_rusthdl(&self) -> bool {
        false
    }

    fn stimuli(&self, _cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        Box::new(self.dense.driver(true, seed))
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        self.dense.coverage()
    }

    fn least_clocks(&self) -> u64 {
        DENSE_LEAST_CLOCKS
    }

    fn reach(&self) -> Box<dyn Reach + '_> {
        Box::new(self.dense.reach_with(DENSE_BARS))
    }
}
