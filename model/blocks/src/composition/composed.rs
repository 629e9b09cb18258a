//! The blocks of a composition, simulated together; each is clocked only when something happens in it.

use super::member::Member;
use super::wire::{MemberInput, Wire};
use super::{Composition, Net};
use crate::{ClockedBlock, Direction, Moore, OutputKind, Port, StepError};

/// The model of a composition.
///
/// A block sleeps while it is [quiet](Moore::quiet_clocks). It is woken when that time is over, or by a change of an
/// input that it does not ignore; then it catches up. So a clock costs only what happens in it, and
/// [`hold`](Self::hold) skips clocks without an event. The outputs are the same as if every block were clocked in
/// every clock.
///
/// Outputs of one block that another reads come from registers, and are known before any block is clocked, in any
/// order. An output that depends on inputs of the same clock ([`OutputKind::Combinational`]) may be an output of the
/// whole, and may feed registers and combinational outputs of later parts.
///
/// It implements [`Moore`] itself, so that compositions can be parts of others.
pub struct Composed {
    composition: Composition,
    members: Vec<Member>,
    /// The members that must be clocked next.
    due: Due,
    /// The clock in which each other member must be clocked.
    wakes: Vec<u64>,
    /// None of them must be clocked before this clock.
    next_wake: u64,
    wires: Vec<Wire>,
    /// Values of the inputs, whose nets come first.
    inputs: Vec<u64>,
    /// Values of the outputs, but for those that count.
    outputs: Vec<u64>,
    /// Indices of the outputs that count, with their nets.
    counters: Vec<(usize, usize)>,
    /// Indices of the members with combinational outputs, in order.
    combinational: Vec<usize>,
    /// For each member, whether its combinational outputs are up to date with its state and inputs.
    is_combined: Vec<bool>,
    /// The next clock, counted from 1.
    now: u64,
    /// Indices of the members that were clocked in this clock.
    clocked: Vec<usize>,
    /// Nets with their values after this clock.
    changes: Vec<(usize, u64)>,
    /// Whether an output was set since `hold` began.
    shows_anew: bool,
}

/// Members to be clocked, in the order in which that became known.
struct Due {
    list: Vec<usize>,
    /// For each member, whether it is in the list.
    is_in: Vec<bool>,
}

impl Due {
    #[inline]
    fn add(&mut self, member: usize) {
        if !self.is_in[member] {
            self.is_in[member] = true;
            self.list.push(member);
        }
    }

    /// Moves the members into an empty list.
    fn take(&mut self, members: &mut Vec<usize>) {
        std::mem::swap(&mut self.list, members);
        members.iter().for_each(|member| self.is_in[*member] = false);
    }
}

impl Composed {
    /// Makes the model from the blocks of the parts, in their order, with the parts' ports.
    pub fn new(composition: Composition, blocks: Vec<Box<dyn Moore>>) -> Self {
        let wire = |net: &Net| match kind(&composition, &blocks, net) {
            OutputKind::Counter => Wire::counter(net.port.width),
            _ => Wire::default(),
        };
        let mut wires: Vec<Wire> = composition.nets.iter().map(wire).collect();
        let members = blocks.into_iter().zip(&composition.connections).zip(&composition.parts);
        let members: Vec<Member> = members
            .enumerate()
            .map(|(at, ((block, connections), part))| Member::new(at, block, part, connections, &mut wires))
            .collect();
        let outputs = composition
            .ports
            .iter()
            .filter(|port| port.direction == Direction::Output);
        let net = |port: &Port| composition.nets.iter().position(|net| net.port.name == port.name);
        let combinational = members
            .iter()
            .enumerate()
            .filter(|(_, member)| member.is_combinational());
        let output_nets: Vec<usize> = outputs.filter_map(net).collect();
        for (output, net) in output_nets.iter().enumerate() {
            wires[*net].output = Some(output);
        }
        let counters = output_nets.iter().copied().enumerate();
        let mut due = Due {
            list: Vec::new(),
            is_in: vec![false; members.len()],
        };
        (0..members.len()).for_each(|member| due.add(member));
        let mut composed = Self {
            inputs: composition
                .nets
                .iter()
                .filter(|net| net.driver.is_none())
                .map(|_| 0)
                .collect(),
            outputs: vec![0; output_nets.len()],
            counters: counters.filter(|(_, net)| wires[*net].counts()).collect(),
            combinational: combinational.map(|(at, _)| at).collect(),
            is_combined: vec![false; members.len()],
            clocked: due.list.clone(),
            due,
            wakes: vec![u64::MAX; members.len()],
            next_wake: u64::MAX,
            changes: Vec::new(),
            shows_anew: false,
            members,
            wires,
            now: 1,
            composition,
        };
        composed.settle();
        composed
    }

