//! The stimuli that a machine's lock step goes through: every directed case, a real move, then random to the end.
//!
//! ```text
//! | directed case 1 | … | corner case n   | real move, strobes one pass apart and more | random, seeded …        |
//! ```
//!
//! One run, so that each phase begins in whatever state the one before has left: every directed case and the move begin
//! with a reset, the random stimuli do not. A short run sees only the first phases; the report's clock counts tell.

use std::collections::VecDeque;

use crate::stimuli::{Directed, Layout, Motion, Random, Stimuli, cases, corners, motion_cases};

/// Clocks between the strobes of the move beyond a pass: idle clocks, a handful.
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
    /// The campaign for the shapers of `layout`, whose passes take at most `pass_clocks`. `words` is the move: command
    /// words per axis; none, and the move is left out. The move gets at most a quarter of `cycles`, so that a long move
    /// does not crowd out the random stimuli.
    pub fn new(layout: &Layout, pass_clocks: u32, words: &'a [Vec<i64>], cycles: u64, seed: u64) -> Self {
        let mut phases = VecDeque::new();
        // A corner belongs to one axis's sizes; on the others it is one more script.
        let corner_cases = layout.axes.iter().flat_map(corners);
        let in_motion = layout.axes.iter().any(|axis| axis.swap_how.is_some());
        let motion_cases = in_motion.then(motion_cases).into_iter().flatten();
        for (_, script) in cases().into_iter().chain(motion_cases).chain(corner_cases) {
            let directed = Directed::new(layout, script);
            let clocks = directed.clocks(pass_clocks);
            phases.push_back(Phase {
                stimuli: Box::new(directed),
                clocks,
            });
        }
        if words.iter().any(|w| !w.is_empty()) {
            let motion = Motion::new(layout, words, u64::from(pass_clocks) + IDLE_CLOCKS);
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
