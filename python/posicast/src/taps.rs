//! The tap table, and the bit-exact model of the shaper that computes with it.

use crate::design::residuals;
use crate::error::refused;
use numpy::{Element, PyArray1, PyArrayMethods, PyReadonlyArray1};
use posicast_blocks::shaper::{CommandWord, SampleShaper, ShaperConfig};
use posicast_shaper::analysis::{residual_vibration, tap_impulses};
use posicast_taps::{Tap, TapTable};
use pyo3::prelude::*;
use std::sync::{Mutex, PoisonError};

/// An integer tap table for a sample rate.
#[pyclass(frozen, module = "posicast._native")]
pub(crate) struct Taps {
    table: TapTable,
    sample_hz: f64,
}

impl Taps {
    pub(crate) fn new(table: TapTable, sample_hz: f64) -> Self {
        Self { table, sample_hz }
    }
}

#[pymethods]
impl Taps {
    /// A table of these delays in samples and coefficients.
    #[new]
    fn of_taps(
        py: Python<'_>,
        delays: Vec<u32>,
        coefficients: Vec<i32>,
        fraction_bits: u32,
        sample_hz: f64,
    ) -> PyResult<Self> {
        let taps = delays.into_iter().zip(coefficients);
        let taps = taps.map(|(delay_samples, coefficient)| Tap {
            delay_samples,
            coefficient,
        });
        let table = TapTable::new(fraction_bits, taps.collect()).map_err(|error| {
            let remedy = "give delays in increasing order, and coefficients that sum to 2**fraction_bits";
            refused(py, error, remedy)
        })?;
        Ok(Self { table, sample_hz })
    }

    /// Samples per second.
    #[getter]
    fn sample_hz(&self) -> f64 {
        self.sample_hz
    }

    /// Fraction bits F of a coefficient.
    #[getter]
    fn fraction_bits(&self) -> u32 {
        self.table.coefficient_fraction()
    }

    /// Mean delay in samples.
    #[getter]
    fn mean_delay(&self) -> f64 {
        self.table.mean_delay_samples()
    }

    /// Delays in samples.
    fn delays<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        let taps = self.table.taps().iter();
        PyArray1::from_vec(py, taps.map(|tap| i64::from(tap.delay_samples)).collect())
    }

    /// Coefficients, in units of `2^-F`.
    fn coefficients<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        let taps = self.table.taps().iter();
        PyArray1::from_vec(py, taps.map(|tap| i64::from(tap.coefficient)).collect())
    }

    /// Residual vibration of the integer table at each pair of frequency in Hz and damping ratio.
    fn residual<'py>(
        &self,
        py: Python<'py>,
        frequency_hz: PyReadonlyArray1<'py, f64>,
        damping: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let impulses = tap_impulses(&self.table, self.sample_hz);
        residuals(py, &frequency_hz, &damping, |mode| residual_vibration(&impulses, mode))
    }

    /// The shaper after a start at this word, with words of this width.
    #[pyo3(signature = (word_bits, start))]
    fn stream(&self, py: Python<'_>, word_bits: u32, start: i64) -> PyResult<Stream> {
        let config = ShaperConfig::new(word_bits, self.table.clone()).map_err(|error| {
            refused(
                py,
                error,
                "give word_bits from 8 to 32, and a table that the hardware holds",
            )
        })?;
        let mut shaper = SampleShaper::new(&config);
        shaper.start(start);
        Ok(Stream(Mutex::new(shaper)))
    }
}

/// The bit-exact model of a shaper, with its history.
#[pyclass(frozen, module = "posicast._native")]
pub(crate) struct Stream(Mutex<SampleShaper>);

#[pymethods]
impl Stream {
    /// Shapes words of 64 bits in memory.
    fn apply64<'py>(
        &self,
        py: Python<'py>,
        command: PyReadonlyArray1<'py, i64>,
    ) -> PyResult<Bound<'py, PyArray1<i64>>> {
        self.apply(py, &command)
    }

    /// Shapes words of 32 bits in memory.
    fn apply32<'py>(
        &self,
        py: Python<'py>,
        command: PyReadonlyArray1<'py, i32>,
    ) -> PyResult<Bound<'py, PyArray1<i32>>> {
        self.apply(py, &command)
    }

    /// Whether a sample was clamped.
    #[getter]
    fn saturated(&self) -> bool {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).saturated()
    }
}

impl Stream {
    fn apply<'py, W: CommandWord + Element + Send + Sync>(
        &self,
        py: Python<'py>,
        command: &PyReadonlyArray1<'py, W>,
    ) -> PyResult<Bound<'py, PyArray1<W>>> {
        let command = command.as_slice()?;
        let shaped = PyArray1::zeros(py, command.len(), false);
        let done = {
            let mut room = shaped.readwrite();
            let room = room.as_slice_mut()?;
            py.detach(|| {
                let mut shaper = self.0.lock().unwrap_or_else(PoisonError::into_inner);
                shaper.shape(command, room)
            })
        };
        done.map_err(|error| refused(py, error, "report this bug"))?;
        Ok(shaped)
    }
}
