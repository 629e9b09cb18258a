//! Measures what an inline shaper does between a controller and its machine, in a move of all axes by step pulses.
//!
//! ```text
//!  controller ─┬─► step lines ─► inline shaper (model, Verilog beside it) ─► step lines ─► machine: shaped
//!              └─────────────────────────────────────────────────────────────────────────► machine: unshaped
//! ```
//!
//! The controller is an ideal one: its positions are planned with the limits of the machine file, without one of the jerk, as those of
//! most controllers for steps, and each step comes in the clock in which the position passes the middle between two steps. The machine
//! reads its lines as a drive does.

mod controller;

use posicast_blocks::segments::Entry;
use posicast_blocks::step_generator::StepLinesActiveLow;
use posicast_blocks::{ClockedBlock, Direction, Port};
use posicast_machine::hardware::InlineHardware;
use posicast_machine::machine_file::{AxisSection, InputSection, Machine, StepsSection};
use posicast_machine::motion::AxisMove;
use posicast_machine::plan::MachineDesign;
use posicast_machine::plant::axis::{AxisPlant, DrivePins, PlantOptions};
use posicast_taps::TapTable;
use posicast_testbench::Error;
use posicast_testbench::blocks::{Block, check_with};
use posicast_testbench::lockstep::Device;

use self::controller::Edge;
use crate::stage_bench::AxisSample;
use crate::stage_run::{
    AxisFigures, COMPARED_CLOCKS, Compared, Expected, STANDSTILL_TICKS, Shaping, StageRunError, WORD_FRACTION,
    commands, figures_of_move, plan_axis, ringing_of_move, settle_ticks, stepped_move,
};

/// Ticks before the move, in which the axes begin to follow.
const START_TICKS: u64 = 20;

/// An inline shaper between a controller and the machine for which it was made.
#[derive(Debug)]
pub struct InlineRun<'a> {
    machine: &'a Machine,
    hardware: &'a InlineHardware,
    tables: Vec<&'a TapTable>,
    /// The plan of each axis: its entries, and where it ends.
    plans: Vec<(Vec<Entry>, i32)>,
    /// Ticks of the longest plan, of the longest shaper, and until the machine has come to rest after both.
    move_ticks: u64,
    shaper_ticks: u64,
    settle_ticks: u64,
    /// The controller's lines by axis.
    edges: Vec<Vec<Edge>>,
    seed: u64,
}

/// Result of the move.
#[derive(Debug, Clone, PartialEq)]
pub struct InlineMoved {
    /// The axes, in the order of the file.
    pub axes: Vec<InlineAxisMoved>,
    /// Whether all axes were settled at the end.
    pub settled: bool,
    /// Whether they had stopped with a fault.
    pub fault: bool,
}

/// Result of the move of an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct InlineAxisMoved {
    /// Steps of the controller, up less down.
    pub sent_steps: i64,
    /// Steps that the drive has read from the inline shaper.
    pub given_steps: i64,
    /// Steps that the motor behind the inline shaper lost; 0 without `[axis.stepper]`.
    pub lost_steps: i64,
    /// Samples at every tick with the machine on the inline shaper.
    pub shaped: Vec<AxisSample>,
    /// Samples at every tick with the machine on the controller's own lines.
    pub unshaped: Vec<AxisSample>,
}

impl InlineAxisMoved {
    /// Figures with the inline shaper, or without it, for this many steps per unit.
    pub fn figures(&self, shaping: Shaping, counts_per_unit: f64) -> AxisFigures {
        figures_of_move(self.samples(shaping), counts_per_unit)
    }

    /// Vibration of the load about its place of rest in m or rad, at each tick from the end of its motor's command on.
    pub fn ringing(&self, shaping: Shaping) -> Vec<f64> {
        ringing_of_move(self.samples(shaping)).0
    }

    fn samples(&self, shaping: Shaping) -> &[AxisSample] {
        match shaping {
            Shaping::Shaped => &self.shaped,
            Shaping::Unshaped => &self.unshaped,
        }
    }
}

