//! Figures that the file gives in the unit of its axis, read in m or rad.

use super::range::NumberRange;
use super::table::Table;
use crate::unit::AxisUnit;

impl Table<'_, '_> {
    /// Reads a length or angle of the axis, or a velocity, acceleration or jerk, in m or rad. The range is in these;
    /// the file's number is in the axis's unit.
    pub(super) fn quantity(&self, key: &str, range: NumberRange, unit: AxisUnit) -> Option<f64> {
        let found = self.number(key, range.times(unit.per_si()))?;
        Some(unit.to_si(found))
    }

    /// Reads counts per m or rad, from the file's counts per unit of the axis; the key is required.
    pub(super) fn required_counts(&self, key: &str, range: NumberRange, unit: AxisUnit) -> Option<f64> {
        let found = self.required_number(key, range.times(1.0 / unit.per_si()))?;
        Some(found * unit.per_si())
    }
}
