//! The closed loop of a run: the stage on its simulated machine, in Verilator beside the model, and in the model
//! alone.

mod contours;
mod hosted;
mod pictures;
mod probing;
mod pulses;
mod report;
mod step_lines;
mod touches;
pub(super) mod verdicts;

use crate::bench::{self, Simulator};
use crate::failure::Failure;
use crate::hardware::Stage;
use crate::observer::Observer;
use posicast_closed_loop::stage_run::{
    Circle, Circled, Compared, Compensated, Contoured, Expected, Moved, Shaping, StageRun, StageRunError,
};
use posicast_machine::hardware::StageHardware;
use posicast_machine::machine_file::Machine;
use posicast_machine::motion::AxisMove;
use posicast_testbench::blocks::Sources;
use posicast_testbench::lockstep::Device;
use std::path::Path;
use std::sync::{Mutex, OnceLock};
use std::thread;

pub use contours::{FollowedPath, FollowedRow, PathDistance};
pub(crate) use contours::{NamedContour, contour};
pub use report::{Compensation, DrivenCircle, MovedAxis, PathError, StageFigures, TickSchedule};

use contours::Contours;

/// Frequency factors of machines for which the shapers were not designed.
const SLOWER: f64 = 0.9;
const FASTER: f64 = 1.1;
/// The moves, as shaping and frequency factor.
const MOVES: [(Shaping, f64); 4] = [
    (Shaping::Shaped, 1.0),
    (Shaping::Unshaped, 1.0),
    (Shaping::Shaped, SLOWER),
    (Shaping::Shaped, FASTER),
];

/// Results of the closed loop.
pub(crate) struct ClosedLoop<'a> {
    machine: &'a Machine,
    moves: &'a [AxisMove],
    stage: &'a Stage,
    /// Comparison with the Verilog; `None` without Verilator.
    compared: Option<Compared>,
    shaped: Moved,
    unshaped: Moved,
    slower: Moved,
    faster: Moved,
    /// The shaped move without the error tables; `None` if no axis has one.
    uncompensated: Option<Moved>,
    /// Expected figures of these four moves, by axis.
    expected: [Vec<Expected>; 4],
    /// For each axis, whether its move has no jerk limit, so that its acceleration changes from tick to tick.
    harsh: Vec<bool>,
    /// The circles; the error says why there are none.
    circles: Result<Circles, String>,
    /// The path of `--contour`.
    contours: Option<Contours<'a>>,
    /// The axes that are homed by a probe.
    probed: Vec<probing::Probed>,
    /// The axes that have a position compare.
    pulsed: Vec<pulses::Pulsed>,
    /// The axes that a probe touched with, of a stage with a capture line.
    touched: Vec<touches::Touched>,
}

/// Results of the circle of the first two axes.
struct Circles {
    circle: Circle,
    /// Result with each shaper's own delay.
    apart: Circled,
    /// Result with equal delays of all shapers; the error says why there are no such tables.
    matched: Result<Circled, String>,
}

/// A run, on a stage of its own.
#[derive(Clone, Copy)]
enum Task<'a> {
    Compare,
    Move(Shaping, f64),
    MoveUncompensated,
    Circle(&'a StageRun<'a>),
    Contour(&'a StageRun<'a>),
    CompareContour,
}

/// Result of a run.
enum Done {
    Compared(Compared),
    Moved(Moved),
    MovedUncompensated(Moved),
    Circled(Circled),
    Contoured(Contoured),
    ContourCompared(Compared),
}

/// The machine file, its hardware, and the simulator.
pub(crate) struct Job<'a> {
    pub(crate) machine: &'a Machine,
    pub(crate) moves: &'a [AxisMove],
    /// The circle; the error says why there is none.
    pub(crate) circle: Result<Circle, String>,
    /// The path of `--contour`.
    pub(crate) contour: Option<&'a NamedContour>,
    pub(crate) path: &'a Path,
    pub(crate) stage: &'a Stage,
    pub(crate) sources: &'a Sources,
    pub(crate) simulator: Simulator,
    pub(crate) seed: u64,
}

impl<'a> Job<'a> {
    /// Runs everything; `second` is set when a second thread may work.
    pub(crate) fn run(&self, second: &OnceLock<()>, observer: &dyn Observer) -> Result<ClosedLoop<'a>, Failure> {
        let refused = |error| failure(error, self.path);
        let own = StageRun::with_moves(self.machine, &self.stage.of_machine.config, self.seed, self.moves)
            .map_err(refused)?;
        let circle = self.circle.clone();
        let delays = |equal| {
            if self.contour.is_none() {
                circle.clone()?;
            }
            let run = StageRun::with_delays(self.machine, equal, self.seed).map_err(|error| error.to_string())?;
            run.ok_or_else(|| "its tap tables make no stage".to_owned())
        };
        let (apart, matched) = (delays(false), delays(true));

