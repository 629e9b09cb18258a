//! Seeded random inputs for a whole stage: a driver that switches on, loads, starts and stops, among random traffic
//! on all windows; lines that are mostly healthy; encoders that move.

mod driver;
mod reads;

use posicast_blocks::absolute_encoder::AbsoluteEncoderConfig;
use posicast_blocks::component::{Component, ComponentPart};
use posicast_blocks::registers::{Access, Register, RegisterMap};
use posicast_blocks::{Direction, Port};

use self::driver::{Driver, Moves, Pins};
use self::reads::{Clears, ReadBack};
use crate::absolute_encoder::encoder::{EncoderFault, SimulatedEncoder, range};
use crate::registers::RegistersRandom;
use crate::registers::stimuli::{ADDRESS, BYTE_ENABLE, READ, WRITE, WRITE_DATA};
use crate::stimuli::Stimuli;
use crate::stimuli::table::pick;

/// Number of clocks between changes of the mood: with random writes to any register, and without.
const MOOD_CLOCKS: [u64; 2] = [6_000, 40_000];
/// Lines of an axis that are high in normal operation, and how rarely each is low. Lines that stop everything are low
/// more rarely.
const LINES: [(&str, u32); 6] = [
    ("limit_plus_n", 1),
    ("limit_minus_n", 1),
    ("drive_ready", 4),
    ("drive_fault_n", 4),
    ("fault_n", 8),
    ("home", 1),
];
/// The shared lines of the stage, as in [`LINES`].
const SHARED_LINES: [(&str, u32); 2] = [("emergency_stop_n", 4), ("pll_locked", 8)];
/// A reset comes before every so many scenes: what the last one left in any block goes. It is odd, so that each axis had the lead.
const SCENES_TO_A_RESET: usize = 5;
/// Number of clocks of the gates' mean that make one step of an encoder that follows them.
const STEP_CLOCKS: i32 = 48;
/// Least number of clocks between two steps, so that the encoder's filter passes them.
const EDGE_CLOCKS: u32 = 12;
/// A fault of an absolute encoder begins once in so many clocks, and lasts for as many as one of these ticks.
const ENCODER_FAULT_CLOCKS: u32 = 20_000;
const ENCODER_FAULT_TICKS: [u32; 4] = [1, 2, 3, 6];

/// Settings that hold for a while.
#[derive(Debug, Clone, Copy)]
struct Mood {
    /// Whether random writes go to any register.
    wild: bool,
    /// Whether a scene is played; nothing else happens then.
    scene: bool,
    /// One fault comes in this many clocks.
    fault_pace: u32,
    /// The driver makes one request in this many clocks.
    request_pace: u32,
    /// One reset comes in this many clocks.
    reset_pace: u32,
}

/// The pins of an axis.
#[derive(Debug, Clone)]
struct AxisPins {
    /// Indices of A, B and Z of the encoder, and of the linear scale if there is one: it moves as the motor does. An axis with steps
    /// has only the index, or the probe.
    encoders: [[Option<usize>; 3]; 2],
    /// Indices of the limit switches, + and −.
    switches: [usize; 2],
    /// Indices of A's and B's high gate, of the drive's enable and of the brake's release among the outputs.
    shown: [usize; 4],
    moves: Moves,
    count: i32,
    /// The count at the last reset.
    origin: i32,
    /// Sum of the gates' mean since the last step.
    mean: i32,
    since_step: u32,
    invert: bool,
    /// Whether both lines change at once in the next step.
    slips: bool,
    absolute: Option<AbsolutePins>,
}

/// The pins of an absolute encoder, and the encoder.
#[derive(Debug, Clone)]
struct AbsolutePins {
    /// Index of the data among the inputs, and of the clock among the outputs.
    data: usize,
    clock: usize,
    encoder: SimulatedEncoder,
    /// Reading at which the axis is at 0.
    offset: u64,
    range: u64,
    /// Clocks left of a fault.
    fault_clocks: u32,
}

