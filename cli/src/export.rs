//! `posicast export`: the designed impulses in the form in which other controllers and programs take them.

mod arrays;
mod firmware;

use crate::failure::Failure;
use crate::machine;
use crate::output;
use clap::ValueEnum;
use posicast_model::design::{AxisTables, MachineDesign, design_machine};
use posicast_model::machine_file::{AxisSection, Machine};
use std::path::PathBuf;

/// The designed impulses for the firmware of a printer, for C, CSV, NumPy or MATLAB, on standard output
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  posicast export printer.toml --to klipper >> printer.cfg\n  \
                  posicast export examples/gantry.toml --to c > gantry.h\n\n\
                  Exit status 2: the format cannot express the design; the message says why, and what to do."
)]
pub(crate) struct Args {
    /// Machine file
    machine: PathBuf,
    /// Form of the output
    #[arg(long, value_name = "FORMAT")]
    to: Format,
    /// Only this axis; may be given several times
    #[arg(long, value_name = "NAME")]
    axis: Vec<String>,
}

/// What takes the impulses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// Section [input_shaper] of Klipper's configuration
    Klipper,
    /// M593 of Marlin
    Marlin,
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

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let machine = machine::read(&args.machine)?.machine;
    let design = design_machine(&machine).map_err(|error| machine::of_design(&machine, &error, &args.machine))?;
    let selection = Selection::new(&machine, &design, &args.axis)?;
    for selected in selection.axes.iter().filter(|selected| selected.axis.family.is_some()) {
        output::say(&format!(
            "warning: axis `{}`: its modes move, and the export has the shaper of their nominal values only",
            selected.axis.name
        ));
    }
    let text = match args.to {
        Format::Klipper => firmware::klipper(&selection),
        Format::Marlin => firmware::marlin(&selection),
        Format::Reprapfirmware => firmware::reprapfirmware(&selection),
        Format::C => Ok(arrays::c(&selection)),
        Format::Csv => Ok(arrays::csv(&selection)),
        Format::Numpy => Ok(arrays::numpy(&selection)),
        Format::Matlab => Ok(arrays::matlab(&selection)),
    };
    output::print(&text.map_err(|failure| failure.in_file(&args.machine))?)
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
        let axes = wanted.map(|(axis, tables)| Selected { axis, tables }).collect();
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
