//! The boards: device, oscillator and pins.
//!
//! A pin is in the table only if two public projects name it, each in a file of its own ([`BoardPin::sources`]: repository and path
//! on GitHub).

use crate::BitstreamError;

/// A board with an FPGA that open tools can build for.
#[derive(Debug, Clone, Copy)]
pub struct FpgaBoard {
    /// Its name on the command line.
    pub name: &'static str,
    /// Its name in prose.
    pub title: &'static str,
    /// The device.
    pub device: Ice40Device,
    /// The device's package, as nextpnr names it.
    pub package: &'static str,
    /// Frequency of the oscillator at [`clock`](Self::clock).
    pub oscillator_hz: u32,
    /// Voltage of the pins.
    pub volts: f64,
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
}

/// A pin of a board.
#[derive(Debug, Clone, Copy)]
pub struct BoardPin {
    /// Name of the pin in the package.
    pub pin: &'static str,
    /// Two files of public projects that agree about it, as `owner/repository path`.
    pub sources: [&'static str; 2],
}

/// A device of the iCE40 family.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ice40Device {
    /// iCE40 UltraPlus 5K.
    Up5k,
    /// iCE40 HX8K.
    Hx8k,
}

impl Ice40Device {
    /// Name of the device.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Up5k => "iCE40UP5K",
            Self::Hx8k => "iCE40HX8K",
        }
    }

    /// The option of nextpnr that selects it.
    #[must_use]
    pub fn option(self) -> &'static str {
        match self {
            Self::Up5k => "--up5k",
            Self::Hx8k => "--hx8k",
        }
    }

    /// The name by which Yosys's timing model knows it.
    #[must_use]
    pub fn timing(self) -> &'static str {
        match self {
            Self::Up5k => "u",
            Self::Hx8k => "hx",
        }
    }

    /// Number of logic cells.
    #[must_use]
    pub fn logic_cells(self) -> u64 {
        match self {
            Self::Up5k => 5280,
            Self::Hx8k => 7680,
        }
    }

    /// Number of block RAMs of 4096 bits.
    #[must_use]
    pub fn memories(self) -> u64 {
        match self {
            Self::Up5k => 30,
            Self::Hx8k => 32,
        }
    }
}

const ICEBREAKER: [&str; 2] = [
    "YosysHQ/icestorm examples/icebreaker/icebreaker.pcf",
    "amaranth-lang/amaranth-boards amaranth_boards/icebreaker.py",
];
const HX8K: [&str; 2] = [
    "YosysHQ/icestorm examples/hx8kboard/hx8kboard.pcf",
    "amaranth-lang/amaranth-boards amaranth_boards/ice40_hx8k_b_evn.py",
];
/// The first file of [`HX8K`] does not name the serial line.
const HX8K_SERIAL: [&str; 2] = [
    "YosysHQ/picorv32 picosoc/hx8kdemo.pcf",
    "amaranth-lang/amaranth-boards amaranth_boards/ice40_hx8k_b_evn.py",
];

/// All boards.
pub const BOARDS: [FpgaBoard; 2] = [
    FpgaBoard {
        name: "icebreaker",
        title: "iCEBreaker",
        device: Ice40Device::Up5k,
        package: "sg48",
        oscillator_hz: 12_000_000,
        volts: 3.3,
        clock: pin("35", ICEBREAKER),
        serial_rx: pin("6", ICEBREAKER),
        serial_tx: pin("9", ICEBREAKER),
        led: pin("11", ICEBREAKER),
        led_is_active_low: true,
    },
    FpgaBoard {
        name: "ice40-hx8k",
        title: "iCE40-HX8K Breakout Board",
        device: Ice40Device::Hx8k,
        package: "ct256",
        oscillator_hz: 12_000_000,
        volts: 3.3,
        clock: pin("J3", HX8K),
        serial_rx: pin("B10", HX8K_SERIAL),
        serial_tx: pin("B12", HX8K_SERIAL),
        led: pin("B5", HX8K),
        led_is_active_low: false,
    },
];

const fn pin(pin: &'static str, sources: [&'static str; 2]) -> BoardPin {
    BoardPin { pin, sources }
}

/// The board of this name.
///
/// # Errors
/// [`BitstreamError::UnknownBoard`], which lists all boards.
pub fn board(name: &str) -> Result<FpgaBoard, BitstreamError> {
    let known = || BOARDS.map(|board| board.name).join(", ");
    let found = BOARDS.into_iter().find(|board| board.name == name);
    found.ok_or_else(|| BitstreamError::UnknownBoard {
        found: name.to_owned(),
        known: known(),
    })
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
            }
        }
    }

    #[test]
    fn an_unknown_board_lists_those_that_are_known() {
        let message = board("ulx3s").unwrap_err().to_string();
        assert!(message.ends_with("allowed: icebreaker, ice40-hx8k"), "{message}");
    }
}
