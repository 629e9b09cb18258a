//! Writes waveforms: one VCD per run. [`merge`] writes one that shows several side by side.
//!
//! ```text
//!            ┌─ step 0 ─┐┌─ step 1 ─┐┌─ step 2 ─┐
//!  clk       ‾‾‾‾‾‾\_____/‾‾‾‾\_____/‾‾‾‾\_____/‾      step k is what stands just before rising edge k,
//!  y         <  of 0    ><  of 1    ><  of 2    >      and changes with the edge before it, as registers do
//! ```
//!
//! - Files are written under a temporary name beside their own and renamed when complete; a run that fails leaves
//!   none.
//! - Memory does not grow with the length: only the latest value of each signal is kept, and only changes are
//!   written.
//! - The timescale is one second divided by a power of 1000: the coarsest in which half a clock period is a whole number, down
//!   to femtoseconds.
//! - Clocks without changes can be [left out](Recorder::skip_to), with all times correct. The file shows this: `clk`
//!   is `x` there, and a signal `recording` is 0.
//!
//! ```text
//!  clk        ‾\_/‾\_/‾\_xxxxxxxxxxxxxxxxxxxxxx_/‾\_/‾\_     one row each time that clk rises
//!  recording  ‾‾‾‾‾‾‾‾‾‾‾\____________________/‾‾‾‾‾‾‾‾‾     from half a period before the clock that is recorded next
//! ```

mod clocking;
mod output;

use std::path::Path;

use posicast_blocks::{Direction, Port};
use vcd::{IdCode, VarType};

use self::clocking::Clocking;
use self::output::Output;
pub use self::output::{SealedFiles, SignalKind, merge, write_text};
use crate::Error;

/// A signal of a waveform.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Signal {
    /// Name, as in the Verilog: one word.
    pub name: String,
    /// Kind and width.
    pub kind: SignalKind,
}

impl Signal {
    /// Creates a vector.
    pub fn bits(name: &str, width: u32) -> Self {
        Self {
            name: name.to_owned(),
            kind: SignalKind::Bits(width.clamp(1, 64)),
        }
    }

    /// Creates a real number.
    pub fn real(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            kind: SignalKind::Real,
        }
    }
}

/// Contents of a file apart from its signals.
#[derive(Debug, Clone, Copy, Default)]
pub struct Heading<'a> {
    /// Name of the clock; `clk` if empty.
    pub clock: &'a str,
    /// Text of a `$comment` at the top; none if empty.
    pub comment: &'a str,
    /// Whether clocks may be [left out](Recorder::skip_to): the file then has the signal `recording`.
    pub gaps: bool,
}

/// Name of the signal that is 0 while the clock is not recorded.
const RECORDING: &str = "recording";

struct Recorded {
    id: IdCode,
    kind: SignalKind,
    last: Option<u64>,
}

/// Writes the signals of one clock domain, a row per clock.
pub struct Recorder {
    output: Output,
    clock: IdCode,
    recording: Option<IdCode>,
    clocking: Clocking,
    signals: Vec<Recorded>,
    clocks: u64,
    /// Whether nothing has been written yet.
    is_new: bool,
    /// Whether the clock of the previous row was left out.
    behind_gap: bool,
}

impl Recorder {
    /// Starts a file with the scopes `scope[0].scope[1]…`, which holds `clk` and the signals.
    ///
    /// # Errors
    /// [`Error::Option`] for a clock that is not positive and at most 500 THz, or a name that VCD cannot hold;
    /// [`Error::File`] if the file cannot be made.
    pub fn create(path: &Path, clock_hz: f64, scope: &[&str], signals: &[Signal]) -> Result<Self, Error> {
        Self::create_with(path, clock_hz, scope, signals, &Heading::default())
    }

    /// Like [`Recorder::create`], with a given heading.
    ///
    /// # Errors
    /// As [`Recorder::create`].
    pub fn create_with(
        path: &Path,
        clock_hz: f64,
        scope: &[&str],
        signals: &[Signal],
        heading: &Heading<'_>,
    ) -> Result<Self, Error> {
        let clocking = Clocking::new(clock_hz)?;
        let clock_name = if heading.clock.is_empty() { "clk" } else { heading.clock };
        let names = scope.iter().copied().chain(signals.iter().map(|s| s.name.as_str()));
        for name in names.chain([clock_name]) {
            if name.is_empty() || !name.bytes().all(|b| b.is_ascii_graphic()) {
                return Err(Error::Option(format!(
                    "`{name}` is not a valid name in a waveform: use letters, digits and _"
                )));
            }
        }
        let mut output = Output::create(path)?;
        let (clock, recording, ids) = output.write(|vcd| {
            if !heading.comment.is_empty() {
                vcd.comment(heading.comment)?;
            }
            vcd.timescale(1, clocking.unit)?;
            for name in scope {
                vcd.add_module(name)?;
            }
            if scope.is_empty() {
                vcd.add_module("top")?;
            }
            let clock = vcd.add_wire(1, clock_name)?;
            let recording = heading.gaps.then(|| vcd.add_wire(1, RECORDING)).transpose()?;
            let declare = |signal: &Signal| match signal.kind {
                SignalKind::Bits(width) => vcd.add_wire(width.clamp(1, 64), &signal.name),
                SignalKind::Real => vcd.add_var(VarType::Real, 64, &signal.name, None),
            };
            let ids = signals.iter().map(declare).collect::<std::io::Result<Vec<_>>>()?;
            for _ in 0..scope.len().max(1) {
                vcd.upscope()?;
            }
            vcd.enddefinitions()?;
            Ok((clock, recording, ids))
        })?;
        let recorded = ids.into_iter().zip(signals).map(|(id, signal)| Recorded {
            id,
            kind: signal.kind,
            last: None,
        });
        Ok(Self {
            signals: recorded.collect(),
            output,
            clock,
            recording,
            clocking,
            clocks: 0,
            is_new: true,
            behind_gap: false,
        })
    }

