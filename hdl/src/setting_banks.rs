//! The settings of a controller that stands alone: bank 0 a ROM with the machine's, banks 1 and 2 to be loaded.
//!
//! The reference is `posicast_model::rtl::setting_banks`. Which rows were written since the reset is kept in flip-flops,
//! since a memory has no reset: others read as 0.

use crate::emit::{self, EmitError, EmitOptions, Header, Module};
use crate::prelude::*;
use crate::simulation::{Pins, Simulated, SimulationError};
use posicast_model::rtl::ClockedBlock;
use posicast_model::rtl::setting_banks::ports;
use posicast_model::rtl::sliding_mode::{Row, Settings};

#[derive(LogicBlock)]
struct SettingBanks {
    clk: Signal<In, Clock>,
    rst: Signal<In, Bit>,
    setting_write: Signal<In, Bit>,
    setting_bank: Signal<In, Bits<2>>,
    setting_row: Signal<In, Bits<4>>,
    setting_word: Signal<In, Bits<32>>,
    bank: Signal<In, Bits<2>>,
    row: Signal<In, Bits<4>>,
    setting: Signal<Out, Bits<32>>,
    setting_refused: Signal<Out, Bit>,

    machine_settings: Rom<32, 4>,
    loaded_settings: Ram<32, 5>,
    written: Dff<Bits<32>>,
    known: Dff<Bit>,
    from_machine: Dff<Bit>,
    refused_q: Dff<Bit>,

    loadable: Signal<Local, Bit>,
    taken: Signal<Local, Bit>,
    write_half: Signal<Local, Bits<5>>,
    write_address: Signal<Local, Bits<5>>,
    read_half: Signal<Local, Bits<5>>,
    read_address: Signal<Local, Bits<5>>,
    in_loaded: Signal<Local, Bit>,

    bank_machine: Constant<Bits<2>>,
    bank_1: Constant<Bits<2>>,
    bank_2: Constant<Bits<2>>,
    lower_half: Constant<Bits<5>>,
    upper_half: Constant<Bits<5>>,
    one: Constant<Bits<32>>,
    nothing: Constant<Bits<32>>,
}

impl SettingBanks {
    fn new(machine: &Settings) -> Self {
        let word = |row: &Row| RomWord {
            pattern: machine.word(*row as usize).into(),
            meaning: format!("{row:?}"),
        };
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            setting_write: Signal::default(),
            setting_bank: Signal::default(),
            setting_row: Signal::default(),
            setting_word: Signal::default(),
            bank: Signal::default(),
            row: Signal::default(),
            setting: Signal::default(),
            setting_refused: Signal::default(),
            machine_settings: Rom::new("machine_settings", Row::ALL.iter().map(word).collect()),
            loaded_settings: Ram::default(),
            written: Dff::default(),
            known: Dff::default(),
            from_machine: Dff::default(),
            refused_q: Dff::default(),
            loadable: Signal::default(),
            taken: Signal::default(),
            write_half: Signal::default(),
            write_address: Signal::default(),
            read_half: Signal::default(),
            read_address: Signal::default(),
            in_loaded: Signal::default(),
            bank_machine: Constant::new(from_u64(0)),
            bank_1: Constant::new(from_u64(1)),
            bank_2: Constant::new(from_u64(2)),
            lower_half: Constant::new(from_u64(0)),
            upper_half: Constant::new(from_u64(16)),
            one: Constant::new(from_u64(1)),
            nothing: Constant::new(from_u64(0)),
        }
    }
}

impl Logic for SettingBanks {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module setting_banks");
        dff_setup!(self, clk, written, known, from_machine, refused_q);

        comment!("Writes: only to a bank that is not in use");
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

        comment!("Reads: what was not written is 0");
        self.read_half.next = self.lower_half.val();
        if self.bank.val() == self.bank_2.val() {
            self.read_half.next = self.upper_half.val();
        }
        self.read_address.next = self.read_half.val() | bit_cast::<5, 4>(self.row.val());
        self.in_loaded.next = (self.bank.val() == self.bank_1.val()) | (self.bank.val() == self.bank_2.val());
        self.known.d.next = self.in_loaded.val() & self.written.q.val().get_bit(self.read_address.val().index());
        self.from_machine.d.next = self.bank.val() == self.bank_machine.val();

        self.machine_settings.clk.next = self.clk.val();
        self.machine_settings.address.next = self.row.val();
        self.loaded_settings.clk.next = self.clk.val();
        self.loaded_settings.write_enable.next = self.taken.val();
        self.loaded_settings.write_address.next = self.write_address.val();
        self.loaded_settings.write_data.next = self.setting_word.val();
        self.loaded_settings.read_address.next = self.read_address.val();

        self.setting.next = self.nothing.val();
        if self.known.q.val() {
            self.setting.next = self.loaded_settings.read_data.val();
        }
        if self.from_machine.q.val() {
            self.setting.next = self.machine_settings.data.val();
        }
        self.setting_refused.next = self.refused_q.q.val();
    }
}

impl Pins for SettingBanks {
    fn set_clk(&mut self, level: bool) {
        self.clk.next = level.into();
    }

    fn drive(&mut self, inputs: &[u64]) {
        let mut values = inputs.iter().copied();
        let mut next = || values.next().unwrap_or_default();
        self.rst.next = next() & 1 != 0;
        self.setting_write.next = next() & 1 != 0;
        self.setting_bank.next = from_u64(next());
        self.setting_row.next = from_u64(next());
        self.setting_word.next = from_u64(next());
        self.bank.next = from_u64(next());
        self.row.next = from_u64(next());
    }

    fn read(&self, outputs: &mut [u64]) {
        let shown = [self.setting.val().into(), u64::from(self.setting_refused.val())];
        for (output, value) in outputs.iter_mut().zip(shown) {
            *output = value;
        }
    }
}

/// The banks in RustHDL's own simulator.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds a fault in the block.
pub fn simulate(machine: &Settings) -> Result<Box<dyn ClockedBlock>, SimulationError> {
    let block = Box::new(SettingBanks::new(machine));
    Ok(Box::new(Simulated::new("setting_banks", block, ports())?))
}

/// The banks' Verilog, with the machine's settings in bank 0: `PREFIX_setting_banks`, or `setting_banks` where `prefix` is
/// empty, last.
///
/// # Errors
/// [`EmitError`] where `prefix` makes no Verilog name.
pub fn emit(machine: &Settings, prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: "setting_banks".to_owned(),
        prefix: prefix.to_owned(),
        header: Header {
            about: "Settings of a controller: bank 0 is the machine's, banks 1 and 2 can be loaded.\n\
                    A row that was not written since the reset reads as 0."
                .to_owned(),
            parameters: Vec::new(),
        },
    };
    emit::emit(&SettingBanks::new(machine), &options)
}
