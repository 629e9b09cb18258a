//! A stage with its machine: a host on the bus, drives and encoders at the pins, and optionally the RTL beside the
//! model.
//!
//! ```text
//!  host: write, read ─► bus ─┐                    ┌─► gates, drive_enable, brake_release ─► plants ─┐
//!                            ├─► stage (model) ───┤                                                 │
//!  lines: limits, faults ────┤   stage (device) ──┴─► every output equal, in every clock            │
//!                            └───────────────────────────────────────── a, b, z ◄───────────────────┘
//! ```
//!
//! With a device every clock is stepped and compared. Without one the model runs event by event, much faster and with
//! exactly the same result. The plants follow the model.
//!
//! Faults: [`StageBench::set`] drives lines; [`StageBench::force_encoder`] and [`StageBench::break_wire`] cut or
//! corrupt an encoder, [`StageBench::fault_absolute_encoder`] an absolute one, [`StageBench::force_scale`] a scale; [`StageBench::jam`] holds an axis,
//! [`StageBench::displace`] disturbs it. Forbidden states of the pins are checked in every clock:
//! [`StageBench::watched`].

mod line_changes;
mod pin_record;
mod watch;

pub use line_changes::LineChange;
use line_changes::LineRecord;
pub use pin_record::PinChange;
use pin_record::{PinRecord, Scheduled};
pub use watch::Watched;

use posicast_blocks::component::Component;
use posicast_blocks::composition::Composed;
use posicast_blocks::segments::Entry;
use posicast_blocks::stage::StageConfig;
use posicast_blocks::{ClockedBlock, Direction, Moore, OutputKind, Port, StepError};
use posicast_machine::plant::axis::{AbsoluteFault, AxisPlant, DrivePins, EncoderPins};

use posicast_testbench::Error;
use posicast_testbench::lockstep::report::Mismatch;
use posicast_testbench::lockstep::{Device, Instance, Lockstep, LockstepOptions};

/// Lines of an axis that are high in normal operation.
const HEALTHY: [&str; 5] = [
    "limit_plus_n",
    "limit_minus_n",
    "drive_ready",
    "drive_fault_n",
    "fault_n",
];
/// Lines of the stage that are high in normal operation.
const HEALTHY_SHARED: [&str; 2] = ["emergency_stop_n", "pll_locked"];
/// Nets of each axis, without the axis's name, that are recorded in a tick.
const RECORDED: [&str; 3] = ["command_position", "shaped_position", "count"];
/// The error of a controller, which an axis with steps does not have.
const ERROR: &str = "error";

/// States of an axis, as values of `STATUS.state`.
pub mod state {
    use posicast_blocks::axis::SupervisorState;

    /// The outputs are off.
    pub const OFF: u32 = SupervisorState::Off as u32;
    /// The outputs are off and nothing is wrong.
    pub const READY: u32 = SupervisorState::Ready as u32;
    /// The outputs are on and the command stands still.
    pub const HOLD: u32 = SupervisorState::Hold as u32;
    /// Segments are played.
    pub const RUN: u32 = SupervisorState::Run as u32;
    /// The command slows down.
    pub const QUICK_STOP: u32 = SupervisorState::QuickStop as u32;
    /// A fault has occurred and its causes are not cleared.
    pub const FAULT: u32 = SupervisorState::Fault as u32;
}

/// An axis at a tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisSample {
    /// Command position in counts.
    pub command: f64,
    /// Shaped position in counts.
    pub shaped: f64,
    /// Count of the encoder.
    pub count: f64,
    /// Error of the controller in counts; with steps, the distance of the count from the shaped position.
    pub error: f64,
    /// Position of the motor in m or rad.
    pub motor: f64,
    /// Position of the load in m or rad.
    pub load: f64,
}

