//! The stage, its two sockets, and the time that passes between them.

use crate::link::{Link, Request};
use crate::path::{Recording, picture};
use posicast_blocks::component::Component;
use posicast_closed_loop::stage_bench::{StageBench, Wire, state};
use posicast_machine::hardware::MachineStage;
use posicast_machine::machine_file::Machine;
use posicast_machine::plant::axis::{AxisPlant, PlantOptions};
use posicast_testbench::blocks::Sources;
use posicast_testbench::component::ComponentBlock;
use posicast_testbench::lockstep::Device;
use std::error::Error;
use std::io::{BufRead, BufReader, ErrorKind, Write};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::Path;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;

type Outcome<T> = Result<T, Box<dyn Error>>;

/// Count of the index of each encoder.
const INDEX_AT: i64 = 777;
/// Distance in m from the start to the contact of a probe, towards its side.
const CONTACT_M: f64 = 3e-3;
/// Time in seconds for which the machine runs on by itself after a dropped link, and whenever LinuxCNC is silent.
const ALONE_S: f64 = 0.5;

const ASK_READ: u32 = 1;
const ASK_WRITE: u32 = 2;
const ASK_RUN: u32 = 3;

/// A command, and the receiver of its answer.
type Command = (String, Sender<String>);

pub(crate) struct Server {
    bench: StageBench,
    clock_hz: f64,
    /// Clocks that LinuxCNC has requested; a fraction of a clock is kept.
    asked_clocks: f64,
    drift: f64,
    accesses: u64,
    dropped: bool,
    recordings: Vec<Recording>,
    sample_s: f64,
    /// Whether an axis has step lines, whose levels at rest say nothing.
    steps: Vec<bool>,
    /// Position of the program's zero from the origin of each axis, m or rad: that of a probe's contact is not 0.
    zeros: Vec<f64>,
}

impl Server {
    /// Starts the stage with its machine at rest; with its Verilog beside the model if `with_rtl`.
    pub(crate) fn new(machine: &Machine, stage: &MachineStage, with_rtl: bool) -> Outcome<Self> {
        let component = Component::stage(&stage.config)?;
        let device = if with_rtl {
            let block = ComponentBlock::new(component.clone(), &format!("{}_stage", machine.name), "stage");
            Some(Box::new(Sources::write(&block)?.verilated(&block, 1)?) as Box<dyn Device>)
        } else {
            None
        };
        let plants = machine.axes.iter().map(|axis| {
            let options = PlantOptions {
                index_at: INDEX_AT,
                contact_at: axis.probe.map_or(0.0, |probe| probe.side.sign() * CONTACT_M),
                ..PlantOptions::default()
            };
            AxisPlant::new(axis, &machine.clock, &options)
        });
        let bench = StageBench::new(&stage.config, &component, plants.collect::<Result<_, _>>()?, device, 1)?;
        Ok(Self {
            bench,
            clock_hz: machine.clock.frequency_hz,
            asked_clocks: 0.0,
            drift: 0.0,
            accesses: 0,
            dropped: false,
            recordings: Vec::new(),
            sample_s: machine.clock.sample_period_s(),
            steps: machine.axes.iter().map(|axis| axis.steps.is_some()).collect(),
            zeros: machine
                .axes
                .iter()
                .map(|axis| axis.probe.map_or(0.0, |probe| -probe.position))
                .collect(),
        })
    }

