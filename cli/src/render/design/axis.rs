//! The shaper of one axis: impulses, modes, taps, and what else belongs to the axis.

use super::{certificate, family};
use crate::table::Table;
use posicast_flow::design::{Control, DesignAxis, DesignErrorTable, Mechanics, Quantised, StabilityMargins};
use posicast_flow::text::percent;
use posicast_machine::unit::AxisUnit;
use posicast_shaper::analysis::INSENSITIVITY_LIMIT;
use posicast_shaper::unit::{show_seconds, trimmed};
use posicast_testbench::wording::counted;
use std::fmt::Write;

/// The section of an axis.
pub(super) fn section(axis: &DesignAxis) -> String {
    let unit = axis.unit.of_axis();
    let mut text = format!(
        "axis {}: {}, {}, duration {:.4} ms, delay {:.4} ms, partial sums {:.4} … {:.4}\n",
        axis.name,
        axis.kind,
        counted(axis.impulses.len() as u64, "impulse"),
        axis.duration_s * 1e3,
        axis.delay_s * 1e3,
        axis.partial_sum_min,
        axis.partial_sum_max,
    );
    let mut table = Table::new(&["", ">time ms", ">amplitude"]);
    for impulse in &axis.impulses {
        table.row([
            String::new(),
            format!("{:.6}", impulse.time_s * 1e3),
            format!("{:.6}", impulse.amplitude),
        ]);
    }
    text += &table.text("  ");
    text += &findings(axis);
    text += &modes(axis);
    text += &convolution(axis);
    text += &taps(axis);
    if let Some(certificate) = &axis.certificate {
        text += &certificate::certified(certificate, axis.quantised.sample_hz);
    }
    if let Some(family) = &axis.family {
        text += &family::tables(family, unit);
    }
    if let Some(table) = &axis.error_table {
        text += &error_table(table, unit);
    }
    if let Some(reason) = &axis.quantised.misfit {
        let _ = writeln!(text, "  does not fit: {reason}");
    }
    if let Some(control) = &axis.control {
        text += &controller(control, unit);
    }
    text
}

/// Further results of a kind that treats all modes together; the certificate has those of `optimal`.
fn findings(axis: &DesignAxis) -> String {
    let mut text = String::new();
    if let (Some(system_hz), Some(solutions)) = (axis.system_hz, &axis.solutions) {
        let _ = writeln!(text, "\n  periodic at {system_hz:.6} Hz; all solutions:");
        let mut table = Table::new(&["", ">from Hz", ">to Hz", "odd multiples"]);
        for solution in solutions {
            let multiples = solution.n.iter().map(|n| (2 * n + 1).to_string());
            table.row([
                String::new(),
                format!("{:.6}", solution.low_hz),
                format!("{:.6}", solution.high_hz),
                multiples.collect::<Vec<_>>().join(", "),
            ]);
        }
        text += &table.text("  ");
    }
    for class in axis.classes.iter().flatten() {
        let modes: Vec<String> = class.modes.iter().map(usize::to_string).collect();
        let odd: Vec<String> = class.multiples.iter().map(u64::to_string).collect();
        let _ = writeln!(
            text,
            "\n  antisymmetric modes {}: {} times {:.6} Hz, within {:.2e} of each",
            modes.join(", "),
            odd.join(", "),
            class.divisor_hz,
            class.ratio_error,
        );
    }
    match axis.time_optimal {
        None => {}
        Some(true) => text += "\n  no command within the same bounds is shorter\n",
        Some(false) => text += "\n  the shortest found, not proven to be the shortest\n",
    }
    text
}

fn modes(axis: &DesignAxis) -> String {
    if axis.modes.is_empty() {
        return "\n  no modes given: no residual to state\n".to_owned();
    }
    let headings = [
        "mode Hz",
        ">damping",
        ">residual %",
        ">quantised %",
        ">tolerance %",
        "insensitivity f/f0",
    ];
    let mut table = Table::new(&headings);
    for (mode, quantised) in axis.modes.iter().zip(&axis.quantised.modes) {
        let range = match mode.insensitivity {
            None => "none: the residual exceeds the tolerance".to_owned(),
            Some((low, Some(high))) => format!("{low:.4} … {high:.4}"),
            Some((low, None)) => format!("{low:.4} … above {INSENSITIVITY_LIMIT}"),
        };
        table.row([
            format!("{:.3}", mode.frequency_hz),
            format!("{:.4}", mode.damping),
            percent(mode.residual),
            percent(quantised.residual),
            percent(mode.tolerance),
            range,
        ]);
    }
    let mut text = format!("\n{}", table.text("  "));
    // All modes of an axis have the mechanics of its one screw.
    let mechanics = axis.modes.first().and_then(|mode| mode.mechanics.as_ref());
    text += &mechanics.map_or_else(String::new, screw);
    for (index, mode) in axis.modes.iter().enumerate() {
        if let Some(free) = &mode.free {
            let _ = writeln!(
                text,
                "  mode {}: measured with the motor free at {:.3} Hz, damping {:.4}; designed for the motor held, {:.3} Hz and {:.4}",
                index + 1,
                free.frequency_hz,
                free.damping,
                mode.frequency_hz,
                mode.damping,
            );
        }
    }
    text
}

