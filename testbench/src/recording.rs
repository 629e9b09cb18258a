//! A real move recorded as waveforms: by the model, by the RTL, and by the float design beside them.
//!
//! Between two samples a shaper idles for thousands of clocks, which would fill a waveform with nothing. The recording
//! therefore runs on a clock just fast enough for a pass within a sample ([`wave_clocks_per_sample`]): what the shaper does
//! in its clocks does not depend on how long they last, and the samples keep their true times.

use std::path::Path;

use posicast_model::rtl::{Direction, Port};

use crate::Error;
use crate::lockstep::Device;
use crate::stimuli::{Axis, Layout, Motion, Stimuli};
use crate::wave::{Recorder, Signal};

/// Idle clocks after a pass, so that each sample's output is seen to stand.
const IDLE_CLOCKS: u64 = 5;

/// Clocks per sample of a recording, for passes of at most `pass_clocks`.
pub fn wave_clocks_per_sample(pass_clocks: u32) -> u64 {
    u64::from(pass_clocks) + IDLE_CLOCKS
}

/// A move of all axes of a machine.
#[derive(Debug, Clone)]
pub struct Move<'a> {
    /// Where the shapers' ports are.
    pub layout: &'a Layout,
    /// Command words per axis, all of one length.
    pub words: &'a [Vec<i64>],
    /// Clocks of the recording per sample.
    pub clocks_per_sample: u64,
    /// Sample rate in Hz.
    pub sample_hz: f64,
}

/// What came out of a recorded move.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Trace {
    /// Shaped words per axis, one per `valid`.
    pub shaped: Vec<Vec<i64>>,
    /// The clock of each of them.
    pub valid_clocks: Vec<Vec<u64>>,
}

impl Move<'_> {
    fn clock_hz(&self) -> f64 {
        self.sample_hz * self.clocks_per_sample as f64
    }

    /// Runs the move through a block and writes its ports as a VCD with the scope `scope`.
    ///
    /// # Errors
    /// [`Error::Step`] where a simulator stops, [`Error::File`] where the file cannot be written.
    pub fn record(&self, device: &mut dyn Device, path: &Path, scope: &str) -> Result<Trace, Error> {
        let ports = device.ports().to_vec();
        let mut recorder = Recorder::for_ports(path, self.clock_hz(), &[scope], &ports)?;
        let outputs: Vec<&Port> = ports.iter().filter(|p| p.direction == Direction::Output).collect();
        let places = Places::new(&outputs, self.layout)?;
        let mut motion = Motion::new(self.layout, self.words, self.clocks_per_sample);
        let mut trace = Trace {
            shaped: vec![Vec::new(); places.0.len()],
            valid_clocks: vec![Vec::new(); places.0.len()],
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

    /// Writes the float design's outputs, in LSB, as real signals `<axis>_y` that change in the very clocks in which the
    /// hardware's do (`trace`).
    ///
    /// # Errors
    /// [`Error::File`] where the file cannot be written.
    pub fn record_float(&self, float: &[Vec<f64>], trace: &Trace, path: &Path, scope: &str) -> Result<(), Error> {
        let names: Vec<String> = self.layout.axes.iter().map(output_of).collect();
        let signals: Vec<Signal> = names.iter().map(|name| Signal::real(name)).collect();
        let mut recorder = Recorder::create(path, self.clock_hz(), &[scope], &signals)?;
        let motion = Motion::new(self.layout, self.words, self.clocks_per_sample);
        // After reset the hardware shows 0, after the start its start position, then one sample per `valid`.
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

/// Where each axis's `y` and `valid` are among the outputs.
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

/// The output that shows the shaped position: `y`, or `y_0` of a shaper for motion.
fn output_of(axis: &Axis) -> String {
    port_of(&axis.name, if axis.swap_how.is_some() { "y_0" } else { "y" })
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
