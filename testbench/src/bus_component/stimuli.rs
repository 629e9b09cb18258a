//! The accesses of a component's stimuli, made by a manager of AXI4-Lite or a master of Wishbone at random paces.

use std::collections::VecDeque;

use posicast_blocks::Direction;
use posicast_blocks::axi_lite_bridge;
use posicast_blocks::bus_component::{BridgedBus, mapped};
use posicast_blocks::component::Component;
use posicast_blocks::wishbone_bridge;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::component::ComponentRandom;
use crate::registers::stimuli::{ADDRESS, BUS_INPUTS, BYTE_ENABLE, READ, WRITE, WRITE_DATA};
use crate::stage::StageRandom;
use crate::stimuli::table::pick;
use crate::stimuli::{Stimuli, row};

/// Accesses that may wait: the component's stimuli stand still while there are as many.
const MOST_WAITING: usize = 4;

/// An access to a word.
#[derive(Debug, Clone, Copy, Default)]
struct Access {
    address: u64,
    write: bool,
    bytes: u64,
    data: u64,
}

/// What a channel still has to transfer, and whether it offers the first of it.
#[derive(Debug, Clone, Default)]
struct Channel {
    waiting: VecDeque<Access>,
    offers: bool,
}

impl Channel {
    /// Ends the transfer of the clock before if it was taken, and begins the next one if `begins`; returns it.
    fn next(&mut self, taken: bool, begins: bool) -> Option<Access> {
        if self.offers && taken {
            self.waiting.pop_front();
            self.offers = false;
        }
        self.offers |= begins && !self.waiting.is_empty();
        self.waiting.front().filter(|_| self.offers).copied()
    }
}

/// The stimuli of a component, with its accesses on another bus. A word without a register is now and then accessed, too.
pub struct BusComponentRandom {
    bus: BridgedBus,
    rng: Xoshiro256PlusPlus,
    inner: Box<dyn Stimuli>,
    /// Inputs and outputs of the component on its own bus, and the place of its `avs_readdata`.
    own: Vec<u64>,
    seen: Vec<u64>,
    read_data: usize,
    outputs: usize,
    /// Words without a register.
    unmapped: Vec<u64>,
    /// Write addresses, words, read addresses; on Wishbone all accesses are in the first.
    channels: [Channel; 3],
    /// Clocks of a thousand in which a channel begins, or an answer is taken.
    paces: [u32; 5],
}

impl BusComponentRandom {
    /// Creates the generator. Equal seeds give equal inputs for equal outputs.
    pub fn new(component: &Component, bus: BridgedBus, axes: &[String], seed: u64) -> Self {
        let ports = component.composition().ports();
        let count = |wanted| ports.iter().filter(|port| port.direction == wanted).count();
        let mut outputs = ports.iter().filter(|port| port.direction == Direction::Output);
        let mapped = mapped(component.map());
        Self {
            bus,
            rng: Xoshiro256PlusPlus::seed_from_u64(seed ^ 0xb5),
            inner: if axes.is_empty() {
                Box::new(ComponentRandom::new(component, seed))
            } else {
                Box::new(StageRandom::new(component, axes, seed))
            },
            own: vec![0; count(Direction::Input)],
            seen: vec![0; count(Direction::Output)],
            read_data: outputs.position(|port| port.name == "avs_readdata").unwrap_or(0),
            outputs: bus.bus_outputs(),
            unmapped: (0..component.map().words())
                .filter(|word| mapped.iter().all(|(first, last)| !(first..=last).contains(&word)))
                .map(u64::from)
                .collect(),
            channels: Default::default(),
            paces: [1000; 5],
        }
    }

    fn happens(&mut self, channel: usize) -> bool {
        self.rng.random_range(0..1000) < self.paces[channel]
    }

    /// An access to a word without a register, now and then.
    fn beside_the_registers(&mut self) -> Option<Access> {
        if self.rng.random_range(0..100) != 0 || self.unmapped.is_empty() {
            return None;
        }
        Some(Access {
            address: *pick(&mut self.rng, &self.unmapped),
            write: self.rng.random(),
            bytes: 0xf,
            data: u64::from(self.rng.random::<u32>()),
        })
    }

