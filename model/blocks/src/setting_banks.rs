//! The settings of a controller that stands alone: bank 0 is a ROM with the machine's settings, banks 1 and 2 can be
//! loaded.
//!
//! ```text
//! clock        0       1
//! row, bank   < n >< .. >
//! setting     -----< n of that bank >
//! ```
//!
//! ```text
//! clock               0     1     2     3     4
//! setting_read       /‾‾‾‾‾\_________________________   the host reads back
//! setting_read_waits ______/‾‾‾‾‾‾‾‾‾‾‾\_____________   longer while `busy`: served in clock 1 here
//! setting_loaded     ------------------< word >------   of `setting_bank` and `setting_row` of clock 1
//! ```
//!
//! - A row that was not written since the reset reads as 0, and so does bank 3: the command is then 0, whatever the
//!   memory holds.
//! - A write to the active bank, to bank 0 or to bank 3 is refused: `setting_refused` is high in the next clock. So
//!   no word is read in the clock in which it is written.
//! - A host can read back any bank, also the active one, as the controller would read it. Its read takes the place of
//!   the controller's, so it waits while the controller is `busy`, and for a write of the same clock. Bank and row
//!   are those of the clock in which it is served. A `setting_read` while a read waits is the same read; one in the
//!   clock in which the word is taken is another.
//! - `busy` must be high from the clock after the controller's start on. A read that is served in the clock of the
//!   start has its word in the first clock of the controller's computation, in which no step uses a setting.

use super::sliding_mode::{SETTINGS, Settings};
use super::{FOREVER, Moore, clocked_block, ports, show_each};

ports! {
    setting_banks_ports;

    /// The input ports. Bits above a port's width are ignored.
    inputs Inputs {
        /// Synchronous reset; the contents of banks 1 and 2 are discarded.
        rst: Bit as bool;
        /// One clock: writes `setting_word` to `setting_row` of `setting_bank`.
        setting_write: Bit as bool;
        /// Bank to write, 1 or 2, or to read back.
        setting_bank: Bits(2) as u8;
        /// Row to write or to read back.
        setting_row: Bits(4) as u8;
        /// Word to write.
        setting_word: Bits(32) as u32;
        /// Bank that the controller reads: 0 is the machine's, 1 and 2 are the loaded ones.
        bank: Bits(2) as u8;
        /// Row that the controller reads.
        row: Bits(4) as u8;
        /// The controller is reading, so a host's read waits.
        busy: Bit as bool;
        /// One clock: read back the word at `setting_row` of `setting_bank`.
        setting_read: Bit as bool;
    }

    /// The output ports, all of them registers.
    outputs Outputs {
        /// The word read, one clock after its bank and row.
        setting: Bits(32) as u32;
        /// One clock: a write was refused.
        setting_refused: Bit as bool;
        /// Last word that the host read back; 0 after reset.
        setting_loaded: Bits(32) as u32;
        /// A host's read waits to be served.
        setting_read_waits: Bit as bool;
    }
}

/// The cycle-accurate model of the setting banks.
#[derive(Debug, Clone)]
pub struct SettingBanks {
    machine: Settings,
    /// Words of banks 1 and 2; `None` for a row that was not written since the reset.
    loaded: [Option<u32>; 2 * SETTINGS],
    setting: u32,
    refused: bool,
    read_back: u32,
    read_waits: bool,
    /// Whether `setting` is the host's word in this clock.
    served: bool,
}

impl SettingBanks {
    /// The state after reset, with the machine's settings in bank 0.
    pub fn new(machine: &Settings) -> Self {
        Self {
            machine: *machine,
            loaded: [None; 2 * SETTINGS],
            setting: 0,
            refused: false,
            read_back: 0,
            read_waits: false,
            served: false,
        }
    }

    fn word(&self, bank: u8, row: u8) -> u32 {
        let row = usize::from(row);
        match bank {
            0 => self.machine.word(row),
            1 | 2 => self.loaded[(usize::from(bank) - 1) * SETTINGS + row].unwrap_or(0),
            _ => 0,
        }
    }

    /// Simulates one clock: returns the outputs before the rising edge, then clocks.
    pub fn step(&mut self, inputs: &Inputs) -> Outputs {
        let shown = self.outputs();
        if inputs.rst {
            *self = Self::new(&self.machine);
            return shown;
        }
        let loadable = matches!(inputs.setting_bank, 1 | 2) && inputs.setting_bank != inputs.bank;
        let serves = self.read_waits && !self.served && !inputs.busy && !inputs.setting_write;
        if self.served {
            self.read_back = self.setting;
        }
        self.read_waits = inputs.setting_read || self.read_waits && !self.served;
        self.served = serves;
        self.setting = if serves {
            self.word(inputs.setting_bank, inputs.setting_row)
        } else {
            self.word(inputs.bank, inputs.row)
        };
        self.refused = inputs.setting_write && !loadable;
        if inputs.setting_write && loadable {
            let row = usize::from(inputs.setting_row);
            self.loaded[(usize::from(inputs.setting_bank) - 1) * SETTINGS + row] = Some(inputs.setting_word);
        }
        shown
    }