        let mut tasks = Vec::new();
        if self.simulator == Simulator::Verilator {
            tasks.push(Task::Compare);
        }
        let rounds = apart.iter().chain(apart.as_ref().ok().and(matched.as_ref().ok()));
        match self.contour {
            None => tasks.extend(rounds.map(Task::Circle)),
            Some(_) => {
                tasks.extend(rounds.map(Task::Contour));
                if self.simulator == Simulator::Verilator {
                    tasks.push(Task::CompareContour);
                }
            }
        }
        let mut expected = [const { Vec::new() }; 4];
        for (expected, (shaping, factor)) in expected.iter_mut().zip(MOVES) {
            *expected = own.expected(shaping, factor).map_err(refused)?;
        }
        tasks.extend(MOVES.map(|(shaping, factor)| Task::Move(shaping, factor)));
        if self.machine.axes.iter().any(|axis| axis.error_table.is_some()) {
            tasks.push(Task::MoveUncompensated);
        }
        let done = self.all(&own, circle.as_ref().ok().copied(), &tasks, second, observer);
        let done = done.map_err(refused)?;

        let (mut compared, mut moves, mut circles) = (None, Vec::new(), Vec::new());
        let (mut contours, mut contour_compared, mut uncompensated) = (Vec::new(), None, None);
        for done in done {
            match done {
                Done::Compared(result) => compared = Some(result),
                Done::Moved(result) => moves.push(result),
                Done::MovedUncompensated(result) => uncompensated = Some(result),
                Done::Circled(result) => circles.push(result),
                Done::Contoured(result) => contours.push(result),
                Done::ContourCompared(result) => contour_compared = Some(result),
            }
        }
        let hardware = StageHardware {
            of_machine: self.stage.of_machine.clone(),
            component: self.stage.block.component().clone(),
        };
        let probed = probing::all(self.machine, &hardware, self.seed).map_err(refused)?;
        let pulsed = pulses::all(self.machine, &hardware, self.seed).map_err(refused)?;
        let touched = touches::all(self.machine, &hardware, self.seed).map_err(refused)?;
        let lost = || Failure::input("a run of the closed loop is missing");
        let [shaped, unshaped, slower, faster] = moves.try_into().map_err(|_| lost())?;
        let mut contoured = contours.into_iter();
        let contours = match (self.contour, &apart) {
            (None, _) => None,
            (Some(_), Err(reason)) => return Err(Failure::input(format!("--contour: {reason}"))),
            (Some(path), Ok(_)) => Some(Contours {
                path,
                compared: contour_compared,
                apart: contoured.next().ok_or_else(lost)?,
                matched: match &matched {
                    Ok(_) => Ok(contoured.next().ok_or_else(lost)?),
                    Err(reason) => Err(reason.clone()),
                },
            }),
        };
        let mut circled = circles.into_iter();
        let circles = match (circle, apart) {
            (Ok(circle), Ok(_)) => Ok(Circles {
                circle,
                apart: circled.next().ok_or_else(lost)?,
                matched: match matched {
                    Ok(_) => Ok(circled.next().ok_or_else(lost)?),
                    Err(reason) => Err(reason),
                },
            }),
            (Err(reason), _) | (_, Err(reason)) => Err(reason),
        };
        Ok(ClosedLoop {
            machine: self.machine,
            moves: self.moves,
            stage: self.stage,
            compared,
            shaped,
            unshaped,
            slower,
            faster,
            uncompensated,
            expected,
            harsh: (0..self.machine.axes.len()).map(|axis| own.is_harsh(axis)).collect(),
            circles,
            contours,
            probed,
            pulsed,
            touched,
        })
    }

    /// Runs these tasks on two threads, the second one from when it may work, and returns their results in order. Two suffice: Verilator's
    /// takes as long as the others together.
    fn all(
        &self,
        own: &StageRun<'_>,
        circle: Option<Circle>,
        tasks: &[Task<'_>],
        second: &OnceLock<()>,
        observer: &dyn Observer,
    ) -> Result<Vec<Done>, StageRunError> {
        let bar = observer.begin("closed loop", Some(tasks.len() as u64));
        let next = Mutex::new(tasks.iter().enumerate());
        let results = Mutex::new(Vec::new());
        let worker = || {
            loop {
                let Some((index, task)) = bench::locked(&next).next() else {
                    return;
                };
                let result = self.one(own, circle, *task);
                if result.is_err() {
                    // The remaining tasks are not begun: the error ends the command.
                    bench::locked(&next).by_ref().for_each(drop);
                }
                bench::locked(&results).extend(result.transpose().map(|result| (index, result)));
                bar.advance(1);
            }
        };
        thread::scope(|scope| {
            scope.spawn(|| {
                second.wait();
                worker();
            });
            worker();
        });
        drop(bar);
        let mut results = results.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
        results.sort_by_key(|(index, _)| *index);
        results.into_iter().map(|(_, result)| result).collect()
    }

    /// Opens the stage's Verilog.
    fn device(&self) -> Result<Box<dyn Device>, StageRunError> {
        let sources = self.sources.reached_by(&self.stage.block)?;
        Ok(self.simulator.device(&self.stage.block, &sources, self.seed)?)
    }

    fn one(&self, own: &StageRun<'_>, circle: Option<Circle>, task: Task<'_>) -> Result<Option<Done>, StageRunError> {
        Ok(match task {
            Task::Compare => Some(Done::Compared(own.side_by_side(self.device()?)?)),
            Task::Move(shaping, factor) => Some(Done::Moved(own.moved(shaping, factor)?)),
            Task::MoveUncompensated => {
                let uncompensated = own.clone().without_error_tables();
                Some(Done::MovedUncompensated(uncompensated.moved(Shaping::Shaped, 1.0)?))
            }
            Task::Contour(run) => match self.contour {
                Some(path) => Some(Done::Contoured(run.contour(&path.contour)?)),
                None => None,
            },
            Task::CompareContour => match self.contour {
                Some(path) => {
                    let device = self.device()?;
                    Some(Done::ContourCompared(own.contour_side_by_side(device, &path.contour)?))
                }
                None => None,
            },
            Task::Circle(run) => match circle {
                Some(circle) => Some(Done::Circled(run.circle(&circle)?)),
                None => None,
            },
        })
    }
}

