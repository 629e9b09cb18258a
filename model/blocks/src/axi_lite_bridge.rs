//! The bridge from AXI4-Lite to the registers: a subordinate of AXI4-Lite, and a host of the registers' bus.
//!
//! The datasheet is `docs/axi_lite_bridge.md`; the hardware is compared with this reference model.
//!
//! ```text
//! aw ─► queue ─┐
//! w  ─► queue ─┼─► one access per clock ─► avm_*        ┌─► queue ─► b
//! ar ─► queue ─┘                       registers answer └─► queue ─► queue ─► r
//! ```
//!
//! - Address and data of a write may come in any order, and any clocks apart. The access is made once both are there.
//! - Reads and writes that wait together take turns. Each gets one answer, in the order of its kind.
//! - An access to a word without a register is answered by SLVERR, any other by OKAY.
//! - A write without a byte (`s_axi_wstrb` = 0) is answered, and does not reach the registers.
//! - Every output is a function of registers: no path leads from a `ready` to a `valid`, or back.
//!
//! ```text
//! clock              0      1      2      3      4
//! a read   ar ready & valid | avm_read | data | in queue | r valid
//! a write  aw, w ready & valid | avm_write | b valid
//! ```

use super::{Moore, clocked_block, ports, show_each};

/// Clocks from the handshake of an address to `s_axi_rvalid`, where nothing waits.
pub const READ_CLOCKS: u32 = 4;
/// Clocks from the later handshake of address and data to `s_axi_bvalid`, where nothing waits.
pub const WRITE_CLOCKS: u32 = 2;
/// Reads that are accepted by the registers before the first of them is taken.
const MOST_READS: u8 = 4;

ports! {
    axi_lite_bridge_ports;

    /// The input ports. Bits above a port's width are ignored.
    inputs Inputs {
        /// Synchronous reset.
        rst: Bit as bool;
        /// Byte address of a write; the lowest two bits are ignored.
        s_axi_awaddr: Bits(18) as u32;
        /// The address of a write is there.
        s_axi_awvalid: Bit as bool;
        /// Data of a write.
        s_axi_wdata: Bits(32) as u32;
        /// Bytes of the data that are written.
        s_axi_wstrb: Bits(4) as u8;
        /// The data of a write is there.
        s_axi_wvalid: Bit as bool;
        /// The manager takes the answer to a write.
        s_axi_bready: Bit as bool;
        /// Byte address of a read; the lowest two bits are ignored.
        s_axi_araddr: Bits(18) as u32;
        /// The address of a read is there.
        s_axi_arvalid: Bit as bool;
        /// The manager takes the answer to a read.
        s_axi_rready: Bit as bool;
        /// Data of the registers, in the clock after `avm_read`.
        avm_readdata: Bits(32) as u32;
        /// Beside `avm_address`: there is a register.
        avm_mapped: Bit as bool;
    }

    /// The output ports, functions of registers only.
    outputs Outputs {
        /// The address of a write is taken.
        s_axi_awready: Bit as bool;
        /// The data of a write is taken.
        s_axi_wready: Bit as bool;
        /// Answer to a write: 0 OKAY, 2 SLVERR.
        s_axi_bresp: Bits(2) as u8;
        /// The answer to a write is there.
        s_axi_bvalid: Bit as bool;
        /// The address of a read is taken.
        s_axi_arready: Bit as bool;
        /// Data of a read.
        s_axi_rdata: Bits(32) as u32;
        /// Answer to a read: 0 OKAY, 2 SLVERR.
        s_axi_rresp: Bits(2) as u8;
        /// The answer to a read is there.
        s_axi_rvalid: Bit as bool;
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

/// The answer OKAY or SLVERR.
fn answer(failed: bool) -> u8 {
    u8::from(failed) << 1
}

/// A queue of two entries: the next one that comes out, and one behind it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Queue<T> {
    first: T,
    second: T,
    /// Whether there is an entry, and whether there are two.
    holds: bool,
    full: bool,
}

impl<T: Copy> Queue<T> {
    /// Simulates a clock: takes the first entry if `take`, and puts an entry in if there is one and it was not full.
    fn clock(&mut self, put: Option<T>, take: bool) {
        let put = put.filter(|_| !self.full);
        if take && self.holds {
            self.first = self.second;
            self.holds = self.full;
            self.full = false;
        }
        let Some(entry) = put else { return };
        if self.holds {
            self.second = entry;
            self.full = true;
        } else {
            self.first = entry;
            self.holds = true;
        }
    }
}

/// The cycle-accurate model of the bridge.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct AxiLiteBridge {
    /// Low in the clock after a reset, in which nothing is taken.
    awake: bool,
    write_addresses: Queue<u16>,
    /// Data and bytes.
    write_words: Queue<(u32, u8)>,
    read_addresses: Queue<u16>,
    /// Whether a write failed.
    write_answers: Queue<bool>,
    /// Whether a read failed, and its word.
    read_words: Queue<(u32, bool)>,
    read_answers: Queue<(u32, bool)>,
    /// Reads that have begun and whose answers were not taken.
    open_reads: u8,
    /// Whether a read goes first where a write waits, too.
    read_first: bool,
    /// Whether a read began in the clock before, and whether it failed.
    reading: bool,
    failed: bool,
}

