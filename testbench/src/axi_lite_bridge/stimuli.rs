//! Seeded random inputs for the AXI4-Lite bridge: a manager that keeps what it offers until it is taken, with every channel at its
//! own pace, from standing still to every clock; words with and without a register; resets at any time.

use posicast_blocks::axi_lite_bridge::{Inputs, Outputs};
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::blocks::Bins;
use crate::lockstep::Clock;
use crate::stimuli::table::pick;
use crate::stimuli::{Stimuli, row};

/// Number of channels.
const CHANNELS: usize = 5;

/// An endless random mixture of all inputs.
#[derive(Debug, Clone)]
pub struct AxiLiteBridgeRandom {
    rng: Xoshiro256PlusPlus,
    clock: u64,
    /// Clocks of a thousand in which a channel offers something new, or takes an answer: write address, write data, answer,
    /// read address, answer.
    paces: [u32; CHANNELS],
    offered: Inputs,
}

impl AxiLiteBridgeRandom {
    /// Creates the generator. Equal seeds give equal inputs.
    pub fn new(seed: u64) -> Self {
        Self {
            rng: Xoshiro256PlusPlus::seed_from_u64(seed),
            clock: 0,
            paces: [1000; CHANNELS],
            offered: Inputs::default(),
        }
    }

    fn happens(&mut self, channel: usize) -> bool {
        self.rng.random_range(0..1000) < self.paces[channel]
    }
}

impl Stimuli for AxiLiteBridgeRandom {
    fn fill(&mut self, seen: &[u64], inputs: &mut [u64]) {
        let seen = Outputs::from_raw(&row(seen));
        if self.rng.random_range(0..150) == 0 {
            let channel = self.rng.random_range(0..CHANNELS);
            self.paces[channel] = *pick(&mut self.rng, &[0, 20, 300, 700, 1000, 1000]);
        }
        let rst = self.clock < 2 || self.rng.random_range(0..3000) == 0;
        let before = self.offered;
        let mut next = Inputs {
            rst,
            avm_readdata: self.rng.next_u32(),
            avm_mapped: self.rng.random_range(0..4) != 0,
            s_axi_bready: self.happens(2),
            s_axi_rready: self.happens(4),
            ..before
        };
        // A reset ends what is offered, as the bus demands.
        let kept = |valid: bool, ready: bool| valid && !ready && !before.rst && !rst;
        if !kept(before.s_axi_awvalid, seen.s_axi_awready) {
            next.s_axi_awvalid = !rst && self.happens(0);
            next.s_axi_awaddr = self.rng.next_u32();
        }
        if !kept(before.s_axi_wvalid, seen.s_axi_wready) {
            next.s_axi_wvalid = !rst && self.happens(1);
            next.s_axi_wdata = self.rng.next_u32();
            next.s_axi_wstrb = *pick(&mut self.rng, &[0xf, 0xf, 0, 1, 2, 4, 8, 5]);
        }
        if !kept(before.s_axi_arvalid, seen.s_axi_arready) {
            next.s_axi_arvalid = !rst && self.happens(3);
            next.s_axi_araddr = self.rng.next_u32();
        }
        self.offered = next;
        self.clock += 1;
        inputs.copy_from_slice(&next.to_raw());
    }
}

/// Counts of the events in a lockstep run.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct AxiLiteBridgeCoverage {
    counts: [u64; NAMES.len()],
    /// Addresses less words of writes that were taken.
    ahead: i64,
    accessed: bool,
}

/// What is counted.
const NAMES: [&str; 14] = [
    "writes of whole words",
    "writes of some bytes",
    "reads",
    "an address before its word",
    "a word before its address",
    "a write address that waits",
    "a word that waits",
    "a read address that waits",
    "an answer to a write that waits",
    "an answer to a read that waits",
    "SLVERR to a write",
    "SLVERR to a read",
    "accesses in successive clocks",
    "resets",
];

impl Bins for AxiLiteBridgeCoverage {
    fn observe(&mut self, clock: &Clock<'_>) {
        let (inputs, shown) = (
            Inputs::from_raw(&row(clock.inputs)),
            Outputs::from_raw(&row(clock.expected)),
        );
        let address = inputs.s_axi_awvalid && shown.s_axi_awready;
        let word = inputs.s_axi_wvalid && shown.s_axi_wready;
        self.ahead = if inputs.rst {
            0
        } else {
            self.ahead + i64::from(address) - i64::from(word)
        };
        let accesses = shown.avm_read || shown.avm_write;
        let seen = [
            shown.avm_write && shown.avm_byteenable == 0xf,
            shown.avm_write && shown.avm_byteenable != 0xf,
            shown.avm_read,
            self.ahead > 0,
            self.ahead < 0,
            inputs.s_axi_awvalid && !shown.s_axi_awready,
            inputs.s_axi_wvalid && !shown.s_axi_wready,
            inputs.s_axi_arvalid && !shown.s_axi_arready,
            shown.s_axi_bvalid && !inputs.s_axi_bready,
            shown.s_axi_rvalid && !inputs.s_axi_rready,
            shown.s_axi_bvalid && shown.s_axi_bresp != 0,
            shown.s_axi_rvalid && shown.s_axi_rresp != 0,
            accesses && self.accessed,
            inputs.rst,
        ];
        self.accessed = accesses;
        for (count, seen) in self.counts.iter_mut().zip(seen) {
            *count += u64::from(seen);
        }
    }

    fn counts(&self) -> Vec<(String, u64)> {
        NAMES.map(str::to_owned).into_iter().zip(self.counts).collect()
    }
}
