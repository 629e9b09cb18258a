//! The fault campaign of the host link: line, host and servo thread fail while a machine moves.
//!
//! ```text
//!  HostedStage ─► Line: loses, doubles, changes, invents bytes; is cut; the host dies ─► LinkedBench: bridge, stage, machine
//! ```
//!
//! Each case moves both axes of the fault campaign's machine through the library, with a fault. It is judged by what reached the bus and the
//! pins, not by what the library says:
//!
//! - **writes**: what reached the bus is what the hosts sent, request by request, in order, each whole and once. Only the last request of a
//!   host that died or gave up may be missing;
//! - **pins**, in every clock: never both gates of a leg on, no gate on and no brake released with the drive disabled;
//! - **counter**: never a count away from the machine;
//! - **end**: the machine stands, at its target if the host says so; without a living host its outputs are off;
//! - **way**: no axis leaves the way between start and target by more than a quick stop.

use std::cell::RefCell;
use std::io::{self, ErrorKind, Read, Write};
use std::rc::Rc;
use std::time::Duration;

use posicast_host::{HostError, HostMove, HostedStage, Link, LinkOptions};
use posicast_model::hardware::StageHardware;
use posicast_model::link::cobs;
use posicast_model::machine_file::LinkSection;
use posicast_model::motion::{TickLimits, plan_move};
use posicast_model::rtl::linked_stage::address_limit;
use posicast_testbench::fault_campaign::{Bed, TICK_CLOCKS};
use posicast_testbench::linked_bench::LinkedBench;
use posicast_testbench::stage_bench::state;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// The line of the campaign.
const LINK: LinkSection = LinkSection {
    baud: 3_000_000,
    timeout_s: 200e-6,
    machine_crc: 0x1234_5678,
};
/// Watchdog of the campaign's machine in s: 300 ticks.
const WATCHDOG_S: f64 = 6e-3;
/// Clocks for which a host waits for a reply, in the time of the model.
const REPLY_CLOCKS: u64 = 20_000;
/// How long a host waits in real time. A read from the silent line takes longer, so that it is the only one.
const REPLY: Duration = Duration::from_micros(200);
const READ: Duration = Duration::from_micros(250);
/// Clocks after the last host in which the machine must have come to rest: the watchdog, a quick stop, the brake.
const AFTER_CLOCKS: u64 = 700 * TICK_CLOCKS;
/// Counts by which an axis may be beyond its way: a quick stop from 2 counts per tick at 800 m/s² takes 6, and the modes ring.
const BEYOND_COUNTS: i64 = 40;
/// Counts by which an axis may miss its target.
const ON_TARGET: i64 = 2;

/// What fails.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Nothing.
    None,
    /// Bytes are lost, doubled, changed, invented, in both directions.
    Bytes,
    /// The line is cut for a while.
    Cut,
    /// The line is cut for ever.
    CutForEver,
    /// Noise and breaks for a while.
    Noise,
    /// The host dies in the middle of a frame.
    HostDies,
    /// The same, and another host starts.
    HostRestarts,
    /// The same, on a line that damages bytes.
    RestartWithBytes,
    /// The servo thread sends an entry late.
    Late,
    /// The servo thread sends no more entries.
    Missing,
}

impl Kind {
    pub(crate) const ALL: [Self; 10] = [
        Self::None,
        Self::Bytes,
        Self::Cut,
        Self::CutForEver,
        Self::Noise,
        Self::HostDies,
        Self::HostRestarts,
        Self::RestartWithBytes,
        Self::Late,
        Self::Missing,
    ];

    /// Its name in the table.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Bytes => "line: bytes damaged",
            Self::Cut => "line: cut for a while",
            Self::CutForEver => "line: cut",
            Self::Noise => "line: noise and breaks",
            Self::HostDies => "host: dies in a frame",
            Self::HostRestarts => "host: dies and restarts",
            Self::RestartWithBytes => "host: the same, bytes damaged",
            Self::Late => "servo thread: late entry",
            Self::Missing => "servo thread: no more entries",
        }
    }
}