impl AxiLiteBridge {
    /// The bridge after reset.
    pub fn new() -> Self {
        Self::default()
    }

    /// Whether a read, and whether a write begins in this clock.
    fn begins(&self) -> (bool, bool) {
        let can_write = self.write_addresses.holds && self.write_words.holds && !self.write_answers.full;
        let can_read = self.read_addresses.holds && self.open_reads < MOST_READS;
        (
            can_read && (self.read_first || !can_write),
            can_write && !(self.read_first && can_read),
        )
    }

    /// The outputs in this clock.
    pub fn outputs(&self) -> Outputs {
        let (reads, writes) = self.begins();
        let (avm_writedata, avm_byteenable) = self.write_words.first;
        let (s_axi_rdata, failed) = self.read_answers.first;
        Outputs {
            s_axi_awready: self.awake && !self.write_addresses.full,
            s_axi_wready: self.awake && !self.write_words.full,
            s_axi_bresp: answer(self.write_answers.first),
            s_axi_bvalid: self.write_answers.holds,
            s_axi_arready: self.awake && !self.read_addresses.full,
            s_axi_rdata,
            s_axi_rresp: answer(failed),
            s_axi_rvalid: self.read_answers.holds,
            avm_address: if writes {
                self.write_addresses.first
            } else {
                self.read_addresses.first
            },
            avm_read: reads,
            avm_write: writes && avm_byteenable != 0,
            avm_byteenable,
            avm_writedata,
        }
    }

    /// Simulates one clock: returns the outputs before the rising edge, then clocks.
    pub fn step(&mut self, inputs: &Inputs) -> Outputs {
        let shown = self.outputs();
        if inputs.rst {
            *self = Self::default();
            return shown;
        }
        let (reads, writes) = self.begins();
        let word = |address: u32| (address >> 2) as u16;
        let awake = self.awake;
        let taken = |valid: bool| valid && awake;
        let address = taken(inputs.s_axi_awvalid).then_some(word(inputs.s_axi_awaddr));
        self.write_addresses.clock(address, writes);
        let data = taken(inputs.s_axi_wvalid).then_some((inputs.s_axi_wdata, inputs.s_axi_wstrb));
        self.write_words.clock(data, writes);
        let address = taken(inputs.s_axi_arvalid).then_some(word(inputs.s_axi_araddr));
        self.read_addresses.clock(address, reads);
        self.write_answers
            .clock(writes.then_some(!inputs.avm_mapped), inputs.s_axi_bready);

        let answered = shown.s_axi_rvalid && inputs.s_axi_rready;
        self.open_reads = self.open_reads + u8::from(reads) - u8::from(answered);
        let moves = self.read_words.holds && !self.read_answers.full;
        let moved = moves.then_some(self.read_words.first);
        self.read_answers.clock(moved, inputs.s_axi_rready);
        let word = self.reading.then_some((inputs.avm_readdata, self.failed));
        self.read_words.clock(word, moves);
        self.reading = reads;
        self.failed = !inputs.avm_mapped;
        if reads || writes {
            self.read_first = writes;
        }
        self.awake = true;
        shown
    }
}

