//! Marlin's `M593` (ZV), and `M493` of its fixed-time motion.

use super::super::{Selected, Selection};
use super::nearest::Own;
use super::{Read, Refusal, Told, Wish, axis_of, heading, of_version, residuals};
use crate::failure::Failure;
use posicast_shaper::axis::DEFAULT_TOLERANCE;
use posicast_shaper::design::ShaperParts;
use posicast_shaper::design::kind::ShaperKind;
use posicast_shaper::firmware::closest::OwnKind;
use posicast_shaper::firmware::marlin::{FT_DAMPING, FT_LEAST_HZ, FT_SAMPLE_HZ, FtKind, m593, m593_damping};
use posicast_shaper::firmware::version::{Firmware, MarlinVersion};
use posicast_shaper::impulse::ImpulseSequence;
use posicast_shaper::mode::Mode;
use std::fmt::Write;

/// `M593` for each axis.
pub(crate) fn marlin(selection: &Selection<'_>, wish: &Wish<'_>) -> Result<String, Failure> {
    let version = MarlinVersion::m593(wish.version).map_err(|error| of_version(Firmware::Marlin, &error))?;
    let mut text = heading(selection, ";", &version.name);
    text += "; F is the damped frequency: Marlin delays by half its period. Marlin rounds amplitudes down to 1/128 by a fit of D, so that D may\n\
             ; differ a little from the mode's damping ratio. It refuses frequencies below its timer's rate / 131068, for example 15.3 Hz at 2 MHz.\n";
    let own = Own {
        firmware: "Marlin",
        candidates: vec![OwnKind {
            name: "M593 (ZV)".into(),
            damping: [0.0, 0.9],
            frequency_hz: [1.0, 1e4],
            impulses: Box::new(m593),
        }],
        default_damping: None,
    };
    let line = |axis: &str, frequency_hz: f64, damping: f64| {
        format!("M593 {} F{frequency_hz:.4} D{damping:.6}\n", axis.to_uppercase())
    };
    let told = |selected: &Selected<'_>, axis: &str| {
        if is_none(selected) {
            return Ok(off(&format!("M593 {} F0\n", axis.to_uppercase())));
        }
        let (mode, kind) = named(selected, "Marlin", "zv")?;
        if kind != ShaperKind::Zv {
            return Err(Refusal::new(
                format!("Marlin's M593 has only ZV, and this axis `{}`", kind.name()),
                "set `kind = \"zv\"`, or take --to marlin-ft, --to klipper or --to reprapfirmware",
            ));
        }
        let (frequency_hz, damping) = (mode.damped_frequency_hz(), m593_damping(mode.damping));
        let read = m593(frequency_hz, damping)
            .ok_or_else(|| Refusal::new("Marlin takes damping ratios below 1", "check the mode"))?;
        Ok(Told {
            lines: line(axis, frequency_hz, damping),
            read: Read::Impulses(read),
        })
    };
    let closest = |axis: &str, _: usize, frequency_hz: f64, damping: f64| line(axis, frequency_hz, damping);
    axes(selection, wish, &version, &own, &told, &closest, text)
}