    /// Lets the component's stimuli go on, and takes their access.
    fn advance(&mut self) {
        let beside = self.beside_the_registers();
        self.inner.fill(&self.seen, &mut self.own);
        let write = self.own[WRITE] & 1 != 0;
        let own = (write || self.own[READ] & 1 != 0).then_some(Access {
            address: self.own[ADDRESS],
            write,
            bytes: self.own[BYTE_ENABLE],
            data: self.own[WRITE_DATA],
        });
        for access in [beside, own].into_iter().flatten() {
            self.put(access);
        }
    }

    fn put(&mut self, access: Access) {
        let [first, second, third] = &mut self.channels;
        match (self.bus, access.write) {
            (BridgedBus::Wishbone { .. }, _) => first.waiting.push_back(access),
            (BridgedBus::AxiLite, false) => third.waiting.push_back(access),
            (BridgedBus::AxiLite, true) => {
                first.waiting.push_back(access);
                second.waiting.push_back(access);
            }
        }
    }

    fn axi_lite(&mut self, seen: &[u64]) -> Vec<u64> {
        let seen = axi_lite_bridge::Outputs::from_raw(&row(seen));
        let begins = [0, 1, 3].map(|channel| self.happens(channel));
        let [address, word, read] = &mut self.channels;
        let address = address.next(seen.s_axi_awready, begins[0]);
        let word = word.next(seen.s_axi_wready, begins[1]);
        let read = read.next(seen.s_axi_arready, begins[2]);
        let inputs = axi_lite_bridge::Inputs {
            s_axi_awvalid: address.is_some(),
            s_axi_awaddr: address.map_or(0, |access| (access.address << 2) as u32),
            s_axi_wvalid: word.is_some(),
            s_axi_wdata: word.map_or(0, |access| access.data as u32),
            s_axi_wstrb: word.map_or(0, |access| access.bytes as u8),
            s_axi_bready: self.happens(2),
            s_axi_arvalid: read.is_some(),
            s_axi_araddr: read.map_or(0, |access| (access.address << 2) as u32),
            s_axi_rready: self.happens(4),
            ..axi_lite_bridge::Inputs::default()
        };
        let raw = inputs.to_raw();
        raw[1..raw.len() - 2].to_vec()
    }

    fn wishbone(&mut self, seen: &[u64], pipelined: bool) -> Vec<u64> {
        let seen = wishbone_bridge::Outputs::from_raw(&row(seen));
        let taken = if pipelined {
            !seen.wb_stall
        } else {
            seen.wb_ack || seen.wb_err
        };
        let begins = self.happens(0);
        let access = self.channels[0].next(taken, begins);
        let inputs = wishbone_bridge::Inputs {
            wb_cyc: true,
            wb_stb: access.is_some(),
            wb_we: access.is_some_and(|access| access.write),
            wb_adr: access.map_or(0, |access| access.address as u16),
            wb_sel: access.map_or(0, |access| access.bytes as u8),
            wb_dat_w: access.map_or(0, |access| access.data as u32),
            ..wishbone_bridge::Inputs::default()
        };
        let raw = inputs.to_raw();
        raw[2..raw.len() - 2].to_vec()
    }
}

impl Stimuli for BusComponentRandom {
    fn fill(&mut self, seen: &[u64], inputs: &mut [u64]) {
        let (of_bus, pins) = seen.split_at(self.outputs.min(seen.len()));
        let own = self.seen.iter_mut().enumerate();
        let own = own.filter(|(place, _)| *place != self.read_data);
        own.zip(pins).for_each(|((_, own), pin)| *own = *pin);
        if self.rng.random_range(0..500) == 0 {
            let channel = self.rng.random_range(0..self.paces.len());
            self.paces[channel] = *pick(&mut self.rng, &[30, 300, 1000, 1000]);
        }
        let was_reset = self.own[0] & 1 != 0;
        if self.channels.iter().all(|channel| channel.waiting.len() < MOST_WAITING) {
            self.advance();
        }
        let rst = self.own[0];
        // A reset ends all that was offered.
        if rst & 1 != 0 || was_reset {
            self.channels = Default::default();
        }
        let of_bus = match self.bus {
            BridgedBus::AxiLite => self.axi_lite(of_bus),
            BridgedBus::Wishbone { pipelined } => self.wishbone(of_bus, pipelined),
        };
        inputs[0] = rst;
        let (bus, pins) = inputs[1..].split_at_mut(of_bus.len());
        bus.copy_from_slice(&of_bus);
        pins.copy_from_slice(&self.own[BUS_INPUTS..]);
    }
}
