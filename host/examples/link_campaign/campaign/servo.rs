//! A servo thread: it writes a point per axis and period while the axes move, as a controller does that computes its path on the way.

use std::cell::RefCell;
use std::rc::Rc;

use posicast_blocks::axis::KICK;
use posicast_blocks::component::Component;
use posicast_blocks::segments::{CubicEntry, Entry, EntryMotion};
use posicast_host::{HostError, HostMove, HostedStage, LinkError};
use posicast_machine::machine_file::Machine;
use posicast_machine::motion::{Profile, TickLimits};

use super::world::{Line, World};

/// Ticks of a period. A point of both axes, a kick and a look at the FIFO take about 15 on the line.
const PERIOD_TICKS: u32 = 24;
/// Points that are written before the start; later so many wait or play. The shortest move has five.
const AHEAD: usize = 2;
/// Number of kicks after the last point: the thread lives on.
const KICKS_AFTER: usize = 40;
/// Value of START for both axes.
const BOTH: u32 = 3;
/// Low bits of `fifo`: the number of waiting entries.
const LEVEL: u32 = 0x7f;
/// In `fifo_control`: the place of the extrapolation, and the low-water mark.
const EXTRAPOLATION_LOW: u32 = 8;
const LOW_WATER: u32 = 1;

/// What fails in the thread: a point after those that are written before the start.
pub(super) struct LatePoint {
    /// Which one, modulo their number.
    pub(super) place: u32,
    /// It comes so many clocks late; `None`: neither it nor another one comes.
    pub(super) clocks: Option<u64>,
    /// Ticks for which an axis goes on at its last velocity if a point is missing.
    pub(super) extrapolation_ticks: u32,
}

/// Switches on, moves, and switches off.
pub(super) fn run(
    mut host: HostedStage<'_, Line>,
    (world, component): (&Rc<RefCell<World>>, &Component),
    moves: &[HostMove; 2],
    late: &LatePoint,
) -> Result<(), HostError> {
    host.switch_on(&[0, 1], true)?;
    let machine = host.machine();
    let mut link = host.into_link();
    let address = |name: String| {
        let register = component.map().register(&name);
        register.map_or(0, |register| register.offset as u16)
    };
    let of_axes = |register: &str| -> Vec<u16> {
        let names = machine.axes.iter().map(|axis| format!("{}_{register}", axis.name));
        names.map(address).collect()
    };
    let plans: Vec<Vec<Entry>> = moves.iter().map(|of| points(machine, of)).collect();
    let segments = of_axes("segment");
    let entries = |at: usize| -> Vec<(u16, u32)> {
        let axes = segments.iter().zip(&plans);
        let entries = axes.filter_map(|(address, plan)| Some((*address, plan.get(at)?.words())));
        entries.flat_map(|(address, words)| (address..).zip(words)).collect()
    };
    let to_all = |addresses: Vec<u16>, word: u32| -> Vec<(u16, u32)> {
        addresses.into_iter().map(|address| (address, word)).collect()
    };
    let kicks = to_all(of_axes("kick"), KICK);
    let levels = of_axes("fifo");
    let goes_on = late.extrapolation_ticks << EXTRAPOLATION_LOW | LOW_WATER;
    link.write_list(&to_all(of_axes("fifo_control"), goes_on))?;
    link.write_list(&[entries(0), entries(1)].concat())?;
    link.write_list(&[(address("start".to_owned()), BOTH)])?;
    let longest = plans.iter().map(Vec::len).max().unwrap_or(0);
    let late_at = AHEAD + late.place as usize % (longest - AHEAD);
    for at in AHEAD..longest {
        loop {
            link.write_list(&kicks)?;
            let words = link.read_list(&levels)?;
            if words.iter().all(|word| word & LEVEL < AHEAD as u32) {
                break;
            }
        }
        if at == late_at {
            let Some(clocks) = late.clocks else {
                break;
            };
            let idle = world.borrow_mut().idle(clocks);
            idle.map_err(|error| LinkError::from(std::io::Error::other(error)))?;
        }
        link.write_list(&entries(at))?;
    }
    for _ in 0..KICKS_AFTER {
        link.write_list(&kicks)?;
        link.read_list(&levels)?;
    }
    link.write_list(&to_all(of_axes("control"), 0))?;
    Ok(())
}

/// The fastest profile of a move within the limits of its axis, in counts and ticks from its start.
pub(super) fn profile(machine: &Machine, of: &HostMove) -> Profile {
    let axis = &machine.axes[of.axis];
    let limits = TickLimits::of_axis(axis, &machine.clock);
    let counts = (of.distance * axis.loop_counts_per_file_unit()).round();
    let profile = Profile::new(0.0, counts, limits.velocity, limits.acceleration, limits.jerk);
    profile.unwrap_or_else(|error| unreachable!("the limits of a machine file are positive: {error}"))
}

/// The entries of a move, one per period, and one at rest: the formulas of `docs/segments.md`, points of a controller. Each begins
/// where the one before ends, so that what is rounded in one is made good in the next.
fn points(machine: &Machine, of: &HostMove) -> Vec<Entry> {
    let profile = profile(machine, of);
    let n = f64::from(PERIOD_TICKS);
    let periods = (profile.duration_s() / n).ceil() as u32;
    let velocity = |tick: f64| profile.position(tick + 0.5) - profile.position(tick - 0.5);
    let mut at = posicast_blocks::segments::Integrator::default();
    let mut entries = Vec::new();
    for period in 1..=periods {
        let scale = 2f64.powi(32);
        let end = f64::from(period) * n;
        let distance = profile.position(end) - at.position as f64 / scale;
        let (from, to) = (at.velocity as f64 / scale, velocity(end));
        let jerk = 6.0 * ((n + 1.0) * (to - from) - 2.0 * (distance - n * from)) / ((n - 1.0) * n * (n + 1.0));
        let acceleration = (to - from) / n - jerk * (n - 1.0) / 2.0;
        let ramp = acceleration * n * (n - 1.0) / 2.0 + jerk * (n - 1.0) * n * (n + 1.0) / 6.0;
        let first = (distance - ramp) / n;
        let word = |value: f64, fraction: i32| (value * 2f64.powi(fraction)).round() as i32;
        let cubic = EntryMotion::Cubic(CubicEntry {
            jerk: word(jerk, 32),
            velocity: word(first, 16),
            acceleration: word(acceleration, 24),
        });
        for tick in 0..PERIOD_TICKS {
            // It fits: the velocity is that of a move within the limits.
            let _ = at.play(&cubic, tick == 0);
        }
        entries.push(Entry {
            ticks: PERIOD_TICKS,
            motion: cubic,
            notify: false,
        });
    }
    entries.push(Entry {
        ticks: 1,
        motion: EntryMotion::Cubic(CubicEntry::default()),
        notify: false,
    });
    entries
}
