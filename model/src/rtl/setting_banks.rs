//! The settings of a controller that stands alone: bank 0 a ROM with the machine's, banks 1 and 2 to be loaded.
//!
//! ```text
//! clock        0       1
//! row, bank   < n >< .. >
//! setting     -----< n of that bank >
//! ```
//!
//! - A row that was not written since the reset reads as 0, and so does bank 3: a command of 0, whatever the memory holds.
//! - A write to the active bank, to bank 0 or 3 is refused: `setting_refused` is high in the next clock. So no word is read
//!   in the clock in which it is written.

use super::sliding_mode::{SETTINGS, Settings};
use super::{FOREVER, Moore, clocked_block, ports};

ports! {
    setting_banks_ports;

    /// The input ports. Bits above a port's width are ignored.
    inputs Inputs {
        /// Synchronous reset: banks 1 and 2 are forgotten.
        rst: Bit as bool;
        /// One clock: `setting_word` goes to its bank and row.
        setting_write: Bit as bool;
        /// Bank that is written, 1 or 2.
        setting_bank: Bits(2) as u8;
        /// Row that is written.
        setting_row: Bits(4) as u8;
        /// What is written.
        setting_word: Bits(32) as u32;
        /// Bank that is read: 0 the machine's, 1 and 2 the loaded ones.
        bank: Bits(2) as u8;
        /// Row that is read.
        row: Bits(4) as u8;
    }

    /// The output ports, all of them registers.
    outputs Outputs {
        /// The word that was read, a clock after its bank and row.
        setting: Bits(32) as u32;
        /// One clock: a write was refused.
        setting_refused: Bit as bool;
    }
}

/// The banks, cycle accurate at their ports.
#[derive(Debug, Clone)]
pub struct SettingBanks {
    machine: Settings,
    /// Banks 1 and 2; `None` was not written since the reset.
    loaded: [Option<u32>; 2 * SETTINGS],
    setting: u32,
    refused: bool,
}

impl SettingBanks {
    /// After reset, with the machine's settings in bank 0.
    pub fn new(machine: &Settings) -> Self {
        Self {
            machine: *machine,
            loaded: [None; 2 * SETTINGS],
            setting: 0,
            refused: false,
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

    /// One clock: what the outputs show before the rising edge, then the edge.
    pub fn step(&mut self, inputs: &Inputs) -> Outputs {
        let shown = self.outputs();
        if inputs.rst {
            *self = Self::new(&self.machine);
            return shown;
        }
        let loadable = matches!(inputs.setting_bank, 1 | 2) && inputs.setting_bank != inputs.bank;
        self.setting = self.word(inputs.bank, inputs.row);
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
        }
    }
}

impl Moore for SettingBanks {
    fn show(&self, outputs: &mut [u64]) {
        for (output, value) in outputs.iter_mut().zip(self.outputs().to_raw()) {
            *output = value;
        }
    }

    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        let Ok(inputs) = <&[u64; INPUT_PORTS]>::try_from(inputs).map(Inputs::from_raw) else {
            return 0;
        };
        let stays = self.setting == self.word(inputs.bank, inputs.row) && !self.refused;
        match stays && !inputs.rst && !inputs.setting_write {
            true => FOREVER,
            false => 0,
        }
    }

    fn ignores(&self, input: &str) -> bool {
        matches!(input, "setting_bank" | "setting_row" | "setting_word")
    }
}

clocked_block!(SettingBanks, "the setting banks' module");
