//! The bench of `shaper`: one shaper alone, or all shapers of a machine in its top module.

pub(crate) mod proofs;
pub(crate) mod stimuli;
mod trials;

pub use self::stimuli::{
    Action, AxisLayout, Coverage, Directed, Fill, Layout, MotionStimuli, Random, ShaperExercise, cases, corners,
    motion_cases,
};
use posicast_blocks::shaper::{Shaper, ShaperConfig, ShaperMotion, ports};
use posicast_blocks::{ClockedBlock, Port};
use posicast_hdl::SimulationError;
use posicast_hdl::emit::{EmitError, Module};
use posicast_hdl::machine::{AxisShaper, emit_machine};
use posicast_hdl::shaper::{emit, simulate, simulated_as};
use posicast_taps::{Tap, TapTable};

use crate::Error;
use crate::blocks::reached::AtThePorts;
use crate::blocks::registry::{AreaRow, RegistryRow, one, small};
use crate::blocks::{Bins, Block, Exercise, Reach, ReachedCount, named};
use crate::campaign::Campaign;
use crate::formal::refused;
use crate::lockstep::{Clock, Instance, SideBySide};
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
        Box::new(Campaign::new(&self.layout, &[&self.config], &[], cycles, seed))
    }

    fn least_clocks(&self) -> u64 {
        Campaign::least_clocks(&self.layout, &[&self.config])
    }

    fn exercise(&self) -> Option<Box<dyn Exercise + '_>> {
        let shown = ShaperExercise::new(&self.layout, [&self.config]);
        Some(Box::new(OfInstances {
            shown,
            names: vec![self.instance.clone()],
        }))
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(OfLayout::new(&self.layout, [&self.config]))
    }
}

/// The shapers of a machine in its top module, one per axis.
#[derive(Debug, Clone)]
pub struct MachineShapers {
    machine: String,
    shapers: Vec<AxisShaper>,
    layout: Layout,
    words: Vec<Vec<i64>>,
}

impl MachineShapers {
    /// Creates the top module of the machine of this name. `words` is a move that the stimuli include, as command words
    /// per axis; it may be empty.
    ///
    /// # Errors
    /// [`Error::Unlike`] if there is no shaper.
    pub fn new(machine: &str, shapers: Vec<AxisShaper>, words: Vec<Vec<i64>>) -> Result<Self, Error> {
        let fraction = shapers.first().map_or(1, |s| s.config.coefficient_fraction());
        Ok(Self {
            layout: Layout::new(joined(&shapers, 0).ports(), fraction)?,
            machine: machine.to_owned(),
            shapers,
            words,
        })
    }

    /// Returns the shapers, axis by axis.
    pub fn shapers(&self) -> &[AxisShaper] {
        &self.shapers
    }

    /// Returns the positions of the ports.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Returns the move that the stimuli include.
    pub fn words(&self) -> &[Vec<i64>] {
        &self.words
    }

    fn configs(&self) -> Vec<&ShaperConfig> {
        self.shapers.iter().map(|shaper| &shaper.config).collect()
    }

    /// Returns the number of clocks of the longest pass of all axes.
    pub fn pass_clocks(&self) -> u32 {
        let passes = self
            .shapers
            .iter()
            .map(|s| s.config.pass_clocks(s.config.most_products()));
        passes.max().unwrap_or(0)
    }
}

impl Block for MachineShapers {
    fn name(&self) -> &str {
        "shaper"
    }

    fn instance(&self) -> &str {
        &self.machine
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        emit_machine(&self.machine, &self.shapers)
    }

    fn top(&self) -> String {
        self.machine.clone()
    }

    fn model(&self, seed: u64) -> Box<dyn ClockedBlock> {
        Box::new(joined(&self.shapers, seed))
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        let block = |s: &AxisShaper| Ok((s.axis.clone(), simulate(&s.config)?));
        let blocks = self.shapers.iter().map(block).collect::<Result<_, _>>()?;
        Ok(Box::new(SideBySide::new(blocks)))
    }

    fn simulated_as(&self) -> Option<String> {
        let of_axis = |s: &AxisShaper| Some(format!("{}: {}", s.axis, simulated_as(&s.config)?));
        let sizes: Vec<_> = self.shapers.iter().filter_map(of_axis).collect();
        (!sizes.is_empty()).then(|| sizes.join("; "))
    }

    fn stimuli(&self, cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        Box::new(Campaign::new(&self.layout, &self.configs(), &self.words, cycles, seed))
    }

    fn least_clocks(&self) -> u64 {
        Campaign::least_clocks(&self.layout, &self.configs())
    }

    fn exercise(&self) -> Option<Box<dyn Exercise + '_>> {
        let shown = ShaperExercise::new(&self.layout, self.configs());
        let names = self.shapers.iter().map(|shaper| shaper.axis.clone()).collect();
        Some(Box::new(OfInstances { shown, names }))
    }

    fn reach(&self) -> Box<dyn Reach + '_> {
        Box::new(SideBySideReach::new(&self.shapers))
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(OfLayout::new(&self.layout, self.shapers.iter().map(|s| &s.config)))
    }

    fn instances(&self, _ports: &[Port]) -> Vec<Instance> {
        joined(&self.shapers, 0).instances(self.name())
    }
}

/// Counts at the ports of each shaper.
struct SideBySideReach(Vec<AtThePorts>);

impl SideBySideReach {
    fn new(shapers: &[AxisShaper]) -> Self {
        let joined = joined(shapers, 0);
        let of = |shaper: &AxisShaper| {
            let prefix = format!("{}_", shaper.axis);
            AtThePorts::new(&shaper.axis, &prefix, joined.ports(), None)
        };
        Self(shapers.iter().map(of).collect())
    }
}

impl Reach for SideBySideReach {
    fn observe(&mut self, clock: &Clock<'_>) {
        self.0.iter_mut().for_each(|shaper| shaper.observe(clock));
    }

    fn reached(&self) -> Vec<(String, ReachedCount)> {
        self.0.iter().flat_map(AtThePorts::reached).collect()
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

fn joined(shapers: &[AxisShaper], seed: u64) -> SideBySide {
    let block = |(index, s): (usize, &AxisShaper)| {
        // The initial contents of each memory differ, because nothing may depend on them.
        let block: Box<dyn ClockedBlock> = Box::new(Shaper::new(&s.config, seed.wrapping_add(index as u64)));
        (s.axis.clone(), block)
    };
    SideBySide::new(shapers.iter().enumerate().map(block).collect())
}

/// Coverage of a shaper: the layout gives the positions of its ports, the configuration the cases that can occur.
struct OfLayout<'a> {
    layout: &'a Layout,
    saturates: bool,
    hands_over: bool,
    coverage: Coverage,
}

impl<'a> OfLayout<'a> {
    fn new(layout: &'a Layout, configs: impl IntoIterator<Item = &'a ShaperConfig>) -> Self {
        let motions: Vec<_> = configs.into_iter().map(ShaperConfig::motion).collect();
        // A position that wraps around never saturates.
        let wraps = |motion: &Option<ShaperMotion>| motion.is_some_and(|motion| motion.modulo && motion.channels == 1);
        Self {
            layout,
            saturates: !motions.iter().all(wraps),
            hands_over: motions.iter().any(Option::is_some),
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
