//! The shapers of a machine: a section for each axis, then the delays of the stage, the durations and the moves.

mod axis;
mod certificate;
mod family;
mod moves;

use crate::table::Table;
use posicast_flow::design::{Document, EqualDelays, Front, Together};
use posicast_flow::text::percent;
use posicast_machine::unit::AxisUnit;
use posicast_shaper::certify::CheckedShorter;
use posicast_shaper::unit::show_seconds;
use posicast_testbench::wording::counted;
use std::fmt::Write;

/// The sections of the axes, and what concerns several axes.
pub(crate) fn design(document: &Document) -> String {
    let clocking = &document.clocking;
    let mut text = format!(
        "{}: {}, {} MHz clock, {} Hz samples, coefficients with {} fraction bits\n",
        document.name,
        counted(document.axes.len() as u64, "axis"),
        clocking.clock_hz / 1e6,
        clocking.sample_hz,
        clocking.coefficient_fraction,
    );
    for axis in &document.axes {
        text.push('\n');
        text += &axis::section(axis);
    }
    if let Some(stage) = &document.stage {
        text += &delays(document, stage);
        text += &stage
            .together
            .as_ref()
            .map_or_else(String::new, |joint| together(document, joint));
    }
    text += &inline(document);
    text.extend(document.fronts.iter().map(front));
    text.extend(document.moves.iter().map(moves::compared));
    text
}

/// Delays and rates of an inline shaper.
fn inline(document: &Document) -> String {
    if document.inline.is_empty() {
        return String::new();
    }
    let headings = [
        "axis",
        ">steps/s at most",
        ">of the drive's lines",
        ">overshoot",
        ">delay ms",
        ">bypassed ms",
        ">at rest after ms",
    ];
    let mut table = Table::new(&headings);
    for axis in &document.inline {
        table.row([
            axis.axis.clone(),
            format!("{:.0}", axis.input_hz),
            format!("{:.0}", axis.output_hz),
            format!("{:.2}", axis.overshoot),
            format!("{:.3}", axis.shaped_s * 1e3),
            format!("{:.3}", axis.unshaped_s * 1e3),
            format!("{:.1}", axis.settle_s * 1e3),
        ]);
    }
    format!(
        "\ninline shaper: from the controller's steps to those of the drive\n{}",
        table.text("  ")
    )
}

/// The parts of each axis's delay, and the remaining mismatch.
fn delays(document: &Document, stage: &EqualDelays) -> String {
    let headings = [
        "axis",
        ">shaper ms",
        ">mode lag ms",
        ">added samples",
        ">total ms",
        ">rounding ns",
    ];
    let mut table = Table::new(&headings);
    for axis in &document.axes {
        if let Some(delay) = &axis.delay {
            table.row([
                axis.name.clone(),
                format!("{:.6}", delay.shaper_s * 1e3),
                format!("{:.6}", delay.mode_lag_s * 1e3),
                format!("{:.4}", delay.added_samples),
                format!("{:.6}", delay.total_s * 1e3),
                format!("{:.2}", delay.rounding_s * 1e9),
            ]);
        }
    }
    let mut text = format!(
        "\nstage: every axis {:.6} ms late\n{}",
        stage.total_delay_s * 1e3,
        table.text("  ")
    );
    let first = document.axes.first();
    let unit = first.map_or(AxisUnit::default(), |axis| axis.unit.of_axis());
    let mismatch = show_seconds(stage.mismatch_s, 3);
    let _ = match stage.contour_speed {
        Some(speed) => writeln!(
            text,
            "  mismatch {mismatch}, {} at {}",
            unit.show(stage.mismatch_s * speed, 3),
            unit.show_round(speed, "/s")
        ),
        None => writeln!(text, "  mismatch {mismatch}"),
    };
    text
}

/// The joint design of the axes, with its proofs.
fn together(document: &Document, together: &Together) -> String {
    let axis = |index: usize| document.axes.get(index).map_or("", |axis| &axis.name);
    let milliseconds = |samples: f64| 1e3 * samples / together.sample_hz;
    let mut text = format!(
        "\ndesigned together: least common duration {} samples, {:.4} ms; delay of every axis {:.6} ms\n",
        together.samples,
        milliseconds(f64::from(together.samples)),
        milliseconds(together.delay_samples),
    );
    let _ = match &together.checked.shorter {
        Some(Ok(CheckedShorter::Alone { axis: index, bound })) => writeln!(
            text,
            "  proof, checked: axis {} has no shaper of at most {} samples, whatever its delay",
            axis(*index),
            bound.samples
        ),
        Some(Ok(CheckedShorter::Apart {
            samples,
            late_axis,
            early_axis,
            gap_samples,
        })) => writeln!(
            text,
            "  proof, checked: with at most {samples} samples, the earliest that axis {} can be is {gap_samples:.4} samples later than \
             the latest that axis {} can be",
            axis(*late_axis),
            axis(*early_axis)
        ),
        Some(Err(error)) => writeln!(text, "  not proven to be the least duration: {error}"),
        None => writeln!(text, "  not proven to be the least duration"),
    };
    let decisive = &together.decisive_axis;
    let _ = match &together.checked.least_delay_samples {
        Some(Ok(least)) => writeln!(
            text,
            "  proof, checked: every shaper of axis {decisive} of this duration is at least {:.6} ms late; the design keeps a part of the \
             tolerance for rounding",
            milliseconds(*least)
        ),
        Some(Err(error)) => writeln!(
            text,
            "  axis {decisive} decides the delay; not proven to be the least: {error}"
        ),
        None => writeln!(text, "  axis {decisive} decides the delay; not proven to be the least"),
    };
    text
}

/// What the durations of an axis's shaper buy.
fn front(front: &Front) -> String {
    let mut table = Table::new(&[
        "",
        ">duration ms",
        ">more than the least %",
        ">taps",
        ">peak command",
        ">mean delay ms",
        ">least residual %",
    ]);
    let least_s = front.durations.first().map_or(0.0, |least| least.duration_s);
    for figures in &front.durations {
        table.row([
            String::new(),
            format!("{:.4}", 1e3 * figures.duration_s),
            format!("{:.1}", 100.0 * (figures.duration_s / least_s - 1.0)),
            figures.taps.to_string(),
            format!("{:.4}", figures.peak_command),
            format!("{:.4}", 1e3 * figures.delay_s),
            percent(figures.least_residual),
        ]);
    }
    format!(
        "\naxis {}: what the duration buys: the fewest taps found within the tolerance, their peak command and mean delay; and the \
         least residual of any shaper of that duration\n{}",
        front.axis,
        table.text("  ")
    )
}
