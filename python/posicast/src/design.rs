//! The shaper of an axis: floating-point impulses, and their figures.

use crate::error::{NO_FILE, raised, refused};
use crate::taps::Taps;
use crate::waited::waited;
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray1};
use posicast_flow::{Failure, compare, design, machine};
use posicast_machine::machine_file::{self, Machine};
use posicast_machine::plan::{AxisTables, design_machine};
use posicast_shaper::analysis::{insensitivity, residual_vibration, sensitivity_curve};
use posicast_shaper::digitise::RealShaper;
use posicast_shaper::mode::Mode;
use pyo3::prelude::*;
use std::path::Path;
use std::sync::Mutex;

/// Two arrays of the same length.
pub(crate) type Pair<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

/// The designed shaper of an axis.
#[pyclass(frozen, module = "posicast._native")]
pub(crate) struct Design {
    axis: usize,
    machine: Machine,
    tables: AxisTables,
}

/// Designs the axes of a machine.
pub(crate) fn designs(machine: &Machine, path: &Path) -> Result<Vec<Design>, Failure> {
    let design = design_machine(machine).map_err(|error| machine::of_design(machine, &error, path))?;
    let axes = design.axes.into_iter().enumerate();
    Ok(axes
        .map(|(axis, tables)| Design {
            axis,
            machine: machine.clone(),
            tables,
        })
        .collect())
}

/// Designs the only axis of a machine file without a file.
#[pyfunction]
pub(crate) fn design_text(py: Python<'_>, text: String) -> PyResult<Design> {
    let designed = waited(py, move || {
        let machine = machine_file::parse(NO_FILE, &text)?;
        designs(&machine, Path::new(NO_FILE))
    })?;
    let mut designs = designed.map_err(|failure| raised(py, &failure, Some(NO_FILE)))?;
    designs.pop().ok_or_else(|| refused(py, "no axis", "describe one axis"))
}

/// Compares every kind of shaper on the only axis of a machine file without a file; returns a JSON document.
#[pyfunction]
pub(crate) fn compare_text(py: Python<'_>, text: String, band_percent: f64) -> PyResult<String> {
    let compared = waited(py, move || {
        let machine = machine_file::parse(NO_FILE, &text)?;
        posicast_flow::text::json_text(&compare::of_machine(&machine, band_percent))
    })?;
    compared.map_err(|failure| raised(py, &failure, Some(NO_FILE)))
}

#[pymethods]
impl Design {
    /// Name of the axis.
    #[getter]
    fn axis(&self) -> &str {
        &self.tables.design.name
    }

    /// Kind of the shaper.
    #[getter]
    fn kind(&self) -> &str {
        &self.tables.design.kind
    }

    /// Samples per second of the tap table.
    #[getter]
    fn sample_hz(&self) -> f64 {
        self.machine.clock.sample_hz
    }

    /// Frequency in Hz and damping ratio of each mode.
    #[getter]
    fn modes(&self) -> Vec<(f64, f64)> {
        let modes = self.machine.axes[self.axis].modes.iter();
        modes.map(|mode| (mode.mode.frequency_hz, mode.mode.damping)).collect()
    }

    /// Time of the last impulse in s.
    #[getter]
    fn duration(&self) -> f64 {
        self.tables.design.impulses.duration_s()
    }

    /// Mean delay in s.
    #[getter]
    fn delay(&self) -> f64 {
        self.tables.design.impulses.delay_s()
    }

