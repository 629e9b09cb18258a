//! Every block in every clock: the reference for a composition, without skipping anything.

use posicast_blocks::composition::{Composition, Connection};
use posicast_blocks::{ClockedBlock, Direction, Moore, OutputKind, Port, StepError};

/// A block, the nets of its inputs, and the nets of its outputs with their kinds.
struct Part {
    block: Box<dyn Moore>,
    inputs_from: Vec<Connection>,
    outputs_to: Vec<(usize, OutputKind)>,
    inputs: Vec<u64>,
    outputs: Vec<u64>,
}

impl Part {
    /// Reads its inputs from the nets.
    fn read(&mut self, nets: &[u64]) {
        for (input, from) in self.inputs.iter_mut().zip(&self.inputs_from) {
            *input = match from {
                Connection::Net(net) => nets[*net],
                Connection::Tied(value) => *value,
            };
        }
    }

    /// Writes its outputs to the nets.
    fn put(&self, nets: &mut [u64]) {
        for ((net, _), value) in self.outputs_to.iter().zip(&self.outputs) {
            nets[*net] = *value;
        }
    }
}

/// A composition that is clocked block by block.
pub(crate) struct Plain {
    composition: Composition,
    parts: Vec<Part>,
    nets: Vec<u64>,
    output_nets: Vec<usize>,
}

impl Plain {
    pub(crate) fn new((composition, blocks): (Composition, Vec<Box<dyn Moore>>)) -> Self {
        let parts = blocks.into_iter().zip(composition.connections());
        let part = |(block, connections): (Box<dyn Moore>, &Vec<Connection>)| {
            let (mut inputs_from, mut outputs_to) = (Vec::new(), Vec::new());
            for (port, on) in block.ports().iter().zip(connections) {
                match (port.direction, *on) {
                    (Direction::Input, on) => inputs_from.push(on),
                    (_, Connection::Net(net)) => outputs_to.push((net, block.output_kind(&port.name))),
                    (_, Connection::Tied(_)) => panic!("a tied output"),
                }
            }
            Part {
                block,
                inputs: vec![0; inputs_from.len()],
                outputs: vec![0; outputs_to.len()],
                inputs_from,
                outputs_to,
            }
        };
        let outputs = composition
            .ports()
            .iter()
            .filter(|port| port.direction == Direction::Output);
        let net = |port: &Port| composition.nets().iter().position(|net| net.port.name == port.name);
        Self {
            parts: parts.map(part).collect(),
            nets: vec![0; composition.nets().len()],
            output_nets: outputs.filter_map(net).collect(),
            composition,
        }
    }
}

impl ClockedBlock for Plain {
    fn ports(&self) -> &[Port] {
        self.composition.ports()
    }

    fn step(&mut self, inputs: &[u64], outputs: &mut [u64]) -> Result<(), StepError> {
        self.show_with(inputs, outputs);
        for part in &mut self.parts {
            part.read(&self.nets);
            part.block.step(&part.inputs, &mut part.outputs)?;
        }
        Ok(())
    }
}

/// As a part of another composition, it reports that it is never quiet.
impl Moore for Plain {
    fn show(&self, outputs: &mut [u64]) {
        let mut nets = self.nets.clone();
        for part in &self.parts {
            let mut shown = vec![0; part.outputs.len()];
            part.block.show(&mut shown);
            for ((net, _), value) in part.outputs_to.iter().zip(&shown) {
                nets[*net] = *value;
            }
        }
        for (output, net) in outputs.iter_mut().zip(&self.output_nets) {
            *output = nets[*net];
        }
    }

    fn output_kind(&self, output: &str) -> OutputKind {
        let net = self.composition.nets().iter().position(|net| net.port.name == output);
        let mut outputs = self.parts.iter().flat_map(|part| &part.outputs_to);
        outputs.find(|(to, _)| Some(*to) == net).unwrap().1
    }

    /// Updates registers first, then, part after part, what depends on inputs.
    fn show_with(&mut self, inputs: &[u64], outputs: &mut [u64]) {
        self.nets[..inputs.len()].copy_from_slice(inputs);
        for part in &mut self.parts {
            part.block.show(&mut part.outputs);
            part.put(&mut self.nets);
        }
        for part in &mut self.parts {
            if part
                .outputs_to
                .iter()
                .any(|(_, kind)| *kind == OutputKind::Combinational)
            {
                part.read(&self.nets);
                part.block.show_with(&part.inputs, &mut part.outputs);
                part.put(&mut self.nets);
            }
        }
        for (output, net) in outputs.iter_mut().zip(&self.output_nets) {
            *output = self.nets[*net];
        }
    }
}
