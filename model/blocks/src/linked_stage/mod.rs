//! A stage, or an inline shaper, whose registers a host operates through a line: the component with its bridge.
//!
//! ```text
//!                ┌─────────────┐ avm_*      avs_* ┌───────┐
//! uart_rx     ─► │ uart_bridge ├────────────────► │ stage ├─► pins of the axes
//! uart_tx     ◄─ │             │ ◄─ waitrequest   │       │ ◄─
//! or spi_*       │ spi_bridge  │                  │       │
//!                └─────────────┘                  └───────┘
//! ```
//!
//! The registers answer in the clock after `avs_read`, so the bridge waits in the first clock of each read. It is the only host of the
//! bus: words are always written whole. Everything else is that of [`uart_bridge`](super::uart_bridge) or
//! [`spi_bridge`](super::spi_bridge), and [`stage`](super::stage); the datasheets are theirs.
//!
//! | ports | |
//! |---|---|
//! | `rst`, and `uart_rx`, `uart_tx` or `spi_sck`, `spi_cs_n`, `spi_mosi`, `spi_miso` | the bridge's |
//! | `irq`, all pins | the stage's; not its bus |
//!
//! An inline shaper with registers takes the place of the stage: [`Component::inline_shaper`].

mod bridge;

pub use bridge::BridgeConfig;

use self::bridge::{Bridge, inputs};
use super::component::Component;
use super::composition::Composed;
use super::{ClockedBlock, Direction, Port, StepError};

/// Prefix of the ports of the stage's bus.
const BUS_PREFIX: &str = "avs_";
/// Ports of the bus, which are the stage's inputs from 1 on.
const BUS_INPUTS: usize = 5;

/// The ports of a stage with its bridge: inputs, then outputs.
pub fn ports(stage: &Component, config: &BridgeConfig) -> Vec<Port> {
    let rst = Port {
        name: "rst".to_owned(),
        direction: Direction::Input,
        width: 1,
        signed: false,
    };
    let of_stage = stage.composition().ports().iter();
    let pins = of_stage.filter(|port| port.name != "rst" && !port.name.starts_with(BUS_PREFIX));
    let all: Vec<Port> = std::iter::once(rst)
        .chain(config.lines())
        .chain(pins.cloned())
        .collect();
    let (inputs, outputs): (Vec<_>, Vec<_>) = all.into_iter().partition(|port| port.direction == Direction::Input);
    inputs.into_iter().chain(outputs).collect()
}

/// Number of word addresses of a stage.
pub fn address_limit(stage: &Component) -> u16 {
    // A stage has at most five windows of 256 words.
    stage.map().words().try_into().unwrap_or(u16::MAX)
}

/// The cycle-accurate model.
pub struct LinkedStage {
    bridge: Bridge,
    /// Number of inputs of its line.
    lines: usize,
    stage: Composed,
    ports: Vec<Port>,
    /// `avm_read` of the clock before.
    read_before: bool,
    stage_inputs: Vec<u64>,
    stage_outputs: Vec<u64>,
    /// Place of `avs_readdata` among the stage's outputs.
    read_data: usize,
}

impl LinkedStage {
    /// A stage after reset. `config` has the line and the [`address_limit`]; `seed` determines the arbitrary contents of memories.
    pub fn new(stage: &Component, config: &BridgeConfig, seed: u64) -> Self {
        let of_stage = stage.composition().ports();
        let count = |wanted| of_stage.iter().filter(|port| port.direction == wanted).count();
        let mut outputs = of_stage.iter().filter(|port| port.direction == Direction::Output);
        Self {
            bridge: Bridge::new(config),
            lines: inputs(config),
            ports: ports(stage, config),
            read_before: false,
            stage_inputs: vec![0; count(Direction::Input)],
            stage_outputs: vec![0; count(Direction::Output)],
            read_data: outputs.position(|port| port.name == "avs_readdata").unwrap_or(0),
            stage: stage.model(seed),
        }
    }

    /// The stage.
    pub fn stage(&self) -> &Composed {
        &self.stage
    }
}

impl ClockedBlock for LinkedStage {
    fn ports(&self) -> &[Port] {
        &self.ports
    }

    fn step(&mut self, inputs: &[u64], outputs: &mut [u64]) -> Result<(), StepError> {
        let wrong = || StepError(format!("{} inputs", inputs.len()));
        let [rst, rest @ ..] = inputs else {
            return Err(wrong());
        };
        let (lines, pins) = rest.split_at_checked(self.lines).ok_or_else(wrong)?;
        if pins.len() + 1 + BUS_INPUTS != self.stage_inputs.len() || outputs.len() != self.stage_outputs.len() {
            return Err(StepError(format!(
                "{} inputs and {} outputs",
                inputs.len(),
                outputs.len()
            )));
        }
        let rst = *rst & 1 != 0;
        let asked = self.bridge.shown();
        let bus = [
            u64::from(rst),
            asked.address.into(),
            asked.read.into(),
            asked.write.into(),
            0xf,
            asked.writedata.into(),
        ];
        self.stage_inputs[..bus.len()].copy_from_slice(&bus);
        self.stage_inputs[bus.len()..].copy_from_slice(pins);
        self.stage.step(&self.stage_inputs, &mut self.stage_outputs)?;
        let read_data = self.stage_outputs[self.read_data] as u32;
        self.bridge.step(rst, lines, read_data, asked.read && !self.read_before);
        self.read_before = asked.read && !rst;
        outputs[0] = asked.line.into();
        let shown = self.stage_outputs.iter().enumerate();
        let shown = shown.filter(|(place, _)| *place != self.read_data);
        outputs[1..]
            .iter_mut()
            .zip(shown)
            .for_each(|(output, (_, value))| *output = *value);
        Ok(())
    }

    fn composed(&self) -> Option<&Composed> {
        Some(&self.stage)
    }
}
