//! `posicast run`: goes the whole way from the machine file to the verdict.
//!
//! design → quantise → generate → lock step → waveforms compared → plant measured → estimated → reported. Later steps
//! use what an earlier one has decided: the tap table is made once. The folder appears when everything is done, also
//! after a failed check: it holds all that `generate` writes, and the evidence with it.

mod advice;
mod checks;
mod closed_loop;
mod excerpt;
mod gain;
mod page;
mod pictures;
mod report;
mod summary;
mod waves;

use crate::bench::{self, Simulator};
use crate::blocks;
use crate::command;
use crate::contour::{ContourArgs, CornerArgs};
use crate::design::{self, DesignReport};
use crate::failure::Failure;
use crate::hardware::Built;
use crate::input;
use crate::kit;
use crate::machine;
use crate::moves::{self, MotionArgs};
use crate::plot;
use crate::simulate::simulate;
use crate::verify::DEFAULT_SEED;
use crate::{driver, generate, output, progress, sopc, synth, verilog};
use closed_loop::ClosedLoop;
use posicast_machine::compare::{DEFAULT_BAND, compare};
use posicast_machine::machine_file::Machine;
use posicast_synth::yosys::{Estimate, Yosys, YosysError};
use posicast_testbench::blocks::{Block, Sources};
use report::RunReport;
use std::path::{Path, PathBuf};

/// The whole way: design, Verilog, simulation, comparison, estimate, verdict
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  posicast run examples/xy-stage.toml -o xy_stage
  posicast run examples/xy-stage.toml --move x=0.04,y=-0.02 --speed 0.1
  posicast run examples/xy-stage.toml --contour part.gcode

Exit status: 0 all checks hold, 1 a check failed (the folder holds the evidence), 2 bad input, 3 a named tool is missing.")]
pub(crate) struct Args {
    /// Machine file
    machine: PathBuf,
    /// Output folder: new, empty, or written by posicast before [default: ./NAME]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    #[command(flatten)]
    motion: MotionArgs,
    /// Radius of the circle of the closed loop, in the unit of the first axis [default: what the limits of the axes suit]
    #[arg(long, allow_negative_numbers = true)]
    radius: Option<f64>,
    /// Path of the closed loop in place of the circle: circle, square, a CSV file of points x,y, or a G-code file,
    /// from where the axes stand at reset; --radius and --speed apply to it
    #[arg(long, value_name = "SHAPE|FILE", conflicts_with = "command")]
    contour: Option<String>,
    #[command(flatten)]
    corners: CornerArgs,
    /// Simulator [default: verilator; rusthdl, the weaker check, where Verilator is missing]
    #[arg(long)]
    simulator: Option<Simulator>,
    /// Clocks of the lock step [default: 1000000 with verilator, 20000 with icarus and rusthdl]
    #[arg(long, value_parser = crate::bench::clocks)]
    cycles: Option<u64>,
    /// Seed of the random stimuli
    #[arg(long, default_value_t = DEFAULT_SEED)]
    seed: u64,
    /// Print all tables and every check
    #[arg(short, long)]
    verbose: bool,
    /// Print only the verdict, and what failed
    #[arg(short, long, conflicts_with = "verbose")]
    quiet: bool,
    /// Print one JSON document on standard output
    #[arg(long, conflicts_with_all = ["verbose", "quiet"])]
    json: bool,
}

