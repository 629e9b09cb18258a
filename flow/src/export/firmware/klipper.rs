//! Klipper's and Kalico's section `[input_shaper]`.
//!
//! `zv`, `zvd` and `mzv` equal posicast's designs. The EI kinds of Klipper are fits; if the firmware accepts impulses
//! (`custom`), posicast's own are written instead.

use super::super::{Selected, Selection, list};
use super::nearest::Own;
use super::{Read, Refusal, Told, Wish, axis_of, heading, of_version, residuals};
use crate::failure::Failure;
use posicast_shaper::design::ShaperParts;
use posicast_shaper::design::kind::ShaperKind;
use posicast_shaper::design::smooth::Kernel;
use posicast_shaper::firmware::closest::{Closest, OwnKind};
use posicast_shaper::firmware::klipper::{DEFAULT_DAMPING, DEFAULT_TOLERANCE, EiFormulas, Kind, impulses};
use posicast_shaper::firmware::merge::merged;
use posicast_shaper::firmware::smoother::Smoother;
use posicast_shaper::firmware::version::{Firmware, KlipperVersion};
use posicast_shaper::impulse::ImpulseSequence;
use posicast_shaper::mode::Mode;
use std::fmt::Write;

/// Limits of `custom`: number of impulses, smallest amplitude, and duration in seconds.
const MOST_IMPULSES: usize = 5;
const LEAST_AMPLITUDE: f64 = 0.001;
const DURATION_S: [f64; 2] = [0.001, 0.2];
/// Tolerances for which the fit of `ei` is accurate enough to keep what it promises.
const TOLERANCES: [f64; 2] = [0.01, 0.2];
/// Parameters of `ei` and `mzv` that are tried in a search.
const TRIED_TOLERANCES: [f64; 3] = [0.02, 0.1, 0.15];
const TRIED_MZV: [(usize, f64); 6] = [(4, 0.9), (4, 1.0), (4, 1.2), (5, 1.2), (5, 1.4), (6, 1.5)];

/// Klipper's section.
pub(crate) fn klipper(selection: &Selection<'_>, wish: &Wish<'_>) -> Result<String, Failure> {
    let version = KlipperVersion::klipper(wish.version).map_err(|error| of_version(Firmware::Klipper, &error))?;
    section(selection, wish, &version)
}

/// Kalico's section.
pub(crate) fn kalico(selection: &Selection<'_>, wish: &Wish<'_>) -> Result<String, Failure> {
    let version = KlipperVersion::kalico(wish.version).map_err(|error| of_version(Firmware::Kalico, &error))?;
    section(selection, wish, &version)
}

fn section(selection: &Selection<'_>, wish: &Wish<'_>, version: &KlipperVersion) -> Result<String, Failure> {
    let own = own(version);
    let mut text = heading(selection, "#", &version.name);
    let mut lines = String::from("[input_shaper]\n");
    for selected in &selection.axes {
        let told = axis_of(selected, &version.name, version.axes)
            .and_then(|axis| told(selected, &axis, version).map(|told| (told, axis)));
        let (told, remark) = match told {
            Ok((told, _)) => (told, None),
            Err(refusal) if wish.closest && refusal.has_own => {
                let found = own
                    .search(&[selected])
                    .ok_or_else(|| own.refuse(&refusal, &[selected]))?;
                let axis = selected.axis.name.to_lowercase();
                (told_closest(&axis, &own, &found.best[0]), Some(found.line))
            }
            Err(refusal) => return Err(own.refuse(&refusal, &[selected])),
        };
        let _ = writeln!(text, "# {}", selected.title());
        if let Some(remark) = &remark {
            let _ = writeln!(text, "# {remark}");
        }
        let _ = writeln!(
            text,
            "# As {} computes it, it {}.",
            version.firmware.name(),
            residuals(selected, &told.read, version.firmware.name(), remark.is_some())
        );
        lines += &told.lines;
    }
    if lines.contains(": 3hump_ei\n") && version.ei != EiFormulas::Fits {
        text += "# 3hump_ei is right from Klipper v0.13.0-594 (31 March 2026) on: the figures above are those of the version named above.\n";
    }
    Ok(text + &lines)
}