/// Returns the circle of a run, with the radius of `--radius` in the unit of the first axis. If there is none, the
/// report gives the reason; it is a failure if `--radius` requested the circle.
pub(crate) fn circle(
    machine: &Machine,
    radius: Option<f64>,
    has_stage: bool,
) -> Result<Result<Circle, String>, Failure> {
    let refused = |reason: String| {
        Failure::input(format!("--radius: no circle is driven: {reason}"))
            .with_help("leave out --radius, or give one that fits")
    };
    match (radius, machine.axes.first()) {
        (Some(_), _) if !has_stage => Err(refused("the machine has no stage".to_owned())),
        (Some(radius), Some(axis)) => {
            let circle = Circle::with_radius(machine, axis.unit.to_si(radius));
            circle.map(Ok).map_err(|reason| refused(reason.to_string()))
        }
        _ => Ok(Circle::of_machine(machine).map_err(|reason| reason.to_string())),
    }
}

impl ClosedLoop<'_> {
    /// Rest position of the load of each axis with an error table: index of the axis, and figures.
    fn compensated(&self) -> impl Iterator<Item = (usize, Compensated)> {
        let without = self.uncompensated.iter();
        let built = &self.stage.of_machine.config.axes;
        without.flat_map(move |without| {
            let axes = self.machine.axes.iter().zip(built).zip(&self.expected[0]).enumerate();
            axes.filter_map(move |(index, ((axis, built), expected))| {
                let figures = Compensated::of_axis(axis, built, index, [&self.shaped, without], expected);
                figures.map(|figures| (index, figures))
            })
        })
    }
}

/// Turns an error of a stage run into the failure of a command.
fn failure(error: StageRunError, path: &Path) -> Failure {
    match error {
        StageRunError::Bench(error) => bench::failure(error),
        other => Failure::because(other).in_file(path),
    }
}

/// Reports at the start what the closed loop of this run will leave out.
pub(crate) fn announce(simulator: Simulator, has_command: bool, observer: &dyn Observer) {
    if simulator != Simulator::Verilator {
        observer.say(
            "note: the stage's Verilog is compared in Verilator alone; the closed loop runs in the bit-exact model.",
        );
    }
    if has_command {
        observer.say(
            "note: --command drives the shapers only; in the closed loop each axis makes the move of --move, or its default move.",
        );
    }
}
