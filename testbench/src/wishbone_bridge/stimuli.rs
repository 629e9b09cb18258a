//! Seeded random inputs for the Wishbone bridge: a classic master, which keeps its request until the answer, and a pipelined one;
//! both leave a cycle at times before it is answered. Words with and without a register; resets at any time.

use posicast_blocks::wishbone_bridge::{Inputs, Outputs};
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::blocks::Bins;
use crate::lockstep::Clock;
use crate::stimuli::table::pick;
use crate::stimuli::{Stimuli, row};

/// An endless random mixture of all inputs.
#[derive(Debug, Clone)]
pub struct WishboneBridgeRandom {
    rng: Xoshiro256PlusPlus,
    clock: u64,
    /// Clocks of a thousand in which a request begins, and in which the cycle is left.
    pace: u32,
    leaves: u32,
    offered: Inputs,
}

impl WishboneBridgeRandom {
    /// Creates the generator. Equal seeds give equal inputs.
    pub fn new(seed: u64) -> Self {
        Self {
            rng: Xoshiro256PlusPlus::seed_from_u64(seed),
            clock: 0,
            pace: 1000,
            leaves: 0,
            offered: Inputs::default(),
        }
    }

    fn in_a_thousand(&mut self, chances: u32) -> bool {
        self.rng.random_range(0..1000) < chances
    }
}

impl Stimuli for WishboneBridgeRandom {
    fn fill(&mut self, seen: &[u64], inputs: &mut [u64]) {
        let seen = Outputs::from_raw(&row(seen));
        if self.rng.random_range(0..200) == 0 {
            self.pace = *pick(&mut self.rng, &[20, 300, 700, 1000, 1000]);
            self.leaves = *pick(&mut self.rng, &[0, 0, 30, 300]);
        }
        let before = self.offered;
        let mut next = Inputs {
            rst: self.clock < 2 || self.rng.random_range(0..3000) == 0,
            avm_readdata: self.rng.next_u32(),
            avm_mapped: self.rng.random_range(0..4) != 0,
            ..before
        };
        if self.rng.random_range(0..1000) == 0 {
            next.pipelined = !before.pipelined;
        }
        let answered = seen.wb_ack || seen.wb_err;
        let kept = before.wb_stb && if before.pipelined { seen.wb_stall } else { !answered };
        if !kept {
            next.wb_stb = self.in_a_thousand(self.pace);
            next.wb_we = self.rng.random();
            next.wb_adr = self.rng.random();
            next.wb_sel = *pick(&mut self.rng, &[0xf, 0xf, 0, 1, 2, 4, 8, 5]);
            next.wb_dat_w = self.rng.next_u32();
        }
        next.wb_cyc = !self.in_a_thousand(self.leaves);
        // A master that leaves the cycle withdraws its request, or should.
        next.wb_stb &= next.wb_cyc || self.rng.random_range(0..4) == 0;
        self.offered = next;
        self.clock += 1;
        inputs.copy_from_slice(&next.to_raw());
    }
}

/// Counts of the events in a lockstep run.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct WishboneBridgeCoverage {
    counts: [u64; NAMES.len()],
    open: bool,
    accessed: bool,
}

/// What is counted.
const NAMES: [&str; 10] = [
    "writes of whole words, classic",
    "writes of whole words, pipelined",
    "writes of some bytes",
    "reads, classic",
    "reads, pipelined",
    "acknowledged",
    "errors",
    "accesses in successive clocks",
    "cycles that were left",
    "resets",
];

impl Bins for WishboneBridgeCoverage {
    fn observe(&mut self, clock: &Clock<'_>) {
        let (inputs, shown) = (
            Inputs::from_raw(&row(clock.inputs)),
            Outputs::from_raw(&row(clock.expected)),
        );
        let accesses = shown.avm_read || shown.avm_write;
        let whole = shown.avm_write && shown.avm_byteenable == 0xf;
        let seen = [
            whole && !inputs.pipelined,
            whole && inputs.pipelined,
            shown.avm_write && !whole,
            shown.avm_read && !inputs.pipelined,
            shown.avm_read && inputs.pipelined,
            shown.wb_ack,
            shown.wb_err,
            accesses && self.accessed,
            self.open && !inputs.wb_cyc,
            inputs.rst,
        ];
        (self.open, self.accessed) = (accesses, accesses);
        for (count, seen) in self.counts.iter_mut().zip(seen) {
            *count += u64::from(seen);
        }
    }

    fn counts(&self) -> Vec<(String, u64)> {
        NAMES.map(str::to_owned).into_iter().zip(self.counts).collect()
    }
}
