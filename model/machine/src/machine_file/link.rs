//! `[link]`: the line, serial or SPI, through which a host reads and writes the registers of the stage or the inline shaper.

use super::ClockSection;
use super::hint::written;
use super::key::{Default, Key, Values};
use super::range::NumberRange;
use super::table::Table;
use posicast_blocks::linked_stage::BridgeConfig;
use posicast_blocks::spi_bridge::{LEAST_CLOCKS_PER_BIT, SpiBridgeConfig, SpiBridgeConfigError};
use posicast_blocks::uart_bridge::{BAUD, UartBridgeConfig, UartBridgeConfigError};
use std::ops::RangeInclusive;

/// The words of `line`.
const UART: &str = "uart";
const SPI: &str = "spi";
/// Clocks of an SPI host in Hz; the clock of the machine limits them further.
const SCK_HZ: RangeInclusive<u32> = 100_000..=50_000_000;
/// Bits of two bytes, the shortest time-out with SPI.
const LEAST_SPI_TIMEOUT_BITS: f64 = 16.0;
/// Range of time-outs; the line limits them further.
const TIMEOUT_S: NumberRange = NumberRange::positive(MOST_TIMEOUT_S).unit("s");
const MOST_TIMEOUT_S: f64 = 1.2;
/// Time-out of a file that gives none.
const DEFAULT_TIMEOUT_S: f64 = 0.01;
/// Baud rates that the ports of hosts usually have, within [`BAUD`].
const USUAL_BAUD: [u32; 9] = [
    115_200, 230_400, 460_800, 500_000, 921_600, 1_000_000, 1_500_000, 2_000_000, 3_000_000,
];

/// `[link]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinkSection {
    /// The line, and its speed.
    pub line: LinkLine,
    /// Time-out in s: the bridge drops a frame whose next byte takes this long. Default 0.01.
    pub timeout_s: f64,
    /// CRC-32 (IEEE 802.3, as in `zlib`) of the machine file, followed by the files beside it that it names, each once. The stage, or
    /// the inline shaper, has it in a register, so that a host can tell whether it has the machine file of the hardware.
    pub machine_crc: u32,
}

/// The line of a link.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LinkLine {
    /// A serial line.
    Uart {
        /// Baud rate, 115,200 to 3,000,000. The clock makes it within 2 %.
        baud: u32,
    },
    /// SPI, with the host as its controller.
    Spi {
        /// Clock of the host in Hz, at most an eighth of that of the machine.
        sck_hz: u32,
    },
}