/// Returns the text for an axis, if the firmware has a shaper for it.
fn told(selected: &Selected<'_>, axis: &str, version: &KlipperVersion) -> Result<Told, Refusal> {
    let firmware = version.firmware.name();
    if selected.tables.design.impulses.impulses().len() == 1 {
        return Ok(Told {
            lines: format!("shaper_type_{axis}: zv\nshaper_freq_{axis}: 0\n"),
            read: Read::Impulses(ImpulseSequence::unity()),
        });
    }
    let single = single(selected);
    if let Some((mode, kind)) = single {
        if kind.is_smooth() && version.has_custom {
            return smoother(selected, axis, mode, kind);
        }
        let exact = matches!(kind, ShaperKind::Zv | ShaperKind::Zvd | ShaperKind::Mzv);
        if let Some(named) = named(kind).filter(|_| exact || !version.has_custom) {
            let told = lines_of_named_kind(selected, axis, version, mode, named);
            // A damping ratio beyond the limit of a branch is not a reason to refuse if the branch accepts impulses.
            if told.is_ok() || !version.has_custom {
                return told;
            }
        }
    }
    if version.has_custom {
        return custom(selected, axis, firmware);
    }
    let names: Vec<&str> = KINDS.iter().map(|(kind, _)| kind.name()).collect();
    let remedy = format!(
        "choose one of {} and one mode; or a firmware that takes impulses: --to kalico, --to klipper --firmware-version advanced-features, \
         --to reprapfirmware; or --to c, csv, numpy or matlab",
        names.join(", ")
    );
    Err(match single {
        Some((_, kind)) => Refusal::new(format!("{firmware} does not have the kind `{}`", kind.name()), remedy),
        None if selected.axis.modes.len() > 1 => Refusal::new(
            format!(
                "{firmware} shapes one mode per axis, and this axis has {}",
                selected.axis.modes.len()
            ),
            remedy,
        ),
        None => Refusal::new(
            format!("{firmware} does not have the kind `{}`", selected.tables.design.kind),
            remedy,
        ),
    })
}

/// The kinds of posicast that Klipper offers by name.
const KINDS: [(ShaperKind, Kind); 6] = [
    (ShaperKind::Zv, Kind::Zv),
    (ShaperKind::Mzv, Kind::Mzv),
    (ShaperKind::Zvd, Kind::Zvd),
    (ShaperKind::Ei, Kind::Ei),
    (ShaperKind::TwoHumpEi, Kind::TwoHumpEi),
    (ShaperKind::ThreeHumpEi, Kind::ThreeHumpEi),
];

fn named(kind: ShaperKind) -> Option<Kind> {
    KINDS.iter().find(|(of, _)| *of == kind).map(|(_, named)| *named)
}

/// Mode and kind of an axis with one mode and one kind for it.
fn single(selected: &Selected<'_>) -> Option<(Mode, ShaperKind)> {
    match &selected.tables.design.parts {
        ShaperParts::PerMode(parts) if parts.len() == 1 => Some((parts[0].mode, parts[0].kind)),
        _ => None,
    }
}

/// Returns the text for a kind that the firmware offers by name.
fn lines_of_named_kind(
    selected: &Selected<'_>,
    axis: &str,
    version: &KlipperVersion,
    mode: Mode,
    kind: Kind,
) -> Result<Told, Refusal> {
    let firmware = version.firmware.name();
    let tolerance = selected
        .axis
        .modes
        .first()
        .map_or(DEFAULT_TOLERANCE, |mode| selected.axis.shaped().tolerance_of(mode));
    let has_tolerance = matches!(kind, Kind::Ei | Kind::TwoHumpEi | Kind::ThreeHumpEi);
    let kind = match kind {
        _ if !has_tolerance || tolerance == DEFAULT_TOLERANCE => kind,
        Kind::Ei if version.has_parameters && (TOLERANCES[0]..=TOLERANCES[1]).contains(&tolerance) => {
            Kind::EiOf { tolerance }
        }
        _ => {
            let of_ei = if version.has_parameters {
                "`ei` alone takes another, from 0.01 to 0.2"
            } else {
                "from Klipper v0.13.0-633 on, `ei` takes another"
            };
            return Err(Refusal::new(
                format!(
                    "{firmware}'s `{}` has a tolerance of {DEFAULT_TOLERANCE}, and this axis {tolerance}",
                    kind.text()
                ),
                format!("leave out `tolerance`, or set it to {DEFAULT_TOLERANCE}; {of_ei}"),
            ));
        }
    };
    let most = version.damping.of(kind);
    if mode.damping > most {
        return Err(Refusal::new(
            format!(
                "{firmware}'s `{}` takes a damping ratio up to {most}, and the mode has {}",
                kind.text(),
                mode.damping
            ),
            "choose zv, mzv or zvd",
        ));
    }
    let read = impulses(kind, version.ei, mode.frequency_hz, mode.damping).ok_or_else(|| {
        Refusal::new(
            format!(
                "{firmware} makes no shaper of `{}` at damping ratio {}",
                kind.text(),
                mode.damping
            ),
            "choose zv, mzv or zvd",
        )
    })?;
    Ok(Told {
        lines: lines(axis, &kind.text(), mode.frequency_hz, mode.damping),
        read: Read::Impulses(read),
    })
}

