//! Writes waveforms: one VCD per run, and one that shows several side by side.
//!
//! ```text
//!            ┌─ step 0 ─┐┌─ step 1 ─┐┌─ step 2 ─┐
//!  clk       ‾‾‾‾‾‾\_____/‾‾‾‾\_____/‾‾‾‾\_____/‾      step k is what stands just before rising edge k,
//!  y         <  of 0    ><  of 1    ><  of 2    >      and changes with the edge before it, as registers do
//! ```
//!
//! - Files are written to a temporary name beside their own and renamed when complete; a run that fails leaves nothing.
//! - Memory does not grow with the length: only the latest value of each signal is kept, only changes are written.
//! - The timescale is the coarsest in which half a clock period is a whole number, down to femtoseconds.

mod clocking;
mod output;
mod view;

use std::path::Path;

use posicast_model::rtl::{Direction, Port};
use vcd::{IdCode, VarType};

use self::clocking::Clocking;
use self::output::Output;
pub use self::output::write_text;
pub use self::view::{Difference, Focus, Part, merge, merge_around};
use crate::Error;

/// How a signal is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SignalKind {
    /// A vector of so many bits, 1..=64.
    Bits(u32),
    /// A real number; its value is handed over as [`f64::to_bits`].
    Real,
}

/// A signal of a waveform.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Signal {
    /// Name, as in the Verilog: one word.
    pub name: String,
    /// Kind and width.
    pub kind: SignalKind,
}

impl Signal {
    /// A vector.
    pub fn bits(name: &str, width: u32) -> Self {
        Self {
            name: name.to_owned(),
            kind: SignalKind::Bits(width.clamp(1, 64)),
        }
    }

    /// A real number.
    pub fn real(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            kind: SignalKind::Real,
        }
    }
}

struct Recorded {
    id: IdCode,
    kind: SignalKind,
    last: Option<u64>,
}

/// Writes the signals of one clock domain, a row per clock.
pub struct Recorder {
    output: Output,
    clock: IdCode,
    clocking: Clocking,
    signals: Vec<Recorded>,
    clocks: u64,
}

impl Recorder {
    /// Starts a file with the scopes `scope[0].scope[1]…`, which holds `clk` and the signals.
    ///
    /// # Errors
    /// [`Error::Option`] for a clock that is not positive and at most 500 THz, or a name that VCD cannot hold;
    /// [`Error::File`] if the file cannot be made.
    pub fn create(path: &Path, clock_hz: f64, scope: &[&str], signals: &[Signal]) -> Result<Self, Error> {
        let clocking = Clocking::new(clock_hz)?;
        let names = scope.iter().copied().chain(signals.iter().map(|s| s.name.as_str()));
        for name in names {
            if name.is_empty() || !name.bytes().all(|b| b.is_ascii_graphic()) {
                return Err(Error::Option(format!(
                    "`{name}` is no name for a waveform: use letters, digits and _"
                )));
            }
        }
        let mut output = Output::create(path)?;
        let (clock, ids) = output.write(|vcd| {
            vcd.timescale(clocking.timescale.0, clocking.timescale.1)?;
            for name in scope {
                vcd.add_module(name)?;
            }
            if scope.is_empty() {
                vcd.add_module("top")?;
            }
            let clock = vcd.add_wire(1, "clk")?;
            let declare = |signal: &Signal| match signal.kind {
                SignalKind::Bits(width) => vcd.add_wire(width.clamp(1, 64), &signal.name),
                SignalKind::Real => vcd.add_var(VarType::Real, 64, &signal.name, None),
            };
            let ids = signals.iter().map(declare).collect::<std::io::Result<Vec<_>>>()?;
            for _ in 0..scope.len().max(1) {
                vcd.upscope()?;
            }
            vcd.enddefinitions()?;
            Ok((clock, ids))
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
            clocking,
            clocks: 0,
        })
    }

    /// Starts a file for a block's ports, inputs first, then outputs, each in the order of the ports.
    ///
    /// # Errors
    /// As [`Recorder::create`].
    pub fn for_ports(path: &Path, clock_hz: f64, scope: &[&str], ports: &[Port]) -> Result<Self, Error> {
        let all = |direction| ports.iter().filter(move |p| p.direction == direction);
        let signals = all(Direction::Input).chain(all(Direction::Output));
        let signals: Vec<Signal> = signals.map(|p| Signal::bits(&p.name, p.width)).collect();
        Self::create(path, clock_hz, scope, &signals)
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
        let (clock, signals, first) = (self.clock, &mut self.signals, self.clocks == 0);
        self.output.write(|vcd| {
            vcd.timestamp(rise)?;
            if first {
                vcd.begin(vcd::SimulationCommand::Dumpvars)?;
            }
            vcd.change_scalar(clock, true)?;
            for (signal, value) in signals.iter_mut().zip(values.iter().copied().flatten()) {
                if signal.last != Some(*value) {
                    signal.last = Some(*value);
                    output::change(vcd, signal.id, signal.kind, *value)?;
                }
            }
            if first {
                vcd.end()?;
            }
            vcd.timestamp(fall)?;
            vcd.change_scalar(clock, false)
        })?;
        self.clocks += 1;
        Ok(())
    }

    /// Writes the last rising edge and puts the file in its place.
    ///
    /// # Errors
    /// [`Error::File`] if writing or renaming fails.
    pub fn finish(mut self) -> Result<(), Error> {
        let (rise, _) = self.clocking.edges(self.clocks)?;
        let clock = self.clock;
        if self.clocks > 0 {
            self.output.write(|vcd| {
                vcd.timestamp(rise)?;
                vcd.change_scalar(clock, true)
            })?;
        }
        self.output.finish()
    }
}
