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

/// A family of devices whose bitstreams are read back alike.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FpgaFamily {
    /// Lattice iCE40.
    Ice40,
    /// Lattice ECP5.
    Ecp5,
    /// Gowin LittleBee and Arora.
    Gowin,
}

impl FpgaFamily {
    /// Ending of a file of constraints.
    #[must_use]
    pub fn constraints_ending(self) -> &'static str {
        match self {
            Self::Ice40 => "pcf",
            Self::Ecp5 => "lpf",
            Self::Gowin => "cst",
        }
    }

    /// Ending of a packed bitstream.
    #[must_use]
    pub fn bitstream_ending(self) -> &'static str {
        match self {
            Self::Ice40 => "bin",
            Self::Ecp5 => "bit",
            Self::Gowin => "fs",
        }
    }
}

/// A device.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BoardDevice {
    /// iCE40 UltraPlus 5K.
    Up5k,
    /// iCE40 HX8K.
    Hx8k,
    /// ECP5 with 12,000 look-up tables by its data sheet: the same as [`Lfe5u25f`](Self::Lfe5u25f) but for its identity.
    Lfe5u12f,
    /// ECP5 with 24,000 look-up tables.
    Lfe5u25f,
    /// ECP5 with 84,000 look-up tables.
    Lfe5u85f,
    /// Gowin LittleBee with 8,640 look-up tables.
    Gw1nr9c,
    /// Gowin Arora with 20,736 look-up tables.
    Gw2ar18c,
}

impl BoardDevice {
    /// Its family.
    #[must_use]
    pub fn family(self) -> FpgaFamily {
        match self {
            Self::Up5k | Self::Hx8k => FpgaFamily::Ice40,
            Self::Lfe5u12f | Self::Lfe5u25f | Self::Lfe5u85f => FpgaFamily::Ecp5,
            Self::Gw1nr9c | Self::Gw2ar18c => FpgaFamily::Gowin,
        }
    }

