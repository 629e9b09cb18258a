//! The closed loop of a run: the stage on its simulated machine, in Verilator beside the model, and in the model alone.

mod pictures;
mod report;

use super::checks::Check;
use crate::bench::{self, Simulator};
use crate::failure::Failure;
use crate::progress;
use crate::stage::Stage;
use posicast_model::spec::Machine;
use posicast_testbench::blocks::Sources;
use posicast_testbench::stage_run;
use posicast_testbench::stage_run::{Circle, Circled, Compared, Moved, Shaping, StageRun, StageRunError};
use posicast_testbench::wording::counted;
use std::path::Path;
use std::sync::Mutex;
use std::thread;

pub(crate) use report::StageDocument;

/// Runs at a time: one may be Verilator's, which takes as long as the others together.
const AT_ONCE: usize = 2;
/// Machines that the shapers were not made for: their frequencies, as parts of those in the file.
const SLOWER: f64 = 0.9;
const FASTER: f64 = 1.1;

/// What the closed loop did.
pub(crate) struct ClosedLoop<'a> {
    machine: &'a Machine,
    stage: &'a Stage,
    /// Beside the Verilog; none without Verilator.
    compared: Option<Compared>,
    shaped: Moved,
    unshaped: Moved,
    slower: Moved,
    faster: Moved,
    circles: Option<Circles>,
}

/// The circle of the first two axes.
struct Circles {
    circle: Circle,
    /// Each shaper with its own delay.
    apart: Circled,
    /// All shapers with the same delay; the reason where there are no such tables.
    matched: Result<Circled, String>,
}

/// What is run, each on a stage of its own.
#[derive(Clone, Copy)]
enum Task<'a> {
    Compare,
    Move(Shaping, f64),
    Circle(&'a StageRun<'a>),
}

/// What came of it.
enum Done {
    Compared(Compared),
    Moved(Moved),
    Circled(Circled),
}

/// The machine file, its hardware, and what runs it.
pub(crate) struct Job<'a> {
    pub(crate) machine: &'a Machine,
    pub(crate) path: &'a Path,
    pub(crate) stage: &'a Stage,
    pub(crate) sources: &'a Sources,
    pub(crate) simulator: Simulator,
    pub(crate) seed: u64,
}

impl<'a> Job<'a> {
    /// Runs everything.
    pub(crate) fn run(&self) -> Result<ClosedLoop<'a>, Failure> {
        let refused = |error| failure(error, self.path);
        let own = StageRun::new(self.machine, &self.stage.of_machine.config, self.seed).map_err(refused)?;
        let circle = Circle::of_machine(self.machine);
        let delays = |equal| match circle {
            Some(_) => StageRun::with_delays(self.machine, equal, self.seed).map_err(|error| error.to_string()),
            None => Ok(None),
        };
        let (apart, matched) = (delays(false), delays(true));

        let mut tasks = Vec::new();
        if self.simulator == Simulator::Verilator {
            tasks.push(Task::Compare);
        }
        let rounds = [&apart, &matched]
            .into_iter()
            .flat_map(|run| run.as_ref().ok()?.as_ref());
        tasks.extend(rounds.map(Task::Circle));
        let moves = [
            (Shaping::Shaped, 1.0),
            (Shaping::Unshaped, 1.0),
            (Shaping::Shaped, SLOWER),
            (Shaping::Shaped, FASTER),
        ];
        tasks.extend(moves.map(|(shaping, factor)| Task::Move(shaping, factor)));
        let done = self.all(&own, circle, &tasks).map_err(refused)?;

        let (mut compared, mut moves, mut circles) = (None, Vec::new(), Vec::new());
        for done in done {
            match done {
                Done::Compared(result) => compared = Some(result),
                Done::Moved(result) => moves.push(result),
                Done::Circled(result) => circles.push(result),
            }
        }
        let lost = || Failure::from(miette::miette!("a run of the closed loop is missing"));
        let [shaped, unshaped, slower, faster] = moves.try_into().map_err(|_| lost())?;
        let mut circles = circles.into_iter();
        let circles = match (circle, circles.next()) {
            (Some(circle), Some(apart)) => Some(Circles {
                circle,
                apart,
                matched: match (circles.next(), matched) {
                    (Some(circled), _) => Ok(circled),
                    (None, Err(reason)) => Err(reason),
                    (None, Ok(_)) => return Err(lost()),
                },
            }),
            _ => None,
        };
        Ok(ClosedLoop {
            machine: self.machine,
            stage: self.stage,
            compared,
            shaped,
            unshaped,
            slower,
            faster,
            circles,
        })
    }

    /// Does these, some at a time; what came of them in their order.
    fn all(&self, own: &StageRun<'_>, circle: Option<Circle>, tasks: &[Task<'_>]) -> Result<Vec<Done>, StageRunError> {
        let bar = progress::bar("closed loop", tasks.len() as u64);
        let next = Mutex::new(tasks.iter().enumerate());
        let results = Mutex::new(Vec::new());
        let worker = || {
            loop {
                let Some((index, task)) = bench::locked(&next).next() else {
                    return;
                };
                let result = self.one(own, circle, *task);
                if result.is_err() {
                    // What is left is not begun: the error ends the command.
                    bench::locked(&next).by_ref().for_each(drop);
                }
                bench::locked(&results).extend(result.transpose().map(|result| (index, result)));
                bar.inc(1);
            }
        };
        thread::scope(|scope| {
            for _ in 1..AT_ONCE {
                scope.spawn(worker);
            }
            worker();
        });
        bar.finish_and_clear();
        let mut results = results.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
        results.sort_by_key(|(index, _)| *index);
        results.into_iter().map(|(_, result)| result).collect()
    }

    fn one(&self, own: &StageRun<'_>, circle: Option<Circle>, task: Task<'_>) -> Result<Option<Done>, StageRunError> {
        Ok(match task {
            Task::Compare => {
                let sources = self.sources.reached_by(&self.stage.block)?;
                let device = self.simulator.device(&self.stage.block, &sources, self.seed)?;
                Some(Done::Compared(own.side_by_side(device)?))
            }
            Task::Move(shaping, factor) => Some(Done::Moved(own.moved(shaping, factor)?)),
            Task::Circle(run) => match circle {
                Some(circle) => Some(Done::Circled(run.circle(&circle)?)),
                None => None,
            },
        })
    }
}

