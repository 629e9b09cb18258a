//! Bus traffic for components: what a driver would do, mixed with everything else.

use std::collections::VecDeque;

use posicast_blocks::Direction;
use posicast_blocks::component::{Component, ComponentPart};
use posicast_blocks::registers::RegisterMap;
use posicast_blocks::shaper::ShaperConfig;
use rand::Rng;

use crate::pulse_counter::PulseCounterRandom;
use crate::registers::RegistersRandom;
use crate::registers::stimuli::{ADDRESS, BUS_INPUTS, BYTE_ENABLE, READ, WRITE, WRITE_DATA};
use crate::stimuli::Stimuli;
use crate::stimuli::table::Table;

/// Number of clocks at the start of a run in which a PWM runs undisturbed.
const CALM_CLOCKS: u64 = 5_000;

/// Bus traffic for a component: like [`RegistersRandom`], with pins and transactions that exercise the component's
/// block.
#[derive(Debug, Clone)]
pub struct ComponentRandom {
    registers: RegistersRandom,
    map: RegisterMap,
    core: Core,
    /// Queued writes: word and data.
    writes: VecDeque<(u32, u32)>,
    clock: u64,
}

#[derive(Debug, Clone)]
enum Core {
    Shaper(Box<ShaperConfig>, Table),
    PulseCounter(Box<PulseCounterRandom>, Vec<u64>),
    SlidingMode,
    /// Indices of `sync` and of `fault_n` among the inputs; the PLL's fault and the filtered faults follow `fault_n`.
    Pwm {
        sync: usize,
        fault_n: usize,
    },
    Other,
}

impl ComponentRandom {
    /// Creates the generator. Equal seeds give equal inputs.
    pub fn new(component: &Component, seed: u64) -> Self {
        let core = component.blocks().find_map(|block| match block {
            ComponentPart::Shaper(config) => Some(Core::Shaper(config.clone(), Table::with_capacity(256))),
            ComponentPart::SlidingMode => Some(Core::SlidingMode),
            ComponentPart::Pwm(_) => {
                let place = |name: &str| {
                    let ports = component.composition().ports().iter();
                    let mut inputs = ports.filter(|port| port.direction == Direction::Input);
                    inputs.position(|port| port.name == name)
                };
                place("sync")
                    .zip(place("fault_n"))
                    .map(|(sync, fault_n)| Core::Pwm { sync, fault_n })
            }
            ComponentPart::PulseCounter => {
                Some(Core::PulseCounter(Box::new(PulseCounterRandom::new(seed)), vec![0; 26]))
            }
            _ => None,
        });
        Self {
            registers: RegistersRandom::new(component.map(), component.composition().ports(), seed),
            map: component.map().clone(),
            core: core.unwrap_or(Core::Other),
            writes: VecDeque::new(),
            clock: 0,
        }
    }

    fn write(&mut self, register: &str, data: u32) {
        self.writes
            .extend(self.map.register(register).map(|register| (register.offset, data)));
    }

