//! RepRapFirmware's `M593 P"custom"`: one shaper for all axes.

use super::super::{Selected, Selection, list};
use super::nearest::Own;
use super::{Read, Refusal, Wish, heading, of_version, residuals};
use crate::failure::Failure;
use posicast_shaper::axis::DEFAULT_TOLERANCE;
use posicast_shaper::design::kind::ShaperKind;
use posicast_shaper::design::{ModeSettings, design_mode};
use posicast_shaper::firmware::closest::OwnKind;
use posicast_shaper::firmware::merge::merged;
use posicast_shaper::firmware::reprapfirmware::{FREQUENCY_HZ, Form, MOST_IMPULSES};
use posicast_shaper::firmware::version::{self, Firmware};
use posicast_shaper::impulse::{Impulse, ImpulseSequence};
use posicast_shaper::mode::Mode;
use std::cell::RefCell;
use std::collections::HashMap;
use std::fmt::Write;

/// Kinds whose impulses are tried: positive ones of two to five impulses.
const KINDS: [ShaperKind; 8] = [
    ShaperKind::Zv,
    ShaperKind::Mzv,
    ShaperKind::Zvd,
    ShaperKind::Ei,
    ShaperKind::Zvdd,
    ShaperKind::TwoHumpEi,
    ShaperKind::Zvddd,
    ShaperKind::ThreeHumpEi,
];
/// Largest damping ratio that is tried.
const MOST_DAMPING: f64 = 0.3;

/// `M593` with the impulses of the design.
pub(crate) fn reprapfirmware(selection: &Selection<'_>, wish: &Wish<'_>) -> Result<String, Failure> {
    let (form, version) =
        version::reprapfirmware(wish.version).map_err(|error| of_version(Firmware::RepRapFirmware, &error))?;
    let Some(first) = selection.axes.first() else {
        return Ok(String::new());
    };
    let own = own();
    let all: Vec<&Selected<'_>> = selection.axes.iter().collect();
    let mut text = heading(selection, ";", &version);
    let shared = shared(selection, form);
    let is_closest = shared.is_err();
    let impulses = match shared {
        Ok(impulses) => impulses,
        Err((_, refusal)) if wish.closest => {
            let found = own.search(&all).ok_or_else(|| own.refuse(&refusal, &all))?;
            let _ = writeln!(text, "; {}", found.line);
            found.best[0].impulses.impulses().to_vec()
        }
        Err((selected, refusal)) => {
            let failure = own.refuse(&refusal, &all);
            // The message begins with the axis that differs, not with the first one.
            return Err(if selected.axis.name == first.axis.name {
                failure
            } else {
                own.refuse(
                    &Refusal {
                        has_own: true,
                        ..refusal
                    },
                    &reordered(&all, selected),
                )
            });
        }
    };
    let command = command(form, &impulses);
    for selected in &selection.axes {
        let rounded = impulses.iter().map(|impulse| Impulse {
            time_s: form.rounded_s(impulse.time_s),
            ..*impulse
        });
        // Impulses closer than a step clock would coincide; then the designed sequence is the better approximation.
        let read = ImpulseSequence::new(rounded.collect()).unwrap_or_else(|_| selected.tables.design.impulses.clone());
        let _ = writeln!(
            text,
            "; {}: {}",
            selected.title(),
            residuals(selected, &Read::Impulses(read), "RepRapFirmware", is_closest)
        );
    }
    text += match form {
        Form::Sums => {
            "; H: sum of the amplitudes so far, after each impulse but the last. T: seconds from each impulse to the next.\n"
        }
        Form::Amplitudes => {
            "; H: amplitude of each impulse but the last, which is 1 minus their sum. T: seconds from the first impulse.\n"
        }
    };
    let times_s: Vec<f64> = impulses.iter().map(|impulse| impulse.time_s).collect();
    let _ = writeln!(text, "; Impulses in seconds: {}", list(&times_s, ", "));
    Ok(text + &command)
}

/// Returns the axes, starting with this one.
fn reordered<'a, 'b>(all: &[&'a Selected<'b>], first: &'a Selected<'b>) -> Vec<&'a Selected<'b>> {
    let others = all
        .iter()
        .copied()
        .filter(|selected| selected.axis.name != first.axis.name);
    std::iter::once(first).chain(others).collect()
}

