//! `posicast simulate`: passes a command through the bit-exact model and the float design to the simulated machine.

use crate::command::{self, Words};
use crate::contour::{self, ContourArgs};
use crate::design::DesignReport;
use crate::failure::Failure;
use crate::hardware;
use crate::machine;
use crate::moves::MotionArgs;
use crate::output::{self, Table, UnitDocument};
use crate::plot;
use posicast_hdl::machine::AxisShaper;
use posicast_machine::machine_file::{AxisSection, Machine};
use posicast_machine::plan::MachineDesign;
use posicast_machine::plant::Plant;
use posicast_machine::simulation::{AxisSimulation, simulate_axis};
use posicast_system::output::OutputFiles;
use posicast_testbench::wave::{Heading, Recorder, Signal};
use posicast_testbench::wording::counted;
use serde::Serialize;
use std::path::{Path, PathBuf};
use wavecmp::diff::SAMPLE_CLOCK;

/// Run a command through the bit-exact model and the float design, on the simulated machine
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  posicast simulate examples/xy-stage.toml -o move.vcd
  posicast simulate examples/xy-stage.toml --move 0.04
  posicast simulate examples/xy-stage.toml --command moves.csv
  posicast simulate examples/xy-stage.toml --contour circle --radius 0.01 --speed 0.1 --plot circle.svg
  posicast simulate examples/xy-stage.toml --contour part.gcode

The waveform holds, per axis and in LSB of the command word: command x, shaped y, float design y_float, and the
machine's position with and without shaping. The words of a modulo axis wrap; the machine's position counts on.")]
pub(crate) struct Args {
    /// Machine file
    machine: PathBuf,
    /// Waveform to write [default: ./NAME.vcd]
    #[arg(short, long, value_name = "FILE.vcd", conflicts_with = "contour")]
    output: Option<PathBuf>,
    #[command(flatten)]
    motion: MotionArgs,
    #[command(flatten)]
    contour: ContourArgs,
    /// Replace a file that posicast did not write, or that was changed since; never one that this command reads
    #[arg(long)]
    force: bool,
    /// Print one JSON document on standard output
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let machine = machine::read(&args.machine)?.machine;
    if args.contour.contour.is_some() {
        return along_contour(args, &machine);
    }
    args.contour.only_with_a_path()?;
    let default = PathBuf::from(format!("{}.vcd", machine.name));
    let path = args.output.as_ref().unwrap_or(&default);
    let mut outputs = OutputFiles::new(args.force);
    outputs.input("the machine file", &args.machine);
    if let Some(command) = &args.motion.command {
        outputs.input("the command", command);
    }
    outputs.claim("--output", path).map_err(Failure::because)?;
    output::one_document(&outputs, args.json)?;
    let moves = args.motion.moves(&machine, false)?;
    let report = DesignReport::new(&machine, &args.machine)?;
    let shapers = hardware::shapers(&machine, &report.hardware, &args.machine)?;
    let design = report.design;
    let words = command::words(&machine, &design, args.motion.command.as_deref(), &moves)?;
    let axes = simulate(&machine, &design, &shapers, &words)?;
    write_wave(&machine, &words, &axes, path)?;
    let document = Document::new(&machine, &axes, path);
    if args.json {
        output::print_json(&document)?
    } else {
        output::print_beside(&outputs, &document.text())?
    }
    match document.axes.iter().find(|a| a.largest_difference_lsb > a.bound_lsb) {
        None => Ok(()),
        Some(axis) => Err(Failure::Check(format!(
            "axis {}: the model leaves the float design's bound",
            axis.name
        ))),
    }
}

/// Simulates a path of two axes instead of writing a waveform.
fn along_contour(args: &Args, machine: &Machine) -> Result<(), Failure> {
    let mut outputs = OutputFiles::new(args.force);
    outputs.input("the machine file", &args.machine);
    if let Some(path) = args.contour.file() {
        outputs.input("--contour", path);
    }
    if let Some(path) = &args.contour.plot {
        outputs.claim("--plot", path).map_err(Failure::because)?;
        plot::check_name("--plot", path)?;
    }
    output::one_document(&outputs, args.json)?;
    contour::run(
        &args.contour,
        machine,
        args.motion.along_contour()?,
        &outputs,
        args.json,
    )
}

