//! What a host's correction of missing steps does in hardware: the deviation counts anew, and the steps are counted.
//!
//! The reference is `posicast_blocks::realign`.

use crate::emit::{self, EmitError, EmitOptions, Header, Module};
use crate::prelude::*;
use crate::simulation::{Simulated, SimulationError};
use posicast_blocks::realign::{PORTS, ports};
use posicast_blocks::{ClockedBlock, port_notes};

kernel! {
    struct Realign;
    ports posicast_blocks::realign_ports;

    registers { align_q: Bit, corrected: Signed<32> }
    wires { added: Signed<32> }
}

impl Logic for Realign {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module realign");
        self.align_q.d.next = self.enabled.val() | self.correct.val();
        self.added.next = signed_bit_cast::<32, 16>(self.realign_steps.val());
        if self.correct.val() {
            self.corrected.d.next = self.corrected.q.val() + self.added.val();
        }
        self.align.next = self.align_q.q.val();
        self.corrected_steps.next = self.corrected.q.val();
    }
}

/// The block in RustHDL's own simulator.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds an error in the block.
pub fn simulate() -> Result<Box<dyn ClockedBlock>, SimulationError> {
    let block = Box::new(Realign::default());
    Ok(Box::new(Simulated::new("realign", block, ports())?))
}

const NAME: &str = "realign";

/// Name of the last module that [`emit()`] writes.
pub fn name(prefix: &str) -> String {
    emit::shared_name(prefix, NAME)
}

/// Verilog of the block; [`name`] gives its name.
///
/// # Errors
/// [`EmitError`] where `prefix` is not a valid Verilog name.
pub fn emit(prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: NAME.to_owned(),
        prefix: prefix.to_owned(),
        header: Header {
            about: "Counts the deviation from the scale anew when the axis is switched on or a host corrects it, and counts the steps."
                .to_owned(),
            ports: port_notes(PORTS),
            parameters: Vec::new(),
        },
    };
    emit::emit(&Realign::default(), &options)
}
