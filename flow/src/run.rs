//! `posicast run`: goes the whole way from the machine file to the verdict.
//!
//! The steps are: design → quantise → generate → lock step, waveforms compared, plant measured, estimated, all at once → reported. Later
//! steps use the decisions of earlier ones: the tap table is made once. The folder appears at the end, also after a failed check: it contains all
//! files that `generate` writes, and the evidence.

mod advice;
mod checks;
mod closed_loop;
mod excerpt;
mod gain;
mod inline;
mod options;
mod page;
mod pictures;
mod report;
mod sentence;
mod waves;

use crate::Outcome;
use crate::bench::{self, Simulator};
use crate::blocks;
use crate::command::{self, Words};
use crate::design::{self, DesignReport};
use crate::failure::Failure;
use crate::generate;
use crate::hardware::Built;
use crate::input;
use crate::machine::{self, MachineFile};
use crate::moves;
use crate::observer::Observer;
use crate::plot::{self, Panel};
use crate::simulate::simulate_axes;
use crate::text::json_text;
use crate::{sopc, synth};
use closed_loop::{ClosedLoop, NamedContour};
use inline::InlineLoop;
use posicast_closed_loop::stage_run::Circle;
use posicast_machine::compare::{DEFAULT_BAND, compare};
use posicast_machine::machine_file::Machine;
use posicast_machine::motion::AxisMove;
use posicast_synth::package::Package;
use posicast_synth::yosys::{Estimate, Yosys, YosysError};
use posicast_testbench::blocks::{Block, Sources};
use posicast_testbench::shaper::MachineShapers;
use report::RunReport;
use std::panic::resume_unwind;
use std::path::PathBuf;
use std::sync::OnceLock;
use std::thread::{self, ScopedJoinHandle};

pub use advice::Advice;
pub use checks::Check;
pub use closed_loop::{
    Compensation, DrivenCircle, FollowedPath, FollowedRow, MovedAxis, PathDistance, PathError, StageFigures,
    TickSchedule,
};
pub use inline::{InlineRunAxis, InlineRunFigures};
pub use options::Options;
pub use report::{Document, PlantStep, RunAxis, RunVerdict, StepOnPlant};
pub use sentence::RunSentence;

/// Runs all steps: design, Verilog, simulation, comparison, estimate, verdict.
///
/// # Errors
/// [`Failure`] for files that cannot be read, built, simulated or written, and for a missing tool. A failed check is not an error but gives
/// [`Outcome::failed`].
pub fn run(options: &Options, observer: &dyn Observer) -> Result<Outcome<Document>, Failure> {
    let path = options.machine.as_path();
    let file = machine::read(path)?;
    let machine = &file.machine;
    let design = DesignReport::new(machine, path)?;
    design.warn(observer);
    let board = sopc::board(machine, path)?;
    let built = Built::new(&design, path, observer)?;
    let plan = Plan::new(options, &design, &built, observer)?;
    let axes = simulate_axes(machine, &design.design, &built.shapers, &plan.words)?;
    let top = blocks::shapers(machine, built.shapers.clone(), &plan.words)?;

    let mut package = opened(options, &file, &plan)?;
    let files = generate::add(&mut package, (&file, path), &built, board, observer)?;
    let rtl = Rtl {
        top: &top,
        built: &built,
        sources: Sources::found(files),
    };
    rtl.require_tools(plan.simulator)?;
    let shaper_sources = rtl.sources.reached_by(rtl.top).map_err(bench::failure)?;
    let shapers = waves::Job {
        machine,
        top: rtl.top,
        sources: &shaper_sources,
        simulator: plan.simulator,
        seed: options.seed,
        observer,
    };
    let check = || {
        let lint = checks::lint(plan.simulator, &rtl.sources)?;
        let estimate = estimate(&plan, machine, rtl.sources.files(), observer)?;
        Ok((lint, estimate, compare(machine, DEFAULT_BAND)))
    };
    // None of these needs the result of another. The stage beside its Verilog takes longest, on one thread; so on two cores a second thread
    // does the rest, and is free for the stage's other runs then.
    let is_free = OnceLock::new();
    let has_cores = thread::available_parallelism().is_ok_and(|cores| cores.get() > 2);
    let (looped, lockstep, waves, checked) = thread::scope(|scope| {
        let looped = scope.spawn(|| {
            let closed_loop = run_stage(options, (machine, &plan), &rtl, &is_free, observer)?;
            Ok((
                closed_loop,
                inline::run((&design, path), &plan, &rtl, options.seed, observer)?,
            ))
        });
        let frees = Frees(&is_free);
        if has_cores {
            frees.now();
        }
        let checked = (has_cores || built.stage.is_none()).then(|| scope.spawn(check));
        let lockstep = shapers.lockstep(options.cycles);
        let waves = shapers.waves(&mut package, &design.design, &axes);
        let checked = checked.map_or_else(check, joined);
        frees.now();
        (joined(looped), lockstep, waves, checked)
    });
    // Where several fail, the error is that of the first in this order.
    let (lockstep, waves) = (lockstep?, waves?);
    let (lint, estimate, kinds) = checked?;
    let (closed_loop, inline) = looped?;

    let mut checks = Vec::from_iter(lint);
    checks.push(checks::moves(machine, &axes));
    checks.extend(checks::all(plan.simulator, machine, &design.design, &lockstep, &waves));
    checks.extend(checks::link(built.link.as_ref()));
    checks.extend(checks::buses(&built.buses));
    checks.extend(estimate.as_ref().and_then(|e| checks::fits(machine, e)));
    checks.extend(closed_loop.iter().flat_map(ClosedLoop::checks));
    checks.extend(inline.iter().flat_map(InlineLoop::checks));
    let report = RunReport {
        machine,
        design: &design,
        axes: &axes,
        plants: report::on_plants(machine, &design.design)?,
        simulator: plan.simulator,
        seed: options.seed,
        lockstep: &lockstep,
        waves: &waves,
        estimate: estimate.as_ref(),
        closed_loop: closed_loop.as_ref(),
        inline: inline.as_ref(),
        checks: &checks,
        words: &plan.words,
        gains: gain::of_axes(machine, &plan.words, &axes, |axis| {
            closed_loop.as_ref().and_then(|of| of.gain(axis))
        }),
        kinds: &kinds,
        command: options.command_line(),
    };
    let mut document = report.json();
    add_report(&mut package, &report, &document)?;

    let root = package.root().to_owned();
    let committed = package.commit().map_err(Failure::because)?;
    generate::tell(&committed, observer);
    let files = committed.files.iter();
    document.files = files
        .map(|file| file.strip_prefix(&root).unwrap_or(file).to_owned())
        .collect();
    document.folder = root;
    let failed: Vec<_> = checks.iter().filter(|c| !c.passed).map(|c| c.name).collect();
    Ok(Outcome {
        failed: (!failed.is_empty()).then(|| format!("failed: {}", failed.join(", "))),
        ..Outcome::passed(document)
    })
}