/// Why a bridge cannot be built.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum BridgeConfigError {
    /// The serial line's.
    #[error(transparent)]
    Uart(#[from] UartBridgeConfigError),
    /// That of SPI.
    #[error(transparent)]
    Spi(#[from] SpiBridgeConfigError),
}

impl LinkSection {
    /// The constants of the bridge at this clock, for registers with word addresses below `address_limit`.
    ///
    /// # Errors
    /// [`BridgeConfigError`], which the machine file's validation rules out.
    pub fn bridge(&self, clock: &ClockSection, address_limit: u16) -> Result<BridgeConfig, BridgeConfigError> {
        let clock_hz = clock.frequency_hz.round() as u64;
        Ok(match self.line {
            LinkLine::Uart { baud } => {
                BridgeConfig::Uart(UartBridgeConfig::new(clock_hz, baud, self.timeout_s, address_limit)?)
            }
            LinkLine::Spi { .. } => BridgeConfig::Spi(SpiBridgeConfig::new(clock_hz, self.timeout_s, address_limit)?),
        })
    }

    /// Clocks in Hz that a host at the SPI lines may have, at this clock of the machine: two bytes must fit into the time-out.
    pub fn sck_range(&self, clock: &ClockSection) -> RangeInclusive<u32> {
        let least = (LEAST_SPI_TIMEOUT_BITS / self.timeout_s).ceil() as u32;
        least.max(*SCK_HZ.start())..=most_sck_hz(clock)
    }

    /// Time of a byte on the line in s.
    pub fn byte_s(&self) -> f64 {
        match self.line {
            LinkLine::Uart { baud } => 10.0 / f64::from(baud),
            LinkLine::Spi { sck_hz } => 8.0 / f64::from(sck_hz),
        }
    }
}

/// The keys of the table.
pub(super) const KEYS: &[Key] = &[
    Key::new(
        "line",
        Values::Word(|| vec![UART, SPI]),
        "Line to the host: `uart` (serial), or `spi` (mode 0, the host is the controller).",
    )
    .default(Default::Word(UART)),
    Key::new(
        "baud",
        Values::Integer(*BAUD.start(), *BAUD.end()),
        "Baud rate, 8N1. The clock must make it within 2 %.",
    )
    .rule("any from a clock of 23.53 MHz on")
    .chosen_by("line", UART),
    Key::new(
        "sck_hz",
        Values::Integer(*SCK_HZ.start(), *SCK_HZ.end()),
        "SPI clock of the host, at most an eighth of the machine's.",
    )
    .instead_of("baud")
    .chosen_by("line", SPI),
    Key::new(
        "timeout_s",
        Values::Number(TIMEOUT_S),
        "Longest pause within a frame: serial 20 to 131,071 bits; SPI two bytes or more, 2560 to 67,108,800 clocks.",
    )
    .default(Default::Number(DEFAULT_TIMEOUT_S)),
];

/// Reads the table. The checksum is not set yet.
pub(super) fn read(table: &Table<'_, '_>, clock: Option<ClockSection>) -> Option<LinkSection> {
    table.allow(KEYS);
    let word = if table.has("line") {
        table.choice("line", &[UART, SPI])
    } else {
        Some(UART)
    };
    let line = match word {
        Some(UART) => read_uart(table),
        Some(_) => read_spi(table, clock),
        None => None,
    };
    let timeout_s = if table.has("timeout_s") {
        table.number("timeout_s", TIMEOUT_S)
    } else {
        Some(DEFAULT_TIMEOUT_S)
    };
    // Every problem is reported before the first ends this.
    let (line, timeout_s) = (line?, timeout_s?);
    let section = LinkSection {
        line,
        timeout_s,
        machine_crc: 0,
    };
    // Without a clock, the file has a problem already.
    let clock = clock?;
    if let LinkLine::Spi { sck_hz } = line
        && section.sck_range(&clock).start() > &sck_hz
    {
        table.refuse(
            "timeout_s",
            format_args!(
                "at least two bytes, {:.1e} s at sck_hz = {sck_hz}",
                2.0 * section.byte_s()
            ),
            "give a time of at least two bytes, or a faster sck_hz",
        );
        return None;
    }
    let (shortest, longest, at) = match section.bridge(&clock, 0) {
        Ok(_) => return Some(section),
        Err(BridgeConfigError::Uart(UartBridgeConfigError::Silence {
            shortest,
            longest,
            baud,
            ..
        })) => (shortest, longest, format!("{baud} baud")),
        Err(BridgeConfigError::Spi(error)) => (
            error.shortest,
            error.longest,
            format!("a clock of {} Hz", error.clock_hz),
        ),
        Err(BridgeConfigError::Uart(error)) => {
            let (allowed, remedy) = slower(&error);
            table.refuse("baud", allowed, remedy);
            return None;
        }
    };
    let other = match line {
        LinkLine::Uart { .. } => "give a time in this range, or another baud rate",
        LinkLine::Spi { .. } => "give a time in this range",
    };
    table.refuse(
        "timeout_s",
        format_args!(
            "{:.1e} s to {:.3} s at {at}",
            rounded_up(shortest),
            longest.min(MOST_TIMEOUT_S)
        ),
        other,
    );
    None
}

fn read_uart(table: &Table<'_, '_>) -> Option<LinkLine> {
    let allowed = format!(
        "a whole number, {} to {}; or line = \"{SPI}\" and sck_hz",
        BAUD.start(),
        BAUD.end()
    );
    if table.has("sck_hz") {
        let remedy = if table.has("baud") {
            format!("remove sck_hz; or write `line = \"{SPI}\"` and remove baud")
        } else {
            format!("write `line = \"{SPI}\"`; or replace sck_hz by baud")
        };
        table.contradiction(
            "sck_hz",
            format!("sck_hz, and line = \"{UART}\""),
            "sck_hz where the line is SPI",
            remedy,
        );
        return None;
    }
    table.require("baud", allowed);
    let baud = table.integer("baud", *BAUD.start(), *BAUD.end())?;
    Some(LinkLine::Uart { baud })
}

fn read_spi(table: &Table<'_, '_>, clock: Option<ClockSection>) -> Option<LinkLine> {
    if table.has("baud") {
        let remedy = if table.has("sck_hz") {
            format!("remove baud; or write `line = \"{UART}\"` and remove sck_hz")
        } else {
            format!("replace baud by sck_hz; or write `line = \"{UART}\"`")
        };
        table.contradiction(
            "baud",
            format!("baud, and line = \"{SPI}\""),
            "baud where the line is serial",
            remedy,
        );
        return None;
    }
    let most = clock.map_or(*SCK_HZ.end(), |clock| most_sck_hz(&clock).min(*SCK_HZ.end()));
    let allowed = format!("a whole number, {} to {most}", SCK_HZ.start());
    let example = written(f64::from(most));
    table.require_with(
        "sck_hz",
        allowed,
        format!("add the clock of the host, such as `sck_hz = {example}`"),
    );
    let sck_hz = table.integer("sck_hz", *SCK_HZ.start(), *SCK_HZ.end())?;
    let clock = clock?;
    let most = most_sck_hz(&clock);
    if sck_hz > most {
        let faster = format!(
            "raise clock.frequency_hz to at least {} Hz",
            u64::from(sck_hz) * LEAST_CLOCKS_PER_BIT
        );
        let remedy = if SCK_HZ.contains(&most) {
            format!("write `sck_hz = {}`, or {faster}", written(f64::from(most)))
        } else {
            faster
        };
        table.refuse(
            "sck_hz",
            format_args!("at most an eighth of the clock of {} Hz: {most}", clock.frequency_hz),
            remedy,
        );
        return None;
    }
    Some(LinkLine::Spi { sck_hz })
}

/// Fastest clock of an SPI host.
fn most_sck_hz(clock: &ClockSection) -> u32 {
    (clock.frequency_hz.round() as u64 / LEAST_CLOCKS_PER_BIT) as u32
}

/// The next number of two digits, so that the number in a message is itself allowed.
fn rounded_up(number: f64) -> f64 {
    let unit = 10_f64.powf(number.log10().floor() - 1.0);
    (number / unit).ceil() * unit
}

/// Returns the allowed values and the remedy if the clock cannot generate the baud rate.
fn slower(error: &UartBridgeConfigError) -> (String, String) {
    let UartBridgeConfigError::BaudError {
        baud,
        clock_hz,
        percent,
        most,
        least_hz,
        ..
    } = error
    else {
        return (error.to_string(), "choose another baud rate".to_owned());
    };
    let allowed = format!(
        "what a clock of {clock_hz} Hz makes within 2 %: at most {most} baud ({baud} would be off by {percent:.1} %)"
    );
    let faster = format!("raise clock.frequency_hz to at least {least_hz} Hz");
    let usual = USUAL_BAUD.iter().rev().find(|usual| u64::from(**usual) <= *most);
    let remedy = match usual {
        Some(usual) => format!(
            "write `baud = {}`, the nearest of the usual rates, or {}, the nearest of all; or {faster}",
            written(f64::from(*usual)),
            written(*most as f64)
        ),
        None => faster,
    };
    (allowed, remedy)
}