    /// Times in s and amplitudes of the impulses.
    fn impulses<'py>(&self, py: Python<'py>) -> Pair<'py> {
        let impulses = self.tables.design.impulses.impulses().iter();
        let (times, amplitudes): (Vec<f64>, Vec<f64>) = impulses.map(|i| (i.time_s, i.amplitude)).unzip();
        (PyArray1::from_vec(py, times), PyArray1::from_vec(py, amplitudes))
    }

    /// Delays in samples and weights of the taps before rounding.
    fn real_taps<'py>(&self, py: Python<'py>) -> (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<f64>>) {
        let taps = self.tables.digitised.taps.iter();
        let (delays, weights): (Vec<i64>, Vec<f64>) = taps.map(|t| (i64::from(t.delay_samples), t.weight)).unzip();
        (PyArray1::from_vec(py, delays), PyArray1::from_vec(py, weights))
    }

    /// Residual vibration at each pair of frequency in Hz and damping ratio.
    fn residual<'py>(
        &self,
        py: Python<'py>,
        frequency_hz: PyReadonlyArray1<'py, f64>,
        damping: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let impulses = self.tables.design.impulses.impulses();
        residuals(py, &frequency_hz, &damping, |mode| residual_vibration(impulses, mode))
    }

    /// Frequency ratios, and the residual vibration there.
    fn sensitivity<'py>(&self, py: Python<'py>, mode: (f64, f64), low: f64, high: f64, points: usize) -> Pair<'py> {
        let curve = sensitivity_curve(
            self.tables.design.impulses.impulses(),
            &mode_of(mode),
            low,
            high,
            points,
        );
        let (ratios, residuals): (Vec<f64>, Vec<f64>) = curve.into_iter().unzip();
        (PyArray1::from_vec(py, ratios), PyArray1::from_vec(py, residuals))
    }

    /// Frequency ratios between which at most `tolerance` remains; the upper one is `None` beyond the searched range.
    fn insensitivity(&self, mode: (f64, f64), tolerance: f64) -> Option<(f64, Option<f64>)> {
        let found = insensitivity(self.tables.design.impulses.impulses(), &mode_of(mode), tolerance)?;
        Some((found.low, found.high))
    }

    /// The integer table of the hardware.
    fn taps(&self) -> Taps {
        Taps::new(self.tables.table.clone(), self.machine.clock.sample_hz)
    }

    /// The document of `posicast design --json` for this axis, with the certificate if it is wanted.
    fn document(&self, py: Python<'_>, certify: bool) -> PyResult<String> {
        let (machine, axis) = (self.machine.clone(), self.axis);
        let described = waited(py, move || {
            let document = design::described(&machine, Path::new(NO_FILE), certify)?;
            posicast_flow::text::json_text(&document.axes[axis])
        })?;
        described.map_err(|failure| raised(py, &failure, Some(NO_FILE)))
    }

    /// The shaper in floating point on the samples, before its first one.
    #[pyo3(signature = (start=None))]
    fn stream(&self, start: Option<f64>) -> RealStream {
        RealStream(Mutex::new(RealShaper::new(&self.tables.digitised, start)))
    }
}

fn mode_of((frequency_hz, damping): (f64, f64)) -> Mode {
    Mode { frequency_hz, damping }
}

/// A figure at each pair of frequency and damping ratio.
pub(crate) fn residuals<'py>(
    py: Python<'py>,
    frequency_hz: &PyReadonlyArray1<'py, f64>,
    damping: &PyReadonlyArray1<'py, f64>,
    figure: impl Fn(&Mode) -> f64 + Sync,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let (frequencies, dampings) = (frequency_hz.as_slice()?, damping.as_slice()?);
    let figures: Vec<f64> = py.detach(|| {
        let pairs = frequencies.iter().zip(dampings);
        pairs.map(|pair| figure(&mode_of((*pair.0, *pair.1)))).collect()
    });
    Ok(PyArray1::from_vec(py, figures))
}

/// A shaper in floating point with its history.
#[pyclass(frozen, module = "posicast._native")]
pub(crate) struct RealStream(Mutex<RealShaper>);

#[pymethods]
impl RealStream {
    /// Shapes the samples that follow.
    fn apply<'py>(&self, py: Python<'py>, command: PyReadonlyArray1<'py, f64>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let command = command.as_slice()?;
        let shaped = PyArray1::zeros(py, command.len(), false);
        {
            let mut room = shaped.readwrite();
            let room = room.as_slice_mut()?;
            py.detach(|| {
                let mut shaper = self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
                shaper.shape(command, room);
            });
        }
        Ok(shaped)
    }
}
