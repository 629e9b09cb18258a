//! Reading the machine file and what is decided from it once: the design.

use crate::failure::Failure;
use posicast_hdl::machine::AxisShaper;
use posicast_model::control::Schedule;
use posicast_model::design::{AxisTables, MachineDesign};
use posicast_model::rtl::shaper::{Motion, ShaperConfig, ShaperConfigError};
use posicast_model::spec::{self, Axis, Machine};
use std::fmt;
use std::fs::File;
use std::io::Read;
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
    // The length above is 0 for a device or a pipe: these may go on for ever.
    let file = File::open(path).map_err(|e| unreadable(&e))?;
    let mut bytes = Vec::new();
    let limit = file.take(LARGEST_FILE_BYTES + 1).read_to_end(&mut bytes);
    if limit.map_err(|e| unreadable(&e))? as u64 > LARGEST_FILE_BYTES {
        return Err(unreadable(&format!("it goes on after {LARGEST_FILE_BYTES} bytes")));
    }
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
    axes.enumerate()
        .map(|(index, (axis, tables))| {
            let refused = |unfit: Unfit| match unfit {
                Unfit::Shaper(_) => Failure::from(miette::miette!("axis `{}`: {unfit}", axis.name)).in_file(path),
                Unfit::Tick(_) => at_key(path, index, SAMPLE_KEY, format_args!("axis `{}`: {unfit}", axis.name)),
            };
            Ok(AxisShaper {
                axis: axis.name.clone(),
                config: shaper(machine, axis, tables).map_err(refused)?,
            })
        })
        .collect()
}

/// Why an axis is not built.
#[derive(Debug)]
pub(crate) enum Unfit {
    /// Its shaper cannot be.
    Shaper(ShaperConfigError),
    /// What it does in a tick takes longer than one.
    Tick(String),
}

impl fmt::Display for Unfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Shaper(error) => error.fmt(f),
            Self::Tick(reason) => f.write_str(reason),
        }
    }
}

/// The shaper of an axis in the machine's top module, or why it cannot be built, or the axis not run at the sample rate.
pub(crate) fn shaper(machine: &Machine, axis: &Axis, tables: &AxisTables) -> Result<ShaperConfig, Unfit> {
    let plain = ShaperConfig::new(machine.fixed_point.command_bits, tables.table.clone());
    let config = match axis.modulo {
        true => plain.and_then(|config| config.for_motion(MODULO)),
        false => plain,
    };
    let config = config.map_err(Unfit::Shaper)?;
    let available = machine.clock.clocks_per_sample();
    config
        .fits(u64::from(available))
        .map_err(|error| Unfit::Tick(error.to_string()))?;
    let Some(schedule) = schedule(axis, &config) else {
        return Ok(config);
    };
    schedule.fits(available).map_err(|error| {
        let step_clocks = pwm_step_clocks(machine);
        let largest_hz = schedule.largest_sample_hz(machine.clock.frequency_hz, step_clocks);
        Unfit::Tick(format!("{error}; allowed: up to {largest_hz} Hz"))
    })?;
    Ok(config)
}

/// The shaper of an axis as a component: one with a controller shapes velocity and acceleration too, and can change its
/// table while it moves, as far as words and ring allow.
pub(crate) fn component_shaper(axis: &Axis, top: &ShaperConfig) -> ShaperConfig {
    if axis.controller.is_none() {
        return top.clone();
    }
    let channels = |channels| {
        let motion = Motion {
            channels,
            modulo: axis.modulo,
        };
        top.clone().for_motion(motion)
    };
    channels(3).or_else(|_| channels(1)).unwrap_or_else(|_| top.clone())
}

/// What an axis does in a tick; nothing that must be in time where its position is not measured.
pub(crate) fn schedule(axis: &Axis, top: &ShaperConfig) -> Option<Schedule> {
    let shaper = component_shaper(axis, top);
    match (&axis.controller, &axis.encoder) {
        (Some(_), _) => Some(Schedule::controlling(shaper.pass_clocks(shaper.most_products()))),
        (None, Some(_)) => Some(Schedule::measuring()),
        (None, None) => None,
    }
}

/// A sample lasts a multiple of so many clocks: every axis's PWM has a whole number of periods in it.
fn pwm_step_clocks(machine: &Machine) -> u64 {
    let periods = machine.axes.iter().filter_map(|axis| axis.pwm.as_ref());
    let periods = periods.map(|pwm| u64::from(pwm.period_clocks(&machine.clock)).max(1));
    // Each divides the sample, which has at most a million clocks; so does what all of them divide.
    periods.fold(1, |common, period| common / common_divisor(common, period) * period)
}

fn common_divisor(a: u64, b: u64) -> u64 {
    match b {
        0 => a,
        _ => common_divisor(b, a % b),
    }
}

/// The key of the tick.
pub(crate) const SAMPLE_KEY: &str = "clock.sample_hz";

/// Bad input at a key of the machine file at `path`, or of that in the folder; `axis` counts the axes from 0.
pub(crate) fn at_key(path: &Path, axis: usize, key: &str, reason: impl fmt::Display) -> Failure {
    let file = match path.is_dir() {
        true => path.join("machine.toml"),
        false => path.to_owned(),
    };
    // The file was read before; where it is gone, the key must do.
    let text = std::fs::read_to_string(&file).unwrap_or_default();
    let line = spec::line_of(&text, axis, key).map_or_else(String::new, |line| format!(":{line}"));
    Failure::from(miette::miette!("{}{line}: {key}: {reason}", file.display()))
}
