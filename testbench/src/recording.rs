//! Records a real move as waveforms: of the model, of the RTL, and of the float design.
//!
//! ```text
//!  time       0       40 ns         1.1 µs                      100.04 µs
//!  clk        ‾\_/‾\_/‾\_/‾ … ‾\_/‾\_xxxxxxxxxxxxxxxxxxxxxxxxxxxx_/‾\_/‾\_ …     clock of 50 MHz, samples of 10 kHz
//!  recording  ‾‾‾‾‾‾‾‾‾‾‾‾ … ‾‾‾‾‾‾‾\__________________________/‾‾‾‾‾‾‾‾‾ …
//!  rst        ‾‾‾‾‾‾‾‾\_______________________________________________
//!  strobe     ________/‾‾‾\___________________________________/‾‾‾\____     sample n: n samples after the reset
//! ```
//!
//! All times are those of the machine: its clock, a strobe per sample period, and outputs that come as many clocks
//! later as a pass takes. Between two samples a shaper waits for thousands of clocks, which would fill a waveform
//! with nothing. These clocks are neither simulated nor recorded: after each strobe come the clocks of a pass and
//! some idle ones, and the file [says](crate::wave::Recorder::skip_to) where clocks are left out. A shaper's results
//! do not depend on how long it waited; a test compares with a recording of all clocks.

use std::path::Path;

use posicast_blocks::{Direction, Port};

use crate::Error;
use crate::lockstep::Device;
use crate::shaper::{AxisLayout, Layout, MotionStimuli};
use crate::stimuli::Stimuli;
use crate::wave::{Heading, Recorder, Signal};

/// Number of idle clocks after a pass, so that each sample's output is visible.
const IDLE_CLOCKS: u64 = 5;

/// A move of all axes of a machine.
#[derive(Debug, Clone)]
pub struct Move<'a> {
    /// Positions of the shapers' ports.
    pub layout: &'a Layout,
    /// Command words per axis, all of the same length.
    pub words: &'a [Vec<i64>],
    /// Largest number of clocks of a pass.
    pub pass_clocks: u32,
    /// The machine's clock in Hz, a multiple of the sample rate.
    pub clock_hz: f64,
    /// Sample rate in Hz.
    pub sample_hz: f64,
}

/// Result of a recorded move.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct RecordedMove {
    /// Shaped words per axis, one per clock with `valid`.
    pub shaped: Vec<Vec<i64>>,
    /// The clock of each of them, counted in recorded clocks.
    pub valid_clocks: Vec<Vec<u64>>,
    /// Number of recorded clocks.
    pub recorded_clocks: u64,
    /// Number of the machine's clocks from the start to the last recorded one.
    pub clocks: u64,
}

