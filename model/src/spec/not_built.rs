//! The blocks that the schema has and that this version builds no hardware for: checked as all others are, then refused.
//!
//! Nothing is kept of them but `[stage]`, which has a type of its own.

use super::Stage;
use super::range::NumberRange;
use super::table::Table;

/// Delays.
const SHORT_S: NumberRange = NumberRange::closed(0.0, 1.0).unit("s");
/// What must be there to divide by.
const POSITIVE: NumberRange = NumberRange::positive(1e12);

/// Checks `[axis.scale]` and `[axis.trace]`, and records each that is there.
pub(super) fn read_axis_blocks(axis: &Table<'_, '_>) {
    if let Some(table) = axis.table("scale") {
        check_scale(&table);
        axis.not_built("scale", "scale", None, "leave the table [axis.scale] out");
    }
    if let Some(table) = axis.table("trace") {
        check_trace(&table);
        axis.not_built("trace", "trace", None, "leave the table [axis.trace] out");
    }
}

/// Reads `[stage]`, and records it.
pub(super) fn read_stage(root: &Table<'_, '_>, table: &Table<'_, '_>) -> Option<Stage> {
    table.allow(&["extra_delay_s", "contour_speed"]);
    root.not_built("stage", "stage", None, "leave the table [stage] out");
    Some(Stage {
        extra_delay_s: table.number("extra_delay_s", SHORT_S).unwrap_or(0.0),
        contour_speed: table.number("contour_speed", POSITIVE),
    })
}

fn check_scale(table: &Table<'_, '_>) {
    table.allow(&["counts_per_unit", "use"]);
    table.required_number("counts_per_unit", POSITIVE);
    table.choice("use", &["monitor", "position"]);
}

fn check_trace(table: &Table<'_, '_>) {
    let sizes = [256, 512, 1024, 2048];
    table.allow(&["samples"]);
    let list = sizes.map(|size| size.to_string()).join(", ");
    table.require("samples", &list);
    if table
        .integer("samples", 1, u32::MAX)
        .is_some_and(|samples| !sizes.contains(&samples))
    {
        table.refuse("samples", list, "choose one of the list");
    }
}
