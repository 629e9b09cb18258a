//! A block in a composition, with the clock up to which it has been simulated.

use super::wire::Wire;
use super::{Connection, Part};
use crate::{Direction, Moore, OutputKind, StepError};

/// A block in a running composition. Its state is that before the clock `clocked_to`; from there on it is quiet until
/// the clock given by [`sleep_until`](Self::sleep_until), unless an input changes.
pub(super) struct Member {
    pub(super) block: Box<dyn Moore>,
    /// Indices of inputs with their nets; the other inputs are constants.
    inputs_from: Vec<(usize, usize)>,
    inputs: Vec<u64>,
    /// Whether no input has changed since they were read, and the clock as of which that was.
    is_read: bool,
    read_clock: u64,
    /// Whether it reads a net that counts, so that its inputs change without notice.
    reads_counter: bool,
    /// The net of each output, if that is one of registers that do not count.
    registers_to: Vec<Option<usize>>,
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
    /// Whether its combinational outputs are up to date with its state and inputs.
    pub(super) is_combined: bool,
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
        let (mut inputs, mut inputs_from) = (Vec::new(), Vec::new());
        let (mut reads_counter, mut never_sleeps) = (false, false);
        let mut kinds = Vec::new();
        let (mut registers_to, mut counters_to, mut combinational_to) = (Vec::new(), Vec::new(), Vec::new());
        for (port, on) in part.ports.iter().zip(connections) {
            match (port.direction, *on) {
                (Direction::Input, Connection::Tied(value)) => inputs.push(value),
                (Direction::Input, Connection::Net(net)) => {
                    inputs_from.push((inputs.len(), net));
                    inputs.push(0);
                    reads_counter |= wires[net].counts();
                    if block.ignores(&port.name) {
                        wires[net].ignorers.push(at);
                    } else {
                        never_sleeps |= wires[net].counts();
                        wires[net].watchers.push(at);
                    }
                }
                (Direction::Output, on) => {
                    let kind = block.output_kind(&port.name);
                    registers_to.push(None);
                    if let Connection::Net(net) = on {
                        match kind {
                            OutputKind::Combinational => combinational_to.push((kinds.len(), net)),
                            OutputKind::Counter => counters_to.push((kinds.len(), net)),
                            OutputKind::Register => registers_to[kinds.len()] = Some(net),
                        }
                    }
                    kinds.push(kind);
                }
            }
        }
        Self {
            block,
            inputs_from,
            inputs,
            is_read: false,
            read_clock: 0,
            reads_counter,
            registers_to,
            counters_to,
            combinational_to,
            outputs: vec![0; kinds.len()],
            // A net is 0 before it is set.
            shown: vec![0; kinds.len()],
            kinds,
            never_sleeps,
            clocked_to: 1,
            is_combined: false,
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

    /// An input has changed in the clock that comes next.
    #[inline]
    pub(super) fn has_new_inputs(&mut self) {
        self.is_read = false;
    }

    #[inline]
    fn read(&mut self, wires: &[Wire], clock: u64) {
        for (input, net) in &self.inputs_from {
            self.inputs[*input] = wires[*net].at(clock);
        }
    }

    /// Reads the inputs of this clock, if they are not those that were read.
    #[inline]
    fn read_now(&mut self, wires: &[Wire], now: u64) {
        if !self.is_read {
            self.read(wires, now);
            self.read_clock = now;
            self.is_read = !self.reads_counter;
        }
    }

    /// Appends the nets that its registers drive with another value than before, and those that should count.
    #[inline]
    pub(super) fn show(&mut self, changes: &mut Vec<(usize, u64)>) {
        self.block.show(&mut self.outputs);
        // In most clocks few outputs change, and often none.
        if self.outputs != self.shown {
            let outputs = self.outputs.iter().zip(&mut self.shown);
            for ((value, shown), net) in outputs.zip(&self.registers_to) {
                if *shown != *value {
                    *shown = *value;
                    changes.extend(net.map(|net| (net, *value)));
                }
            }
        }
        let counters = self.counters_to.iter();
        changes.extend(counters.map(|(from, net)| (*net, self.outputs[*from])));
    }

    /// Updates the outputs, since the combinational ones depend on the inputs of this clock.
    pub(super) fn combine(&mut self, wires: &[Wire], now: u64) {
        self.read_now(wires, now);
        self.block.show_with(&self.inputs, &mut self.outputs);
        self.is_combined = true;
    }

    /// Clocks it for this clock, after those that it has slept through.
    pub(super) fn clock(&mut self, wires: &[Wire], now: u64) -> Result<(), StepError> {
        if self.clocked_to < now {
            // It slept with the inputs before the change that woke it, which may have been read since.
            if !self.is_read || self.read_clock == now {
                self.read(wires, now - 1);
                self.is_read = false;
            }
            self.block.pass(&self.inputs, now - self.clocked_to);
        }
        self.read_now(wires, now);
        self.block.step(&self.inputs, &mut self.outputs)?;
        self.clocked_to = now + 1;
        self.is_combined = false;
        Ok(())
    }
}
