//! Text that `identify` prints for people.

use super::findings::Findings;
use super::machine_file::Written;
use crate::new::to_measure;
use crate::output::{Table, percent, shell_word};
use posicast_identify::Interval;
use posicast_model::unit::{show_seconds, trimmed};
use posicast_testbench::wording::counted;
use std::fmt::Write;
use std::path::Path;

/// Modes, shapers, and what to do next.
pub(super) fn text(log: &Path, findings: &Findings, written: Option<(&Path, &Written)>) -> String {
    let mut text = format!(
        "{}: {} over {} at {} samples per second; {}\n{}\n",
        log.display(),
        counted(findings.rows as u64, "row"),
        show_seconds(findings.rows as f64 * findings.sample_s, 4),
        trimmed(1.0 / findings.sample_s, 6),
        findings.source,
        findings.method,
    );
    if !findings.modes.is_empty() {
        text += "\nmodes, with their 95 % intervals\n";
        text += &modes(findings);
        let _ = write!(
            text,
            "\nshapers after a jump of the acceleration by {} {}/s², frequencies anywhere in their intervals and ±{} %: first the \
             shortest that leave {} % at most\n",
            trimmed(findings.judgement.acceleration, 4),
            findings.unit.si_name(),
            trimmed(100.0 * findings.judgement.margin, 4),
            trimmed(100.0 * findings.judgement.enough, 4),
        );
        text += &shapers(findings);
    }
    if !findings.remarks.is_empty() {
        text += "\nto be known\n";
        for remark in &findings.remarks {
            let _ = writeln!(text, "  - {remark}");
        }
    }
    if let Some((path, machine)) = written {
        let file = shell_word(path);
        let _ = writeln!(
            text,
            "\n{} written\nnext: {}`posicast design {file}`, then `posicast run {file}`",
            path.display(),
            to_measure(&machine.text),
        );
    } else if !findings.modes.is_empty() {
        text += "\nnext: -o machine.toml writes a machine file with these modes and the first shaper\n";
    }
    text
}

fn modes(findings: &Findings) -> String {
    let mut table = Table::new(&[
        ">frequency Hz",
        ">interval",
        ">damping ratio",
        ">interval",
        ">share of the displacement %",
    ]);
    let interval =
        |interval: Interval, digits| format!("{} … {}", trimmed(interval.low, digits), trimmed(interval.high, digits));
    for found in &findings.modes {
        table.row([
            trimmed(found.mode.frequency_hz, 5),
            interval(found.frequency_interval_hz(), 6),
            trimmed(found.mode.damping, 4),
            interval(found.damping_interval(), 4),
            format!("{:.1}", 100.0 * found.participation),
        ]);
    }
    table.text("  ")
}

fn shapers(findings: &Findings) -> String {
    let mut table = Table::new(&[
        "kind",
        ">duration",
        ">delay",
        ">residual",
        ">of unshaped %",
        ">smoothing",
    ]);
    for shaper in &findings.recommended {
        table.row([
            shaper.kind.name().to_owned(),
            show_seconds(shaper.impulses.duration_s(), 3),
            show_seconds(shaper.impulses.delay_s(), 3),
            findings.unit.show(shaper.residual_displacement, 3),
            percent(shaper.ratio()),
            findings.unit.show(shaper.smoothing, 3),
        ]);
    }
    table.text("  ")
}