/// Simulates all axes of a machine with their command words.
pub(crate) fn simulate(
    machine: &Machine,
    design: &MachineDesign,
    shapers: &[AxisShaper],
    words: &Words,
) -> Result<Vec<AxisSimulation>, Failure> {
    let axes = machine.axes.iter().zip(&design.axes).zip(shapers).zip(words);
    axes.map(|(((axis, tables), shaper), words)| {
        let plant = Plant::of_axis(axis).map_err(Failure::because)?;
        Ok(simulate_axis(
            &shaper.config,
            tables,
            &plant,
            machine.clock.sample_period_s(),
            words,
        ))
    })
    .collect()
}

/// Metres (or radians) per LSB of an axis's command word.
pub(crate) fn si_per_lsb(machine: &Machine, axis: &AxisSection) -> f64 {
    1.0 / (axis.loop_counts_per_unit() * f64::from(machine.fixed_point.command_fraction).exp2())
}

fn write_wave(machine: &Machine, words: &Words, axes: &[AxisSimulation], path: &Path) -> Result<(), Failure> {
    let bits = machine.fixed_point.command_bits;
    let signals: Vec<Signal> = machine
        .axes
        .iter()
        .flat_map(|axis| {
            let name = |signal: &str| format!("{}_{signal}", axis.name);
            [
                Signal::bits(&name("x"), bits),
                Signal::bits(&name("y"), bits),
                Signal::real(&name("y_float")),
                Signal::real(&name("position")),
                Signal::real(&name("position_unshaped")),
            ]
        })
        .collect();
    let sample_hz = machine.clock.sample_hz;
    let heading = Heading {
        clock: SAMPLE_CLOCK,
        comment: &format!(
            "{SAMPLE_CLOCK} rises with each sample, at {sample_hz} Hz; it is not the clock of the hardware"
        ),
        gaps: false,
    };
    let mut recorder =
        Recorder::create_with(path, sample_hz, &[&machine.name], &signals, &heading).map_err(Failure::because)?;
    let mask = u64::MAX >> (64 - bits);
    let raw = |word: i64| word as u64 & mask;
    let float: Vec<Vec<f64>> = axes.iter().map(|axis| axis.float_words(bits)).collect();
    for sample in 0..words.first().map_or(0, Vec::len) {
        let row: Vec<u64> = axes
            .iter()
            .zip(words)
            .zip(&float)
            .flat_map(|((axis, words), float)| {
                let reals = [float[sample], axis.position[sample], axis.position_unshaped[sample]];
                let integers = [raw(words[sample]), raw(axis.shaped[sample])];
                integers.into_iter().chain(reals.map(f64::to_bits))
            })
            .collect();
        recorder.clock(&[&row]).map_err(Failure::because)?;
    }
    recorder.finish().map_err(Failure::because)
}

/// `simulate --json`.
#[derive(Serialize)]
struct Document {
    name: String,
    samples: usize,
    axes: Vec<AxisDocument>,
    wave: String,
}

#[derive(Serialize)]
struct AxisDocument {
    name: String,
    #[serde(flatten)]
    unit: UnitDocument,
    largest_difference_lsb: f64,
    bound_lsb: f64,
    residual_displacement_unshaped: f64,
    residual_displacement: f64,
}

impl Document {
    fn new(machine: &Machine, axes: &[AxisSimulation], path: &Path) -> Self {
        let document = |(axis, run): (&AxisSection, &AxisSimulation)| {
            let scale = si_per_lsb(machine, axis);
            AxisDocument {
                name: axis.name.clone(),
                unit: UnitDocument::new(axis.unit),
                largest_difference_lsb: run.largest_difference_lsb(),
                bound_lsb: run.bound_lsb,
                residual_displacement_unshaped: run.vibration_unshaped * scale,
                residual_displacement: run.vibration * scale,
            }
        };
        Self {
            name: machine.name.clone(),
            samples: axes.first().map_or(0, |a| a.shaped.len()),
            axes: machine.axes.iter().zip(axes).map(document).collect(),
            wave: path.display().to_string(),
        }
    }

    fn text(&self) -> String {
        let headings = [
            "axis",
            ">ringing unshaped",
            ">ringing shaped",
            ">largest difference from float",
            ">bound",
        ];
        let mut table = Table::new(&headings);
        for axis in &self.axes {
            let ringing = [axis.residual_displacement_unshaped, axis.residual_displacement];
            let [unshaped, shaped] = axis.unit.of_axis().show_all(ringing);
            table.row([
                axis.name.clone(),
                unshaped,
                shaped,
                format!("{:.3} LSB", axis.largest_difference_lsb),
                format!("{:.3} LSB", axis.bound_lsb),
            ]);
        }
        format!(
            "{}: {}; ringing after the command's end\n{}{}\n",
            self.name,
            counted(self.samples as u64, "sample"),
            table.text(""),
            self.wave
        )
    }
}