/// Result of a case.
#[derive(Debug, Clone)]
pub(crate) struct Outcome {
    pub(crate) kind: Kind,
    /// Whether the move came to its target.
    pub(crate) arrived: bool,
    /// Bytes that were damaged or lost.
    pub(crate) faults: u64,
    /// Words written to the bus.
    pub(crate) writes: usize,
    /// Ticks from the last byte of the last host to outputs off; `None` where it switched them off itself.
    pub(crate) off_ticks: Option<u64>,
    /// What was not as required.
    pub(crate) failures: Vec<String>,
}

/// A request with writes, as a host sent it.
struct Sent {
    sequence: u8,
    pairs: Vec<(u16, u32)>,
    /// Whether it may be missing: its host got no reply.
    open: bool,
}

/// Line and machine.
struct World {
    linked: LinkedBench,
    rng: Xoshiro256PlusPlus,
    /// One byte in this many is damaged; 0: none.
    damaged_one_in: u32,
    /// Bytes that the present host has sent.
    sent_bytes: u64,
    /// Bytes after which the present host is dead.
    dies_at: Option<u64>,
    /// Clocks in which nothing passes, and in which noise comes.
    cut: Option<[u64; 2]>,
    noise: Option<[u64; 2]>,
    coming: Vec<u8>,
    /// The frame that the present host is sending.
    frame: Vec<u8>,
    sent: Vec<Sent>,
    /// Requests of hosts that have ended.
    closed: usize,
    faults: u64,
    last_byte: u64,
}

impl World {
    fn now(&self) -> u64 {
        self.linked.bench.now()
    }

    fn within(&self, window: Option<[u64; 2]>) -> bool {
        window.is_some_and(|[from, to]| (from..to).contains(&self.now()))
    }

    /// What becomes of a byte on the line.
    fn carry(&mut self, byte: u8) -> Vec<u8> {
        if self.within(self.cut) {
            self.faults += 1;
            return vec![];
        }
        if self.within(self.noise) && self.rng.random_range(0..4) == 0 {
            self.faults += 1;
            let any = self.rng.random();
            return vec![any, byte];
        }
        if self.damaged_one_in == 0 || self.rng.random_range(0..self.damaged_one_in) != 0 {
            return vec![byte];
        }
        self.faults += 1;
        let any: u8 = self.rng.random();
        match self.rng.random_range(0..5) {
            0 => vec![],
            1 => vec![byte, byte],
            2 => vec![byte ^ 1 << (any % 8)],
            3 => vec![any, byte],
            _ => vec![any],
        }
    }

    /// Keeps the requests that a host sent as they were, before the line.
    fn record(&mut self, byte: u8) {
        if byte != 0 {
            self.frame.push(byte);
            return;
        }
        let frame = std::mem::take(&mut self.frame);
        let Some(bytes) = cobs::decode(&frame) else {
            return;
        };
        let [sequence, command, count, rest @ ..] = bytes.as_slice() else {
            return;
        };
        let number = |bytes: &[u8]| {
            bytes
                .iter()
                .rev()
                .fold(0, |number: u32, byte| number << 8 | u32::from(*byte))
        };
        let pairs: Vec<(u16, u32)> = match command {
            0x11 => {
                let address = number(&rest[..2]) as u16;
                let words = (0..usize::from(*count)).map(|at| number(&rest[2 + 4 * at..6 + 4 * at]));
                (address..).zip(words).collect()
            }
            0x13 => {
                let at = (0..usize::from(*count)).map(|at| &rest[6 * at..6 * at + 6]);
                at.map(|pair| (number(&pair[..2]) as u16, number(&pair[2..]))).collect()
            }
            _ => return,
        };
        // A repetition has the number of the request before it.
        if self
            .sent
            .last()
            .is_none_or(|last| last.sequence != *sequence || !last.open)
        {
            self.sent.push(Sent {
                sequence: *sequence,
                pairs,
                open: true,
            });
        }
    }

