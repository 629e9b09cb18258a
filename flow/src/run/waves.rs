//! The shapers' lock step, and the waveforms of the move: model, RTL and float design.

use super::excerpt::{self, Excerpt};
use crate::bench::{self, Bench, Simulator};
use crate::failure::Failure;
use crate::observer::Observer;
use posicast_blocks::shaper::wrap;
use posicast_hdl::machine::AxisShaper;
use posicast_machine::machine_file::Machine;
use posicast_machine::plan::MachineDesign;
use posicast_machine::simulation::{AxisSimulation, largest_difference};
use posicast_synth::package::Package;
use posicast_testbench::blocks::{Block, Sources};
use posicast_testbench::lockstep::TwoValued;
use posicast_testbench::lockstep::report::LockstepReport;
use posicast_testbench::recording::Move;
use posicast_testbench::shaper::MachineShapers;
use posicast_testbench::wave::merge;
use wavecmp::diff::{self, Comparison, DiffOptions};
use wavecmp::merge::{DifferenceSignal, MergePart};

/// The waveforms of the move with the result of their comparison.
pub(super) struct Waves {
    /// Number of output samples of each axis.
    pub(super) samples: Vec<usize>,
    /// Number of the machine's clocks that the move lasts; the idle clocks between two samples are not recorded.
    pub(super) clocks: u64,
    /// Comparison of RTL and model, which must be equal.
    pub(super) model: Comparison,
    /// Comparison of RTL and float design, within the bound.
    pub(super) float: Comparison,
    /// Largest difference between RTL and float design per axis, in LSB.
    pub(super) largest_difference_lsb: Vec<f64>,
    /// Name of the simulated device.
    pub(super) device: &'static str,
    /// Its shaped words per axis; those of a modulo axis with the whole turns of the model's.
    pub(super) unwrapped: Vec<Vec<i64>>,
    /// The sample in which the first axis makes its largest step.
    pub(super) excerpt: Option<Excerpt>,
}

/// A machine's shapers compared with their model, with random stimuli and during the move.
pub(super) struct Job<'a> {
    pub(super) machine: &'a Machine,
    pub(super) top: &'a MachineShapers,
    pub(super) sources: &'a Sources,
    pub(super) simulator: Simulator,
    pub(super) seed: u64,
    pub(super) observer: &'a dyn Observer,
}

impl Job<'_> {
    /// Compares them with random stimuli, clock by clock.
    pub(super) fn lockstep(&self, cycles: Option<u64>) -> Result<LockstepReport, Failure> {
        let bench = Bench {
            block: self.top,
            sources: self.sources,
            cycles,
        };
        bench::compare_all(&[bench], self.simulator, self.seed, self.observer)
    }

    /// Simulates the move, whose waveforms go into the package.
    pub(super) fn waves(
        &self,
        package: &mut Package,
        design: &MachineDesign,
        axes: &[AxisSimulation],
    ) -> Result<Waves, Failure> {
        let command = Move {
            layout: self.top.layout(),
            words: self.top.words(),
            pass_clocks: self.top.pass_clocks(),
            clock_hz: self.machine.clock.frequency_hz,
            sample_hz: design.sample_hz,
        };
        let mut stage = |name: &str| {
            package
                .stage_evidence(&format!("wave/{name}"))
                .map_err(Failure::because)
        };
        let (model_vcd, rtl_vcd, float_vcd) = (stage("model.vcd")?, stage("rtl.vcd")?, stage("float.vcd")?);
        let merged = stage("merged.vcd")?;
        for view in ["merged.gtkw", "merged.sucl"] {
            stage(view)?;
        }
        let _shown = self.observer.begin("waveforms", None);
        let scope = self.machine.name.as_str();
        let mut model = TwoValued(self.top.model(self.seed));
        command.record(&mut model, &model_vcd, scope).map_err(bench::failure)?;
        let device = self.simulator.device(self.top, self.sources, self.seed);
        let mut device = device.map_err(bench::failure)?;
        let trace = command
            .record(device.as_mut(), &rtl_vcd, scope)
            .map_err(bench::failure)?;
        let excerpt = match self.top.words().first() {
            Some(words) => excerpt::read(&rtl_vcd, excerpt::largest_step(words))?,
            None => None,
        };
        let word_bits = self.machine.fixed_point.command_bits;
        let float: Vec<Vec<f64>> = axes.iter().map(|axis| axis.float_words(word_bits)).collect();
        command
            .record_float(&float, &trace, &float_vcd, scope)
            .map_err(bench::failure)?;

        let exact = DiffOptions {
            require_all: true,
            ..DiffOptions::default()
        };
        let mut within = DiffOptions::default();
        let mut differences = Vec::new();
        let names: Vec<String> = self.top.shapers().iter().map(AxisShaper::output).collect();
        for (name, axis) in names.iter().zip(axes) {
            within
                .add_tolerance(&format!("{name}={}", axis.bound_lsb))
                .map_err(Failure::because)?;
            differences.push(DifferenceSignal {
                name,
                minuend: (1, name),
                subtrahend: (2, name),
            });
        }
        let compare = |a, b, options: &DiffOptions| diff::compare(a, b, options, &mut |_| {}).map_err(Failure::because);
        let waves = Waves {
            samples: trace.shaped.iter().map(Vec::len).collect(),
            clocks: trace.clocks,
            model: compare(&model_vcd, &rtl_vcd, &exact)?,
            float: compare(&rtl_vcd, &float_vcd, &within)?,
            largest_difference_lsb: trace
                .shaped
                .iter()
                .zip(&float)
                .map(|(shaped, float)| largest_difference(shaped, float))
                .collect(),
            device: match self.simulator {
                Simulator::Rusthdl => "RustHDL description",
                Simulator::Verilator | Simulator::Icarus => "RTL",
            },
            unwrapped: trace
                .shaped
                .iter()
                .zip(axes)
                .map(|(words, axis)| unwrapped(words, axis, word_bits))
                .collect(),
            excerpt,
        };
        let parts = [("model", &model_vcd), ("rtl", &rtl_vcd), ("float", &float_vcd)];
        let parts = parts.map(|(scope, path)| MergePart { scope, path });
        merge(&merged, &parts, &differences).map_err(bench::failure)?;
        Ok(waves)
    }
}

/// Returns the words of the hardware with as many whole turns as those of the model.
fn unwrapped(words: &[i64], axis: &AxisSimulation, word_bits: u32) -> Vec<i64> {
    let pairs = words.iter().zip(&axis.shaped);
    pairs
        .map(|(word, model)| model + wrap(word - model, word_bits))
        .collect()
}
