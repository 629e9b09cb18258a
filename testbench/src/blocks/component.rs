//! The bench of a component: a block behind its registers, on an Avalon-MM agent.

use posicast_hdl::SimulationError;
use posicast_hdl::component::emit;
use posicast_hdl::emit::{EmitError, Module};
use posicast_model::rtl::ClockedBlock;
use posicast_model::rtl::component::Component;

use super::changes::Changes;
use super::registry::RegistryRow;
use super::{Bins, Block, inside, not_in_rusthdl, proofs};
use crate::Error;
use crate::stimuli::{ComponentRandom, Stimuli};

/// Its row in the registry.
pub(super) const ROW: RegistryRow = RegistryRow {
    name: "component",
    benches: |sizes| {
        let components = sizes.components.iter().cloned();
        Ok(components.map(|block| Box::new(block) as Box<dyn Block>).collect())
    },
    proofs: || Ok(vec![proofs::sliding_mode::law_and_bank()?]),
    ..RegistryRow::EMPTY
};

/// A component under a name of its own.
#[derive(Debug, Clone)]
pub struct ComponentBlock {
    component: Component,
    top: String,
    prefix: String,
    axis: String,
    instance: String,
}

impl ComponentBlock {
    /// The component with the top module `top`, of this axis.
    pub fn new(component: Component, top: &str, axis: &str) -> Self {
        Self {
            component,
            top: top.to_owned(),
            prefix: top.to_owned(),
            axis: axis.to_owned(),
            instance: format!("{axis}, Avalon"),
        }
    }

    /// The same with modules that hold something of a machine called `PREFIX_…`: the machine's and axis's names, as a package has them. By default the prefix
    /// is the name of the top.
    pub fn with_prefix(self, prefix: &str) -> Self {
        Self {
            prefix: prefix.to_owned(),
            ..self
        }
    }

    /// Another component under the same names.
    pub fn like(&self, component: Component) -> Self {
        Self {
            component,
            ..self.clone()
        }
    }

    /// What it is.
    pub fn component(&self) -> &Component {
        &self.component
    }

    /// Its blocks, each as it stands in the component, on the bench of its kind: stimuli made for a block get to corners that
    /// traffic on the bus hardly ever sets up.
    ///
    /// What only joins them (sample select, setting banks, time base) has no bench of its own: the component's covers it.
    ///
    /// # Errors
    /// [`Error::Unlike`] where a shaper lacks a port that the stimuli drive.
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

    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(Changes::new(self.component.composition().ports()))
    }
}
