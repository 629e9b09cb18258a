//! A host of an inline shaper, and the controller at its pins: the pins are those of the inline shaper's own bench; the host loads
//! tables, asks for no shaping, records traces, takes snapshots and clears flags.

use std::collections::VecDeque;

use posicast_blocks::Port;
use posicast_blocks::inline_shaper::{InlineConfig, InlineShaper};
use posicast_blocks::linked_stage::BridgeConfig;
use posicast_blocks::registers::{Field, RegisterMap, WINDOW_WORDS};
use posicast_blocks::spi_bridge::SpiBridgeConfig;
use posicast_blocks::step_generator::StepMode;
use posicast_blocks::trace::TraceConfig;
use posicast_blocks::uart_bridge::UartBridgeConfig;
use posicast_taps::{Tap, TapTable};
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::stimuli::BesideALine;
use super::{FASTEST, LinkedStageBlock};
use crate::Error;
use crate::blocks::changes::Changes;
use crate::blocks::registry::RegistryRow;
use crate::blocks::{Bins, Block, BlockMutant, Trial};
use crate::formal::refused;
use crate::inline_shaper::{InlineShaperRandom, example};
use crate::lockstep::Clock;
use crate::stimuli::Stimuli;

/// Number of the inputs of the bus, between `rst` and the pins.
const BUS_INPUTS: usize = 5;
/// Least number of taps other than 0 of each axis in a run.
pub(super) const LEAST_TAPS: u64 = 1;

/// The row of the inline shaper with its line in the registry. The line is as fast as its bridge receives.
pub(crate) const ROW: RegistryRow = RegistryRow {
    name: "linked_inline_shaper",
    // One line is enough: the bridges have rows of their own.
    benches: |sizes| {
        let bench = |shaper| Ok(Box::new(linked(shaper, false)?) as Box<dyn Block>);
        sizes.inline.iter().map(bench).collect()
    },
    trials: || {
        Ok(vec![
            Trial::new(linked(&example()?, false)?, &[1, 2], 2).size("serial"),
            Trial::new(linked(&example()?, true)?, &[3], 2).size("SPI").long(),
        ])
    },
    mutants: &[
        BlockMutant::new(
            "a read that is taken in its first clock",
            "(avm_read & ~read_before)",
            "(1'b0)",
        ),
        BlockMutant::new(
            "a request that is left out",
            "if (bypass_request_0) begin",
            "if (1'd0) begin",
        ),
    ],
    ..RegistryRow::EMPTY
};

/// Changes of the outputs, without the flags that cannot change: those of other lines, and those that another cause prevents.
pub(super) struct InlineChanges {
    changes: Changes,
    left_out: Vec<String>,
}

impl InlineChanges {
    pub(super) fn new(config: &InlineConfig, ports: &[Port]) -> Self {
        let illegal = config.axes.iter().filter(|axis| axis.input != StepMode::Quadrature);
        let illegal = illegal.map(|axis| format!("{}_input_illegal", axis.name));
        // The limit of the input stops the axis before, unless a host loads a table with more overshoot.
        let stopped = config.axes.iter().map(|axis| format!("{}_steps_stopped", axis.name));
        Self {
            changes: Changes::new(ports),
            left_out: illegal.chain(stopped).collect(),
        }
    }
}

impl Bins for InlineChanges {
    fn observe(&mut self, clock: &Clock<'_>) {
        self.changes.observe(clock);
    }

    fn counts(&self) -> Vec<(String, u64)> {
        let mut counts = self.changes.counts();
        counts.retain(|(name, _)| !self.left_out.contains(name));
        counts
    }
}

/// The inline shaper with SPI lines, or the fastest serial line.
fn linked(shaper: &InlineShaper, with_spi: bool) -> Result<LinkedStageBlock, Error> {
    let words = (shaper.config().axes.len() as u16 + 1) * WINDOW_WORDS as u16;
    let (clock_hz, baud, silence_s) = FASTEST;
    let line = if with_spi {
        BridgeConfig::Spi(SpiBridgeConfig::new(clock_hz, silence_s, words).map_err(refused)?)
    } else {
        BridgeConfig::Uart(UartBridgeConfig::new(clock_hz, baud, silence_s, words).map_err(refused)?)
    };
    let names = ["inline_link", "inline_top", "inline"];
    let mut config = shaper.config().clone();
    config.axes[0].trace = Some(TraceConfig::new(256).map_err(refused)?);
    LinkedStageBlock::of_inline((&config, Some(0x1234_5678)), (line, clock_hz as f64), names).map_err(refused)
}

/// The pins, and the host.
struct InlineBeside {
    rng: Xoshiro256PlusPlus,
    pins: InlineShaperRandom,
    /// Inputs of the bench of the inline shaper without registers.
    own: Vec<u64>,
    map: RegisterMap,
    axes: Vec<(String, TapTable)>,
    /// Axis and word of the writes that follow, in order.
    script: VecDeque<(usize, (u32, u32))>,
    wild: bool,
}

