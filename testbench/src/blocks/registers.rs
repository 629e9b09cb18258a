//! The bench of `registers`: the bank of one map.

use posicast_hdl::SimulationError;
use posicast_hdl::emit::{EmitError, Module};
use posicast_hdl::registers::emit;
use posicast_model::rtl::ClockedBlock;
use posicast_model::rtl::registers::{RegisterBank, RegisterMap};

use super::{Bins, Block, not_in_rusthdl};
use crate::lockstep::Clock;
use crate::stimuli::{RegistersCoverage, RegistersRandom, Stimuli};

/// A register bank without the block behind it.
#[derive(Debug, Clone)]
pub struct RegistersBlock {
    map: RegisterMap,
    prefix: String,
    instance: String,
}

impl RegistersBlock {
    /// The bank `PREFIX_registers` of a map.
    pub fn new(map: RegisterMap, prefix: &str) -> Self {
        Self {
            instance: format!("of {}", map.name()),
            map,
            prefix: prefix.to_owned(),
        }
    }

    /// The same, called `instance` in the report.
    pub fn called(self, instance: &str) -> Self {
        Self {
            instance: instance.to_owned(),
            ..self
        }
    }
}

impl Block for RegistersBlock {
    fn name(&self) -> &str {
        "registers"
    }

    fn instance(&self) -> &str {
        &self.instance
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        emit(&self.map, &self.prefix).map(|module| vec![module])
    }

    fn top(&self) -> String {
        posicast_hdl::registers::name(&self.map, &self.prefix)
    }

    fn model(&self, _seed: u64) -> Box<dyn ClockedBlock> {
        Box::new(RegisterBank::new(&self.map))
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        Err(not_in_rusthdl("registers"))
    }

    fn in_rusthdl(&self) -> bool {
        false
    }

    fn stimuli(&self, _cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        Box::new(RegistersRandom::new(&self.map, self.map.ports(), seed))
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(RegistersCoverage::new(&self.map))
    }
}

impl Bins for RegistersCoverage {
    fn observe(&mut self, clock: &Clock<'_>) {
        self.observe(clock.inputs);
    }

    fn counts(&self) -> Vec<(String, u64)> {
        self.counts()
    }
}
