//! A case: a fault at a random clock of a move; everything derives from one seed.

use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::expectation::{Hit, Lasts};
use super::kind::FaultRow;

/// Largest distance of a move in counts; the smallest is half of it.
const MOST_COUNTS: i64 = 300;
/// One in this many faults of an axis hits both axes.
const BOTH_ONE_IN: u32 = 8;

/// A fault during a move of both axes.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    /// Number of the case in the campaign.
    pub number: u64,
    /// Kind of the fault, with its expectation.
    pub row: FaultRow,
    /// Axes that are hit, a bit each.
    pub axes: u32,
    /// Distance of the move of each axis in counts.
    pub counts: [i64; 2],
    /// Time of the fault, in ten thousandths of the move.
    pub when: u64,
    /// Clock within that tick.
    pub clock_of_tick: u64,
    /// Duration in clocks; `None`: until the axes have stopped.
    pub lasts: Option<u64>,
    /// The word `off_causes`, with the reaction to each cause.
    pub off_causes: u16,
    /// Random choice for what a kind leaves open: a level, a line, a value.
    pub choice: u32,
}

impl Case {
    /// The case with this number; the kinds of `rows`, which has at least one, alternate.
    pub fn new(rows: &[FaultRow], number: u64, seed: u64) -> Self {
        let row = rows[(number % rows.len() as u64) as usize];
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed ^ number.wrapping_mul(0x9e37_79b9_7f4a_7c15));
        let expects = &row.expects;
        let size = rng.random_range(MOST_COUNTS / 2..=MOST_COUNTS);
        // Both moves take the same time, so that a group stop finds the other axis in motion.
        let counts = [0, 1].map(|_| if rng.random::<bool>() { size } else { -size });
        let axes = match expects.hit {
            Hit::Stage => 3,
            Hit::Axis if rng.random_range(0..BOTH_ONE_IN) == 0 => 3,
            Hit::Axis => rng.random_range(1..=2),
        };
        let [from, to] = expects.within_percent.map(|percent| percent * 100);
        let lasts = match expects.lasts {
            Lasts::Held => None,
            Lasts::Clocks(least, most) => Some(rng.random_range(least..=most)),
            Lasts::HeldOrClocks(least, most) => rng.random::<bool>().then(|| rng.random_range(least..=most)),
        };
        Self {
            number,
            row,
            axes,
            counts,
            when: rng.random_range(from..=to),
            clock_of_tick: rng.random_range(0..super::machine::TICK_CLOCKS),
            lasts,
            off_causes: match rng.random_range(0..3) {
                0 => 0,
                1 => u16::MAX,
                _ => rng.random(),
            },
            choice: rng.random(),
        }
    }

    /// Whether the fault hits this axis.
    pub fn hits(&self, axis: usize) -> bool {
        self.axes >> axis & 1 != 0
    }

    /// The axes that are hit.
    pub fn hit_axes(&self) -> impl Iterator<Item = usize> + use<> {
        let axes = self.axes;
        (0..2).filter(move |axis| axes >> axis & 1 != 0)
    }
}
