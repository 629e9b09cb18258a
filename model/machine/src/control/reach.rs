//! Range of the position word.
//!
//! Commands are Q24.8 counts, and 0 is where the axis stands at reset, because an encoder that only counts knows no
//! other origin. So either end of the travel may be a whole travel away from 0. The shaped command goes further by
//! the shaper's overshoot, and by a quick stop that begins at the end.

use super::supervision_error::SupervisionError;
use crate::machine_file::AxisSection;
use crate::plan::TableFamily;
use crate::unit::AxisUnit;
use posicast_blocks::segments::REACH_COUNTS;
use posicast_taps::TapTable;

/// Bounds of a shaper's table that determine the words of a supervisor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TableBounds {
    /// Longest delay of the table, in samples.
    pub longest_delay_samples: u32,
    /// Largest distance that a unit step covers: above 1 where it overshoots, or where it first moves the other way.
    pub farthest: f64,
}

impl From<&TapTable> for TableBounds {
    fn from(table: &TapTable) -> Self {
        let unit = f64::from(table.coefficient_fraction()).exp2();
        let sums = table.taps().iter().scan(0, |sum, tap| {
            *sum += i64::from(tap.coefficient);
            Some(*sum)
        });
        let farthest = sums.map(|sum| sum.max((unit as i64) - sum)).max().unwrap_or(0);
        Self {
            longest_delay_samples: table.longest_delay_samples(),
            farthest: (farthest as f64 / unit).max(1.0),
        }
    }
}

impl TableBounds {
    /// The bounds that hold for every table of an axis: its own, and those of its family.
    pub fn of_axis(own: &TapTable, family: Option<&TableFamily>) -> Self {
        let members = family.iter().flat_map(|family| &family.members);
        let members = members.map(|member| Self::from(&member.tables.table));
        members.fold(Self::from(own), |all, one| Self {
            longest_delay_samples: all.longest_delay_samples.max(one.longest_delay_samples),
            farthest: all.farthest.max(one.farthest),
        })
    }
}

/// An axis whose file does not state its travel, with the end of the position word that it may reach.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "no travel in [axis.limits]: the position word reaches {} to either side of where the axis stands at reset; a command beyond that \
     stops before its end (cause segments), and a count beyond it switches the axis off (cause range): give travel",
    .unit.as_in_file(*.reach, "")
)]
pub struct NoTravel {
    /// Unit of the axis.
    pub unit: AxisUnit,
    /// Range of the word to either side, in m or rad.
    pub reach: f64,
}

/// Returns a warning where neither `travel` bounds the axis nor `modulo` lets its position wrap.
pub fn no_travel(axis: &AxisSection) -> Option<NoTravel> {
    let bounded = axis.modulo || axis.limits.is_some_and(|limits| limits.travel.is_some());
    (!bounded).then(|| NoTravel {
        unit: axis.unit,
        reach: reach(axis),
    })
}

/// Range of the command to either side of where the axis stands at reset.
fn reach(axis: &AxisSection) -> f64 {
    f64::from(REACH_COUNTS) / axis.loop_counts_per_unit()
}

/// Checks that the travel fits the position word, wherever in it the axis stands at reset.
///
/// # Errors
/// [`SupervisionError::Reach`] with the range that is needed and the range of the word.
pub(super) fn check_travel(axis: &AxisSection, table: &TableBounds) -> Result<(), SupervisionError> {
    let limits = axis.limits.unwrap_or_default();
    let Some([low, high]) = limits.travel.filter(|_| !axis.modulo) else {
        return Ok(());
    };
    let deceleration = limits.stop_deceleration.or(limits.acceleration);
    let key = match limits.stop_deceleration {
        Some(_) => "axis.limits.stop_deceleration",
        None => "axis.limits.acceleration",
    };
    let stop = match (limits.velocity, deceleration) {
        (Some(velocity), Some(deceleration)) => velocity * velocity / (2.0 * deceleration),
        _ => 0.0,
    };
    let shaped = (high - low) * table.farthest;
    let reach = reach(axis);
    if shaped + stop <= reach {
        return Ok(());
    }
    Err(SupervisionError::Reach {
        axis: axis.name.clone(),
        unit: axis.unit,
        low,
        high,
        shaped,
        stop,
        deceleration: key,
        reach,
        counts_per_unit: axis.loop_counts_per_file_unit(),
    })
}
