//! The bench of `shaper`: one shaper alone, or all shapers of a machine in its top module.

mod machine;
pub(crate) mod proofs;
pub(crate) mod stimuli;
mod trials;

pub use self::machine::MachineShapers;
pub use self::stimuli::{
    Action, AxisLayout, Coverage, Directed, Fill, Layout, MotionStimuli, Random, ShaperExercise, TableLayout, cases,
    corners, motion_cases,
};
use posicast_blocks::ClockedBlock;
use posicast_blocks::axis_shaper::AxisShaperConfig;
use posicast_blocks::shaper::{Shaper, ShaperConfig, ShaperMotion, ports};
use posicast_hdl::SimulationError;
use posicast_hdl::emit::{EmitError, Module};
use posicast_hdl::shaper::{emit, simulate, simulated_as};
use posicast_taps::{Tap, TapTable};

use crate::Error;
use crate::blocks::registry::{AreaRow, RegistryRow, one, small};
use crate::blocks::{Bins, Block, Exercise, named};
use crate::campaign::Campaign;
use crate::formal::refused;
use crate::lockstep::Clock;
use crate::stimuli::Stimuli;

/// The block's row in the registry.
pub(crate) const ROW: RegistryRow = RegistryRow {
    name: "shaper",
    benches: |sizes| Ok(one(ShaperBlock::new(sizes.motion.clone(), &sizes.prefix, "motion")?)),
    small: || {
        let (plain, motion) = (small_config(None)?, small_config(Some(3))?);
        let mut blocks = small(ShaperBlock::new(plain, "", "alone")?, "24 bits, 5 taps");
        blocks.extend(small(ShaperBlock::new(motion, "", "alone")?, "the same for motion"));
        Ok(blocks)
    },
    proofs: proofs::tasks,
    areas: || {
        let (plain, motion) = (area_config()?, area_config()?.for_motion(MOTION).map_err(refused)?);
        Ok(vec![
            AreaRow::new("plain, 32 bits, ring 128", emit(&plain, "")?),
            AreaRow::new("motion, 3 channels, 32 bits, ring 128", emit(&motion, "")?),
        ])
    },
    trials: trials::all,
    mutants: trials::MUTANTS,
    proof_mutants: trials::PROOF_MUTANTS,
};

/// Position, velocity and acceleration.
pub(crate) const MOTION: ShaperMotion = ShaperMotion {
    channels: 3,
    modulo: false,
};

/// A shaper alone.
#[derive(Debug, Clone)]
pub struct ShaperBlock {
    config: ShaperConfig,
    layout: Layout,
    prefix: String,
    instance: String,
}

impl ShaperBlock {
    /// Creates the shaper `PREFIX_shaper`.
    ///
    /// # Errors
    /// [`Error::Unlike`] if the shaper lacks a port that the stimuli drive.
    pub fn new(config: ShaperConfig, prefix: &str, instance: &str) -> Result<Self, Error> {
        Ok(Self {
            layout: Layout::new(&ports(&config), config.coefficient_fraction())?,
            config,
            prefix: prefix.to_owned(),
            instance: instance.to_owned(),
        })
    }

    /// Returns its configuration.
    pub fn config(&self) -> &ShaperConfig {
        &self.config
    }

    /// Returns the positions of its ports.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    fn as_axis(&self) -> AxisShaperConfig {
        AxisShaperConfig::Taps(self.config.clone())
    }
}

impl Block for ShaperBlock {
    fn name(&self) -> &str {
        "shaper"
    }

    fn instance(&self) -> &str {
        &self.instance
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        emit(&self.config, &self.prefix)
    }

    fn top(&self) -> String {
        posicast_hdl::shaper::name(&self.config, &self.prefix)
    }

    fn model(&self, seed: u64) -> Box<dyn ClockedBlock> {
        Box::new(Shaper::new(&self.config, seed))
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        simulate(&self.config)
    }

    fn simulated_as(&self) -> Option<String> {
        simulated_as(&self.config)
    }

    fn stimuli(&self, cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        Box::new(Campaign::new(&self.layout, &[&self.as_axis()], &[], cycles, seed))
    }