/// Indices of an axis's pins among the stage's ports.
struct Places {
    /// Lines A, B and index of the encoder, or a probe, as far as the axis has them.
    encoder: [Option<usize>; 3],
    /// Data of an absolute encoder, and the net of its clock.
    absolute: Option<[usize; 2]>,
    /// Lines A and B of the scale.
    scale: Option<[usize; 2]>,
    /// Pins in the order of [`DrivePins`], as far as the axis has them.
    drive: [Option<usize>; 6],
    recorded: [usize; 3],
    error: Option<usize>,
}

impl Places {
    /// A power stage has four gates, a drive with step inputs two lines.
    fn has_step_lines(&self) -> bool {
        self.drive[1].is_none()
    }
}

/// Faults between an axis of the machine and the stage.
#[derive(Debug, Clone, Copy, Default)]
struct Fault {
    encoder: Option<EncoderPins>,
    wire: Option<Wire>,
    scale: Option<EncoderPins>,
    lines: Option<StepWire>,
    jammed: bool,
}

/// A fault of one wire of an encoder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wire {
    /// Line A stays at this level.
    AStuck(bool),
    /// Line B stays at this level.
    BStuck(bool),
    /// The two wires of the pair A are exchanged: the encoder counts in the other direction.
    AInverted,
}

/// A fault of one line between the stage and a drive with step inputs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StepWire {
    /// The drive sees no step: its first line is low.
    Cut,
    /// The drive sees the second line, the direction, inverted.
    Reversed,
}

impl StepWire {
    fn apply(self, pins: DrivePins) -> DrivePins {
        match self {
            Self::Cut => DrivePins { a_high: false, ..pins },
            Self::Reversed => DrivePins {
                b_high: !pins.b_high,
                ..pins
            },
        }
    }
}

impl Wire {
    /// Returns the lines with the fault applied.
    fn apply(self, lines: EncoderPins) -> EncoderPins {
        match self {
            Self::AStuck(a) => EncoderPins { a, ..lines },
            Self::BStuck(b) => EncoderPins { b, ..lines },
            Self::AInverted => EncoderPins { a: !lines.a, ..lines },
        }
    }
}

/// A net that is read often: see [`StageBench::probe`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Probe(usize);

fn stopped(clock: u64) -> impl Fn(StepError) -> Error {
    move |source| Error::Step { clock, source }
}

/// The RTL beside the model.
struct Beside {
    lockstep: Lockstep,
    device: Box<dyn Device>,
    /// Most clocks at once: an output that counts changes in each.
    most: u64,
}

impl Beside {
    fn new(model: &Composed, device: Box<dyn Device>) -> Result<Self, Error> {
        let ports = model.ports();
        let counts = |port: &Port| model.output_kind(&port.name) == OutputKind::Counter;
        let stage = [Instance::whole("stage", "with its machine", ports)];
        // The clocks are those of the bench, so none end it.
        let options = LockstepOptions::cycles(u64::MAX);
        Ok(Self {
            lockstep: Lockstep::new(ports, device.ports(), &stage, &options)?,
            device,
            most: if ports.iter().any(counts) { 1 } else { u64::MAX },
        })
    }
}

/// A stage, its machine and its host.
pub struct StageBench {
    component: Component,
    axes: Vec<String>,
    model: Composed,
    compared: Option<Beside>,
    plants: Vec<AxisPlant>,
    places: Vec<Places>,
    input_names: Vec<String>,
    output_names: Vec<String>,
    inputs: Vec<u64>,
    outputs: Vec<u64>,
    tick: usize,
    read_data: usize,
    now: u64,
    samples: Option<Vec<Vec<AxisSample>>>,
    lines: Vec<LineRecord>,
    pins: PinRecord,
    /// Changes of inputs that are still to come, the next one first.
    scheduled: Vec<Scheduled>,
    faults: Vec<Fault>,
    shown: Vec<DrivePins>,
    watched: Vec<Watched>,
}

