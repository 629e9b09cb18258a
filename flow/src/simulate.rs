//! `posicast simulate`: passes a command through the bit-exact model and the float design to the simulated machine.

use crate::Outcome;
use crate::command::{self, Words};
use crate::contour::{self, PathOptions};
use crate::design::DesignReport;
use crate::failure::Failure;
use crate::files::{ResultForm, one_document};
use crate::hardware;
use crate::machine;
use crate::moves::{self, Motion};
use crate::observer::Observer;
use crate::plot;
use crate::text::UnitDocument;
use posicast_hdl::machine::AxisShaper;
use posicast_machine::machine_file::{AxisSection, Machine};
use posicast_machine::plan::MachineDesign;
use posicast_machine::plant::Plant;
use posicast_machine::simulation::{AxisSimulation, simulate_axis};
use posicast_system::output::OutputFiles;
use posicast_testbench::wave::{Heading, Recorder, Signal};
use schemars::JsonSchema;
use serde::Serialize;
use std::path::{Path, PathBuf};
use wavecmp::diff::SAMPLE_CLOCK;

/// Options of a simulation.
#[derive(Debug, Clone)]
pub struct Options {
    /// Machine file.
    pub machine: PathBuf,
    /// Waveform to write; `None`: the machine's name with `.vcd`. Not with a contour.
    pub output: Option<PathBuf>,
    /// How the axes move.
    pub motion: Motion,
    /// A path of the first two axes, which is followed instead of writing a waveform.
    pub path: PathOptions,
    /// Whether a file that posicast did not write is replaced; never one that is read.
    pub force: bool,
    /// What the front does with the document.
    pub form: ResultForm,
}

/// The result of a simulation.
#[derive(Serialize, JsonSchema)]
#[serde(untagged)]
pub enum Simulated {
    /// Result of a command, as a waveform.
    Command(Document),
    /// Result of a path of two axes.
    Contour(contour::Document),
}

/// Simulates a command or a path.
///
/// # Errors
/// [`Failure`] for files that cannot be read, designed, simulated or written.
pub fn simulate(options: &Options, observer: &dyn Observer) -> Result<Outcome<Simulated>, Failure> {
    let machine = machine::read(&options.machine)?.machine;
    if options.path.contour.is_some() {
        return along_contour(options, &machine, observer);
    }
    options.path.only_with_a_path()?;
    let default = PathBuf::from(format!("{}.vcd", machine.name));
    let path = options.output.as_ref().unwrap_or(&default);
    let mut outputs = OutputFiles::new(options.force);
    outputs.input("the machine file", &options.machine);
    let command = options.motion.command.as_deref();
    if let Some(command) = command {
        outputs.input("the command", command);
    }
    outputs.claim("--output", path).map_err(Failure::because)?;
    one_document(&outputs, options.form)?;
    let moves = options.motion.moves(&machine, false)?;
    let report = DesignReport::new(&machine, &options.machine)?;
    let shapers = hardware::shapers(&machine, &report.hardware, &options.machine)?;
    let design = report.design;
    let words = command::words(&machine, &design, command, &moves, observer)?;
    let axes = simulate_axes(&machine, &design, &shapers, &words)?;
    write_wave(&machine, &words, &axes, path)?;
    let document = Document::new(&machine, &axes, path);
    let beyond = document.axes.iter().find(|a| a.largest_difference_lsb > a.bound_lsb);
    let failed = beyond.map(|axis| format!("axis {}: the model leaves the float design's bound", axis.name));
    Ok(Outcome {
        failed,
        ..Outcome::passed(Simulated::Command(document)).beside(&outputs)
    })
}

/// An axis that followed its command, with every sample.
pub struct SimulatedMotion {
    /// Name of the axis.
    pub axis: String,
    /// Value of one LSB of a word, in the axis's unit.
    pub unit_per_lsb: f64,
    /// The command words; those of a modulo axis include whole turns.
    pub words: Vec<i64>,
    /// The shaped words, the float design and the machine.
    pub simulation: AxisSimulation,
}

/// Simulates a machine that was read already, which `path` names in messages: with the positions of `command`, by axis and sample in the
/// axes' units, or with the default move of each axis.
///
/// # Errors
/// [`Failure`] for a machine that cannot be designed, and for positions that its words do not hold.
pub fn motion(
    machine: &Machine,
    path: &Path,
    command: Option<&[Vec<f64>]>,
    observer: &dyn Observer,
) -> Result<Vec<SimulatedMotion>, Failure> {
    let report = DesignReport::new(machine, path)?;
    let shapers = hardware::shapers(machine, &report.hardware, path)?;
    let design = report.design;
    let words = match command {
        Some(positions) => command::words_of(machine, &design, positions)?,
        None => command::words(machine, &design, None, &moves::by_default(machine), observer)?,
    };
    let axes = simulate_axes(machine, &design, &shapers, &words)?;
    let fraction = f64::from(machine.fixed_point.command_fraction).exp2();
    let motions = machine.axes.iter().zip(words).zip(axes);
    Ok(motions
        .map(|((axis, words), simulation)| SimulatedMotion {
            axis: axis.name.clone(),
            unit_per_lsb: 1.0 / (axis.loop_counts_per_file_unit() * fraction),
            words,
            simulation,
        })
        .collect())
}

/// Simulates a path of two axes instead of writing a waveform.
fn along_contour(options: &Options, machine: &Machine, observer: &dyn Observer) -> Result<Outcome<Simulated>, Failure> {
    let mut outputs = OutputFiles::new(options.force);
    outputs.input("the machine file", &options.machine);
    if let Some(path) = options.path.file() {
        outputs.input("--contour", path);
    }
    if let Some(path) = &options.path.plot {
        outputs.claim("--plot", path).map_err(Failure::because)?;
        plot::check_name("--plot", path)?;
    }
    one_document(&outputs, options.form)?;
    let speed = options.motion.along_contour()?;
    let document = contour::simulate(&options.path, machine, speed, observer)?;
    Ok(Outcome::passed(Simulated::Contour(document)).beside(&outputs))
}

/// Simulates all axes of a machine with their command words.
pub(crate) fn simulate_axes(
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
#[derive(Serialize, JsonSchema)]
pub struct Document {
    /// Name of the machine.
    pub name: String,
    /// Number of samples of the command.
    pub samples: usize,
    /// The axes of the machine, in the order of the file.
    pub axes: Vec<SimulatedAxis>,
    /// The waveform that was written.
    pub wave: String,
}

/// An axis that followed its command.
#[derive(Serialize, JsonSchema)]
pub struct SimulatedAxis {
    /// Name of the axis.
    pub name: String,
    /// Its unit.
    #[serde(flatten)]
    pub unit: UnitDocument,
    /// Largest difference of the model and the float design.
    pub largest_difference_lsb: f64,
    /// The largest that rounding explains.
    pub bound_lsb: f64,
    /// Ringing after the command's end without the shaper, in `si_unit`.
    pub residual_displacement_unshaped: f64,
    /// Ringing after the command's end with it, in `si_unit`.
    pub residual_displacement: f64,
}

impl Document {
    fn new(machine: &Machine, axes: &[AxisSimulation], path: &Path) -> Self {
        let document = |(axis, run): (&AxisSection, &AxisSimulation)| {
            let scale = si_per_lsb(machine, axis);
            SimulatedAxis {
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
}
