//! `posicast design`: impulses, residuals, insensitivity and the tap table of every axis.

mod axis;
mod certificate;
mod delay;
mod document;
mod error_table;
mod family;
mod front;
mod given_move;
mod sensitivity;
mod together;

use crate::Outcome;
use crate::control::{self, AxisControl};
use crate::failure::Failure;
use crate::files::{ResultForm, one_document};
use crate::guards;
use crate::hardware;
use crate::machine;
use crate::moves::PerAxis;
use crate::observer::Observer;
use crate::plot;
use crate::sopc;
use crate::tolerance::beyond_tolerance;
use posicast_machine::hardware::Hardware;
use posicast_machine::machine_file::Machine;
use posicast_machine::plan::{MachineDesign, design_machine};
use posicast_shaper::design::convolution_figures;
use posicast_system::output::OutputFiles;
use posicast_testbench::wave::write_text;
use std::path::{Path, PathBuf};

use axis::AxisReport;
use certificate::CertificateReport;
use error_table::ErrorTableReport;
use family::FamilyReport;
use front::FrontReport;
use given_move::MoveReport;

pub use crate::control::{Control, ControlSetting, StabilityMargins};
pub use certificate::{Certificate, CertifiedMode, LeastDuration, ProofPoint, WorstPoint};
pub use delay::{DelayParts, EqualDelays};
pub use document::{
    Clocking, DesignAxis, DesignImpulse, DesignMode, Document, FreeMode, InlineAxisDocument, Mechanics, ModeClass,
    PeriodicSolution, Quantised, Residual, ShaperCrossGain, TableTap,
};
pub use error_table::DesignErrorTable;
pub use family::{DesignFamily, FamilyMode, FamilyTable};
pub use front::{Front, FrontDuration};
pub use given_move::{ComparedMove, MoveByPeriod, MoveTimes};
pub(crate) use sensitivity::sensitivity_panels;
pub use together::Together;

/// Options of a design and its output.
#[derive(Debug, Clone)]
pub struct Options {
    /// Machine file.
    pub machine: PathBuf,
    /// The SVG file into which the sensitivity curves are drawn.
    pub plot: Option<PathBuf>,
    /// Whether a file that posicast did not write is replaced; never one that is read.
    pub force: bool,
    /// Whether the largest residual of the integer taps of every axis is certified, over the whole bands of its modes.
    pub certify: bool,
    /// Whether the benefit of longer durations for optimal shapers is shown.
    pub front: bool,
    /// Distance of a move, in the axis's unit, that is compared with a move whose jerk time is a period of a mode.
    pub distance: Option<PerAxis>,
    /// What the front does with the document.
    pub form: ResultForm,
}

/// Designs the shapers of a machine.
///
/// # Errors
/// [`Failure`] for files that cannot be read, designed or written.
pub fn design(options: &Options, observer: &dyn Observer) -> Result<Outcome<Document>, Failure> {
    let machine = machine::read(&options.machine)?.machine;
    let mut outputs = OutputFiles::new(options.force);
    outputs.input("the machine file", &options.machine);
    if let Some(path) = &options.plot {
        outputs.claim("--plot", path).map_err(Failure::because)?;
        plot::check_name("--plot", path)?;
    }
    one_document(&outputs, options.form)?;
    // Refuse here a board that `generate` would refuse.
    sopc::board(&machine, &options.machine)?;
    let mut report = DesignReport::new(&machine, &options.machine)?;
    report.certify = options.certify;
    report.warn(observer);
    let fronts = if options.front {
        front::of_axes(&report, observer)?
    } else {
        Vec::new()
    };
    let moves = match &options.distance {
        Some(distance) => given_move::of_axes(&report, distance)?,
        None => Vec::new(),
    };
    if let Some(path) = &options.plot {
        let mut panels = sensitivity_panels(&machine, &report.design);
        panels.extend(report.family_panels());
        panels.extend(fronts.iter().flat_map(|front| front.panels(&machine.name)));
        panels.extend(report.controllers.iter().flatten().map(AxisControl::nyquist));
        write_text(path, &plot::svg(&panels)?).map_err(Failure::because)?;
    }
    let mut document = report.json();
    document.fronts = fronts.iter().map(FrontReport::json).collect();
    document.moves = moves.iter().map(MoveReport::json).collect();
    Ok(Outcome::passed(document).beside(&outputs))
}

/// The figures of a machine's shapers, for a machine that was read already: that of [`design`] without options. `path` names it in messages.
///
/// # Errors
/// [`Failure`] for a machine whose shapers do not exist.
pub fn described(machine: &Machine, path: &Path, certify: bool) -> Result<Document, Failure> {
    let mut report = DesignReport::new(machine, path)?;
    report.certify = certify;
    Ok(report.json())
}