impl<'a> InlineRun<'a> {
    /// A run of `hardware`, which was made of this machine and design. `seed` determines the arbitrary contents of memories.
    ///
    /// # Errors
    /// [`StageRunError::Plan`] for a move that cannot be planned.
    pub fn new(
        machine: &'a Machine,
        design: &'a MachineDesign,
        hardware: &'a InlineHardware,
        moves: &[AxisMove],
        seed: u64,
    ) -> Result<Self, StageRunError> {
        let plans = machine.axes.iter().zip(moves);
        let plans: Vec<_> = plans
            .map(|(axis, of)| plan_axis(machine, axis, of, true, 0))
            .collect::<Result<_, _>>()?;
        let ticks = |(entries, _): &(Vec<Entry>, i32)| entries.iter().map(|entry| u64::from(entry.ticks)).sum();
        let tick_clocks = machine.clock.clocks_per_sample().into();
        let inputs = machine.axes.iter().zip(&plans);
        let edges = inputs.map(|(axis, plan)| {
            let positions = commands(plan, 0).into_iter();
            let positions: Vec<f64> = positions
                .map(|[word, ..]| word / f64::from(1_u32 << WORD_FRACTION))
                .collect();
            axis.input.as_ref().map_or_else(Vec::new, |input| {
                let pulse_clocks = (input.pulse_s * machine.clock.frequency_hz).ceil() as u64;
                controller::edges(&positions, tick_clocks, input.kind, pulse_clocks)
            })
        });
        let tables: Vec<&TapTable> = design.axes.iter().map(|axis| &axis.table).collect();
        let shaper_ticks = tables.iter().map(|table| table.longest_delay_samples()).max();
        let shaper_ticks = shaper_ticks.unwrap_or(0).into();
        Ok(Self {
            machine,
            hardware,
            tables,
            move_ticks: plans.iter().map(ticks).max().unwrap_or(0),
            shaper_ticks,
            settle_ticks: settle_ticks(machine, shaper_ticks),
            edges: edges.collect(),
            plans,
            seed,
        })
    }

    /// Expected figures of the move, by axis, from the machine file alone.
    ///
    /// # Errors
    /// [`StageRunError::Plant`] for a machine that cannot be simulated, and [`StageRunError::Design`].
    pub fn expected(&self, shaping: Shaping) -> Result<Vec<Expected>, StageRunError> {
        let axes = self.machine.axes.iter().zip(&self.plans).zip(&self.tables);
        axes.map(|((axis, plan), table)| {
            let bypass = TapTable::bypass(table.coefficient_fraction());
            let bypass = bypass.map_err(|error| StageRunError::Design(Box::new(error)))?;
            let table = match shaping {
                Shaping::Shaped => table,
                Shaping::Unshaped => &bypass,
            };
            stepped_move(
                axis,
                self.machine.clock.sample_hz,
                &commands(plan, self.settle_ticks),
                table,
                1.0,
            )
        })
        .collect()
    }

    /// Makes the move with `device` beside the model of `block`: every output is compared in every clock, to standstill or for as long as
    /// takes about half a minute. `progress` gets the clocks.
    ///
    /// # Errors
    /// [`StageRunError::Bench`] for a device that fails, or has other ports.
    pub fn side_by_side(
        &self,
        block: &dyn Block,
        device: &mut dyn Device,
        progress: &mut dyn FnMut(u64),
    ) -> Result<Compared, StageRunError> {
        let ports = block.model(self.seed);
        let mut pins = Pins::new(self, ports.ports())?;
        let mut clock = 0;
        let mut stimuli = |_: &[u64], inputs: &mut [u64]| {
            pins.at(clock);
            inputs.copy_from_slice(&pins.inputs);
            clock += 1;
        };
        let clocks = self.compared_clocks();
        let report = check_with(block, device, &mut stimuli, (clocks, self.seed), progress)?;
        let first = report.blocks.iter().find_map(|block| block.first.clone());
        Ok(Compared {
            clocks: report.cycles,
            whole: clocks == self.whole_clocks(),
            mismatches: report.mismatches(),
            first,
            trouble: None,
        })
    }

