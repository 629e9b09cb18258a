//! Effect of an error table: the distance of the resting load from its target, with and without the table.

use posicast_blocks::stage::StageAxis;
use posicast_machine::hardware::error_table_departure_counts;
use posicast_machine::machine_file::{AxisSection, ErrorTableSection, ErrorUse};

use super::{Expected, Moved};

/// A move exercises a table if, without the table, the load comes to rest at least this many times as far from its
/// target as is allowed with it.
const EXERCISED: f64 = 1.5;

/// Rest positions of the load of an axis with an error table, after its move. Lengths are in m or rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Compensated {
    /// Distance from the target without the table, with its sign.
    pub without: f64,
    /// Distance from the target with the table, with its sign.
    pub with: f64,
    /// Largest allowed distance with the table.
    pub allowed: f64,
}

impl Compensated {
    /// Returns the figures of the axis with index `place`; `None` if it has no error table, or one of the moves was not made.
    ///
    /// `with` and `without` are the same move with the table and without it.
    pub fn of_axis(
        axis: &AxisSection,
        built: &StageAxis,
        place: usize,
        [with, without]: [&Moved; 2],
        expected: &Expected,
    ) -> Option<Self> {
        let (section, table) = (axis.error_table.as_ref()?, built.error_table.as_ref()?);
        let departure = error_table_departure_counts(axis, &table.table) / axis.loop_counts_per_unit();
        Some(Self {
            without: without.axes.get(place)?.offset,
            with: with.axes.get(place)?.offset,
            // The loop rests within half a count of its target, and the compensated target is rounded.
            allowed: expected.count + expected.friction + departure + error_of_place(section),
        })
    }

    /// Whether the load rests within the allowed distance.
    pub fn holds(&self) -> bool {
        self.with.abs() <= self.allowed
    }

    /// Whether the move exercises the table.
    pub fn is_exercised(&self) -> bool {
        self.without.abs() >= EXERCISED * self.allowed
    }
}

/// Returns the largest error that remains because the table is read at the reference, which is the true position, but
/// was measured over the counted position: error times slope.
fn error_of_place(section: &ErrorTableSection) -> f64 {
    if section.apply == ErrorUse::Feedback {
        return 0.0;
    }
    let largest = section.points.iter().map(|(_, error)| error.abs()).fold(0.0, f64::max);
    let slopes = section.points.windows(2).map(|pair| {
        let [(low, from), (high, to)] = [pair[0], pair[1]];
        ((to - from) / (high - low)).abs()
    });
    largest * slopes.fold(0.0, f64::max)
}
