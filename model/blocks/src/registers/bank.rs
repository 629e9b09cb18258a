//! The register bank, clock by clock: an interpreter of the register map.

mod plan;

use self::plan::{Plan, plan};
use super::description::{Access, FlagSource};
use super::map::RegisterMap;
use crate::{ClockedBlock, Direction, FOREVER, Moore, Port, StepError};

/// Source of an output.
#[derive(Debug, Clone, Copy)]
enum Shown {
    ReadData,
    Irq,
    Strobe(usize),
    /// The word of a register that was written last.
    Word(usize),
    Field {
        register: usize,
        low: u32,
        ones: u32,
    },
}

/// All registers of the hardware.
#[derive(Debug, Clone, PartialEq, Eq)]
struct State {
    /// Words of the registers, as the hardware sees them or as they read.
    words: Vec<u32>,
    /// Words that the host has written to staged registers.
    staged: Vec<u32>,
    /// The command whose strobe is high.
    strobe: Option<usize>,
    /// Per register, the index of the word that was written last; used by commands with several words.
    places: Vec<u32>,
    commit_waits: bool,
    read_data: u32,
    irq: bool,
}

/// Errors of a write in a clock.
#[derive(Debug, Clone, Copy, Default)]
struct Refusals {
    partial: bool,
    guard: bool,
    commit: bool,
}

/// Index of the bus among the inputs; the outputs begin with `avs_readdata`.
const ADDRESS: usize = 1;
const READ: usize = 2;
const WRITE: usize = 3;
const BYTE_ENABLE: usize = 4;
const WRITE_DATA: usize = 5;

/// The cycle-accurate model of a register bank.
#[derive(Debug, Clone)]
pub struct RegisterBank {
    ports: Vec<Port>,
    inputs: usize,
    plan: Vec<Plan>,
    /// For each word of the windows, its register and the word's index in it.
    decode: Vec<Option<(usize, u32)>>,
    outputs: Vec<Shown>,
    /// Registers that are updated in every clock.
    flags: Vec<usize>,
    staged: Vec<usize>,
    commit: Option<usize>,
    interrupts: Option<(usize, usize)>,
    reset: State,
    state: State,
}

impl RegisterBank {
    /// The bank of `map`, after reset.
    pub fn new(map: &RegisterMap) -> Self {
        let registers = map.registers();
        let plan: Vec<Plan> = (0..registers.len()).map(|at| plan(map, at)).collect();
        let mut decode = vec![None; 1 << map.address_bits()];
        for (at, register) in registers.iter().enumerate() {
            for place in 0..register.words() {
                decode[(register.offset + place) as usize] = Some((at, place));
            }
        }
        let places = |holds: fn(&Access) -> bool| {
            let all = plan.iter().enumerate();
            all.filter(move |(_, p)| holds(&p.access)).map(|(at, _)| at)
        };
        let words: Vec<u32> = plan.iter().map(|plan| plan.reset).collect();
        let reset = State {
            staged: words.clone(),
            words,
            strobe: None,
            places: vec![0; plan.len()],
            commit_waits: false,
            read_data: 0,
            irq: false,
        };
        let inputs = map
            .ports()
            .iter()
            .filter(|port| port.direction == Direction::Input)
            .count();
        Self {
            ports: map.ports().to_vec(),
            inputs,
            outputs: outputs(map),
            flags: places(Access::is_sticky).collect(),
            staged: places(|access| *access == Access::Staged).collect(),
            commit: places(|access| matches!(access, Access::Commit { .. })).next(),
            interrupts: places(|access| *access == Access::InterruptState)
                .next()
                .zip(places(|access| *access == Access::InterruptEnable).next()),
            decode,
            state: reset.clone(),
            reset,
            plan,
        }
    }

    /// Simulates this many clocks with the same inputs. It ends early once a clock changes nothing, since no later
    /// one would.
    ///
    /// # Errors
    /// [`StepError`] for a wrong number of inputs.
    pub fn hold(&mut self, inputs: &[u64], clocks: u64) -> Result<(), StepError> {
        self.check(inputs, self.outputs.len())?;
        for _ in 0..clocks {
            let before = self.state.clone();
            self.clock(inputs);
            if self.state == before {
                break;
            }
        }
        Ok(())
    }

