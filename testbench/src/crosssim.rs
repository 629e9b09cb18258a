//! Runs the same Verilog in two independent simulators, and compares their waveforms by our own [`diff`].
//!
//! ```text
//!               ┌─► Verilator ─────────────────────► verilator.vcd ─┐
//!  stimuli ─────┼─► Icarus, as emitted ────────────► icarus.vcd ────┤─► diff: every port, every clock, exact
//!  (same rows)  └─► Icarus, without initial values ► unset.vcd ─────┘─► diff, from the release of the first reset on
//! ```
//!
//! - Verilator's memories, and unset registers, start at random; Icarus's start as `x`, which its own waveform shows.
//!   An `x` or `z` on an output is a difference, from the first clock on.
//! - The emitted Verilog gives every register its reset value at power-up, which would hide a register without a
//!   reset. The third run is without these values: all registers are `x` until the reset, and no output may be `x`
//!   after it.
//! - The first two runs are also in lock step with the model, to whose outputs the stimuli react; so is the third,
//!   whose mismatches before the reset do not count.
//!
//! This does not show whether both simulators share a misunderstanding of the language, nor compare signals inside a
//! block.

use std::path::Path;
use std::time::{Duration, Instant};

use posicast_blocks::{Direction, Port};
use posicast_hdl::emit::Module;

use crate::Error;
use crate::blocks::{Block, Sources};
use crate::icarus::SCOPE;
use crate::lockstep::report::{self, LockstepReport};
use crate::lockstep::{self, Clock};
use crate::wave::{Heading, Recorder};
use wavecmp::diff::{self, Comparison, DiffOptions, DiffVerdict, Reset};

/// Clock frequency of the waveforms: Icarus's testbench has two steps of 1 ns per clock.
const CLOCK_HZ: f64 = 500e6;
/// The input that resets a block.
const RESET: &str = "rst";

/// Result for a block.
#[derive(Debug, Clone)]
pub struct CrosssimOutcome {
    /// Number of ports of the block.
    pub ports: usize,
    /// Lock step of Verilator with the model.
    pub verilator: LockstepReport,
    /// Lock step of Icarus with the model.
    pub icarus: LockstepReport,
    /// Comparison of Icarus's waveform with Verilator's.
    pub waves: Comparison,
    /// Comparison of the run without initial values, from the release of the first reset on.
    pub unset: Comparison,
    /// Duration of the runs.
    pub time: Duration,
}

impl CrosssimOutcome {
    /// Whether everything is equal and was compared: every port, in every clock of the run.
    pub fn is_good(&self) -> bool {
        let matched = [&self.verilator, &self.icarus].map(|report| report.result == report::LockstepVerdict::Match);
        let whole = |waves: &Comparison| {
            waves.result == DiffVerdict::Equal && waves.exact && waves.signals == self.ports as u64 + 1
        };
        matched == [true; 2]
            && whole(&self.waves)
            && self.waves.samples == self.icarus.cycles
            && whole(&self.unset)
            && self.unset.samples > 0
    }
}

/// Runs a block for this many clocks in both simulators, and writes the waveforms into `folder`.
///
/// # Errors
/// Those of [`Sources::verilated`], [`lockstep::run`] and [`diff::compare`].
pub fn run(block: &dyn Block, clocks: u64, seed: u64, folder: &Path) -> Result<CrosssimOutcome, Error> {
    run_modules(block, &block.modules()?, clocks, seed, folder)
}