/// The absolute encoder of an axis, as the stage is built for it.
fn absolute_encoder<'a>(component: &'a Component, axis: &str) -> Option<&'a AbsoluteEncoderConfig> {
    let of_axis = component.blocks().find_map(|part| match part {
        ComponentPart::Joined(joined) if joined.name() == axis => Some(joined),
        _ => None,
    });
    of_axis?.blocks().find_map(|part| match part {
        ComponentPart::AbsoluteEncoder(config) => Some(config),
        _ => None,
    })
}

/// A line and the time for which it is low.
#[derive(Debug, Clone, Copy)]
struct Line {
    /// Index of the axis; `None` for a line shared by all.
    axis: Option<usize>,
    name: &'static str,
    at: usize,
    /// The line is low this many times more rarely than other lines.
    pace: u32,
    low: u32,
}

/// An endless random mixture of all inputs.
#[derive(Debug, Clone)]
pub struct StageRandom {
    /// Generators that read back the settings and the taps.
    read_back: [ReadBack; 2],
    registers: RegistersRandom,
    driver: Driver,
    tick_clocks: u32,
    clock: u64,
    mood: Mood,
    mood_ends: u64,
    /// Number of moods and scenes so far.
    moods: u32,
    scenes: usize,
    /// Clocks left of a reset between two scenes.
    reset_clocks: u32,
    /// Offsets of the status words.
    status: Vec<u64>,
    clears: Clears,
    axes: Vec<AxisPins>,
    lines: Vec<Line>,
}

fn place(ports: &[Port], direction: Direction, name: &str) -> Option<usize> {
    let mut names = ports.iter().filter(|port| port.direction == direction);
    names.position(|port| port.name == name)
}

/// Returns the offsets of the words that show a stage's states, flags, causes and values.
fn status(map: &RegisterMap) -> Vec<u64> {
    let shown = |register: &&Register| matches!(register.access, Access::Live | Access::Sticky | Access::Shadow { .. });
    map.registers()
        .iter()
        .filter(shown)
        .map(|register| register.offset.into())
        .collect()
}

impl StageRandom {
    /// Creates the generator. Equal seeds give equal inputs for equal outputs.
    pub fn new(component: &Component, axes: &[String], seed: u64) -> Self {
        let ports = component.composition().ports();
        let input = |name: &str| place(ports, Direction::Input, name);
        let of_axis = |axis: &String| {
            let encoder = |kind: &str| ["a", "b", "z"].map(|pin| input(&format!("{axis}_{kind}{pin}")));
            // A probe takes the place of the index.
            let [a, b, z] = encoder("");
            let own = [a, b, z.or_else(|| input(&format!("{axis}_probe")))];
            let shown = ["a_high", "b_high", "drive_enable", "brake_release"];
            let absolute = absolute_encoder(component, axis).map(|config| AbsolutePins {
                data: input(&format!("{axis}_encoder_data")).unwrap_or(0),
                clock: place(ports, Direction::Output, &format!("{axis}_encoder_clock")).unwrap_or(0),
                encoder: SimulatedEncoder::new(config),
                offset: component
                    .map()
                    .register(&format!("{axis}_encoder_offset"))
                    .map_or(0, |register| register.reset().into()),
                range: range(config),
                fault_clocks: 0,
            });
            AxisPins {
                absolute,
                encoders: [own, encoder("scale_")],
                switches: [0, 1].map(|which| input(&format!("{axis}_{}", LINES[which].0)).unwrap_or(0)),
                shown: shown.map(|pin| place(ports, Direction::Output, &format!("{axis}_{pin}")).unwrap_or(0)),
                moves: Moves::Still,
                count: 0,
                origin: 0,
                mean: 0,
                since_step: 0,
                invert: false,
                slips: false,
            }
        };
        let of_axes = |(at, axis): (usize, &String)| {
            let axis = axis.clone();
            LINES.map(move |(line, pace)| (Some(at), line, format!("{axis}_{line}"), pace))
        };
        let shared = SHARED_LINES.map(|(line, pace)| (None, line, line.to_owned(), pace));
        let lines = shared.into_iter().chain(axes.iter().enumerate().flat_map(of_axes));
        let line = |(axis, name, port, pace): (Option<usize>, &'static str, String, u32)| {
            input(&port).map(|at| Line {
                axis,
                name,
                at,
                pace,
                low: 0,
            })
        };
        let map = component.map();
        let read_back = [ReadBack::settings, ReadBack::taps].map(|new| new(map, axes, seed));
        let own: Vec<u64> = read_back.iter().flat_map(ReadBack::own).collect();
        Self {
            registers: RegistersRandom::new(map, ports, seed).without(&own),
            tick_clocks: map.register("tick_clocks").map_or(1000, |register| register.reset()),
            driver: Driver::new(map, axes, seed),
            clock: 0,
            mood_ends: 0,
            scenes: 0,
            reset_clocks: 0,
            moods: 0,
            clears: Clears::new(map, axes, seed),
            status: status(map).into_iter().filter(|offset| !own.contains(offset)).collect(),
            mood: Mood {
                wild: false,
                scene: false,
                fault_pace: 1,
                request_pace: 1,
                reset_pace: 1,
            },
            axes: axes.iter().map(of_axis).collect(),
            lines: lines.filter_map(line).collect(),
            read_back,
        }
    }