    /// Number of clocks that [`side_by_side`](Self::side_by_side) compares.
    pub fn compared_clocks(&self) -> u64 {
        self.whole_clocks().min(COMPARED_CLOCKS)
    }

    fn whole_clocks(&self) -> u64 {
        let ticks = START_TICKS + self.move_ticks + self.shaper_ticks + STANDSTILL_TICKS;
        ticks * u64::from(self.machine.clock.clocks_per_sample())
    }

    /// Makes the move in the model, until the machine has come to rest.
    ///
    /// # Errors
    /// [`StageRunError::Plant`] for a machine that cannot be simulated; [`StageRunError::Bench`] where the model stops.
    pub fn moved(&self) -> Result<InlineMoved, StageRunError> {
        let mut model = match &self.hardware.component {
            Some(component) => component.model(self.seed),
            None => self.hardware.shaper.model(self.seed),
        };
        let mut pins = Pins::new(self, model.ports())?;
        let mut outputs = vec![0; pins.outputs.len()];
        let mut tracks = self
            .machine
            .axes
            .iter()
            .map(|axis| Track::new(self.machine, axis, &pins));
        let mut tracks: Vec<Track> = tracks.by_ref().collect::<Result<_, _>>()?;
        let tick_clocks = u64::from(self.machine.clock.clocks_per_sample());
        let mut now = 0;
        for tick in 1..=START_TICKS + self.move_ticks + self.settle_ticks {
            while now < tick * tick_clocks {
                let end = pins.at(now).unwrap_or(u64::MAX).min(tick * tick_clocks);
                let passed = model.hold(&pins.inputs, end - now, &mut outputs);
                let passed = passed.map_err(|source| Error::Step { clock: now, source })?;
                for track in &mut tracks {
                    track.pass(&pins.inputs, &outputs, passed);
                }
                now += passed;
            }
            tracks.iter_mut().for_each(Track::sample);
        }
        let output = |name: &str| pins.outputs.iter().position(|output| output == name);
        let level = |name: &str| output(name).is_some_and(|place| outputs[place] & 1 != 0);
        Ok(InlineMoved {
            settled: level("settled"),
            fault: level("fault"),
            axes: tracks.into_iter().map(Track::moved).collect(),
        })
    }
}

/// The pins of an inline shaper, with the controller at its inputs.
struct Pins {
    inputs: Vec<u64>,
    input_names: Vec<String>,
    outputs: Vec<String>,
    /// What is still to change: clock, place of the input, level; the next one last.
    coming: Vec<(u64, usize, u64)>,
}

impl Pins {
    /// All axes are enabled, and their lines off.
    fn new(run: &InlineRun<'_>, ports: &[Port]) -> Result<Self, Error> {
        let names = |direction| {
            let ports = ports.iter().filter(move |port| port.direction == direction);
            ports.map(|port| port.name.clone()).collect::<Vec<_>>()
        };
        let input_names = names(Direction::Input);
        let mut pins = Self {
            inputs: vec![0; input_names.len()],
            input_names,
            outputs: names(Direction::Output),
            coming: Vec::new(),
        };
        for name in ["enable", "emergency_stop_n"] {
            let place = pins.input(name)?;
            pins.inputs[place] = 1;
        }
        let start = START_TICKS * u64::from(run.machine.clock.clocks_per_sample());
        for (axis, edges) in run.machine.axes.iter().zip(&run.edges) {
            let Some(input) = &axis.input else {
                continue;
            };
            let places = pins.lines_in(axis, input)?;
            let low = [input.active_low.a, input.active_low.b];
            for (place, low) in places.into_iter().zip(low) {
                pins.inputs[place] = low.into();
            }
            pins.coming.extend(edges.iter().map(|edge| {
                let level = edge.on != low[edge.line];
                (start + edge.clock, places[edge.line], level.into())
            }));
        }
        pins.coming.sort_by_key(|(clock, ..)| std::cmp::Reverse(*clock));
        Ok(pins)
    }

