//! A circle of two axes, point by point: what unequal delays bend.

use posicast_model::machine_file::{AxisSection, Machine};
use posicast_model::motion::{TickLimits, plan_circle};
use posicast_model::plant::axis::{ErrorFigures, contour_error};
use posicast_model::rtl::segments::{Entry, EntryMotion};

use super::host::{Host, Trouble};
use super::{StageRun, StageRunError, moves};
use crate::stage_bench::{AxisSample, state};

/// Speed of the circle as a part of the slower axis's limit, where `[stage]` has no `contour_speed`.
const PART_OF_VELOCITY: f64 = 0.4;
/// The same of acceleration, towards the centre.
const PART_OF_ACCELERATION: f64 = 0.125;
/// The same along the path: together they stay below the limit.
const PART_ALONG_PATH: f64 = 0.5;
/// Part of the speed from which on a place counts: what happens at rest, and on the way from and to it, is a move's business.
const PART_OF_SPEED: f64 = 0.5;
/// The same of the room in the travel.
const PART_OF_TRAVEL: f64 = 0.9;
/// Counts that the position's words reach.
const LARGEST_COUNTS: u32 = 1 << 23;
/// Least radius in counts, below which steps of the encoders are all that is seen.
const LEAST_RADIUS_COUNTS: f64 = 100.0;
/// Entries that a FIFO holds beside those that it may still have when it calls itself low.
const REFILL: usize = 40;
/// Entries that wait at the start.
const FIRST_FILL: usize = 60;
/// Ticks between two looks at the FIFOs: fewer than entries are left in one that is almost low.
const LOOK_TICKS: u64 = 8;
/// Ticks beyond the plan.
const SPARE_TICKS: u64 = 1000;

/// A circle of the first two axes, once round, counter-clockwise, from rest at its right end to rest there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Circle {
    /// m.
    pub radius: f64,
    /// m/s.
    pub speed: f64,
    /// m/s² along the path.
    acceleration: f64,
    /// m/s³ along the path.
    jerk: f64,
    /// 1, or −1 where the first axis has more room on its positive side: then it is mirrored.
    side: f64,
}

/// A circle and what came of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Circled {
    /// The load's distance from the circle, along its radius, in m.
    pub error: ErrorFigures,
    /// The load's places `(x, y)` from the circle's centre, in m, at every tick in which the command goes at half the speed or
    /// faster.
    pub points: Vec<(f64, f64)>,
    /// What the stage did not do.
    pub trouble: Option<Trouble>,
    radius: f64,
}

/// Why a machine drives no circle.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NoCircle {
    /// Less than two axes.
    #[error("it takes two axes, and the machine has one")]
    OneAxis,
    /// An axis that turns round and round.
    #[error("axis {0} is modulo: it turns round and round")]
    Modulo(String),
    /// No radius that the encoders see fits the travel.
    #[error(
        "the travel of axes {x} and {y} has room for a radius of {room}, and {least} is the least that their encoders tell"
    )]
    NoRoom {
        /// The first axis.
        x: String,
        /// The second.
        y: String,
        /// Largest radius.
        room: String,
        /// Least radius.
        least: String,
    },
    /// A radius that was asked for does not fit the travel.
    #[error("the travel of axes {x} and {y} has room for a radius of {room}, less than {radius}")]
    TooLarge {
        /// The first axis.
        x: String,
        /// The second.
        y: String,
        /// The radius.
        radius: String,
        /// Largest radius.
        room: String,
    },
    /// A radius that the encoders do not see: of the limits of the axes, or asked for.
    #[error("its radius is {radius}, and {least} is the least that the encoders of axes {x} and {y} tell")]
    TooSmall {
        /// The first axis.
        x: String,
        /// The second.
        y: String,
        /// The radius.
        radius: String,
        /// Least radius.
        least: String,
    },
}

impl Circle {
    /// A circle that suits the limits of the machine.
    ///
    /// # Errors
    /// [`NoCircle`] where there is none.
    pub fn of_machine(machine: &Machine) -> Result<Self, NoCircle> {
        Self::fitting(machine, None)
    }

    /// The same with a radius in m, or rad.
    ///
    /// # Errors
    /// [`NoCircle`], also where the radius does not fit.
    pub fn with_radius(machine: &Machine, radius: f64) -> Result<Self, NoCircle> {
        Self::fitting(machine, Some(radius))
    }