/// Returns the impulses that all axes share; otherwise the axis that differs, and the reason for the refusal.
fn shared<'a, 'b>(selection: &'a Selection<'b>, form: Form) -> Result<Vec<Impulse>, (&'a Selected<'b>, Refusal)> {
    let first = &selection.axes[0];
    let differs = |other: &&Selected<'_>| other.columns() != first.columns();
    if let Some(other) = selection.axes.iter().find(differs) {
        return Err((
            other,
            Refusal::new(
                format!(
                    "RepRapFirmware has one shaper for all axes, and this one differs from that of `{}`",
                    first.axis.name
                ),
                "choose with --axis the axis whose shaper all axes should have",
            ),
        ));
    }
    let impulses = merged(
        first.tables.design.impulses.impulses(),
        MOST_IMPULSES,
        0.0,
        1.01 * first.sample_s,
    );
    if impulses.len() > MOST_IMPULSES {
        return Err((
            first,
            Refusal::new(
                format!(
                    "RepRapFirmware takes 2 to {MOST_IMPULSES} impulses, and this shaper has {}",
                    impulses.len()
                ),
                "choose a kind with fewer impulses, such as zvd, zvddd or three-hump-ei for one mode; kind = \"optimal\" with taps = 5 designs one \
                 for all modes",
            ),
        ));
    }
    if let Some(negative) = impulses.iter().find(|impulse| impulse.amplitude < 0.0) {
        return Err((
            first,
            Refusal::new(
                format!(
                    "RepRapFirmware takes no negative impulses, and this shaper has one of {:.4}",
                    negative.amplitude
                ),
                "choose a kind with positive impulses, such as zv, zvd, mzv or ei",
            ),
        ));
    }
    if let ([_, second], Form::Amplitudes) = (impulses.as_slice(), form) {
        let frequency_hz = 0.5 / second.time_s;
        if !(FREQUENCY_HZ[0]..=FREQUENCY_HZ[1]).contains(&frequency_hz) {
            return Err((
                first,
                Refusal::new(
                    format!(
                        "RepRapFirmware takes two impulses that are half a period of {:.2} to {} Hz apart, and this shaper has {frequency_hz:.2} Hz",
                        FREQUENCY_HZ[0], FREQUENCY_HZ[1]
                    ),
                    "choose a kind with three impulses, such as zvd",
                ),
            ));
        }
    }
    Ok(impulses)
}

/// The line for the firmware.
fn command(form: Form, impulses: &[Impulse]) -> String {
    let times_s: Vec<f64> = impulses.iter().map(|impulse| impulse.time_s).collect();
    let amplitudes: Vec<f64> = impulses.iter().map(|impulse| impulse.amplitude).collect();
    let digits = |numbers: &[f64]| {
        let texts: Vec<String> = numbers.iter().map(|number| format!("{number:.7}")).collect();
        texts.join(":")
    };
    let [h, t] = form.numbers(&times_s, &amplitudes);
    match (impulses, form) {
        ([] | [_], _) => "M593 P\"none\"\n".into(),
        // From version 3.6 on, a single time would be taken for four; F and S have the same effect.
        ([_, second], Form::Amplitudes) => {
            format!("M593 P\"custom\" F{:.5} S0 H{}\n", 0.5 / second.time_s, digits(&h))
        }
        _ => format!("M593 P\"custom\" H{} T{}\n", digits(&h), digits(&t)),
    }
}

/// Kinds of posicast with no more impulses than the firmware accepts, at any frequency.
fn own() -> Own<'static> {
    let candidates = KINDS.map(|kind| {
        // A kind at another frequency is the same sequence, shorter or longer.
        let of_one_hz: RefCell<HashMap<u64, Option<ImpulseSequence>>> = RefCell::default();
        OwnKind {
            name: kind.name().into(),
            damping: [0.0, MOST_DAMPING],
            frequency_hz: [1.0, 1e4],
            impulses: Box::new(move |frequency_hz: f64, damping: f64| {
                let mut designed = of_one_hz.borrow_mut();
                let unit = designed.entry(damping.to_bits()).or_insert_with(|| {
                    let settings = ModeSettings {
                        tolerance: DEFAULT_TOLERANCE,
                        order: 1,
                        epsilon: DEFAULT_TOLERANCE,
                    };
                    let mode = Mode {
                        frequency_hz: 1.0,
                        damping,
                    };
                    design_mode(kind, &mode, &settings).ok()
                });
                let scaled = unit.as_ref()?.impulses().iter().map(|impulse| Impulse {
                    time_s: impulse.time_s / frequency_hz,
                    ..*impulse
                });
                ImpulseSequence::new(scaled.collect()).ok()
            }),
        }
    });
    Own {
        firmware: "RepRapFirmware",
        candidates: candidates.into_iter().collect(),
        default_damping: None,
    }
}
