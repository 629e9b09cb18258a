//! The bench of a machine's top module: the shapers of all axes side by side.

use posicast_blocks::axis_shaper::AxisShaperConfig;
use posicast_blocks::shaper::ShaperConfig;
use posicast_blocks::{ClockedBlock, Port};
use posicast_hdl::SimulationError;
use posicast_hdl::emit::{EmitError, Module};
use posicast_hdl::machine::{AxisShaper, emit_machine};

use super::{Layout, OfInstances, OfLayout, ShaperExercise};
use crate::Error;
use crate::blocks::reached::AtThePorts;
use crate::blocks::{Bins, Block, Exercise, Reach, ReachedCount};
use crate::campaign::{Campaign, longest_pass_clocks};
use crate::lockstep::{Clock, Instance, SideBySide};
use crate::stimuli::Stimuli;

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
        let mut taps = shapers.iter().filter_map(|shaper| shaper.config.taps());
        let fraction = taps.next().map_or(1, ShaperConfig::coefficient_fraction);
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

    fn configs(&self) -> Vec<&AxisShaperConfig> {
        self.shapers.iter().map(|shaper| &shaper.config).collect()
    }

    /// Returns the number of clocks of the longest pass of all axes.
    pub fn pass_clocks(&self) -> u32 {
        longest_pass_clocks(&self.configs())
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
        let block = |shaper: &AxisShaper| Ok((shaper.axis.clone(), shaper.simulate()?));
        let blocks = self.shapers.iter().map(block).collect::<Result<_, _>>()?;
        Ok(Box::new(SideBySide::new(blocks)))
    }

    fn simulated_as(&self) -> Option<String> {
        let of_axis = |shaper: &AxisShaper| Some(format!("{}: {}", shaper.axis, shaper.simulated_as()?));
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
        Box::new(OfLayout::new(&self.layout, &self.configs()))
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

fn joined(shapers: &[AxisShaper], seed: u64) -> SideBySide {
    let block = |(index, s): (usize, &AxisShaper)| {
        // The initial contents of each memory differ, because nothing may depend on them.
        let block = s.config.model(seed.wrapping_add(index as u64));
        (s.axis.clone(), block)
    };
    SideBySide::new(shapers.iter().enumerate().map(block).collect())
}
