//! The bench of `absolute_encoder`.

pub(crate) mod encoder;
mod proofs;
mod reached;
pub(crate) mod stimuli;
mod trials;

pub use self::reached::AbsoluteEncoderCoverage;
pub use self::stimuli::AbsoluteEncoderRandom;

use posicast_blocks::ClockedBlock;
use posicast_blocks::absolute_encoder::{
    AbsoluteEncoder, AbsoluteEncoderConfig, AbsoluteFrame, AbsoluteLimits, AbsoluteProtocol, AbsoluteTimes, FrameCheck,
};
use posicast_hdl::SimulationError;
use posicast_hdl::absolute_encoder::{emit, name, simulate};
use posicast_hdl::emit::{EmitError, Module};

use crate::Error;
use crate::blocks::registry::{AreaRow, RegistryRow, SmallBench};
use crate::blocks::{Bins, Block, named};
use crate::formal::refused;
use crate::lockstep::Clock;
use crate::stimuli::Stimuli;

/// Readings after which the stimuli have driven every flag.
const LEAST_READINGS: u64 = 70;

/// The block's row in the registry.
pub(crate) const ROW: RegistryRow = RegistryRow {
    name: "absolute_encoder",
    benches: |sizes| {
        let of = |config| -> Box<dyn Block> { Box::new(AbsoluteEncoderBlock::new(config, &sizes.prefix)) };
        Ok(vec![of(biss()?), of(ssi()?)])
    },
    small: || {
        let small = |config, size| SmallBench {
            block: Box::new(AbsoluteEncoderBlock::new(config, "")),
            size,
        };
        Ok(vec![
            small(trials::small_biss()?, "BiSS-C, 8 bits"),
            small(trials::small_ssi()?, "SSI, 8 bits"),
        ])
    },
    proofs: proofs::all,
    areas: || {
        let row = |size, config| -> Result<AreaRow, Error> { Ok(AreaRow::new(size, emit(&config, "")?)) };
        Ok(vec![
            row("BiSS-C, 32 bits", biss()?)?,
            row("SSI, 25 bits in Gray code with parity", ssi()?)?,
        ])
    },
    trials: trials::all,
    mutants: trials::MUTANTS,
    proof_mutants: trials::PROOF_MUTANTS,
};

/// An encoder of 32 bits at 5 MHz, from a clock of 50 MHz; it is ready after 20 µs.
fn biss() -> Result<AbsoluteEncoderConfig, Error> {
    let times = AbsoluteTimes {
        half_period_clocks: 5,
        pause_clocks: 1000,
        answer_clocks: 500,
    };
    let limits = AbsoluteLimits {
        largest_jump: 1 << 20,
        tolerated: 3,
    };
    AbsoluteEncoderConfig::new(AbsoluteProtocol::BissC, AbsoluteFrame::biss_c(32), times, limits).map_err(refused)
}

/// An encoder with 12 bits of turns and 13 of the turn, at 1 MHz from a clock of 50 MHz; its monoflop takes 20 µs.
fn ssi() -> Result<AbsoluteEncoderConfig, Error> {
    let times = AbsoluteTimes {
        half_period_clocks: 25,
        pause_clocks: 1100,
        answer_clocks: 0,
    };
    let limits = AbsoluteLimits {
        largest_jump: 1000,
        tolerated: 3,
    };
    let frame = AbsoluteFrame {
        gray: true,
        check: FrameCheck::EvenParity,
        ..AbsoluteFrame::ssi(25)
    };
    AbsoluteEncoderConfig::new(AbsoluteProtocol::Ssi, frame, times, limits).map_err(refused)
}

/// The absolute encoder at one size.
#[derive(Debug, Clone)]
pub struct AbsoluteEncoderBlock {
    config: AbsoluteEncoderConfig,
    prefix: String,
    instance: String,
}

impl AbsoluteEncoderBlock {
    /// Creates the absolute encoder `PREFIX_absolute_encoder_…`.
    pub fn new(config: AbsoluteEncoderConfig, prefix: &str) -> Self {
        let protocol = match config.protocol() {
            AbsoluteProtocol::Ssi => "SSI",
            AbsoluteProtocol::BissC => "BiSS-C",
        };
        Self {
            config,
            prefix: prefix.to_owned(),
            instance: format!("{protocol}, {} bits", config.frame().position_bits),
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

impl Block for AbsoluteEncoderBlock {
    fn name(&self) -> &str {
        "absolute_encoder"
    }

    fn instance(&self) -> &str {
        &self.instance
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        emit(&self.config, &self.prefix)
    }

    fn top(&self) -> String {
        name(&self.config, &self.prefix)
    }

    fn model(&self, _seed: u64) -> Box<dyn ClockedBlock> {
        Box::new(AbsoluteEncoder::new(&self.config))
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        simulate(&self.config)
    }

    fn stimuli(&self, _cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        Box::new(AbsoluteEncoderRandom::new(&self.config, seed))
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(AbsoluteEncoderCoverage::new(&self.config))
    }

    fn fixed(&self) -> Vec<(String, &'static str)> {
        let frame = self.config.frame();
        let missing = [
            (
                "check_failed",
                frame.check == FrameCheck::None,
                "the frame has no check",
            ),
            ("error_bit", frame.error.is_none(), "the frame has no error bit"),
            ("warning_bit", frame.warning.is_none(), "the frame has no warning bit"),
        ];
        let none = self.config.limits().tolerated == 0;
        let never = [("extrapolated", none, "no failed reading is tolerated")];
        let missing = missing.into_iter().chain(never);
        let missing = missing.filter(|(_, is_missing, _)| *is_missing);
        missing.map(|(flag, _, reason)| (flag.to_owned(), reason)).collect()
    }

    fn least_clocks(&self) -> u64 {
        LEAST_READINGS * self.config.least_tick_clocks()
    }
}

impl Bins for AbsoluteEncoderCoverage {
    fn observe(&mut self, clock: &Clock<'_>) {
        self.observe(clock);
    }

    fn counts(&self) -> Vec<(String, u64)> {
        named(self.counts())
    }
}