impl StageBench {
    /// Starts a stage with a reset of two clocks and all lines in normal operation. `plants` has one plant per axis;
    /// `device` is the RTL to compare, if wanted.
    ///
    /// # Errors
    /// [`Error::Unlike`] if there is not one plant per axis, or the device has other ports; [`Error::Step`] where a
    /// simulator stops.
    pub fn new(
        config: &StageConfig,
        component: &Component,
        plants: Vec<AxisPlant>,
        device: Option<Box<dyn Device>>,
        seed: u64,
    ) -> Result<Self, Error> {
        let axes: Vec<String> = config.axes.iter().map(|axis| axis.name.clone()).collect();
        if plants.len() != axes.len() {
            return Err(Error::Unlike(format!(
                "{} plants for {} axes",
                plants.len(),
                axes.len()
            )));
        }
        let ports = component.composition().ports();
        let names = |direction| -> Vec<String> {
            let ports = ports.iter().filter(|port| port.direction == direction);
            ports.map(|port| port.name.clone()).collect()
        };
        let (input_names, output_names) = (names(Direction::Input), names(Direction::Output));
        let model = component.model(seed);
        let compared = device.map(|device| Beside::new(&model, device)).transpose()?;
        let place = |names: &[String], name: &str| {
            let found = names.iter().position(|other| other == name);
            found.ok_or_else(|| Error::Unlike(format!("the stage has no port `{name}`")))
        };
        let mut places = Vec::new();
        for (axis, built) in axes.iter().zip(&config.axes) {
            let input = |pin: &str| place(&input_names, &format!("{axis}_{pin}")).ok();
            let scale = ["scale_a", "scale_b"].map(input);
            let [first, first_low, second, second_low] = match built.steps() {
                None => ["a_high", "a_low", "b_high", "b_low"].map(Some),
                Some(steps) => {
                    let [first, second] = steps.mode().line_names().map(Some);
                    [first, None, second, None]
                }
            };
            let drive = [
                first,
                first_low,
                second,
                second_low,
                Some("drive_enable"),
                Some("brake_release"),
            ];
            let mut pins = [None; 6];
            for (pin, name) in pins.iter_mut().zip(drive) {
                let found = name.map(|name| place(&output_names, &format!("{axis}_{name}")));
                *pin = found.transpose()?;
            }
            let net = |name: &str| {
                let found = model.net(&format!("{axis}_{name}"));
                found.ok_or_else(|| Error::Unlike(format!("the stage has no net `{axis}_{name}`")))
            };
            let [n0, n1, n2] = RECORDED.map(net);
            places.push(Places {
                encoder: [input("a"), input("b"), input("z").or(input("probe"))],
                absolute: input("encoder_data")
                    .zip(net("encoder_clock").ok())
                    .map(<[usize; 2]>::from),
                scale: scale[0].zip(scale[1]).map(<[usize; 2]>::from),
                drive: pins,
                recorded: [n0?, n1?, n2?],
                error: net(ERROR).ok(),
            });
        }
        let mut bench = Self {
            tick: place(&output_names, "tick")?,
            read_data: place(&output_names, "avs_readdata")?,
            faults: vec![Fault::default(); axes.len()],
            shown: vec![DrivePins::default(); axes.len()],
            watched: vec![Watched::default(); axes.len()],
            inputs: vec![0; input_names.len()],
            outputs: vec![0; output_names.len()],
            component: component.clone(),
            axes,
            model,
            compared,
            plants,
            places,
            input_names,
            output_names,
            now: 0,
            samples: None,
            lines: Vec::new(),
            pins: PinRecord::default(),
            scheduled: Vec::new(),
        };
        // An axis with steps has fewer lines, and a stage of such axes no `pll_locked`.
        let lines = bench
            .axes
            .iter()
            .flat_map(|axis| HEALTHY.map(|line| format!("{axis}_{line}")));
        let mut healthy: Vec<String> = HEALTHY_SHARED.map(str::to_owned).into_iter().chain(lines).collect();
        healthy.retain(|line| bench.input_names.contains(line));
        for line in &healthy {
            bench.set(line, 1)?;
        }
        bench.reset(2)?;
        Ok(bench)
    }