impl Args {
    /// The command line that repeats the run in the output folder, which has the machine file and the files that options name.
    fn command_line(&self) -> String {
        let mut words = vec!["posicast run machine.toml".to_owned()];
        words.extend(self.motion.command_line());
        let mut option =
            |name: &str, value: Option<String>| words.extend(value.map(|value| format!("--{name} {value}")));
        option("radius", self.radius.map(|radius| radius.to_string()));
        let contour = self.contour.as_deref().map(Path::new);
        option(
            "contour",
            contour.map(|path| output::shell_word(&input::in_folder(path))),
        );
        for (name, value) in self.corners.given() {
            option(name, Some(value.to_string()));
        }
        option("simulator", self.simulator.map(|simulator| simulator.to_string()));
        option("cycles", self.cycles.map(|cycles| cycles.to_string()));
        option("seed", (self.seed != DEFAULT_SEED).then(|| self.seed.to_string()));
        words.join(" ")
    }
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let file = machine::read(&args.machine)?;
    let machine = &file.machine;
    let design = DesignReport::new(machine, &args.machine)?;
    design.warn();
    let board = sopc::board(machine, &args.machine)?;
    let built = Built::new(&design, &args.machine)?;
    let moves = match args.contour {
        Some(_) => moves::by_default(machine),
        None => args.motion.moves(machine, built.stage.is_some())?,
    };
    let path = ContourArgs::of_run(args.contour.as_deref(), args.radius, args.corners);
    let contour = closed_loop::contour(machine, path.as_ref(), &args.motion, built.stage.is_some())?;
    let circle = match &contour {
        Some(_) => Err("--contour drives another path".to_owned()),
        None => closed_loop::circle(machine, args.radius, built.stage.is_some())?,
    };
    let command = args.motion.command.as_deref();
    let inputs = [command, args.contour.as_deref().map(Path::new)];
    let inputs = inputs.into_iter().flatten().filter_map(input::copy);
    let inputs = inputs.collect::<Result<Vec<_>, Failure>>()?;
    let words = command::words(machine, &design.design, command, &moves)?;
    let simulator = Simulator::choose(args.simulator)?;
    if built.stage.is_some() {
        closed_loop::announce(simulator, command.is_some());
    }
    let yosys = installed_yosys()?;
    let axes = simulate(machine, &design.design, &built.shapers, &words)?;
    let modules = built.modules(&args.machine)?;
    let kit = kit::files(machine, &modules, &built);
    let Built {
        shapers,
        components,
        stage,
        link,
        ..
    } = built;
    let top = blocks::shapers(machine, shapers, &words)?;

    let package = generate::open(args.output.as_deref(), &file)?;
    let mut package = package.with_evidence().map_err(Failure::because)?;
    for (name, bytes) in &inputs {
        package.add_evidence(name, bytes).map_err(Failure::because)?;
    }
    let files = verilog::add_sources(&mut package, &file, &modules)?;
    kit::add(&mut package, &kit)?;
    sopc::add(
        &mut package,
        (machine, &args.machine),
        board,
        (stage.as_ref(), link.as_ref()),
        &components,
    )?;
    driver::add(
        &mut package,
        machine,
        &modules,
        &components,
        (stage.as_ref(), link.as_ref()),
    )?;
    let components = components.iter().chain(stage.as_ref().map(|stage| &stage.block));
    let components = components.map(|component| component as &dyn Block);
    let components = components.chain(link.as_ref().map(|link| link as &dyn Block));
    let tops: Vec<&dyn Block> = std::iter::once(&top as &dyn Block).chain(components).collect();
    let all = Sources::found(files.clone());
    let sources = all.reached_by(&top).map_err(bench::failure)?;
    let job = waves::Job {
        machine,
        top: &top,
        sources: &sources,
        simulator,
        seed: args.seed,
    };
    // A tool that is missing is named before anything is simulated, and not by the last step that needs it.
    let of_stage = stage.as_ref().filter(|_| simulator == Simulator::Verilator);
    let simulated = std::iter::once(&top as &dyn Block).chain(of_stage.map(|stage| &stage.block as &dyn Block));
    let simulated = simulated.map(|block| Ok((block, all.reached_by(block).map_err(bench::failure)?)));
    let simulated = simulated.collect::<Result<Vec<_>, Failure>>()?;
    let simulated = simulated.iter().map(|(block, sources)| (*block, sources)).collect();
    bench::require_tools(&[(simulator, simulated)], false)?;
    let lockstep = job.lockstep(args.cycles)?;
    let waves = job.waves(&mut package, &design.design, &axes)?;
    let estimate = yosys.map(|yosys| estimate(&yosys, machine, &files)).transpose()?;

    let closed_loop = stage.as_ref().map(|stage| {
        let job = closed_loop::Job {
            machine,
            moves: &moves,
            circle: circle.clone(),
            contour: contour.as_ref(),
            path: &args.machine,
            stage,
            sources: &all,
            simulator,
            seed: args.seed,
        };
        job.run()
    });
    let closed_loop = closed_loop.transpose()?;

