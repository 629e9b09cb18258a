//! The bench of `pwm`.

pub(crate) mod stimuli;
mod trials;

pub use self::stimuli::{GateSafety, PwmCoverage, PwmRandom};

use posicast_blocks::ClockedBlock;
use posicast_blocks::pwm::{ActiveLow, Pwm, PwmConfig, ports};
use posicast_hdl::SimulationError;
use posicast_hdl::emit::{EmitError, Module};
use posicast_hdl::pwm::{emit, simulate};

use crate::Error;
use crate::blocks::registry::{AreaRow, RegistryRow, small};
use crate::blocks::{Bins, Block};
use crate::formal::{INDUCTION, Task, refused};
use crate::lockstep::Clock;
use crate::stimuli::Stimuli;

/// Number of clocks after which the stimuli have driven every flag, and have revealed every named mutant of
/// `mutation::INSIDE`.
const LEAST_CLOCKS: u64 = 40_000;

/// The top module of the test of the fault path.
const ASYNCHRONOUS_TOP: &str = "posicast_asynchronous";

/// The block's row in the registry.
pub(crate) const ROW: RegistryRow = RegistryRow {
    name: "pwm",
    benches: |sizes| {
        let bench = |(config, axes): &(PwmConfig, String)| -> Box<dyn Block> {
            Box::new(PwmBlock::new(*config, &sizes.prefix, axes))
        };
        Ok(sizes.pwms.iter().map(bench).collect())
    },
    small: || {
        let config = PwmConfig::new(ActiveLow::default(), 2, 1).map_err(refused)?;
        let block = PwmBlock::new(config, "", "alone");
        Ok(small(block, "16-bit period, all active high"))
    },
    proofs,
    areas: || {
        let config = PwmConfig::new(ActiveLow::default(), 25, 50).map_err(refused)?;
        Ok(vec![
            AreaRow::new("all modes", emit(&config, "")?).budget(300, 220).note(
                "One adder of 19 bits computes duty, limits and edges in turn; with its operand selection it \
                 takes 161 LUT. 97 LUT compare positions with period, phase and trigger. The rest is fault path, \
                 leg and times.",
            ),
        ])
    },
    trials: trials::all,
    mutants: trials::MUTANTS,
    proof_mutants: trials::PROOF_MUTANTS,
};

/// The PWM with its polarities and smallest times.
#[derive(Debug, Clone)]
pub struct PwmBlock {
    config: PwmConfig,
    prefix: String,
    instance: String,
}

impl PwmBlock {
    /// Creates the PWM `PREFIX_pwm`; `instance` names the axes that it serves.
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
        // This is long enough for either side to be on for a while, even with the longest smallest times.
        let period = 8 * (u32::from(dead_time) + u32::from(pulse)) + 64;
        let bench = include_str!("asynchronous.v")
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

fn proofs() -> Result<Vec<Task>, Error> {
    let two_low = ActiveLow {
        a_high: true,
        b_low: true,
        ..ActiveLow::default()
    };
    let plain = PwmConfig::new(ActiveLow::default(), 2, 1).map_err(refused)?;
    let other = PwmConfig::new(two_low, 25, 50).map_err(refused)?.on_time_base();
    Ok(vec![
        proof(plain, "16-bit period, all active high")?,
        proof(other, "16-bit period, two pins active low, on a time base")?,
    ])
}

fn proof(config: PwmConfig, size: &str) -> Result<Task, Error> {
    let active_low = config.active_low();
    let bit = |low: bool| u8::from(low);
    let off = format!(
        "4'b{}{}{}{}",
        bit(active_low.b_low),
        bit(active_low.b_high),
        bit(active_low.a_low),
        bit(active_low.a_high)
    );
    let macros = [
        ("PINS_OFF", off),
        ("DEAD_TIME_FLOOR", format!("10'd{}", config.dead_time_floor_clocks())),
        (
            "MINIMUM_PULSE_FLOOR",
            format!("10'd{}", config.minimum_pulse_floor_clocks()),
        ),
        ("ON_TIME_BASE", format!("1'b{}", bit(config.is_on_time_base()))),
    ];
    let block = (emit(&config, "")?, ports());
    Ok(Task::new("pwm", size, INDUCTION, block).properties(&macros, include_str!("pwm.sv")))
}