    /// Index of the net with this name, for [`value`](Self::value).
    pub fn net(&self, name: &str) -> Option<usize> {
        self.composition.nets.iter().position(|net| net.port.name == name)
    }

    /// Value of a net in the next clock, as far as registers determine it.
    pub fn value(&self, net: usize) -> u64 {
        self.wires[net].at(self.now)
    }

    /// Simulates clocks with the same inputs for as long as the outputs stay as they are, but at most `clocks`.
    /// Writes the outputs of these clocks to `outputs`, and returns the number of clocks: at least 1, unless `clocks`
    /// is 0. Outputs that are [counters](OutputKind::Counter) go up by one per clock instead. The result is that of
    /// as many calls of [`step`](ClockedBlock::step), but only clocks with events inside take time.
    ///
    /// Call it again to continue; [`show_with`](Moore::show_with) gives the outputs of the next clock.
    ///
    /// # Errors
    /// [`StepError`] for a wrong number of inputs or outputs.
    pub fn hold(&mut self, inputs: &[u64], clocks: u64, outputs: &mut [u64]) -> Result<u64, StepError> {
        self.check(inputs, outputs)?;
        self.show_with(inputs, outputs);
        self.shows_anew = false;
        let start = self.now;
        let end = start.saturating_add(clocks);
        while self.now < end {
            if self.due.list.is_empty() && self.next_wake > self.now {
                self.now = self.next_wake.min(end);
                continue;
            }
            self.clock()?;
            self.combine();
            // An output may have been set twice, at last to what it was.
            if std::mem::take(&mut self.shows_anew) && !self.shows(outputs, self.now - start) {
                break;
            }
        }
        Ok(self.now - start)
    }

    fn check(&self, inputs: &[u64], outputs: &[u64]) -> Result<(), StepError> {
        if (inputs.len(), outputs.len()) == (self.inputs.len(), self.outputs.len()) {
            return Ok(());
        }
        Err(StepError(format!(
            "{} inputs and {} outputs: the composition has {} and {}",
            inputs.len(),
            outputs.len(),
            self.inputs.len(),
            self.outputs.len()
        )))
    }

    /// Whether the outputs still show what they showed this many clocks ago.
    fn shows(&self, outputs: &[u64], clocks: u64) -> bool {
        let pairs = self.outputs.iter().zip(outputs).enumerate();
        let mut differ = pairs.filter(|(_, (now, before))| now != before);
        let counts = |at: usize| self.counters.iter().any(|(output, _)| *output == at);
        differ.all(|(at, _)| counts(at))
            && self.counters.iter().all(|(output, net)| {
                let wire = &self.wires[*net];
                wire.at(self.now) == wire.later(outputs[*output], clocks)
            })
    }

    /// Sets a net from now on, and wakes its watchers.
    #[inline]
    fn set(&mut self, net: usize, value: u64) {
        let (now, wire) = (self.now, &self.wires[net]);
        if wire.at(now) == value {
            return;
        }
        if let Some(output) = wire.output {
            self.outputs[output] = value;
            self.shows_anew = true;
        }
        for MemberInput { member, input } in &wire.watchers {
            self.members[*member].take(*input, value, &self.wires, now);
            self.is_combined[*member] = false;
            self.due.add(*member);
        }
        for MemberInput { member, input } in &wire.ignorers {
            self.members[*member].take(*input, value, &self.wires, now);
        }
        self.wires[net].set(value, now);
    }

    /// Sets the inputs of the coming clock.
    fn take(&mut self, inputs: &[u64]) {
        for (net, value) in inputs.iter().enumerate() {
            if self.inputs[net] != *value {
                self.inputs[net] = *value;
                self.set(net, *value);
            }
        }
        self.combine();
    }

    /// Updates combinational outputs of the members that were clocked or have new inputs.
    fn combine(&mut self) {
        for place in 0..self.combinational.len() {
            let at = self.combinational[place];
            if std::mem::replace(&mut self.is_combined[at], true) {
                continue;
            }
            self.members[at].combine(&self.wires, self.now);
            for output in 0..self.members[at].combinational_to.len() {
                let (from, net) = self.members[at].combinational_to[output];
                self.set(net, self.members[at].outputs[from]);
            }
            self.sleep(at);
        }
    }