fn lines(axis: &str, kind: &str, frequency_hz: f64, damping: f64) -> String {
    format!("shaper_type_{axis}: {kind}\nshaper_freq_{axis}: {frequency_hz:?}\ndamping_ratio_{axis}: {damping:?}\n")
}

/// Returns the text for the impulses themselves.
fn custom(selected: &Selected<'_>, axis: &str, firmware: &str) -> Result<Told, Refusal> {
    let design = &selected.tables.design.impulses;
    let few = merged(
        design.impulses(),
        MOST_IMPULSES,
        LEAST_AMPLITUDE,
        1.01 * selected.sample_s,
    );
    let duration_s = few.last().map_or(0.0, |last| last.time_s) - few.first().map_or(0.0, |first| first.time_s);
    if few.len() > MOST_IMPULSES {
        return Err(Refusal::new(
            format!(
                "{firmware} takes up to {MOST_IMPULSES} impulses, and this shaper has {}",
                few.len()
            ),
            "choose a kind with fewer, such as zv for two modes; kind = \"optimal\" with taps = 5 designs one for all modes",
        ));
    }
    if !(DURATION_S[0]..=DURATION_S[1]).contains(&duration_s) {
        return Err(Refusal::new(
            format!(
                "{firmware} takes shapers that last from {} to {} s, and this one lasts {duration_s:.4} s",
                DURATION_S[0], DURATION_S[1]
            ),
            "choose a shorter or a longer kind",
        ));
    }
    let first_s = few.first().map_or(0.0, |first| first.time_s);
    let times_s: Vec<f64> = few.iter().map(|impulse| impulse.time_s - first_s).collect();
    let amplitudes: Vec<f64> = few.iter().map(|impulse| impulse.amplitude).collect();
    let read = few.iter().map(|impulse| posicast_shaper::impulse::Impulse {
        time_s: impulse.time_s - first_s,
        ..*impulse
    });
    let read = ImpulseSequence::new(read.collect())
        .map_err(|error| Refusal::new(format!("these impulses are no shaper: {error}"), "choose another kind"))?;
    Ok(Told {
        lines: format!(
            "shaper_type_{axis}: custom\nshaper_a_{axis}: {}\nshaper_t_{axis}: {}\n",
            list(&amplitudes, ", "),
            list(&times_s, ", ")
        ),
        read: Read::Impulses(read),
    })
}

/// Returns the text for a `smooth_*` kernel as a polynomial.
fn smoother(selected: &Selected<'_>, axis: &str, mode: Mode, kind: ShaperKind) -> Result<Told, Refusal> {
    let tolerance = selected
        .axis
        .modes
        .first()
        .map_or(DEFAULT_TOLERANCE, |mode| selected.axis.shaped().tolerance_of(mode));
    let kernel = Kernel::new(kind, &mode, tolerance).ok();
    let smoother = kernel
        .and_then(|kernel| Smoother::near(&kernel, &mode))
        .ok_or_else(|| {
            Refusal::new(
                "no polynomial is near the kernel of this kind",
                "choose a kind with impulses, such as mzv",
            )
        })?;
    let falling: Vec<f64> = smoother.coefficients.iter().rev().copied().collect();
    Ok(Told {
        lines: format!(
            "shaper_type_{axis}: smoother\nsmooth_time_{axis}: {:?}\ncoeffs_{axis}: {}\n",
            smoother.duration_s,
            list(&falling, ", ")
        ),
        read: Read::Smoother(smoother),
    })
}

/// The firmware's own kinds in this version.
fn own(version: &KlipperVersion) -> Own<'_> {
    let mut kinds = Kind::NAMED.to_vec();
    if version.has_parameters {
        kinds.extend(TRIED_TOLERANCES.map(|tolerance| Kind::EiOf { tolerance }));
        kinds.extend(TRIED_MZV.map(|(impulses, periods)| Kind::MzvOf { impulses, periods }));
    }
    let candidates = kinds.into_iter().map(|kind| OwnKind {
        name: kind.text(),
        damping: [0.0, version.damping.of(kind)],
        frequency_hz: [0.1, 1e4],
        impulses: Box::new(move |frequency_hz, damping| impulses(kind, version.ei, frequency_hz, damping)),
    });
    Own {
        firmware: version.firmware.name(),
        candidates: candidates.collect(),
        default_damping: Some(DEFAULT_DAMPING),
    }
}

fn told_closest(axis: &str, own: &Own<'_>, found: &Closest) -> Told {
    Told {
        lines: lines(
            axis,
            &own.candidates[found.candidate].name,
            found.frequency_hz,
            found.damping,
        ),
        read: Read::Impulses(found.impulses.clone()),
    }
}
