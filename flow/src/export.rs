//! `posicast export`: the designed impulses in the formats that other controllers and programs read.

mod arrays;
mod firmware;
mod place;

use crate::choice::WordChoice;
use crate::failure::Failure;
use crate::machine;
use crate::observer::Observer;
use firmware::Wish;
use posicast_machine::machine_file::{AxisSection, Machine};
use posicast_machine::plan::{AxisTables, MachineDesign, design_machine};
use std::path::PathBuf;

/// Options of an export.
#[derive(Debug, Clone)]
pub struct Options {
    /// Machine file.
    pub machine: PathBuf,
    /// Format of the output.
    pub to: ExportFormat,
    /// Version of the firmware, such as `3.5`, `v0.13.0-633` or `2026-03-31`; `None`: the newest.
    pub firmware_version: Option<String>,
    /// Only the axes of these names; all without any name.
    pub axes: Vec<String>,
    /// Whether the firmware's own shaper with the smallest residual is written if the firmware cannot use the design.
    pub closest: bool,
    /// A new file to write, or an export to replace; a file that posicast did not write is never replaced. `None`: the
    /// text is returned.
    pub output: Option<PathBuf>,
}

/// What takes the impulses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExportFormat {
    /// Section `[input_shaper]` of Klipper's configuration
    Klipper,
    /// Section `[input_shaper]` of Kalico's configuration
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

impl WordChoice for ExportFormat {
    const ALL: &'static [Self] = &[
        Self::Klipper,
        Self::Kalico,
        Self::Marlin,
        Self::MarlinFt,
        Self::Reprapfirmware,
        Self::C,
        Self::Csv,
        Self::Numpy,
        Self::Matlab,
    ];

    fn word(self) -> &'static str {
        match self {
            Self::Klipper => "klipper",
            Self::Kalico => "kalico",
            Self::Marlin => "marlin",
            Self::MarlinFt => "marlin-ft",
            Self::Reprapfirmware => "reprapfirmware",
            Self::C => "c",
            Self::Csv => "csv",
            Self::Numpy => "numpy",
            Self::Matlab => "matlab",
        }
    }

    fn about(self) -> &'static str {
        match self {
            Self::Klipper => "Section [input_shaper] of Klipper's configuration",
            Self::Kalico => "Section [input_shaper] of Kalico's configuration",
            Self::Marlin => "M593 of Marlin",
            Self::MarlinFt => "M493 of Marlin, fixed-time motion (FT_MOTION)",
            Self::Reprapfirmware => "M593 P\"custom\" of RepRapFirmware",
            Self::C => "Header with arrays of double and of integers",
            Self::Csv => "One line per impulse: axis, time, amplitude",
            Self::Numpy => "Text for numpy.loadtxt: number of the axis, time, amplitude",
            Self::Matlab => "Script that makes a structure per axis",
        }
    }
}

impl ExportFormat {
    /// The beginning of a comment; `None` without comments.
    fn comment(self) -> Option<&'static str> {
        match self {
            ExportFormat::Klipper | ExportFormat::Kalico | ExportFormat::Numpy => Some("#"),
            ExportFormat::Marlin | ExportFormat::MarlinFt | ExportFormat::Reprapfirmware => Some(";"),
            ExportFormat::C => Some("//"),
            ExportFormat::Matlab => Some("%"),
            ExportFormat::Csv => None,
        }
    }
}

/// Exports the impulses of a machine's design. Returns the text if no file is named.
///
/// # Errors
/// [`Failure`] for files that cannot be read, designed or written, and for designs that the firmware cannot use.
pub fn export(options: &Options, observer: &dyn Observer) -> Result<Option<String>, Failure> {
    let path = options.machine.as_path();
    let place = place::Place::claim(options.to, options.output.as_deref(), path)?;
    let machine = machine::read(path)?.machine;
    let design = design_machine(&machine).map_err(|error| machine::of_design(&machine, &error, path))?;
    let selection = Selection::new(&machine, &design, &options.axes, observer)?;
    for selected in selection.axes.iter().filter(|selected| selected.axis.family.is_some()) {
        observer.say(&format!(
            "warning: axis `{}`: its modes move, and the export has the shaper of their nominal values only",
            selected.axis.name
        ));
    }
    let wish = Wish {
        version: options.firmware_version.as_deref(),
        closest: options.closest,
    };
    let text = match options.to {
        ExportFormat::Klipper => firmware::klipper(&selection, &wish),
        ExportFormat::Kalico => firmware::kalico(&selection, &wish),
        ExportFormat::Marlin => firmware::marlin(&selection, &wish),
        ExportFormat::MarlinFt => firmware::marlin_ft(&selection, &wish),
        ExportFormat::Reprapfirmware => firmware::reprapfirmware(&selection, &wish),
        ExportFormat::C | ExportFormat::Csv | ExportFormat::Numpy | ExportFormat::Matlab => {
            wish.refuse_for_arrays()?;
            Ok(match options.to {
                ExportFormat::C => arrays::c(&selection),
                ExportFormat::Csv => arrays::csv(&selection),
                ExportFormat::Numpy => arrays::numpy(&selection),
                _ => arrays::matlab(&selection),
            })
        }
    };
    place.write(text.map_err(|failure| failure.in_file(path))?, observer)
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
    observer: &'a dyn Observer,
}

impl<'a> Selection<'a> {
    /// Selects the axes of these names; all without any name.
    fn new(
        machine: &'a Machine,
        design: &'a MachineDesign,
        names: &[String],
        observer: &'a dyn Observer,
    ) -> Result<Self, Failure> {
        if let Some(missing) = names
            .iter()
            .find(|name| machine.axes.iter().all(|axis| axis.name != **name))
        {
            let known: Vec<&str> = machine.axes.iter().map(|axis| axis.name.as_str()).collect();
            return Err(Failure::input(format!("--axis {missing}: there is no such axis"))
                .with_help(format!("the machine file has: {}", known.join(", "))));
        }
        let axes = machine.axes.iter().zip(&design.axes);
        let wanted = axes.filter(|(axis, _)| names.is_empty() || names.contains(&axis.name));
        let axes = wanted.map(|(axis, tables)| Selected {
            axis,
            tables,
            sample_s: 1.0 / machine.clock.sample_hz,
            observer,
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

/// Numbers with enough digits to distinguish them from their neighbours.
fn list(numbers: &[f64], separator: &str) -> String {
    let texts: Vec<String> = numbers.iter().map(|number| format!("{number:?}")).collect();
    texts.join(separator)
}
