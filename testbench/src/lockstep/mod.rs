//! Runs model and device under test side by side: same inputs, every output compared in every clock.
//!
//! ```text
//! for every clock:  inputs  := stimuli(what the model showed in the clock before)
//!                   expected := model.step(inputs);  actual, unknown := device.step(inputs)
//!                   for every output:  actual ≠ expected or unknown bits → mismatch
//! ```
//!
//! - A block is a named set of outputs ([`Instance`]): the report has one entry for each, axis by axis.
//! - Ports are matched by name; model and device must have the same ones, their order may differ.
//! - The run continues after a mismatch, so that the report shows how much is wrong, and ends early only after
//!   [`LockstepOptions::mismatch_limit`] wrong values.
//! - The first mismatch of each block keeps the clocks around it with all ports, ready to be printed
//!   ([`report::Mismatch`]).
//! - `time` counts clocks since the start of the run, which begins with a reset.

mod joined;
pub mod report;
mod window;

use posicast_blocks::composition::Composed;
use posicast_blocks::{ClockedBlock, Direction, Port, StepError};
use std::ops::ControlFlow;

pub use self::joined::SideBySide;
use self::report::{BlockReport, LockstepReport, Mismatch, outputs_of};
use self::window::Window;
use crate::Error;
use crate::stimuli::Stimuli;
use crate::verilator::Verilated;

/// Number of clocks between two calls of the progress function.
const PROGRESS_CLOCKS: u64 = 1 << 16;

/// A device that is compared with the model: like [`ClockedBlock`], but with outputs that may be `x` and `z`.
pub trait Device {
    /// The ports, as in [`ClockedBlock::ports`].
    fn ports(&self) -> &[Port];

    /// Simulates one clock, as [`ClockedBlock::step`] does; `unknown` gets, for every output, a one for each bit that
    /// is `x` or `z`.
    ///
    /// # Errors
    /// [`StepError`] where the simulator stops.
    fn step(&mut self, inputs: &[u64], outputs: &mut [u64], unknown: &mut [u64]) -> Result<(), StepError>;

    /// Simulates clocks with the same inputs up to the first one in which the outputs are not `expected`, or `clocks` of them. Returns how
    /// many were as expected, also where the simulator stops; `outputs` and `unknown` are those of the one that was not.
    fn hold(
        &mut self,
        inputs: &[u64],
        expected: &[u64],
        clocks: u64,
        outputs: &mut [u64],
        unknown: &mut [u64],
    ) -> (u64, Result<(), StepError>) {
        for equal in 0..clocks {
            if let Err(error) = self.step(inputs, outputs, unknown) {
                return (equal, Err(error));
            }
            if outputs != expected || unknown.iter().any(|bits| *bits != 0) {
                return (equal, Ok(()));
            }
        }
        (clocks, Ok(()))
    }
}

/// A device with only zeros and ones, such as RustHDL's simulator or another model.
pub struct TwoValued(pub Box<dyn ClockedBlock>);

impl Device for TwoValued {
    fn ports(&self) -> &[Port] {
        self.0.ports()
    }

    fn step(&mut self, inputs: &[u64], outputs: &mut [u64], unknown: &mut [u64]) -> Result<(), StepError> {
        unknown.fill(0);
        self.0.step(inputs, outputs)
    }
}

impl Device for Verilated {
    fn ports(&self) -> &[Port] {
        ClockedBlock::ports(self)
    }

    fn step(&mut self, inputs: &[u64], outputs: &mut [u64], unknown: &mut [u64]) -> Result<(), StepError> {
        unknown.fill(0);
        ClockedBlock::step(self, inputs, outputs)
    }

    fn hold(
        &mut self,
        inputs: &[u64],
        expected: &[u64],
        clocks: u64,
        outputs: &mut [u64],
        unknown: &mut [u64],
    ) -> (u64, Result<(), StepError>) {
        unknown.fill(0);
        Verilated::hold(self, inputs, expected, clocks, outputs)
    }
}

/// The outputs of one entry of the report.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Instance {
    /// Name of the block, such as `shaper`.
    pub block: String,
    /// Name that distinguishes it from others of its kind: the axis, or a size.
    pub name: String,
    /// Names of its outputs.
    pub outputs: Vec<String>,
}

