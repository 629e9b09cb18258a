//! A stage whose registers a host operates through a serial line: the stage with its bridge.
//!
//! ```text
//!            ┌─────────────┐ avm_*      avs_* ┌───────┐
//! uart_rx ─► │ uart_bridge ├────────────────► │ stage ├─► pins of the axes
//! uart_tx ◄─ │             │ ◄─ waitrequest   │       │ ◄─
//!            └─────────────┘                  └───────┘
//! ```
//!
//! The registers answer in the clock after `avs_read`, so the bridge waits in the first clock of each read. It is the only host of the
//! bus: words are always written whole. Everything else is that of [`uart_bridge`](super::uart_bridge) and
//! [`stage`](super::stage); the datasheet is `docs/uart_bridge.md`.
//!
//! | ports | |
//! |---|---|
//! | `rst`, `uart_rx`, `uart_tx` | the bridge's |
//! | `irq`, all pins | the stage's; not its bus |

use super::component::Component;
use super::composition::Composed;
use super::uart_bridge::{UartBridge, UartBridgeConfig};
use super::{ClockedBlock, Direction, Port, StepError};

/// Prefix of the ports of the stage's bus.
const BUS_PREFIX: &str = "avs_";
/// Ports of the bus, which are the stage's inputs from 1 on.
const BUS_INPUTS: usize = 5;

/// The ports of a stage with its bridge: inputs, then outputs.
pub fn ports(stage: &Component) -> Vec<Port> {
    let bit = |name: &str, direction| Port {
        name: name.to_owned(),
        direction,
        width: 1,
        signed: false,
    };
    let own = stage
        .composition()
        .ports()
        .iter()
        .filter(|port| port.name != "rst" && !port.name.starts_with(BUS_PREFIX));
    let of = |wanted| {
        own.clone()
            .filter(move |port: &&Port| port.direction == wanted)
            .cloned()
    };
    let (input, output) = (Direction::Input, Direction::Output);
    let inputs = [bit("rst", input), bit("uart_rx", input)].into_iter().chain(of(input));
    let outputs = std::iter::once(bit("uart_tx", output)).chain(of(output));
    inputs.chain(outputs).collect()
}

/// Number of word addresses of a stage.
pub fn address_limit(stage: &Component) -> u16 {
    // A stage has at most five windows of 256 words.
    stage.map().words().try_into().unwrap_or(u16::MAX)
}

/// The cycle-accurate model.
pub struct LinkedStage {
    config: UartBridgeConfig,
    bridge: UartBridge,
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
    /// A stage after reset. `config` has the baud rate and the [`address_limit`]; `seed` determines the arbitrary contents of memories.
    pub fn new(stage: &Component, config: UartBridgeConfig, seed: u64) -> Self {
        let of_stage = stage.composition().ports();
        let count = |wanted| of_stage.iter().filter(|port| port.direction == wanted).count();
        let mut outputs = of_stage.iter().filter(|port| port.direction == Direction::Output);
        Self {
            config,
            bridge: UartBridge::new(),
            ports: ports(stage),
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
        let [rst, uart_rx, pins @ ..] = inputs else {
            return Err(StepError(format!("{} inputs", inputs.len())));
        };
        if pins.len() + 1 + BUS_INPUTS != self.stage_inputs.len() || outputs.len() != self.stage_outputs.len() {
            return Err(StepError(format!(
                "{} inputs and {} outputs",
                inputs.len(),
                outputs.len()
            )));
        }
        let rst = *rst & 1 != 0;
        let idle = self.config.inputs();
        let asked = self.bridge.outputs(&idle);
        let bus = [
            u64::from(rst),
            asked.avm_address.into(),
            asked.avm_read.into(),
            asked.avm_write.into(),
            0xf,
            asked.avm_writedata.into(),
        ];
        self.stage_inputs[..bus.len()].copy_from_slice(&bus);
        self.stage_inputs[bus.len()..].copy_from_slice(pins);
        self.stage.step(&self.stage_inputs, &mut self.stage_outputs)?;
        self.bridge.step(&super::uart_bridge::Inputs {
            rst,
            uart_rx: *uart_rx & 1 != 0,
            avm_readdata: self.stage_outputs[self.read_data] as u32,
            avm_waitrequest: asked.avm_read && !self.read_before,
            ..idle
        });
        self.read_before = asked.avm_read && !rst;
        outputs[0] = asked.uart_tx.into();
        let shown = self.stage_outputs.iter().enumerate();
        let shown = shown.filter(|(place, _)| *place != self.read_data);
        outputs[1..]
            .iter_mut()
            .zip(shown)
            .for_each(|(output, (_, value))| *output = *value);
        Ok(())
    }
}