impl Move<'_> {
    /// Clocks per sample period.
    fn tick_clocks(&self) -> u64 {
        (self.clock_hz / self.sample_hz).round().max(1.0) as u64
    }

    /// Number of clocks that are recorded from each strobe on.
    fn recorded_clocks(&self) -> u64 {
        (u64::from(self.pass_clocks) + IDLE_CLOCKS).min(self.tick_clocks())
    }

    /// The machine's clock that is recorded as number `recorded`.
    fn machine_clock(&self, motion: &MotionStimuli<'_>, recorded: u64) -> u64 {
        match recorded.checked_sub(motion.first_strobe()) {
            None => recorded,
            Some(moving) => {
                let (sample, clock) = (moving / self.recorded_clocks(), moving % self.recorded_clocks());
                motion.first_strobe() + sample * self.tick_clocks() + clock
            }
        }
    }

    /// The comment of the file about its times.
    fn comment(&self, motion: &MotionStimuli<'_>) -> String {
        let (tick, recorded) = (self.tick_clocks(), self.recorded_clocks());
        let mut text = format!(
            "clk is the machine's clock of {} MHz, and all times are true: after {} clocks of reset there is a strobe every {tick} \
             clocks, at {} Hz.",
            self.clock_hz / 1e6,
            motion.first_strobe(),
            self.sample_hz
        );
        if recorded < tick {
            text += &format!(
                "\n    Of each sample the first {recorded} clocks are recorded. In the other {} the hardware waits for the next \
                 strobe and nothing changes:\n    they are left out, clk is x there and recording is 0.",
                tick - recorded
            );
        }
        text
    }

    /// Runs the move through a block and writes its ports as a VCD with the scope `scope`.
    ///
    /// # Errors
    /// [`Error::Step`] where a simulator stops, [`Error::File`] where the file cannot be written.
    pub fn record(&self, device: &mut dyn Device, path: &Path, scope: &str) -> Result<RecordedMove, Error> {
        let ports = device.ports().to_vec();
        let mut motion = MotionStimuli::new(self.layout, self.words, self.recorded_clocks());
        let heading = Heading {
            comment: &self.comment(&motion),
            gaps: true,
            ..Heading::default()
        };
        let mut recorder = Recorder::for_ports(path, self.clock_hz, &[scope], &ports, &heading)?;
        let outputs: Vec<&Port> = ports.iter().filter(|p| p.direction == Direction::Output).collect();
        let places = Places::new(&outputs, self.layout)?;
        let mut trace = RecordedMove {
            shaped: vec![Vec::new(); places.0.len()],
            valid_clocks: vec![Vec::new(); places.0.len()],
            recorded_clocks: motion.clocks(),
            clocks: self.machine_clock(&motion, motion.clocks().saturating_sub(1)) + 1,
        };
        let masks: Vec<u64> = ports
            .iter()
            .filter(|p| p.direction == Direction::Input)
            .map(mask)
            .collect();
        let mut inputs = vec![0; masks.len()];
        let (mut values, mut unknown) = (vec![0; outputs.len()], vec![0; outputs.len()]);
        for clock in 0..motion.clocks() {
            motion.fill(&values, &mut inputs);
            for (input, mask) in inputs.iter_mut().zip(&masks) {
                *input &= mask;
            }
            let failed = |source| Error::Step { clock, source };
            device.step(&inputs, &mut values, &mut unknown).map_err(failed)?;
            recorder.skip_to(self.machine_clock(&motion, clock))?;
            recorder.clock(&[&inputs, &values])?;
            for (axis, place) in places.0.iter().enumerate() {
                if values[place.valid] == 1 {
                    trace.shaped[axis].push(signed(values[place.y], place.width));
                    trace.valid_clocks[axis].push(clock);
                }
            }
        }
        recorder.finish()?;
        Ok(trace)
    }

    /// Writes the float design's outputs, in LSB, as real signals `<axis>_y` that change in the same clocks as the
    /// hardware's in `trace`.
    ///
    /// # Errors
    /// [`Error::File`] where the file cannot be written.
    pub fn record_float(
        &self,
        float: &[Vec<f64>],
        trace: &RecordedMove,
        path: &Path,
        scope: &str,
    ) -> Result<(), Error> {
        let names: Vec<String> = self.layout.axes.iter().map(output_of).collect();
        let signals: Vec<Signal> = names.iter().map(|name| Signal::real(name)).collect();
        let motion = MotionStimuli::new(self.layout, self.words, self.recorded_clocks());
        let heading = Heading {
            comment: &self.comment(&motion),
            gaps: true,
            ..Heading::default()
        };
        let mut recorder = Recorder::create_with(path, self.clock_hz, &[scope], &signals, &heading)?;
        // The hardware shows 0 after reset, its start position after the start, and then one sample per `valid`.
        let start_shows = motion.first_strobe() + 1;
        let mut next = vec![0usize; names.len()];
        let mut values = vec![0f64.to_bits(); names.len()];
        for clock in 0..motion.clocks() {
            for (axis, value) in values.iter_mut().enumerate() {
                if clock == start_shows {
                    let start = self.words.get(axis).and_then(|w| w.first()).copied().unwrap_or(0);
                    *value = (start as f64).to_bits();
                }
                if trace.valid_clocks[axis].get(next[axis]) == Some(&clock) {
                    *value = float[axis].get(next[axis]).copied().unwrap_or(f64::NAN).to_bits();
                    next[axis] += 1;
                }
            }
            recorder.skip_to(self.machine_clock(&motion, clock))?;
            recorder.clock(&[&values])?;
        }
        recorder.finish()
    }
}

struct Place {
    y: usize,
    valid: usize,
    width: u32,
}

/// Positions of each axis's `y` and `valid` among the outputs.
struct Places(Vec<Place>);

impl Places {
    fn new(outputs: &[&Port], layout: &Layout) -> Result<Self, Error> {
        let position = |name: &str| outputs.iter().position(|p| p.name == name);
        let find = |name: String| position(&name).ok_or_else(|| Error::Unlike(format!("there is no output `{name}`")));
        let places = layout.axes.iter().map(|axis| {
            let y = find(output_of(axis))?;
            Ok(Place {
                y,
                valid: find(port_of(&axis.name, "valid"))?,
                width: outputs[y].width,
            })
        });
        places.collect::<Result<_, Error>>().map(Self)
    }
}

/// Name of the output for the shaped position: `y`, or `y_0` of a motion shaper.
fn output_of(axis: &AxisLayout) -> String {
    let tables = axis.tables.as_ref();
    let is_for_motion = tables.is_some_and(|tables| tables.swap_how.is_some());
    port_of(&axis.name, if is_for_motion { "y_0" } else { "y" })
}

fn port_of(axis: &str, port: &str) -> String {
    if axis.is_empty() {
        port.to_owned()
    } else {
        format!("{axis}_{port}")
    }
}

fn mask(port: &Port) -> u64 {
    u64::MAX >> (64 - port.width.clamp(1, 64))
}

fn signed(raw: u64, width: u32) -> i64 {
    let unused = 64 - width.clamp(1, 64);
    ((raw << unused) as i64) >> unused
}
