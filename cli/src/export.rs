//! `posicast export`: the designed impulses in the form in which other controllers and programs take them.

mod arrays;
mod firmware;
mod place;

use crate::failure::Failure;
use crate::machine;
use crate::output;
use clap::ValueEnum;
use firmware::Wish;
use posicast_machine::machine_file::{AxisSection, Machine};
use posicast_machine::plan::{AxisTables, MachineDesign, design_machine};
use std::path::PathBuf;

/// The designed impulses for the firmware of a printer, for C, CSV, NumPy or MATLAB
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  posicast export printer.toml --to klipper --include posicast.cfg
  posicast export printer.toml --to reprapfirmware --firmware-version 3.5
  posicast export printer.toml --to klipper --closest
  posicast export examples/gantry.toml --to c -o gantry.h

The file is one of its own, and the command says which line includes it. Never append to a printer.cfg: behind its SAVE_CONFIG
block, Klipper drops that block.

Exit status 2: the format cannot express the design; the message says why, and which of the firmware's own shapers leaves least.")]
pub(crate) struct Args {
    /// Machine file
    machine: PathBuf,
    /// Form of the output
    #[arg(long, value_name = "FORMAT")]
    to: Format,
    /// Version of the firmware, such as 3.5, v0.13.0-633 or 2026-03-31 [default: the newest, which the output names]
    #[arg(long, value_name = "VERSION")]
    firmware_version: Option<String>,
    /// Only this axis; may be given several times
    #[arg(long, value_name = "NAME")]
    axis: Vec<String>,
    /// Where the firmware cannot take the design, write the one of its own shapers that leaves least
    #[arg(long)]
    closest: bool,
    /// File to write, of its own; one that posicast did not write is never replaced [default: standard output]
    #[arg(short, long, visible_alias = "include", value_name = "FILE")]
    output: Option<PathBuf>,
}

/// What takes the impulses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// Section [input_shaper] of Klipper's configuration
    Klipper,
    /// Section [input_shaper] of Kalico's configuration
    Kalico,
    /// M593 of Marlin
    Marlin,
    /// M493 of Marlin, fixed-time motion (FT_MOTION)
    MarlinFt,
    /// M593 P"custom" of RepRapFirmware
    Reprapfirmware,
    /// Header with arrays of double and of integers
    C,
    /// One line per impulse: axis, time, amplitude
    Csv,
    /// Text for numpy.loadtxt: number of the axis, time, amplitude
    Numpy,
    /// Script that makes a structure per axis
    Matlab,
}

impl Format {
    /// How a comment begins; `None` without comments.
    fn comment(self) -> Option<&'static str> {
        match self {
            Format::Klipper | Format::Kalico | Format::Numpy => Some("#"),
            Format::Marlin | Format::MarlinFt | Format::Reprapfirmware => Some(";"),
            Format::C => Some("//"),
            Format::Matlab => Some("%"),
            Format::Csv => None,
        }
    }
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let place = place::Place::claim(args.to, args.output.as_deref(), &args.machine)?;
    let machine = machine::read(&args.machine)?.machine;
    let design = design_machine(&machine).map_err(|error| machine::of_design(&machine, &error, &args.machine))?;
    let selection = Selection::new(&machine, &design, &args.axis)?;
    for selected in selection.axes.iter().filter(|selected| selected.axis.family.is_some()) {
        output::say(&format!(
            "warning: axis `{}`: its modes move, and the export has the shaper of their nominal values only",
            selected.axis.name
        ));
    }
    let wish = Wish {
        version: args.firmware_version.as_deref(),
        closest: args.closest,
    };
    let text = match args.to {
        Format::Klipper => firmware::klipper(&selection, &wish),
        Format::Kalico => firmware::kalico(&selection, &wish),
        Format::Marlin => firmware::marlin(&selection, &wish),
        Format::MarlinFt => firmware::marlin_ft(&selection, &wish),
        Format::Reprapfirmware => firmware::reprapfirmware(&selection, &wish),
        Format::C | Format::Csv | Format::Numpy | Format::Matlab => {
            wish.refuse_for_arrays()?;
            Ok(match args.to {
                Format::C => arrays::c(&selection),
                Format::Csv => arrays::csv(&selection),
                Format::Numpy => arrays::numpy(&selection),
                _ => arrays::matlab(&selection),
            })
        }
    };
    place.write(&text.map_err(|failure| failure.in_file(&args.machine))?)
}

/// The axes to export, in the order of the file.
struct Selection<'a> {
    machine: &'a Machine,
    design: &'a MachineDesign,
    axes: Vec<Selected<'a>>,
}

struct Selected<'a> {
    axis: &'a AxisSection,
    tables: &'a AxisTables,
    sample_s: f64,
}

impl<'a> Selection<'a> {
    /// Selects the axes of these names; all without any name.
    fn new(machine: &'a Machine, design: &'a MachineDesign, names: &[String]) -> Result<Self, Failure> {
        if let Some(missing) = names
            .iter()
            .find(|name| machine.axes.iter().all(|axis| axis.name != **name))
        {
            let known: Vec<&str> = machine.axes.iter().map(|axis| axis.name.as_str()).collect();
            return Err(Failure::from(miette::miette!(
                help = format!("the machine file has: {}", known.join(", ")),
                "--axis {missing}: there is no such axis"
            )));
        }
        let axes = machine.axes.iter().zip(&design.axes);
        let wanted = axes.filter(|(axis, _)| names.is_empty() || names.contains(&axis.name));
        let axes = wanted.map(|(axis, tables)| Selected {
            axis,
            tables,
            sample_s: 1.0 / machine.clock.sample_hz,
        });
        let axes = axes.collect();
        Ok(Self { machine, design, axes })
    }
}

impl Selected<'_> {
    /// Times in seconds and amplitudes of the impulses.
    fn columns(&self) -> [Vec<f64>; 2] {
        let impulses = self.tables.design.impulses.impulses();
        [
            impulses.iter().map(|impulse| impulse.time_s).collect(),
            impulses.iter().map(|impulse| impulse.amplitude).collect(),
        ]
    }

    /// The axis, its kind and its modes in a line.
    fn title(&self) -> String {
        let modes = self.axis.modes.iter().map(|mode| {
            let mode = mode.mode;
            format!("{} Hz with damping ratio {}", mode.frequency_hz, mode.damping)
        });
        let modes: Vec<String> = modes.collect();
        let of = if modes.is_empty() { "" } else { " for " };
        format!(
            "axis {}: {}{of}{}",
            self.axis.name,
            self.tables.design.kind,
            modes.join(", ")
        )
    }
}

/// Numbers with as many digits as tell them from their neighbours.
fn list(numbers: &[f64], separator: &str) -> String {
    let texts: Vec<String> = numbers.iter().map(|number| format!("{number:?}")).collect();
    texts.join(separator)
}