    fn host_byte(&mut self, byte: u8) -> io::Result<()> {
        if self.dies_at.is_some_and(|end| self.sent_bytes >= end) {
            return Err(ErrorKind::BrokenPipe.into());
        }
        self.sent_bytes += 1;
        self.record(byte);
        for carried in self.carry(byte) {
            if self.within(self.noise) && self.rng.random_range(0..8) == 0 {
                self.linked.bad_byte();
            }
            let reply = self
                .linked
                .byte(carried)
                .map_err(|error| io::Error::other(error.to_string()))?;
            for answer in reply {
                let carried = self.carry(answer);
                self.coming.extend(carried);
            }
        }
        self.last_byte = self.now();
        Ok(())
    }
}

/// The line, as a host has it.
struct Line(Rc<RefCell<World>>);

impl Write for Line {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut world = self.0.borrow_mut();
        bytes.iter().try_for_each(|byte| world.host_byte(*byte))?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Read for Line {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let mut world = self.0.borrow_mut();
        if world.coming.is_empty() {
            world
                .linked
                .idle(REPLY_CLOCKS)
                .map_err(|error| io::Error::other(error.to_string()))?;
            std::thread::sleep(READ);
            return Err(ErrorKind::TimedOut.into());
        }
        let count = bytes.len().min(world.coming.len());
        bytes
            .iter_mut()
            .zip(world.coming.drain(..count))
            .for_each(|(place, byte)| *place = byte);
        Ok(count)
    }
}

/// The machine of the campaign, with its stage behind a line.
pub(crate) struct Ground {
    bed: Bed,
    stage: StageHardware,
}

impl Ground {
    pub(crate) fn new() -> Result<Self, String> {
        let mut bed = Bed::of(|axis| {
            if let Some(limits) = &mut axis.limits {
                limits.watchdog_s = WATCHDOG_S;
            }
        })
        .map_err(|error| error.to_string())?;
        bed.machine.link = Some(LINK);
        bed.stage.config.machine_crc = Some(LINK.machine_crc);
        bed.component =
            posicast_model::rtl::component::Component::stage(&bed.stage.config).map_err(|error| error.to_string())?;
        let stage = StageHardware {
            of_machine: bed.stage.clone(),
            component: bed.component.clone(),
        };
        Ok(Self { bed, stage })
    }