    /// Resets for this many clocks, at any time. Counters restart at 0, where the plants are.
    ///
    /// # Errors
    /// [`Error::Step`] where a simulator stops.
    pub fn reset(&mut self, clocks: u64) -> Result<(), Error> {
        self.set("rst", 1)?;
        self.clocks(clocks)?;
        self.set("rst", 0)?;
        self.rebase();
        Ok(())
    }

    /// Accepts the present counts: from now on no counter may deviate from its plant by more than now.
    pub fn rebase(&mut self) {
        for ((watched, plant), places) in self.watched.iter_mut().zip(&self.plants).zip(&self.places) {
            watched.rebase(self.model.value(places.recorded[2]), plant);
        }
    }

    /// Observations at an axis's pins in every clock since the start.
    pub fn watched(&self, axis: usize) -> &Watched {
        &self.watched[axis]
    }

    /// The levels of an axis's pins in the last clock.
    pub fn pins(&self, axis: usize) -> DrivePins {
        self.shown[axis]
    }

    /// Forces the lines of an axis's encoder from the next clock on; with `None` they follow the plant again.
    pub fn force_encoder(&mut self, axis: usize, pins: Option<EncoderPins>) {
        self.faults[axis].encoder = pins;
    }

    /// Breaks a wire of an axis's encoder from the next clock on; `None` repairs it.
    pub fn break_wire(&mut self, axis: usize, wire: Option<Wire>) {
        self.faults[axis].wire = wire;
    }

    /// Gives the absolute encoder of an axis a fault from the next clock on; `None` mends it.
    pub fn fault_absolute_encoder(&mut self, axis: usize, fault: Option<AbsoluteFault>) {
        self.plants[axis].set_absolute_fault(fault);
    }

    /// Forces the lines A and B of an axis's scale, as [`force_encoder`](Self::force_encoder) does for the encoder.
    pub fn force_scale(&mut self, axis: usize, pins: Option<EncoderPins>) {
        self.faults[axis].scale = pins;
    }

    /// Breaks a line between the stage and the drive of an axis with steps; `None` repairs it.
    pub fn break_step_wire(&mut self, axis: usize, wire: Option<StepWire>) {
        self.faults[axis].lines = wire;
    }

    /// Jams an axis, or frees it: its plant stands as if its brake were applied.
    pub fn jam(&mut self, axis: usize, jammed: bool) {
        self.faults[axis].jammed = jammed;
    }

    /// Displaces an axis by this many counts of its encoder, as a disturbance.
    pub fn displace(&mut self, axis: usize, counts: f64) {
        self.plants[axis].displace(counts);
    }

    /// Names of the axes.
    pub fn axes(&self) -> &[String] {
        &self.axes
    }

    /// Number of clocks since the start.
    pub fn now(&self) -> u64 {
        self.now
    }

    /// The plant of an axis.
    pub fn plant(&self, axis: usize) -> &AxisPlant {
        &self.plants[axis]
    }

    /// Outputs that differed, and the first of them.
    pub fn mismatches(&self) -> (u64, Option<Mismatch>) {
        let report = self.compared.as_ref().map(|compared| compared.lockstep.report());
        let blocks = report.into_iter().flat_map(|report| report.blocks);
        blocks.fold((0, None), |(count, first), block| {
            (count + block.mismatches, first.or(block.first))
        })
    }

    /// Drives an input that belongs neither to an encoder nor to the bus, such as `x_limit_plus_n`, from the next
    /// clock on.
    ///
    /// # Errors
    /// [`Error::Unlike`] if there is no such input.
    pub fn set(&mut self, input: &str, value: u64) -> Result<(), Error> {
        let place = self.input_names.iter().position(|name| name == input);
        let place = place.ok_or_else(|| Error::Unlike(format!("the stage has no input `{input}`")))?;
        self.inputs[place] = value;
        Ok(())
    }

