//! Text that `identify` prints for people.

use super::findings::Findings;
use super::machine_file::Written;
use crate::template::{MachineKind, to_measure};
use crate::text::{Table, percent, shell_word};
use posicast_identify::recommend::Recommendation;
use posicast_identify::{FoundMode, Interval};
use posicast_shaper::unit::{show_seconds, trimmed};
use posicast_testbench::wording::counted;
use std::fmt::Write;
use std::path::Path;

/// Modes, shapers, and the next step.
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
            "\nshapers after a jump of the acceleration by {} {}/s², frequencies anywhere in their intervals and ±{} %\n",
            trimmed(findings.judgement.acceleration, 4),
            findings.unit.si_name(),
            trimmed(100.0 * findings.judgement.margin, 4),
        );
        text += &shapers(findings);
    }
    if !findings.remarks.is_empty() {
        text += "\nremarks\n";
        for remark in &findings.remarks {
            let _ = writeln!(text, "  - {remark}");
        }
    }
    if let Some((path, machine)) = written {
        let file = shell_word(path);
        if let Some(other) = &machine.copied_from {
            let _ = write!(
                text,
                "\nthe axis is new in this machine file: its other values are copies of those of axis {other}, so check them\n"
            );
        }
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
        ">participation %",
        ">rings with",
        ">share %",
    ]);
    let interval =
        |interval: Interval, digits| format!("{} … {}", trimmed(interval.low, digits), trimmed(interval.high, digits));
    let ringing = |found: &FoundMode| found.ringing(findings.judgement.acceleration);
    let whole: f64 = findings.modes.iter().map(ringing).sum();
    for found in &findings.modes {
        table.row([
            trimmed(found.mode.frequency_hz, 5),
            interval(found.frequency_interval_hz(), 6),
            trimmed(found.mode.damping, 4),
            interval(found.damping_interval(), 4),
            format!("{:.1}", 100.0 * found.participation),
            findings.unit.show(ringing(found), 3),
            format!("{:.1}", 100.0 * ringing(found) / whole),
        ]);
    }
    table.text("  ")
}

/// The shapers in two tables: those with a small enough residual, the shortest first, and the others.
fn shapers(findings: &Findings) -> String {
    let enough = trimmed(100.0 * findings.judgement.enough, 4);
    let (few, more): (Vec<_>, Vec<_>) = findings
        .recommended
        .iter()
        .partition(|shaper| findings.judgement.is_enough(shaper));
    let mut text = String::new();
    for (title, shapers) in [
        (format!("{enough} % or less is left, the shortest first"), few),
        (format!("more than {enough} % is left"), more),
    ] {
        if !shapers.is_empty() {
            text += &format!("  {title}\n{}", table_of(&shapers, findings));
        }
    }
    text
}

fn table_of(shapers: &[&Recommendation], findings: &Findings) -> String {
    let mut heads = vec![
        "kind",
        ">duration",
        ">delay",
        ">residual",
        ">of unshaped %",
        ">smoothing",
    ];
    // The rule of printers applies to lengths, and to machines that may take their corners with some acceleration.
    let is_printer = findings.unit.si_name() == "m" && findings.kind() == MachineKind::Printer;
    if is_printer {
        heads.extend([">max_accel mm/s²", ">smoothing at it"]);
    }
    let mut table = Table::new(&heads);
    for shaper in shapers {
        let mut row = vec![
            shaper.kind.name().to_owned(),
            show_seconds(shaper.impulses.duration_s(), 3),
            show_seconds(shaper.impulses.delay_s(), 3),
            findings.unit.show(shaper.residual_displacement, 3),
            percent(shaper.ratio()),
            findings.unit.show(shaper.smoothing, 3),
        ];
        if is_printer {
            row.push(format!("{:.0}", (1e3 * shaper.max_acceleration).floor()));
            row.push(findings.unit.show(shaper.smoothing_in_corners(), 3));
        }
        table.row(row);
    }
    table.text("    ")
}
