//! Plots of the shapers on the simulated machine.

use super::waves::Waves;
use crate::failure::Failure;
use crate::plot::{Corridor, Curve, Panel, label, time_axis};
use crate::simulate::si_per_lsb;
use posicast_machine::machine_file::{AxisSection, Machine};
use posicast_machine::plan::{AxisTables, MachineDesign};
use posicast_machine::plant::response::step_response;
use posicast_machine::plant::{Plant, SampledPlant};
use posicast_machine::simulation::AxisSimulation;
use posicast_shaper::analysis::{settled_from, tap_impulses};
use posicast_shaper::impulse::ImpulseSequence;
use posicast_shaper::unit::{ShownUnit, trimmed};

/// Duration that a step response shows, in shaper durations.
const SHOWN_DURATIONS: f64 = 4.0;
const RESPONSE_POINTS: usize = 1200;
/// Fraction of a step within which a response counts as settled.
const SETTLED: f64 = 0.02;

/// Step responses and the end of the move, two panels per axis; with the simulated hardware's samples if its waves are given.
pub(crate) fn response_panels(
    machine: &Machine,
    design: &MachineDesign,
    axes: &[AxisSimulation],
    waves: Option<&Waves>,
) -> Result<Vec<Panel>, Failure> {
    let mut panels = Vec::new();
    let runs = axes.iter().enumerate();
    for ((axis, tables), (index, run)) in machine.axes.iter().zip(&design.axes).zip(runs) {
        if axis.modes.is_empty() {
            continue;
        }
        panels.push(step_panel(&machine.name, axis, tables, design.sample_hz)?);
        let followed = |waves: &Waves| -> Result<Followed, Failure> {
            Ok(Followed {
                name: waves.device,
                positions: follow(machine, axis, &waves.unwrapped[index])?,
            })
        };
        let followed = waves.map(followed).transpose()?;
        panels.push(move_panel(machine, axis, tables, run, followed.as_ref()));
    }
    Ok(panels)
}

/// `name` with the time at which the deviations, given at times in the unit of `time`, have settled to ± `band`.
///
/// A vibration of this period crosses its band twice per period, so it has settled only if the picture shows that it stays there for a
/// whole period. If it leaves the band within the last half period, it has not settled before the end. If it stays in the band for longer
/// than that, but less than a period, the picture is too short for a verdict.
pub(super) fn with_settling(
    name: &str,
    deviations: &[(f64, f64)],
    band: f64,
    time: ShownUnit,
    period_s: f64,
) -> String {
    let values: Vec<f64> = deviations.iter().map(|point| point.1).collect();
    let begin = deviations.first().map_or(0.0, |point| point.0);
    let end = deviations.last().map_or(0.0, |point| point.0);
    let period = time.of(period_s);
    let settled = settled_from(&values, band).map(|first| (first, deviations[first].0));
    match settled {
        Some((0, at)) if end - at >= period => format!("{name}: settled throughout"),
        Some((_, at)) if end - at >= period => format!("{name}: settled at {} {}", trimmed(at, 3), time.symbol()),
        Some((_, at)) if end - at >= 0.5 * period || at <= begin => format!("{name}: not shown long enough"),
        _ => format!("{name}: settles later"),
    }
}

/// The longest damped period of an axis's modes, on a machine that is 10 % slower than it was modelled.
pub(super) fn slowest_period_s(axis: &AxisSection) -> f64 {
    axis.modes.iter().map(|m| m.mode.damped_period_s()).fold(0.0, f64::max) / 0.9
}

fn step_panel(machine: &str, axis: &AxisSection, tables: &AxisTables, sample_hz: f64) -> Result<Panel, Failure> {
    let plant = Plant::of_axis(axis).map_err(Failure::because)?;
    let taps = tap_impulses(&tables.table, sample_hz);
    let slowest_s = slowest_period_s(axis);
    let duration_s = SHOWN_DURATIONS * tables.design.impulses.duration_s().max(slowest_s);
    let time = time_axis(duration_s);
    let curve = |plant: &Plant, impulses: &[_], name: &str| {
        let points = step_response(plant, impulses, duration_s, RESPONSE_POINTS);
        let points: Vec<_> = points
            .into_iter()
            .map(|(time_s, position)| (time.of(time_s), position))
            .collect();
        let deviations: Vec<_> = points.iter().map(|(at, position)| (*at, position - 1.0)).collect();
        (with_settling(name, &deviations, SETTLED, time, slowest_s), points)
    };
    let (unshaped, points) = curve(&plant, ImpulseSequence::unity().impulses(), "unshaped");
    let machines = [
        ("shaped", 1.0),
        ("machine 10 % slower", 0.9),
        ("machine 10 % faster", 1.1),
    ];
    let shaped = machines.map(|(name, factor)| {
        let (name, points) = curve(&plant.scaled(factor), &taps, name);
        Curve::new(name, points)
    });
    Ok(Panel {
        title: format!(
            "{machine}, axis {}: step response with {}",
            axis.name, tables.design.kind
        ),
        x_label: label("time", time),
        y_label: "position / step".into(),
        curves: std::iter::once(Curve::reference(unshaped, points))
            .chain(shaped)
            .collect(),
        band: Some(Corridor {
            name: format!("±{} % of the step", 100.0 * SETTLED),
            range: (1.0 - SETTLED, 1.0 + SETTLED),
        }),
        ..Panel::default()
    })
}