    /// Value of an output in the last clock.
    ///
    /// # Errors
    /// [`Error::Unlike`] if there is no such output.
    pub fn output(&self, output: &str) -> Result<u64, Error> {
        let place = self.output_names.iter().position(|name| name == output);
        let place = place.ok_or_else(|| Error::Unlike(format!("the stage has no output `{output}`")))?;
        Ok(self.outputs[place])
    }

    /// Value of a net between registers and axes, such as `x_state`.
    ///
    /// # Errors
    /// [`Error::Unlike`] if there is no such net.
    pub fn net(&self, net: &str) -> Result<u64, Error> {
        Ok(self.at(self.probe(net)?))
    }

    /// Returns a handle for frequent reads of a net.
    ///
    /// # Errors
    /// [`Error::Unlike`] if there is no such net.
    pub fn probe(&self, net: &str) -> Result<Probe, Error> {
        let place = self.model.net(net);
        let place = place.ok_or_else(|| Error::Unlike(format!("the stage has no net `{net}`")))?;
        Ok(Probe(place))
    }

    /// Value of the net in the next clock, as far as registers determine it.
    pub fn at(&self, probe: Probe) -> u64 {
        self.model.value(probe.0)
    }

    /// Starts recording all axes at each tick.
    pub fn record(&mut self) {
        self.samples = Some(vec![Vec::new(); self.axes.len()]);
        self.lines = vec![LineRecord::default(); self.axes.len()];
    }

    /// Returns the recorded samples, one list per axis, and ends the recording.
    pub fn recorded(&mut self) -> Vec<Vec<AxisSample>> {
        self.samples.take().unwrap_or_default()
    }

    /// Returns each axis's step lines in the tick with most steps since the recording began, and ends that recording; axes without
    /// steps have no changes.
    pub fn recorded_lines(&mut self) -> Vec<Vec<LineChange>> {
        let lines = std::mem::take(&mut self.lines);
        lines.into_iter().map(LineRecord::busiest).collect()
    }

    /// Simulates this many clocks.
    ///
    /// # Errors
    /// [`Error::Step`] where a simulator stops.
    pub fn clocks(&mut self, clocks: u64) -> Result<(), Error> {
        let end = self.now + clocks;
        while self.now < end {
            let unscheduled = self.drive_scheduled();
            let axes = self.plants.iter_mut().zip(&self.places).zip(&self.faults);
            for (((plant, places), fault), watched) in axes.zip(&mut self.watched) {
                watched.look(self.model.value(places.recorded[2]), plant);
                let lines = fault.wire.map_or(plant.encoder(), |wire| wire.apply(plant.encoder()));
                let pins = fault.encoder.unwrap_or(lines);
                for (place, level) in places.encoder.into_iter().zip([pins.a, pins.b, pins.z]) {
                    if let Some(place) = place {
                        self.inputs[place] = level.into();
                    }
                }
                if let Some([data, clock]) = places.absolute {
                    plant.encoder_clock(self.model.value(clock) != 0);
                    self.inputs[data] = plant.encoder_data().into();
                }
                if let Some([a, b]) = places.scale {
                    let pins = fault.scale.unwrap_or_else(|| plant.scale());
                    (self.inputs[a], self.inputs[b]) = (pins.a.into(), pins.b.into());
                }
            }
            let quiet = self.plants.iter().map(AxisPlant::quiet_clocks);
            let most = quiet.min().unwrap_or(1).clamp(1, unscheduled.min(end - self.now));
            let passed = match &mut self.compared {
                Some(Beside {
                    lockstep,
                    device,
                    most: at_once,
                }) => {
                    let most = most.min(*at_once);
                    let passed = lockstep.hold(&mut self.model, device.as_mut(), &mut self.inputs, most)?;
                    self.outputs.copy_from_slice(lockstep.expected());
                    passed
                }
                None => self
                    .model
                    .hold(&self.inputs, most, &mut self.outputs)
                    .map_err(stopped(self.now))?,
            };
            self.pins.pass(self.now, &self.inputs, &self.outputs, &self.plants);
            if self.outputs[self.tick] != 0 {
                self.sample();
                self.lines.iter_mut().for_each(|record| record.tick(self.now));
            }
            for (axis, (plant, places)) in self.plants.iter_mut().zip(&self.places).enumerate() {
                let [a_high, a_low, b_high, b_low, drive_enable, brake_release] = places
                    .drive
                    .map(|place| place.is_some_and(|place| self.outputs[place] != 0));
                let pins = DrivePins {
                    a_high,
                    a_low,
                    b_high,
                    b_low,
                    drive_enable,
                    brake_release,
                };
                if let Some(record) = self.lines.get_mut(axis).filter(|_| places.has_step_lines()) {
                    record.pass(self.now, [a_high, b_high]);
                }
                self.shown[axis] = pins;
                let brake_release = brake_release && !self.faults[axis].jammed;
                let seen = DrivePins { brake_release, ..pins };
                plant.clocks(self.faults[axis].lines.map_or(seen, |wire| wire.apply(seen)), passed);
                self.watched[axis].pass(&pins, passed, plant);
            }
            self.now += passed;
        }
        Ok(())
    }

