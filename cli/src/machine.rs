//! Reading the machine file and what is decided from it once: the design.

use crate::failure::Failure;
use posicast_hdl::machine::AxisShaper;
use posicast_model::design::{AxisTables, MachineDesign};
use posicast_model::rtl::shaper::{Motion, ShaperConfig};
use posicast_model::spec::{self, Axis, Machine};
use std::path::Path;

/// A machine file is a page of text; anything far beyond is some other file named by mistake.
const LARGEST_FILE_BYTES: u64 = 1 << 20;

/// The shaper of a modulo axis: its position wraps.
const MODULO: Motion = Motion {
    channels: 1,
    modulo: true,
};

/// A machine file, read and validated.
pub(crate) struct MachineFile {
    /// The text as it stands in the file.
    pub(crate) text: String,
    /// What it says.
    pub(crate) machine: Machine,
}

/// Reads and validates the machine file at `path`.
pub(crate) fn read(path: &Path) -> Result<MachineFile, Failure> {
    let name = path.display().to_string();
    let unreadable = |found: &dyn std::fmt::Display| {
        Failure::from(miette::miette!(
            help = "name a machine file, such as examples/xy-stage.toml",
            "cannot read the machine file `{name}`: {found}"
        ))
    };
    let metadata = std::fs::metadata(path).map_err(|e| unreadable(&e))?;
    if metadata.is_dir() {
        return Err(unreadable(&"it is a folder"));
    }
    if metadata.len() > LARGEST_FILE_BYTES {
        return Err(unreadable(&format!(
            "{} bytes found, at most {LARGEST_FILE_BYTES} allowed",
            metadata.len()
        )));
    }
    let bytes = std::fs::read(path).map_err(|e| unreadable(&e))?;
    let text = String::from_utf8(bytes).map_err(|e| unreadable(&format!("it is not UTF-8 text: {e}")))?;
    let machine = parse(path, &text)?;
    Ok(MachineFile { text, machine })
}

/// Validates the text of the machine file at `path`.
pub(crate) fn parse(path: &Path, text: &str) -> Result<Machine, Failure> {
    spec::parse(&path.display().to_string(), text).map_err(Failure::input)
}

/// What is built for every axis of a machine, which the file at `path` describes.
pub(crate) fn shapers(machine: &Machine, design: &MachineDesign, path: &Path) -> Result<Vec<AxisShaper>, Failure> {
    let axes = machine.axes.iter().zip(&design.axes);
    axes.map(|(axis, tables)| {
        let refused = |reason: String| Failure::from(miette::miette!("axis `{}`: {reason}", axis.name)).in_file(path);
        Ok(AxisShaper {
            axis: axis.name.clone(),
            config: shaper(machine, axis, tables).map_err(refused)?,
        })
    })
    .collect()
}

/// The shaper of an axis, or why it cannot be built, or not run at the machine's sample rate.
pub(crate) fn shaper(machine: &Machine, axis: &Axis, tables: &AxisTables) -> Result<ShaperConfig, String> {
    let plain = ShaperConfig::new(machine.fixed_point.command_bits, tables.table.clone());
    let config = match axis.modulo {
        true => plain.and_then(|config| config.for_motion(MODULO)),
        false => plain,
    };
    let config = config.map_err(|e| e.to_string())?;
    config
        .fits(u64::from(machine.clock.clocks_per_sample()))
        .map_err(|e| e.to_string())?;
    Ok(config)
}
