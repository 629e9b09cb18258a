//! Finds the firmware's own shaper with the smallest residual, if the firmware cannot use the design.

use super::super::Selected;
use super::Refusal;
use crate::failure::Failure;
use posicast_shaper::analysis::WeightedMode;
use posicast_shaper::firmware::closest::{BAND, Closest, OwnKind, closest, left};

/// Number of kinds that a message lists.
const LISTED: usize = 8;

/// The shapers that a firmware itself offers.
pub(super) struct Own<'a> {
    /// The firmware.
    pub(super) firmware: &'a str,
    /// Its kinds.
    pub(super) candidates: Vec<OwnKind<'a>>,
    /// Damping ratio that the firmware uses if none is written.
    pub(super) default_damping: Option<f64>,
}

/// Shapers that were found for axes that share one.
pub(super) struct Found {
    /// The best of each kind, the best first.
    pub(super) best: Vec<Closest>,
    /// One line with the residuals of the first shaper and of the design.
    pub(super) line: String,
}

impl Own<'_> {
    /// Searches for axes that share a shaper; `None` if no kind fits.
    pub(super) fn search(&self, axes: &[&Selected<'_>]) -> Option<Found> {
        let weighted = weighted(axes);
        let best = closest(&self.candidates, &weighted, None);
        let first = best.first()?;
        let design = axes
            .iter()
            .zip(&weighted)
            .map(|(selected, modes)| left(selected.tables.design.impulses.impulses(), std::slice::from_ref(modes)))
            .fold(0.0, f64::max);
        let longest_s = axes
            .iter()
            .map(|selected| selected.tables.design.impulses.duration_s())
            .fold(0.0, f64::max);
        let line = format!(
            "of {}'s own shapers, {} at {} Hz with damping ratio {} leaves least of the ringing after a jump of the acceleration: \
             {:.1} % with every mode off by up to ±{:.0} %, and lasts {:.1} ms; the design would leave {:.1} %, and lasts {:.1} ms",
            self.firmware,
            self.candidates[first.candidate].name,
            first.frequency_hz,
            first.damping,
            100.0 * first.left,
            100.0 * BAND,
            1e3 * first.impulses.duration_s(),
            100.0 * design,
            1e3 * longest_s
        );
        Some(Found { best, line })
    }

    /// Returns the refusal together with the firmware's own shapers.
    pub(super) fn refuse(&self, refusal: &Refusal, axes: &[&Selected<'_>]) -> Failure {
        let name = axes.first().map_or("", |selected| selected.axis.name.as_str());
        let found = refusal.has_own.then(|| self.search(axes)).flatten();
        let Some(found) = found else {
            return refusal.failure(name, &[]);
        };
        let mut lines = vec![
            found.line.clone(),
            "--closest writes it; the best of each kind:".to_owned(),
        ];
        lines.extend(found.best.iter().take(LISTED).map(|of_kind| self.row(of_kind)));
        if let Some(damping) = self.default_damping {
            // Kinds with parameters are only in the list above.
            let plain = |of_kind: &&Closest| !self.candidates[of_kind.candidate].name.contains('(');
            let best = closest(&self.candidates, &weighted(axes), Some(damping));
            let rows: Vec<String> = best.iter().filter(plain).map(|of_kind| self.row(of_kind)).collect();
            if !rows.is_empty() {
                lines.push(format!("with {}'s default damping ratio:", self.firmware));
                lines.extend(rows);
            }
        }
        refusal.failure(name, &lines)
    }

    fn row(&self, of_kind: &Closest) -> String {
        format!(
            "  {} at {} Hz, damping ratio {}: leaves {:.1} %, lasts {:.1} ms",
            self.candidates[of_kind.candidate].name,
            of_kind.frequency_hz,
            of_kind.damping,
            100.0 * of_kind.left,
            1e3 * of_kind.impulses.duration_s()
        )
    }
}

/// The modes of each axis with their shares.
fn weighted(axes: &[&Selected<'_>]) -> Vec<Vec<WeightedMode>> {
    let of = |selected: &&Selected<'_>| {
        let modes = selected.axis.modes.iter().map(|mode| WeightedMode {
            mode: mode.mode,
            participation: mode.participation,
        });
        modes.collect()
    };
    axes.iter().map(of).collect()
}
