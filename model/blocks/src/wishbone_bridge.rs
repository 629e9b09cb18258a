//! The bridge from Wishbone B4 to the registers: a device of Wishbone, classic or pipelined, and a host of the registers' bus.
//!
//! The datasheet is `docs/wishbone_bridge.md`; the hardware is compared with this reference model.
//!
//! ```text
//! clock       0        1           2      3
//! request  stb & cyc | avm_*     | data | ack or err, with the data of a read
//! ```
//!
//! - **Classic**: a request is one clock of `wb_stb` and `wb_cyc` in which no other request is open. It is answered in the third
//!   clock after it; the clock of the answer takes no request.
//! - **Pipelined**: every clock of `wb_stb` and `wb_cyc` without `wb_stall` is a request, and each is answered in the third clock
//!   after it. `wb_stall` is high in the clock after a reset only.
//! - An access to a word without a register is answered by `wb_err`, any other by `wb_ack`.
//! - A write without a byte (`wb_sel` = 0) is answered, and does not reach the registers.
//! - When `wb_cyc` falls, what is open is not answered any more; a write that was taken reaches the registers.
//! - Every output is a function of registers.

use super::{Moore, clocked_block, ports, show_each};

/// Clocks from a request to its answer.
pub const ANSWER_CLOCKS: u32 = 3;

ports! {
    wishbone_bridge_ports;

    /// The input ports. Bits above a port's width are ignored.
    inputs Inputs {
        /// Synchronous reset.
        rst: Bit as bool;
        /// Constant: every clock of `wb_stb` is a request. Low: `wb_stb` stays until the answer.
        pipelined: Bit as bool;
        /// A bus cycle is going on.
        wb_cyc: Bit as bool;
        /// Request.
        wb_stb: Bit as bool;
        /// High: a write.
        wb_we: Bit as bool;
        /// Word address.
        wb_adr: Bits(16) as u16;
        /// Bytes that are written.
        wb_sel: Bits(4) as u8;
        /// Word that is written.
        wb_dat_w: Bits(32) as u32;
        /// Data of the registers, in the clock after `avm_read`.
        avm_readdata: Bits(32) as u32;
        /// Beside `avm_address`: there is a register.
        avm_mapped: Bit as bool;
    }

    /// The output ports, functions of registers only.
    outputs Outputs {
        /// Word that was read, beside `wb_ack`.
        wb_dat_r: Bits(32) as u32;
        /// One clock: the answer to a request.
        wb_ack: Bit as bool;
        /// One clock: the answer to a request for a word without a register.
        wb_err: Bit as bool;
        /// No request is taken; for a pipelined bus.
        wb_stall: Bit as bool;
        /// Word address.
        avm_address: Bits(16) as u16;
        /// One clock per read.
        avm_read: Bit as bool;
        /// One clock per write.
        avm_write: Bit as bool;
        /// Bytes that are written.
        avm_byteenable: Bits(4) as u8;
        /// Word that is written.
        avm_writedata: Bits(32) as u32;
    }
}

/// The cycle-accurate model of the bridge.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct WishboneBridge {
    /// Low in the clock after a reset, in which nothing is taken.
    awake: bool,
    address: u16,
    bytes: u8,
    word: u32,
    /// Whether the registers are read, or written, in this clock.
    read: bool,
    write: bool,
    /// Whether a request is answered two clocks from here, or in the next one; and whether the latter failed.
    asked: bool,
    passed: bool,
    failed: bool,
    data: u32,
    ack: bool,
    err: bool,
}

impl WishboneBridge {
    /// The bridge after reset.
    pub fn new() -> Self {
        Self::default()
    }

    /// The outputs in this clock.
    pub fn outputs(&self) -> Outputs {
        Outputs {
            wb_dat_r: self.data,
            wb_ack: self.ack,
            wb_err: self.err,
            wb_stall: !self.awake,
            avm_address: self.address,
            avm_read: self.read,
            avm_write: self.write,
            avm_byteenable: self.bytes,
            avm_writedata: self.word,
        }
    }

    /// Simulates one clock: returns the outputs before the rising edge, then clocks.
    pub fn step(&mut self, inputs: &Inputs) -> Outputs {
        let shown = self.outputs();
        if inputs.rst {
            *self = Self::default();
            return shown;
        }
        let open = self.asked || self.passed || self.ack || self.err;
        let takes = inputs.wb_cyc && inputs.wb_stb && self.awake && (inputs.pipelined || !open);
        // A master that has left the cycle, or of a classic bus the request, gets no answer.
        let listens = inputs.wb_cyc && (inputs.pipelined || inputs.wb_stb);
        *self = Self {
            awake: true,
            address: inputs.wb_adr,
            bytes: inputs.wb_sel,
            word: inputs.wb_dat_w,
            read: takes && !inputs.wb_we,
            write: takes && inputs.wb_we && inputs.wb_sel != 0,
            asked: takes,
            passed: self.asked && listens,
            failed: !inputs.avm_mapped,
            data: inputs.avm_readdata,
            ack: self.passed && !self.failed && listens,
            err: self.passed && self.failed && listens,
        };
        shown
    }
}

impl Moore for WishboneBridge {
    fn show(&self, outputs: &mut [u64]) {
        show_each(outputs, self.outputs().to_raw());
    }
}

clocked_block!(WishboneBridge, "the Wishbone bridge");

#[cfg(test)]
mod tests {
    use super::*;

    /// Requests in these clocks; returns the clocks of `avm_read` and `wb_ack`.
    fn clocks(pipelined: bool, requests: impl Fn(u64) -> bool) -> [Vec<u64>; 2] {
        let mut bridge = WishboneBridge::new();
        bridge.step(&Inputs::default());
        let mut found = [const { Vec::new() }; 2];
        for clock in 0..16 {
            let shown = bridge.step(&Inputs {
                pipelined,
                wb_cyc: true,
                wb_stb: requests(clock),
                avm_mapped: true,
                ..Inputs::default()
            });
            for (list, seen) in found.iter_mut().zip([shown.avm_read, shown.wb_ack]) {
                list.extend(seen.then_some(clock));
            }
        }
        found
    }

    #[test]
    fn a_request_that_stays_until_its_answer_is_one() {
        let answer = u64::from(ANSWER_CLOCKS);
        assert_eq!(clocks(false, |clock| clock <= answer), [vec![1], vec![answer]]);
        assert_eq!(clocks(false, |_| true), [vec![1, 5, 9, 13], vec![3, 7, 11, 15]]);
    }

    #[test]
    fn a_pipelined_request_comes_in_every_clock() {
        let [reads, answers] = clocks(true, |clock| clock < 6);
        assert_eq!(reads, (1..7).collect::<Vec<_>>());
        assert_eq!(answers, (3..9).collect::<Vec<_>>());
    }

    #[test]
    fn a_master_that_leaves_the_cycle_gets_no_answer_and_its_write_is_made() {
        for left in 1..=3 {
            let mut bridge = WishboneBridge::new();
            bridge.step(&Inputs::default());
            let (mut writes, mut answers) = (0, 0);
            for clock in 0..10 {
                let shown = bridge.step(&Inputs {
                    pipelined: true,
                    wb_cyc: clock < left,
                    wb_stb: clock == 0,
                    wb_we: true,
                    wb_sel: 0xf,
                    avm_mapped: true,
                    ..Inputs::default()
                });
                writes += u32::from(shown.avm_write);
                answers += u32::from(shown.wb_ack || shown.wb_err);
            }
            assert_eq!((writes, answers), (1, u32::from(left == 3)), "{left}");
        }
    }
}
