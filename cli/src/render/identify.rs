//! The modes of a log, shapers for them, and the next step.

use crate::table::Table;
use posicast_flow::identify::{Document, RecommendedShaper, WrittenMachine};
use posicast_flow::template::to_measure;
use posicast_flow::text::{percent, shell_word};
use posicast_shaper::unit::{show_seconds, trimmed};
use posicast_testbench::wording::counted;
use std::fmt::Write;

/// Modes, shapers, and the next step.
pub(crate) fn identify(document: &Document) -> String {
    let background = &document.background;
    let mut text = format!(
        "{}: {} over {} at {} samples per second; {}\n{}\n",
        background.log.display(),
        counted(document.rows as u64, "row"),
        show_seconds(background.duration_s, 4),
        trimmed(document.sample_hz, 6),
        background.source,
        background.method,
    );
    if !document.modes.is_empty() {
        text += "\nmodes, with their 95 % intervals\n";
        text += &modes(document);
        let _ = write!(
            text,
            "\nshapers after a jump of the acceleration by {} {}/s², frequencies anywhere in their intervals and ±{} %\n",
            trimmed(background.judgement.acceleration, 4),
            document.si_unit,
            trimmed(100.0 * background.judgement.margin, 4),
        );
        text += &shapers(document);
    }
    if !document.remarks.is_empty() {
        text += "\nremarks\n";
        for remark in &document.remarks {
            let _ = writeln!(text, "  - {remark}");
        }
    }
    match &background.written {
        Some(machine) => text += &written(machine),
        None if !document.modes.is_empty() => {
            text += "\nnext: -o machine.toml writes a machine file with these modes and the first shaper\n";
        }
        None => {}
    }
    text
}

fn written(machine: &WrittenMachine) -> String {
    let mut text = String::new();
    if let Some(other) = &machine.copied_from {
        let _ = write!(
            text,
            "\nthe axis is new in this machine file: its other values are copies of those of axis {other}, so check them\n"
        );
    }
    let file = shell_word(&machine.path);
    let _ = writeln!(
        text,
        "\n{} written\nnext: {}`posicast design {file}`, then `posicast run {file}`",
        machine.path.display(),
        to_measure(&machine.text),
    );
    text
}

fn modes(document: &Document) -> String {
    let mut table = Table::new(&[
        ">frequency Hz",
        ">interval",
        ">damping ratio",
        ">interval",
        ">participation %",
        ">rings with",
        ">share %",
    ]);
    let interval = |[low, high]: [f64; 2], digits| format!("{} … {}", trimmed(low, digits), trimmed(high, digits));
    for mode in &document.modes {
        table.row([
            trimmed(mode.frequency_hz, 5),
            interval(mode.frequency_interval_hz, 6),
            trimmed(mode.damping, 4),
            interval(mode.damping_interval, 4),
            format!("{:.1}", 100.0 * mode.participation),
            document.background.unit.show(mode.ringing_m, 3),
            format!("{:.1}", 100.0 * mode.ringing_share),
        ]);
    }
    table.text("  ")
}

/// The shapers in two tables: those with a small enough residual, the shortest first, and the others.
fn shapers(document: &Document) -> String {
    let enough = trimmed(100.0 * document.background.judgement.enough, 4);
    let all = document.recommended.iter();
    let (few, more): (Vec<_>, Vec<_>) = all.partition(|shaper| shaper.is_enough);
    let mut text = String::new();
    for (title, shapers) in [
        (format!("{enough} % or less is left, the shortest first"), few),
        (format!("more than {enough} % is left"), more),
    ] {
        if !shapers.is_empty() {
            text += &format!("  {title}\n{}", table_of(&shapers, document));
        }
    }
    text
}

fn table_of(shapers: &[&RecommendedShaper], document: &Document) -> String {
    let background = &document.background;
    let mut heads = vec![
        "kind",
        ">duration",
        ">delay",
        ">residual",
        ">of unshaped %",
        ">smoothing",
    ];
    // The rule of printers applies to lengths, and to machines that may take their corners with some acceleration.
    if background.is_printer {
        heads.extend([">max_accel mm/s²", ">smoothing at it"]);
    }
    let show = |figure: f64| background.unit.show(figure, 3);
    let mut table = Table::new(&heads);
    for shaper in shapers {
        let mut row = vec![
            shaper.kind.to_owned(),
            show_seconds(shaper.duration_s, 3),
            show_seconds(shaper.delay_s, 3),
            show(shaper.residual_displacement_m),
            percent(shaper.residual_displacement_m / shaper.unshaped_displacement_m),
            show(shaper.smoothing_m),
        ];
        if background.is_printer {
            let most = shaper.max_accel_mm_s2.map(|most| format!("{:.0}", most.floor()));
            row.extend([most, shaper.corner_smoothing_m.map(show)].into_iter().flatten());
        }
        table.row(row);
    }
    table.text("    ")
}
