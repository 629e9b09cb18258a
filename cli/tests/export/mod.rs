//! `export`: what the reader of each format makes of the text, and what that leaves.
//!
//! The readers ([`readers`]) are written from the firmware's sources and documentation, not from the writer; what Klipper makes of a kind was computed by its own code
//! (`klipper.txt`). Residuals are computed here, from impulses, by their definition.

#![cfg(test)]

mod closest;
mod firmware;
mod place;
mod readers;
mod tables;
mod versions;

use crate::cli::support::{json, posicast};
use readers::Impulses;
use std::f64::consts::PI;
use std::path::Path;

/// The six damping ratios with which every kind is exported.
pub(crate) const DAMPINGS: [f64; 6] = [0.0, 0.02, 0.06, 0.1, 0.15, 0.2];

/// Runs the command, which must succeed.
pub(crate) fn export(machine: &Path, words: &[&str]) -> String {
    let output = posicast().arg("export").arg(machine).args(words).output().unwrap();
    assert_eq!(
        output.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    String::from_utf8(output.stdout).unwrap()
}

/// Runs the command, which must end with exit status 2 and print nothing: what it says, in one line.
pub(crate) fn refused(machine: &Path, words: &[&str]) -> String {
    let output = posicast().arg("export").arg(machine).args(words).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{words:?}: {said}");
    assert!(output.stdout.is_empty(), "{words:?}");
    let said = said.replace("\n  │ ", " ").replace("help: ", "");
    said.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The impulses of an axis as `design --json` has them.
pub(crate) fn designed(machine: &Path, axis: usize) -> Impulses {
    let output = posicast().arg("design").arg(machine).arg("--json").output().unwrap();
    let document = json(&output.stdout);
    let impulses = document["axes"][axis]["impulses"].as_array().unwrap();
    let number = |impulse: &serde_json::Value, key: &str| impulse[key].as_f64().unwrap();
    impulses
        .iter()
        .map(|impulse| [number(impulse, "time_s"), number(impulse, "amplitude")])
        .collect()
}

/// What impulses leave of the vibration of a mode, measured at the last of them.
pub(crate) fn residual(impulses: &[[f64; 2]], frequency_hz: f64, damping: f64) -> f64 {
    let omega = 2.0 * PI * frequency_hz;
    let damped = omega * (1.0 - damping * damping).sqrt();
    let last = impulses.last().unwrap()[0];
    let part = |of: fn(f64) -> f64| -> f64 {
        impulses
            .iter()
            .map(|[time, amplitude]| amplitude * (damping * omega * (time - last)).exp() * of(damped * time))
            .sum()
    };
    part(f64::sin).hypot(part(f64::cos))
}

/// A printer with these axes, each with a shaper and modes.
pub(crate) fn printer(axes: &[(&str, &str, &str)]) -> String {
    let mut text = "name = \"p\"\n[clock]\nfrequency_hz = 50_000_000\nsample_hz = 10_000\n".to_owned();
    for (name, shaper, modes) in axes {
        text += &format!(
            "[[axis]]\nname = \"{name}\"\nunit = \"m\"\ncounts_per_unit = 80_000\n[axis.shaper]\n{shaper}\n{modes}\n"
        );
    }
    text
}

/// A mode as a table of the machine file.
pub(crate) fn mode(frequency_hz: f64, damping: f64) -> String {
    format!("[[axis.mode]]\nfrequency_hz = {frequency_hz:?}\ndamping = {damping:?}")
}
