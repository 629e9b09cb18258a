//! The settings of a controller that stands alone: bank 0 is a ROM with the machine's settings, banks 1 and 2 can be
//! loaded.
//!
//! The reference is `posicast_blocks::setting_banks`. A memory has no reset, so flip-flops mark the rows that were
//! written since the reset; other rows read as 0. A host can read back any row while the controller is not busy.

use crate::emit::{self, EmitError, EmitOptions, Header, Module, own_name};
use crate::prelude::*;
use crate::simulation::{Simulated, SimulationError};
use posicast_blocks::setting_banks::{PORTS, ports};
use posicast_blocks::sliding_mode::{SettingRow, Settings};
use posicast_blocks::{ClockedBlock, port_notes};

kernel! {
    struct SettingBanks(machine: &Settings, rom: &str);
    ports posicast_blocks::setting_banks_ports;

    parts {
        machine_settings: Rom<32, 4> = machine_rom(machine, rom),
        loaded_settings: Ram<32, 5>,
    }
    registers { written: Bits<32>, known: Bit, from_machine: Bit, refused_q: Bit, read_waits: Bit, served: Bit, read_back: Bits<32> }
    wires {
        loadable: Bit, taken: Bit, write_half: Bits<5>, write_address: Bits<5>, read_half: Bits<5>,
        read_address: Bits<5>, in_loaded: Bit, serves: Bit, read_bank: Bits<2>, read_row: Bits<4>,
    }
    constants {
        bank_machine: Bits<2> = from_u64(0),
        bank_1: Bits<2> = from_u64(1),
        bank_2: Bits<2> = from_u64(2),
        lower_half: Bits<5> = from_u64(0),
        upper_half: Bits<5> = from_u64(16),
        one: Bits<32> = from_u64(1),
        nothing: Bits<32> = from_u64(0),
    }
    connect {
        loaded_settings: write_address, read_address;
    }
}

fn machine_rom(machine: &Settings, name: &str) -> Rom<32, 4> {
    let word = |row: &SettingRow| RomWord {
        pattern: machine.word(*row as usize).into(),
        meaning: format!("{row:?}"),
    };
    Rom::new(name, SettingRow::ALL.iter().map(word).collect())
}

impl Logic for SettingBanks {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module setting_banks");

        comment!("Writes go only to a bank that is not in use");
        self.loadable.next = ((self.setting_bank.val() == self.bank_1.val())
            | (self.setting_bank.val() == self.bank_2.val()))
            & (self.setting_bank.val() != self.bank.val());
        self.taken.next = self.setting_write.val() & self.loadable.val();
        self.refused_q.d.next = self.setting_write.val() & !self.loadable.val();
        self.write_half.next = self.lower_half.val();
        if self.setting_bank.val() == self.bank_2.val() {
            self.write_half.next = self.upper_half.val();
        }
        self.write_address.next = self.write_half.val() | bit_cast::<5, 4>(self.setting_row.val());
        if self.taken.val() {
            self.written.d.next = self.written.q.val() | (self.one.val() << self.write_address.val());
        }

        comment!("A host's read waits for a clock without busy and");
        comment!("without a write");
        self.serves.next =
            self.read_waits.q.val() & !self.served.q.val() & !self.busy.val() & !self.setting_write.val();
        self.served.d.next = self.serves.val();
        self.read_waits.d.next = self.setting_read.val() | (self.read_waits.q.val() & !self.served.q.val());
        self.read_bank.next = self.bank.val();
        self.read_row.next = self.row.val();
        if self.serves.val() {
            self.read_bank.next = self.setting_bank.val();
            self.read_row.next = self.setting_row.val();
        }

        comment!("A row that was not written reads as 0");
        self.read_half.next = self.lower_half.val();
        if self.read_bank.val() == self.bank_2.val() {
            self.read_half.next = self.upper_half.val();
        }
        self.read_address.next = self.read_half.val() | bit_cast::<5, 4>(self.read_row.val());
        self.in_loaded.next = (self.read_bank.val() == self.bank_1.val()) | (self.read_bank.val() == self.bank_2.val());
        self.known.d.next = self.in_loaded.val() & self.written.q.val().get_bit(self.read_address.val().index());
        self.from_machine.d.next = self.read_bank.val() == self.bank_machine.val();

        self.machine_settings.address.next = self.read_row.val();
        self.loaded_settings.write_enable.next = self.taken.val();
        self.loaded_settings.write_data.next = self.setting_word.val();

        self.setting.next = self.nothing.val();
        if self.known.q.val() {
            self.setting.next = self.loaded_settings.read_data.val();
        }
        if self.from_machine.q.val() {
            self.setting.next = self.machine_settings.data.val();
        }
        if self.served.q.val() {
            self.read_back.d.next = self.setting.val();
        }
        self.setting_refused.next = self.refused_q.q.val();
        self.setting_loaded.next = self.read_back.q.val();
        self.setting_read_waits.next = self.read_waits.q.val();
    }
}

/// The banks in RustHDL's own simulator.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds an error in the block.
pub fn simulate(machine: &Settings) -> Result<Box<dyn ClockedBlock>, SimulationError> {
    let block = Box::new(SettingBanks::new(machine, "machine_settings"));
    Ok(Box::new(Simulated::new("setting_banks", block, ports())?))
}

/// Name of the banks' module: `PREFIX_setting_banks`, or `setting_banks` where `prefix` is empty.
pub fn name(prefix: &str) -> String {
    own_name(prefix, "setting_banks")
}

/// Verilog of the banks with the machine's settings in bank 0; the last module is called [`name`].
///
/// # Errors
/// [`EmitError`] where `prefix` is not a valid Verilog name.
pub fn emit(machine: &Settings, prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: "setting_banks".to_owned(),
        prefix: prefix.to_owned(),
        header: Header {
            about: String::new(),
            ports: port_notes(PORTS),
            parameters: Vec::new(),
        },
    };
    emit::emit(&SettingBanks::new(machine, "machine_settings"), &options)
}