/// The motion of the machine behind the simulated hardware.
struct Followed {
    name: &'static str,
    positions: Vec<f64>,
}

/// Positions of an axis's machine that follows these words, in LSB.
fn follow(machine: &Machine, axis: &AxisSection, words: &[i64]) -> Result<Vec<f64>, Failure> {
    let plant = Plant::of_axis(axis).map_err(Failure::because)?;
    let start = words.first().map_or(0.0, |word| *word as f64);
    let mut plant = SampledPlant::new(&plant, machine.clock.sample_period_s(), start);
    Ok(words.iter().map(|word| plant.step(*word as f64)).collect())
}

/// The machine near its target, from the end of the unshaped command on. The deviations after the shaped command's
/// end determine the shown range of the vertical axis, which has at least the band of a count.
fn move_panel(
    machine: &Machine,
    axis: &AxisSection,
    tables: &AxisTables,
    run: &AxisSimulation,
    followed: Option<&Followed>,
) -> Panel {
    let target = run.shaped.last().map_or(0.0, |word| *word as f64);
    let moving = run.shaped.iter().rposition(|word| *word as f64 != target);
    let arrived = moving.map_or(0, |last| last + 1);
    let from = arrived.saturating_sub(tables.table.longest_delay_samples() as usize);
    let per_lsb = si_per_lsb(machine, axis);
    let off = |position: &f64| (position - target) * per_lsb;
    let both = [&run.position_unshaped, &run.position];
    let later = both
        .iter()
        .flat_map(|positions| positions.iter().skip(arrived).map(off));
    let largest = later.map(f64::abs).fold(0.0, f64::max);
    let unit = axis.unit.for_size(largest.max(1.0 / axis.loop_counts_per_unit()));
    let time = time_axis(run.shaped.len() as f64 / machine.clock.sample_hz);
    let points = |positions: &[f64]| {
        let points = positions.iter().enumerate().skip(from);
        points
            .map(|(n, position)| (time.of(n as f64 / machine.clock.sample_hz), unit.of(off(position))))
            .collect::<Vec<_>>()
    };
    let [unshaped, shaped] = both.map(|positions| points(positions));
    let slowest_s = slowest_period_s(axis);
    let count = unit.of(1.0 / axis.loop_counts_per_unit());
    // A motion that stays within a count does not leave the picture.
    let shown = unit.of(largest).max(count);
    let mut curves = vec![
        Curve::reference(with_settling("unshaped", &unshaped, count, time, slowest_s), unshaped),
        Curve::new(with_settling("shaped", &shaped, count, time, slowest_s), shaped),
    ];
    if let Some(followed) = followed {
        let rtl = points(&followed.positions);
        curves.push(Curve::beside(
            with_settling(followed.name, &rtl, count, time, slowest_s),
            rtl,
        ));
    }
    Panel {
        title: format!("{}, axis {}: arrival of the move", machine.name, axis.name),
        x_label: label("time", time),
        y_label: label("deviation from target", unit),
        curves,
        y_range: Some((-1.1 * shown, 1.1 * shown)),
        band: Some(Corridor {
            name: "±1 count".into(),
            range: (-count, count),
        }),
        ..Panel::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use posicast_shaper::unit::time_unit;
    use std::f64::consts::TAU;

    /// The label of a vibration of 10 ms that begins at 7, halves in each period, and is shown for this long.
    fn label_of(shown_ms: f64) -> String {
        let points = (0..=(10.0 * shown_ms) as usize).map(|n| {
            let t = n as f64 / 10.0;
            (t, 7.0 * 0.5f64.powf(t / 10.0) * (TAU * t / 10.0).cos())
        });
        with_settling("load", &points.collect::<Vec<_>>(), 1.0, time_unit(5e-3), 10e-3)
    }

    #[test]
    fn the_label_about_settling_matches_the_curve() {
        // The envelope at the half periods is 7 · 2^(−n/2): 1.24 at 25 ms is the last above 1, and the curve enters the
        // band for good soon after.
        assert_eq!(label_of(60.0), "load: settled at 25.9 ms");
        assert_eq!(label_of(37.0), "load: settled at 25.9 ms");
        assert_eq!(label_of(33.0), "load: not shown long enough");
        // The vibration crosses the band, and leaves it again.
        for shown_ms in [2.5, 7.5, 12.5, 20.0, 28.0] {
            assert_eq!(label_of(shown_ms), "load: settles later", "{shown_ms}");
        }
        let quiet = |shown: usize| (0..=shown).map(|n| (n as f64, 0.1)).collect::<Vec<_>>();
        let label = |shown| with_settling("load", &quiet(shown), 1.0, time_unit(5e-3), 10e-3);
        assert_eq!(label(10), "load: settled throughout");
        assert_eq!(label(2), "load: not shown long enough");
    }
}
