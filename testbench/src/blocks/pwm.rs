//! The bench of `pwm`.

use posicast_hdl::SimulationError;
use posicast_hdl::emit::{EmitError, Module};
use posicast_hdl::pwm::{emit, simulate};
use posicast_model::rtl::ClockedBlock;
use posicast_model::rtl::pwm::{Pwm, PwmConfig};

use super::{Bins, Block};
use crate::lockstep::Clock;
use crate::stimuli::{PwmCoverage, PwmRandom, Stimuli};

/// Clocks after which the stimuli have driven every flag, and every named mutant of `mutation::INSIDE` shows.
const LEAST_CLOCKS: u64 = 40_000;

/// The top module of the test of the fault path.
const ASYNCHRONOUS_TOP: &str = "posicast_asynchronous";

/// The PWM with its polarities and floors.
#[derive(Debug, Clone)]
pub struct PwmBlock {
    config: PwmConfig,
    prefix: String,
    instance: String,
}

impl PwmBlock {
    /// The PWM `PREFIX_pwm`; `instance` says which axes it serves.
    pub fn new(config: PwmConfig, prefix: &str, instance: &str) -> Self {
        Self {
            config,
            prefix: prefix.to_owned(),
            instance: instance.to_owned(),
        }
    }
}

impl Block for PwmBlock {
    fn name(&self) -> &str {
        "pwm"
    }

    fn instance(&self) -> &str {
        &self.instance
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        emit(&self.config, &self.prefix)
    }

    fn top(&self) -> String {
        posicast_hdl::pwm::name(&self.config, &self.prefix)
    }

    fn model(&self, _seed: u64) -> Box<dyn ClockedBlock> {
        Box::new(Pwm::new(&self.config))
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        simulate(&self.config)
    }

    fn stimuli(&self, _cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        Box::new(PwmRandom::new(seed))
    }

    fn least_clocks(&self) -> u64 {
        LEAST_CLOCKS
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(PwmCoverage::default())
    }

    fn asynchronous(&self) -> Option<(String, &'static str)> {
        let (dead_time, pulse) = (
            self.config.dead_time_floor_clocks(),
            self.config.minimum_pulse_floor_clocks(),
        );
        // Long enough that either side is on for a while, at the slowest floors too.
        let period = 8 * (u32::from(dead_time) + u32::from(pulse)) + 64;
        let bench = include_str!("pwm_asynchronous.v")
            .replace("TOP", &self.top())
            .replace("PERIOD", &period.to_string())
            .replace("DEAD", &dead_time.to_string())
            .replace("PULSE", &pulse.to_string());
        Some((bench, ASYNCHRONOUS_TOP))
    }
}

impl Bins for PwmCoverage {
    fn observe(&mut self, clock: &Clock<'_>) {
        self.observe(clock.inputs, clock.expected);
    }

    fn counts(&self) -> Vec<(String, u64)> {
        let counts = self.counts().into_iter();
        counts.map(|(name, count)| (name.to_owned(), count)).collect()
    }
}