    fn fitting(machine: &Machine, asked: Option<f64>) -> Result<Self, NoCircle> {
        let [x, y, ..] = machine.axes.as_slice() else {
            return Err(NoCircle::OneAxis);
        };
        let of_axes = [x, y];
        if let Some(axis) = of_axes.into_iter().find(|axis| axis.modulo) {
            return Err(NoCircle::Modulo(axis.name.clone()));
        }
        let per_s = |axis: &AxisSection| {
            let limits = TickLimits::of_axis(axis, &machine.clock);
            let [unit, hz] = [axis.loop_counts_per_unit(), machine.clock.sample_hz];
            [
                limits.velocity * hz / unit,
                limits.acceleration * hz.powi(2) / unit,
                limits.jerk * hz.powi(3) / unit,
            ]
        };
        let (of_x, of_y) = (per_s(x), per_s(y));
        let [velocity, acceleration, jerk] = std::array::from_fn(|limit| f64::min(of_x[limit], of_y[limit]));
        let wanted = machine.stage.and_then(|stage| stage.contour_speed);
        let speed = wanted.unwrap_or(PART_OF_VELOCITY * velocity).min(velocity);
        let towards_centre = PART_OF_ACCELERATION * acceleration;
        let travel = |axis: &AxisSection| {
            let travel = axis.limits.and_then(|limits| limits.travel);
            travel.map_or([f64::INFINITY; 2], |[low, high]| [-low, high].map(|room| room.max(0.0)))
        };
        let ([left, right], [below, above]) = (travel(x), travel(y));
        let of_words = f64::from(LARGEST_COUNTS) / x.loop_counts_per_unit().max(y.loop_counts_per_unit());
        let room = PART_OF_TRAVEL * (left.max(right).min(of_words) / 2.0).min(below.min(above));
        let towards_speed = speed * speed / towards_centre;
        let radius = asked.unwrap_or(towards_speed.min(room));
        let circle = Self {
            radius,
            speed: speed.min((towards_centre * radius).sqrt()),
            acceleration: PART_ALONG_PATH * acceleration,
            jerk,
            side: if right > left { -1.0 } else { 1.0 },
        };
        let least = LEAST_RADIUS_COUNTS / x.loop_counts_per_unit().min(y.loop_counts_per_unit());
        if radius >= least && radius <= room {
            return Ok(circle);
        }
        let (too_large, no_room) = (radius > room, room < least);
        let [x_name, y_name] = of_axes.map(|axis| axis.name.clone());
        let [radius, room, least] = [radius, room, least].map(|length| x.unit.show_round(length, ""));
        Err(match (no_room, too_large) {
            (true, _) => NoCircle::NoRoom {
                x: x_name,
                y: y_name,
                room,
                least,
            },
            (false, true) => NoCircle::TooLarge {
                x: x_name,
                y: y_name,
                radius,
                room,
            },
            (false, false) => NoCircle::TooSmall {
                x: x_name,
                y: y_name,
                radius,
                least,
            },
        })
    }

    /// The points of both axes, from where they stand.
    fn plan(&self, run: &StageRun<'_>, host: &mut Host<'_>) -> Result<[Vec<Entry>; 2], StageRunError> {
        let clock = &run.machine.clock;
        let mut of_axis = |index: usize| {
            let axis = &run.machine.axes[index];
            let unit = axis.loop_counts_per_unit();
            let limits = TickLimits::new(self.speed, self.acceleration, self.jerk, unit, clock.sample_hz);
            // Planned from 0, then moved to where the axis stands, so that a mirror is a sign.
            let planned = plan_circle([0, 0], self.radius * unit, 1.0, &limits);
            let [x, y] = planned.map_err(|source| StageRunError::Plan {
                axis: axis.name.clone(),
                source,
            })?;
            let start = host.command(index)?;
            let (entries, sign) = if index == 0 { (x, self.side as i32) } else { (y, 1) };
            let placed = entries.into_iter().map(|entry| match entry.motion {
                EntryMotion::Point(mut point) => {
                    point.position = start.saturating_add(sign * point.position);
                    point.velocity *= sign;
                    point.acceleration *= sign;
                    Entry {
                        motion: EntryMotion::Point(point),
                        ..entry
                    }
                }
                EntryMotion::Jerk(_) | EntryMotion::Cubic(_) => entry,
            });
            Ok::<Vec<Entry>, StageRunError>(placed.collect())
        };
        let (mut x, mut y) = (of_axis(0)?, of_axis(1)?);
        // Counts of different size may round the number of ticks differently.
        let longer = x.len().max(y.len());
        for entries in [&mut x, &mut y] {
            let last = entries.last().copied();
            entries.extend(last.into_iter().cycle().take(longer - entries.len()));
        }
        Ok([x, y])
    }
}