    fn host(&self, world: &Rc<RefCell<World>>) -> Result<HostedStage<'_, Line>, HostError> {
        let options = LinkOptions {
            timeout: REPLY,
            attempts: 5,
        };
        HostedStage::open(
            Link::new(Line(Rc::clone(world)), options),
            &self.bed.machine,
            &self.stage,
        )
    }

    /// What a host does in its life: it switches on, moves, and switches off.
    fn life(&self, world: &Rc<RefCell<World>>, moves: &[HostMove; 2]) -> Result<(), HostError> {
        let mut host = self.host(world)?;
        host.switch_on(&[0, 1], true)?;
        host.move_axes(moves)?;
        host.switch_off(&[0, 1])
    }

    /// A servo thread: it writes the entries of the moves one by one, while they are played. Entry `late_at` comes `late_clocks` late;
    /// `None`: it does not come, nor do those after it. A point at the end would be a jump after a late entry, and is left out.
    fn servo(
        &self,
        world: &Rc<RefCell<World>>,
        moves: &[HostMove; 2],
        (late_at, late_clocks): (usize, Option<u64>),
    ) -> Result<(), HostError> {
        let mut host = self.host(world)?;
        host.switch_on(&[0, 1], true)?;
        let mut link = host.into_link();
        let map = self.bed.component.map();
        let address = |name: String| map.register(&name).map_or(0, |register| register.offset as u16);
        let names: Vec<&str> = self.bed.machine.axes.iter().map(|axis| axis.name.as_str()).collect();
        let mut plans = Vec::new();
        for (name, of) in names.iter().zip(moves) {
            let axis = &self.bed.machine.axes[of.axis];
            let start = link.read(address(format!("{name}_command_position")), 1)?[0] as i32;
            let counts = (of.distance * axis.loop_counts_per_file_unit()).round() as i32;
            let limits = TickLimits::of_axis(axis, &self.bed.machine.clock);
            let mut entries = plan_move(i64::from(start) << 24, start + 256 * counts, &limits).unwrap_or_default();
            entries.pop();
            plans.push(entries);
            // It goes on at the last velocity for three ticks.
            link.write_list(&[(address(format!("{name}_fifo_control")), 3 << 8 | 1)])?;
        }
        let longest = plans.iter().map(Vec::len).max().unwrap_or(0);
        let pairs = |at: usize| -> Vec<(u16, u32)> {
            let entries = names
                .iter()
                .zip(&plans)
                .filter_map(|(name, plan)| Some((name, plan.get(at)?)));
            let words = entries.flat_map(|(name, entry)| (address(format!("{name}_segment"))..).zip(entry.words()));
            words.collect()
        };
        let kicks: Vec<(u16, u32)> = names
            .iter()
            .map(|name| (address(format!("{name}_kick")), posicast_model::rtl::axis::KICK))
            .collect();
        // Two entries ahead, and the start.
        link.write_list(&[pairs(0), pairs(1)].concat())?;
        link.write_list(&[(address("start".to_owned()), 3)])?;
        let levels: Vec<u16> = names.iter().map(|name| address(format!("{name}_fifo"))).collect();
        for at in 2..longest {
            loop {
                link.write_list(&kicks)?;
                let words = link.read_list(&levels)?;
                if words.iter().all(|word| word & 0x7f < 2) {
                    break;
                }
            }
            if at == late_at {
                let Some(late) = late_clocks else {
                    break;
                };
                world
                    .borrow_mut()
                    .linked
                    .idle(late)
                    .map_err(|error| HostError::Link(io::Error::other(error.to_string()).into()))?;
            }
            link.write_list(&pairs(at))?;
        }
        // The thread lives on.
        for _ in 0..40 {
            link.write_list(&kicks)?;
            link.read_list(&levels)?;
        }
        let off: Vec<(u16, u32)> = names
            .iter()
            .map(|name| (address(format!("{name}_control")), 0))
            .collect();
        link.write_list(&off)?;
        Ok(())
    }

    /// Runs a case.
    pub(crate) fn run(&self, number: u64, seed: u64) -> Result<Outcome, String> {
        let kind = Kind::ALL[(number % Kind::ALL.len() as u64) as usize];
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed ^ number.wrapping_mul(0x9e37_79b9_7f4a_7c15));
        let bench = self.bed.bench(None, number).map_err(|error| error.to_string())?;
        let limit = address_limit(&self.bed.component);
        let linked = LinkedBench::new(bench, &LINK, &self.bed.machine.clock, limit);
        let counts = [0, 1].map(|_| rng.random_range(60..250_i64) * if rng.random::<bool>() { 1 } else { -1 });
        let moves = [0, 1].map(|axis| HostMove {
            axis,
            distance: counts[axis] as f64 / self.bed.machine.axes[axis].loop_counts_per_file_unit(),
            speed: None,
        });
        // A life without faults takes about this many bytes and clocks.
        let (bytes, clocks) = (rng.random_range(20..3000_u64), rng.random_range(20_000..1_500_000_u64));
        let lasts = rng.random_range(10_000..400_000_u64);
        let damaged = [40, 100, 300][rng.random_range(0..3)];
        let late = (rng.random_range(2..7_usize), rng.random_range(1_000..60_000_u64));
        let dies = matches!(kind, Kind::HostDies | Kind::HostRestarts | Kind::RestartWithBytes);
        let world = Rc::new(RefCell::new(World {
            linked,
            rng,
            damaged_one_in: if matches!(kind, Kind::Bytes | Kind::RestartWithBytes) {
                damaged
            } else {
                0
            },
            sent_bytes: 0,
            dies_at: dies.then_some(bytes),
            cut: match kind {
                Kind::Cut => Some([clocks, clocks + lasts]),
                Kind::CutForEver => Some([clocks, u64::MAX]),
                _ => None,
            },
            noise: (kind == Kind::Noise).then_some([clocks, clocks + lasts]),
            coming: Vec::new(),
            frame: Vec::new(),
            sent: Vec::new(),
            closed: 0,
            faults: 0,
            last_byte: 0,
        }));
        let first = match kind {
            Kind::Late => self.servo(&world, &moves, (late.0, Some(late.1))),
            Kind::Missing => self.servo(&world, &moves, (late.0, None)),
            _ => self.life(&world, &moves),
        };
        let mut alive = first.is_ok();
        let places = || [0, 1].map(|axis| world.borrow().linked.bench.plant(axis).count());
        let mut starts = [0; 2];
        close(&world, first.is_ok());
        if matches!(kind, Kind::HostRestarts | Kind::RestartWithBytes) {
            let pause = world.borrow_mut().rng.random_range(1_000..AFTER_CLOCKS);
            idle(&world, pause)?;
            {
                let mut world = world.borrow_mut();
                // What the dead host left on the line is lost with it.
                (world.dies_at, world.sent_bytes) = (None, 0);
                (world.frame, world.coming) = (Vec::new(), Vec::new());
            }
            // An axis that still moves is refused; the new host waits until the watchdog of its predecessor has stopped it.
            starts = places();
            let mut second = self.life(&world, &moves);
            if let Err(HostError::Busy(_) | HostError::Fault { .. }) = second {
                close(&world, true);
                idle(&world, AFTER_CLOCKS)?;
                starts = places();
                second = self.life(&world, &moves);
            }
            close(&world, second.is_ok());
            alive = second.is_ok();
        }
        let mut outcome = Outcome {
            kind,
            arrived: alive && !matches!(kind, Kind::Late | Kind::Missing),
            faults: world.borrow().faults,
            writes: 0,
            off_ticks: None,
            failures: Vec::new(),
        };
        if kind == Kind::None && !outcome.arrived {
            outcome.failures.push(format!(
                "without a fault: {}",
                first.err().map_or_else(String::new, |error| error.to_string())
            ));
        }
        self.after(&world, &mut outcome, (counts, starts))?;
        Ok(outcome)
    }

    /// Lets the machine come to rest without a host, and judges.
    fn after(
        &self,
        world: &Rc<RefCell<World>>,
        outcome: &mut Outcome,
        (counts, starts): ([i64; 2], [i64; 2]),
    ) -> Result<(), String> {
        let mut world = world.borrow_mut();
        let said = |error: posicast_testbench::Error| error.to_string();
        let mut off = None;
        for _ in 0..AFTER_CLOCKS / TICK_CLOCKS {
            let is_off = (0..2).all(|axis| !world.linked.bench.pins(axis).drive_enable);
            match (is_off, off) {
                (true, None) => off = Some(world.now()),
                (false, _) => off = None,
                _ => {}
            }
            world.linked.bench.clocks(TICK_CLOCKS).map_err(said)?;
        }
        let mut demand = |holds: bool, what: String| {
            if !holds {
                outcome.failures.push(what);
            }
        };
        demand(off.is_some(), "the outputs are still on".to_owned());
        let last_byte = world.last_byte;
        let late = off.map(|off| off.saturating_sub(last_byte) / TICK_CLOCKS);
        for axis in 0..2 {
            let name = &self.bed.machine.axes[axis].name;
            let bench = &world.linked.bench;
            let (watched, plant) = (*bench.watched(axis), bench.plant(axis));
            demand(plant.shorted_clocks() == 0, format!("{name}: both gates of a leg on"));
            demand(
                watched.gates_while_disabled == 0,
                format!("{name}: a gate on with the drive disabled"),
            );
            demand(
                watched.released_while_disabled == 0,
                format!("{name}: the brake released with the drive disabled"),
            );
            demand(
                watched.largest_count_error <= 1,
                format!("{name}: {} counts lost", watched.largest_count_error),
            );
            let at = plant.count();
            if outcome.arrived {
                let target = starts[axis] + counts[axis];
                demand(
                    (at - target).abs() <= ON_TARGET,
                    format!("{name}: at {at} instead of {target}"),
                );
            } else {
                // Two lives move at most twice.
                let ends = [0, counts[axis], 2 * counts[axis]];
                let lives = if matches!(outcome.kind, Kind::HostRestarts | Kind::RestartWithBytes) {
                    3
                } else {
                    2
                };
                let ends = &ends[..lives];
                let least = ends.iter().min().unwrap_or(&0) - BEYOND_COUNTS;
                let most = ends.iter().max().unwrap_or(&0) + BEYOND_COUNTS;
                demand(
                    (least..=most).contains(&at),
                    format!("{name}: at {at}, beyond {least} to {most}"),
                );
            }
            let state = bench.net(&format!("{name}_state")).map_err(said)? as u32;
            demand(
                [state::OFF, state::READY, state::FAULT].contains(&state),
                format!("{name}: state {state} at the end"),
            );
        }
        let by_itself = !outcome.arrived && !matches!(outcome.kind, Kind::Late | Kind::Missing);
        outcome.off_ticks = late.filter(|_| by_itself);
        outcome.writes = world.linked.writes.len();
        if let Err(what) = written(&world.sent, &world.linked.writes) {
            outcome.failures.push(what);
        }
        Ok(())
    }
}

