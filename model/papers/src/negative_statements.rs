//! What "negative-hybrid" states about its figures 2 to 8, amplitudes and robustness.

use super::designs::shaper;
use super::negative_shapers::{MODES, PAIRS, PLAIN, negative, plant, positive};
use super::sheet::Sheet;
use posicast_machine::motion::Trajectory;
use posicast_machine::plant::response::response_figures;
use posicast_shaper::analysis::{insensitivity, residual_vibration};
use posicast_shaper::design::DesignError;
use posicast_shaper::design::kind::ShaperKind;
use posicast_shaper::impulse::ImpulseSequence;
use posicast_shaper::mode::Mode;

pub(super) fn rows(sheet: &mut Sheet) -> Result<(), DesignError> {
    responses(sheet)?;
    properties(sheet)
}

/// Returns the smallest of the values.
pub(super) fn least(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::INFINITY, f64::min)
}

/// Returns the largest of the values.
pub(super) fn most(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

/// Response of the robot with a shaper.
struct Response {
    name: String,
    duration_s: f64,
    /// Residual of mode 2.
    residual_2: f64,
    /// Largest deviation after the last impulse, as a fraction of the step.
    left: f64,
    /// Largest excursion beyond the step or below the start.
    transient: f64,
}

impl Response {
    fn new((name, shaper): (String, ImpulseSequence)) -> Self {
        let figures = response_figures(&plant(), &Trajectory::step(1.0).shaped(shaper.impulses()));
        Self {
            name,
            duration_s: shaper.duration_s(),
            residual_2: residual_vibration(shaper.impulses(), &MODES[1]),
            left: figures.deviation_after,
            transient: (figures.highest - 1.0).max(-figures.lowest),
        }
    }
}

/// The type of [`negative`] and [`positive`].
type Design = fn((usize, usize)) -> Result<(String, ImpulseSequence), DesignError>;

/// Adds the statements about Figures 2 to 8.
fn responses(sheet: &mut Sheet) -> Result<(), DesignError> {
    let of = |pairs: &[(usize, usize)], design: Design| {
        let designs = pairs.iter().map(|pair| design(*pair).map(Response::new));
        designs.collect::<Result<Vec<_>, _>>()
    };
    let (hybrids, plain, smooth) = (of(&PAIRS, negative)?, of(&PLAIN, negative)?, of(&PAIRS, positive)?);
    let percent = |fraction: f64| format!("{:.2} %", 100.0 * fraction);

    let mut by_transient: Vec<&Response> = hybrids.iter().collect();
    by_transient.sort_by(|a, b| a.transient.total_cmp(&b.transient));
    for (claim, found, paper) in [
        ("smallest", by_transient.first(), "NZV-NZVD"),
        ("largest", by_transient.last(), "NZVD-NZV"),
    ] {
        let Some(found) = found else { continue };
        let ours = format!("{}, {}", found.name, percent(found.transient));
        sheet.claim(
            format!("text: {claim} transient of the hybrids"),
            paper,
            ours,
            found.name == paper,
        );
    }
    let left_of = |name: &str| {
        hybrids
            .iter()
            .chain(&plain)
            .find(|r| r.name == name)
            .map_or(f64::NAN, |r| r.left)
    };
    let (smallest, largest) = (
        least(&hybrids.iter().map(|r| r.left).collect::<Vec<_>>()),
        most(&hybrids.iter().map(|r| r.left).collect::<Vec<_>>()),
    );
    const ZERO: f64 = 1e-9;
    sheet.claim(
        "text: the hybrid that removes most vibration",
        "NZV-NZVD",
        format!("NZV-NZVD leaves {}", percent(left_of("NZV-NZVD"))),
        left_of("NZV-NZVD") <= smallest + ZERO,
    );
    sheet.claim(
        "text: the hybrid that removes least vibration",
        "NZVD-NEI",
        format!("NZVD-NEI leaves {}", percent(left_of("NZVD-NEI"))),
        left_of("NZVD-NEI") >= largest - ZERO,
    );
    let order = ["NZV-NZV", "NEI-NZV", "NZV-NEI", "NEI-NEI"];
    let left = order.map(left_of);
    sheet.claim(
        "text: order of the residuals",
        "NZV-NZV < NEI-NZV < NZV-NEI < NEI-NEI",
        left.map(percent).join(" < "),
        left.windows(2).all(|pair| pair[0] < pair[1]),
    );
    for name in ["NEI-NZV", "NEI-NZVD"] {
        let (hybrid, plain) = (left_of(name), left_of("NEI-NEI"));
        let ours = format!("{} against {}", percent(hybrid), percent(plain));
        sheet.claim(
            format!("text: {name} leaves less than NEI-NEI"),
            "less",
            ours,
            hybrid < plain,
        );
    }
    let (hybrid, plain_left) = (left_of("NZVD-NZV"), left_of("NZVD-NZVD"));
    sheet.refuted(
        "text: NZVD-NZV leaves less than NZVD-NZVD",
        "less",
        format!("{} against {}", percent(hybrid), percent(plain_left)),
        hybrid < plain_left - ZERO,
        "both leave nothing; a difference can only be the rounding of the times to 10 µs",
    );
    let roughest = most(&smooth.iter().map(|r| r.transient).collect::<Vec<_>>());
    let calmest = least(&hybrids.iter().map(|r| r.transient).collect::<Vec<_>>());
    sheet.claim(
        "text: positive hybrids move more smoothly than negative ones",
        "smoother",
        format!(
            "transients at most {} against at least {}",
            percent(roughest),
            percent(calmest)
        ),
        roughest < calmest,
    );
    faster_and_limited(sheet, &hybrids, &plain);
    Ok(())
}

fn faster_and_limited(sheet: &mut Sheet, hybrids: &[Response], plain: &[Response]) {
    let fastest_hybrid_s = least(&hybrids.iter().map(|r| r.duration_s).collect::<Vec<_>>());
    let fastest_plain_s = least(&plain.iter().map(|r| r.duration_s).collect::<Vec<_>>());
    sheet.refuted(
        "text: every hybrid is faster than the plain negative shapers",
        "faster",
        format!(
            "fastest hybrid {:.3} ms, NZV-NZV {:.3} ms",
            fastest_hybrid_s * 1e3,
            fastest_plain_s * 1e3
        ),
        fastest_hybrid_s < fastest_plain_s,
        "NZV-NZV is faster than all of them, and NZVD-NZVD faster than NEI-NZVD",
    );
    for response in hybrids.iter().chain(plain).filter(|r| r.name.ends_with("NEI")) {
        sheet.exceeded(
            format!("text: vibration of {} is limited to, %, at mode 2", response.name),
            "5",
            100.0 * response.residual_2,
            "the shaper of mode 1 lifts mode 2 by 3.4: the tolerance would have to be 5 % / 3.4",
        );
    }
}

/// Adds the statements about amplitude and robustness.
fn properties(sheet: &mut Sheet) -> Result<(), DesignError> {
    for pair in PAIRS {
        let (name, convolved) = negative(pair)?;
        let sums = convolved.partial_sums();
        sheet.exceeded(
            format!("text: largest partial sum of {name} (Q)"),
            "1",
            sums.max.max(-sums.min),
            "Q = 1 holds for each factor; the convolution of two reaches −3 and 5 times the step",
        );
    }
    let undamped = Mode {
        frequency_hz: 1.0,
        damping: 0.0,
    };
    for (name, negative, positive) in [
        ("NZV", ShaperKind::PsZv, ShaperKind::Zv),
        ("NZVD", ShaperKind::PsZvd, ShaperKind::Zvd),
        ("NEI", ShaperKind::PsEi, ShaperKind::Ei),
    ] {
        let width = |kind| -> Result<f64, DesignError> {
            let designed = shaper(kind, &[undamped])?;
            let found = insensitivity(designed.impulses(), &undamped, 0.05);
            Ok(found.map_or(f64::NAN, |i| i.high.unwrap_or(f64::INFINITY) - i.low))
        };
        let (negative, positive) = (width(negative)?, width(positive)?);
        sheet.refuted(
            format!("section 2.1: insensitivity of {name} against the positive one"),
            "increases",
            format!("{:.2} % instead of {:.2} %", 100.0 * negative, 100.0 * positive),
            negative > positive,
            "negative shapers are 10 to 15 % less insensitive",
        );
    }
    Ok(())
}
