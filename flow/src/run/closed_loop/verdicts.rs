//! The checks of the closed loop. `docs/closed-loop.md` derives their bounds.

use super::contours::Contours;
use super::{ClosedLoop, MOVES};
use crate::run::checks::{Check, Coverage};
use posicast_closed_loop::stage_run::{AxisFigures, Compared, Expected, Moved, Shaping};
use posicast_machine::machine_file::AxisSection;
use posicast_testbench::wording::counted;

impl ClosedLoop<'_> {
    /// All checks.
    pub(crate) fn checks(&self) -> Vec<Check> {
        let moved = self
            .compared
            .as_ref()
            .map(|compared| equals_model(compared, "the move to standstill"));
        let mut checks = Vec::from_iter(moved);
        checks.extend(self.contours.as_ref().and_then(Contours::check));
        checks.push(self.without_trouble());
        checks.push(self.follows());
        checks.extend(self.kept_steps());
        checks.extend(self.probed());
        checks.extend(self.pulsed());
        checks.extend(self.touched());
        checks.extend(self.calmer());
        checks.extend(self.limited());
        checks.extend(self.led_to_true_positions());
        checks
    }

    fn moves(&self) -> [&Moved; 4] {
        [&self.shaped, &self.unshaped, &self.slower, &self.faster]
    }

    /// No motor may lose a step; there is no check if no axis has steps.
    fn kept_steps(&self) -> Option<Check> {
        let axes = || {
            self.machine
                .axes
                .iter()
                .enumerate()
                .filter(|(_, axis)| axis.steps.is_some())
        };
        let moves = self.moves();
        let lost = axes().flat_map(|(index, axis)| {
            let lost = moves
                .iter()
                .map(move |moved| moved.lost_steps.get(index).copied().unwrap_or(0));
            lost.max().map(|most| (axis.name.as_str(), most))
        });
        let worst = lost.max_by_key(|(_, most)| *most)?;
        let motors = axes().filter(|(_, axis)| axis.stepper.is_some()).count();
        let detail = match worst {
            (_, 0) => format!(
                "{} moves of {}, {motors} with a simulated motor",
                moves.len(),
                counted(axes().count() as u64, "axis")
            ),
            (name, most) => format!(
                "axis {name} lost {}: lower its acceleration or its velocity",
                counted(most, "step")
            ),
        };
        // Without [axis.stepper] the drive is always at its steps: no motor was asked.
        let name = match motors {
            0 => "no step comes while its drive is off",
            _ => "no motor loses a step",
        };
        Some(Check::new(name, worst.1 == 0, detail))
    }

    fn without_trouble(&self) -> Check {
        let circles = self.circles.iter().flat_map(|circles| {
            let matched = circles.matched.as_ref().ok();
            std::iter::once(&circles.apart).chain(matched)
        });
        let moves = self.moves().into_iter().chain(&self.uncompensated);
        let of_moves = moves.map(|moved| moved.trouble.as_ref());
        let mut of_runs = of_moves
            .chain(circles.map(|circled| circled.trouble.as_ref()))
            .chain(self.contours.iter().flat_map(Contours::troubles));
        let runs = of_runs.clone().count();
        let circles = match &self.circles {
            Ok(circles) if circles.matched.is_ok() => String::new(),
            Err(_) if self.contours.is_some() => String::new(),
            Ok(_) => "; no circle with equal delays, because they do not fit the tables".to_owned(),
            Err(reason) => format!("; no circle: {reason}"),
        };
        let trouble = of_runs.find_map(|trouble| trouble);
        let held = || format!("{runs} runs, watched in every tick from reset to standstill{circles}");
        Check::new(
            "the stage carries out its commands without a fault",
            trouble.is_none(),
            trouble.map_or_else(held, ToString::to_string),
        )
    }

    /// Measured and expected figures of every move of every axis; empty for a move that was not made.
    fn figures(&self) -> impl Iterator<Item = (String, &AxisSection, &AxisFigures, &Expected)> {
        let moves = self.moves().into_iter().zip(&self.expected).zip(MOVES);
        moves.flat_map(move |((moved, expected), (shaping, factor))| {
            let name = match (shaping, factor) {
                (Shaping::Unshaped, _) => ", without its shaper".to_owned(),
                (Shaping::Shaped, 1.0) => String::new(),
                (Shaping::Shaped, factor) => format!(", its modes at {:.0} %", 100.0 * factor),
            };
            let axes = self.machine.axes.iter().zip(&moved.axes).zip(expected);
            axes.map(move |((axis, found), expected)| (format!("axis {}{name}", axis.name), axis, found, expected))
        })
    }

    /// Describes an axis whose move is too short for a verdict.
    fn motionless(&self) -> Option<String> {
        let axes = self.machine.axes.iter().zip(&self.expected[0]);
        let mut short = axes.filter(|(_, expected)| !expected.moves());
        short.next().map(|(axis, expected)| {
            format!(
                "axis {}: its move of {} is only {:.1} counts; below 100 counts the encoder's steps dominate the figures",
                axis.name,
                axis.unit.show(expected.distance, 3),
                expected.counts
            )
        })
    }

    /// The error of every move must stay below what the loop's lag, the move's frequency content, friction and counts
    /// allow.
    fn follows(&self) -> Check {
        let (mut compared, mut worst) = (0, None);
        for (name, axis, found, expected) in self.figures() {
            compared += 1;
            let (peak, allowed) = (found.tracking.peak, expected.tracking_allowed());
            if peak.is_nan() || peak > allowed {
                worst.get_or_insert_with(|| {
                    let figures = [peak, allowed, expected.figures.tracking.peak];
                    let [found, allowed, float] = axis.unit.show_compared(figures);
                    format!("{name}: an error of {found}, {float} expected from its loop, {allowed} allowed")
                });
            }
        }
        let name = "the axes follow as closely as their loops are designed to";
        let nothing = (compared == 0).then(|| "nothing moved".to_owned());
        if let Some(reason) = self.motionless().or(nothing) {
            return Check::not_exercised(name, false, &reason);
        }
        if worst.is_none() && self.moves().iter().any(|moved| moved.trouble.is_some()) {
            return Check::not_exercised(name, true, "a move was given up before its end");
        }
        let held = || {
            format!(
                "{compared} moves of an axis, each within its bound; tightest {}",
                self.tightest()
            )
        };
        Check::new(name, worst.is_none(), worst.unwrap_or_else(held))
    }

    /// The move that comes closest to its bound.
    fn tightest(&self) -> String {
        let part = |found: &AxisFigures, expected: &Expected| found.tracking.peak / expected.tracking_allowed();
        let moves = self
            .figures()
            .map(|(name, axis, found, expected)| (part(found, expected), name, axis, found, expected));
        let tightest = moves.max_by(|a, b| a.0.total_cmp(&b.0));
        tightest.map_or_else(String::new, |(_, name, axis, found, expected)| {
            let figures = [found.tracking.peak, expected.tracking_allowed()];
            let [found, allowed] = axis.unit.show_compared(figures);
            format!("{name}: {found} of {allowed}")
        })
    }

    /// The shapers must suppress the vibration for which they are designed. Returns a check for the axes whose moves
    /// exercise it, and a note about the others; nothing if no axis has a shaper.
    fn calmer(&self) -> Vec<Check> {
        if [&self.shaped, &self.unshaped]
            .iter()
            .any(|moved| moved.trouble.is_some())
        {
            // The check of the faults reports this failure.
            return vec![Check::not_exercised(
                CALMER,
                true,
                "the move was given up before its end",
            )];
        }
        let built = &self.stage.of_machine.config.axes;
        let mut rung = Vec::new();
        for (index, (axis, built)) in self.machine.axes.iter().zip(built).enumerate() {
            if axis.modes.is_empty() || built.shaper.table().taps().len() < 2 {
                continue;
            }
            let of = |at: usize| Some((self.moves()[at].axes.get(index)?, self.expected[at].get(index)?));
            let figures = of(0).zip(of(1)).map(|((shaped, expected), (unshaped, bare))| Ringing {
                found: shaped.residual.peak,
                without: unshaped.residual.peak,
                expected,
                bare,
                handovers: self.shaped.handovers,
                harsh: self.harsh.get(index).copied().unwrap_or(false),
            });
            rung.push((axis, figures));
        }
        // A move that is too short for any figure already fails in the check of the error.
        calmer(&rung, self.motionless().is_none())
    }

    /// With its error table, the load of an axis must rest at its target; there is no check if no axis has a table.
    fn led_to_true_positions(&self) -> Option<Check> {
        self.uncompensated.as_ref()?;
        let (mut failed, mut held, mut open) = (None, Vec::new(), Vec::new());
        for (index, of) in self.compensated() {
            let axis = &self.machine.axes[index];
            let [with, allowed, without] = axis.unit.show_compared([of.with.abs(), of.allowed, of.without.abs()]);
            let text = format!(
                "axis {}: the load rests {with} from its target with the table, {allowed} allowed, {without} without",
                axis.name
            );
            match (of.holds(), of.is_exercised()) {
                (false, _) => failed = failed.or(Some(text)),
                (true, true) => held.push(text),
                (true, false) => open.push(text),
            }
        }
        let name = "the error tables lead the loads to their true positions";
        let is_open = held.is_empty();
        held.extend(open);
        Some(match (failed, is_open) {
            (Some(text), _) => Check::new(name, false, text),
            (None, false) => Check::new(name, true, held.join("; ")),
            (None, true) if held.is_empty() => Check::not_exercised(name, true, "nothing moved"),
            (None, true) => {
                let found = format!("{}; choose a place with a larger error by --move", held.join("; "));
                Check::not_exercised(name, true, &found)
            }
        })
    }

    /// The error must stay below `following_error`; there is no check if no axis has that limit.
    fn limited(&self) -> Option<Check> {
        let limited = self.figures().filter_map(|(name, axis, found, _)| {
            let limit = axis.limits?.following_error?;
            Some((name, axis.unit, found.tracking.peak, limit))
        });
        let limited: Vec<_> = limited.collect();
        let beyond = limited.iter().find(|(_, _, peak, limit)| peak.is_nan() || peak > limit);
        let detail = beyond.map_or_else(
            || format!("{} moves of an axis", limited.len()),
            |(name, unit, peak, limit)| {
                let [found, allowed] = unit.show_compared([*peak, *limit]);
                format!("{name}: {found}, {allowed} allowed")
            },
        );
        (!limited.is_empty()).then(|| {
            let name = "the axes follow within their following_error";
            Check::new(name, beyond.is_none(), detail)
        })
    }
}