    fn input(&self, name: &str) -> Result<usize, Error> {
        let found = self.input_names.iter().position(|input| input == name);
        found.ok_or_else(|| Error::Unlike(format!("the inline shaper has no input {name}")))
    }

    fn lines_in(&self, axis: &AxisSection, input: &InputSection) -> Result<[usize; 2], Error> {
        let [a, b] = input.kind.line_names();
        let place = |line: &str| self.input(&format!("{}_{line}_in", axis.name));
        Ok([place(a)?, place(b)?])
    }

    fn lines_out(&self, axis: &AxisSection, steps: &StepsSection) -> Result<[usize; 2], Error> {
        let [a, b] = steps.mode.line_names();
        let place = |line: &str| {
            let name = format!("{}_{line}", axis.name);
            let found = self.outputs.iter().position(|output| *output == name);
            found.ok_or_else(|| Error::Unlike(format!("the inline shaper has no output {name}")))
        };
        Ok([place(a)?, place(b)?])
    }

    /// Sets the inputs of this clock; returns the clock of the next change.
    fn at(&mut self, clock: u64) -> Option<u64> {
        while let Some((next, place, level)) = self.coming.last().copied() {
            if next > clock {
                return Some(next);
            }
            self.inputs[place] = level;
            self.coming.pop();
        }
        None
    }
}

/// A machine on two lines, and what was recorded of it.
struct Side {
    plant: AxisPlant,
    samples: Vec<AxisSample>,
}

impl Side {
    fn new(machine: &Machine, axis: &AxisSection) -> Result<Self, StageRunError> {
        Ok(Self {
            plant: AxisPlant::new(axis, &machine.clock, &PlantOptions::default())?,
            samples: Vec::new(),
        })
    }

    fn pass(&mut self, levels: [u64; 2], clocks: u64) {
        let [a_high, b_high] = levels.map(|level| level & 1 != 0);
        let pins = DrivePins {
            a_high,
            b_high,
            drive_enable: true,
            brake_release: true,
            ..DrivePins::default()
        };
        self.plant.clocks(pins, clocks);
    }

    fn sample(&mut self) {
        let (count, motion) = (self.plant.count() as f64, self.plant.motion());
        self.samples.push(AxisSample {
            command: count,
            shaped: count,
            count,
            error: 0.0,
            motor: motion.position,
            load: motion.load,
        });
    }
}

/// An axis of the machine behind the inline shaper, and the same on the controller's lines.
struct Track {
    lines_in: [usize; 2],
    lines_out: [usize; 2],
    shaped: Side,
    unshaped: Side,
}

impl Track {
    fn new(machine: &Machine, axis: &AxisSection, pins: &Pins) -> Result<Self, StageRunError> {
        let (Some(input), Some(steps)) = (&axis.input, &axis.steps) else {
            let reason = format!("axis {} has no [axis.input] or [axis.steps]", axis.name);
            return Err(Error::Unlike(reason).into());
        };
        let mut as_controlled = axis.clone();
        as_controlled.steps = Some(StepsSection {
            mode: input.kind,
            active_low: StepLinesActiveLow {
                a: input.active_low.a,
                b: input.active_low.b,
            },
            ..*steps
        });
        Ok(Self {
            lines_in: pins.lines_in(axis, input)?,
            lines_out: pins.lines_out(axis, steps)?,
            shaped: Side::new(machine, axis)?,
            unshaped: Side::new(machine, &as_controlled)?,
        })
    }

    fn pass(&mut self, inputs: &[u64], outputs: &[u64], clocks: u64) {
        self.unshaped.pass(self.lines_in.map(|place| inputs[place]), clocks);
        self.shaped.pass(self.lines_out.map(|place| outputs[place]), clocks);
    }

    fn sample(&mut self) {
        self.unshaped.sample();
        self.shaped.sample();
    }

    fn moved(self) -> InlineAxisMoved {
        InlineAxisMoved {
            sent_steps: self.unshaped.plant.count(),
            given_steps: self.shaped.plant.count(),
            lost_steps: self.shaped.plant.lost_steps(),
            shaped: self.shaped.samples,
            unshaped: self.unshaped.samples,
        }
    }
}