/// The pins and the host of an inline shaper with these settings.
pub(super) fn pins(config: &InlineConfig, map: &RegisterMap, seed: u64) -> Box<dyn BesideALine> {
    let axes = config.axes.iter();
    let axes = axes.map(|axis| (axis.name.clone(), axis.shaper.table().clone()));
    let mut host = InlineBeside {
        rng: Xoshiro256PlusPlus::seed_from_u64(seed ^ 0x1a),
        pins: InlineShaperRandom::new(config, seed),
        own: Vec::new(),
        map: map.clone(),
        axes: axes.collect(),
        script: VecDeque::new(),
        wild: false,
    };
    // Every axis gets a table early, so that short runs have one, too.
    for axis in 0..host.axes.len() {
        host.load_table(axis);
    }
    Box::new(host)
}

impl InlineBeside {
    fn below(&mut self, end: u32) -> u32 {
        self.rng.random_range(0..end.max(1))
    }

    fn push(&mut self, axis: usize, register: &str, word: u32) {
        let offset = self.map.register(register).map(|register| register.offset);
        self.script.extend(offset.map(|offset| (axis, (offset, word))));
    }

    /// The field with this name of a register, placed in its word.
    fn placed(&self, register: &str, field: &str, value: u32) -> u32 {
        let register = self.map.register(register);
        let place = |field: &Field| value << field.low & field.mask();
        let mut fields = register.into_iter().flat_map(|register| &register.fields);
        fields.find(|of| of.name == field).map_or(0, place)
    }

    /// The taps of the machine at other delays, which keep their order, in a loadable bank; then a swap to it.
    fn load_table(&mut self, axis: usize) {
        let (name, table) = self.axes[axis].clone();
        let of = |register: &str| format!("{name}_{register}");
        let bank = 1 + self.below(2);
        let longest = table.longest_delay_samples().max(table.taps().len() as u32);
        let mut delay = 0;
        let place = self.placed(&of("tap_address"), &of("tap_bank"), bank);
        for (index, tap) in (0..).zip(table.taps()) {
            let tap = Tap {
                delay_samples: delay,
                coefficient: tap.coefficient,
            };
            delay += 1 + self.below(longest / table.taps().len() as u32);
            let index = self.placed(&of("tap_address"), &of("tap_index"), index);
            let word = self.placed(&of("tap"), &of("tap_coefficient"), tap.coefficient as u32)
                | self.placed(&of("tap"), &of("tap_delay"), tap.delay_samples);
            self.push(axis, &of("tap_address"), place | index);
            self.push(axis, &of("tap"), word);
        }
        let how = 1 + self.below(2);
        let swap = self.placed(&of("swap"), &of("swap_bank"), bank) | self.placed(&of("swap"), &of("swap_how"), how);
        self.push(axis, &of("swap"), swap);
    }

    /// A trace of some rows, in any mode of its trigger; or the word that is read next.
    fn trace(&mut self, axis: usize) {
        let of = |register: &str, name: &str| format!("{name}_{register}");
        let name = self.axes[axis].0.clone();
        if self.below(2) == 0 {
            let address = self.below(256);
            self.push(axis, &of("trace_address", &name), address);
            return;
        }
        let setup = self.rng.next_u32();
        let rate = self.below(3) | self.below(300) << 16;
        let level = self.below(1 << 14).wrapping_sub(1 << 13);
        self.push(axis, &of("trace_halt", &name), 0);
        self.push(axis, &of("trace_setup", &name), setup);
        self.push(axis, &of("trace_rate", &name), rate);
        self.push(axis, &of("trace_level", &name), level);
        self.push(axis, &of("trace_arm", &name), 0);
    }

    /// The next sequence of writes, or none for a while.
    fn think(&mut self) {
        let axis = self.below(self.axes.len() as u32) as usize;
        self.wild = self.below(12) == 0;
        match self.below(10) {
            0 => self.load_table(axis),
            1 | 2 => {
                let request = self.below(2);
                self.push(axis, "bypass", request);
            }
            3 => self.push(axis, "snapshot", 0),
            4 => {
                let enables = self.rng.next_u32();
                self.push(axis, "interrupt_enable", enables);
                self.push(axis, "interrupt_state", u32::MAX);
            }
            5 => {
                let flags = format!("{}_flags", self.axes[axis].0);
                self.push(axis, &flags, u32::MAX);
            }
            6 => {
                // Back to the machine's own table, at once or handed over.
                let swap = format!("{}_swap", self.axes[axis].0);
                let how = self.below(3);
                let word = self.placed(&swap, &format!("{}_swap_how", self.axes[axis].0), how);
                self.push(axis, &swap, word);
            }
            7 => self.trace(axis),
            _ => {}
        }
    }
}

impl BesideALine for InlineBeside {
    fn beside_a_line(&mut self, seen: &[u64], inputs: &mut [u64], _waiting: u32, _longer: u64) {
        self.own.resize(inputs.len() - BUS_INPUTS, 0);
        self.pins.fill(seen, &mut self.own);
        inputs[0] = self.own[0];
        inputs[1 + BUS_INPUTS..].copy_from_slice(&self.own[1..]);
    }

    fn due_writes(&mut self, most: usize) -> (Vec<(u32, u32)>, u32) {
        if self.script.is_empty() {
            self.think();
        }
        let count = self.script.len().min(most);
        let due: Vec<_> = self.script.drain(..count).collect();
        let axes = due.iter().fold(0, |axes, (axis, _)| axes | 1 << axis);
        (due.into_iter().map(|(_, write)| write).collect(), axes)
    }

    fn is_wild(&self) -> bool {
        self.wild
    }

    fn writes(&self, axis: usize) -> bool {
        self.script.iter().any(|(of, _)| *of == axis)
    }
}