impl Instance {
    /// The instance with all outputs of a block that stands alone.
    pub fn whole(block: &str, name: &str, ports: &[Port]) -> Self {
        Self {
            block: block.to_owned(),
            name: name.to_owned(),
            outputs: outputs_of(ports).map(|p| p.name.clone()).collect(),
        }
    }
}

/// Length of a run, and how much it keeps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LockstepOptions {
    /// Number of clocks to compare.
    pub cycles: u64,
    /// Number of clocks to keep before and after the first mismatch.
    pub window_clocks: usize,
    /// The run ends early after this many wrong values, over all blocks.
    pub mismatch_limit: u64,
}

impl LockstepOptions {
    /// This many clocks, with a window of 6 clocks on each side and at most a million wrong values.
    pub fn cycles(cycles: u64) -> Self {
        Self {
            cycles,
            window_clocks: 6,
            mismatch_limit: 1_000_000,
        }
    }
}

/// Values of one clock, for coverage and waveforms.
#[derive(Clone, Copy)]
pub struct Clock<'a> {
    /// Number of clocks since the start of the run.
    pub time: u64,
    /// The inputs, in the order of the model's input ports.
    pub inputs: &'a [u64],
    /// The model's outputs, in the order of its output ports.
    pub expected: &'a [u64],
    /// The device's outputs, in the same order.
    pub actual: &'a [u64],
    /// The nets inside the model, if it is a composition.
    pub inside: Option<&'a Composed>,
}

/// Runs model and device, and compares them.
///
/// `watch` gets every clock; `progress` is called with the number of clocks done every 65,536 clocks and at the end.
///
/// # Errors
/// [`Error::Unlike`] if the ports differ or an instance names no output; [`Error::Step`] where a simulator stops.
pub fn run(
    model: &mut dyn ClockedBlock,
    device: &mut dyn Device,
    stimuli: &mut dyn Stimuli,
    instances: &[Instance],
    options: &LockstepOptions,
    watch: &mut dyn FnMut(&Clock<'_>),
    progress: &mut dyn FnMut(u64),
) -> Result<LockstepReport, Error> {
    let mut to_the_end = |clock: &Clock<'_>| {
        watch(clock);
        ControlFlow::Continue(())
    };
    run_until(model, device, stimuli, instances, options, &mut to_the_end, progress)
}