/// Where the mode of `[axis.mechanics]` comes from.
fn screw(mechanics: &Mechanics) -> String {
    let between = format!(
        "mode 1: from [axis.mechanics], {} N/µm between motor and table, table {} kg, motor and screw {} kg·m² ({} kg at the table)",
        trimmed(mechanics.stiffness_n_per_m / 1e6, 4),
        trimmed(mechanics.table_mass_kg, 4),
        trimmed(mechanics.turning_inertia_kg_m2, 4),
        trimmed(mechanics.motor_mass_kg, 4),
    );
    let other = &mechanics.other_way;
    let other = format!("{:.3} Hz and {:.4}", other.frequency_hz, other.damping);
    match mechanics.motor {
        "free" => format!("  {between}; the motor free, as behind a torque drive; held it would be {other}\n"),
        _ => format!("  {between}; the motor held; free it would be {other}\n"),
    }
}

/// The effect of the modes' shapers on each other, if there are several.
fn convolution(axis: &DesignAxis) -> String {
    let mut text = String::new();
    if !axis.cross_gains.is_empty() {
        let mut table = Table::new(&["shaper", ">for mode Hz", ">at mode Hz", ">gain"]);
        for cross in &axis.cross_gains {
            table.row([
                cross.kind.to_owned(),
                format!("{:.3}", cross.shaper_hz),
                format!("{:.3}", cross.at_hz),
                format!("{:.4}", cross.gain),
            ]);
        }
        let _ = write!(
            text,
            "\n  peak command {:.4} of a step; gain of each shaper at the other modes\n{}",
            axis.peak_command,
            table.text("  ")
        );
    }
    for warning in &axis.placed_warnings {
        let _ = writeln!(text, "\n  warning: {warning}");
    }
    text
}

fn taps(axis: &DesignAxis) -> String {
    let quantised = &axis.quantised;
    if !quantised.half_sums_samples.is_empty() {
        return half_sums(quantised);
    }
    let mut table = Table::new(&["", ">delay", ">coefficient"]);
    for tap in &quantised.taps {
        table.row([
            String::new(),
            tap.delay_samples.to_string(),
            tap.coefficient.to_string(),
        ]);
    }
    format!(
        "\n  {} at {} Hz, digitised {}, sum {}\n{}",
        counted(quantised.taps.len() as u64, "tap"),
        quantised.sample_hz,
        quantised.digitise,
        quantised.taps.iter().map(|tap| i64::from(tap.coefficient)).sum::<i64>(),
        table.text("  ")
    )
}

/// A cascade by its half sums: the impulses are many, and no table in the hardware.
fn half_sums(quantised: &Quantised) -> String {
    let delays: Vec<String> = quantised.half_sums_samples.iter().map(u32::to_string).collect();
    format!(
        "\n  cascade of {} at {} Hz, delayed by {} samples: as {}\n",
        counted(delays.len() as u64, "half sum"),
        quantised.sample_hz,
        delays.join(", "),
        counted(quantised.taps.len() as u64, "tap"),
    )
}

fn error_table(table: &DesignErrorTable, unit: AxisUnit) -> String {
    let show = |counts: f64| unit.show(counts / table.counts_per_si, 3);
    format!(
        "\n  error table, at the {}: {} of up to {} in {} entries, {} apart; at most {} off the file\n",
        table.apply,
        counted(table.points as u64, "point"),
        show(table.largest_error_counts),
        table.entries,
        show(f64::from(table.spacing_counts)),
        show(table.departure_counts),
    )
}

fn controller(control: &Control, unit: AxisUnit) -> String {
    format!(
        "\n  controller {}: loop lag {}, friction leaves {} of error\n  {}\n",
        control.law,
        show_seconds(control.lag_s, 4),
        unit.show(control.steady_error, 3),
        stability(&control.margins)
    )
}

fn stability(margins: &StabilityMargins) -> String {
    let without = || "without limit".to_owned();
    let figure = |value: Option<f64>, digits: usize, unit: &str| {
        value.map_or_else(without, |value| format!("{value:.digits$} {unit}"))
    };
    format!(
        "stability of the sampled loop on this machine: gain margin {}, phase margin {}, delay margin {}, modulus margin {:.2}, \
         crossover at {}",
        figure(margins.gain_margin_db, 1, "dB"),
        figure(margins.phase_margin_deg, 0, "degrees"),
        margins
            .delay_margin_s
            .map_or_else(without, |time_s| show_seconds(time_s, 3)),
        margins.modulus_margin,
        figure(margins.crossover_hz, 2, "Hz"),
    )
}
