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
use super::{ClockedBlock, Direction, FOREVER, Moore, Port, StepError};

/// The ports in the order of the Verilog's port list, without `clk`.
pub fn ports() -> Vec<Port> {
    use Direction::{Input, Output};
    let port = |name: &str, direction, width| Port {
        name: name.to_owned(),
        direction,
        width,
        signed: false,
    };
    vec![
        port("rst", Input, 1),
        port("setting_write", Input, 1),
        port("setting_bank", Input, 2),
        port("setting_row", Input, 4),
        port("setting_word", Input, 32),
        port("bank", Input, 2),
        port("row", Input, 4),
        port("setting", Output, 32),
        port("setting_refused", Output, 1),
    ]
}

/// The banks, cycle accurate at their ports.
#[derive(Debug, Clone)]
pub struct SettingBanks {
    ports: Vec<Port>,
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
            ports: ports(),
            machine: *machine,
            loaded: [None; 2 * SETTINGS],
            setting: 0,
            refused: false,
        }
    }

    fn word(&self, bank: u64, row: usize) -> u32 {
        match bank {
            0 => self.machine.word(row),
            1 | 2 => self.loaded[(bank as usize - 1) * SETTINGS + row].unwrap_or(0),
            _ => 0,
        }
    }
}

impl Moore for SettingBanks {
    fn show(&self, outputs: &mut [u64]) {
        for (output, value) in outputs.iter_mut().zip([self.setting.into(), self.refused.into()]) {
            *output = value;
        }
    }

    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        let &[reset, write, .., bank, row] = inputs else {
            return 0;
        };
        let stays = self.setting == self.word(bank & 3, row as usize & 0xf) && !self.refused;
        if reset & 1 == 0 && write & 1 == 0 && stays {
            FOREVER
        } else {
            0
        }
    }

    fn ignores(&self, input: &str) -> bool {
        matches!(input, "setting_bank" | "setting_row" | "setting_word")
    }
}

impl ClockedBlock for SettingBanks {
    fn ports(&self) -> &[Port] {
        &self.ports
    }

    fn step(&mut self, inputs: &[u64], outputs: &mut [u64]) -> Result<(), StepError> {
        let (&[reset, write, to_bank, to_row, word, bank, row], 2) = (inputs, outputs.len()) else {
            return Err(StepError(format!(
                "{} inputs and {} outputs: the setting banks have 7 and 2",
                inputs.len(),
                outputs.len()
            )));
        };
        self.show(outputs);
        let (to_bank, bank) = (to_bank & 3, bank & 3);
        self.setting = self.word(bank, row as usize & 0xf);
        let loadable = matches!(to_bank, 1 | 2) && to_bank != bank;
        self.refused = write & 1 != 0 && !loadable;
        if write & 1 != 0 && loadable {
            self.loaded[(to_bank as usize - 1) * SETTINGS + (to_row as usize & 0xf)] = Some(word as u32);
        }
        if reset & 1 != 0 {
            self.loaded = [None; 2 * SETTINGS];
            self.refused = false;
            self.setting = 0;
        }
        Ok(())
    }
}
