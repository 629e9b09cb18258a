//! Writes the files that LinuxCNC needs to drive a machine, into the output folder:
//!
//! ```text
//! hal/posicast.c, _link, _load, _path    the real-time component, the same for every machine; it is compiled with driver/
//! hal/posicast_hal_machine.h      the machine's scaling and travel
//! hal/Makefile                    builds posicast.so with halcompile's rules
//! hal/NAME.hal, NAME.ini          a configuration to start from
//! hal/NAME.shapers.toml           tap tables at the servo rate, for posicast_shaper: a machine without the FPGA
//! ```
//!
//! A machine without a stage gets the tap tables only. `docs/linuxcnc.md` says how they are used.

mod ini;
mod machine;
mod wiring;

pub use machine::ServoError;

use crate::driver::DriverFile;
use posicast_blocks::shaper_tables::ShaperTables;
use std::fmt::Write;

/// Folder in the output folder.
pub const FOLDER: &str = "hal";

/// Letters of LinuxCNC's linear and rotary axes.
const LINEAR: [char; 6] = ['X', 'Y', 'Z', 'U', 'V', 'W'];
const ROTARY: [char; 3] = ['A', 'B', 'C'];
/// Words of the stage's command in a count.
const COMMAND_LSB: f64 = 256.0;

/// A machine for LinuxCNC.
#[derive(Debug, Clone)]
pub struct HalMachine<'a> {
    /// The machine's name.
    pub name: &'a str,
    /// Rate of the servo thread in Hz; the tick rate is a whole multiple of it.
    pub servo_hz: f64,
    /// The axes, in the order of the machine file.
    pub axes: Vec<HalAxis<'a>>,
    /// Whether there is a stage.
    pub has_stage: bool,
    /// Whether the stage captures positions, for a touch probe.
    pub captures: bool,
    /// The tap tables at the servo rate.
    pub tables: ShaperTables,
}

/// An axis, in LinuxCNC's units: mm, or degrees if it is rotary.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalAxis<'a> {
    /// Its name in the machine file.
    pub name: &'a str,
    /// Whether it turns.
    pub rotary: bool,
    /// Counts of its loop per mm or degree.
    pub counts_per_unit: f64,
    /// Largest velocity, per s.
    pub velocity: f64,
    /// Largest acceleration, per s².
    pub acceleration: f64,
    /// Lowest and highest position, if the machine file has them.
    pub travel: Option<[f64; 2]>,
    /// Largest following error of the stage's own check, if it has one.
    pub following_error: Option<f64>,
    /// Delay of a ramp by the shaper, in s.
    pub delay_s: f64,
    /// Whether its encoder has an index.
    pub index: bool,
    /// Whether its encoder is absolute, so that it needs no homing.
    pub absolute: bool,
    /// The probe at which it is homed, in place of an index.
    pub probe: Option<HalProbe>,
}

/// The probe of an axis, in LinuxCNC's units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalProbe {
    /// Velocity of the approach, with its direction.
    pub velocity: f64,
    /// Position of the contact.
    pub position: f64,
    /// Position after homing, away from the contact.
    pub rest: f64,
}

/// Why a machine cannot be driven by LinuxCNC. `axis` counts from 0.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("axis {axis}: LinuxCNC has only the letters A, B and C for rotary axes: make a machine with at most three")]
pub struct HalError {
    /// The axis.
    pub axis: usize,
}

/// The files.
///
/// # Errors
/// [`HalError`] for more rotary axes than LinuxCNC has.
pub fn files(machine: &HalMachine<'_>) -> Result<Vec<DriverFile>, HalError> {
    let letters = letters(&machine.axes)?;
    let name = machine.name;
    let title = format!(
        "# Tap tables of {name} for LinuxCNC's posicast_shaper: the machine's own, and one that does not shape. Written by posicast.\n"
    );
    let mut files = vec![file(&format!("{name}.shapers.toml"), title + &machine.tables.text())];
    if machine.has_stage {
        files.extend(FIXED.map(|(path, text)| file(path, text.to_owned())));
        files.push(file("posicast_hal_machine.h", header(machine)));
        files.push(file(&format!("{name}.hal"), wiring::text(machine)));
        files.push(file(&format!("{name}.ini"), ini::text(machine, &letters)));
    }
    Ok(files)
}

