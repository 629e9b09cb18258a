//! What is required of a case.

use posicast_closed_loop::fault_campaign::{Bed, TICK_CLOCKS};
use posicast_closed_loop::stage_bench::state;
use posicast_host::HostMove;
use posicast_machine::machine_file::Machine;

use super::kind::Outcome;
use super::world::World;
use super::{AFTER_CLOCKS, servo};

/// Counts by which an axis may miss a place at which it was told to stand: the machine's friction holds it there.
const ON_PLACE: i64 = 2;
/// Low bit of the ticks that were extrapolated, in the register FIFO, and its bits.
const LATE_LOW: u32 = 16;
const LATE_MASK: u32 = 0xff;

/// The move of an axis.
pub(super) struct Course {
    /// Distance in counts.
    counts: i64,
    /// Counts per tick that it never exceeds: twice its mean, because the profile has at most the velocity of one without a stretch at
    /// constant velocity.
    fastest: f64,
}

impl Course {
    pub(super) fn of(machine: &Machine, of: &HostMove) -> Self {
        let profile = servo::profile(machine, of);
        let counts = profile.position(f64::INFINITY);
        Self {
            counts: counts as i64,
            fastest: 2.0 * counts.abs() / profile.duration_s(),
        }
    }

    /// Counts by which an axis may be beyond its way. A quick stop ends on the way: it decelerates by 800 m/s², as much as the path at
    /// its steepest. So what remains is what the axis went on while points were missing.
    fn beyond(&self, late_ticks: u32) -> i64 {
        ON_PLACE + (f64::from(late_ticks) * self.fastest).ceil() as i64
    }
}

/// Lets the machine come to rest without a host, and judges.
pub(super) fn after(world: &mut World, bed: &Bed, outcome: &mut Outcome, courses: [Course; 2]) -> Result<(), String> {
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
    let off = off.map(|off| off.saturating_sub(last_byte) / TICK_CLOCKS);
    let mut on_target = true;
    for (axis, course) in courses.iter().enumerate() {
        let name = &bed.machine.axes[axis].name;
        let late = world.linked.bench.read(&format!("{name}_fifo")).map_err(said)?;
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
        let beyond = course.beyond(late >> LATE_LOW & LATE_MASK);
        let target = world.starts[axis] + course.counts;
        on_target &= (at - target).abs() <= beyond;
        if outcome.arrived {
            demand(
                (at - target).abs() <= ON_PLACE,
                format!("{name}: at {at} instead of {target}"),
            );
        } else {
            // Two lives move at most twice.
            let lives = if outcome.kind.restarts() { 2 } else { 1 };
            let ends = (0..=lives).map(|life| life * course.counts);
            let (least, most) = ends.fold((0, 0), |(least, most), end| (end.min(least), end.max(most)));
            demand(
                (least - beyond..=most + beyond).contains(&at),
                format!("{name}: at {at}, beyond {least} to {most} by more than {beyond}"),
            );
        }
        let state = bench.net(&format!("{name}_state")).map_err(said)? as u32;
        demand(
            [state::OFF, state::READY, state::FAULT].contains(&state),
            format!("{name}: state {state} at the end"),
        );
    }
    if outcome.kind.streams() {
        // A thread does not know: it is the judge who looks.
        outcome.arrived = on_target;
    } else {
        outcome.off_ticks = off.filter(|_| !outcome.arrived);
    }
    outcome.writes = world.linked.writes.len();
    if let Err(what) = world.requests.are(&world.linked.writes) {
        outcome.failures.push(what);
    }
    Ok(())
}
