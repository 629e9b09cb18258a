//! The bench of a component: a block with registers, driven through its Avalon-MM agent.

pub(crate) mod stimuli;

pub use self::stimuli::ComponentRandom;

use posicast_blocks::ClockedBlock;
use posicast_blocks::component::Component;
use posicast_hdl::SimulationError;
use posicast_hdl::component::emit;
use posicast_hdl::emit::{EmitError, Module};

use crate::Error;
use crate::blocks::changes::Changes;
use crate::blocks::reached::AtThePorts;
use crate::blocks::registry::RegistryRow;
use crate::blocks::{Bins, Block, ProofMutant, Reach, inside, not_in_rusthdl};
use crate::stimuli::Stimuli;

/// The block's row in the registry.
pub(crate) const ROW: RegistryRow = RegistryRow {
    name: "component",
    benches: |sizes| {
        let components = sizes.components.iter().cloned();
        Ok(components.map(|block| Box::new(block) as Box<dyn Block>).collect())
    },
    proofs: || Ok(vec![crate::sliding_mode::proofs::law_and_bank()?]),
    proof_mutants: &[ProofMutant::new(
        "a law that changes in a pass",
        "applies = waits && ends",
        "applies = waits",
    )
    .of("law_and_bank")],
    ..RegistryRow::EMPTY
};

/// A component with the name of its top module.
#[derive(Debug, Clone)]
pub struct ComponentBlock {
    component: Component,
    top: String,
    prefix: String,
    axis: String,
    instance: String,
}

impl ComponentBlock {
    /// Creates the component of an axis with the top module `top`.
    pub fn new(component: Component, top: &str, axis: &str) -> Self {
        Self {
            component,
            top: top.to_owned(),
            prefix: top.to_owned(),
            axis: axis.to_owned(),
            instance: format!("{axis}, Avalon"),
        }
    }

    /// Sets the prefix of the modules whose contents depend on the machine: in a package, the names of machine and
    /// axis. By default it is the name of the top.
    pub fn with_prefix(self, prefix: &str) -> Self {
        Self {
            prefix: prefix.to_owned(),
            ..self
        }
    }

    /// Prefix of the modules whose contents depend on the machine.
    pub fn prefix(&self) -> &str {
        &self.prefix
    }

    /// Replaces the component and keeps the names.
    pub fn like(&self, component: Component) -> Self {
        Self {
            component,
            ..self.clone()
        }
    }

    /// Returns the component.
    pub fn component(&self) -> &Component {
        &self.component
    }

    /// Returns the component's blocks, each with the modules of the component, on the bench of its kind: stimuli made
    /// for a block reach corner cases that traffic on the bus hardly ever does.
    ///
    /// The blocks that only connect others (sample select, setting banks, time base) are left out: the component's
    /// bench covers them.
    ///
    /// # Errors
    /// [`Error::Unlike`] if a shaper lacks a port that the stimuli drive.
    pub fn inner(&self) -> Result<Vec<Box<dyn Block>>, Error> {
        inside::of_component(&self.component, &self.prefix, &self.axis)
    }
}

impl Block for ComponentBlock {
    fn name(&self) -> &str {
        self.component.name()
    }

    fn instance(&self) -> &str {
        &self.instance
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        emit(&self.component, &self.top, &self.prefix)
    }

    fn top(&self) -> String {
        self.top.clone()
    }

    fn model(&self, seed: u64) -> Box<dyn ClockedBlock> {
        Box::new(self.component.model(seed))
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        Err(not_in_rusthdl("component"))
    }

    fn in_rusthdl(&self) -> bool {
        false
    }

    fn stimuli(&self, _cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        Box::new(ComponentRandom::new(&self.component, seed))
    }

    fn reach(&self) -> Box<dyn Reach + '_> {
        let ports = self.component.composition().ports();
        Box::new(AtThePorts::new(&self.instance, "", ports, Some(self.component.map())))
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(Changes::new(self.component.composition().ports()))
    }
}
