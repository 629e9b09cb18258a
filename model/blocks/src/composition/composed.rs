//! The blocks of a composition, simulated together; each is clocked only when something happens in it.

use super::member::Member;
use super::wire::Wire;
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
    /// Indices of the members that must be clocked next, and for each member whether it is one of them.
    due: Vec<usize>,
    is_due: Vec<bool>,
    /// The clock in which each other member must be clocked.
    wakes: Vec<u64>,
    /// None of them must be clocked before this clock.
    next_wake: u64,
    wires: Vec<Wire>,
    input_count: usize,
    /// Net of each output of the composition.
    output_nets: Vec<usize>,
    /// Indices of the members with combinational outputs, in order.
    combinational: Vec<usize>,
    /// The next clock, counted from 1.
    now: u64,
    /// Indices of the members that were clocked in this clock.
    clocked: Vec<usize>,
    /// Nets with their values after this clock.
    changes: Vec<(usize, u64)>,
    /// Whether an output was set since `hold` began.
    shows_anew: bool,
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
        for net in &output_nets {
            wires[*net].is_output = true;
        }
        let all: Vec<usize> = (0..members.len()).collect();
        let mut composed = Self {
            input_count: composition.nets.iter().filter(|net| net.driver.is_none()).count(),
            output_nets,
            combinational: combinational.map(|(at, _)| at).collect(),
            clocked: all.clone(),
            due: all,
            is_due: vec![true; members.len()],
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
            if self.due.is_empty() && self.next_wake > self.now {
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
        if (inputs.len(), outputs.len()) == (self.input_count, self.output_nets.len()) {
            return Ok(());
        }
        Err(StepError(format!(
            "{} inputs and {} outputs: the composition has {} and {}",
            inputs.len(),
            outputs.len(),
            self.input_count,
            self.output_nets.len()
        )))
    }

    /// Whether the outputs still show what they showed this many clocks ago.
    fn shows(&self, outputs: &[u64], clocks: u64) -> bool {
        let wires = self.output_nets.iter().map(|net| &self.wires[*net]);
        let mut pairs = wires.zip(outputs);
        pairs.all(|(wire, output)| wire.at(self.now) == wire.later(*output, clocks))
    }

    /// Sets a net from now on, and wakes its watchers.
    #[inline]
    fn set(&mut self, net: usize, value: u64) {
        let wire = &mut self.wires[net];
        if !wire.set(value, self.now) {
            return;
        }
        self.shows_anew |= wire.is_output;
        for watcher in &wire.watchers {
            self.members[*watcher].has_new_inputs();
            self.members[*watcher].is_combined = false;
            if !self.is_due[*watcher] {
                self.is_due[*watcher] = true;
                self.due.push(*watcher);
            }
        }
        for ignorer in &wire.ignorers {
            self.members[*ignorer].has_new_inputs();
        }
    }

    /// Updates combinational outputs of the members that were clocked or have new inputs.
    fn combine(&mut self) {
        for place in 0..self.combinational.len() {
            let at = self.combinational[place];
            if self.members[at].is_combined {
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
        if self.is_due[at] || !self.members[at].is_clocked_to(self.now) {
            return;
        }
        self.wakes[at] = self.members[at].sleep_until(self.now);
        if self.wakes[at] > self.now {
            self.next_wake = self.next_wake.min(self.wakes[at]);
        } else {
            self.is_due[at] = true;
            self.due.push(at);
        }
    }

    /// Wakes the members whose time has come.
    fn wake(&mut self) {
        self.next_wake = u64::MAX;
        for (at, wake) in self.wakes.iter().enumerate() {
            if *wake > self.now {
                self.next_wake = self.next_wake.min(*wake);
            } else if !self.is_due[at] {
                self.is_due[at] = true;
                self.due.push(at);
            }
        }
    }

    /// Clocks all members that are awake.
    fn clock(&mut self) -> Result<(), StepError> {
        if self.next_wake <= self.now {
            self.wake();
        }
        self.clocked.clear();
        std::mem::swap(&mut self.clocked, &mut self.due);
        for at in &self.clocked {
            self.is_due[*at] = false;
            self.wakes[*at] = u64::MAX;
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
        for at in &self.clocked {
            self.members[*at].show(&mut changes);
        }
        for (net, value) in changes.drain(..) {
            self.set(net, value);
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

    fn composed(&self) -> Option<&Composed> {
        Some(self)
    }
}

impl Moore for Composed {
    fn show(&self, outputs: &mut [u64]) {
        for (output, net) in outputs.iter_mut().zip(&self.output_nets) {
            *output = self.wires[*net].at(self.now);
        }
    }

    fn output_kind(&self, output: &str) -> OutputKind {
        let net = self.composition.nets.iter().find(|net| net.port.name == output);
        let part = net.and_then(|net| net.driver.map(|(part, at)| (part, at, net)));
        part.map_or(OutputKind::Register, |(part, at, _)| self.members[part].kind(at))
    }

    fn show_with(&mut self, inputs: &[u64], outputs: &mut [u64]) {
        for (net, value) in inputs.iter().enumerate().take(self.input_count) {
            self.set(net, *value);
        }
        self.combine();
        self.show(outputs);
    }

    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        let combined = self.combinational.iter().all(|at| self.members[*at].is_combined);
        let watched = self.wires.iter().zip(inputs).take(self.input_count);
        let mut watched = watched.filter(|(wire, _)| !wire.watchers.is_empty());
        if combined && self.due.is_empty() && watched.all(|(wire, value)| wire.at(self.now) == *value) {
            self.next_wake.saturating_sub(self.now)
        } else {
            0
        }
    }

    fn pass(&mut self, inputs: &[u64], clocks: u64) {
        self.now += clocks;
        for (wire, value) in self.wires.iter_mut().zip(inputs).take(self.input_count) {
            if wire.set(*value, self.now - 1) {
                let readers = wire.watchers.iter().chain(&wire.ignorers);
                readers.for_each(|reader| self.members[*reader].has_new_inputs());
            }
        }
    }

    fn ignores(&self, input: &str) -> bool {
        let inputs = self.composition.nets.iter().zip(&self.wires).take(self.input_count);
        let mut named = inputs.filter(|(net, _)| net.port.name == input);
        named.all(|(_, wire)| wire.watchers.is_empty())
    }
}