/// A host has ended: with success, all of its requests were answered; else all but the last.
fn close(world: &Rc<RefCell<World>>, well: bool) {
    let mut world = world.borrow_mut();
    let (from, count) = (world.closed, world.sent.len());
    for (at, sent) in world.sent.iter_mut().enumerate().skip(from) {
        sent.open = at + 1 == count && !well;
    }
    world.closed = count;
    // The next host's first request is never taken for a repetition of this one's last.
    if let Some(last) = world.sent.last_mut()
        && last.open
    {
        last.sequence = 0;
    }
}

fn idle(world: &Rc<RefCell<World>>, clocks: u64) -> Result<(), String> {
    world
        .borrow_mut()
        .linked
        .idle(clocks)
        .map_err(|error| error.to_string())
}

/// Compares what reached the bus with what was sent: request by request, whole, once and in order.
fn written(sent: &[Sent], writes: &[(u16, u32)]) -> Result<(), String> {
    let mut rest = writes;
    for (number, request) in sent.iter().enumerate() {
        match rest.strip_prefix(request.pairs.as_slice()) {
            Some(behind) => rest = behind,
            None if request.open => {}
            None => {
                return Err(format!(
                    "request {number} of {} is not what was written: {:x?}",
                    sent.len(),
                    rest.first()
                ));
            }
        }
    }
    match rest {
        [] => Ok(()),
        [first, ..] => Err(format!(
            "{} words were written that nobody sent, first {first:x?}",
            rest.len()
        )),
    }
}

/// A wrong write must be found: the comparison is tried on writes that are doubled, missing, changed and exchanged.
pub(crate) fn comparison_finds_wrong_writes() {
    let sent = |pairs: &[(u16, u32)]| Sent {
        sequence: 1,
        pairs: pairs.to_vec(),
        open: false,
    };
    let all = [sent(&[(1, 5)]), sent(&[(2, 6), (3, 7)])];
    assert_eq!(written(&all, &[(1, 5), (2, 6), (3, 7)]), Ok(()));
    for wrong in [
        &[(1, 5), (1, 5), (2, 6), (3, 7)][..],
        &[(1, 5), (2, 6)],
        &[(1, 5), (2, 6), (3, 8)],
        &[(2, 6), (3, 7), (1, 5)],
        &[(1, 5), (2, 6), (3, 7), (3, 7)],
    ] {
        assert!(written(&all, wrong).is_err(), "{wrong:?}");
    }
}