    fn least_clocks(&self) -> u64 {
        Campaign::least_clocks(&self.layout, &[&self.as_axis()])
    }

    fn exercise(&self) -> Option<Box<dyn Exercise + '_>> {
        let shown = ShaperExercise::new(&self.layout, [&self.as_axis()]);
        Some(Box::new(OfInstances {
            shown,
            names: vec![self.instance.clone()],
        }))
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(OfLayout::new(&self.layout, &[&self.as_axis()]))
    }
}

/// Levels that the outputs of the shapers have had, by the names of their rows.
struct OfInstances {
    shown: ShaperExercise,
    names: Vec<String>,
}

impl Exercise for OfInstances {
    fn observe(&mut self, clock: &Clock<'_>) {
        self.shown.observe(clock);
    }

    fn missing(&self) -> Vec<(String, String)> {
        let of_instance = |(name, missing): (&String, Vec<String>)| -> Vec<(String, String)> {
            missing.into_iter().map(|what| (name.clone(), what)).collect()
        };
        self.names
            .iter()
            .zip(self.shown.missing())
            .flat_map(of_instance)
            .collect()
    }
}

/// Cases that only shapers with tables have.
const OF_TABLES: [&str; 5] = ["tap writes", "refused", "taps read back", "swaps requested", "swaps"];

/// Coverage of a shaper: the layout gives the positions of its ports, the configuration the cases that can occur.
struct OfLayout<'a> {
    layout: &'a Layout,
    saturates: bool,
    has_tables: bool,
    hands_over: bool,
    coverage: Coverage,
}

impl<'a> OfLayout<'a> {
    fn new(layout: &'a Layout, configs: &[&AxisShaperConfig]) -> Self {
        let hands_over = |config: &&AxisShaperConfig| config.taps().is_some_and(|taps| taps.motion().is_some());
        Self {
            layout,
            saturates: configs.iter().any(|config| config.saturates()),
            has_tables: layout.axes.iter().any(|axis| axis.tables.is_some()),
            hands_over: configs.iter().any(hands_over),
            coverage: Coverage::default(),
        }
    }
}

impl Bins for OfLayout<'_> {
    fn observe(&mut self, clock: &Clock<'_>) {
        self.coverage.observe(self.layout, clock);
    }

    fn counts(&self) -> Vec<(String, u64)> {
        let mut counts = named(self.coverage.counts());
        counts.retain(|(name, _)| self.saturates || name != "saturated");
        counts.retain(|(name, _)| self.has_tables || !OF_TABLES.contains(&name.as_str()));
        if self.hands_over {
            counts.push(("handovers".to_owned(), self.coverage.handovers));
            counts.push(("handovers over".to_owned(), self.coverage.handovers_over));
        }
        counts
    }
}

/// Three impulses, two of them with two taps each; with rates for `channels` channels.
fn small_config(channels: Option<u32>) -> Result<ShaperConfig, Error> {
    let taps = [(0, 400), (5, 280), (6, 180), (11, 110), (12, 54)];
    let config = ShaperConfig::new(24, tap_table(10, &taps)?).map_err(refused)?;
    match channels {
        None => Ok(config),
        Some(channels) => config.for_motion(ShaperMotion { channels, ..MOTION }).map_err(refused),
    }
}

/// Six taps: ZVD digitised with two taps per impulse, 79 samples long.
pub(crate) fn area_config() -> Result<ShaperConfig, Error> {
    let taps = [(0, 25431), (38, 12000), (39, 18787), (77, 4000), (78, 5317), (79, 1)];
    ShaperConfig::new(32, tap_table(16, &taps)?).map_err(refused)
}

/// Makes taps from delays and coefficients.
pub(crate) fn tap_table(fraction: u32, taps: &[(u32, i32)]) -> Result<TapTable, Error> {
    let taps = taps.iter().map(|&(delay_samples, coefficient)| Tap {
        delay_samples,
        coefficient,
    });
    TapTable::new(fraction, taps.collect()).map_err(refused)
}