    fn sample(&mut self) {
        let Some(samples) = &mut self.samples else {
            return;
        };
        for ((list, places), plant) in samples.iter_mut().zip(&self.places).zip(&self.plants) {
            let signed = |net: usize| f64::from(self.model.value(net) as u32 as i32);
            let [command, shaped, count] = places.recorded.map(signed);
            let error = places
                .error
                .map_or(shaped / 256.0 - count, |net| signed(net) / 65_536.0);
            let motion = plant.motion();
            list.push(AxisSample {
                command: command / 256.0,
                shaped: shaped / 256.0,
                count,
                error,
                motor: motion.position,
                load: motion.load,
            });
        }
    }

    /// Whether the stage has a register of this name.
    pub fn has(&self, register: &str) -> bool {
        self.component.map().register(register).is_some()
    }

    /// Address of a register on the bus.
    fn address(&self, register: &str) -> Result<u64, Error> {
        let found = self.component.map().register(register);
        let found = found.ok_or_else(|| Error::Unlike(format!("the stage has no register `{register}`")))?;
        Ok(found.offset.into())
    }

    fn access(&mut self, address: u64, write: Option<u32>) -> Result<(), Error> {
        let data = u64::from(write.unwrap_or(0));
        let bus = [address, write.is_none().into(), write.is_some().into(), 0xf, data];
        self.inputs[1..6].copy_from_slice(&bus);
        self.clocks(1)?;
        self.inputs[1..6].fill(0);
        Ok(())
    }

    /// Writes the word at this address, as a program on the bus does; it takes one clock.
    ///
    /// # Errors
    /// [`Error::Unlike`] for an address beyond the stage's windows; [`Error::Step`] where a simulator stops.
    pub fn write_at(&mut self, address: u32, data: u32) -> Result<(), Error> {
        let address = self.inside(address)?;
        self.access(address, Some(data))
    }

    /// Reads the word at this address; it takes two clocks.
    ///
    /// # Errors
    /// Those of [`write_at`](Self::write_at).
    pub fn read_at(&mut self, address: u32) -> Result<u32, Error> {
        let address = self.inside(address)?;
        self.access(address, None)?;
        self.clocks(1)?;
        Ok(self.outputs[self.read_data] as u32)
    }

    fn inside(&self, address: u32) -> Result<u64, Error> {
        match self.component.map().words() {
            words if address < words => Ok(address.into()),
            words => Err(Error::Unlike(format!("the stage has {words} words, none at {address}"))),
        }
    }