    /// Starts a file for a block's ports, inputs first, then outputs, each in the order of the ports.
    ///
    /// # Errors
    /// As [`Recorder::create`].
    pub fn for_ports(
        path: &Path,
        clock_hz: f64,
        scope: &[&str],
        ports: &[Port],
        heading: &Heading<'_>,
    ) -> Result<Self, Error> {
        let all = |direction| ports.iter().filter(move |p| p.direction == direction);
        let signals = all(Direction::Input).chain(all(Direction::Output));
        let signals: Vec<Signal> = signals.map(|p| Signal::bits(&p.name, p.width)).collect();
        Self::create_with(path, clock_hz, scope, &signals, heading)
    }

    /// Writes one clock: a value per signal, in order, that may come in several slices (inputs, outputs).
    ///
    /// # Errors
    /// [`Error::File`] if writing fails; [`Error::Option`] if the number of values is not that of the signals.
    pub fn clock(&mut self, values: &[&[u64]]) -> Result<(), Error> {
        let count: usize = values.iter().map(|v| v.len()).sum();
        if count != self.signals.len() {
            return Err(Error::Option(format!(
                "{count} values for the {} signals of a waveform",
                self.signals.len()
            )));
        }
        let (rise, fall) = self.clocking.edges(self.clocks)?;
        let start = self.clocking.before(self.clocks)?;
        let is_new = std::mem::take(&mut self.is_new);
        let behind_gap = std::mem::take(&mut self.behind_gap);
        let (clock, recording, signals) = (self.clock, self.recording, &mut self.signals);
        self.output.write(|vcd| {
            if behind_gap && !is_new {
                vcd.timestamp(start)?;
                vcd.change_scalar(clock, false)?;
                recording.map_or(Ok(()), |id| vcd.change_scalar(id, true))?;
            }
            vcd.timestamp(rise)?;
            if is_new {
                vcd.begin(vcd::SimulationCommand::Dumpvars)?;
            }
            vcd.change_scalar(clock, true)?;
            if is_new {
                recording.map_or(Ok(()), |id| vcd.change_scalar(id, true))?;
            }
            for (signal, value) in signals.iter_mut().zip(values.iter().copied().flatten()) {
                if signal.last != Some(*value) {
                    signal.last = Some(*value);
                    output::change(vcd, signal.id, signal.kind, *value)?;
                }
            }
            if is_new {
                vcd.end()?;
            }
            vcd.timestamp(fall)?;
            vcd.change_scalar(clock, false)
        })?;
        self.clocks += 1;
        Ok(())
    }

    /// Leaves out all clocks before clock `clock`, counted from the beginning of the file: nothing may change in
    /// them, and the next recorded clock is `clock`. If that is the next clock anyway, nothing happens.
    ///
    /// # Errors
    /// [`Error::Option`] for a clock that was recorded before, and where the file has no signal `recording`
    /// ([`Heading::gaps`]); [`Error::File`] if writing fails.
    pub fn skip_to(&mut self, clock: u64) -> Result<(), Error> {
        let Some(recording) = self.recording.filter(|_| clock >= self.clocks) else {
            return Err(Error::Option(format!(
                "clocks before clock {clock} of a waveform cannot be left out"
            )));
        };
        if clock == self.clocks {
            return Ok(());
        }
        if !self.is_new && !self.behind_gap {
            let (end, _) = self.clocking.edges(self.clocks)?;
            let id = self.clock;
            self.output.write(|vcd| {
                vcd.timestamp(end)?;
                vcd.change_scalar(id, vcd::Value::X)?;
                vcd.change_scalar(recording, false)
            })?;
        }
        self.behind_gap = true;
        self.clocks = clock;
        Ok(())
    }

    /// Writes the last rising edge and puts the file in its place.
    ///
    /// # Errors
    /// [`Error::File`] if writing or renaming fails.
    pub fn finish(mut self) -> Result<(), Error> {
        let (rise, _) = self.clocking.edges(self.clocks)?;
        let clock = self.clock;
        if !self.is_new && !self.behind_gap {
            self.output.write(|vcd| {
                vcd.timestamp(rise)?;
                vcd.change_scalar(clock, true)
            })?;
        }
        self.output.finish()
    }
}