    /// Lets a member that was clocked sleep until its next event or a change of an input.
    #[inline]
    fn sleep(&mut self, at: usize) {
        if self.due.is_in[at] || !self.members[at].is_clocked_to(self.now) {
            return;
        }
        self.wakes[at] = self.members[at].sleep_until(self.now);
        if self.wakes[at] > self.now {
            self.next_wake = self.next_wake.min(self.wakes[at]);
        } else {
            self.due.add(at);
        }
    }

    /// Wakes the members whose time has come.
    fn wake(&mut self) {
        self.next_wake = u64::MAX;
        for (at, wake) in self.wakes.iter().enumerate() {
            if *wake > self.now {
                self.next_wake = self.next_wake.min(*wake);
            } else {
                self.due.add(at);
            }
        }
    }

    /// Clocks all members that are awake.
    fn clock(&mut self) -> Result<(), StepError> {
        if self.next_wake <= self.now {
            self.wake();
        }
        self.clocked.clear();
        self.due.take(&mut self.clocked);
        for at in &self.clocked {
            self.wakes[*at] = u64::MAX;
            self.is_combined[*at] = false;
            self.members[*at].clock(&self.wires, self.now)?;
        }
        self.now += 1;
        self.settle();
        Ok(())
    }

    /// Sets the nets that the registers of the clocked members drive; then lets these members sleep if their inputs
    /// allow it.
    fn settle(&mut self) {
        let mut changes = std::mem::take(&mut self.changes);
        changes.clear();
        for at in &self.clocked {
            self.members[*at].show(&mut changes);
        }
        for (net, value) in &changes {
            self.set(*net, *value);
        }
        self.changes = changes;
        for place in 0..self.clocked.len() {
            let at = self.clocked[place];
            if !self.members[at].is_combinational() {
                self.sleep(at);
            }
        }
    }
}

/// The way in which a net gets its value.
fn kind(composition: &Composition, blocks: &[Box<dyn Moore>], net: &Net) -> OutputKind {
    let Some((part, output)) = net.driver else {
        return OutputKind::Register;
    };
    let mut outputs = composition.parts[part]
        .ports
        .iter()
        .filter(|port| port.direction == Direction::Output);
    let port = outputs.nth(output);
    port.map_or(OutputKind::Register, |port| blocks[part].output_kind(&port.name))
}

impl ClockedBlock for Composed {
    fn ports(&self) -> &[Port] {
        &self.composition.ports
    }

    fn step(&mut self, inputs: &[u64], outputs: &mut [u64]) -> Result<(), StepError> {
        self.check(inputs, outputs)?;
        self.show_with(inputs, outputs);
        self.clock()
    }

    fn advance(&mut self, inputs: &[u64], outputs: &mut [u64]) -> Result<(), StepError> {
        self.check(inputs, outputs)?;
        self.take(inputs);
        self.clock()
    }

    fn composed(&self) -> Option<&Composed> {
        Some(self)
    }
}

impl Moore for Composed {
    fn show(&self, outputs: &mut [u64]) {
        outputs.copy_from_slice(&self.outputs);
        for (output, net) in &self.counters {
            outputs[*output] = self.wires[*net].at(self.now);
        }
    }

    fn output_kind(&self, output: &str) -> OutputKind {
        let net = self.composition.nets.iter().find(|net| net.port.name == output);
        let part = net.and_then(|net| net.driver.map(|(part, at)| (part, at, net)));
        part.map_or(OutputKind::Register, |(part, at, _)| self.members[part].kind(at))
    }

    fn show_with(&mut self, inputs: &[u64], outputs: &mut [u64]) {
        self.take(inputs);
        self.show(outputs);
    }

    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        let combined = self.combinational.iter().all(|at| self.is_combined[*at]);
        let values = self.inputs.iter().zip(inputs).enumerate();
        let mut changed = values.filter(|(_, (before, value))| before != value);
        if combined && self.due.list.is_empty() && changed.all(|(net, _)| self.wires[net].watchers.is_empty()) {
            self.next_wake.saturating_sub(self.now)
        } else {
            0
        }
    }

    fn pass(&mut self, inputs: &[u64], clocks: u64) {
        self.now += clocks;
        for (net, value) in inputs.iter().enumerate() {
            if self.inputs[net] != *value {
                self.inputs[net] = *value;
                self.wires[net].set(*value, self.now - 1);
                for MemberInput { member, input } in &self.wires[net].ignorers {
                    self.members[*member].take_unnoticed(*input, *value);
                }
            }
        }
    }

    fn ignores(&self, input: &str) -> bool {
        let inputs = self.composition.nets.iter().zip(&self.wires).take(self.inputs.len());
        let mut named = inputs.filter(|(net, _)| net.port.name == input);
        named.all(|(_, wire)| wire.watchers.is_empty())
    }
}