impl Moore for AxiLiteBridge {
    fn show(&self, outputs: &mut [u64]) {
        show_each(outputs, self.outputs().to_raw());
    }
}

clocked_block!(AxiLiteBridge, "the AXI4-Lite bridge");

#[cfg(test)]
mod tests {
    use super::*;

    /// Plays a manager that is always ready, and returns the clocks of `avm_write`, `avm_read`, `bvalid` and `rvalid`.
    fn clocks(offered: impl Fn(u64) -> Inputs) -> [Vec<u64>; 4] {
        let mut bridge = AxiLiteBridge::new();
        bridge.step(&Inputs::default());
        let mut found = [const { Vec::new() }; 4];
        for clock in 0..20 {
            let shown = bridge.step(&Inputs {
                s_axi_bready: true,
                s_axi_rready: true,
                avm_mapped: true,
                ..offered(clock)
            });
            let seen = [shown.avm_write, shown.avm_read, shown.s_axi_bvalid, shown.s_axi_rvalid];
            for (list, seen) in found.iter_mut().zip(seen) {
                list.extend(seen.then_some(clock));
            }
        }
        found
    }

    #[test]
    fn accesses_take_the_stated_clocks() {
        let write = clocks(|clock| Inputs {
            s_axi_awvalid: clock == 0,
            s_axi_wvalid: clock == 3,
            s_axi_wstrb: 0xf,
            ..Inputs::default()
        });
        assert_eq!(write, [vec![4], vec![], vec![3 + u64::from(WRITE_CLOCKS)], vec![]]);
        let read = clocks(|clock| Inputs {
            s_axi_arvalid: clock == 0,
            ..Inputs::default()
        });
        assert_eq!(read, [vec![], vec![1], vec![], vec![u64::from(READ_CLOCKS)]]);
    }

    #[test]
    fn reads_or_writes_alone_come_one_per_clock_and_take_turns_together() {
        let ten = |clock: u64| clock < 10;
        let reads = clocks(|clock| Inputs {
            s_axi_arvalid: ten(clock),
            ..Inputs::default()
        });
        assert_eq!(reads[1], (1..11).collect::<Vec<_>>());
        assert_eq!(reads[3], (4..14).collect::<Vec<_>>());
        let writes = clocks(|clock| Inputs {
            s_axi_awvalid: ten(clock),
            s_axi_wvalid: ten(clock),
            s_axi_wstrb: 1,
            ..Inputs::default()
        });
        assert_eq!(writes[0], (1..11).collect::<Vec<_>>());
        let both = clocks(|clock| Inputs {
            s_axi_awvalid: true,
            s_axi_wvalid: true,
            s_axi_wstrb: 1,
            s_axi_arvalid: ten(clock),
            ..Inputs::default()
        });
        assert_eq!(both[1], [2, 4, 6, 8, 10, 12]);
    }

    #[test]
    fn words_without_a_register_and_writes_without_bytes_are_answered() {
        let mut bridge = AxiLiteBridge::new();
        bridge.step(&Inputs::default());
        let mut shown = Vec::new();
        for clock in 0..8 {
            shown.push(bridge.step(&Inputs {
                s_axi_awvalid: clock < 2,
                s_axi_awaddr: 0x3_0004 + 4 * clock,
                s_axi_wvalid: clock < 2,
                s_axi_wstrb: if clock == 0 { 0xf } else { 0 },
                s_axi_bready: true,
                avm_mapped: clock != 1,
                ..Inputs::default()
            }));
        }
        assert_eq!((shown[1].avm_address, shown[1].avm_write), (0xc001, true));
        assert_eq!((shown[2].avm_address, shown[2].avm_write), (0xc002, false));
        assert_eq!((shown[2].s_axi_bresp, shown[3].s_axi_bresp), (2, 0));
    }
}
