//! An inline shaper with registers, a controller that steps its axes, and drives that only count edges: for hosts and programs that are
//! tested without hardware.

use posicast_blocks::Direction;
use posicast_blocks::component::Component;
use posicast_blocks::composition::Composed;
use posicast_testbench::Error;

use crate::linked_bench::Registered;

/// Number of the inputs of the bus after `rst`, in order: address, read, write, byte enables, data.
const BUS_INPUTS: usize = 5;
/// Clocks of a pulse of the controller, and of the pause after it at the least.
const PULSE_CLOCKS: u64 = 250;
/// Clocks between two steps of the controller, unless [`InlineBench::steps`] is told otherwise.
const INTERVAL_CLOCKS: u64 = 2_500;

/// An inline shaper with a controller.
pub struct InlineBench {
    model: Composed,
    inputs: Vec<u64>,
    outputs: Vec<u64>,
    input_names: Vec<String>,
    output_names: Vec<String>,
    /// Steps that an axis still gets, with their sign: place of its first input, its name, and steps.
    riding: Vec<(usize, i64)>,
    now: u64,
}

impl InlineBench {
    /// An inline shaper whose axes take step and direction: enabled, without an emergency stop, and with all other pins low.
    ///
    /// # Errors
    /// [`Error::Unlike`] if it lacks a pin that the bench drives.
    pub fn new(component: &Component, seed: u64) -> Result<Self, Error> {
        let ports = component.composition().ports();
        let names = |direction| {
            let ports = ports.iter().filter(move |port| port.direction == direction);
            ports.map(|port| port.name.clone()).collect::<Vec<_>>()
        };
        let (input_names, output_names) = (names(Direction::Input), names(Direction::Output));
        let mut bench = Self {
            model: component.model(seed),
            inputs: vec![0; input_names.len()],
            outputs: vec![0; output_names.len()],
            riding: Vec::new(),
            input_names,
            output_names,
            now: 0,
        };
        bench.set("enable", 1)?;
        bench.set("emergency_stop_n", 1)?;
        bench.set("avs_byteenable", 0xf)?;
        Ok(bench)
    }

    fn input(&self, name: &str) -> Result<usize, Error> {
        let found = self.input_names.iter().position(|input| input == name);
        found.ok_or_else(|| Error::Unlike(format!("the inline shaper has no input {name}")))
    }

    /// Sets an input pin from now on.
    ///
    /// # Errors
    /// [`Error::Unlike`] if there is no such pin.
    pub fn set(&mut self, name: &str, level: u64) -> Result<(), Error> {
        let place = self.input(name)?;
        self.inputs[place] = level;
        Ok(())
    }

    /// The level of an output pin; 0 if there is no such pin.
    pub fn pin(&self, name: &str) -> u64 {
        let found = self.output_names.iter().position(|output| output == name);
        found.map_or(0, |place| self.outputs[place])
    }

    /// Clocks since the reset.
    pub fn now(&self) -> u64 {
        self.now
    }

    /// The controller gives an axis so many steps, up or down, one per 2,500 clocks.
    ///
    /// # Errors
    /// [`Error::Unlike`] if the axis has no pins for step and direction.
    pub fn steps(&mut self, axis: &str, steps: i64) -> Result<(), Error> {
        let place = self.input(&format!("{axis}_step_in"))?;
        self.set(&format!("{axis}_direction_in"), u64::from(steps > 0))?;
        self.riding.retain(|(other, _)| *other != place);
        self.riding.push((place, steps.abs()));
        Ok(())
    }

    /// Whether the controller has given all its steps.
    pub fn rests(&self) -> bool {
        self.riding.iter().all(|(_, steps)| *steps == 0)
    }

    /// Simulates clocks with the inputs as they are.
    fn hold(&mut self, clocks: u64) -> Result<(), Error> {
        let mut left = clocks;
        while left > 0 {
            let passed = self.model.hold(&self.inputs, left, &mut self.outputs);
            left -= passed.map_err(|source| Error::Step {
                clock: self.now + clocks - left,
                source,
            })?;
        }
        self.now += clocks;
        Ok(())
    }

    /// The level of an input in the clock before; 0 if there is no such pin.
    pub fn input_level(&self, name: &str) -> u64 {
        self.input(name).map_or(0, |place| self.inputs[place])
    }

    /// One clock with these words on the bus: address, read, write, byte enables, data.
    ///
    /// # Errors
    /// [`Error::Step`] where the model stops.
    pub fn access(&mut self, words: [u64; BUS_INPUTS]) -> Result<(), Error> {
        self.inputs[1..=BUS_INPUTS].copy_from_slice(&words);
        self.clocks(1)?;
        self.inputs[1..=BUS_INPUTS].copy_from_slice(&[0, 0, 0, 0xf, 0]);
        Ok(())
    }
}

impl Registered for InlineBench {
    fn read_at(&mut self, address: u32) -> Result<u32, Error> {
        self.access([address.into(), 1, 0, 0xf, 0])?;
        self.clocks(1)?;
        Ok(self.pin("avs_readdata") as u32)
    }

    fn write_at(&mut self, address: u32, data: u32) -> Result<(), Error> {
        self.access([address.into(), 0, 1, 0xf, data.into()])
    }

    fn clocks(&mut self, clocks: u64) -> Result<(), Error> {
        let end = self.now + clocks;
        while self.now < end {
            let phase = self.now % INTERVAL_CLOCKS;
            for (place, steps) in &mut self.riding {
                if phase == 0 && *steps > 0 {
                    self.inputs[*place] = 1;
                    *steps -= 1;
                } else if phase >= PULSE_CLOCKS {
                    self.inputs[*place] = 0;
                }
            }
            let next = if phase < PULSE_CLOCKS {
                PULSE_CLOCKS
            } else {
                INTERVAL_CLOCKS
            };
            self.hold((next - phase).min(end - self.now))?;
        }
        Ok(())
    }
}