/// `M493` for each axis.
pub(crate) fn marlin_ft(selection: &Selection<'_>, wish: &Wish<'_>) -> Result<String, Failure> {
    let version = MarlinVersion::m493(wish.version).map_err(|error| of_version(Firmware::MarlinFixedTime, &error))?;
    let mut text = heading(selection, ";", &version.name);
    let _ = write!(
        text,
        "; Fixed-time motion rounds each delay to its samples of {} ms (FTM_FS {FT_SAMPLE_HZ}); the figures below include that. It takes frequencies \
         from FTM_MIN_SHAPE_FREQ on, by default {FT_LEAST_HZ} Hz.\nM493 S1\n",
        1e3 / FT_SAMPLE_HZ
    );
    let candidates = FtKind::ALL.map(|(kind, _, name)| OwnKind {
        name: name.into(),
        damping: FT_DAMPING,
        frequency_hz: [FT_LEAST_HZ, FT_SAMPLE_HZ / 2.0],
        impulses: Box::new(move |frequency_hz, damping| kind.impulses(frequency_hz, damping, DEFAULT_TOLERANCE)),
    });
    let own = Own {
        firmware: "fixed-time motion",
        candidates: candidates.into_iter().collect(),
        default_damping: None,
    };
    let line = |axis: &str, kind: FtKind, frequency_hz: f64, damping: f64, tolerance: f64| {
        m493(&version, axis, kind, frequency_hz, damping, tolerance)
    };
    let told = |selected: &Selected<'_>, axis: &str| {
        if is_none(selected) {
            let off_line = if version.has_axis_flags {
                format!("M493 {} C0\n", axis.to_uppercase())
            } else {
                format!("M493 {}0\n", axis.to_uppercase())
            };
            return Ok(off(&off_line));
        }
        let names: Vec<&str> = KINDS.iter().map(|(kind, _)| kind.name()).collect();
        let (mode, kind) = named(selected, "Marlin", &names.join(", "))?;
        let Some((_, ft)) = KINDS.iter().find(|(of, _)| *of == kind) else {
            return Err(Refusal::new(
                format!("fixed-time motion does not have the kind `{}`", kind.name()),
                format!(
                    "choose one of {}, or take --to reprapfirmware or --to kalico",
                    names.join(", ")
                ),
            ));
        };
        // The firmware replaces a smaller ratio by 0.01; the figures show the effect.
        let damping = mode.damping.max(FT_DAMPING[0]);
        if damping > FT_DAMPING[1] {
            return Err(Refusal::new(
                format!(
                    "fixed-time motion takes damping ratios up to {}, and the mode has {damping}",
                    FT_DAMPING[1]
                ),
                "take --to marlin with kind = \"zv\", --to klipper or --to reprapfirmware",
            ));
        }
        if mode.frequency_hz < FT_LEAST_HZ || mode.frequency_hz > FT_SAMPLE_HZ / 2.0 {
            return Err(Refusal::new(
                format!(
                    "fixed-time motion takes frequencies from {FT_LEAST_HZ} to {} Hz, and the mode has {}",
                    FT_SAMPLE_HZ / 2.0,
                    mode.frequency_hz
                ),
                "lower FTM_MIN_SHAPE_FREQ in Marlin's configuration and write the line by hand, or take --to marlin",
            )
            .without_own());
        }
        let tolerance = selected
            .axis
            .modes
            .first()
            .map_or(DEFAULT_TOLERANCE, |mode| selected.axis.shaped().tolerance_of(mode));
        let read = ft
            .impulses(mode.frequency_hz, damping, tolerance)
            .ok_or_else(|| Refusal::new("fixed-time motion makes no shaper of these numbers", "check the mode"))?;
        Ok(Told {
            lines: line(axis, *ft, mode.frequency_hz, damping, tolerance),
            read: Read::Impulses(read),
        })
    };
    let closest = |axis: &str, candidate: usize, frequency_hz: f64, damping: f64| {
        line(axis, FtKind::ALL[candidate].0, frequency_hz, damping, DEFAULT_TOLERANCE)
    };
    axes(selection, wish, &version, &own, &told, &closest, text)
}

/// The kinds of posicast that fixed-time motion has.
const KINDS: [(ShaperKind, FtKind); 8] = [
    (ShaperKind::Zv, FtKind::Zv),
    (ShaperKind::Zvd, FtKind::Zvd),
    (ShaperKind::Zvdd, FtKind::Zvdd),
    (ShaperKind::Zvddd, FtKind::Zvddd),
    (ShaperKind::Mzv, FtKind::Mzv),
    (ShaperKind::Ei, FtKind::Ei),
    (ShaperKind::TwoHumpEi, FtKind::TwoHumpEi),
    (ShaperKind::ThreeHumpEi, FtKind::ThreeHumpEi),
];

