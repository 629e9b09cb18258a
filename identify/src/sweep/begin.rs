//! Finds when a sweep began in a log, first to a few milliseconds, then to a small part of a sample.

use super::excitation::{QuarterOrder, Rise, Sweep, SweptAcceleration};
use super::record::Grid;
use super::transfer::{self, Division, Lines, estimate};
use crate::modal::{self, Fit, Phase, Pole, ResponsePoint};
use crate::parallel::mapped;
use crate::separable::Effort;

/// Sharpness of the impulse response below which other orders of the quarters are tried.
const SHARP: f64 = 30.0;

/// A sweep whose start is known to a few milliseconds.
pub(super) struct Begun {
    pub(super) excitation: SweptAcceleration,
    /// Lines of the excitation when it begins at the start of the grid.
    lines: Lines,
    pub(super) order: QuarterOrder,
    pub(super) rise: Rise,
    /// Time from the start of the grid.
    pub(super) start_s: f64,
}

/// Places the description of a sweep in the log, with the likeliest order of its quarters.
pub(super) fn begin(grid: &Grid, response: &Lines, sweep: &Sweep) -> Option<Begun> {
    let mut best: Option<(f64, Begun)> = None;
    for order in QuarterOrder::ALL {
        for rise in Rise::ALL {
            let excitation = SweptAcceleration::new(sweep, order, rise);
            let lines = grid.excitation(&excitation, 0.0);
            let (start_s, sharpness) = transfer::delay(response, &lines);
            let begun = Begun {
                excitation,
                lines,
                order,
                rise,
                start_s,
            };
            if sharpness > SHARP {
                return Some(begun);
            }
            if best.as_ref().is_none_or(|(best, _)| sharpness > *best) {
                best = Some((sharpness, begun));
            }
        }
    }
    best.map(|(_, begun)| begun)
}

/// Lines of the sweep that begins at `start_s`.
pub(super) fn placed(grid: &Grid, begun: &Begun, start_s: f64) -> Lines {
    if !grid.is_cut() && start_s >= 0.0 && start_s + begun.excitation.duration_s() <= grid.seconds() {
        grid.later(&begun.lines, start_s)
    } else {
        grid.excitation(&begun.excitation, start_s)
    }
}

/// Finds the lateness that fits these poles, or else poles that are fitted without knowledge of the phase.
pub(super) fn timed(points: &[ResponsePoint], known: Option<&[Pole]>) -> Option<Fit> {
    const TRIED_S: f64 = 0.25e-3;
    const TRIED: i32 = 60;
    // A third of the points is as good for start values, and takes a third of the time.
    let points = &modal::thinned(points, 3);
    let poles = match known {
        Some(poles) => poles.to_vec(),
        None => modal::select(points, Phase::Free)?.poles,
    };
    let delays_s = (-TRIED..=TRIED).map(|n| f64::from(n) * TRIED_S);
    let late = modal::likeliest_delay(points, &poles, delays_s)?;
    modal::refine(points, &poles, Phase::Late(late), Effort::Full)
}

/// Number of steps of the search for the start on either side, and their size in samples.
const SOUGHT_STEPS: [(i32, f64); 3] = [(6, 0.1), (4, 0.025), (4, 0.006)];

/// Returns the start at which the samples of an excitation explain most of a response on the lines that count. If most edges lie between a
/// few samples, the samples give the start more exactly than the phase does.
pub(super) fn sought(
    grid: &Grid,
    response: &Lines,
    trusted: &[bool],
    excitation: &SweptAcceleration,
    about_s: f64,
) -> f64 {
    let explained = |start_s: &f64| {
        let samples = grid.band_of(&grid.sampled(excitation, *start_s));
        let division = Division {
            response,
            excitation: &samples,
            folded: &[],
            trusted,
        };
        (estimate(&division, |_| 1.0).explained, *start_s)
    };
    let mut start_s = about_s;
    for (steps, step) in SOUGHT_STEPS {
        let tried: Vec<f64> = (-steps..=steps)
            .map(|n| start_s + f64::from(n) * step * grid.sample_s())
            .collect();
        let found = mapped(&tried, explained).into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
        start_s = found.map_or(start_s, |(_, start_s)| start_s);
    }
    start_s
}
