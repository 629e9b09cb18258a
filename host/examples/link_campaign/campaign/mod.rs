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
//! - **way**: no axis leaves the way between start and target, except by what it goes on where points are missing.

mod judge;
mod kind;
mod requests;
mod servo;
mod world;

pub(crate) use kind::{Kind, Outcome};
pub(crate) use requests::comparison_finds_wrong_writes;

use std::cell::RefCell;
use std::ops::Range;
use std::rc::Rc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

use posicast_blocks::component::Component;
use posicast_blocks::linked_stage::address_limit;
use posicast_closed_loop::fault_campaign::{Bed, TICK_CLOCKS};
use posicast_closed_loop::linked_bench::LinkedBench;
use posicast_host::{HostError, HostMove, HostedStage, Link, LinkOptions};
use posicast_machine::hardware::StageHardware;
use posicast_machine::machine_file::{LinkLine, LinkSection};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use judge::Course;
use servo::LatePoint;
use world::{Line, LineFaults, REPLY, World};

/// The line of the campaign.
const LINK: LinkSection = LinkSection {
    line: LinkLine::Uart { baud: 3_000_000 },
    timeout_s: 200e-6,
    machine_crc: 0x1234_5678,
};
/// Watchdog of the campaign's machine in s: 300 ticks.
const WATCHDOG_S: f64 = 6e-3;
/// Clocks after the last host in which the machine must have come to rest: the watchdog, a quick stop, the brake.
const AFTER_CLOCKS: u64 = 700 * TICK_CLOCKS;
/// Longest time for which an axis goes on at its last velocity if a point is missing.
const MOST_EXTRAPOLATION_TICKS: u32 = 12;

/// Runs cases on all cores, and returns their numbers and outcomes.
pub(crate) fn run(cases: Range<u64>, seed: u64) -> Result<Vec<(u64, Outcome)>, String> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let (next, all) = (AtomicU64::new(cases.start), Mutex::new(Vec::new()));
    let work = || -> Result<(), String> {
        let ground = Ground::new()?;
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            if number >= cases.end {
                return Ok(());
            }
            let outcome = ground.run(number, seed);
            let outcome = outcome.map_err(|error| format!("case {number}: {error}"))?;
            all.lock()
                .unwrap_or_else(PoisonError::into_inner)
                .push((number, outcome));
        }
    };
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        let mut ended = workers.into_iter().map(|worker| worker.join());
        ended.try_for_each(|worker| worker.unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
    })?;
    Ok(all.into_inner().unwrap_or_else(PoisonError::into_inner))
}

/// The machine of the campaign, with its stage behind a line.
struct Ground {
    bed: Bed,
    stage: StageHardware,
}

impl Ground {
    fn new() -> Result<Self, String> {
        let mut bed = Bed::of(|axis| {
            if let Some(limits) = &mut axis.limits {
                limits.watchdog_s = WATCHDOG_S;
            }
        })
        .map_err(|error| error.to_string())?;
        bed.machine.link = Some(LINK);
        bed.stage.config.machine_crc = Some(LINK.machine_crc);
        bed.component = Component::stage(&bed.stage.config).map_err(|error| error.to_string())?;
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

    /// Runs a case.
    fn run(&self, number: u64, seed: u64) -> Result<Outcome, String> {
        let kind = Kind::ALL[(number % Kind::ALL.len() as u64) as usize];
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed ^ number.wrapping_mul(0x9e37_79b9_7f4a_7c15));
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
        let late = LatePoint {
            place: rng.random(),
            clocks: (kind == Kind::Late).then_some(rng.random_range(10_000..60_000_u64)),
            extrapolation_ticks: rng.random_range(0..=MOST_EXTRAPOLATION_TICKS),
        };
        let damages = matches!(kind, Kind::Bytes | Kind::RestartWithBytes);
        let faults = LineFaults {
            damaged_one_in: if damages { damaged } else { 0 },
            cut: match kind {
                Kind::Cut => Some([clocks, clocks + lasts]),
                Kind::CutForEver => Some([clocks, u64::MAX]),
                _ => None,
            },
            noise: (kind == Kind::Noise).then_some([clocks, clocks + lasts]),
        };
        let dies = kind == Kind::HostDies || kind.restarts();
        let world = self.world(number, (faults, dies.then_some(bytes)), rng)?;
        let first = if kind.streams() {
            self.host(&world)
                .and_then(|host| servo::run(host, (&world, &self.bed.component), &moves, &late))
        } else {
            self.life(&world, &moves)
        };
        world.borrow_mut().requests.close(first.is_ok());
        let last = if kind.restarts() {
            self.restart(&world, &moves)?
        } else {
            first
        };
        let mut outcome = Outcome {
            kind,
            arrived: last.is_ok() && !kind.streams(),
            faults: world.borrow().faults,
            writes: 0,
            off_ticks: None,
            failures: Vec::new(),
        };
        if kind == Kind::None
            && let Err(error) = last
        {
            outcome.failures.push(format!("without a fault: {error}"));
        }
        let course = |axis: usize| Course::of(&self.bed.machine, &moves[axis]);
        judge::after(&mut world.borrow_mut(), &self.bed, &mut outcome, [course(0), course(1)])?;
        Ok(outcome)
    }

    /// The machine after reset, at its line.
    fn world(
        &self,
        number: u64,
        faults: (LineFaults, Option<u64>),
        rng: Xoshiro256PlusPlus,
    ) -> Result<Rc<RefCell<World>>, String> {
        let bench = self.bed.bench(None, number).map_err(|error| error.to_string())?;
        let limit = address_limit(&self.bed.component);
        let linked = LinkedBench::new(bench, &LINK, &self.bed.machine.clock, limit);
        let start = self.bed.component.map().register("start").ok_or("no START")?;
        Ok(Rc::new(RefCell::new(World::new(
            linked,
            faults,
            start.offset as u16,
            rng,
        ))))
    }

    /// Another host comes after a while, and lives the same life. An axis that still moves is refused to it; it then waits until the
    /// watchdog of its predecessor has stopped that axis.
    fn restart(&self, world: &Rc<RefCell<World>>, moves: &[HostMove; 2]) -> Result<Result<(), HostError>, String> {
        {
            let mut world = world.borrow_mut();
            let pause = world.rng.random_range(1_000..AFTER_CLOCKS);
            world.idle(pause)?;
            world.new_host();
        }
        let mut second = self.life(world, moves);
        if let Err(HostError::Busy(_) | HostError::Fault { .. }) = second {
            {
                let mut world = world.borrow_mut();
                world.requests.close(true);
                world.idle(AFTER_CLOCKS)?;
            }
            second = self.life(world, moves);
        }
        world.borrow_mut().requests.close(second.is_ok());
        Ok(second)
    }
}
