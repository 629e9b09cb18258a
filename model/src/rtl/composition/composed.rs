//! The blocks of a composition, stepped together.

use super::{Composition, Connection};
use crate::rtl::{ClockedBlock, Direction, Moore, Port, StepError};

/// A block while it is stepped.
struct Member {
    block: Box<dyn Moore>,
    /// For each input: net, or the constant that it is tied to.
    inputs_from: Vec<Connection>,
    /// For each output: its net.
    outputs_to: Vec<usize>,
    inputs: Vec<u64>,
    outputs: Vec<u64>,
}

/// The model of a composition: its blocks stepped together.
///
/// What a block shows to others must be registers ([`Moore`]): then all nets are known before any block is clocked, in
/// whatever order. An output that depends on inputs in the same clock may be an output of the whole only.
pub struct Composed {
    composition: Composition,
    members: Vec<Member>,
    nets: Vec<u64>,
    input_count: usize,
    /// Part and output of each output of the whole.
    outputs_from: Vec<(usize, usize)>,
}

impl Composed {
    /// `blocks` are those of the parts, in their order, with the parts' ports.
    pub fn new(composition: Composition, blocks: Vec<Box<dyn Moore>>) -> Self {
        let members = blocks.into_iter().zip(&composition.connections).zip(&composition.parts);
        let members = members.map(|((block, connections), part)| {
            let on = |direction| {
                let all = part.ports.iter().zip(connections);
                all.filter(move |(port, _)| port.direction == direction)
                    .map(|(_, on)| *on)
            };
            let inputs_from: Vec<Connection> = on(Direction::Input).collect();
            let nets = on(Direction::Output).filter_map(|on| match on {
                Connection::Net(net) => Some(net),
                Connection::Tied(_) => None,
            });
            let outputs_to: Vec<usize> = nets.collect();
            Member {
                block,
                inputs: vec![0; inputs_from.len()],
                outputs: vec![0; outputs_to.len()],
                inputs_from,
                outputs_to,
            }
        });
        let outputs = composition
            .ports
            .iter()
            .filter(|port| port.direction == Direction::Output);
        let driver = |port: &Port| {
            let net = composition.nets.iter().find(|net| net.port.name == port.name);
            net.and_then(|net| net.driver).unwrap_or_default()
        };
        let mut composed = Self {
            members: members.collect(),
            nets: vec![0; composition.nets.len()],
            input_count: composition.nets.iter().filter(|net| net.driver.is_none()).count(),
            outputs_from: outputs.map(driver).collect(),
            composition,
        };
        composed.settle();
        composed
    }

    /// How it is joined.
    pub fn composition(&self) -> &Composition {
        &self.composition
    }

    /// Nets to what the blocks' registers show.
    fn settle(&mut self) {
        for member in &mut self.members {
            member.block.show(&mut member.outputs);
            for (net, value) in member.outputs_to.iter().zip(&member.outputs) {
                self.nets[*net] = *value;
            }
        }
    }
}

impl ClockedBlock for Composed {
    fn ports(&self) -> &[Port] {
        &self.composition.ports
    }

    fn step(&mut self, inputs: &[u64], outputs: &mut [u64]) -> Result<(), StepError> {
        if (inputs.len(), outputs.len()) != (self.input_count, self.outputs_from.len()) {
            return Err(StepError(format!(
                "{} inputs and {} outputs: the composition has {} and {}",
                inputs.len(),
                outputs.len(),
                self.input_count,
                self.outputs_from.len()
            )));
        }
        self.nets[..inputs.len()].copy_from_slice(inputs);
        for member in &mut self.members {
            for (input, from) in member.inputs.iter_mut().zip(&member.inputs_from) {
                *input = match from {
                    Connection::Net(net) => self.nets[*net],
                    Connection::Tied(value) => *value,
                };
            }
            member.block.step(&member.inputs, &mut member.outputs)?;
        }
        for (output, (part, at)) in outputs.iter_mut().zip(&self.outputs_from) {
            *output = self.members[*part].outputs[*at];
        }
        self.settle();
        Ok(())
    }
}

impl Moore for Composed {
    fn show(&self, outputs: &mut [u64]) {
        for (output, (part, at)) in outputs.iter_mut().zip(&self.outputs_from) {
            *output = self.members[*part].outputs[*at];
        }
    }
}
