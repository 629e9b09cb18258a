//! The certificate of an axis's table.

use crate::table::Table;
use posicast_flow::design::{Certificate, CertifiedMode, LeastDuration};
use posicast_flow::text::percent;
use posicast_testbench::wording::counted;
use std::fmt::Write;

/// The bounds of the modes, and what is known about shorter shapers.
pub(super) fn certified(certificate: &Certificate, sample_hz: f64) -> String {
    let mut text = String::new();
    if !certificate.modes.is_empty() {
        let mut table = Table::new(&[
            "mode from Hz",
            ">to Hz",
            ">damping from",
            ">to",
            ">tolerance %",
            ">certified %",
            ">found %",
            ">at Hz",
            "",
        ]);
        certificate.modes.iter().for_each(|mode| table.row(row(mode)));
        let _ = write!(
            text,
            "\n  certified: nowhere in these bands do the integer taps leave more\n{}",
            table.text("  ")
        );
    }
    if let Some(shorter) = &certificate.shorter {
        text += &least(shorter);
        text += &costs(shorter, sample_hz);
    }
    text
}

fn row(mode: &CertifiedMode) -> [String; 9] {
    let ([low_hz, high_hz], [least, most]) = (mode.frequency_hz, mode.damping);
    [
        format!("{low_hz:.3}"),
        format!("{high_hz:.3}"),
        format!("{least:.4}"),
        format!("{most:.4}"),
        percent(mode.tolerance),
        percent(mode.certified_residual),
        percent(mode.found_residual),
        format!("{:.3}", mode.found_at.frequency_hz),
        if mode.holds { "" } else { "above the tolerance" }.into(),
    ]
}

/// The least duration, and its proof.
fn least(shorter: &LeastDuration) -> String {
    let least = shorter.least_samples;
    let milliseconds = shorter.least_duration_s * 1e3;
    match &shorter.checked {
        Some(Ok(bound)) if bound.points == 0 => format!(
            "\n  least duration {least} samples, {milliseconds:.4} ms. Proof, checked: amplitudes within the bounds on at most {} samples do not \
             sum to 1\n",
            bound.samples + 1,
        ),
        Some(Ok(bound)) => format!(
            "\n  least duration {least} samples, {milliseconds:.4} ms. Proof, checked: every shaper of at most {} samples leaves, at one of {} of \
             the bands, at least {:.6} of what is tolerated there\n",
            bound.samples,
            counted(bound.points as u64, "point"),
            bound.ratio,
        ),
        Some(Err(error)) => {
            format!("\n  shortest found {least} samples, {milliseconds:.4} ms; not proven to be the least: {error}\n")
        }
        None => format!("\n  shortest found {least} samples, {milliseconds:.4} ms; not proven to be the least\n"),
    }
}

/// How much longer the design is, and why.
fn costs(shorter: &LeastDuration, sample_hz: f64) -> String {
    let more = shorter.samples.saturating_sub(shorter.least_samples);
    if shorter.is_together {
        "  this is about the axis alone; its taps are those of the joint design below\n".to_owned()
    } else if more > 0 {
        format!(
            "  the limit of {} costs {} more, {:.4} ms\n",
            counted(shorter.most_taps as u64, "tap"),
            counted(u64::from(more), "sample"),
            f64::from(more) / sample_hz * 1e3,
        )
    } else {
        String::new()
    }
}
