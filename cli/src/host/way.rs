//! The connections to a stage, as the first argument of `posicast host` names them.

use posicast_flow::Failure;
#[cfg(target_os = "linux")]
use posicast_host::SpiLine;
use posicast_host::{Line, Link, LinkError, LinkOptions, UdpLine};
use posicast_machine::machine_file::{LinkLine, LinkSection, Machine};
use std::path::Path;

/// Prefix of the name of an SPI device.
const SPI: &str = "spi://";
/// Prefix of the clock after the device.
const SPI_CLOCK: &str = "?hz=";
/// Prefix of the address of a server.
const UDP: &str = "udp://";

/// The connection to the stage.
pub(super) enum Way<'a> {
    /// Port and baud rate.
    Serial(&'a str, u32),
    /// SPI device and clock in Hz.
    Spi(&'a str, u32),
    /// Address of a server.
    Network(&'a str),
}

impl<'a> Way<'a> {
    /// Returns the connection for a port, with the baud rate of the arguments, if they have one. `path` is the machine
    /// file.
    pub(super) fn of((port, baud): (&'a str, Option<u32>), machine: &Machine, path: &Path) -> Result<Self, Failure> {
        let (spi, udp) = (port.strip_prefix(SPI), port.strip_prefix(UDP));
        if baud.is_some() && (spi.is_some() || udp.is_some()) {
            return Err(refused("leave it out", format!("--baud: {port} is not a serial line")));
        }
        if let Some(address) = udp {
            let (host, number) = address.rsplit_once(':').unwrap_or_default();
            if host.is_empty() || number.parse::<u16>().is_err() {
                return Err(refused(
                    "write udp://HOST:PORT",
                    format!("{port}: this is not the address of a server"),
                ));
            }
            return Ok(Self::Network(address));
        }
        if port.is_empty() || (spi.is_none() && port.contains("://")) {
            return Err(refused(
                "write spi:///dev/spidev0.0, udp://HOST:PORT, or a serial port such as /dev/ttyUSB0",
                format!("`{port}`: this is neither a serial port, an SPI device nor a UDP address"),
            ));
        }
        let file = path.display();
        let Some(link) = machine.link else {
            return Err(refused(
                "add [link] with `baud = 921_600` (or `line = \"spi\"` and its sck_hz), then generate and build the hardware anew",
                format!("{file}: the machine has no [link]: its hardware has no line to a host"),
            ));
        };
        match (spi, link.line) {
            (None, LinkLine::Uart { baud: of_file }) => Ok(Self::Serial(port, baud.unwrap_or(of_file))),
            (Some(device), LinkLine::Spi { sck_hz }) => Self::spi((port, device), (&link, sck_hz), machine),
            (Some(_), LinkLine::Uart { .. }) => Err(refused(
                "give the serial port, such as /dev/ttyUSB0",
                format!("{port}: the hardware of {file} has a serial line, not SPI"),
            )),
            (None, LinkLine::Spi { .. }) => Err(refused(
                "give the SPI device, such as spi:///dev/spidev0.0",
                format!("{port}: the hardware of {file} has SPI, not a serial line"),
            )),
        }
    }

    /// Parses an SPI device, whose name may be followed by a clock; otherwise the clock of the machine file is used.
    fn spi(
        (port, name): (&str, &'a str),
        (link, sck_hz): (&LinkSection, u32),
        machine: &Machine,
    ) -> Result<Self, Failure> {
        let (device, clock) = match name.split_once(SPI_CLOCK) {
            Some((device, clock)) => (device, Some(clock)),
            None => (name, None),
        };
        if !device.starts_with('/') || device.contains('?') {
            return Err(refused(
                "write spi:///dev/spidev0.0 (three slashes), or spi:///dev/spidev0.0?hz=1000000",
                format!("{port}: this is not the name of an SPI device"),
            ));
        }
        let Some(clock) = clock else {
            return Ok(Self::Spi(device, sck_hz));
        };
        let range = link.sck_range(&machine.clock);
        match clock.replace('_', "").parse() {
            Ok(hz) if range.contains(&hz) => Ok(Self::Spi(device, hz)),
            _ => Err(refused(
                "give a clock in this range, or leave it out for that of the machine file",
                format!(
                    "{port}: hz must be a whole number from {} (two bytes within link.timeout_s) to {} (an eighth of the machine's clock)",
                    range.start(),
                    range.end()
                ),
            )),
        }
    }

    /// What to check if there is no reply, or the line fails.
    pub(super) fn remedy(&self) -> String {
        match self {
            Self::Serial(..) => {
                "use the baud rate of the machine file from which the FPGA was built; connect the adapter's transmitter to uart_rx, and \
                 its receiver to uart_tx"
                    .to_owned()
            }
            Self::Spi(device, sck_hz) => format!(
                "connect spi_cs_n to the chip select of {device}, spi_mosi to MOSI and spi_miso to MISO, not crossed; try a slower \
                 clock, such as {SPI}{device}{SPI_CLOCK}{}",
                sck_hz / 10
            ),
            Self::Network(address) => format!("posicast_serve must run at {address}, and the stage behind it must have a clock"),
        }
    }

    /// Opens it.
    pub(super) fn open(&self, options: LinkOptions) -> Result<Link<Box<dyn Line>>, LinkError> {
        let line: Box<dyn Line> = match self {
            Self::Serial(port, baud) => Box::new(Link::open(port, *baud, options)?.into_line()),
            #[cfg(target_os = "linux")]
            Self::Spi(device, sck_hz) => Box::new(SpiLine::open(device, *sck_hz)?),
            #[cfg(not(target_os = "linux"))]
            Self::Spi(device, _) => {
                return Err(LinkError::Spi {
                    device: (*device).to_owned(),
                    reason: "posicast supports SPI devices on Linux only".to_owned(),
                    remedy: "operate the stage from a computer with Linux",
                });
            }
            Self::Network(address) => Box::new(UdpLine::open(address, options)?),
        };
        Ok(Link::new(line, options))
    }
}

impl std::fmt::Display for Way<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Serial(port, baud) => write!(f, "{port}, {baud} baud"),
            Self::Spi(device, sck_hz) => write!(f, "{SPI}{device}, {sck_hz} Hz"),
            Self::Network(address) => write!(f, "{UDP}{address}"),
        }
    }
}

/// Refuses arguments that do not suit the machine.
fn refused(help: &str, text: String) -> Failure {
    Failure::input(text).with_help(help)
}