    fn one_in(&mut self, clocks: u32) -> bool {
        self.registers.one_in(clocks)
    }

    fn pick<T: Copy>(&mut self, choices: &[T]) -> T {
        *pick(&mut self.registers.rng, choices)
    }

    /// Alternates scenes with periods of random traffic, after the first scenes, which come at once.
    fn new_mood(&mut self) {
        self.moods += 1;
        // Each axis leads each scene once before random traffic begins.
        if self.scenes < self.driver.scenes() * self.axes.len() || self.moods.is_multiple_of(2) {
            return self.new_scene();
        }
        self.mood = Mood {
            scene: false,
            wild: self.one_in(4),
            fault_pace: self.pick(&[3_000, 12_000, 12_000, 100_000]),
            request_pace: self.pick(&[3, 30, 30, 300]),
            reset_pace: self.pick(&[10_000, 1_000_000, 1_000_000, 1_000_000]),
        };
        for at in 0..self.axes.len() {
            self.axes[at].moves = self.pick(&[Moves::Still, Moves::Follows, Moves::Follows, Moves::Walks]);
            self.axes[at].invert = self.one_in(3);
        }
        self.driver.begin_anew();
    }

    fn new_scene(&mut self) {
        self.mood = Mood {
            wild: false,
            scene: true,
            fault_pace: u32::MAX,
            request_pace: u32::MAX,
            reset_pace: u32::MAX,
        };
        for axis in &mut self.axes {
            axis.invert = false;
        }
        self.driver.play(self.scenes);
        self.scenes += 1;
        if self.scenes.is_multiple_of(SCENES_TO_A_RESET) {
            self.reset_clocks = 2;
        }
    }

    /// Applies what the scenes require at the pins of an axis.
    fn pins(&mut self, seen: &[u64]) {
        for at in 0..self.axes.len() {
            let axis = &self.axes[at];
            let [on, released] = [2, 3].map(|pin| seen.get(axis.shown[pin]).is_some_and(|value| value & 1 != 0));
            for pins in self.driver.sees(at, axis.count - axis.origin, on, released) {
                match pins {
                    Pins::Encoder(moves) => self.axes[at].moves = moves,
                    Pins::Slip => self.axes[at].slips = true,
                    Pins::Low(name, clocks) => {
                        let is_meant = |line: &&mut Line| line.name == name && line.axis.is_none_or(|axis| axis == at);
                        let line = self.lines.iter_mut().find(is_meant);
                        line.into_iter().for_each(|line| line.low = clocks);
                    }
                }
            }
        }
    }

