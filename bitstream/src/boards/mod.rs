//! The boards: device, oscillator and pins.
//!
//! A pin is in the table only if two public projects name it, each in a file of its own ([`BoardPin::sources`]: repository and path
//! on GitHub).

mod device;
mod table;

pub use device::{BoardDevice, FpgaFamily};
pub use table::BOARDS;

use crate::BitstreamError;

/// A board with an FPGA that open tools can build for.
#[derive(Debug, Clone, Copy)]
pub struct FpgaBoard {
    /// Its name on the command line.
    pub name: &'static str,
    /// Its name in prose.
    pub title: &'static str,
    /// The device.
    pub device: BoardDevice,
    /// The device's package, as nextpnr names it.
    pub package: &'static str,
    /// Frequency of the oscillator at [`clock`](Self::clock).
    pub oscillator_hz: u32,
    /// Voltage of the pins.
    pub volts: f64,
    /// Voltage of the LED's pin.
    pub led_volts: f64,
    /// The oscillator.
    pub clock: BoardPin,
    /// Serial line from the host.
    pub serial_rx: BoardPin,
    /// Serial line to the host.
    pub serial_tx: BoardPin,
    /// An LED.
    pub led: BoardPin,
    /// Whether the LED is lit by a low level.
    pub led_is_active_low: bool,
    /// Its name in openFPGALoader.
    pub loader: &'static str,
    /// Free pins on headers, by their names on the board.
    pub header: &'static [(&'static str, &'static str)],
    /// Two files of public projects that agree about the free pins.
    pub header_sources: [&'static str; 2],
}

/// A pin of a board.
#[derive(Debug, Clone, Copy)]
pub struct BoardPin {
    /// Name of the pin in the package.
    pub pin: &'static str,
    /// Two files of public projects that agree about it, as `owner/repository path`.
    pub sources: [&'static str; 2],
}

/// How the top uses a pin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PinUse {
    /// As an input.
    Input,
    /// As an output.
    Output,
}

/// A pin of the device as a top uses it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TopPin {
    /// Port of the top.
    pub port: String,
    /// Name of the pin in the package.
    pub pin: &'static str,
    /// Its name on the board; empty for a pin that has its own use there.
    pub header: &'static str,
    /// Two files of public projects that agree about it.
    pub sources: [&'static str; 2],
    /// What the top uses it for.
    pub direction: PinUse,
    /// The level of an open input, which a resistor in the device makes; `None` without one.
    pub open_level: Option<bool>,
}

/// The board of this name.
///
/// # Errors
/// [`BitstreamError::UnknownBoard`], which lists all boards.
pub fn board(name: &str) -> Result<FpgaBoard, BitstreamError> {
    let found = BOARDS.into_iter().find(|board| board.name == name);
    found.ok_or_else(|| BitstreamError::UnknownBoard {
        found: name.to_owned(),
        known: names(),
    })
}

/// The names of all boards, with commas between them.
#[must_use]
pub fn names() -> String {
    BOARDS.map(|board| board.name).join(", ")
}

impl FpgaBoard {
    /// The pins that the top uses, with the names of its ports.
    #[must_use]
    pub fn pins(&self) -> [(&'static str, BoardPin); 4] {
        let led = if self.led_is_active_low { "led_n" } else { "led" };
        [
            ("clk", self.clock),
            ("serial_rx", self.serial_rx),
            ("serial_tx", self.serial_tx),
            (led, self.led),
        ]
    }

    /// The same pins as a top uses them.
    #[must_use]
    pub fn own_pins(&self) -> [TopPin; 4] {
        let directions = [PinUse::Input, PinUse::Input, PinUse::Output, PinUse::Output];
        let mut directions = directions.into_iter();
        self.pins().map(|(port, pin)| TopPin {
            port: port.to_owned(),
            pin: pin.pin,
            header: "",
            sources: pin.sources,
            direction: directions.next().unwrap_or(PinUse::Output),
            open_level: None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pin_has_two_sources_in_different_projects_and_none_is_used_twice() {
        for board in BOARDS {
            let pins = board.pins();
            for (index, (name, pin)) in pins.iter().enumerate() {
                let projects = pin.sources.map(|source| source.split_once(' ').unwrap().0);
                assert_ne!(projects[0], projects[1], "{} {name}", board.name);
                assert!(pins[..index].iter().all(|(_, other)| other.pin != pin.pin));
                assert!(board.header.iter().all(|(_, free)| *free != pin.pin));
            }
            let [first, second] = board.header_sources.map(|source| source.split(' ').next().unwrap());
            assert!(board.header.is_empty() || first != second, "{}", board.name);
            for (index, (_, pin)) in board.header.iter().enumerate() {
                assert!(board.header[..index].iter().all(|(_, other)| other != pin), "{pin}");
            }
        }
    }

    #[test]
    fn an_unknown_board_lists_those_that_are_known() {
        let message = board("ulx3s").unwrap_err().to_string();
        assert!(
            message.ends_with(
                "allowed: icebreaker, ice40-hx8k, colorlight-i5, ulx3s-12f, ulx3s-25f, ulx3s-85f, tang-nano-9k, tang-nano-20k"
            ),
            "{message}"
        );
    }
}
