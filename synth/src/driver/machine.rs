//! Writes the machine's tap tables, limits and controllers in C.

use super::{AxisData, DriverFile, StageDriver, family, file};
use posicast_blocks::segments::{ACCELERATION_BITS, FRACTION_BITS, VELOCITY_BITS};
use posicast_blocks::sliding_mode::{SettingRow, Settings};
use posicast_blocks::stage::StageAxis;
use std::fmt::Write;

/// Writes `machine_NAME.h` and `machine_NAME.c`.
pub(super) fn files(driver: &StageDriver<'_>) -> Vec<DriverFile> {
    let name = driver.machine;
    vec![
        file(&format!("inc/machine_{name}.h"), header(driver)),
        file(&format!("src/machine_{name}.c"), source(driver)),
    ]
}

fn header(driver: &StageDriver<'_>) -> String {
    let name = driver.machine;
    let upper = name.to_uppercase();
    let mut text = format!(
        "/* Data of {name} from its machine file. Written by posicast. */\n#ifndef MACHINE_{upper}_H\n#define \
        MACHINE_{upper}_H\n\n\
         #include \"{}\"\n\n/* Axes, as the driver counts them. */\n",
        if driver.families.is_empty() {
            "posicast_machine.h"
        } else {
            "posicast_family.h"
        }
    );
    for (index, axis) in driver.config.axes.iter().enumerate() {
        let _ = writeln!(
            text,
            "#define MACHINE_{upper}_AXIS_{} {index}u",
            axis.name.to_uppercase()
        );
    }
    let families = family::declarations(driver);
    let _ = write!(
        text,
        "\nextern const posicast_machine machine_{name};\n{families}\n#endif\n"
    );
    text
}

fn source(driver: &StageDriver<'_>) -> String {
    let name = driver.machine;
    let mut text = format!(
        "/* Tap tables, limits and controllers of {name}. Written by posicast. */\n#include \"machine_{name}.h\"\n"
    );
    for axis in &driver.config.axes {
        family::taps(&mut text, &format!("taps_of_{}", axis.name), axis.shaper.table());
    }
    text.push_str("\nstatic const posicast_axis_machine axes[] = {\n");
    for (axis, data) in driver.config.axes.iter().zip(driver.axes) {
        write_axis(&mut text, axis, data);
    }
    let _ = write!(
        text,
        "}};\n\nconst posicast_machine machine_{name} = {{\n    \"{name}\",\n    {:?}, /* ticks per second */\n    {}, /* axes */\n    axes,\n}};\n",
        driver.tick_hz,
        driver.config.axes.len(),
    );
    text + &family::definitions(driver)
}

fn write_axis(text: &mut String, axis: &StageAxis, data: &AxisData) {
    let limits = &data.limits;
    let _ = write!(
        text,
        "    {{\n        \"{name}\",\n        {counts:?}, /* counts per {unit} */\n        \
         /* velocity, acceleration, jerk: counts per tick, tick^2, tick^3, in LSB of 2^-32 */\n        \
         {{INT64_C({velocity}), INT64_C({acceleration}), INT64_C({jerk})}},\n        \
         {{taps_of_{name}, {taps}, {fraction}}},\n        {{{law}u, {{\n{words}        }}}},\n    }},\n",
        name = axis.name,
        counts = data.counts_per_unit,
        unit = data.unit.name(),
        velocity = lsb(limits.velocity, VELOCITY_BITS),
        acceleration = lsb(limits.acceleration, ACCELERATION_BITS),
        jerk = lsb(limits.jerk, ACCELERATION_BITS),
        taps = axis.shaper.table().taps().len(),
        fraction = axis.shaper.coefficient_fraction(),
        law = axis.closed_loop().map_or(0, |of| of.law as u32),
        words = words(&axis.closed_loop().map_or_else(Settings::default, |of| of.settings)),
    );
}

/// A line for each row.
fn words(settings: &Settings) -> String {
    let line = |row: SettingRow| format!("            {:#x}u, /* {row:?} */\n", settings.word(row as usize));
    SettingRow::ALL.map(line).concat()
}

/// A limit in LSB of the integrator: truncated, so that no move is faster, at least 1, and at most what the word
/// holds.
fn lsb(limit: f64, bits: u32) -> i64 {
    let largest = (1i64 << (bits - 1)) - 1;
    let scaled = limit * (1u64 << FRACTION_BITS) as f64;
    // A cast of a number that is too large gives the largest.
    (scaled as i64).clamp(1, largest)
}
