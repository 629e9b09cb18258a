//! Traces: signals of an axis, tick by tick, read from its trace memory; with a test signal if wanted.

use std::fmt::Write as _;
use std::io::{self, Read, Write};

use posicast_blocks::registers::{Choice, Field, Format};
use vcd::{IdCode, TimescaleUnit, VarType};

use crate::stage::{PATIENCE_TICKS, fault};
use crate::{HostError, HostedStage};

/// Ticks of a pseudo-random sequence beyond the trace, so that it does not end before.
const SPARE_TICKS: u32 = 100;
/// Most ticks of a test signal.
const MOST_TICKS: u32 = (1 << 24) - 1;

/// Signals to record.
#[derive(Debug, Clone, PartialEq)]
pub struct TraceRequest {
    /// Index of the axis.
    pub axis: usize,
    /// One, two or four signals, by their names in the register `TRACE_SETUP`.
    pub signals: Vec<String>,
    /// Ticks from row to row, 1 to 65,536.
    pub every_ticks: u32,
    /// A pseudo-random test signal on the position; the axis must be on, and stand.
    pub shake: Option<Shake>,
}

/// A pseudo-random sequence of 15 bits, added to the position reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shake {
    /// Amplitude in counts, up to 255.99; the machine file limits it further.
    pub amplitude_counts: f64,
    /// Ticks of a bit, 1 to 65,535.
    pub bit_ticks: u32,
}

/// A signal that was recorded.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecordedSignal {
    /// Its name in the registers.
    pub name: String,
    /// Unit of its values.
    pub unit: String,
    /// Fraction bits of its words.
    fraction: u32,
}

/// A trace that was read.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordedTrace {
    /// Name of the axis.
    pub axis: String,
    /// Time from row to row in s.
    pub row_s: f64,
    /// The signals, in the order of the request.
    pub signals: Vec<RecordedSignal>,
    /// A word per signal, row by row.
    words: Vec<Vec<i32>>,
}

impl RecordedTrace {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.words.len()
    }

    /// The rows in the units of the signals.
    pub fn values(&self) -> impl Iterator<Item = Vec<f64>> + '_ {
        let value = |(word, signal): (&i32, &RecordedSignal)| f64::from(*word) / f64::from(1u32 << signal.fraction);
        self.words
            .iter()
            .map(move |row| row.iter().zip(&self.signals).map(value).collect())
    }

    /// The trace as CSV: `time_s`, then the signals, in a form that `posicast identify` reads. The command to the drive is called
    /// `drive_command` there.
    pub fn csv(&self) -> String {
        let name = |signal: &RecordedSignal| match signal.name.as_str() {
            "command" => "drive_command".to_owned(),
            name => name.to_owned(),
        };
        let names: Vec<String> = self.signals.iter().map(name).collect();
        let mut text = format!("time_s,{}\n", names.join(","));
        for (row, values) in self.values().enumerate() {
            // The time has as many decimals as a tick, without the rounding error of the product.
            let _ = write!(text, "{}", format_args!("{:.9}", row as f64 * self.row_s));
            values.iter().for_each(|value| {
                let _ = write!(text, ",{value}");
            });
            text.push('\n');
        }
        text
    }

    /// The trace as VCD: a real per signal, times in ns.
    ///
    /// # Errors
    /// The error of `to`.
    pub fn vcd(&self, to: impl Write) -> io::Result<()> {
        let mut writer = vcd::Writer::new(to);
        writer.timescale(1, TimescaleUnit::NS)?;
        writer.add_module(&self.axis)?;
        let ids: Result<Vec<IdCode>, io::Error> = self
            .signals
            .iter()
            .map(|signal| writer.add_var(VarType::Real, 64, &signal.name, None))
            .collect();
        let ids = ids?;
        writer.upscope()?;
        writer.enddefinitions()?;
        for (row, values) in self.values().enumerate() {
            writer.timestamp((row as f64 * self.row_s * 1e9).round() as u64)?;
            for (id, value) in ids.iter().zip(values) {
                writer.change_real(*id, value)?;
            }
        }
        Ok(())
    }
}

