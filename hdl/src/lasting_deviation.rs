//! Passes the deviation from a scale on to the supervisor once it has lasted.
//!
//! The reference is `posicast_blocks::lasting_deviation`.

use crate::emit::{self, EmitError, EmitOptions, Header, Module};
use crate::prelude::*;
use crate::simulation::{Simulated, SimulationError};
use posicast_blocks::lasting_deviation::{PORTS, ports};
use posicast_blocks::{ClockedBlock, port_notes};

kernel! {
    struct LastingDeviation;
    ports posicast_blocks::lasting_deviation_ports;

    registers { beyond: Bit, count: Bits<16>, lasting_q: Signed<32> }
    wires { deviation_bits: Bits<32>, size: Bits<32> }
    constants {
        no_ticks: Bits<16> = from_u64(0),
        one: Bits<16> = from_u64(1),
        nothing: Signed<32> = from_i64(0),
    }
}

impl Logic for LastingDeviation {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module lasting_deviation");

        comment!("Magnitude, as the supervisor takes it");
        self.deviation_bits.next = unsigned_cast(self.deviation.val());
        self.size.next = self.deviation_bits.val();
        if self.deviation_bits.val().get_bit(31) {
            self.size.next = !self.deviation_bits.val();
        }
        self.beyond.d.next = self.size.val() > self.limit.val();

        comment!("Ticks in a row, up to the largest number");
        if self.tick.val() {
            self.count.d.next = self.no_ticks.val();
            if self.beyond.q.val() {
                self.count.d.next = self.count.q.val();
                if !self.count.q.val().all() {
                    self.count.d.next = self.count.q.val() + self.one.val();
                }
            }
        }

        self.lasting_q.d.next = self.nothing.val();
        if self.beyond.q.val() & (self.count.q.val() >= self.ticks.val()) {
            self.lasting_q.d.next = self.deviation.val();
        }
        self.lasting.next = self.lasting_q.q.val();
    }
}

/// The block in RustHDL's own simulator.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds an error in the block.
pub fn simulate() -> Result<Box<dyn ClockedBlock>, SimulationError> {
    let block = Box::new(LastingDeviation::default());
    Ok(Box::new(Simulated::new("lasting_deviation", block, ports())?))
}

/// Name of the last module that [`emit()`] writes.
pub fn name(prefix: &str) -> String {
    emit::shared_name(prefix, NAME)
}

const NAME: &str = "lasting_deviation";

/// Verilog of the block; [`name`] gives its name.
///
/// # Errors
/// [`EmitError`] where `prefix` is not a valid Verilog name.
pub fn emit(prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: NAME.to_owned(),
        prefix: prefix.to_owned(),
        header: Header {
            about: "Passes the deviation from a scale on to the supervisor once it has lasted for so many ticks."
                .to_owned(),
            ports: port_notes(PORTS),
            parameters: Vec::new(),
        },
    };
    emit::emit(&LastingDeviation::default(), &options)
}