/// The design of a machine with its figures at every mode.
pub struct DesignReport<'a> {
    /// The machine.
    pub machine: &'a Machine,
    /// The shapers of its axes.
    pub design: MachineDesign,
    /// The hardware that is built for it.
    pub hardware: Hardware<'a>,
    pub(crate) controllers: Vec<Option<AxisControl>>,
    /// Whether every axis is certified, not only those of `optimal`.
    certify: bool,
    /// The machine file, or the folder that contains it.
    path: &'a Path,
}

impl<'a> DesignReport<'a> {
    /// Designs the shapers of `machine`, which the file at `path` describes.
    ///
    /// # Errors
    /// [`Failure`] with the key of the file that causes it.
    pub fn new(machine: &'a Machine, path: &'a Path) -> Result<Self, Failure> {
        let design = design_machine(machine).map_err(|error| machine::of_design(machine, &error, path))?;
        let hardware = Hardware::of(machine, &design).map_err(|error| machine::of_hardware(&error, path))?;
        let controllers = control::of_machine(machine, &hardware);
        Ok(Self {
            machine,
            design,
            hardware,
            controllers,
            certify: false,
            path,
        })
    }

    /// Refuses a machine if one of its shapers cannot be built.
    ///
    /// # Errors
    /// [`Failure`] with the key of the file that causes it.
    pub fn check_shapers(&self) -> Result<(), Failure> {
        hardware::shapers(self.machine, &self.hardware, self.path).map(drop)
    }

    /// Reports problems of tables and controllers, and missing guards of axes.
    pub(crate) fn warn(&self, observer: &dyn Observer) {
        let mut warnings = beyond_tolerance(self.machine, &self.design);
        warnings.extend(guards::missing(self.machine));
        warnings.extend(guards::long_cables(self.machine));
        warnings.extend(self.families().filter_map(|family| family.warning()));
        warnings.extend(error_table::not_built(self.machine, &self.hardware));
        let controllers = self.controllers.iter().enumerate();
        warnings.extend(controllers.flat_map(|(index, control)| {
            let of_axis = control.as_ref().map(|control| control.warnings_of(index));
            of_axis.unwrap_or_default()
        }));
        warnings.iter().for_each(|warning| warning.tell(self.path, observer));
    }

    fn axes(&self) -> impl Iterator<Item = AxisReport<'_>> {
        self.machine
            .axes
            .iter()
            .zip(&self.design.axes)
            .zip(&self.controllers)
            .zip(self.hardware.axes())
            .enumerate()
            .map(|(place, (((axis, tables), control), built))| AxisReport {
                path: self.path,
                place,
                axis,
                tables,
                certificate: CertificateReport::new(axis, tables, self.design.sample_hz, self.certify),
                in_stage: self.design.stage.is_some(),
                control: control.as_ref(),
                modes: tables.mode_figures(axis, self.design.sample_hz),
                convolution: convolution_figures(axis.shaped(), &tables.design),
                misfit: built.shaper.as_ref().err(),
                family: self.families().find(|family| std::ptr::eq(family.axis, axis)),
                error_table: ErrorTableReport::new(&self.hardware, axis, place),
            })
    }

    /// The axes whose modes move, with their tables.
    fn families(&self) -> impl Iterator<Item = FamilyReport<'_>> {
        let axes = self.machine.axes.iter().enumerate();
        axes.filter_map(|(index, axis)| {
            FamilyReport::new(index, axis, self.design.family_of(index), self.design.sample_hz)
        })
    }

    /// The residual over the variable of the modes, for each axis whose modes move.
    pub(crate) fn family_panels(&self) -> impl Iterator<Item = plot::Panel> {
        self.families().map(|family| family.panel(&self.machine.name))
    }

    /// The JSON document of the command line's contract.
    pub(crate) fn json(&self) -> Document {
        let fraction = self.design.coefficient_fraction;
        let axes = self.axes().map(|a| a.json(self.design.sample_hz, fraction)).collect();
        Document {
            name: self.machine.name.clone(),
            clocking: Clocking {
                clock_hz: self.machine.clock.frequency_hz,
                sample_hz: self.machine.clock.sample_hz,
                coefficient_fraction: fraction,
            },
            axes,
            fronts: Vec::new(),
            moves: Vec::new(),
            stage: self
                .design
                .stage
                .as_ref()
                .map(|stage| EqualDelays::new(stage, &self.design)),
            inline: self.inline(),
        }
    }

    /// Delays and rates of the inline shaper, if there is one.
    fn inline(&self) -> Vec<InlineAxisDocument> {
        let Ok(Some(inline)) = self.hardware.inline() else {
            return Vec::new();
        };
        let axes = self.machine.axes.iter().zip(&inline.axes);
        axes.map(|(axis, figures)| InlineAxisDocument {
            axis: axis.name.clone(),
            input_hz: figures.input_hz,
            output_hz: figures.output_hz,
            overshoot: figures.overshoot,
            shaped_s: figures.shaped_s,
            unshaped_s: figures.unshaped_s,
            settle_s: figures.settle_s,
        })
        .collect()
    }
}
