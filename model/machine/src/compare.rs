//! Compares every kind of shaper on one axis: its costs and its residual vibration.
//!
//! Each kind that this version builds is designed for the axis's modes and tolerances, digitised and rounded as the
//! machine file requires, and judged by the integer taps that the hardware uses. A kind is *Pareto-optimal* if no
//! other is at least as good in duration, worst residual and taps, and better in one of them.
//!
//! `optimal` is designed for the conditions of the comparison: the frequency band in which every kind is judged, and the tolerances of
//! the modes; once without negative amplitudes, and once with a shaped step that stays within −1 … 1. An `optimal` of the machine file
//! has its own row.

use thiserror::Error;

use crate::machine_file::{AxisSection, Machine};
use posicast_optimal::{Band, Command, Request, least_ratio_at};
use posicast_shaper::analysis::{tap_impulses, worst_residual};
use posicast_shaper::axis::{AxisMode, DEFAULT_TOLERANCE, ShaperChoice};
use posicast_shaper::design::kind::ShaperKind;
use posicast_shaper::design::{DesignError, design_axis, optimal};
use posicast_shaper::digitise::{DigitiseError, digitise};
use posicast_shaper::impulse::PartialSums;
use posicast_taps::TapTable;

/// Relative difference below which two costs are equal: kinds that give the same shaper for one mode differ by
/// rounding.
const EQUAL: f64 = 1e-6;

/// Relative excess of a tolerance that is rounding of the arithmetic.
const ROUNDING: f64 = 1e-9;

/// Default of the relative frequency error of the modes: ±10 %.
pub const DEFAULT_BAND: f64 = 0.1;

/// Longest duration in samples for which the least residual is computed: a cone program with a variable per sample.
pub const LONGEST_SOLVED: u32 = 800;

/// Figures of a kind of shaper on one axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// The kind, or several joined by `+` where the file has one per mode.
    pub kind: String,
    /// Whether this is the shaper of the machine file.
    pub in_file: bool,
    /// Time of the last impulse in seconds.
    pub duration_s: f64,
    /// Delay of a ramp in seconds.
    pub delay_s: f64,
    /// Largest residual vibration, by the integer taps, of any mode whose frequency is off by no more than the band.
    pub worst_residual: f64,
    /// Number of taps of the integer table.
    pub taps: usize,
    /// For a smooth kind, the least worst residual of any shaper without negative amplitudes that ends with its last tap, for the same
    /// band; `None` for the other kinds, and for durations of more than [`LONGEST_SOLVED`] samples.
    pub least_residual: Option<f64>,
    /// Range of the shaped unit step.
    pub partial_sums: PartialSums,
    /// Whether no other kind is at least as good in everything and better in something.
    pub pareto: bool,
    /// Whether each mode keeps its tolerance in the whole band.
    pub keeps_tolerance: bool,
    /// Whether no other kind that keeps the tolerance is shorter. An axis without modes has none.
    pub shortest: bool,
}

/// A kind that is not possible on this axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Missing {
    /// The kind, as in [`Candidate::kind`].
    pub kind: String,
    /// The reason, in words.
    pub reason: String,
}

/// The kinds on one axis.
#[derive(Debug, Clone, PartialEq)]
pub struct KindComparison {
    /// Name of the axis.
    pub axis: String,
    /// The possible kinds, shortest first.
    pub candidates: Vec<Candidate>,
    /// The kinds that are not possible.
    pub missing: Vec<Missing>,
    /// Tolerance of each mode, in the order of the file.
    pub tolerances: Vec<f64>,
}