/// Runs them as [`run`] does, up to the clock at which `watch` breaks, which is included.
///
/// # Errors
/// Those of [`run`].
pub fn run_until(
    model: &mut dyn ClockedBlock,
    device: &mut dyn Device,
    stimuli: &mut dyn Stimuli,
    instances: &[Instance],
    options: &LockstepOptions,
    watch: &mut dyn FnMut(&Clock<'_>) -> ControlFlow<()>,
    progress: &mut dyn FnMut(u64),
) -> Result<LockstepReport, Error> {
    let mut both = Lockstep::new(model.ports(), device.ports(), instances, options)?;
    let mut inputs = vec![0; both.wiring.inputs.len()];
    while both.time < options.cycles && both.comparison.wrong_values < options.mismatch_limit {
        stimuli.fill(&both.expected, &mut inputs);
        both.clock(model, device, &mut inputs)?;
        let goes_on = watch(&Clock {
            time: both.time - 1,
            inputs: &inputs,
            expected: &both.expected,
            actual: &both.actual,
            inside: model.composed(),
        });
        if goes_on.is_break() {
            break;
        }
        if both.time.is_multiple_of(PROGRESS_CLOCKS) {
            progress(both.time);
        }
    }
    progress(both.time);
    Ok(both.report())
}

/// A lock step, clock by clock: for who makes inputs of more than stimuli, as a bench with a simulated machine does.
pub struct Lockstep {
    wiring: Wiring,
    comparison: Comparison,
    time: u64,
    expected: Vec<u64>,
    actual: Vec<u64>,
    unknown: Vec<u64>,
    /// Values of the device's ports, in the device's own order.
    device_inputs: Vec<u64>,
    device_expected: Vec<u64>,
    device_outputs: Vec<u64>,
    device_unknown: Vec<u64>,
}

impl Lockstep {
    /// Prepares the comparison of a model and a device with these ports.
    ///
    /// # Errors
    /// [`Error::Unlike`] if the ports differ or an instance names no output.
    pub fn new(
        model: &[Port],
        device: &[Port],
        instances: &[Instance],
        options: &LockstepOptions,
    ) -> Result<Self, Error> {
        let wiring = Wiring::new(model, device)?;
        let outputs = vec![0; wiring.outputs.len()];
        Ok(Self {
            comparison: Comparison::new(model, instances, options)?,
            time: 0,
            expected: outputs.clone(),
            actual: outputs.clone(),
            unknown: outputs.clone(),
            device_inputs: vec![0; wiring.inputs.len()],
            device_expected: outputs.clone(),
            device_outputs: outputs.clone(),
            device_unknown: outputs,
            wiring,
        })
    }

    /// One clock of both. Of `inputs`, in the order of the model, bits beyond a port's width are cleared.
    ///
    /// # Errors
    /// [`Error::Step`] where a simulator stops.
    pub fn clock(
        &mut self,
        model: &mut dyn ClockedBlock,
        device: &mut dyn Device,
        inputs: &mut [u64],
    ) -> Result<(), Error> {
        let time = self.time;
        let failed = |source| Error::Step { clock: time, source };
        self.take(inputs);
        model.step(inputs, &mut self.expected).map_err(failed)?;
        device
            .step(&self.device_inputs, &mut self.device_outputs, &mut self.device_unknown)
            .map_err(failed)?;
        self.compare(inputs);
        Ok(())
    }

    /// Clocks of both with the same inputs, at most `clocks`, for as long as the outputs of the model stay as they are; returns how many.
    /// Every output is compared in each of them. The model must have no output that counts. Of `inputs`, as for [`clock`](Self::clock).
    ///
    /// # Errors
    /// [`Error::Step`] where a simulator stops.
    pub fn hold(
        &mut self,
        model: &mut Composed,
        device: &mut dyn Device,
        inputs: &mut [u64],
        clocks: u64,
    ) -> Result<u64, Error> {
        let failed = |clock| move |source| Error::Step { clock, source };
        self.take(inputs);
        let passed = model
            .hold(inputs, clocks, &mut self.expected)
            .map_err(failed(self.time))?;
        for (port, expected) in self.wiring.outputs.iter().zip(&self.expected) {
            self.device_expected[port.device] = *expected;
        }
        let end = self.time + passed;
        while self.time < end {
            let (equal, result) = device.hold(
                &self.device_inputs,
                &self.device_expected,
                end - self.time,
                &mut self.device_outputs,
                &mut self.device_unknown,
            );
            self.comparison.equal(self.time, equal, inputs, &self.expected);
            self.time += equal;
            result.map_err(failed(self.time))?;
            if self.time < end {
                self.compare(inputs);
            }
        }
        Ok(passed)
    }

    /// Clears bits beyond a port's width, and sets the device's inputs.
    fn take(&mut self, inputs: &mut [u64]) {
        for (input, port) in inputs.iter_mut().zip(&self.wiring.inputs) {
            *input &= port.mask;
            self.device_inputs[port.device] = *input;
        }
    }

    /// Compares the clock that both have simulated.
    fn compare(&mut self, inputs: &[u64]) {
        for (at, port) in self.wiring.outputs.iter().enumerate() {
            self.actual[at] = self.device_outputs[port.device];
            self.unknown[at] = self.device_unknown[port.device];
        }
        self.comparison
            .clock(self.time, inputs, &self.expected, &self.actual, &self.unknown);
        self.time += 1;
    }

    /// Outputs of the model in the last clock.
    pub fn expected(&self) -> &[u64] {
        &self.expected
    }

    /// Reports the comparison so far.
    pub fn report(&self) -> LockstepReport {
        self.comparison.report(self.time)
    }
}

/// Position of a model's port in the device, and its bits.
struct Wire {
    device: usize,
    mask: u64,
}

/// The model's ports in the device.
struct Wiring {
    inputs: Vec<Wire>,
    outputs: Vec<Wire>,
}

impl Wiring {
    fn new(model: &[Port], device: &[Port]) -> Result<Self, Error> {
        let wires = |direction| {
            let theirs: Vec<&Port> = device.iter().filter(|p| p.direction == direction).collect();
            let ours = model.iter().filter(|p| p.direction == direction);
            let wires = ours.map(|port| {
                let found = theirs.iter().position(|p| p.name == port.name && p.width == port.width);
                let missing = || Error::Unlike(format!("the device has no {} `{}`", words(port), port.name));
                Ok(Wire {
                    device: found.ok_or_else(missing)?,
                    mask: u64::MAX >> (64 - port.width.clamp(1, 64)),
                })
            });
            wires.collect::<Result<Vec<_>, Error>>()
        };
        if let Some(extra) = device.iter().find(|p| model.iter().all(|m| m.name != p.name)) {
            return Err(Error::Unlike(format!(
                "the model has no {} `{}`",
                words(extra),
                extra.name
            )));
        }
        Ok(Self {
            inputs: wires(Direction::Input)?,
            outputs: wires(Direction::Output)?,
        })
    }
}

fn words(port: &Port) -> String {
    let direction = match port.direction {
        Direction::Input => "input",
        Direction::Output => "output",
    };
    format!("{}-bit {direction}", port.width)
}

/// An instance while it is compared.
struct Watched {
    instance: Instance,
    outputs: Vec<usize>,
    valid: Option<usize>,
    samples: u64,
    mismatches: u64,
    first: Option<Window>,
}

struct Comparison {
    ports: Vec<Port>,
    watched: Vec<Watched>,
    recent: Window,
    wrong_values: u64,
}

impl Comparison {
    fn new(ports: &[Port], instances: &[Instance], options: &LockstepOptions) -> Result<Self, Error> {
        let outputs: Vec<&Port> = outputs_of(ports).collect();
        let find = |name: &String| {
            let at = outputs.iter().position(|p| p.name == *name);
            at.ok_or_else(|| Error::Unlike(format!("there is no output `{name}`")))
        };
        let watched = instances.iter().map(|instance| {
            let at = instance.outputs.iter().map(find).collect::<Result<Vec<_>, Error>>()?;
            let is_valid = |at: &&usize| outputs[**at].name == "valid" || outputs[**at].name.ends_with("_valid");
            Ok(Watched {
                valid: at.iter().find(is_valid).copied(),
                outputs: at,
                instance: instance.clone(),
                samples: 0,
                mismatches: 0,
                first: None,
            })
        });
        Ok(Self {
            watched: watched.collect::<Result<Vec<_>, Error>>()?,
            recent: Window::new(ports, options.window_clocks),
            ports: ports.to_vec(),
            wrong_values: 0,
        })
    }

    fn clock(&mut self, time: u64, inputs: &[u64], expected: &[u64], actual: &[u64], unknown: &[u64]) {
        self.recent.push(time, inputs, expected, actual, unknown);
        for watched in &mut self.watched {
            watched.samples += u64::from(watched.valid.is_some_and(|at| expected[at] == 1));
            if let Some(first) = &mut watched.first {
                first.extend(time, inputs, expected, actual, unknown);
            }
            let wrong = |at: &&usize| expected[**at] != actual[**at] || unknown[**at] != 0;
            let mismatches = watched.outputs.iter().filter(wrong).count() as u64;
            if mismatches == 0 {
                continue;
            }
            watched.mismatches += mismatches;
            self.wrong_values += mismatches;
            if watched.first.is_none() {
                let output = watched.outputs.iter().find(wrong).copied();
                watched.first = Some(self.recent.opened_at(time, output.unwrap_or(0)));
            }
        }
    }

    /// This many clocks in which the device showed what the model did.
    fn equal(&mut self, time: u64, clocks: u64, inputs: &[u64], expected: &[u64]) {
        let none = vec![0; expected.len()];
        let (kept, end) = (self.recent.clocks(), time + clocks);
        for watched in &mut self.watched {
            watched.samples += clocks * u64::from(watched.valid.is_some_and(|at| expected[at] == 1));
            if let Some(first) = &mut watched.first {
                (time..end.min(time + kept)).for_each(|time| first.extend(time, inputs, expected, expected, &none));
            }
        }
        let latest = time.max(end.saturating_sub(kept))..end;
        latest.for_each(|time| self.recent.push(time, inputs, expected, expected, &none));
    }

    fn report(&self, cycles: u64) -> LockstepReport {
        let blocks = self.watched.iter().map(|watched| BlockReport {
            name: watched.instance.block.clone(),
            first: (watched.first.as_ref()).map(|window| Mismatch::new(&self.ports, &watched.instance.outputs, window)),
            instance: watched.instance.name.clone(),
            cycles,
            samples: watched.valid.map(|_| watched.samples),
            mismatches: watched.mismatches,
            not_exercised: Vec::new(),
            unchanged: Vec::new(),
            reached: Vec::new(),
            findings: Vec::new(),
        });
        LockstepReport::new(cycles, blocks.collect())
    }
}
