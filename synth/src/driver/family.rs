//! The table families of axes whose modes move, in C.

use super::StageDriver;
use posicast_machine::machine_file::Machine;
use posicast_machine::plan::TableFamily;
use posicast_taps::TapTable;
use std::fmt::Write;

/// The table family of an axis whose modes move.
#[derive(Debug, Clone, Copy)]
pub struct AxisFamily<'a> {
    /// Name of the axis.
    axis: &'a str,
    /// Name of the variable with which the modes move.
    variable: &'a str,
    /// Values of the machine file per value of the design: for a position its units per m or rad, else 1.
    scale: f64,
    tables: &'a TableFamily,
}

impl<'a> AxisFamily<'a> {
    /// The families of a machine.
    pub fn of_machine(machine: &'a Machine, families: &'a [TableFamily]) -> Vec<Self> {
        let families = families.iter().filter_map(|tables| {
            let axis = machine.axes.get(tables.axis)?;
            let family = axis.family.as_ref()?;
            Some(Self {
                axis: &axis.name,
                variable: &family.variable,
                scale: if family.is_position() { axis.unit.per_si() } else { 1.0 },
                tables,
            })
        });
        families.collect()
    }
}

/// Writes a static array with the taps of a table.
pub(super) fn taps(text: &mut String, name: &str, table: &TapTable) {
    let _ = write!(text, "\nstatic const posicast_tap {name}[] = {{\n");
    for tap in table.taps() {
        let _ = writeln!(text, "    {{{}, {}}},", tap.delay_samples, tap.coefficient);
    }
    text.push_str("};\n");
}

/// Declarations of the families.
pub(super) fn declarations(driver: &StageDriver<'_>) -> String {
    let families = driver.families.iter().map(|family| {
        format!(
            "/* Tables of {}, whose modes move with {}. */\nextern const posicast_family {};\n",
            family.axis,
            family.variable,
            name(driver, family)
        )
    });
    families.collect()
}

/// Definitions of the families.
pub(super) fn definitions(driver: &StageDriver<'_>) -> String {
    let mut text = String::new();
    for family in driver.families {
        let of_member = |place: usize| format!("taps_of_{}_{place}", family.axis);
        for (place, member) in family.tables.members.iter().enumerate() {
            taps(&mut text, &of_member(place), &member.tables.table);
        }
        let _ = write!(
            text,
            "\nstatic const posicast_family_member members_of_{}[] = {{\n",
            family.axis
        );
        for (place, member) in family.tables.members.iter().enumerate() {
            let table = &member.tables.table;
            // C has no literal for an infinite end, so the largest number stands for it.
            let [value, down, up] =
                [member.value, member.down, member.up].map(|value| (value * family.scale).clamp(f64::MIN, f64::MAX));
            let _ = writeln!(
                text,
                "    {{{value:?}, {down:?}, {up:?}, {{{}, {}, {}}}}},",
                of_member(place),
                table.taps().len(),
                table.coefficient_fraction()
            );
        }
        let _ = write!(
            text,
            "}};\n\nconst posicast_family {} = {{\"{}\", {}, {}, members_of_{}}};\n",
            name(driver, family),
            family.variable,
            family.tables.nominal,
            family.tables.members.len(),
            family.axis
        );
    }
    text
}

fn name(driver: &StageDriver<'_>, family: &AxisFamily<'_>) -> String {
    format!("machine_{}_family_of_{}", driver.machine, family.axis)
}
