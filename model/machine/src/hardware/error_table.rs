//! The error table of an axis: the measured points on the places that the hardware has.

use crate::machine_file::{AxisSection, ErrorTableSection, ErrorUse};
use posicast_blocks::error_table::{
    EntryUnit, ErrorTableConfig, ErrorTableConfigError, ErrorTableFormat, LARGEST_ENTRY, LEAST_SPACING_BITS,
    MOST_ENTRIES, MOST_SPACING_BITS,
};
use posicast_blocks::stage::StageErrorTable;

/// Creates the axis's table, if it has one. The entries are as few counts apart as 256 entries allow, in the finest unit
/// that holds them.
///
/// # Errors
/// [`ErrorTableConfigError`] if the entries do not fit. Entries that the reader of the machine file accepts do fit.
pub(super) fn of_axis(axis: &AxisSection) -> Result<Option<StageErrorTable>, ErrorTableConfigError> {
    let Some(section) = &axis.error_table else {
        return Ok(None);
    };
    let (places, unit) = (Places::of(section, axis.loop_counts_per_unit()), unit(section, axis));
    let format = ErrorTableFormat {
        first_counts: places.first as i32,
        spacing_bits: places.spacing_bits,
        unit,
    };
    let counts = axis.loop_counts_per_unit();
    let entry = |index: usize| {
        let position = (places.first + (index << places.spacing_bits) as f64) / counts;
        (section.at(position) * counts / unit.counts()).round() as i32
    };
    Ok(Some(StageErrorTable {
        table: ErrorTableConfig::new(format, (0..places.entries).map(entry).collect())?,
        on_measured: section.apply == ErrorUse::Feedback,
    }))
}

/// Where the entries are.
struct Places {
    /// Counts of the first.
    first: f64,
    spacing_bits: u32,
    entries: usize,
}

impl Places {
    fn of(section: &ErrorTableSection, counts: f64) -> Self {
        let end = |point: Option<&(f64, f64)>| point.map_or(0.0, |(position, _)| position * counts);
        let first = end(section.points.first()).floor();
        let span = end(section.points.last()) - first;
        let intervals = |bits: u32| (span / f64::from(1u32 << bits)).ceil().max(1.0) as usize;
        let fits = (LEAST_SPACING_BITS..MOST_SPACING_BITS).find(|bits| intervals(*bits) < MOST_ENTRIES);
        let spacing_bits = fits.unwrap_or(MOST_SPACING_BITS);
        Self {
            first,
            spacing_bits,
            entries: intervals(spacing_bits) + 1,
        }
    }
}

/// The finer unit, if it holds all errors.
fn unit(section: &ErrorTableSection, axis: &AxisSection) -> EntryUnit {
    let errors = section.points.iter().map(|(_, error)| error.abs());
    let largest = errors.fold(0.0, f64::max) * axis.loop_counts_per_unit();
    if largest <= f64::from(LARGEST_ENTRY) * EntryUnit::Fine.counts() {
        EntryUnit::Fine
    } else {
        EntryUnit::Coarse
    }
}

/// Returns the largest difference in counts between a table and the points that it was made from. At its entries the difference is
/// only their rounding.
pub fn departure_counts(axis: &AxisSection, table: &ErrorTableConfig) -> f64 {
    let (format, counts) = (table.format(), axis.loop_counts_per_unit());
    let Some(section) = &axis.error_table else {
        return 0.0;
    };
    let of_table = |position: f64| {
        let place = (position * counts - f64::from(format.first_counts)) / f64::from(1u32 << format.spacing_bits);
        let (index, last) = (place.floor().max(0.0) as usize, table.entries().len() - 1);
        let entry = |index: usize| f64::from(table.entries()[index.min(last)]);
        let share = (place - index as f64).clamp(0.0, 1.0);
        (entry(index) + (entry(index + 1) - entry(index)) * share) * format.unit.counts()
    };
    let departures = section
        .points
        .iter()
        .map(|(position, error)| (of_table(*position) - error * counts).abs());
    departures.fold(0.0, f64::max)
}