/// Decisions about a run, made before anything long begins.
struct Plan {
    /// The move of each axis.
    moves: Vec<AxisMove>,
    /// The command of that move, or of the command file, per axis.
    words: Words,
    /// The path of the closed loop in place of the circle.
    contour: Option<NamedContour>,
    /// The circle of the closed loop; the error says why there is none.
    circle: Result<Circle, String>,
    /// Names and contents of the copies of files that options name.
    inputs: Vec<(String, Vec<u8>)>,
    simulator: Simulator,
    /// The tool that estimates the area, if it is installed.
    yosys: Option<Yosys>,
}

impl Plan {
    fn new(
        options: &Options,
        design: &DesignReport<'_>,
        built: &Built<'_>,
        observer: &dyn Observer,
    ) -> Result<Self, Failure> {
        let (machine, motion) = (design.machine, &options.motion);
        let has_stage = built.stage.is_some();
        let moves = match options.contour {
            Some(_) => moves::by_default(machine),
            None => motion.moves(machine, has_stage)?,
        };
        let contour = closed_loop::contour(machine, options.path().as_ref(), motion, has_stage, observer)?;
        let circle = match &contour {
            Some(_) => Err("--contour drives another path".to_owned()),
            None => closed_loop::circle(machine, options.radius, has_stage)?,
        };
        let inputs = options.files().filter_map(input::copy);
        let inputs = inputs.collect::<Result<Vec<_>, Failure>>()?;
        let command = motion.command.as_deref();
        let words = command::words(machine, &design.design, command, &moves, observer)?;
        let simulator = Simulator::choose(options.simulator, observer)?;
        if has_stage {
            closed_loop::announce(simulator, command.is_some(), observer);
        }
        Ok(Self {
            moves,
            words,
            contour,
            circle,
            inputs,
            simulator,
            yosys: installed_yosys(observer)?,
        })
    }
}

/// The Verilog of a run, and the blocks that it describes.
struct Rtl<'a> {
    /// The shapers of all axes.
    top: &'a MachineShapers,
    built: &'a Built<'a>,
    sources: Sources,
}

impl Rtl<'_> {
    /// The inline shaper, with registers or without.
    fn inline(&self) -> Option<&dyn Block> {
        let without = self.built.inline.as_ref().map(|inline| inline as &dyn Block);
        let with = self.built.inline_registers.as_ref().map(|inline| inline as &dyn Block);
        without.or(with)
    }

    /// Refuses a run for which a tool is missing, before anything is simulated and not only in the step that needs it.
    fn require_tools(&self, simulator: Simulator) -> Result<(), Failure> {
        let stage = self.built.stage.as_ref().filter(|_| simulator == Simulator::Verilator);
        let inline = self.inline().filter(|_| simulator == Simulator::Verilator);
        let simulated = std::iter::once(self.top as &dyn Block)
            .chain(stage.map(|stage| &stage.block as &dyn Block))
            .chain(inline);
        let simulated = simulated.map(|block| Ok((block, self.sources.reached_by(block).map_err(bench::failure)?)));
        let simulated = simulated.collect::<Result<Vec<_>, Failure>>()?;
        let simulated = simulated.iter().map(|(block, sources)| (*block, sources)).collect();
        bench::require_tools(&[(simulator, simulated)], false)
    }
}

