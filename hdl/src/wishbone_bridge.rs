//! The bridge from Wishbone to the registers in hardware.
//!
//! The datasheet is `docs/wishbone_bridge.md`, the reference `posicast_blocks::wishbone_bridge`.

use crate::emit::{self, EmitError, EmitOptions, Header, Module, Parameter};
use crate::prelude::*;
use crate::simulation::{Simulated, SimulationError};
use posicast_blocks::wishbone_bridge::{ANSWER_CLOCKS, PORTS, ports};
use posicast_blocks::{ClockedBlock, port_notes};

kernel! {
    struct WishboneBridge;
    ports posicast_blocks::wishbone_bridge_ports;

    registers {
        awake: Bit, address: Bits<16>, bytes: Bits<4>, word: Bits<32>, read_q: Bit, write_q: Bit, asked: Bit,
        passed: Bit, failed: Bit, data: Bits<32>, ack_q: Bit, err_q: Bit,
    }
    wires { open: Bit, takes: Bit, listens: Bit }
}

impl Logic for WishboneBridge {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module wishbone_bridge");
        comment!("A request of a classic bus stays until its answer");
        self.awake.d.next = true;
        self.open.next = self.asked.q.val() | self.passed.q.val() | self.ack_q.q.val() | self.err_q.q.val();
        self.takes.next =
            self.wb_cyc.val() & self.wb_stb.val() & self.awake.q.val() & (self.pipelined.val() | !self.open.val());

        comment!("The access");
        self.address.d.next = self.wb_adr.val();
        self.bytes.d.next = self.wb_sel.val();
        self.word.d.next = self.wb_dat_w.val();
        self.read_q.d.next = self.takes.val() & !self.wb_we.val();
        self.write_q.d.next = self.takes.val() & self.wb_we.val() & self.wb_sel.val().any();

        comment!("Its answer, if the master still waits for it");
        self.listens.next = self.wb_cyc.val() & (self.pipelined.val() | self.wb_stb.val());
        self.asked.d.next = self.takes.val();
        self.passed.d.next = self.asked.q.val() & self.listens.val();
        self.failed.d.next = !self.avm_mapped.val();
        self.data.d.next = self.avm_readdata.val();
        self.ack_q.d.next = self.passed.q.val() & !self.failed.q.val() & self.listens.val();
        self.err_q.d.next = self.passed.q.val() & self.failed.q.val() & self.listens.val();

        self.wb_dat_r.next = self.data.q.val();
        self.wb_ack.next = self.ack_q.q.val();
        self.wb_err.next = self.err_q.q.val();
        self.wb_stall.next = !self.awake.q.val();
        self.avm_address.next = self.address.q.val();
        self.avm_read.next = self.read_q.q.val();
        self.avm_write.next = self.write_q.q.val();
        self.avm_byteenable.next = self.bytes.q.val();
        self.avm_writedata.next = self.word.q.val();
    }
}

/// The bridge in RustHDL's own simulator.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds an error in the block.
pub fn simulate() -> Result<Box<dyn ClockedBlock>, SimulationError> {
    let block = Box::new(WishboneBridge::default());
    Ok(Box::new(Simulated::new("wishbone_bridge", block, ports())?))
}

/// The bridge's Verilog.
///
/// The module is called `posicast_wishbone_bridge`, or `wishbone_bridge` where `prefix` is empty.
///
/// # Errors
/// [`EmitError`] where `prefix` is not a valid Verilog name.
pub fn emit(prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: "wishbone_bridge".to_owned(),
        prefix: prefix.to_owned(),
        header: Header {
            about: "Bridge from Wishbone B4, classic or pipelined, to registers: err for a word without a register."
                .to_owned(),
            ports: port_notes(PORTS),
            parameters: vec![Parameter {
                name: "answer_clocks".to_owned(),
                value: ANSWER_CLOCKS.to_string(),
                meaning: "from a request to its answer".to_owned(),
            }],
        },
    };
    emit::emit(&WishboneBridge::default(), &options)
}
