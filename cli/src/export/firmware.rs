//! Impulses for the firmware of 3D printers. What a firmware cannot express is refused: a shaper that is nearly the one that
//! was designed would have a residual that nobody computed.
//!
//! | firmware | takes |
//! |---|---|
//! | Klipper, `[input_shaper]` | the name of a kind for each of the axes x and y, with undamped frequency and damping ratio |
//! | Marlin, `M593` | ZV for each of the axes X and Y, with the damped frequency, because half its period is the delay |
//! | RepRapFirmware, `M593 P"custom"` | up to 5 impulses for all axes together: the sums of amplitudes, and the times between them |

use super::{Selected, Selection, list};
use crate::failure::Failure;
use posicast_model::design::ShaperParts;
use posicast_model::design::kind::ShaperKind;
use posicast_model::machine_file::DEFAULT_TOLERANCE;
use posicast_model::mode::Mode;
use std::fmt::Write;

/// Kinds that Klipper has: its name, and the largest damping ratio that it takes.
const KLIPPER: [(ShaperKind, &str, f64); 6] = [
    (ShaperKind::Zv, "zv", 0.99),
    (ShaperKind::Mzv, "mzv", 0.99),
    (ShaperKind::Zvd, "zvd", 0.99),
    (ShaperKind::Ei, "ei", 0.4),
    (ShaperKind::TwoHumpEi, "2hump_ei", 0.3),
    (ShaperKind::ThreeHumpEi, "3hump_ei", 0.2),
];

/// Number of impulses of RepRapFirmware: the first, and four more.
const REPRAP_IMPULSES: usize = 5;

fn refused(selected: &Selected<'_>, why: &str, remedy: &str) -> Failure {
    Failure::from(miette::miette!(
        help = remedy.to_owned(),
        "axis `{}`: {why}",
        selected.axis.name
    ))
}

/// Returns the axis's name in lower case, which must be one that both firmwares shape.
fn x_or_y(selected: &Selected<'_>, firmware: &str) -> Result<String, Failure> {
    let name = selected.axis.name.to_lowercase();
    match name.as_str() {
        "x" | "y" => Ok(name),
        _ => Err(refused(
            selected,
            &format!("{firmware} shapes the axes x and y"),
            "name the axis x or y in the machine file, or select the axes that are with --axis",
        )),
    }
}

/// Returns mode and kind of an axis with one mode, whose shaper the firmware can be told by name.
fn named(selected: &Selected<'_>, firmware: &str, kinds: &str) -> Result<(Mode, ShaperKind), Failure> {
    let remedy = format!(
        "choose one of {kinds} and one mode, or take --to reprapfirmware, which takes two to five impulses above 0, or --to c, csv, numpy or matlab"
    );
    match &selected.tables.design.parts {
        ShaperParts::PerMode(parts) if parts.len() == 1 => Ok((parts[0].mode, parts[0].kind)),
        ShaperParts::PerMode(parts) => Err(refused(
            selected,
            &format!("{firmware} shapes one mode per axis, and this axis has {}", parts.len()),
            &remedy,
        )),
        ShaperParts::Joint { .. } => Err(refused(
            selected,
            &format!("{firmware} does not have the kind `{}`", selected.tables.design.kind),
            &remedy,
        )),
    }
}

/// Klipper's section `[input_shaper]`.
pub(super) fn klipper(selection: &Selection<'_>) -> Result<String, Failure> {
    let names = KLIPPER.map(|(kind, ..)| kind.name()).join(", ");
    let mut text = format!(
        "# Shapers of {}, designed by posicast {}.\n# Klipper computes zv, mzv and zvd by the same formulas as posicast. Its \
         ei kinds are fits to a tolerance of 5 %;\n# posicast's are exact, so that its residual figures hold only approximately \
         for these.\n[input_shaper]\n",
        selection.machine.name,
        env!("POSICAST_VERSION")
    );
    for selected in &selection.axes {
        let axis = x_or_y(selected, "Klipper")?;
        let (mode, kind) = named(selected, "Klipper", &names)?;
        let Some((_, name, most_damping)) = KLIPPER.into_iter().find(|(of, ..)| *of == kind) else {
            return Err(refused(
                selected,
                &format!("Klipper does not have the kind `{}`", kind.name()),
                &format!(
                    "choose one of {names}, or take --to reprapfirmware, which takes two to five impulses above 0, or --to c, csv, numpy or matlab"
                ),
            ));
        };
        let tolerance = selected.axis.modes.first().map(|mode| selected.axis.tolerance_of(mode));
        let has_tolerance = matches!(kind, ShaperKind::Ei | ShaperKind::TwoHumpEi | ShaperKind::ThreeHumpEi);
        if let (true, Some(tolerance)) = (has_tolerance, tolerance.filter(|found| *found != DEFAULT_TOLERANCE)) {
            return Err(refused(
                selected,
                &format!("Klipper's `{name}` has a tolerance of {DEFAULT_TOLERANCE}, and this axis {tolerance}"),
                &format!("leave out `tolerance`, or set it to {DEFAULT_TOLERANCE}"),
            ));
        }
        if mode.damping > most_damping {
            return Err(refused(
                selected,
                &format!(
                    "Klipper's `{name}` takes a damping ratio up to {most_damping}, and the mode has {}",
                    mode.damping
                ),
                "choose zv, mzv or zvd",
            ));
        }
        let _ = write!(
            text,
            "shaper_type_{axis}: {name}\nshaper_freq_{axis}: {:?}\ndamping_ratio_{axis}: {:?}\n",
            mode.frequency_hz, mode.damping
        );
    }
    Ok(text)
}