    /// Name of the device.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Up5k => "iCE40UP5K",
            Self::Hx8k => "iCE40HX8K",
            Self::Lfe5u12f => "LFE5U-12F",
            Self::Lfe5u25f => "LFE5U-25F",
            Self::Lfe5u85f => "LFE5U-85F",
            Self::Gw1nr9c => "GW1NR-9C",
            Self::Gw2ar18c => "GW2AR-18C",
        }
    }

    /// The option of nextpnr that selects it; for Gowin the part after `--device`.
    #[must_use]
    pub fn nextpnr_option(self) -> &'static str {
        match self {
            Self::Up5k => "--up5k",
            Self::Hx8k => "--hx8k",
            Self::Lfe5u12f => "--12k",
            Self::Lfe5u25f => "--25k",
            Self::Lfe5u85f => "--85k",
            Self::Gw1nr9c => "GW1NR-LV9QN88PC6/I5",
            Self::Gw2ar18c => "GW2AR-LV18QN88C8/I7",
        }
    }

    /// The name by which the timing model of Yosys for iCE40 knows it; empty for others.
    #[must_use]
    pub fn yosys_timing(self) -> &'static str {
        match self {
            Self::Up5k => "u",
            Self::Hx8k => "hx",
            _ => "",
        }
    }

    /// The name of the die in apycula's database; empty for other families.
    #[must_use]
    pub fn gowin_die(self) -> &'static str {
        match self {
            Self::Gw1nr9c => "GW1N-9C",
            Self::Gw2ar18c => "GW2A-18C",
            _ => "",
        }
    }

    /// Number of logic cells.
    #[must_use]
    pub fn logic_cells(self) -> u64 {
        match self {
            Self::Up5k => 5280,
            Self::Hx8k => 7680,
            // nextpnr uses the whole of a 12F.
            Self::Lfe5u12f | Self::Lfe5u25f => 24_288,
            Self::Lfe5u85f => 83_640,
            Self::Gw1nr9c => 8640,
            Self::Gw2ar18c => 20_736,
        }
    }

    /// Number of block RAMs: of 4,096 bits in iCE40, of 18,432 bits in ECP5 and Gowin.
    #[must_use]
    pub fn memories(self) -> u64 {
        match self {
            Self::Up5k => 30,
            Self::Hx8k => 32,
            Self::Lfe5u12f | Self::Lfe5u25f => 56,
            Self::Lfe5u85f => 208,
            Self::Gw1nr9c => 26,
            Self::Gw2ar18c => 46,
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

const COLORLIGHT_I5: [&str; 2] = [
    "FPiorski/colorlight-i5-vhdl-examples common/ext_board.lpf",
    "LukeMoll/amaranth-boards amaranth_boards/muselab_ext.py",
];
const ULX3S: [&str; 2] = [
    "emard/ulx3s doc/constraints/ulx3s_v20.lpf",
    "amaranth-lang/amaranth-boards amaranth_boards/ulx3s.py",
];
const TANG_NANO_9K: [&str; 2] = [
    "litex-hub/litex-boards litex_boards/platforms/sipeed_tang_nano_9k.py",
    "amaranth-lang/amaranth-boards amaranth_boards/tang_nano_9k.py",
];
const TANG_NANO_20K: [&str; 2] = [
    "litex-hub/litex-boards litex_boards/platforms/sipeed_tang_nano_20k.py",
    "ryomuk/tangnano-5V applications/TangNano6809MEM/TangNano6809MEM_project/src/tn20k.cst",
];
/// The second file of [`TANG_NANO_20K`] uses the LED's pin for a wire.
const TANG_NANO_20K_LED: [&str; 2] = [
    "litex-hub/litex-boards litex_boards/platforms/sipeed_tang_nano_20k.py",
    "YosysHQ/apicula examples/himbaechel/tangnano20k.cst",
];
/// Pins of the headers P2, P3 and P6 that have no other use, by header and pin. Those of bank 8 are left out: the configuration drives
/// some of them.
const COLORLIGHT_I5_HEADER: [(&str, &str); 40] = [
    ("P2 pin 4", "T18"),
    ("P2 pin 5", "R17"),
    ("P2 pin 6", "M17"),
    ("P2 pin 12", "N18"),
    ("P2 pin 13", "L20"),
    ("P2 pin 14", "K20"),
    ("P2 pin 15", "G20"),
    ("P2 pin 16", "J20"),
    ("P2 pin 17", "L18"),
    ("P2 pin 18", "M18"),
    ("P2 pin 19", "N17"),
    ("P2 pin 25", "P17"),
    ("P2 pin 26", "R18"),
    ("P2 pin 27", "C18"),
    ("P3 pin 3", "D20"),
    ("P3 pin 4", "B19"),
    ("P3 pin 5", "A19"),
    ("P3 pin 6", "A18"),
    ("P3 pin 13", "B1"),
    ("P3 pin 14", "D2"),
    ("P3 pin 15", "E2"),
    ("P3 pin 16", "D1"),
    ("P3 pin 17", "C1"),
    ("P3 pin 18", "C2"),
    ("P3 pin 19", "E3"),
    ("P3 pin 25", "C17"),
    ("P3 pin 26", "B18"),
    ("P3 pin 27", "B20"),
    ("P3 pin 28", "F20"),
    ("P6 pin 3", "J18"),
    ("P6 pin 4", "P16"),
    ("P6 pin 5", "L4"),
    ("P6 pin 6", "N4"),
    ("P6 pin 12", "N2"),
    ("P6 pin 19", "M1"),
    ("P6 pin 22", "N3"),
    ("P6 pin 24", "M3"),
    ("P6 pin 26", "M4"),
    ("P6 pin 27", "L5"),
    ("P6 pin 28", "J16"),
];
/// Pins of the headers J1 and J2 that neither the radio nor the converter uses.
const ULX3S_HEADER: [(&str, &str); 42] = [
    ("gp0", "B11"),
    ("gn0", "C11"),
    ("gp1", "A10"),
    ("gn1", "A11"),
    ("gp2", "A9"),
    ("gn2", "B10"),
    ("gp3", "B9"),
    ("gn3", "C10"),
    ("gp4", "A7"),
    ("gn4", "A8"),
    ("gp5", "C8"),
    ("gn5", "B8"),
    ("gp6", "C6"),
    ("gn6", "C7"),
    ("gp7", "A6"),
    ("gn7", "B6"),
    ("gp8", "A4"),
    ("gn8", "A5"),
    ("gp9", "A2"),
    ("gn9", "B1"),
    ("gp10", "C4"),
    ("gn10", "B4"),
    ("gp18", "H18"),
    ("gn18", "H17"),
    ("gp19", "F17"),
    ("gn19", "G18"),
    ("gp20", "D18"),
    ("gn20", "E17"),
    ("gp21", "C18"),
    ("gn21", "D17"),
    ("gp22", "B15"),
    ("gn22", "C15"),
    ("gp23", "B17"),
    ("gn23", "C17"),
    ("gp24", "C16"),
    ("gn24", "D16"),
    ("gp25", "D14"),
    ("gn25", "E14"),
    ("gp26", "B13"),
    ("gn26", "C13"),
    ("gp27", "D13"),
    ("gn27", "E13"),
];
/// The ULX3S without its device.
const ULX3S_BOARD: FpgaBoard = FpgaBoard {
    name: "ulx3s-25f",
    title: "ULX3S",
    device: BoardDevice::Lfe5u25f,
    package: "CABGA381",
    oscillator_hz: 25_000_000,
    volts: 3.3,
    led_volts: 3.3,
    clock: pin("G2", ULX3S),
    serial_rx: pin("M1", ULX3S),
    serial_tx: pin("L4", ULX3S),
    led: pin("B2", ULX3S),
    led_is_active_low: false,
    loader: "ulx3s",
    header: &ULX3S_HEADER,
    header_sources: ULX3S,
};

/// All boards.
pub const BOARDS: [FpgaBoard; 8] = [
    FpgaBoard {
        name: "icebreaker",
        title: "iCEBreaker",
        device: BoardDevice::Up5k,
        package: "sg48",
        oscillator_hz: 12_000_000,
        volts: 3.3,
        led_volts: 3.3,
        clock: pin("35", ICEBREAKER),
        serial_rx: pin("6", ICEBREAKER),
        serial_tx: pin("9", ICEBREAKER),
        led: pin("11", ICEBREAKER),
        led_is_active_low: true,
        loader: "ice40_generic",
        header: &[],
        header_sources: ["", ""],
    },
    FpgaBoard {
        name: "ice40-hx8k",
        title: "iCE40-HX8K Breakout Board",
        device: BoardDevice::Hx8k,
        package: "ct256",
        oscillator_hz: 12_000_000,
        volts: 3.3,
        led_volts: 3.3,
        clock: pin("J3", HX8K),
        serial_rx: pin("B10", HX8K_SERIAL),
        serial_tx: pin("B12", HX8K_SERIAL),
        led: pin("B5", HX8K),
        led_is_active_low: false,
        loader: "ice40_generic",
        header: &[],
        header_sources: ["", ""],
    },
    FpgaBoard {
        name: "colorlight-i5",
        title: "Colorlight i5 v7.0 on its extension board",
        device: BoardDevice::Lfe5u25f,
        package: "CABGA381",
        oscillator_hz: 25_000_000,
        volts: 3.3,
        led_volts: 3.3,
        clock: pin("P3", COLORLIGHT_I5),
        serial_rx: pin("H18", COLORLIGHT_I5),
        serial_tx: pin("J17", COLORLIGHT_I5),
        led: pin("U16", COLORLIGHT_I5),
        led_is_active_low: true,
        loader: "colorlight-i5",
        header: &COLORLIGHT_I5_HEADER,
        header_sources: [
            "wuxx/Colorlight-FPGA-Projects src/i5/common/io.lpf",
            "LukeMoll/amaranth-boards amaranth_boards/muselab_ext.py",
        ],
    },
    FpgaBoard {
        name: "ulx3s-12f",
        device: BoardDevice::Lfe5u12f,
        ..ULX3S_BOARD
    },
    ULX3S_BOARD,
    FpgaBoard {
        name: "ulx3s-85f",
        device: BoardDevice::Lfe5u85f,
        ..ULX3S_BOARD
    },
    FpgaBoard {
        name: "tang-nano-9k",
        title: "Tang Nano 9K",
        device: BoardDevice::Gw1nr9c,
        package: "QN88P",
        oscillator_hz: 27_000_000,
        volts: 3.3,
        // Its bank has the voltage of the memory in the package.
        led_volts: 1.8,
        clock: pin("52", TANG_NANO_9K),
        serial_rx: pin("18", TANG_NANO_9K),
        serial_tx: pin("17", TANG_NANO_9K),
        led: pin("10", TANG_NANO_9K),
        led_is_active_low: true,
        loader: "tangnano9k",
        header: &[],
        header_sources: ["", ""],
    },
    FpgaBoard {
        name: "tang-nano-20k",
        title: "Tang Nano 20K",
        device: BoardDevice::Gw2ar18c,
        package: "QN88",
        oscillator_hz: 27_000_000,
        volts: 3.3,
        led_volts: 3.3,
        clock: pin("4", TANG_NANO_20K),
        serial_rx: pin("70", TANG_NANO_20K),
        serial_tx: pin("69", TANG_NANO_20K),
        led: pin("15", TANG_NANO_20K_LED),
        led_is_active_low: true,
        loader: "tangnano20k",
        header: &[],
        header_sources: ["", ""],
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