impl Circled {
    /// How far the load is outside of the circle, at each tick: direction from the centre in degrees, from 0 on and on, and
    /// distance in m.
    pub fn distances(&self) -> Vec<(f64, f64)> {
        let mut turned = 0.0;
        let mut distances: Vec<(f64, f64)> = Vec::with_capacity(self.points.len());
        for (x, y) in &self.points {
            let degrees = y.atan2(*x).to_degrees();
            // The direction goes on beyond a half turn instead of jumping back.
            turned += (degrees - turned + 180.0).rem_euclid(360.0) - 180.0;
            distances.push((turned, x.hypot(*y) - self.radius));
        }
        distances
    }
}

/// Writes the next entries to the FIFOs of both axes.
fn write(
    host: &mut Host<'_>,
    paths: &[Vec<Entry>; 2],
    written: &mut [usize; 2],
    axis: usize,
    entries: usize,
) -> Result<(), StageRunError> {
    let path = &paths[axis];
    let end = (written[axis] + entries).min(path.len());
    let name = host.config.axes[axis].name.clone();
    for entry in &path[written[axis]..end] {
        host.bench.segment(&name, entry)?;
    }
    written[axis] = end;
    Ok(())
}

/// Streams the points of both axes, refilling as the FIFOs ask for it, and waits for their end.
pub(super) fn stream(host: &mut Host<'_>, paths: &[Vec<Entry>; 2]) -> Result<Option<Trouble>, StageRunError> {
    stream_some(host, paths, true)
}

/// The same; where the points are `whole`, it waits for their end, else it ends once all are written.
pub(super) fn stream_some(
    host: &mut Host<'_>,
    paths: &[Vec<Entry>; 2],
    whole: bool,
) -> Result<Option<Trouble>, StageRunError> {
    let mut written = [0, 0];
    for axis in 0..2 {
        write(host, paths, &mut written, axis, FIRST_FILL)?;
    }
    host.bench.record();
    if let Some(trouble) = host.start(&[0, 1])? {
        return Ok(Some(trouble));
    }
    while written[0] < paths[0].len() || written[1] < paths[1].len() {
        host.pass(LOOK_TICKS * host.tick_clocks())?;
        for axis in 0..2 {
            if host.state(axis)? != state::RUN {
                return Ok(Some(host.trouble(axis, "played the path")?));
            }
            let name = host.config.axes[axis].name.clone();
            if host.bench.field(&name, "fifo", "fifo_low")? != 0 {
                write(host, paths, &mut written, axis, REFILL)?;
            }
        }
    }
    match whole {
        true => Ok(host.arrive(SPARE_TICKS)?),
        false => Ok(None),
    }
}

/// The circle in the model.
pub(super) fn measure(run: &StageRun<'_>, mut host: Host<'_>, circle: &Circle) -> Result<Circled, StageRunError> {
    let mut trouble = host.switch_on()?;
    if trouble.is_none() {
        let paths = circle.plan(run, &mut host)?;
        trouble = stream(&mut host, &paths)?;
    }
    if trouble.is_none() {
        trouble = host.rest(moves::settle_ticks(run))?;
    }
    let samples = host.bench.recorded();
    let points = match samples.as_slice() {
        [x, y, ..] => places(run, circle, x, y),
        _ => Vec::new(),
    };
    Ok(Circled {
        error: contour_error(&points, (0.0, 0.0), circle.radius),
        points,
        trouble,
        radius: circle.radius,
    })
}

/// Where the load is from the centre while it goes round.
fn places(run: &StageRun<'_>, circle: &Circle, x: &[AxisSample], y: &[AxisSample]) -> Vec<(f64, f64)> {
    let units = [0, 1].map(|axis| run.machine.axes[axis].loop_counts_per_unit());
    let slowest = PART_OF_SPEED * circle.speed / run.machine.clock.sample_hz;
    let ticks = x.windows(2).zip(y.windows(2));
    let moving = ticks.filter_map(|(x, y)| {
        let step = |of: &[AxisSample], unit: f64| (of[1].command - of[0].command) / unit;
        let moves = step(x, units[0]).hypot(step(y, units[1])) >= slowest;
        moves.then_some((circle.side * x[1].load + circle.radius, y[1].load))
    });
    moving.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_directions_go_on_and_distances_are_along_the_radius() {
        let quarter = |turn: f64| {
            let (y, x) = (turn * std::f64::consts::FRAC_PI_2).sin_cos();
            (2.1 * x, 2.1 * y)
        };
        let circled = Circled {
            error: ErrorFigures::default(),
            points: (0..6).map(|turn| quarter(f64::from(turn))).collect(),
            trouble: None,
            radius: 2.0,
        };
        for (turn, (degrees, distance)) in circled.distances().into_iter().enumerate() {
            assert!((degrees - 90.0 * turn as f64).abs() < 1e-9, "{degrees}");
            assert!((distance - 0.1).abs() < 1e-9, "{distance}");
        }
    }
}