    fn check(&self, inputs: &[u64], outputs: usize) -> Result<(), StepError> {
        if (inputs.len(), outputs) == (self.inputs, self.outputs.len()) {
            return Ok(());
        }
        Err(StepError(format!(
            "{} inputs and {} outputs: the bank has {} and {}",
            inputs.len(),
            outputs,
            self.inputs,
            self.outputs.len()
        )))
    }

    fn clock(&mut self, inputs: &[u64]) {
        if inputs[0] & 1 != 0 {
            self.state.clone_from(&self.reset);
            return;
        }
        let data = (inputs[READ] & 1 != 0).then(|| self.read(inputs));
        let irq = self.raises_irq();
        self.state.strobe = None;
        let applies = self.applies_commit(inputs);
        if applies {
            for at in &self.staged {
                self.state.words[*at] = self.state.staged[*at];
            }
        }
        let refusals = if inputs[WRITE] & 1 != 0 {
            self.write(inputs)
        } else {
            Refusals::default()
        };
        if applies {
            self.state.commit_waits = false;
        }
        self.set_flags(inputs, refusals);
        if let Some(data) = data {
            self.state.read_data = data;
        }
        self.state.irq = irq;
    }

    fn raises_irq(&self) -> bool {
        let words = &self.state.words;
        self.interrupts
            .is_some_and(|(state, enable)| words[state] & words[enable] != 0)
    }

    fn applies_commit(&self, inputs: &[u64]) -> bool {
        let tick = self.commit.is_some_and(|at| inputs[self.plan[at].gate] & 1 != 0);
        tick && self.state.commit_waits
    }

    fn read(&self, inputs: &[u64]) -> u32 {
        let Some((at, _)) = self.addressed(inputs) else {
            return 0;
        };
        match self.plan[at].access {
            Access::Live => self.wired(at, inputs),
            Access::Staged => self.state.staged[at],
            Access::Commit { .. } => self.state.commit_waits.into(),
            Access::Command { .. } | Access::Words { .. } | Access::Snapshot | Access::InterruptTest => 0,
            _ => self.state.words[at],
        }
    }

    fn addressed(&self, inputs: &[u64]) -> Option<(usize, u32)> {
        self.decode[inputs[ADDRESS] as usize & (self.decode.len() - 1)]
    }

    fn wired(&self, at: usize, inputs: &[u64]) -> u32 {
        let wires = &self.plan[at].wires;
        wires.iter().fold(0, |word, wire| word | wire.bits(inputs))
    }

    fn write(&mut self, inputs: &[u64]) -> Refusals {
        let mut refusals = Refusals::default();
        let Some((at, place)) = self.addressed(inputs) else {
            return refusals;
        };
        let plan = &self.plan[at];
        let (enabled, data) = (bytes(inputs[BYTE_ENABLE]), inputs[WRITE_DATA] as u32);
        if plan.access.whole_words() && enabled != u32::MAX {
            refusals.partial = true;
            return refusals;
        }
        let merged = |old: u32| (old & !enabled | data & enabled) & plan.mask;
        let state = &mut self.state;
        match &plan.access {
            Access::Configuration | Access::InterruptEnable => state.words[at] = merged(state.words[at]),
            Access::Guarded { .. } => {
                let word = merged(state.words[at]);
                let enough = plan.minima.iter().all(|(mask, minimum)| word & mask >= *minimum);
                if inputs[plan.gate] & 1 == 0 && enough {
                    state.words[at] = word;
                } else {
                    refusals.guard = true;
                }
            }
            Access::Staged if state.commit_waits => refusals.commit = true,
            Access::Staged => state.staged[at] = merged(state.staged[at]),
            Access::Command { .. } | Access::Words { .. } => {
                state.words[at] = data & plan.mask;
                state.places[at] = place;
                state.strobe = Some(at);
            }
            Access::Sticky | Access::InterruptState => state.words[at] &= !(data & enabled),
            Access::Commit { .. } if state.commit_waits => refusals.commit = true,
            Access::Commit { .. } => state.commit_waits = true,
            Access::Snapshot => self.snapshot(inputs),
            Access::InterruptTest => state.words[plan.refers_to] |= data & plan.mask,
            Access::Constant | Access::Live | Access::Shadow { .. } => {}
        }
        refusals
    }

