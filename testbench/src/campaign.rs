//! The stimuli of a machine's lock step: the delay lines are filled, then come every directed case and a real move,
//! then random stimuli to the end.
//!
//! ```text
//! | noise, a sample per pass | directed case 1 | … | corner case n | real move | random, seeded …        |
//! |◄──────────────── [`Campaign::least_clocks`] ──►|
//! ```
//!
//! It is one run, so that each phase begins in the state that the one before has left: the noise, every directed case
//! and the move begin with a reset, the random stimuli do not. What slow simulators must reach comes first.

use std::collections::VecDeque;

use posicast_blocks::axis_shaper::AxisShaperConfig;

use crate::shaper::{Action, Directed, Fill, Layout, MotionStimuli, Random, cases, corners, motion_cases};
use crate::stimuli::Stimuli;

/// Idle clocks between the move's samples.
const IDLE_CLOCKS: u64 = 5;

/// The phases, one after the other.
pub struct Campaign<'a> {
    phases: VecDeque<Phase<'a>>,
    last: Random,
}

struct Phase<'a> {
    stimuli: Box<dyn Stimuli + 'a>,
    clocks: u64,
}

impl<'a> Campaign<'a> {
    /// The campaign for the shapers of `layout`, built with `configs`. `words` has the move as command words per
    /// axis; without words the move is left out. The move gets at most a quarter of `cycles`, so that a long move
    /// leaves room for the random stimuli.
    pub fn new(layout: &Layout, configs: &[&AxisShaperConfig], words: &'a [Vec<i64>], cycles: u64, seed: u64) -> Self {
        let pass_clocks = longest_pass_clocks(configs);
        let mut phases = VecDeque::from([Phase {
            stimuli: Box::new(Fill::new(layout, seed)),
            clocks: fill_clocks(configs),
        }]);
        // A corner case is for the sizes of one axis; for the others it is one more script.
        let tables = layout.axes.iter().filter_map(|axis| axis.tables.as_ref());
        let corner_cases = tables.flat_map(corners);
        for (_, script) in directed(layout).into_iter().chain(corner_cases) {
            let directed = Directed::new(layout, script);
            let clocks = directed.clocks(pass_clocks);
            phases.push_back(Phase {
                stimuli: Box::new(directed),
                clocks,
            });
        }
        if words.iter().any(|w| !w.is_empty()) {
            let motion = MotionStimuli::new(layout, words, u64::from(pass_clocks) + IDLE_CLOCKS);
            let clocks = motion.clocks().min(cycles / 4);
            phases.push_back(Phase {
                stimuli: Box::new(motion),
                clocks,
            });
        }
        Self {
            phases,
            last: Random::new(layout, seed),
        }
    }

    /// Number of clocks after which the delay lines were full, every tap was exercised, and every directed case is
    /// over.
    pub fn least_clocks(layout: &Layout, configs: &[&AxisShaperConfig]) -> u64 {
        let pass_clocks = longest_pass_clocks(configs);
        let cases = directed(layout).into_iter();
        let cases = cases.map(|(_, script)| Directed::new(layout, script).clocks(pass_clocks));
        fill_clocks(configs) + cases.sum::<u64>()
    }
}

/// Clocks of the longest pass, which is a handover over two tables.
pub(crate) fn longest_pass_clocks(configs: &[&AxisShaperConfig]) -> u32 {
    let passes = configs.iter().map(|config| config.most_pass_clocks());
    passes.max().unwrap_or(0)
}

/// Clocks of the phase that fills the delay lines, in which only the machine's tables are in use.
fn fill_clocks(configs: &[&AxisShaperConfig]) -> u64 {
    let pass = configs.iter().map(|config| config.pass_clocks()).max();
    let longest = configs.iter().map(|config| config.longest_delay_samples()).max();
    Fill::clocks(longest.unwrap_or(0), pass.unwrap_or(0))
}

/// The directed cases for the shapers of the layout.
fn directed(layout: &Layout) -> Vec<(&'static str, Vec<Action>)> {
    let mut tables = layout.axes.iter().filter_map(|axis| axis.tables.as_ref());
    let in_motion = tables.any(|tables| tables.swap_how.is_some());
    let mut all = cases();
    all.extend(in_motion.then(motion_cases).into_iter().flatten());
    all
}

impl Stimuli for Campaign<'_> {
    fn fill(&mut self, seen: &[u64], inputs: &mut [u64]) {
        while self.phases.front().is_some_and(|phase| phase.clocks == 0) {
            self.phases.pop_front();
        }
        match self.phases.front_mut() {
            Some(phase) => {
                phase.clocks -= 1;
                phase.stimuli.fill(seen, inputs);
            }
            None => self.last.fill(seen, inputs),
        }
    }
}