/// Runs a block with other Verilog, for example one that was changed on purpose.
///
/// # Errors
/// Those of [`run`].
pub fn run_modules(
    block: &dyn Block,
    modules: &[Module],
    clocks: u64,
    seed: u64,
    folder: &Path,
) -> Result<CrosssimOutcome, Error> {
    let start = Instant::now();
    let bench = Bench { block, clocks, seed };
    let sources = Sources::of_modules(modules)?;
    let [verilator, icarus, unset] = ["verilator.vcd", "icarus.vcd", "unset.vcd"].map(|name| folder.join(name));
    let of_verilator = bench.verilated(&sources, &verilator)?;
    let of_icarus = bench.icarus(&sources, &icarus)?;
    let without: Vec<Module> = modules.iter().map(without_initial_values).collect();
    bench.icarus(&Sources::of_modules(&without)?, &unset)?;

    let exact = DiffOptions {
        require_all: true,
        // This is a variable of the testbench.
        ignore: vec![format!("{SCOPE}.posicast_read")],
        ..DiffOptions::default()
    };
    let released = DiffOptions {
        reset: Reset::Named {
            name: format!("{SCOPE}.{RESET}"),
            active: true,
        },
        ..exact.clone()
    };
    Ok(CrosssimOutcome {
        ports: bench.ports().len(),
        verilator: of_verilator,
        icarus: of_icarus,
        waves: diff::compare(&verilator, &icarus, &exact, &mut |_| {})?,
        unset: diff::compare(&verilator, &unset, &released, &mut |_| {})?,
        time: start.elapsed(),
    })
}

struct Bench<'a> {
    block: &'a dyn Block,
    clocks: u64,
    seed: u64,
}

impl Bench<'_> {
    fn ports(&self) -> Vec<Port> {
        self.block.model(self.seed).ports().to_vec()
    }

    fn verilated(&self, sources: &Sources, waves: &Path) -> Result<LockstepReport, Error> {
        let mut device = sources.verilated(self.block, self.seed)?;
        let mut recorder = Recorder::for_ports(waves, CLOCK_HZ, &[SCOPE], &self.ports(), &Heading::default())?;
        let mut written = Ok(());
        let report = self.lockstep(&mut device, &mut |clock| {
            if written.is_ok() {
                written = recorder.clock(&[clock.inputs, clock.actual]);
            }
        })?;
        written?;
        recorder.finish()?;
        Ok(report)
    }

    fn icarus(&self, sources: &Sources, waves: &Path) -> Result<LockstepReport, Error> {
        let mut device = sources.icarus_recording(self.block)?;
        let report = self.lockstep(&mut device, &mut |_| {})?;
        device.finish(waves)?;
        Ok(report)
    }

    fn lockstep(
        &self,
        device: &mut dyn lockstep::Device,
        watch: &mut dyn FnMut(&Clock<'_>),
    ) -> Result<LockstepReport, Error> {
        let mut model = self.block.model(self.seed);
        let instances = self.block.instances(model.ports());
        let mut stimuli = self.block.stimuli(self.clocks, self.seed);
        // Both waveforms must have the same length, even if much is wrong.
        let options = lockstep::LockstepOptions {
            mismatch_limit: u64::MAX,
            ..lockstep::LockstepOptions::cycles(self.clocks)
        };
        lockstep::run(
            model.as_mut(),
            device,
            stimuli.as_mut(),
            &instances,
            &options,
            watch,
            &mut |_| {},
        )
    }
}

/// The module without the values that its registers have at power-up. A memory keeps its contents, because those of a
/// ROM are fixed.
pub fn without_initial_values(module: &Module) -> Module {
    if module.has_memory() {
        return module.clone();
    }
    let mut text = String::with_capacity(module.text.len());
    let mut inside = false;
    for line in module.text.lines() {
        inside |= line == "    initial begin";
        if !inside {
            text.push_str(line);
            text.push('\n');
        }
        inside &= line != "    end";
    }
    Module { text, ..module.clone() }
}

/// Number of outputs of a block that are compared.
pub fn outputs(block: &dyn Block) -> usize {
    let model = block.model(0);
    let outputs = model.ports().iter().filter(|port| port.direction == Direction::Output);
    outputs.count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_initial_values_are_removed() {
        let modules = posicast_hdl::axis::emit("").unwrap();
        let before: usize = modules
            .iter()
            .map(|module| module.text.matches("initial").count())
            .sum();
        assert!(before > 0);
        for module in &modules {
            let without = without_initial_values(module);
            assert!(!without.text.contains("initial begin"), "{}", without.text);
            assert_eq!(
                without.text.matches(" <= ").count(),
                module.text.matches(" <= ").count(),
                "{}",
                module.name
            );
        }
    }
}