/// Marlin's `M593` for each axis.
pub(super) fn marlin(selection: &Selection<'_>) -> Result<String, Failure> {
    let mut text = format!(
        "; Shapers of {}, designed by posicast {}.\n; F is the damped frequency: Marlin delays by half its period. Marlin \
         rounds amplitudes to 1/128, and refuses\n; frequencies below its timer's rate / 131068, for example 15.3 Hz at 2 MHz.\n",
        selection.machine.name,
        env!("POSICAST_VERSION")
    );
    for selected in &selection.axes {
        let axis = x_or_y(selected, "Marlin")?.to_uppercase();
        let (mode, kind) = named(selected, "Marlin", "zv")?;
        if kind != ShaperKind::Zv {
            return Err(refused(
                selected,
                &format!("Marlin's M593 has only ZV, and this axis `{}`", kind.name()),
                "set `kind = \"zv\"`, or take --to klipper or --to reprapfirmware",
            ));
        }
        let [times, _] = selected.columns();
        let half_period_s = times.last().copied().unwrap_or_default();
        let _ = writeln!(text, "M593 {axis} F{:.4} D{:.6}", 0.5 / half_period_s, mode.damping);
    }
    Ok(text)
}

/// RepRapFirmware's `M593` with impulses of one's own.
pub(super) fn reprapfirmware(selection: &Selection<'_>) -> Result<String, Failure> {
    let Some((first, others)) = selection.axes.split_first() else {
        return Ok(String::new());
    };
    if let Some(other) = others.iter().find(|other| other.columns() != first.columns()) {
        return Err(refused(
            other,
            &format!(
                "RepRapFirmware has one shaper for all axes, and this one differs from that of `{}`",
                first.axis.name
            ),
            "select the axis whose shaper all are to have with --axis",
        ));
    }
    let [times, amplitudes] = first.columns();
    if !(2..=REPRAP_IMPULSES).contains(&times.len()) {
        return Err(refused(
            first,
            &format!(
                "RepRapFirmware takes 2 to {REPRAP_IMPULSES} impulses, and this shaper has {}",
                times.len()
            ),
            "choose a kind with fewer impulses, such as zvd, zvddd or three-hump-ei, for one mode",
        ));
    }
    if let Some(negative) = amplitudes.iter().find(|amplitude| **amplitude < 0.0) {
        return Err(refused(
            first,
            &format!("RepRapFirmware takes no negative impulses, and this shaper has one of {negative:.4}"),
            "choose a kind with positive impulses, such as zv, zvd, mzv or ei",
        ));
    }
    let before_last = &amplitudes[..amplitudes.len() - 1];
    let sums = before_last.iter().scan(0.0, |sum, amplitude| {
        *sum += amplitude;
        Some(*sum)
    });
    let sums: Vec<f64> = sums.collect();
    let between: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let digits = |numbers: &[f64]| {
        let texts: Vec<String> = numbers.iter().map(|number| format!("{number:.7}")).collect();
        texts.join(":")
    };
    Ok(format!(
        "; Shaper of {}, {}, designed by posicast {}.\n; H: sum of the amplitudes so far, after each impulse but the last. T: seconds \
         from each impulse to the next.\n; Impulses in seconds: {}\nM593 P\"custom\" H{} T{}\n",
        selection.machine.name,
        first.title(),
        env!("POSICAST_VERSION"),
        list(&times, ", "),
        digits(&sums),
        digits(&between)
    ))
}
