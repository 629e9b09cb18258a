//! The bench of `registers`: the register bank of one map.

mod coverage;
mod promises;
pub(crate) mod proofs;
pub(crate) mod stimuli;

pub use self::coverage::RegistersCoverage;
pub use self::promises::ReadPromises;
pub use self::stimuli::RegistersRandom;

use posicast_blocks::ClockedBlock;
use posicast_blocks::component::{Component, ComponentError};
use posicast_blocks::divider::DividerConfig;
use posicast_blocks::pwm::{ActiveLow, BridgeMode, PwmConfig};
use posicast_blocks::registers::{RegisterBank, RegisterMap};
use posicast_blocks::sliding_mode::{Law, Settings};
use posicast_hdl::SimulationError;
use posicast_hdl::emit::{EmitError, Module};
use posicast_hdl::registers::emit;

use crate::Error;
use crate::blocks::reached::AtThePorts;
use crate::blocks::registry::{AreaRow, RegistryRow, small};
use crate::blocks::{Bins, Block, ProofMutant, Reach, not_in_rusthdl};
use crate::formal::refused;
use crate::lockstep::Clock;
use crate::shaper;
use crate::stimuli::Stimuli;

/// The block's row in the registry, with the register bank of each component.
pub(crate) const ROW: RegistryRow = RegistryRow {
    name: "registers",
    benches: |sizes| {
        let mut maps: Vec<&RegisterMap> = Vec::new();
        for map in sizes.components.iter().map(|component| component.component().map()) {
            if !maps.iter().any(|other| other.name() == map.name()) {
                maps.push(map);
            }
        }
        let bench = |map: &RegisterMap| -> Box<dyn Block> { Box::new(RegistersBlock::new(map.clone(), map.name())) };
        Ok(maps.into_iter().map(bench).collect())
    },
    small: || {
        let map = pwm_component()?.map().clone();
        Ok(small(RegistersBlock::new(map, ""), "bank of pwm"))
    },
    proofs: proofs::tasks,
    proof_mutants: &[
        ProofMutant::new(
            "a byte that nobody wrote",
            "phase[15:8] <= avs_writedata[15:8]",
            "phase[15:8] <= avs_writedata[7:0]",
        )
        .violates("holds_what_was_written"),
        ProofMutant::new(
            "a write after its commit",
            "if (write_law && !waits && avs_byteenable[0])",
            "if (write_law && avs_byteenable[0])",
        )
        .of("commit")
        .violates("all_at_once"),
    ],
    areas: || {
        let motion = shaper::area_config()?.for_motion(shaper::MOTION);
        let pwm = PwmConfig::new(ActiveLow::default(), 25, 50).map_err(refused)?;
        Ok(vec![
            area("of shaper, 3 channels", Component::shaper(motion.map_err(refused)?))?,
            area(
                "of pulse_counter",
                Component::pulse_counter(DividerConfig::new(5000).map_err(refused)?, 8, false),
            )?,
            area("of pwm", Component::pwm(pwm, BridgeMode::HalfBridge, 2500))?,
            area(
                "of sliding_mode",
                Component::sliding_mode(&Settings::default(), Law::SlidingMode, false),
            )?,
        ])
    },
    ..RegistryRow::EMPTY
};

/// A register bank without its block.
#[derive(Debug, Clone)]
pub struct RegistersBlock {
    map: RegisterMap,
    prefix: String,
    instance: String,
}

impl RegistersBlock {
    /// Creates the register bank `PREFIX_registers` of a map.
    pub fn new(map: RegisterMap, prefix: &str) -> Self {
        Self {
            instance: format!("of {}", map.name()),
            map,
            prefix: prefix.to_owned(),
        }
    }

    /// Renames the block to `instance` in the report.
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

    fn reach(&self) -> Box<dyn Reach + '_> {
        Box::new(AtThePorts::new(&self.instance, "", self.map.ports(), Some(&self.map)))
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

/// The component whose bank has fields of every kind, an interrupt, and byte enables.
pub(crate) fn pwm_component() -> Result<Component, Error> {
    let config = PwmConfig::new(ActiveLow::default(), 25, 50).map_err(refused)?;
    Component::pwm(config, BridgeMode::Unipolar, 2500).map_err(refused)
}

fn area(size: &'static str, component: Result<Component, ComponentError>) -> Result<AreaRow, Error> {
    let modules = vec![emit(component.map_err(refused)?.map(), "")?];
    Ok(AreaRow::new(size, modules))
}
