//! Impulses for the firmware of 3D printers.
//!
//! The file of each firmware describes its numbers, their format, and its own shapers; this file has what the firmwares share:
//!
//! ```text
//! design ─► accepted: the numbers, and their interpretation by the firmware ─► residual at the modes, beside the design's
//!        └► refused ─► the firmware's own shaper that leaves least, which --closest writes
//! ```

mod klipper;
mod marlin;
mod nearest;
mod reprapfirmware;

pub(super) use klipper::{kalico, klipper};
pub(super) use marlin::{marlin, marlin_ft};
pub(super) use reprapfirmware::reprapfirmware;

use super::{Selected, Selection};
use crate::failure::Failure;
use posicast_shaper::analysis::residual_vibration;
use posicast_shaper::firmware::smoother::Smoother;
use posicast_shaper::firmware::version::{Firmware, VersionError};
use posicast_shaper::impulse::ImpulseSequence;
use posicast_shaper::mode::Mode;

/// Smallest difference of two residuals that gives a warning.
const WORTH_A_WARNING: f64 = 0.01;

/// The user's options for a firmware's export.
pub(super) struct Wish<'a> {
    /// Its version; `None` for the newest.
    pub(super) version: Option<&'a str>,
    /// Whether the firmware's own shaper is written if the firmware cannot use the design.
    pub(super) closest: bool,
}

impl Wish<'_> {
    /// Refuses these options for tables of numbers, which have neither versions nor a closest shaper.
    pub(super) fn refuse_for_arrays(&self) -> Result<(), Failure> {
        let option = match (self.version, self.closest) {
            (Some(_), _) => "--firmware-version",
            (None, true) => "--closest",
            (None, false) => return Ok(()),
        };
        Err(
            Failure::input(format!("{option}: this form of the output is not for a firmware")).with_help(format!(
                "leave out {option}, or take --to klipper, kalico, marlin, marlin-ft or reprapfirmware"
            )),
        )
    }
}

/// The firmware's interpretation of the written numbers.
enum Read {
    /// Impulses.
    Impulses(ImpulseSequence),
    /// A polynomial kernel.
    Smoother(Smoother),
}

impl Read {
    fn residual(&self, mode: &Mode) -> f64 {
        match self {
            Read::Impulses(impulses) => residual_vibration(impulses.impulses(), mode),
            Read::Smoother(smoother) => smoother.residual(mode),
        }
    }
}

/// The text for an axis.
struct Told {
    /// Lines of the output.
    lines: String,
    /// The firmware's interpretation of these lines.
    read: Read,
}

/// Why a firmware cannot use a design.
struct Refusal {
    why: String,
    remedy: String,
    /// Whether the firmware has a shaper of its own for the axis, so that another one can help.
    has_own: bool,
}

impl Refusal {
    fn new(why: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self {
            why: why.into(),
            remedy: remedy.into(),
            has_own: true,
        }
    }

    /// The firmware has no shaper for the axis.
    fn without_own(self) -> Self {
        Self { has_own: false, ..self }
    }

    fn failure(&self, axis: &str, more: &[String]) -> Failure {
        let help: Vec<&str> = more.iter().map(String::as_str).chain([self.remedy.as_str()]).collect();
        Failure::input(format!("axis `{axis}`: {}", self.why)).with_help(help.join("\n"))
    }
}

/// Refuses an unknown version, and lists the known ones.
fn of_version(firmware: Firmware, error: &VersionError) -> Failure {
    Failure::input(format!("--firmware-version: {error}")).with_help(format!(
        "versions of {}: {}",
        firmware.name(),
        firmware.versions()
    ))
}

/// Returns the axis's name in lower case, which must be one that the firmware shapes.
fn axis_of(selected: &Selected<'_>, version: &str, axes: &[&str]) -> Result<String, Refusal> {
    let name = selected.axis.name.to_lowercase();
    if axes.contains(&name.as_str()) {
        Ok(name)
    } else {
        Err(Refusal::new(
            format!("{version} shapes the axes {}", joined(axes)),
            match name.as_str() {
                "z" => "take a newer --firmware-version, or select the other axes with --axis",
                _ => "give the axis one of these names in the machine file, or select only such axes with --axis",
            },
        )
        .without_own())
    }
}

/// Words with commas, and `and` before the last.
fn joined(words: &[&str]) -> String {
    match words {
        [before @ .., last] if !before.is_empty() => format!("{} and {last}", before.join(", ")),
        _ => words.join(", "),
    }
}

/// Head of an output: its content, and its firmware.
fn heading(selection: &Selection<'_>, comment: &str, version: &str) -> String {
    format!(
        "{comment} Shapers of {}, designed by posicast {}, for {version}.\n",
        selection.machine.name,
        crate::VERSION
    )
}

/// Compares the residuals of the firmware and of the design at each mode, in a comment. Adds a warning if the difference matters, unless
/// `--closest` requested it.
fn residuals(selected: &Selected<'_>, read: &Read, firmware: &str, is_closest: bool) -> String {
    let design = &selected.tables.design.impulses;
    let modes: Vec<Mode> = selected.axis.modes.iter().map(|mode| mode.mode).collect();
    if modes.is_empty() {
        return "no mode, no residual".into();
    }
    let of = |residual: &dyn Fn(&Mode) -> f64| -> (Vec<f64>, String) {
        let values: Vec<f64> = modes.iter().map(residual).collect();
        let texts: Vec<String> = values.iter().map(|value| format!("{:.3} %", 100.0 * value)).collect();
        (values, texts.join(" and "))
    };
    let (theirs, their_text) = of(&|mode| read.residual(mode));
    let (ours, our_text) = of(&|mode| residual_vibration(design.impulses(), mode));
    let at = if modes.len() == 1 {
        "at the mode"
    } else {
        "at the modes"
    };
    let differs = theirs
        .iter()
        .zip(&ours)
        .any(|(theirs, ours)| (theirs - ours).abs() > WORTH_A_WARNING);
    if differs && !is_closest {
        selected.observer.say(&format!(
            "warning: axis `{}`: as {firmware} computes the shaper, it leaves {their_text} {at}, and the design {our_text}",
            selected.axis.name
        ));
    }
    format!("leaves {their_text} {at}; the design {our_text}")
}
