//! Seeded random inputs for register banks and components: valid and invalid Avalon traffic, among inputs that change
//! at any pace.
//!
//! Traffic comes in phases: dense, sparse, and reads only, so that what a register sets is also left unchanged for a
//! while. Addresses are mostly those of registers; words are random, single bits, small or full; the bytes are mostly
//! all enabled.

use posicast_blocks::registers::{Register, RegisterMap};
use posicast_blocks::{Direction, Port};
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::stimuli::Stimuli;
use crate::stimuli::table::pick;

/// Indices of the bus signals among the input ports, after `rst`.
pub(crate) const ADDRESS: usize = 1;
pub(crate) const READ: usize = 2;
pub(crate) const WRITE: usize = 3;
pub(crate) const BYTE_ENABLE: usize = 4;
pub(crate) const WRITE_DATA: usize = 5;
pub(crate) const BUS_INPUTS: usize = 6;

/// An input that does not belong to the bus, and its pace: it changes once in this many clocks.
#[derive(Debug, Clone)]
struct Pin {
    at: usize,
    width: u32,
    pace: u32,
    value: u64,
}

/// An endless random mixture of all inputs.
#[derive(Debug, Clone)]
pub struct RegistersRandom {
    pub(crate) rng: Xoshiro256PlusPlus,
    offsets: Vec<u64>,
    /// Mask of the bits of an address.
    address_ones: u64,
    /// Words at and below the minima of guarded registers, with their offsets.
    floors: Vec<(u64, u64)>,
    pins: Vec<Pin>,
    clock: u64,
    /// Number of clocks from access to access, and whether there are writes.
    phase: (u32, bool),
    /// Offset of the last write, which a read that follows uses.
    pub(crate) last: u64,
}

impl RegistersRandom {
    /// Creates the generator for a block with these ports, the bus first, and these registers. Equal seeds give equal
    /// inputs.
    pub fn new(map: &RegisterMap, ports: &[Port], seed: u64) -> Self {
        let inputs = ports.iter().filter(|port| port.direction == Direction::Input);
        let pin = |(at, port): (usize, &Port)| Pin {
            at,
            width: port.width,
            pace: 2,
            value: 0,
        };
        Self {
            rng: Xoshiro256PlusPlus::seed_from_u64(seed),
            offsets: offsets(map),
            address_ones: (1 << map.address_bits()) - 1,
            floors: floors(map),
            pins: inputs.enumerate().skip(BUS_INPUTS).map(pin).collect(),
            clock: 0,
            phase: (1, true),
            last: 0,
        }
    }

    /// Excludes the registers at these offsets, which another generator uses.
    pub(crate) fn without(mut self, offsets: &[u64]) -> Self {
        self.offsets.retain(|offset| !offsets.contains(offset));
        self
    }

    pub(crate) fn one_in(&mut self, clocks: u32) -> bool {
        self.rng.random_range(0..clocks) == 0
    }

    pub(crate) fn word(&mut self) -> u64 {
        let random = u64::from(self.rng.next_u32());
        let bit = 1u64 << self.rng.random_range(0..32);
        let small = random >> self.rng.random_range(0..32);
        *pick(
            &mut self.rng,
            &[random, random, random, small, bit, !bit & 0xffff_ffff, 0, 0xffff_ffff],
        )
    }

    pub(crate) fn access(&mut self, inputs: &mut [u64]) {
        let (pace, writes) = self.phase;
        let anywhere = u64::from(self.rng.next_u32()) & self.address_ones;
        let again = self.last;
        let register = *pick(&mut self.rng, &self.offsets);
        inputs[ADDRESS] = *pick(
            &mut self.rng,
            &[register, register, register, register, again, anywhere],
        );
        inputs[WRITE_DATA] = self.word();
        let partial = u64::from(self.rng.next_u32() & 0xf);
        inputs[BYTE_ENABLE] = *pick(&mut self.rng, &[0xf, 0xf, 0xf, 0xf, partial]);
        inputs[READ] = 0;
        inputs[WRITE] = 0;
        if self.one_in(pace) {
            let write = writes && self.one_in(2);
            inputs[WRITE] = write.into();
            // Both at once are invalid and must do no harm.
            inputs[READ] = (!write || self.one_in(20)).into();
            self.last = inputs[ADDRESS];
        }
        let near: Vec<(u64, u64)> = self
            .floors
            .iter()
            .copied()
            .filter(|floor| floor.0 == self.last)
            .collect();
        if !near.is_empty() && self.one_in(2) {
            (inputs[ADDRESS], inputs[WRITE_DATA]) = *pick(&mut self.rng, &near);
            inputs[BYTE_ENABLE] = 0xf;
        }
    }

    pub(crate) fn pins(&mut self, inputs: &mut [u64]) {
        for at in 0..self.pins.len() {
            if self.one_in(5000) {
                self.pins[at].pace = *pick(&mut self.rng, &[1, 2, 5, 40, 300, 3000]);
            }
            let pace = self.pins[at].pace;
            if self.one_in(pace) {
                let (random, pin) = (self.rng.next_u64(), &mut self.pins[at]);
                pin.value = match random & 7 {
                    // These are counters and lines that toggle.
                    0..=3 => pin.value.wrapping_add(1),
                    _ => random >> 3,
                } & (u64::MAX >> (64 - pin.width));
            }
            inputs[self.pins[at].at] = self.pins[at].value;
        }
    }
}

/// Returns the offset of every word that has a function.
fn offsets(map: &RegisterMap) -> Vec<u64> {
    let words = |register: &Register| register.offset..register.offset + register.words();
    map.registers().iter().flat_map(words).map(u64::from).collect()
}

fn floors(map: &RegisterMap) -> Vec<(u64, u64)> {
    let mut floors = Vec::new();
    for register in map.registers() {
        for field in register.fields.iter().filter(|field| field.minimum > 0) {
            for value in [field.minimum, field.minimum - 1] {
                let word = register.reset() & !field.mask() | value << field.low;
                floors.push((register.offset.into(), word.into()));
            }
        }
    }
    floors
}

impl Stimuli for RegistersRandom {
    fn fill(&mut self, _seen: &[u64], inputs: &mut [u64]) {
        if self.one_in(2000) {
            self.phase = *pick(
                &mut self.rng,
                &[(1, true), (2, true), (5, true), (60, true), (60, false), (4, false)],
            );
        }
        inputs[0] = (self.clock < 2 || self.one_in(10_000)).into();
        self.access(inputs);
        self.pins(inputs);
        self.clock += 1;
    }
}