/// How what could not be run ends the command.
fn failure(error: StageRunError, path: &Path) -> Failure {
    match error {
        StageRunError::Bench(error) => bench::failure(error),
        other => Failure::because(other).in_file(path),
    }
}

/// Says at the start what the closed loop of this run will not do.
pub(crate) fn announce(simulator: Simulator, has_command: bool) {
    if simulator != Simulator::Verilator {
        crate::output::say(
            "note: the stage's Verilog is compared in Verilator alone; the closed loop runs in the bit-exact model.",
        );
    }
    if has_command {
        crate::output::say("note: --command is for the shapers; the closed loop makes the default move of each axis.");
    }
}

impl ClosedLoop<'_> {
    /// What must hold.
    pub(crate) fn checks(&self) -> Vec<Check> {
        let mut checks = Vec::from_iter(self.compared.as_ref().map(equals_model));
        checks.push(self.without_trouble());
        checks.extend(self.calmer());
        checks.extend(self.follows());
        checks
    }

    fn moves(&self) -> [&Moved; 4] {
        [&self.shaped, &self.unshaped, &self.slower, &self.faster]
    }

    fn without_trouble(&self) -> Check {
        let circles = self.circles.iter().flat_map(|circles| {
            let matched = circles.matched.as_ref().ok();
            std::iter::once(&circles.apart).chain(matched)
        });
        let of_moves = self.moves().map(|moved| moved.trouble.as_ref());
        let mut of_runs = of_moves
            .into_iter()
            .chain(circles.map(|circled| circled.trouble.as_ref()));
        let runs = of_runs.clone().count();
        let trouble = of_runs.find_map(|trouble| trouble);
        Check {
            name: "the stage does what it is told, without a fault",
            passed: trouble.is_none(),
            detail: trouble.map_or_else(|| format!("{runs} runs from reset to standstill"), ToString::to_string),
        }
    }

    /// The shapers take away the vibration that they are for; no check where none is for any.
    fn calmer(&self) -> Option<Check> {
        let axes = self.machine.axes.iter().zip(&self.stage.of_machine.config.axes);
        let figures = self.shaped.axes.iter().zip(&self.unshaped.axes);
        let mut louder = None;
        let mut shaped_axes = 0;
        for ((axis, built), (shaped, unshaped)) in axes.zip(figures) {
            if axis.modes.is_empty() || built.shaper.table().taps().len() < 2 {
                continue;
            }
            shaped_axes += 1;
            let (found, allowed) = (shaped.residual.peak, stage_run::residual_allowed(axis, unshaped));
            if found.is_nan() || found > allowed {
                louder.get_or_insert_with(|| {
                    format!(
                        "axis {}: {} µ with its shaper, {} µ without, {} µ allowed",
                        axis.name,
                        report::micro(found),
                        report::micro(unshaped.residual.peak),
                        report::micro(allowed)
                    )
                });
            }
        }
        (shaped_axes > 0).then(|| Check {
            name: "the shapers take the vibration of the move that they are made for",
            passed: louder.is_none(),
            detail: louder.unwrap_or_else(|| "every axis, to its tolerance and half a count".to_owned()),
        })
    }

    /// The error stays below `following_error`; no check where no axis has that.
    fn follows(&self) -> Option<Check> {
        let axes = self.machine.axes.iter().zip(&self.shaped.axes);
        let limited = axes.filter_map(|(axis, figures)| {
            let limit = axis.limits?.following_error?;
            Some((axis, figures.tracking.peak, limit))
        });
        let limited: Vec<_> = limited.collect();
        let beyond = limited.iter().find(|(_, peak, limit)| peak.is_nan() || peak > limit);
        (!limited.is_empty()).then(|| Check {
            name: "the axes follow within their following_error",
            passed: beyond.is_none(),
            detail: beyond.map_or_else(
                || "the whole move".to_owned(),
                |(axis, peak, limit)| {
                    let (found, allowed) = (report::micro(*peak), report::micro(*limit));
                    format!("axis {}: {found} µ, {allowed} µ allowed", axis.name)
                },
            ),
        })
    }
}

fn equals_model(compared: &Compared) -> Check {
    let reach = match compared.whole {
        true => "from reset over switch-on and the move to standstill",
        false => "from reset on, not to the end of the move",
    };
    let detail = match (&compared.first, &compared.trouble) {
        (Some(first), _) => format!(
            "{} differs first in clock {}: expected {:#x}, found {:#x}; {} in {} clocks",
            first.signal,
            first.clock,
            first.expected,
            first.actual,
            counted(compared.mismatches, "difference"),
            compared.clocks
        ),
        (None, Some(trouble)) => trouble.to_string(),
        (None, None) => format!("{} clocks, {reach}, no mismatch", compared.clocks),
    };
    Check {
        name: "the stage's RTL equals the bit-exact model in every clock of the closed loop",
        passed: compared.mismatches == 0 && compared.trouble.is_none(),
        detail,
    }
}