/// Name of the check of the vibration after a move.
const CALMER: &str = "the shapers suppress the vibration of the move that they are made for";

/// Vibration of the load of an axis about its place of rest after its move, in m or rad.
pub(crate) struct Ringing<'a> {
    /// With the shaper.
    pub(crate) found: f64,
    /// Without it.
    pub(crate) without: f64,
    /// Figures of the design with the shaper.
    pub(crate) expected: &'a Expected,
    /// Figures without it.
    pub(crate) bare: &'a Expected,
    /// Changes of the tap table in the move.
    pub(crate) handovers: u64,
    /// Whether the move has no limit of the jerk, though the machine file has one.
    pub(crate) harsh: bool,
}

/// The shapers of these axes must suppress the vibration for which they are designed; without figures the axis did not move. Returns a
/// check for the axes whose moves exercise it, and a note about the others, which holds if `open_passes`.
pub(crate) fn calmer(rung: &[(&AxisSection, Option<Ringing<'_>>)], open_passes: bool) -> Vec<Check> {
    let (mut louder, mut held, mut open) = (None, Vec::new(), Vec::new());
    for (axis, figures) in rung {
        let Some(figures) = figures else {
            open.push(format!("axis {} did not move", axis.name));
            continue;
        };
        let Ringing {
            found,
            without,
            expected,
            bare,
            ..
        } = *figures;
        let allowed = expected.ringing_allowed();
        let shown = [
            found,
            expected.figures.residual.peak,
            allowed,
            without,
            expected.handover,
        ];
        let [of_shaper, of_design, most, bare_found, of_handovers] = axis.unit.show_compared(shown);
        let handed = if expected.handover > 0.0 {
            format!(", {of_handovers} for {}", counted(figures.handovers, "hand-over"))
        } else {
            String::new()
        };
        let text = format!(
            "axis {}: {of_shaper} with its shaper, {of_design} expected from its design, {most} allowed{handed}, {bare_found} without",
            axis.name
        );
        if found.is_nan() || found > allowed || without.is_nan() || without > bare.ringing_allowed() {
            louder.get_or_insert(text);
        } else if expected.exercises(bare) && without > allowed && expected.moves() {
            let harsh = if figures.harsh {
                ", by a move without a limit of the jerk"
            } else {
                ""
            };
            held.push(text + harsh);
        } else {
            open.push(text);
        }
    }
    let mut checks = Vec::new();
    if let Some(detail) = louder {
        checks.push(Check::new(CALMER, false, detail));
    } else if !held.is_empty() {
        checks.push(Check::new(CALMER, true, held.join("; ")));
    }
    if !open.is_empty() {
        checks.push(Check::not_exercised(
            "every shaper is exercised by the move",
            open_passes,
            &format!("{}: too small to distinguish from counts and friction", open.join("; ")),
        ));
    }
    checks
}

/// The check of a comparison; `end` names the end of a complete one.
pub(super) fn equals_model(compared: &Compared, end: &str) -> Check {
    let name = "the stage's RTL equals the bit-exact model in every clock of the closed loop";
    named_equals_model(name, compared, ("from reset over switch-on", end))
}

/// The same under another name, with the way and the end of a complete comparison in words.
pub(crate) fn named_equals_model(name: &'static str, compared: &Compared, (way, end): (&str, &str)) -> Check {
    let reach = if compared.whole {
        format!("{way} to {end}")
    } else {
        format!("from reset on, not to {end}")
    };
    let detail = match (&compared.first, &compared.trouble) {
        (Some(first), _) => {
            let [expected, found] = first.shown();
            format!(
                "{} differs first in clock {}: expected {expected}, found {found}; {} in {} clocks",
                first.signal,
                first.time,
                counted(compared.mismatches, "difference"),
                compared.clocks
            )
        }
        (None, Some(trouble)) => format!(
            "{} clocks, no mismatch until the run was given up: {trouble}",
            compared.clocks
        ),
        (None, None) => format!("{} clocks, {reach}, no mismatch", compared.clocks),
    };
    let coverage = match (&compared.first, &compared.trouble) {
        (None, Some(_)) => Coverage::GivenUp,
        _ => Coverage::Enough,
    };
    Check {
        coverage,
        ..Check::new(
            name,
            compared.clocks > 0 && compared.mismatches == 0 && compared.trouble.is_none(),
            detail,
        )
    }
}
