//! The boards for which a project is written: facts of board and device.
//!
//! Sources. Pins of the DE1: Altera's board package `::qboard::de1` and a generator of DE1 projects, both public,
//! which agree in all 72 header pins, clock, key and serial line. Pins of the DE1-SoC: the assignments that Terasic's
//! System Builder writes and a second public project, which agree in all header pins; clock and the first two header
//! pins are also in `litex-boards` (`platforms/de1soc.py`). Capacities: [`Family::device`].

use std::fmt;
use std::str::FromStr;

use crate::yosys::Family;

/// A board, with its name in the machine file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Board {
    /// Terasic DE1 with a Cyclone II, the board of the XY stage's paper.
    De1,
    /// Terasic DE1-SoC with a Cyclone V.
    De1Soc,
}

/// The processor of the system.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Processor {
    /// Nios II/e, which needs no licence.
    Nios2,
    /// Nios V/m.
    NiosV,
}

/// Facts of a board.
#[derive(Debug)]
pub(super) struct Facts {
    /// Common name of the board.
    pub(super) title: &'static str,
    /// Family of the device, as Quartus calls it.
    pub(super) quartus_family: &'static str,
    /// Version of Quartus for which the project is written.
    pub(super) quartus: &'static str,
    /// That version, as `.qpf` and `package require` need it.
    pub(super) quartus_version: &'static str,
    /// Version of the `qsys` package of its system's script.
    pub(super) script_version: &'static str,
    pub(super) processor: Processor,
    /// On-chip memory for program and data, bytes.
    pub(super) memory_bytes: u32,
    /// Frequency of its oscillator in Hz.
    pub(super) oscillator_hz: f64,
    pub(super) clock_pin: &'static str,
    /// Pin and board name of the push button for the reset, which is low while pressed.
    pub(super) reset_pin: (&'static str, &'static str),
    /// Pins for receive and transmit of a serial line on the board; `None` if the fabric has none.
    pub(super) uart_pins: Option<[&'static str; 2]>,
    /// Pins `[0]` to `[35]` of the expansion headers `GPIO_0` and `GPIO_1`.
    pub(super) headers: [[&'static str; 36]; 2],
}

/// The board is not known.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("unknown board {found:?}; known: {known}; leave the key out for projects of all of them", known = known())]
pub struct UnknownBoard {
    /// Name that was found.
    pub found: String,
}

fn known() -> String {
    let boards = Board::ALL.map(|board| format!("{} ({})", board.name(), board.family()));
    boards.join(", ")
}

impl Board {
    /// All boards.
    pub const ALL: [Self; 2] = [Self::De1, Self::De1Soc];

    /// Name of the board in the machine file.
    pub fn name(self) -> &'static str {
        match self {
            Self::De1 => "de1",
            Self::De1Soc => "de1soc",
        }
    }

    /// Family of its device; [`Family::device`] gives the device.
    pub fn family(self) -> Family {
        match self {
            Self::De1 => Family::Cyclone2,
            Self::De1Soc => Family::Cyclone5,
        }
    }

    pub(super) fn facts(self) -> &'static Facts {
        match self {
            Self::De1 => &DE1,
            Self::De1Soc => &DE1_SOC,
        }
    }
}

impl FromStr for Board {
    type Err = UnknownBoard;

    fn from_str(name: &str) -> Result<Self, UnknownBoard> {
        let found = Self::ALL.into_iter().find(|board| board.name() == name);
        found.ok_or_else(|| UnknownBoard { found: name.to_owned() })
    }
}

impl fmt::Display for Board {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[rustfmt::skip]
static DE1: Facts = Facts {
    title: "Terasic DE1",
    quartus_family: "Cyclone II",
    quartus: "Quartus II 13.0sp1 (Web Edition), the last that knows Cyclone II",
    quartus_version: "13.0",
    script_version: "13.0",
    processor: Processor::Nios2,
    // This takes 16 of the 52 M4K blocks.
    memory_bytes: 8 << 10,
    oscillator_hz: 50e6,
    clock_pin: "L1",
    reset_pin: ("R22", "KEY[0]"),
    uart_pins: Some(["F14", "G12"]),
    headers: [
        [
            "A13", "B13", "A14", "B14", "A15", "B15", "A16", "B16", "A17", "B17", "A18", "B18",
            "A19", "B19", "A20", "B20", "C21", "C22", "D21", "D22", "E21", "E22", "F21", "F22",
            "G21", "G22", "J21", "J22", "K21", "K22", "J19", "J20", "J18", "K20", "L19", "L18",
        ],
        [
            "H12", "H13", "H14", "G15", "E14", "E15", "F15", "G16", "F12", "F13", "C14", "D14",
            "D15", "D16", "C17", "C18", "C19", "C20", "D19", "D20", "E20", "F20", "E19", "E18",
            "G20", "G18", "G17", "H17", "J15", "H18", "N22", "N21", "P15", "N15", "P17", "P18",
        ],
    ],
};

#[rustfmt::skip]
static DE1_SOC: Facts = Facts {
    title: "Terasic DE1-SoC",
    quartus_family: "Cyclone V",
    quartus: "Quartus Prime 25.1std (Lite or Standard Edition)",
    quartus_version: "25.1",
    script_version: "16.1",
    processor: Processor::NiosV,
    memory_bytes: 64 << 10,
    oscillator_hz: 50e6,
    clock_pin: "AF14",
    reset_pin: ("AA14", "KEY[0]"),
    // The serial line belongs to the hard processor.
    uart_pins: None,
    headers: [
        [
            "AC18", "Y17",  "AD17", "Y18",  "AK16", "AK18", "AK19", "AJ19", "AJ17", "AJ16", "AH18", "AH17",
            "AG16", "AE16", "AF16", "AG17", "AA18", "AA19", "AE17", "AC20", "AH19", "AJ20", "AH20", "AK21",
            "AD19", "AD20", "AE18", "AE19", "AF20", "AF21", "AF19", "AG21", "AF18", "AG20", "AG18", "AJ21",
        ],
        [
            "AB17", "AA21", "AB21", "AC23", "AD24", "AE23", "AE24", "AF25", "AF26", "AG25", "AG26", "AH24",
            "AH27", "AJ27", "AK29", "AK28", "AK27", "AJ26", "AK26", "AH25", "AJ25", "AJ24", "AK24", "AG23",
            "AK23", "AH23", "AK22", "AJ22", "AH22", "AG22", "AF24", "AF23", "AE22", "AD21", "AA20", "AC22",
        ],
    ],
};

#[cfg(test)]
mod tests {
    use super::*;
    use posicast_machine::machine_file::BOARDS;
    use std::collections::BTreeSet;

    #[test]
    fn names_are_read_back_and_unknown_ones_get_the_list() {
        for board in Board::ALL {
            assert_eq!(board.name().parse(), Ok(board));
        }
        assert_eq!(Board::ALL.map(Board::name), BOARDS, "those of the machine file");
        let error = "de2".parse::<Board>().unwrap_err().to_string();
        assert!(error.contains("de1 (cyclone2), de1soc (cyclone5)"), "{error}");
    }

    #[test]
    fn no_pin_of_a_board_is_named_twice() {
        for board in Board::ALL {
            let facts = board.facts();
            let others = [facts.clock_pin, facts.reset_pin.0];
            let pins: Vec<&str> = facts
                .headers
                .iter()
                .flatten()
                .copied()
                .chain(others)
                .chain(facts.uart_pins.into_iter().flatten())
                .collect();
            assert_eq!(pins.iter().collect::<BTreeSet<_>>().len(), pins.len(), "{board}");
        }
    }
}