    /// Moves the encoders, one step at a time. An axis with steps shows no current in its pins: its index comes as if it walked.
    fn encoders(&mut self, seen: &[u64], inputs: &mut [u64]) {
        for at in 0..self.axes.len() {
            let [own, _] = self.axes[at].encoders;
            let is_pulled = own[0].is_some() || self.axes[at].absolute.is_some();
            let step = match self.axes[at].moves {
                Moves::Still => 0,
                Moves::Follows if is_pulled => {
                    let axis = &mut self.axes[at];
                    let level = |output: usize| seen.get(output).map_or(0, |value| *value as i32 & 1);
                    axis.mean += level(axis.shown[0]) - level(axis.shown[1]);
                    let step = i32::from(axis.mean >= STEP_CLOCKS) - i32::from(axis.mean <= -STEP_CLOCKS);
                    axis.mean -= step * STEP_CLOCKS;
                    if axis.invert { -step } else { step }
                }
                Moves::Walks | Moves::Follows => {
                    let walks = self.one_in(40);
                    let back = self.one_in(3);
                    i32::from(walks) * if back { -1 } else { 1 }
                }
            };
            // Rarely both lines change at once.
            let slips = !self.mood.scene && self.one_in(300_000);
            let axis = &mut self.axes[at];
            let slips = std::mem::take(&mut axis.slips) || slips;
            axis.since_step += 1;
            if step != 0 && axis.since_step > EDGE_CLOCKS || slips {
                axis.count += if slips { 2 } else { step };
                axis.since_step = 0;
            }
            let phase = axis.count & 3;
            let levels = [phase == 1 || phase == 2, phase >= 2, axis.count & 31 == 0];
            for (place, level) in axis.encoders.iter().flat_map(|places| places.iter().zip(levels)) {
                if let Some(place) = place {
                    inputs[*place] = level.into();
                }
            }
        }
    }

    /// Answers the stage as the absolute encoders do, now and then with a fault.
    fn absolute_encoders(&mut self, seen: &[u64], inputs: &mut [u64]) {
        for at in 0..self.axes.len() {
            if self.axes[at].absolute.is_none() {
                continue;
            }
            let fails = !self.mood.scene && self.one_in(ENCODER_FAULT_CLOCKS);
            let fault = fails.then(|| (self.pick(&EncoderFault::ALL), self.pick(&ENCODER_FAULT_TICKS)));
            let count = i64::from(self.axes[at].count);
            let Some(of) = &mut self.axes[at].absolute else {
                continue;
            };
            if let Some((fault, ticks)) = fault {
                of.fault_clocks = ticks * self.tick_clocks;
                of.encoder.fault = fault;
            }
            if of.fault_clocks == 0 {
                of.encoder.fault = EncoderFault::None;
            }
            of.fault_clocks = of.fault_clocks.saturating_sub(1);
            of.encoder.position = of.offset.wrapping_add_signed(count) & of.range;
            let clock = self.clock < 2 || seen.get(of.clock).is_none_or(|level| level & 1 != 0);
            inputs[of.data] = of.encoder.clock(clock, &mut self.registers.rng).into();
        }
    }

    fn lines(&mut self, inputs: &mut [u64]) {
        for at in 0..self.lines.len() {
            let rarer = self.lines[at].pace * self.axes.len() as u32;
            if !self.mood.scene && self.one_in(self.mood.fault_pace * rarer) {
                let tick = self.tick_clocks;
                self.lines[at].low = self.pick(&[1, 3, 9, 40, tick, 3 * tick, 8 * tick]);
            }
            let line = &mut self.lines[at];
            inputs[line.at] = (line.low == 0).into();
            line.low = line.low.saturating_sub(1);
        }
        for (at, axis) in self.axes.iter().enumerate() {
            for (bit, place) in axis.switches.into_iter().enumerate() {
                inputs[place] &= u64::from(!self.driver.switches(at) >> bit & 1);
            }
        }
    }

