//! A component behind a bridge that operates its bus: the part that [`bus_component`](super::bus_component) and
//! [`linked_stage`](super::linked_stage) share.

use super::component::Component;
use super::composition::Composed;
use super::{ClockedBlock, Direction, Port, StepError};

/// Prefix of the ports of the component's bus.
const BUS_PREFIX: &str = "avs_";
/// Inputs of the component's bus, which come after `rst`: address, read, write, byteenable, writedata.
const BUS_INPUTS: usize = 5;

/// The ports of a component with a bridge, whose own ports are `of_bridge`: inputs, then outputs.
pub(super) fn ports(component: &Component, of_bridge: Vec<Port>) -> Vec<Port> {
    let of_component = component.composition().ports().iter();
    let own = of_component.filter(|port| !port.name.starts_with(BUS_PREFIX));
    let (reset, pins): (Vec<Port>, Vec<Port>) = own.cloned().partition(|port| port.name == "rst");
    let all = reset.into_iter().chain(of_bridge).chain(pins);
    let (inputs, outputs): (Vec<_>, Vec<_>) = all.partition(|port| port.direction == Direction::Input);
    inputs.into_iter().chain(outputs).collect()
}

/// The model of a component whose bus is operated by a bridge.
pub(super) struct Bridged {
    component: Composed,
    inputs: Vec<u64>,
    outputs: Vec<u64>,
    /// Place of `avs_readdata` among the outputs.
    read_data: usize,
}

impl Bridged {
    /// A component after reset. `seed` determines the arbitrary contents of memories.
    pub(super) fn new(component: &Component, seed: u64) -> Self {
        let ports = component.composition().ports();
        let count = |wanted| ports.iter().filter(|port| port.direction == wanted).count();
        let mut outputs = ports.iter().filter(|port| port.direction == Direction::Output);
        Self {
            inputs: vec![0; count(Direction::Input)],
            outputs: vec![0; count(Direction::Output)],
            read_data: outputs.position(|port| port.name == "avs_readdata").unwrap_or(0),
            component: component.model(seed),
        }
    }

    pub(super) fn composed(&self) -> &Composed {
        &self.component
    }

    /// Simulates a clock with an access and these inputs at the pins, writes all outputs but those of the bus to
    /// `outputs`, and returns the word that was read.
    ///
    /// # Errors
    /// [`StepError`] where `pins` or `outputs` are too few or too many.
    pub(super) fn step(
        &mut self,
        rst: bool,
        access: [u64; BUS_INPUTS],
        pins: &[u64],
        outputs: &mut [u64],
    ) -> Result<u32, StepError> {
        if 1 + access.len() + pins.len() != self.inputs.len() || outputs.len() + 1 != self.outputs.len() {
            let (inputs, outputs) = (pins.len(), outputs.len());
            return Err(StepError(format!("{inputs} inputs and {outputs} outputs at the pins")));
        }
        let (of_bus, of_pins) = self.inputs.split_at_mut(1 + access.len());
        of_bus[0] = rst.into();
        of_bus[1..].copy_from_slice(&access);
        of_pins.copy_from_slice(pins);
        self.component.step(&self.inputs, &mut self.outputs)?;
        let (before, after) = self.outputs.split_at(self.read_data);
        let (before_out, after_out) = outputs.split_at_mut(self.read_data);
        before_out.copy_from_slice(before);
        after_out.copy_from_slice(&after[1..]);
        Ok(after[0] as u32)
    }
}
