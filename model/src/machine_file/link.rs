//! `[link]`: the serial line through which a host reads and writes the registers of the stage.

use super::ClockSection;
use super::hint::written;
use super::key::{Default, Key, Values};
use super::range::NumberRange;
use super::table::Table;
use crate::rtl::uart_bridge::{BAUD, UartBridgeConfig, UartBridgeConfigError};

/// Range of time-outs; the baud rate limits them further.
const TIMEOUT_S: NumberRange = NumberRange::positive(1.2).unit("s");
/// Time-out of a file that gives none.
const DEFAULT_TIMEOUT_S: f64 = 0.01;
/// Baud rates that the ports of hosts usually have, within [`BAUD`].
const USUAL_BAUD: [u32; 9] = [
    115_200, 230_400, 460_800, 500_000, 921_600, 1_000_000, 1_500_000, 2_000_000, 3_000_000,
];

/// `[link]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinkSection {
    /// Baud rate, 115,200 to 3,000,000. The clock makes it within 2 %.
    pub baud: u32,
    /// Time-out in s: the bridge drops a frame whose next byte takes this long. Default 0.01.
    pub timeout_s: f64,
    /// CRC-32 (IEEE 802.3, as in `zlib`) of the machine file, followed by the files beside it that it names, each once. The stage has it
    /// in a register, so that a host can tell whether it has the machine file of the hardware.
    pub machine_crc: u32,
}

impl LinkSection {
    /// The constants of the bridge at this clock, for registers with word addresses below `address_limit`.
    ///
    /// # Errors
    /// [`UartBridgeConfigError`], which the machine file's validation rules out.
    pub fn bridge(&self, clock: &ClockSection, address_limit: u16) -> Result<UartBridgeConfig, UartBridgeConfigError> {
        UartBridgeConfig::new(
            clock.frequency_hz.round() as u64,
            self.baud,
            self.timeout_s,
            address_limit,
        )
    }
}

/// The keys of the table.
pub(super) const KEYS: &[Key] = &[
    Key::new(
        "baud",
        Values::Integer(*BAUD.start(), *BAUD.end()),
        "Baud rate of the serial line, 8 data bits, no parity, 1 stop bit. The clock must make it within 2 %.",
    )
    .required(),
    Key::new(
        "timeout_s",
        Values::Number(TIMEOUT_S),
        "Time in s after which the hardware drops a frame whose next byte has not come: 20 to 131,071 bits.",
    )
    .default(Default::Number(DEFAULT_TIMEOUT_S)),
];

/// Reads the table. The checksum is that of nothing yet.
pub(super) fn read(table: &Table<'_, '_>, clock: Option<ClockSection>) -> Option<LinkSection> {
    table.allow(KEYS);
    table.require(
        "baud",
        format_args!("a whole number, {} to {}", BAUD.start(), BAUD.end()),
    );
    let baud = table.integer("baud", *BAUD.start(), *BAUD.end());
    let timeout_s = match table.has("timeout_s") {
        true => table.number("timeout_s", TIMEOUT_S),
        false => Some(DEFAULT_TIMEOUT_S),
    };
    let section = LinkSection {
        baud: baud?,
        timeout_s: timeout_s?,
        machine_crc: 0,
    };
    // Without a clock, the file has a problem already.
    match section.bridge(&clock?, 0) {
        Ok(_) => Some(section),
        Err(UartBridgeConfigError::Silence { shortest, longest, .. }) => {
            table.refuse(
                "timeout_s",
                format_args!("{shortest:.1e} s to {longest:.3} s at {baud} baud", baud = section.baud),
                "give a time in this range, or another baud rate",
            );
            None
        }
        Err(error) => {
            let (allowed, remedy) = slower(section.baud, &error);
            table.refuse("baud", allowed, remedy);
            None
        }
    }
}

/// What is allowed where the clock cannot make the baud rate, and what to do.
fn slower(baud: u32, error: &UartBridgeConfigError) -> (String, String) {
    let UartBridgeConfigError::BaudError {
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
