//! Sensitivity curves: the residual over the mode's true frequency.

use crate::plot::{Curve, Panel};
use posicast_machine::machine_file::{AxisSection, Machine};
use posicast_machine::plan::{AxisTables, MachineDesign};
use posicast_shaper::analysis::{sensitivity_curve, tap_impulses};
use posicast_shaper::unit::trimmed;

/// Range of frequency ratios that the sensitivity curves show.
const CURVE_RATIOS: (f64, f64) = (0.4, 1.6);
const CURVE_POINTS: usize = 601;

/// Sensitivity curves, one panel per axis: residual over the mode's true frequency, float and quantised.
pub(crate) fn sensitivity_panels(machine: &Machine, design: &MachineDesign) -> Vec<Panel> {
    let panels = machine
        .axes
        .iter()
        .zip(&design.axes)
        .filter(|(axis, _)| !axis.modes.is_empty());
    panels
        .map(|(axis, tables)| sensitivity_panel(&machine.name, axis, tables, design.sample_hz))
        .collect()
}

fn sensitivity_panel(machine: &str, axis: &AxisSection, tables: &AxisTables, sample_hz: f64) -> Panel {
    let integer = tap_impulses(&tables.table, sample_hz);
    let mut curves = Vec::new();
    for mode in &axis.modes {
        let curve = |impulses: &[_]| {
            let points = sensitivity_curve(impulses, &mode.mode, CURVE_RATIOS.0, CURVE_RATIOS.1, CURVE_POINTS);
            points
                .into_iter()
                .map(|(ratio, residual)| (ratio, 100.0 * residual))
                .collect::<Vec<_>>()
        };
        let name = format!("{} Hz", trimmed(mode.mode.frequency_hz, 4));
        curves.push(Curve::new(format!("{name}, integer taps"), curve(&integer)));
        curves.push(Curve::beside(
            format!("{name}, impulses before rounding"),
            curve(tables.design.impulses.impulses()),
        ));
    }
    let mut tolerances: Vec<f64> = axis
        .modes
        .iter()
        .map(|mode| 100.0 * axis.shaped().tolerance_of(mode))
        .collect();
    tolerances.sort_by(f64::total_cmp);
    tolerances.dedup();
    for tolerance in tolerances {
        let line = vec![(CURVE_RATIOS.0, tolerance), (CURVE_RATIOS.1, tolerance)];
        curves.push(Curve::limit(format!("tolerance {} %", trimmed(tolerance, 3)), line));
    }
    Panel {
        title: format!(
            "{machine}, axis {}: residual vibration of {}",
            axis.name, tables.design.kind
        ),
        x_label: "frequency of the mode / design frequency".into(),
        y_label: "residual vibration, %".into(),
        curves,
        ..Panel::default()
    }
}