/// A line of `M493` in the version's form: version 2 names the axis by a flag, version 1 has letters per axis.
fn m493(version: &MarlinVersion, axis: &str, kind: FtKind, frequency_hz: f64, damping: f64, tolerance: f64) -> String {
    let number = FtKind::ALL
        .iter()
        .find(|(of, ..)| *of == kind)
        .map_or(0, |(_, number, _)| *number);
    let (upper, letters) = (
        axis.to_uppercase(),
        if axis == "y" { ["B", "J", "R"] } else { ["A", "I", "Q"] },
    );
    let ([frequency, ratio, bound], shaper) = if version.has_axis_flags {
        (["A", "I", "Q"], format!("{upper} C{number}"))
    } else {
        (letters, format!("{upper}{number}"))
    };
    let bound = kind
        .humps()
        .map_or_else(String::new, |_| format!(" {bound}{tolerance}"));
    format!("M493 {shaper} {frequency}{frequency_hz:.4} {ratio}{damping:.6}{bound}\n")
}

fn is_none(selected: &Selected<'_>) -> bool {
    selected.tables.design.impulses.impulses().len() == 1
}

fn off(line: &str) -> Told {
    Told {
        lines: line.into(),
        read: Read::Impulses(ImpulseSequence::unity()),
    }
}

/// Returns mode and kind of an axis with one mode, if the firmware offers its shaper by name.
fn named(selected: &Selected<'_>, firmware: &str, kinds: &str) -> Result<(Mode, ShaperKind), Refusal> {
    let remedy = format!(
        "choose one of {kinds} and one mode, or take --to reprapfirmware or --to kalico, which take impulses, or --to c, csv, numpy or matlab"
    );
    match &selected.tables.design.parts {
        ShaperParts::PerMode(parts) if parts.len() == 1 => Ok((parts[0].mode, parts[0].kind)),
        ShaperParts::PerMode(parts) => Err(Refusal::new(
            format!("{firmware} shapes one mode per axis, and this axis has {}", parts.len()),
            remedy,
        )),
        ShaperParts::Joint { .. } => Err(Refusal::new(
            format!("{firmware} does not have the kind `{}`", selected.tables.design.kind),
            remedy,
        )),
    }
}

/// The lines of all axes, each with the residual that Marlin leaves.
fn axes(
    selection: &Selection<'_>,
    wish: &Wish<'_>,
    version: &MarlinVersion,
    own: &Own<'_>,
    told: &dyn Fn(&Selected<'_>, &str) -> Result<Told, Refusal>,
    closest: &dyn Fn(&str, usize, f64, f64) -> String,
    mut text: String,
) -> Result<String, Failure> {
    for selected in &selection.axes {
        let axis = axis_of(selected, &version.name, version.axes);
        let _ = writeln!(text, "; {}", selected.title());
        let told = axis.and_then(|axis| told(selected, &axis));
        let is_closest = told.is_err();
        let told = match told {
            Ok(told) => told,
            Err(refusal) if wish.closest && refusal.has_own => {
                let found = own
                    .search(&[selected])
                    .ok_or_else(|| own.refuse(&refusal, &[selected]))?;
                let _ = writeln!(text, "; {}", found.line);
                let best = &found.best[0];
                let axis = selected.axis.name.to_lowercase();
                Told {
                    lines: closest(&axis, best.candidate, best.frequency_hz, best.damping),
                    read: Read::Impulses(best.impulses.clone()),
                }
            }
            Err(refusal) => return Err(own.refuse(&refusal, &[selected])),
        };
        let _ = writeln!(
            text,
            "; As Marlin computes it, it {}.",
            residuals(selected, &told.read, "Marlin", is_closest)
        );
        text += &told.lines;
    }
    Ok(text)
}
