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
use super::bridged::{self, Bridged};
use super::component::Component;
use super::composition::Composed;
use super::{ClockedBlock, Port, StepError};

/// The ports of a stage with its bridge: inputs, then outputs.
pub fn ports(stage: &Component, config: &BridgeConfig) -> Vec<Port> {
    bridged::ports(stage, config.lines())
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
    stage: Bridged,
    ports: Vec<Port>,
    /// `avm_read` of the clock before.
    read_before: bool,
}

impl LinkedStage {
    /// A stage after reset. `config` has the line and the [`address_limit`]; `seed` determines the arbitrary contents of memories.
    pub fn new(stage: &Component, config: &BridgeConfig, seed: u64) -> Self {
        Self {
            bridge: Bridge::new(config),
            lines: inputs(config),
            stage: Bridged::new(stage, seed),
            ports: ports(stage, config),
            read_before: false,
        }
    }

    /// The stage.
    pub fn stage(&self) -> &Composed {
        self.stage.composed()
    }
}

impl ClockedBlock for LinkedStage {
    fn ports(&self) -> &[Port] {
        &self.ports
    }

    fn step(&mut self, inputs: &[u64], outputs: &mut [u64]) -> Result<(), StepError> {
        let wrong = || StepError(format!("{} inputs and {} outputs", inputs.len(), outputs.len()));
        let [rst, rest @ ..] = inputs else {
            return Err(wrong());
        };
        let (lines, pins) = rest.split_at_checked(self.lines).ok_or_else(wrong)?;
        let [line, to_pins @ ..] = outputs else {
            return Err(wrong());
        };
        let rst = *rst & 1 != 0;
        let asked = self.bridge.shown();
        let access = [
            asked.address.into(),
            asked.read.into(),
            asked.write.into(),
            0xf,
            asked.writedata.into(),
        ];
        let read_data = self.stage.step(rst, access, pins, to_pins)?;
        self.bridge.step(rst, lines, read_data, asked.read && !self.read_before);
        self.read_before = asked.read && !rst;
        *line = asked.line.into();
        Ok(())
    }

    fn composed(&self) -> Option<&Composed> {
        Some(self.stage())
    }
}