    let mut checks = Vec::from_iter(checks::lint(simulator, &all, &tops)?);
    checks.push(checks::moves(machine, &axes));
    checks.extend(checks::all(simulator, machine, &design.design, &lockstep, &waves));
    checks.extend(checks::link(link.as_ref()));
    checks.extend(estimate.as_ref().and_then(|e| checks::fits(machine, e)));
    checks.extend(closed_loop.iter().flat_map(ClosedLoop::checks));
    let of_loop: Vec<_> = closed_loop.iter().flat_map(ClosedLoop::pictures).collect();
    for (name, panels) in &of_loop {
        let picture = plot::svg(panels)?;
        package
            .add_evidence(name, picture.as_bytes())
            .map_err(Failure::because)?;
    }
    let mut sensitivity = design::sensitivity_panels(machine, &design.design);
    sensitivity.extend(design.family_panels());
    let of_model = pictures::response_panels(machine, &design.design, &axes, None)?;
    let response = pictures::response_panels(machine, &design.design, &axes, Some(&waves))?;
    package
        .add_evidence("plots/sensitivity.svg", plot::svg(&sensitivity)?.as_bytes())
        .map_err(Failure::because)?;
    package
        .add_evidence("plots/response.svg", plot::svg(&of_model)?.as_bytes())
        .map_err(Failure::because)?;
    let kinds = compare(machine, DEFAULT_BAND);
    let report = RunReport {
        machine,
        design: &design,
        axes: &axes,
        plants: report::on_plants(machine, &design.design)?,
        simulator,
        seed: args.seed,
        lockstep: &lockstep,
        waves: &waves,
        estimate: estimate.as_ref(),
        closed_loop: closed_loop.as_ref(),
        checks: &checks,
        words: &words,
        gains: gain::of_axes(machine, &words, &axes, |axis| {
            closed_loop.as_ref().and_then(|of| of.gain(axis))
        }),
        kinds: &kinds,
        command: args.command_line(),
    };
    let document = report.json();
    package
        .add_evidence("report.json", output::json_text(&document)?.as_bytes())
        .map_err(Failure::because)?;
    let page = report.page(&page::Extra {
        closed_loop: of_loop,
        sensitivity,
        response,
    })?;
    package
        .add_evidence("report.html", page.as_bytes())
        .map_err(Failure::because)?;
    let root = package.root().to_owned();
    let committed = package.commit().map_err(Failure::because)?;
    generate::tell(&committed);
    if args.json {
        output::print_json(&document)?
    } else {
        output::print_styled(&match (args.verbose, args.quiet) {
            (true, _) => report.text(&root, &committed.files),
            (false, true) => report.quiet(),
            (false, false) => report.summary(&root, &committed.files),
        })?
    }
    let failed: Vec<_> = checks.iter().filter(|c| !c.passed).map(|c| c.name).collect();
    if failed.is_empty() {
        Ok(())
    } else {
        Err(Failure::Check(format!("failed: {}", failed.join(", "))))
    }
}

/// Opens Yosys; where it is not installed, warns that there will be no estimate.
fn installed_yosys() -> Result<Option<Yosys>, Failure> {
    match Yosys::installed() {
        Ok(yosys) => Ok(Some(yosys)),
        // One that a variable names was asked for.
        Err(error @ YosysError::Missing(_))
            if std::env::var_os("POSICAST_YOSYS").is_some_and(|name| !name.is_empty()) =>
        {
            Err(synth::failure(error))
        }
        Err(YosysError::Missing(_)) => {
            output::say("warning: Yosys is not installed: no estimate of area. Install it with scripts/install-tools.");
            Ok(None)
        }
        Err(error) => Err(Failure::because(error)),
    }
}

fn estimate(yosys: &Yosys, machine: &Machine, files: &[PathBuf]) -> Result<Estimate, Failure> {
    let spinner = progress::spinner("Yosys maps the design");
    let estimate = yosys
        .estimate(files, &machine.name, machine::family(machine)?)
        .map_err(Failure::because)?;
    spinner.finish_and_clear();
    Ok(estimate)
}