    /// Serves until the folder's control socket gets `quit`.
    pub(crate) fn serve(mut self, folder: &Path) -> Outcome<()> {
        let (to, commands) = channel();
        let control = UnixListener::bind(folder.join("control"))?;
        std::thread::spawn(move || control.incoming().flatten().for_each(|link| forward(link, &to)));
        let links = UnixListener::bind(folder.join("stage"))?;
        links.set_nonblocking(true)?;
        loop {
            match links.accept() {
                Ok((link, _)) => {
                    if self.talk(link, &commands)? {
                        return Ok(());
                    }
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => {
                    if let Ok(command) = commands.recv_timeout(Duration::from_millis(20))
                        && self.obey(command)?
                    {
                        return Ok(());
                    }
                }
                Err(error) => return Err(error.into()),
            }
        }
    }

    /// Answers LinuxCNC until it disconnects; returns whether the server must end.
    fn talk(&mut self, link: UnixStream, commands: &Receiver<Command>) -> Outcome<bool> {
        let mut link = Link::new(link)?;
        self.dropped = false;
        while !self.dropped {
            if let Ok(command) = commands.try_recv()
                && self.obey(command)?
            {
                return Ok(true);
            }
            match link.request()? {
                Request::End => return Ok(false),
                Request::Silence => self.run(ALONE_S)?,
                Request::None => {}
                Request::Words([what, data]) => {
                    if let Some(word) = self.answer(what >> 28, what & 0x0fff_ffff, data)? {
                        link.answer(word)?;
                    }
                }
            }
        }
        Ok(false)
    }

    fn answer(&mut self, kind: u32, word: u32, data: u32) -> Outcome<Option<u32>> {
        self.accesses += u64::from(kind != ASK_RUN);
        Ok(match kind {
            ASK_READ => Some(self.bench.read_at(word)?),
            ASK_WRITE => {
                self.bench.write_at(word, data)?;
                None
            }
            ASK_RUN => {
                self.run(f64::from(data) * 1e-9)?;
                None
            }
            _ => return Err(format!("a request of kind {kind}").into()),
        })
    }

    /// Runs this time of LinuxCNC; the time that accesses have taken is included.
    fn run(&mut self, seconds: f64) -> Outcome<()> {
        self.asked_clocks =
            self.asked_clocks.max(self.bench.now() as f64) + seconds * self.clock_hz * (1.0 + self.drift);
        let clocks = (self.asked_clocks as u64).saturating_sub(self.bench.now());
        Ok(self.bench.clocks(clocks)?)
    }

    /// Carries a command out; returns whether the server must end.
    fn obey(&mut self, (line, to): Command) -> Outcome<bool> {
        let words: Vec<&str> = line.split_whitespace().collect();
        let said = match words.as_slice() {
            ["set", line, level] => self.bench.set(line, level.parse()?).map(|()| "{}".to_owned())?,
            ["stick", axis] => self.wire(axis, true)?,
            ["mend", axis] => self.wire(axis, false)?,
            ["jam", axis] => self.jam(axis, true)?,
            ["free", axis] => self.jam(axis, false)?,
            ["drift", ppm] => {
                self.drift = ppm.parse::<f64>()? * 1e-6;
                "{}".to_owned()
            }
            ["record"] => {
                self.bench.record();
                "{}".to_owned()
            }
            ["path", name, program] => {
                let samples = self.bench.recorded();
                let origins = [self.zero(0)?, self.zero(1)?];
                let recording = Recording::new(
                    name,
                    &std::fs::read_to_string(program)?,
                    &samples,
                    origins,
                    self.sample_s,
                )?;
                let said = recording.json();
                self.recordings.push(recording);
                said
            }
            ["picture", file] => {
                picture(Path::new(file), &self.recordings)?;
                "{}".to_owned()
            }
            ["drop"] => {
                self.dropped = true;
                self.run(ALONE_S)?;
                self.state()?
            }
            ["state"] => self.state()?,
            ["quit"] => "{}".to_owned(),
            _ => format!("{{\"error\": {line:?}}}"),
        };
        // A client that has disconnected needs no answer.
        let _ = to.send(said);
        Ok(words == ["quit"])
    }

    fn place(&self, axis: &str) -> Outcome<usize> {
        let found = self.bench.axes().iter().position(|name| name == axis);
        Ok(found.ok_or_else(|| format!("there is no axis `{axis}`"))?)
    }

    fn wire(&mut self, axis: &str, sticks: bool) -> Outcome<String> {
        let place = self.place(axis)?;
        let a = self.bench.plant(place).encoder().a;
        self.bench.break_wire(place, sticks.then_some(Wire::AStuck(a)));
        Ok("{}".to_owned())
    }

    fn jam(&mut self, axis: &str, jammed: bool) -> Outcome<String> {
        let place = self.place(axis)?;
        self.bench.jam(place, jammed);
        Ok("{}".to_owned())
    }

    /// Position in m or rad of a program's zero.
    fn zero(&mut self, axis: usize) -> Outcome<f64> {
        let name = self.bench.axes()[axis].clone();
        let counts = self.bench.read(&format!("{name}_origin"))? as i32;
        let plant = self.bench.plant(axis);
        // The encoder counts the driven coordinate.
        let per_count = match plant.count() {
            0 => 0.0,
            count => plant.motion().position / count as f64,
        };
        Ok(f64::from(counts) * per_count + self.zeros[axis])
    }

    fn state(&mut self) -> Outcome<String> {
        let mut axes = Vec::new();
        for (axis, name) in self.bench.axes().to_vec().iter().enumerate() {
            let number = self.bench.field(name, "status", "state")?;
            let causes = self.bench.read(&format!("{name}_causes"))?;
            let origin = self.bench.read(&format!("{name}_origin"))? as i32;
            let pins = self.bench.pins(axis);
            let names = [
                state::OFF,
                state::READY,
                state::HOLD,
                state::RUN,
                state::QUICK_STOP,
                state::FAULT,
            ];
            let named = ["off", "ready", "hold", "run", "quick stop", "fault"];
            let place = names.iter().position(|known| *known == number).unwrap_or(0);
            let gates = pins.a_high || pins.a_low || pins.b_high || pins.b_low;
            let is_on = pins.drive_enable || (gates && !self.steps[axis]);
            let motion = self.bench.plant(axis).motion();
            axes.push(format!(
                "{{\"axis\": {name:?}, \"state\": {:?}, \"causes\": {causes}, \"origin\": {origin}, \"outputs_on\": {is_on}, \"velocity\": {:e}, \"position\": {:e}}}",
                named[place], motion.velocity, motion.position
            ));
        }
        let (mismatches, _) = self.bench.mismatches();
        Ok(format!(
            "{{\"clocks\": {}, \"accesses\": {}, \"mismatches\": {mismatches}, \"axes\": [{}]}}",
            self.bench.now(),
            self.accesses,
            axes.join(", ")
        ))
    }
}

/// Passes the lines of a client on, and answers each.
fn forward(link: UnixStream, to: &Sender<Command>) {
    let Ok(mut answers) = link.try_clone() else { return };
    for line in BufReader::new(link).lines().map_while(Result::ok) {
        let (sender, answer) = channel();
        if to.send((line, sender)).is_err() {
            return;
        }
        let Ok(said) = answer.recv() else { return };
        if writeln!(answers, "{said}").is_err() {
            return;
        }
    }
}
