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
    /// Indices of registered outputs with their nets.
    pub(super) registers_to: Vec<(usize, usize)>,
    pub(super) combinational_to: Vec<(usize, usize)>,
    pub(super) outputs: Vec<u64>,
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
        let (mut inputs, mut inputs_from, mut never_sleeps) = (Vec::new(), Vec::new(), false);
        let (mut kinds, mut registers_to, mut combinational_to) = (Vec::new(), Vec::new(), Vec::new());
        for (port, on) in part.ports.iter().zip(connections) {
            match (port.direction, *on) {
                (Direction::Input, Connection::Tied(value)) => inputs.push(value),
                (Direction::Input, Connection::Net(net)) => {
                    inputs_from.push((inputs.len(), net));
                    inputs.push(0);
                    if !block.ignores(&port.name) {
                        never_sleeps |= wires[net].counts();
                        wires[net].watchers.push(at);
                    }
                }
                (Direction::Output, on) => {
                    let kind = block.output_kind(&port.name);
                    let nets = match kind {
                        OutputKind::Combinational => &mut combinational_to,
                        _ => &mut registers_to,
                    };
                    if let Connection::Net(net) = on {
                        nets.push((kinds.len(), net));
                    }
                    kinds.push(kind);
                }
            }
        }
        Self {
            block,
            inputs_from,
            inputs,
            registers_to,
            combinational_to,
            outputs: vec![0; kinds.len()],
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

    #[inline]
    fn read(&mut self, wires: &[Wire], clock: u64) {
        for (input, net) in &self.inputs_from {
            self.inputs[*input] = wires[*net].at(clock);
        }
    }

    /// Updates the outputs, since the combinational ones depend on the inputs of this clock.
    pub(super) fn combine(&mut self, wires: &[Wire], now: u64) {
        self.read(wires, now);
        self.block.show_with(&self.inputs, &mut self.outputs);
        self.is_combined = true;
    }

    /// Clocks it for this clock, after those that it has slept through.
    pub(super) fn clock(&mut self, wires: &[Wire], now: u64) -> Result<(), StepError> {
        if self.clocked_to < now {
            self.read(wires, now - 1);
            self.block.pass(&self.inputs, now - self.clocked_to);
        }
        self.read(wires, now);
        self.block.step(&self.inputs, &mut self.outputs)?;
        self.clocked_to = now + 1;
        self.is_combined = false;
        Ok(())
    }
}