    /// Writes a register; it takes one clock.
    ///
    /// # Errors
    /// [`Error::Unlike`] if there is no such register; [`Error::Step`] where a simulator stops.
    pub fn write(&mut self, register: &str, data: u32) -> Result<(), Error> {
        let address = self.address(register)?;
        self.access(address, Some(data))
    }

    /// Reads a register; it takes two clocks.
    ///
    /// # Errors
    /// Those of [`write`](Self::write).
    pub fn read(&mut self, register: &str) -> Result<u32, Error> {
        let address = self.address(register)?;
        self.access(address, None)?;
        self.clocks(1)?;
        Ok(self.outputs[self.read_data] as u32)
    }

    /// Reads a field of a register. Names are without the axis: `("x", "status", "state")`.
    ///
    /// # Errors
    /// Those of [`write`](Self::write), and [`Error::Unlike`] if there is no such field.
    pub fn field(&mut self, axis: &str, register: &str, field: &str) -> Result<u32, Error> {
        let word = self.read(&format!("{axis}_{register}"))?;
        let found = self.component.map().register(&format!("{axis}_{register}"));
        let name = format!("{axis}_{field}");
        let field = found.and_then(|register| register.fields.iter().find(|field| field.name == name));
        let field = field.ok_or_else(|| Error::Unlike(format!("the register has no field `{name}`")))?;
        Ok(field.of(word))
    }

    /// Writes an entry to an axis's FIFO; it takes four clocks.
    ///
    /// # Errors
    /// Those of [`write`](Self::write).
    pub fn segment(&mut self, axis: &str, entry: &Entry) -> Result<(), Error> {
        for (place, word) in entry.words().into_iter().enumerate() {
            self.write_word(&format!("{axis}_segment"), place, word)?;
        }
        Ok(())
    }

    /// Writes one word of a register that has several; it takes one clock.
    ///
    /// # Errors
    /// Those of [`write`](Self::write).
    pub fn write_word(&mut self, register: &str, place: usize, data: u32) -> Result<(), Error> {
        let address = self.address(register)?;
        self.access(address + place as u64, Some(data))
    }

    /// Simulates until an axis has this state, for at most this many clocks; returns whether it has.
    ///
    /// # Errors
    /// [`Error::Step`] where a simulator stops.
    pub fn wait(&mut self, axis: &str, state: u32, most_clocks: u64) -> Result<bool, Error> {
        let end = self.now + most_clocks;
        let net = format!("{axis}_state");
        while self.net(&net)? != u64::from(state) {
            if self.now >= end {
                return Ok(false);
            }
            self.clocks((end - self.now).min(1000))?;
        }
        Ok(true)
    }

    /// Goes from reset to HOLD on all axes: clears the PWM's first trip, switches on, and waits for the brake.
    /// Returns whether all axes are in HOLD.
    ///
    /// # Errors
    /// [`Error::Step`] where a simulator stops.
    pub fn switch_on(&mut self, most_clocks: u64) -> Result<bool, Error> {
        // This lets filters and encoders settle.
        self.clocks(1000)?;
        for axis in self.axes.clone() {
            self.write(&format!("{axis}_clear_faults"), 0)?;
        }
        for axis in self.axes.clone() {
            if !self.wait(&axis, state::READY, most_clocks)? {
                return Ok(false);
            }
        }
        for axis in self.axes.clone() {
            self.write(&format!("{axis}_control"), 1)?;
        }
        for axis in self.axes.clone() {
            let net = format!("{axis}_can_start");
            let end = self.now + most_clocks;
            // `can_start` is high only in HOLD, once the brake is open.
            while self.now < end && self.net(&net)? == 0 {
                self.clocks(100)?;
            }
            if self.now >= end {
                return Ok(false);
            }
        }
        Ok(true)
    }
}
