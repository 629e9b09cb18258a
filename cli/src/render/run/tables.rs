//! Tables of the shapers of a run.

use crate::table::Table;
use posicast_flow::run::{Document, PlantStep};
use posicast_flow::text::percent;

/// What the shapers leave of a step, and of the move.
pub(super) fn shapers(document: &Document) -> String {
    let mut residuals = Table::new(&[
        "axis",
        "shaper",
        ">impulses",
        ">taps",
        ">float",
        ">quantised",
        ">on plant",
        ">plant -10 %",
        ">plant +10 %",
    ]);
    let mut overshoots = Table::new(&[
        "axis",
        ">unshaped",
        ">on plant",
        ">plant -10 %",
        ">plant +10 %",
        ">ringing unshaped",
        ">ringing shaped",
    ]);
    for (axis, design) in document.axes.iter().zip(&document.design.axes) {
        let (plant, quantised) = (&axis.plant, &design.quantised);
        residuals.row([
            axis.name.clone(),
            design.kind.clone(),
            design.impulses.len().to_string(),
            quantised.taps.len().to_string(),
            largest(design.modes.iter().map(|mode| mode.residual)),
            largest(quantised.modes.iter().map(|mode| mode.residual)),
            worst(&plant.nominal),
            worst(&plant.minus_10_percent),
            worst(&plant.plus_10_percent),
        ]);
        let ringing = [axis.residual_displacement_unshaped, axis.residual_displacement];
        let [ringing_unshaped, ringing_shaped] = axis.unit.of_axis().show_all(ringing);
        overshoots.row([
            axis.name.clone(),
            percent(plant.unshaped.overshoot),
            percent(plant.nominal.overshoot),
            percent(plant.minus_10_percent.overshoot),
            percent(plant.plus_10_percent.overshoot),
            ringing_unshaped,
            ringing_shaped,
        ]);
    }
    format!(
        "Residual vibration of a step, worst mode, % of unshaped\n{}\n\
         Overshoot of a step, %; ringing after the move\n{}",
        residuals.text("  "),
        overshoots.text("  ")
    )
}

/// The largest of these fractions in percent; a dash if there is none.
fn largest(fractions: impl Iterator<Item = f64>) -> String {
    fractions.reduce(f64::max).map_or_else(|| "-".to_owned(), percent)
}

fn worst(step: &PlantStep) -> String {
    largest(step.residual.iter().copied())
}

/// The shapers' Verilog beside their model and the float design.
pub(super) fn comparison(document: &Document) -> String {
    let mut table = Table::new(&[
        "axis",
        ">clocks",
        ">mismatches",
        ">samples of the move",
        ">largest difference from float, LSB",
        ">bound, LSB",
    ]);
    for axis in &document.axes {
        let mut blocks = document.verify.blocks.iter();
        let block = blocks.find(|block| block.name == "shaper" && block.instance == axis.name);
        table.row([
            axis.name.clone(),
            block.map_or_else(String::new, |block| block.cycles.to_string()),
            block.map_or_else(String::new, |block| block.mismatches.to_string()),
            axis.samples.to_string(),
            format!("{:.3}", axis.largest_difference_lsb),
            format!("{:.3}", axis.bound_lsb),
        ]);
    }
    format!("RTL against model and float design\n{}", table.text("  "))
}