    fn outputs(&self) -> Outputs {
        Outputs {
            setting: self.setting,
            setting_refused: self.refused,
            setting_loaded: self.read_back,
            setting_read_waits: self.read_waits,
        }
    }
}

impl Moore for SettingBanks {
    fn show(&self, outputs: &mut [u64]) {
        show_each(outputs, self.outputs().to_raw());
    }

    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        let Ok(inputs) = <&[u64; INPUT_PORTS]>::try_from(inputs).map(Inputs::from_raw) else {
            return 0;
        };
        let stays = self.setting == self.word(inputs.bank, inputs.row) && !self.refused;
        let reads = inputs.setting_read && !self.read_waits || self.read_waits && (self.served || !inputs.busy);
        if stays && !reads && !inputs.rst && !inputs.setting_write {
            FOREVER
        } else {
            0
        }
    }

    fn ignores(&self, input: &str) -> bool {
        matches!(input, "setting_bank" | "setting_row" | "setting_word")
    }
}

clocked_block!(SettingBanks, "the setting banks' module");

#[cfg(test)]
mod tests {
    use super::*;

    const MACHINE: u32 = 0x1111_0000;

    /// Words that a host reads back from a bank while the controller reads bank `bank` in every other interval of 20
    /// clocks.
    fn read_bank(banks: &mut SettingBanks, of: u8, bank: u8, clock: &mut u32) -> [u32; SETTINGS] {
        std::array::from_fn(|row| {
            let mut inputs = Inputs {
                setting_bank: of,
                setting_row: row as u8,
                setting_read: true,
                bank,
                ..Inputs::default()
            };
            loop {
                (inputs.row, inputs.busy) = (*clock as u8 & 15, (*clock / 20).is_multiple_of(2));
                let used = *clock % 20 > 1 && inputs.busy;
                let expected = banks.word(bank, inputs.row.wrapping_sub(1) & 15);
                let shown = banks.step(&inputs);
                assert!(!used || shown.setting == expected, "the controller's word");
                *clock += 1;
                let asked = std::mem::take(&mut inputs.setting_read);
                if !asked && !shown.setting_read_waits {
                    return shown.setting_loaded;
                }
            }
        })
    }

    #[test]
    fn what_was_written_is_read_back() {
        let machine = Settings(std::array::from_fn(|row| MACHINE + row as u32));
        let mut banks = SettingBanks::new(&machine);
        let mut clock = 0;
        let word = |bank: u8, row: u8| u32::from(bank) << 28 | u32::from(row) << 4 | 1;
        for (bank, rows) in [(1, 0..16), (2, 0..5)] {
            for row in rows {
                banks.step(&Inputs {
                    setting_write: true,
                    setting_bank: bank,
                    setting_row: row,
                    setting_word: word(bank, row),
                    ..Inputs::default()
                });
            }
        }
        // This holds whichever bank is in use.
        for active in 0..3 {
            let mut read = |of| read_bank(&mut banks, of, active, &mut clock);
            assert_eq!(read(0), machine.0);
            assert_eq!(read(1), std::array::from_fn(|row| word(1, row as u8)));
            let of_second = |row: usize| if row < 5 { word(2, row as u8) } else { 0 };
            assert_eq!(read(2), std::array::from_fn(of_second));
            assert_eq!(read(3), [0; SETTINGS]);
        }
    }

    #[test]
    fn a_read_waits_for_the_controller_and_for_a_write() {
        let mut banks = SettingBanks::new(&Settings(std::array::from_fn(|row| MACHINE + row as u32)));
        let read = Inputs {
            setting_read: true,
            busy: true,
            ..Inputs::default()
        };
        let write = Inputs {
            setting_write: true,
            setting_bank: 1,
            setting_word: 7,
            ..Inputs::default()
        };
        banks.step(&read);
        for _ in 0..100 {
            assert!(banks.step(&Inputs { busy: true, ..write }).setting_read_waits);
        }
        assert!(banks.step(&write).setting_read_waits);
        let idle = Inputs {
            setting_write: false,
            ..write
        };
        let waits: [bool; 4] = std::array::from_fn(|_| banks.step(&idle).setting_read_waits);
        assert_eq!(waits, [true, true, false, false]);
        assert_eq!(banks.outputs().setting_loaded, 7);
    }
}