/// Sources that are the same for every machine.
const FIXED: [(&str, &str); 8] = [
    ("posicast.c", include_str!("c/posicast.c")),
    ("posicast_link.c", include_str!("c/posicast_link.c")),
    ("posicast_link.h", include_str!("c/posicast_link.h")),
    ("posicast_load.c", include_str!("c/posicast_load.c")),
    ("posicast_load.h", include_str!("c/posicast_load.h")),
    ("posicast_path.c", include_str!("c/posicast_path.c")),
    ("posicast_path.h", include_str!("c/posicast_path.h")),
    ("Makefile", include_str!("c/Makefile")),
];

/// Returns LinuxCNC's letter of each axis: its own name if that is a letter of its kind, otherwise the next free letter.
fn letters(axes: &[HalAxis<'_>]) -> Result<Vec<char>, HalError> {
    let of_kind = |axis: &HalAxis<'_>| if axis.rotary { &ROTARY[..] } else { &LINEAR[..] };
    let own = |axis: &HalAxis<'_>| {
        let letter = axis.name.to_uppercase();
        of_kind(axis).iter().copied().find(|known| letter == known.to_string())
    };
    let mut letters: Vec<Option<char>> = axes.iter().map(own).collect();
    for (index, axis) in axes.iter().enumerate() {
        if letters[index].is_none() {
            let free = of_kind(axis).iter().find(|letter| !letters.contains(&Some(**letter)));
            letters[index] = Some(*free.ok_or(HalError { axis: index })?);
        }
    }
    Ok(letters.into_iter().flatten().collect())
}

fn header(machine: &HalMachine<'_>) -> String {
    let name = machine.name;
    let (mut counts, mut travel) = (String::new(), String::new());
    for axis in &machine.axes {
        let _ = writeln!(
            counts,
            "    {:?}, /* {}, per {} */",
            axis.counts_per_unit,
            axis.name,
            axis.unit()
        );
        let ends = axis.travel.unwrap_or([0.0; 2]).map(|end| {
            ((end - axis.probe.map_or(0.0, |probe| probe.position)) * axis.counts_per_unit * COMMAND_LSB).round() as i32
        });
        let _ = writeln!(travel, "    {{{}, {}}},", ends[0], ends[1]);
    }
    format!(
        "/* {name} in LinuxCNC's units. Written by posicast. */
#ifndef POSICAST_HAL_MACHINE_H
#define POSICAST_HAL_MACHINE_H

#include \"machine_{name}.h\"

#define POSICAST_HAL_MACHINE machine_{name}
#define POSICAST_HAL_SERVO_NS {servo_ns}u

/* Counts of the loop per unit of LinuxCNC. */
static const double posicast_hal_counts[] = {{
{counts}}};

/* Soft limits from the origin, which is the contact of a probe, Q24.8 counts; equal where there are none. */
static const int32_t posicast_hal_travel[][2] = {{
{travel}}};

#endif
",
        servo_ns = machine.servo_ns(),
    )
}

impl HalMachine<'_> {
    /// Period of the servo thread in ns.
    fn servo_ns(&self) -> u32 {
        (1e9 / self.servo_hz).round() as u32
    }
}

impl HalAxis<'_> {
    /// Its unit in LinuxCNC.
    fn unit(&self) -> &'static str {
        if self.rotary { "degree" } else { "mm" }
    }
}

fn file(path: &str, text: String) -> DriverFile {
    DriverFile {
        path: format!("{FOLDER}/{path}"),
        text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(name: &str, rotary: bool) -> HalAxis<'_> {
        HalAxis {
            name,
            rotary,
            counts_per_unit: 1000.0,
            velocity: 250.0,
            acceleration: 8000.0,
            travel: None,
            following_error: None,
            delay_s: 0.003,
            index: false,
            absolute: false,
            probe: None,
        }
    }

    #[test]
    fn axes_keep_their_letter_if_it_suits_their_kind() {
        let axes = [
            axis("table", false),
            axis("x", false),
            axis("c", true),
            axis("z2", false),
        ];
        assert_eq!(letters(&axes), Ok(vec!['Y', 'X', 'C', 'Z']));
        // A rotary x and a linear a have letters of the other kind.
        assert_eq!(letters(&[axis("x", true), axis("a", false)]), Ok(vec!['A', 'X']));
        let turning = [axis("a", true), axis("b", true), axis("c", true), axis("d", true)];
        assert_eq!(letters(&turning), Err(HalError { axis: 3 }));
    }
}
