//! A block in a composition, with the clock up to which it has been simulated.

use super::wire::{MemberInput, Wire};
use super::{Connection, Part};
use crate::{Direction, Moore, OutputKind, StepError};

/// A block in a running composition. Its state is that before the clock `clocked_to`; from there on it is quiet until
/// the clock given by [`sleep_until`](Self::sleep_until), unless an input changes.
pub(super) struct Member {
    pub(super) block: Box<dyn Moore>,
    /// The inputs as of the next clock, but for those of `counters_from`.
    inputs: Vec<u64>,
    /// Indices of inputs with their nets that count, and so change without notice.
    counters_from: Vec<(usize, usize)>,
    /// Indices of outputs of registers that do not count, with their nets.
    registers_to: Vec<(usize, usize)>,
    /// Indices of outputs that count, with their nets.
    counters_to: Vec<(usize, usize)>,
    pub(super) combinational_to: Vec<(usize, usize)>,
    pub(super) outputs: Vec<u64>,
    /// The outputs as they were shown last, which the nets of registers have.
    shown: Vec<u64>,
    kinds: Vec<OutputKind>,
    /// Whether it watches a net that counts, so that it must be clocked in every clock.
    never_sleeps: bool,
    clocked_to: u64,
}

impl Member {
    /// Makes the member for the part with this index of the composition, and registers it with the wires that it
    /// watches.
    pub(super) fn new(
        at: usize,
        block: Box<dyn Moore>,
        part: &Part,
        connections: &[Connection],
        wires: &mut [Wire],
    ) -> Self {
        let (mut inputs, mut counters_from) = (Vec::new(), Vec::new());
        let mut never_sleeps = false;
        let mut kinds = Vec::new();
        let (mut registers_to, mut counters_to, mut combinational_to) = (Vec::new(), Vec::new(), Vec::new());
        for (port, on) in part.ports.iter().zip(connections) {
            match (port.direction, *on) {
                (Direction::Input, Connection::Tied(value)) => inputs.push(value),
                (Direction::Input, Connection::Net(net)) => {
                    let reader = MemberInput {
                        member: at,
                        input: inputs.len(),
                    };
                    // A net is 0 before it is set.
                    inputs.push(0);
                    if wires[net].counts() {
                        counters_from.push((reader.input, net));
                    }
                    if block.ignores(&port.name) {
                        wires[net].ignorers.push(reader);
                    } else {
                        never_sleeps |= wires[net].counts();
                        wires[net].watchers.push(reader);
                    }
                }
                (Direction::Output, on) => {
                    let kind = block.output_kind(&port.name);
                    if let Connection::Net(net) = on {
                        match kind {
                            OutputKind::Combinational => combinational_to.push((kinds.len(), net)),
                            OutputKind::Counter => counters_to.push((kinds.len(), net)),
                            OutputKind::Register => registers_to.push((kinds.len(), net)),
                        }
                    }
                    kinds.push(kind);
                }
            }
        }
        Self {
            block,
            inputs,
            counters_from,
            registers_to,
            counters_to,
            combinational_to,
            outputs: vec![0; kinds.len()],
            // A net is 0 before it is set.
            shown: vec![0; kinds.len()],
            kinds,
            never_sleeps,
            clocked_to: 1,
        }
    }

    pub(super) fn kind(&self, output: usize) -> OutputKind {
        self.kinds.get(output).copied().unwrap_or(OutputKind::Register)
    }

    pub(super) fn is_combinational(&self) -> bool {
        !self.combinational_to.is_empty()
    }

    /// The clock of its next event, after it was clocked to `now`, with all nets known and no input changed.
    pub(super) fn sleep_until(&self, now: u64) -> u64 {
        if self.never_sleeps {
            return now;
        }
        now.saturating_add(self.block.quiet_clocks(&self.inputs))
    }

    /// Whether it was clocked in the clock before `now`.
    pub(super) fn is_clocked_to(&self, now: u64) -> bool {
        self.clocked_to == now
    }

    /// Passes the clocks before `now` in which it slept.
    #[inline]
    fn catch_up(&mut self, wires: &[Wire], now: u64) {
        if self.clocked_to < now {
            self.count(wires, now - 1);
            self.block.pass(&self.inputs, now - self.clocked_to);
            self.clocked_to = now;
        }
    }

    /// Sets an input from the clock `now` on. The clocks before it passed with the old value.
    #[inline]
    pub(super) fn take(&mut self, input: usize, value: u64, wires: &[Wire], now: u64) {
        self.catch_up(wires, now);
        self.inputs[input] = value;
    }

    /// Sets an input that it ignored in the clocks in which it slept.
    #[inline]
    pub(super) fn take_unnoticed(&mut self, input: usize, value: u64) {
        self.inputs[input] = value;
    }

    /// Sets the inputs that count to their values in this clock.
    #[inline]
    fn count(&mut self, wires: &[Wire], clock: u64) {
        for (input, net) in &self.counters_from {
            self.inputs[*input] = wires[*net].at(clock);
        }
    }

    /// Appends the nets that its registers drive with another value than before, and those that should count.
    #[inline]
    pub(super) fn show(&mut self, changes: &mut Vec<(usize, u64)>) {
        self.block.show(&mut self.outputs);
        for (from, net) in &self.registers_to {
            let (value, shown) = (self.outputs[*from], &mut self.shown[*from]);
            if *shown != value {
                *shown = value;
                changes.push((*net, value));
            }
        }
        let counters = self.counters_to.iter();
        changes.extend(counters.map(|(from, net)| (*net, self.outputs[*from])));
    }

    /// Updates the outputs, since the combinational ones depend on the inputs of this clock.
    pub(super) fn combine(&mut self, wires: &[Wire], now: u64) {
        self.count(wires, now);
        self.block.show_with(&self.inputs, &mut self.outputs);
    }

    /// Clocks it for this clock, after those that it has slept through.
    pub(super) fn clock(&mut self, wires: &[Wire], now: u64) -> Result<(), StepError> {
        self.catch_up(wires, now);
        self.count(wires, now);
        self.block.advance(&self.inputs, &mut self.outputs)?;
        self.clocked_to = now + 1;
        Ok(())
    }
}
