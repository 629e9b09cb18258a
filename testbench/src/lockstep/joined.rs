//! The model of a machine's top module: one block per axis, with shared `rst` and `strobe`.

use posicast_blocks::{ClockedBlock, Direction, Port, StepError};

use super::Instance;

/// Inputs that all axes share, with their plain names.
const SHARED: [&str; 2] = ["rst", "strobe"];

struct Member {
    axis: String,
    block: Box<dyn ClockedBlock>,
    /// For each input of the block, its index among our inputs.
    inputs_at: Vec<usize>,
    inputs: Vec<u64>,
    outputs: Vec<u64>,
}

/// Blocks side by side. The ports are `rst` and `strobe`, then for every axis its other ports as `<axis>_<port>`.
pub struct SideBySide {
    ports: Vec<Port>,
    members: Vec<Member>,
}

impl SideBySide {
    /// Joins the blocks of the named axes. A shared input appears if at least one block has it.
    pub fn new(axes: Vec<(String, Box<dyn ClockedBlock>)>) -> Self {
        let mut ports: Vec<Port> = Vec::new();
        for name in SHARED {
            let shared = axes.iter().find_map(|(_, b)| b.ports().iter().find(|p| p.name == name));
            ports.extend(shared.cloned());
        }
        for (axis, block) in &axes {
            let own = block.ports().iter().filter(|p| !SHARED.contains(&p.name.as_str()));
            ports.extend(own.map(|port| Port {
                name: format!("{axis}_{}", port.name),
                ..port.clone()
            }));
        }
        let inputs: Vec<&Port> = ports.iter().filter(|p| p.direction == Direction::Input).collect();
        let mut next = SHARED.iter().filter(|s| inputs.iter().any(|p| p.name == **s)).count();
        let members = axes.into_iter().map(|(axis, block)| {
            let own = block.ports().iter().filter(|p| p.direction == Direction::Input);
            let inputs_at: Vec<usize> = own
                .map(|port| {
                    let shared = SHARED.contains(&port.name.as_str());
                    match inputs.iter().position(|p| shared && p.name == port.name) {
                        Some(at) => at,
                        None => {
                            next += 1;
                            next - 1
                        }
                    }
                })
                .collect();
            let outputs = block
                .ports()
                .iter()
                .filter(|p| p.direction == Direction::Output)
                .count();
            Member {
                inputs: vec![0; inputs_at.len()],
                outputs: vec![0; outputs],
                inputs_at,
                axis,
                block,
            }
        });
        Self {
            members: members.collect(),
            ports,
        }
    }

    /// One instance of `block` per axis, in order, for the report.
    pub fn instances(&self, block: &str) -> Vec<Instance> {
        let instance = |member: &Member| {
            let outputs = member.block.ports().iter().filter(|p| p.direction == Direction::Output);
            Instance {
                block: block.to_owned(),
                name: member.axis.clone(),
                outputs: outputs.map(|p| format!("{}_{}", member.axis, p.name)).collect(),
            }
        };
        self.members.iter().map(instance).collect()
    }
}

impl ClockedBlock for SideBySide {
    fn ports(&self) -> &[Port] {
        &self.ports
    }

    fn step(&mut self, inputs: &[u64], outputs: &mut [u64]) -> Result<(), StepError> {
        let mut rest = outputs;
        for member in &mut self.members {
            for (input, at) in member.inputs.iter_mut().zip(&member.inputs_at) {
                *input = inputs[*at];
            }
            member.block.step(&member.inputs, &mut member.outputs)?;
            let (own, others) = rest.split_at_mut(member.outputs.len());
            own.copy_from_slice(&member.outputs);
            rest = others;
        }
        Ok(())
    }
}
