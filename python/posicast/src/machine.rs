//! The machine file, and the simulation of its axes.

use crate::design::{Design, designs};
use crate::error::raised;
use crate::waited::waited;
use numpy::{PyArray1, PyReadonlyArray1};
use posicast_flow::identify::{self, Judgement, LogExcitation, LogOptions};
use posicast_flow::simulate::{self, SimulatedMotion};
use posicast_flow::text::json_text;
use posicast_flow::{Failure, Silent, compare, design, machine, plot};
use posicast_machine::machine_file::Machine;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// A machine file that was read and checked.
#[pyclass(frozen, module = "posicast._native")]
pub(crate) struct MachineFile {
    path: PathBuf,
    machine: Machine,
}

#[pymethods]
impl MachineFile {
    /// Reads and checks a machine file.
    #[new]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let of = path.clone();
        let file = waited(py, move || machine::read(&of))?;
        let file = file.map_err(|failure| raised(py, &failure, Some(&path.display().to_string())))?;
        Ok(Self {
            path,
            machine: file.machine,
        })
    }

    /// Name of the machine.
    #[getter]
    fn name(&self) -> &str {
        &self.machine.name
    }

    /// Samples per second.
    #[getter]
    fn sample_hz(&self) -> f64 {
        self.machine.clock.sample_hz
    }

    /// Name and unit of each axis.
    #[getter]
    fn axes(&self) -> Vec<(String, &'static str)> {
        let axes = self.machine.axes.iter();
        axes.map(|axis| (axis.name.clone(), axis.unit.name())).collect()
    }

    /// The shapers of the axes.
    fn designs(&self, py: Python<'_>) -> PyResult<Vec<Design>> {
        let (machine, path) = (self.machine.clone(), self.path.clone());
        let designed = waited(py, move || designs(&machine, &path))?;
        designed.map_err(|failure| self.raised(py, &failure))
    }

    /// The document of `posicast design --json`.
    fn document(&self, py: Python<'_>, certify: bool) -> PyResult<String> {
        let (machine, path) = (self.machine.clone(), self.path.clone());
        let described = waited(py, move || json_text(&design::described(&machine, &path, certify)?))?;
        described.map_err(|failure| self.raised(py, &failure))
    }

    /// The document of `posicast design --compare --json`.
    fn compare(&self, py: Python<'_>, band_percent: f64) -> PyResult<String> {
        let machine = self.machine.clone();
        let compared = waited(py, move || json_text(&compare::of_machine(&machine, band_percent)))?;
        compared.map_err(|failure| self.raised(py, &failure))
    }

    /// The axes after a command: positions by axis at the sample rate, in the axis's unit; without one, the default move of each.
    fn simulate<'py>(
        &self,
        py: Python<'py>,
        command: Option<Vec<PyReadonlyArray1<'py, f64>>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let command: Option<Vec<Vec<f64>>> = command
            .map(|axes| {
                axes.iter()
                    .map(|axis| Ok(axis.as_slice()?.to_vec()))
                    .collect::<PyResult<_>>()
            })
            .transpose()?;
        let (machine, path) = (self.machine.clone(), self.path.clone());
        let moved = waited(py, move || {
            simulate::motion(&machine, &path, command.as_deref(), &Silent)
        })?;
        let moved = moved.map_err(|failure| self.raised(py, &failure))?;
        let axes = PyDict::new(py);
        for motion in moved {
            axes.set_item(motion.axis.clone(), of_motion(py, motion)?)?;
        }
        Ok(axes)
    }
}

impl MachineFile {
    fn raised(&self, py: Python<'_>, failure: &Failure) -> PyErr {
        raised(py, failure, Some(&self.path.display().to_string()))
    }
}

fn of_motion(py: Python<'_>, motion: SimulatedMotion) -> PyResult<Bound<'_, PyDict>> {
    let axis = PyDict::new(py);
    axis.set_item("lsb", motion.unit_per_lsb)?;
    axis.set_item("command_words", PyArray1::from_vec(py, motion.words))?;
    axis.set_item("shaped_words", PyArray1::from_vec(py, motion.simulation.shaped))?;
    axis.set_item("float_words", PyArray1::from_vec(py, motion.simulation.float))?;
    axis.set_item("position_lsb", PyArray1::from_vec(py, motion.simulation.position))?;
    axis.set_item(
        "unshaped_lsb",
        PyArray1::from_vec(py, motion.simulation.position_unshaped),
    )?;
    axis.set_item("ringing_lsb", motion.simulation.vibration)?;
    axis.set_item("ringing_unshaped_lsb", motion.simulation.vibration_unshaped)?;
    axis.set_item("bound_lsb", motion.simulation.bound_lsb)?;
    Ok(axis)
}

/// A panel of a picture: title, labels of its axes, and curves by name.
type Panel<'py> = (
    String,
    String,
    String,
    Vec<(String, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>)>,
);

/// Finds the modes in a log; returns the document, why no mode was found, and the curves.
#[pyfunction]
#[pyo3(signature = (log, columns, rate_hz, direction, sweep, output_only, ring_down, acceleration, margin_percent))]
#[allow(clippy::too_many_arguments, reason = "each is an option of the command")]
pub(crate) fn identify_log<'py>(
    py: Python<'py>,
    log: PathBuf,
    columns: Option<Vec<String>>,
    rate_hz: Option<f64>,
    direction: Option<String>,
    sweep: Option<String>,
    output_only: bool,
    ring_down: bool,
    acceleration: f64,
    margin_percent: f64,
) -> PyResult<(String, Option<String>, Vec<Panel<'py>>)> {
    let sweep = sweep.map(|text| identify::sweep(&text)).transpose();
    let sweep = sweep.map_err(|allowed| {
        let remedy = "write START:END:RATE:ACCEL, or leave it out: it is then estimated from the log";
        crate::error::refused(py, format!("sweep: allowed is {allowed}"), remedy)
    })?;
    let excitation = LogExcitation {
        sweep,
        output_only,
        ring_down,
    };
    let log_options = LogOptions {
        columns,
        rate_hz,
        direction,
    };
    let judgement = Judgement {
        acceleration,
        margin: margin_percent / 100.0,
        ..Judgement::default()
    };
    let file = log.display().to_string();
    let found = waited(py, move || {
        let (outcome, panels) = identify::with_curves(&log, &log_options, &excitation, &judgement)?;
        Ok((json_text(&outcome.document)?, outcome.failed, panels))
    })?;
    let (document, failed, panels) = found.map_err(|failure: Failure| raised(py, &failure, Some(&file)))?;
    let panels = panels.into_iter().map(|panel| of_panel(py, panel)).collect();
    Ok((document, failed, panels))
}

fn of_panel(py: Python<'_>, panel: plot::Panel) -> Panel<'_> {
    let curves = panel.curves.iter().map(|curve| {
        let (x, y): (Vec<f64>, Vec<f64>) = curve.points().iter().copied().unzip();
        (
            curve.name().to_owned(),
            PyArray1::from_vec(py, x),
            PyArray1::from_vec(py, y),
        )
    });
    (panel.title, panel.x_label, panel.y_label, curves.collect())
}
