//! The bridge of either line, with its constants.

use super::super::spi_bridge::{self, SpiBridge, SpiBridgeConfig};
use super::super::uart_bridge::{self, UartBridge, UartBridgeConfig};
use super::super::{Direction, Port};

/// The constants of a bridge, by the kind of its line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BridgeConfig {
    /// A serial line.
    Uart(UartBridgeConfig),
    /// SPI.
    Spi(SpiBridgeConfig),
}

impl BridgeConfig {
    /// Name of the block.
    pub fn block(&self) -> &'static str {
        match self {
            Self::Uart(_) => "uart_bridge",
            Self::Spi(_) => "spi_bridge",
        }
    }

    /// Name of its line.
    pub fn line(&self) -> &'static str {
        match self {
            Self::Uart(_) => "serial line",
            Self::Spi(_) => "SPI lines",
        }
    }

    /// Speed of its line, for those who connect a host: name, value and meaning.
    pub fn speed(&self) -> (&'static str, u32, &'static str) {
        match self {
            Self::Uart(config) => (
                "baud",
                config.baud(),
                "bits per second: 8 data bits, no parity, 1 stop bit",
            ),
            Self::Spi(config) => (
                "most_sck_hz",
                u32::try_from(config.most_sck_hz()).unwrap_or(u32::MAX),
                "fastest spi_sck in Hz, mode 0: an eighth of the clock",
            ),
        }
    }

    /// The ports of the block.
    pub fn ports(&self) -> Vec<Port> {
        match self {
            Self::Uart(_) => uart_bridge::ports(),
            Self::Spi(_) => spi_bridge::ports(),
        }
    }

    /// The ports of the line: inputs, then the output.
    pub fn lines(&self) -> Vec<Port> {
        let of_line = |port: &Port| port.name.starts_with("uart_") || port.name.starts_with("spi_");
        let mut ports = self.ports();
        ports.retain(of_line);
        ports
    }

    /// Values of the constant inputs.
    pub fn constants(&self) -> Vec<(&'static str, u32)> {
        match self {
            Self::Uart(config) => vec![
                ("baud_step", config.baud_step()),
                ("silence_limit", config.silence_limit()),
                ("address_limit", config.address_limit().into()),
            ],
            Self::Spi(config) => vec![
                ("silence_limit", config.silence_limit()),
                ("address_limit", config.address_limit().into()),
            ],
        }
    }

    /// Addresses below it exist.
    pub fn address_limit(&self) -> u16 {
        match self {
            Self::Uart(config) => config.address_limit(),
            Self::Spi(config) => config.address_limit(),
        }
    }
}

/// Outputs of a bridge in a clock.
pub(super) struct Shown {
    pub(super) line: bool,
    pub(super) address: u16,
    pub(super) read: bool,
    pub(super) write: bool,
    pub(super) writedata: u32,
}

/// A bridge, and its inputs while the line and the bus are idle.
pub(super) enum Bridge {
    Uart(UartBridge, uart_bridge::Inputs),
    Spi(SpiBridge, spi_bridge::Inputs),
}

impl Bridge {
    pub(super) fn new(config: &BridgeConfig) -> Self {
        match config {
            BridgeConfig::Uart(config) => Self::Uart(UartBridge::new(), config.inputs()),
            BridgeConfig::Spi(config) => Self::Spi(SpiBridge::new(), config.inputs()),
        }
    }

    pub(super) fn shown(&self) -> Shown {
        match self {
            Self::Uart(bridge, idle) => {
                let outputs = bridge.outputs(idle);
                Shown {
                    line: outputs.uart_tx,
                    address: outputs.avm_address,
                    read: outputs.avm_read,
                    write: outputs.avm_write,
                    writedata: outputs.avm_writedata,
                }
            }
            Self::Spi(bridge, idle) => {
                let outputs = bridge.outputs(idle);
                Shown {
                    line: outputs.spi_miso,
                    address: outputs.avm_address,
                    read: outputs.avm_read,
                    write: outputs.avm_write,
                    writedata: outputs.avm_writedata,
                }
            }
        }
    }

    /// Simulates a clock with these levels of the line's inputs.
    pub(super) fn step(&mut self, rst: bool, lines: &[u64], avm_readdata: u32, avm_waitrequest: bool) {
        let level = |line: usize| lines.get(line).is_some_and(|level| level & 1 != 0);
        match self {
            Self::Uart(bridge, idle) => {
                bridge.step(&uart_bridge::Inputs {
                    rst,
                    uart_rx: level(0),
                    avm_readdata,
                    avm_waitrequest,
                    ..*idle
                });
            }
            Self::Spi(bridge, idle) => {
                bridge.step(&spi_bridge::Inputs {
                    rst,
                    spi_sck: level(0),
                    spi_cs_n: level(1),
                    spi_mosi: level(2),
                    avm_readdata,
                    avm_waitrequest,
                    ..*idle
                });
            }
        }
    }
}

/// Number of the line's inputs.
pub(super) fn inputs(config: &BridgeConfig) -> usize {
    let lines = config.lines();
    lines.iter().filter(|port| port.direction == Direction::Input).count()
}