impl<L: Read + Write> HostedStage<'_, L> {
    /// The signals that an axis's trace can record, with their formats and units.
    ///
    /// # Errors
    /// [`HostError::NoRegister`] for an axis without a trace memory.
    pub fn signals(&self, axis: usize) -> Result<Vec<RecordedSignal>, HostError> {
        Ok(self.choices(axis)?.iter().map(signal).collect())
    }

    fn choices(&self, axis: usize) -> Result<&[Choice], HostError> {
        match &self.field(axis, "trace_setup", "trace_select_0")?.format {
            Format::Enumeration(choices) => Ok(choices),
            _ => Err(HostError::NoRegister("TRACE_SETUP".to_owned())),
        }
    }

    /// Records until the memory is full, and reads it. The recording begins immediately.
    ///
    /// # Errors
    /// [`HostError`]; [`HostError::Trace`] for a request that the hardware cannot fulfil.
    pub fn trace(&mut self, request: &TraceRequest) -> Result<RecordedTrace, HostError> {
        self.trace_while(request, |stage| {
            let status = &stage.status()?[request.axis];
            if status.causes & !crate::stage::AFTER_RESET != 0 {
                return Err(fault(status));
            }
            Ok(())
        })
    }

    /// As [`trace`](Self::trace), while this check holds.
    pub(crate) fn trace_while(
        &mut self,
        request: &TraceRequest,
        holds: impl FnMut(&mut Self) -> Result<(), HostError>,
    ) -> Result<RecordedTrace, HostError> {
        let axis = request.axis;
        let chosen = self.chosen(request)?;
        if !(1..=1 << 16).contains(&request.every_ticks) {
            return Err(HostError::Trace(format!(
                "a row every {} ticks; allowed: 1 to 65536",
                request.every_ticks
            )));
        }
        let count = request.signals.len() as u32;
        let mut setup = (count / 2) << self.field(axis, "trace_setup", "trace_signals")?.low;
        for (place, choice) in chosen.iter().enumerate() {
            setup |= choice.value << self.field(axis, "trace_setup", &format!("trace_select_{place}"))?.low;
        }
        let signals: Vec<RecordedSignal> = chosen.iter().map(signal).collect();
        let rows = self.machine.axes[axis].trace.map_or(0, |trace| trace.samples) / count;
        let ticks = rows.saturating_mul(request.every_ticks);
        let shake = request
            .shake
            .map(|shake| self.shake_words(axis, &shake, ticks))
            .transpose()?;
        // A running signal would use the new settings.
        let of = |register: &str, word: u32| (self.of(axis, register), word);
        let mut words = vec![
            of("trace_halt", 0),
            of("trace_setup", setup),
            of("trace_rate", request.every_ticks - 1),
            of("trace_arm", 0),
        ];
        words.extend(shake.into_iter().flatten());
        self.write(&words)?;
        self.recorded(axis, ticks, holds)?;
        if request.shake.is_some() {
            self.write_one(axis, "excitation", 0)?;
        }
        let words = self.words(axis, count)?;
        Ok(RecordedTrace {
            axis: self.axis(axis).name.clone(),
            row_s: f64::from(request.every_ticks) / self.machine.clock.sample_hz,
            signals,
            words,
        })
    }

    fn chosen(&self, request: &TraceRequest) -> Result<Vec<Choice>, HostError> {
        let choices = self.choices(request.axis)?;
        let wrong = |what: String| {
            let names: Vec<&str> = choices.iter().map(|choice| choice.name.as_str()).collect();
            HostError::Trace(format!("{what}: choose one, two or four of {}", names.join(", ")))
        };
        if ![1, 2, 4].contains(&request.signals.len()) {
            return Err(wrong(format!("{} signals", request.signals.len())));
        }
        let find = |name: &String| choices.iter().find(|choice| choice.name == *name).cloned();
        let chosen = request
            .signals
            .iter()
            .map(|name| find(name).ok_or_else(|| wrong(format!("no signal `{name}`"))));
        chosen.collect()
    }

    /// The writes that start a test signal.
    fn shake_words(&mut self, axis: usize, shake: &Shake, ticks: u32) -> Result<Vec<(String, u32)>, HostError> {
        let status = &self.status()?[axis];
        if status.causes != 0 {
            return Err(fault(status));
        }
        if !status.can_start {
            return Err(HostError::Busy(status.axis.clone()));
        }
        let field = |register: &str, name: &str| self.field(axis, register, name);
        let amplitude = field("excitation", "excitation_amplitude")?;
        let word = (shake.amplitude_counts * 256.0).round();
        if !(1.0..=f64::from(amplitude.ones())).contains(&word) {
            let found = shake.amplitude_counts;
            return Err(HostError::Trace(format!(
                "an amplitude of {found} counts; allowed: at least 1/256, at most 255.99"
            )));
        }
        let period = field("excitation_time", "excitation_period")?;
        if !(1..=period.ones()).contains(&shake.bit_ticks) {
            return Err(HostError::Trace(format!(
                "bits of {} ticks; allowed: 1 to {}",
                shake.bit_ticks,
                period.ones()
            )));
        }
        let kind = field("excitation", "excitation_kind")?;
        let prbs = match &kind.format {
            Format::Enumeration(kinds) => kinds
                .iter()
                .find(|kind| kind.name == "prbs")
                .map_or(0, |kind| kind.value),
            _ => 0,
        };
        let at = |value: u32, field: &Field| value << field.low;
        let enable = field("excitation", "excitation_enable")?.mask();
        let ticks = ticks.saturating_add(SPARE_TICKS).min(MOST_TICKS);
        let of = |register: &str, word: u32| (self.of(axis, register), word);
        Ok(vec![
            of("excitation", 0),
            of("excitation_time", at(shake.bit_ticks, period)),
            of(
                "excitation_length",
                at(ticks, field("excitation_length", "excitation_duration")?),
            ),
            of("excitation", at(prbs, kind) | at(word as u32, amplitude) | enable),
        ])
    }

    /// Waits until the memory is full, as long as the check holds.
    fn recorded(
        &mut self,
        axis: usize,
        ticks: u32,
        mut holds: impl FnMut(&mut Self) -> Result<(), HostError>,
    ) -> Result<(), HostError> {
        let state = self.field(axis, "trace_status", "trace_state")?;
        let mut left = self.patience(ticks.saturating_add(PATIENCE_TICKS))?;
        while state.of(self.read_one(axis, "trace_status")?) != 0 {
            holds(self)?;
            if !self.pass(&mut left)? {
                return Err(HostError::Trace(
                    "the trace does not end: does the hardware get its tick?".to_owned(),
                ));
            }
        }
        Ok(())
    }

    /// Reads the words of a complete trace, and kicks the watchdogs meanwhile.
    fn words(&mut self, axis: usize, signals: u32) -> Result<Vec<Vec<i32>>, HostError> {
        let status = self.read_one(axis, "trace_status")?;
        let rows = self.field(axis, "trace_status", "trace_rows")?.of(status);
        let address = self.field(axis, "trace_address", "trace_address")?.low;
        let mut all = Vec::new();
        for row in 0..rows {
            let mut words = Vec::new();
            for signal in 0..signals {
                self.write_one(axis, "trace_address", (row * signals + signal) << address)?;
                words.push(self.read_one(axis, "trace_data")? as i32);
            }
            all.push(words);
            if row % 16 == 0 {
                self.kick()?;
            }
        }
        Ok(all)
    }
}

/// Converts an entry of the register map to a signal: the words after the comma are its format and unit, `Q24.8 counts` or `counts`.
fn signal(choice: &Choice) -> RecordedSignal {
    let format = choice.meaning.rsplit(',').next().unwrap_or_default().trim();
    let (fraction, unit) = match format.strip_prefix('Q').and_then(|rest| rest.split_once(' ')) {
        Some((bits, unit)) => (
            bits.split('.').nth(1).and_then(|bits| bits.parse().ok()).unwrap_or(0),
            unit,
        ),
        None => (0, format),
    };
    RecordedSignal {
        name: choice.name.clone(),
        unit: unit.to_owned(),
        fraction,
    }
}