    fn snapshot(&mut self, inputs: &[u64]) {
        for at in 0..self.plan.len() {
            if let Access::Shadow { .. } = self.plan[at].access {
                self.state.words[at] = self.wired(self.plan[at].refers_to, inputs);
            }
        }
    }

    fn set_flags(&mut self, inputs: &[u64], refusals: Refusals) {
        for at in &self.flags {
            let plan = &self.plan[*at];
            let set = plan.wires.iter().fold(0, |word, wire| word | wire.bits(inputs));
            let own = plan.own_flags.iter().fold(0, |word, flag| {
                let happened = match flag.source {
                    FlagSource::PartialWrite => refusals.partial,
                    FlagSource::GuardRefused => refusals.guard,
                    FlagSource::CommitRejected => refusals.commit,
                    FlagSource::Input => false,
                };
                word | if happened { flag.bit } else { 0 }
            });
            self.state.words[*at] |= set | own;
        }
    }
}

/// A mask with ones in the enabled bytes.
fn bytes(enabled: u64) -> u32 {
    (0..4).fold(0, |mask, byte| {
        mask | if enabled >> byte & 1 != 0 {
            0xff << (8 * byte)
        } else {
            0
        }
    })
}

/// Source of each output, in port order.
fn outputs(map: &RegisterMap) -> Vec<Shown> {
    let shown = |port: &Port| match port.name.as_str() {
        "avs_readdata" => Some(Shown::ReadData),
        "irq" => Some(Shown::Irq),
        name => map.registers().iter().enumerate().find_map(|(at, register)| {
            let (is_strobe, is_word) = match &register.access {
                Access::Command { strobe } => (strobe == name, false),
                Access::Words { strobe, word, .. } => (strobe == name, word == name),
                _ => (false, false),
            };
            let field = register.fields.iter().find(|field| field.name == name);
            match field.filter(|_| register.access.drives_fields()) {
                _ if is_strobe => Some(Shown::Strobe(at)),
                _ if is_word => Some(Shown::Word(at)),
                Some(field) => Some(Shown::Field {
                    register: at,
                    low: field.low,
                    ones: field.ones(),
                }),
                None => None,
            }
        }),
    };
    let outputs = map.ports().iter().filter(|port| port.direction == Direction::Output);
    outputs.filter_map(shown).collect()
}

impl Moore for RegisterBank {
    fn show(&self, outputs: &mut [u64]) {
        let state = &self.state;
        for (output, shown) in outputs.iter_mut().zip(&self.outputs) {
            *output = match shown {
                Shown::ReadData => state.read_data.into(),
                Shown::Irq => state.irq.into(),
                Shown::Strobe(at) => (state.strobe == Some(*at)).into(),
                Shown::Word(at) => state.places[*at].into(),
                Shown::Field { register, low, ones } => (state.words[*register] >> low & ones).into(),
            };
        }
    }

    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        let bus = (inputs[0] | inputs[READ] | inputs[WRITE]) & 1 != 0;
        let state = &self.state;
        let ends = state.strobe.is_some() || state.irq != self.raises_irq() || self.applies_commit(inputs);
        let sets = |at: &usize| self.wired(*at, inputs) & !state.words[*at] != 0;
        if bus || ends || self.flags.iter().any(sets) {
            0
        } else {
            FOREVER
        }
    }

    /// Between reads and writes, only flags and the tick of a commit matter.
    fn ignores(&self, input: &str) -> bool {
        let mut inputs = self.ports.iter().filter(|port| port.direction == Direction::Input);
        let Some(at) = inputs.position(|port| port.name == input) else {
            return false;
        };
        let flag = |register: &usize| self.plan[*register].wires.iter().any(|wire| wire.is_on(at));
        let gate = self.commit.is_some_and(|commit| self.plan[commit].gate == at);
        !([0, READ, WRITE].contains(&at) || gate || self.flags.iter().any(flag))
    }
}

impl ClockedBlock for RegisterBank {
    fn ports(&self) -> &[Port] {
        &self.ports
    }

    fn step(&mut self, inputs: &[u64], outputs: &mut [u64]) -> Result<(), StepError> {
        self.check(inputs, outputs.len())?;
        self.show(outputs);
        self.clock(inputs);
        Ok(())
    }

    fn advance(&mut self, inputs: &[u64], scratch: &mut [u64]) -> Result<(), StepError> {
        self.check(inputs, scratch.len())?;
        self.clock(inputs);
        Ok(())
    }
}