/// The output folder with the files that options name.
fn opened(options: &Options, file: &MachineFile, plan: &Plan) -> Result<Package, Failure> {
    let package = generate::open(options.output.as_deref(), file)?;
    let mut package = package.with_evidence().map_err(Failure::because)?;
    for (name, bytes) in &plan.inputs {
        package.add_evidence(name, bytes).map_err(Failure::because)?;
    }
    Ok(package)
}

/// Lets a second thread begin with the closed loop: when it is told, and in any case at its end.
struct Frees<'a>(&'a OnceLock<()>);

impl Frees<'_> {
    fn now(&self) {
        // It may be free already.
        let _ = self.0.set(());
    }
}

impl Drop for Frees<'_> {
    fn drop(&mut self) {
        self.now();
    }
}

/// The result of a thread.
fn joined<T>(thread: ScopedJoinHandle<'_, Result<T, Failure>>) -> Result<T, Failure> {
    thread.join().unwrap_or_else(|panic| resume_unwind(panic))
}

/// The stage on its simulated machine; `second` is set when a second thread may work.
fn run_stage<'a>(
    options: &'a Options,
    (machine, plan): (&'a Machine, &'a Plan),
    rtl: &'a Rtl<'a>,
    second: &OnceLock<()>,
    observer: &dyn Observer,
) -> Result<Option<ClosedLoop<'a>>, Failure> {
    let built = rtl.built;
    let closed_loop = built.stage.as_ref().map(|stage| {
        let job = closed_loop::Job {
            machine,
            moves: &plan.moves,
            circle: plan.circle.clone(),
            contour: plan.contour.as_ref(),
            path: &options.machine,
            stage,
            sources: &rtl.sources,
            simulator: plan.simulator,
            seed: options.seed,
        };
        job.run(second, observer)
    });
    closed_loop.transpose()
}

/// Adds the pictures, the document and the page.
fn add_report(package: &mut Package, report: &RunReport<'_>, document: &Document) -> Result<(), Failure> {
    let mut add = |name: &str, text: &str| package.add_evidence(name, text.as_bytes()).map_err(Failure::because);
    let (machine, design) = (report.machine, &report.design.design);
    let of_inline = report.inline.into_iter().map(InlineLoop::picture);
    let closed_loop: Vec<(&str, Vec<Panel>)> = (report.closed_loop.into_iter())
        .flat_map(ClosedLoop::pictures)
        .chain(of_inline)
        .collect();
    for (name, panels) in &closed_loop {
        add(name, &plot::svg(panels)?)?;
    }
    let mut sensitivity = design::sensitivity_panels(machine, design);
    sensitivity.extend(report.design.family_panels());
    let of_model = pictures::response_panels(machine, design, report.axes, None)?;
    let response = pictures::response_panels(machine, design, report.axes, Some(report.waves))?;
    add("plots/sensitivity.svg", &plot::svg(&sensitivity)?)?;
    add("plots/response.svg", &plot::svg(&of_model)?)?;
    add("report.json", &json_text(document)?)?;
    let page = report.page(&page::Extra {
        closed_loop,
        sensitivity,
        response,
    })?;
    add("report.html", &page)
}

/// Opens Yosys; if it is not installed, warns that there will be no estimate.
fn installed_yosys(observer: &dyn Observer) -> Result<Option<Yosys>, Failure> {
    match Yosys::installed() {
        Ok(yosys) => Ok(Some(yosys)),
        // A variable names this Yosys, so the user requested it.
        Err(error @ YosysError::Missing(_))
            if std::env::var_os("POSICAST_YOSYS").is_some_and(|name| !name.is_empty()) =>
        {
            Err(synth::failure(error))
        }
        Err(YosysError::Missing(_)) => {
            observer
                .say("warning: Yosys is not installed: no estimate of area. Install it (Debian: apt-get install --no-install-recommends yosys).");
            Ok(None)
        }
        Err(error) => Err(Failure::because(error)),
    }
}

/// The area of the machine's top, if Yosys is installed.
fn estimate(
    plan: &Plan,
    machine: &Machine,
    files: &[PathBuf],
    observer: &dyn Observer,
) -> Result<Option<Estimate>, Failure> {
    let Some(yosys) = &plan.yosys else {
        return Ok(None);
    };
    let family = machine::family(machine)?;
    let estimate = synth::mapped(yosys, files, (&machine.name, "the design"), family, observer);
    estimate.map(Some).map_err(Failure::because)
}