    /// Queues what a driver would do, now and then a whole sequence.
    fn plan(&mut self) {
        if !self.writes.is_empty() || !self.registers.one_in(400) {
            return;
        }
        let random = self.registers.rng.next_u32();
        match &mut self.core {
            Core::Shaper(config, table) => {
                let (fraction, address_bits) = (config.coefficient_fraction(), config.ring_address_bits());
                let reach = if random & 1 == 0 { 3 } else { address_bits };
                let count = (random >> 1 & 7) as usize + 1;
                table.draw(&mut self.registers.rng, count, fraction, reach);
                let bank = (random >> 8 & 1) + 1;
                let taps: Vec<(u32, u32)> = (0..)
                    .zip(&table.taps)
                    .map(|(index, (coefficient, delay))| {
                        (index, *coefficient as u32 & 0x3_ffff | (*delay as u32) << 18)
                    })
                    .collect();
                let host = random >> 12 & 3 != 0;
                self.write("control", (!host).into());
                for (index, tap) in taps {
                    self.write("tap_address", index | bank << 8);
                    self.write("tap", tap);
                }
                self.write("swap", bank | (random >> 16 & 3) << 4);
                // Taps are read back, from any bank, during a pass and between two.
                for read in 0..random >> 24 & 7 {
                    self.write("tap_address", random >> (read + 20) & 0x307);
                    self.write("tap_read", 0);
                    self.writes.extend([(0x40, 0); 5]);
                }
                for sample in 0..random >> 20 & 15 {
                    let x = self.registers.rng.next_u32();
                    for word in ["x", "x_0", "x_1", "x_2"] {
                        self.write(word, x >> (sample & 7));
                    }
                    self.write("strobe", 0);
                    self.writes.extend([(0x40, 0); 30]);
                }
            }
            Core::PulseCounter(..) => {
                self.write("lines", random & 0x3 | ((random >> 8 & 7) % 5) << 8 | random & 0x2_0000);
                self.write("index", random >> 24 & 0xff);
                self.write("velocity_filter", random >> 4 & 0xf013 | 0x0100);
                self.write("index_arm", 0);
                self.write("preset", 0);
            }
            Core::SlidingMode => {
                let bank = (random & 1) + 1;
                for row in 0..16 {
                    // A setting is a mantissa and a shift; the limit is a number of the same kind.
                    let setting = self.registers.word() as u32;
                    self.write("setting_address", row | bank << 8);
                    self.write("setting", setting);
                }
                // Settings are read back, from any bank, during a pass and between two.
                for read in 0..random >> 16 & 7 {
                    self.write("setting_address", random >> (read + 20) & 0x30f);
                    self.write("setting_read", 0);
                    self.writes.extend([(0x40, 0); 5]);
                }
                self.write("law", random >> 2 & 3 | bank << 8 | random & 0x10);
                self.write("commit", 0);
                self.write("control", u32::from(random >> 12 & 3 != 0));
                self.write("start", 0);
            }
            Core::Pwm { .. } => {
                // The driver switches off, sets a short period and times near the floors, and switches on; at first
                // with duties that certainly reach the pins.
                let calm = self.clock < CALM_CLOCKS;
                let unless_calm = |value: u32, calm_value: u32| if calm { calm_value } else { value };
                self.write("control", 0);
                self.write("period", 64 + (random & 0x3f));
                self.write("times", (4 + (random >> 6 & 3)) | ((3 + (random >> 8 & 3)) << 16));
                self.write("max_duty", unless_calm(random >> 10 & 0x7f, 0x7f));
                self.write("phase", unless_calm(random >> 12 & 0x1f_001f, 0));
                let supervised = random >> 17 & 1 == 1 && !calm;
                self.write("supervision", if supervised { random >> 18 & 0x703 } else { 0 });
                self.write("clear_trip", 0);
                self.write("control", 1 | random >> 20 & 0x306);
                for sample in 0..unless_calm(random >> 28, 15) {
                    let duty = self.registers.rng.next_u32() as i32 >> 24;
                    let full = if sample / 8 == 0 { 60 } else { -60 };
                    self.write("duty", unless_calm(duty as u32, full as u32));
                    self.write("feed", 0);
                    self.writes.extend([(0x40, 0); 20]);
                    // The bank refuses this while the PWM runs.
                    self.write("times", 0x1f | 0x1f << 16);
                }
            }
            Core::Other => {}
        }
    }
}

impl Stimuli for ComponentRandom {
    fn fill(&mut self, seen: &[u64], inputs: &mut [u64]) {
        self.registers.fill(seen, inputs);
        self.plan();
        if let Core::PulseCounter(encoder, row) = &mut self.core {
            encoder.fill(&[], row);
            // Both rows have the same lines, the one after `rst` and the other after the bus.
            inputs[BUS_INPUTS..BUS_INPUTS + 6].copy_from_slice(&row[1..7]);
        }
        if let Core::Pwm { sync, fault_n } = self.core
            && self.clock < CALM_CLOCKS
        {
            // Only the driver writes, no line fails, and no `sync` finds the carrier at another phase, so the carrier
            // runs.
            (inputs[WRITE], inputs[sync]) = (0, 0);
            for (input, healthy) in inputs[fault_n..].iter_mut().zip([1, 1, 3]) {
                *input = healthy;
            }
            inputs[0] = (self.clock < 2).into();
        } else if let Core::Pwm { sync, fault_n } = self.core {
            // A `sync` is rare, since one that finds the carrier at another phase delays its start until the next
            // one.
            inputs[sync] &= u64::from(self.registers.one_in(500));
            // The lines are mostly healthy.
            for (input, healthy) in inputs[fault_n..].iter_mut().zip([1, 1, 3]) {
                if !self.registers.one_in(1000) {
                    *input = healthy;
                }
            }
        }
        if inputs[READ] == 0
            && !self.registers.one_in(4)
            && let Some((offset, data)) = self.writes.pop_front()
        {
            inputs[ADDRESS] = offset.into();
            inputs[WRITE_DATA] = data.into();
            inputs[BYTE_ENABLE] = 0xf;
            inputs[WRITE] = 1;
        }
        self.clock += 1;
    }
}