/// Why a kind has no table.
#[derive(Debug, Error)]
enum CandidateError {
    #[error(transparent)]
    Design(#[from] DesignError),
    #[error(transparent)]
    Table(#[from] DigitiseError),
    #[error("it has no tap table")]
    NoTable,
}

/// Compares every kind on each axis of a machine; `band` is the relative frequency error that each mode may have, such as
/// [`DEFAULT_BAND`].
pub fn compare(machine: &Machine, band: f64) -> Vec<KindComparison> {
    machine
        .axes
        .iter()
        .map(|axis| compare_axis(machine, axis, band))
        .collect()
}

/// An axis with a kind, under the name of its row.
struct Row {
    name: String,
    axis: AxisSection,
    in_file: bool,
}

fn compare_axis(machine: &Machine, axis: &AxisSection, band: f64) -> KindComparison {
    let own = Row {
        name: axis.shaped().kind_name(),
        axis: axis.clone(),
        in_file: true,
    };
    let others = kinds_for(axis)
        .map(|kind| with_kind(axis, kind))
        .filter(|other| other.shaped().kind_name() != own.name)
        .map(|axis| Row {
            name: axis.shaped().kind_name(),
            axis,
            in_file: false,
        });
    let sample_hz = machine.clock.sample_hz;
    let asked = |axis: &AxisSection| {
        (axis.shaped().joint_kind() == Some(ShaperKind::Optimal)).then(|| optimal::request(axis.shaped(), sample_hz))
    };
    let of_the_file = asked(axis);
    let optimal = optimal_rows(axis, band)
        .into_iter()
        .filter(|row| asked(&row.axis) != of_the_file);
    let others: Vec<Row> = others.chain(optimal).collect();
    let (mut candidates, mut missing) = (Vec::new(), Vec::new());
    for row in std::iter::once(own).chain(others) {
        match candidate(machine, &row, band) {
            Ok(candidate) => candidates.push(candidate),
            Err(error) => missing.push(Missing {
                kind: row.name,
                reason: error.to_string(),
            }),
        }
    }
    mark_pareto(&mut candidates);
    candidates.sort_by(|a, b| a.duration_s.total_cmp(&b.duration_s));
    if !axis.modes.is_empty()
        && let Some(shortest) = candidates.iter_mut().find(|candidate| candidate.keeps_tolerance)
    {
        shortest.shortest = true;
    }
    KindComparison {
        axis: axis.name.clone(),
        candidates,
        missing,
        tolerances: axis.modes.iter().map(|mode| axis.shaped().tolerance_of(mode)).collect(),
    }
}

/// Returns the rows of `optimal` for the band of the comparison: without negative amplitudes, and with a step that stays within −1 … 1.
fn optimal_rows(axis: &AxisSection, band: f64) -> Vec<Row> {
    let both_ways = Command::PartialSums { low: -1.0, high: 1.0 };
    let rows = [("", Command::Positive), (" ±1", both_ways)].map(|(bounds, command)| {
        let mut axis = with_kind(axis, ShaperKind::Optimal);
        for mode in &mut axis.modes {
            mode.frequency_band = Some(band);
            mode.damping_band = None;
        }
        if let Some(shaper) = &mut axis.shaper {
            shaper.command = Some(command);
        }
        Row {
            name: format!("{}{bounds}", ShaperKind::Optimal),
            axis,
            in_file: false,
        }
    });
    rows.into_iter().filter(|row| !row.axis.modes.is_empty()).collect()
}

/// Returns the kinds that need no further data, except `optimal`; on an axis without modes only `none`, which passes the
/// command through.
fn kinds_for(axis: &AxisSection) -> impl Iterator<Item = ShaperKind> {
    let modes = !axis.modes.is_empty();
    ShaperKind::ALL
        .iter()
        .copied()
        .filter(|kind| !matches!(kind, ShaperKind::Custom | ShaperKind::Optimal))
        .filter(move |kind| modes || *kind == ShaperKind::None)
}

/// The axis with another kind: its tolerances stay, and the parameters of the file's own kind are dropped.
pub(crate) fn with_kind(axis: &AxisSection, kind: ShaperKind) -> AxisSection {
    let modes = axis.modes.iter().map(|mode| AxisMode {
        shaper: None,
        order: None,
        ..mode.clone()
    });
    AxisSection {
        shaper: Some(ShaperChoice {
            tolerance: axis.shaper.as_ref().and_then(|s| s.tolerance),
            ..ShaperChoice::of_kind(kind)
        }),
        modes: modes.collect(),
        ..axis.clone()
    }
}

fn candidate(machine: &Machine, row: &Row, band: f64) -> Result<Candidate, CandidateError> {
    let axis = &row.axis;
    let sample_hz = machine.clock.sample_hz;
    let design = design_axis(axis.shaped(), sample_hz)?;
    let digitised = digitise(&design, machine.fixed_point.digitise, sample_hz)?;
    let tables = optimal::tables(&[(&design, &digitised)], machine.fixed_point.coefficient_fraction)?;
    let table = tables.first().ok_or(CandidateError::NoTable)?;
    let taps = tap_impulses(table, sample_hz);
    let residuals = axis.modes.iter().map(|mode| worst_residual(&taps, &mode.mode, band));
    let residuals: Vec<f64> = residuals.collect();
    let mut judged = residuals.iter().zip(&axis.modes);
    Ok(Candidate {
        kind: row.name.clone(),
        in_file: row.in_file,
        duration_s: design.impulses.duration_s(),
        delay_s: design.impulses.delay_s(),
        worst_residual: residuals.iter().copied().fold(0.0, f64::max),
        keeps_tolerance: judged
            .all(|(residual, mode)| *residual <= axis.shaped().tolerance_of(mode) * (1.0 + ROUNDING)),
        shortest: false,
        taps: taps.len(),
        least_residual: least_residual(axis, table, sample_hz, band),
        partial_sums: design.impulses.partial_sums(),
        pareto: false,
    })
}

/// The least worst residual at the duration of a smooth kind.
fn least_residual(axis: &AxisSection, table: &TapTable, sample_hz: f64, band: f64) -> Option<f64> {
    let samples = table.longest_delay_samples();
    let mut kinds = axis.modes.iter().map(|mode| axis.shaped().kind_of(mode));
    if samples > LONGEST_SOLVED || !kinds.all(ShaperKind::is_smooth) || axis.modes.is_empty() {
        return None;
    }
    let given = optimal::request(axis.shaped(), sample_hz);
    let bands = axis.modes.iter().map(|mode| Band {
        frequency_hz: [1.0 - band, 1.0 + band].map(|factor| factor * mode.mode.frequency_hz),
        damping: [mode.mode.damping; 2],
        tolerance: DEFAULT_TOLERANCE,
    });
    let request = Request {
        bands: bands.collect(),
        command: Command::Positive,
        ..given
    };
    let ratio = least_ratio_at(&request, samples).ok()?;
    Some(ratio * DEFAULT_TOLERANCE)
}

fn mark_pareto(candidates: &mut [Candidate]) {
    let costs: Vec<[f64; 3]> = candidates
        .iter()
        .map(|c| [c.duration_s, c.worst_residual, c.taps as f64])
        .collect();
    for (candidate, own) in candidates.iter_mut().zip(&costs) {
        let beaten = costs.iter().any(|other| {
            let pairs = || other.iter().zip(own);
            pairs().all(|(other, own)| *other <= own * (1.0 + EQUAL))
                && pairs().any(|(other, own)| *other < own * (1.0 - EQUAL))
        });
        candidate.pareto = !beaten;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine_file;

    fn machine(shaper: &str, modes: &str) -> Machine {
        let text = format!(
            "name = \"m\"\n[clock]\nfrequency_hz = 50_000_000\nsample_hz = 10_000\n\
             [[axis]]\nname = \"x\"\ncounts_per_unit = 1e6\n{shaper}\n{modes}"
        );
        machine_file::parse("m.toml", &text).unwrap()
    }

    fn machine_of_band(band: f64) -> Machine {
        machine(
            "[axis.shaper]\nkind = \"optimal\"",
            &format!("{MODE}frequency_band = {band}\n"),
        )
    }

    const MODE: &str = "[[axis.mode]]\nfrequency_hz = 40\ndamping = 0.02\n";

    fn find<'a>(comparison: &'a KindComparison, kind: &str) -> &'a Candidate {
        comparison.candidates.iter().find(|c| c.kind == kind).unwrap()
    }

    #[test]
    fn every_kind_is_tried_once_and_the_files_own_is_marked() {
        let machine = machine("[axis.shaper]\nkind = \"zvd\"", MODE);
        let found = compare(&machine, 0.1).remove(0);
        let mut names: Vec<&str> = found.candidates.iter().map(|c| c.kind.as_str()).collect();
        names.extend(found.missing.iter().map(|m| m.kind.as_str()));
        // Not `custom`; `optimal` has two rows.
        assert_eq!(names.len(), ShaperKind::ALL.len());
        assert!(found.candidates.iter().all(|c| c.in_file == (c.kind == "zvd")));
        assert!(found.candidates.is_sorted_by(|a, b| a.duration_s <= b.duration_s));
    }

    #[test]
    fn every_other_kind_is_beaten_by_a_pareto_optimal_one() {
        let machine = machine("[axis.shaper]\nkind = \"zvd\"", MODE);
        let found = compare(&machine, 0.1).remove(0);
        // No kind is shorter than `none`; among those without negative impulses, none has fewer taps than zv and more
        // than `none`.
        assert!(find(&found, "none").pareto && find(&found, "zv").pareto && find(&found, "zvd").pareto);
        for candidate in found.candidates.iter().filter(|c| !c.pareto) {
            let better = found.candidates.iter().any(|c| {
                c.pareto
                    && c.duration_s <= candidate.duration_s
                    && c.worst_residual <= candidate.worst_residual
                    && c.taps <= candidate.taps
            });
            assert!(better, "{}", candidate.kind);
        }
        let (zv, zvd) = (find(&found, "zv"), find(&found, "zvd"));
        assert!(zv.duration_s < zvd.duration_s && zv.worst_residual > 5.0 * zvd.worst_residual);
    }

    #[test]
    fn what_is_beaten_in_one_cost_and_better_in_none_is_not_marked() {
        let with = |duration_s, worst_residual, taps| Candidate {
            kind: String::new(),
            in_file: false,
            duration_s,
            delay_s: 0.0,
            worst_residual,
            taps,
            least_residual: None,
            partial_sums: PartialSums { min: 0.0, max: 1.0 },
            pareto: false,
            keeps_tolerance: false,
            shortest: false,
        };
        // Worse in duration; worse in taps; equal to rounding; worse in duration, but better in residual.
        let mut candidates = [
            with(1.0, 0.1, 3),
            with(1.1, 0.1, 3),
            with(1.0, 0.1, 4),
            with(1.0 + 1e-12, 0.1, 3),
            with(2.0, 0.05, 3),
        ];
        mark_pareto(&mut candidates);
        assert_eq!(candidates.map(|c| c.pareto), [true, false, false, true, true]);
    }

    #[test]
    fn optimal_keeps_the_tolerance_of_the_band_and_is_the_shortest_that_does() {
        for (band, tolerance) in [(0.1, "0.05"), (0.2, "0.05"), (0.05, "0.02")] {
            let machine = machine(&format!("[axis.shaper]\nkind = \"zvd\"\ntolerance = {tolerance}"), MODE);
            let found = compare(&machine, band).remove(0);
            let (positive, both) = (find(&found, "optimal"), find(&found, "optimal ±1"));
            // Evaluate the integer taps at far more frequencies than the table does.
            for optimal in [positive, both] {
                assert!(
                    optimal.keeps_tolerance && optimal.worst_residual <= found.tolerances[0] * (1.0 + 1e-9),
                    "{optimal:?}"
                );
            }
            let shortest: Vec<&Candidate> = found.candidates.iter().filter(|c| c.shortest).collect();
            assert_eq!(shortest.len(), 1);
            for other in found
                .candidates
                .iter()
                .filter(|c| c.worst_residual <= found.tolerances[0])
            {
                assert!(
                    other.keeps_tolerance && shortest[0].duration_s <= other.duration_s,
                    "{other:?}"
                );
                // Without negative amplitudes no shaper is shorter than the optimum; digitising may add a tap, and so a sample.
                let no_shorter = other.partial_sums.min < -1e-9 || positive.duration_s <= other.duration_s + 1e-4;
                assert!(
                    no_shorter || other.kind.contains("um-") || other.kind.contains("simultaneous"),
                    "{other:?}"
                );
            }
        }
    }

    #[test]
    fn an_optimal_of_the_file_is_a_row_of_its_own() {
        let machine = machine("[axis.shaper]\nkind = \"optimal\"", MODE);
        let found = compare(&machine, 0.1).remove(0);
        let rows: Vec<&Candidate> = found.candidates.iter().filter(|c| c.kind == "optimal").collect();
        // The file's own `optimal` is designed for exact frequencies, so over the band it leaves far more than the tolerance.
        let own = rows.iter().find(|c| c.in_file).unwrap();
        assert!(!own.keeps_tolerance && own.worst_residual > 0.1, "{own:?}");
        assert!(
            rows.len() == 2 && rows.iter().any(|c| !c.in_file && c.keeps_tolerance),
            "{rows:?}"
        );
        // An `optimal` of the file with the band of the comparison shares its row.
        let banded = machine_of_band(0.1);
        let found = compare(&banded, 0.1).remove(0);
        assert_eq!(found.candidates.iter().filter(|c| c.kind == "optimal").count(), 1);
    }

    #[test]
    fn a_wider_band_is_worse() {
        let machine = machine("[axis.shaper]\nkind = \"ei\"\ntolerance = 0.02", MODE);
        let worst = |band| find(&compare(&machine, band)[0], "ei").worst_residual;
        assert!(worst(0.01) < 0.021 && worst(0.1) < worst(0.2) && worst(0.2) < worst(0.5));
    }

    #[test]
    fn no_smooth_kind_leaves_less_than_the_least_at_its_duration() {
        let machine = machine("[axis.shaper]\nkind = \"zvd\"", MODE);
        let found = compare(&machine, 0.1).remove(0);
        for candidate in &found.candidates {
            let is_smooth = candidate.kind.starts_with("smooth_");
            assert_eq!(candidate.least_residual.is_some(), is_smooth, "{}", candidate.kind);
            if let Some(least) = candidate.least_residual {
                assert!(least <= candidate.worst_residual * (1.0 + 1e-3) + 1e-4, "{candidate:?}");
            }
        }
        // At 0.8 periods three impulses leave far less than a kernel with two humps.
        let zv = find(&found, "smooth_zv");
        assert!(zv.least_residual.unwrap() < 0.7 * zv.worst_residual, "{zv:?}");
    }

    #[test]
    fn a_kind_that_does_not_exist_has_its_reason() {
        // At this damping no EI shaper with a tolerance of 5 % exists.
        let machine = machine(
            "[axis.shaper]\nkind = \"zv\"",
            "[[axis.mode]]\nfrequency_hz = 40\ndamping = 0.9\n",
        );
        let found = compare(&machine, 0.1).remove(0);
        let ei = found.missing.iter().find(|m| m.kind == "ei").unwrap();
        assert!(ei.reason.contains("damping"), "{}", ei.reason);
    }

    #[test]
    fn shapers_per_mode_and_axes_without_modes() {
        let modes =
            format!("{MODE}shaper = \"zv\"\n[[axis.mode]]\nfrequency_hz = 90\ndamping = 0.01\nshaper = \"zvd\"\n");
        let found = compare(&machine("", &modes), 0.1).remove(0);
        assert!(find(&found, "zv+zvd").in_file && !find(&found, "zv").in_file);
        let found = compare(&machine("[axis.shaper]\nkind = \"none\"", ""), 0.1).remove(0);
        assert_eq!((found.candidates.len(), found.missing.len()), (1, 0));
        assert_eq!(found.candidates[0].worst_residual, 0.0);
    }
}