    /// Makes the driver's next access, if there is one.
    fn drive(&mut self, seen: &[u64], inputs: &mut [u64]) {
        self.think(seen);
        if let Some(word) = self.clears.word() {
            self.driver.pass(0);
            inputs[ADDRESS] = word;
            (inputs[WRITE], inputs[READ]) = (0, 1);
            return;
        }
        if let Some((offset, data)) = self.driver.clock() {
            self.clears.wrote(offset.into());
            inputs[ADDRESS] = offset.into();
            inputs[WRITE_DATA] = data.into();
            inputs[BYTE_ENABLE] = 0xf;
            (inputs[WRITE], inputs[READ]) = (1, 0);
        } else if self.mood.scene && !self.one_in(4) {
            // The status words show the effect of a scene.
            let status = std::mem::take(&mut self.status);
            inputs[ADDRESS] = self.pick(&status);
            self.status = status;
            inputs[READ] = 1;
        }
    }
}

/// Functions for a host at a line, whose accesses take hundreds of clocks.
impl StageRandom {
    /// Sets `rst` and the pins for a clock, and plans; it does not touch the bus. The pauses of the axes in the mask
    /// `waiting` do not elapse, because their writes are still on the line. A mood lasts `longer` times as long as on the
    /// bus.
    pub(crate) fn beside_a_line(&mut self, seen: &[u64], inputs: &mut [u64], waiting: u32, longer: u64) {
        self.change_mood(longer);
        self.pins(seen);
        inputs[0] = self.reset().into();
        self.encoders(seen, inputs);
        self.absolute_encoders(seen, inputs);
        self.lines(inputs);
        self.think(seen);
        self.driver.pass(waiting);
        self.clock += 1;
    }

    /// Returns at most `most` writes that the driver would make now, and the mask of their axes.
    pub(crate) fn due_writes(&mut self, most: usize) -> (Vec<(u32, u32)>, u32) {
        self.driver.due_writes(most)
    }

    /// Whether random writes may go to any register now.
    pub(crate) fn is_wild(&self) -> bool {
        self.mood.wild
    }

    /// Whether the driver is in a sequence of writes to an axis.
    pub(crate) fn writes(&self, axis: usize) -> bool {
        self.driver.writes(axis)
    }

    fn reset(&mut self) -> bool {
        let between = self.reset_clocks > 0;
        self.reset_clocks = self.reset_clocks.saturating_sub(1);
        let resets = between || self.clock < 2 || !self.mood.scene && self.one_in(self.mood.reset_pace);
        if resets {
            // The count of an absolute encoder does not restart.
            for axis in self.axes.iter_mut().filter(|axis| axis.absolute.is_none()) {
                axis.origin = axis.count;
            }
        }
        resets
    }

    fn change_mood(&mut self, longer: u64) {
        let is_over = if self.mood.scene {
            self.driver.is_idle()
        } else {
            self.clock >= self.mood_ends
        };
        if is_over {
            self.new_mood();
            self.mood_ends = self.clock + longer * MOOD_CLOCKS[usize::from(!self.mood.wild)];
        }
    }

    fn think(&mut self, seen: &[u64]) {
        if self.mood.scene {
            return;
        }
        for (at, axis) in self.axes.iter().enumerate() {
            let on = seen.get(axis.shown[2]).is_some_and(|value| value & 1 != 0);
            self.driver.plan(at, on, self.mood.request_pace);
        }
    }
}

impl Stimuli for StageRandom {
    fn fill(&mut self, seen: &[u64], inputs: &mut [u64]) {
        self.change_mood(1);
        self.pins(seen);
        self.registers.fill(seen, inputs);
        if !self.mood.wild {
            inputs[WRITE] = 0;
        }
        inputs[0] = self.reset().into();
        self.encoders(seen, inputs);
        self.absolute_encoders(seen, inputs);
        self.lines(inputs);
        self.drive(seen, inputs);
        for read_back in &mut self.read_back {
            read_back.fill(&self.driver, self.mood.wild, inputs);
        }
        self.clock += 1;
    }
}
