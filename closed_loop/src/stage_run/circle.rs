//! A circle of two axes as points, which unequal delays distort.

use posicast_blocks::segments::{Entry, EntryMotion};
use posicast_machine::machine_file::{AxisSection, Machine};
use posicast_machine::motion::{TickLimits, plan_circle};
use posicast_machine::plant::axis::{ErrorFigures, contour_error};

use super::host::{Host, Trouble};
use super::{StageRun, StageRunError, moves};
use crate::stage_bench::{AxisSample, state};

/// Speed of the circle as a fraction of the slower axis's limit, where `[stage]` has no `contour_speed`.
const PART_OF_VELOCITY: f64 = 0.4;
/// Acceleration towards the centre as a fraction of the limit.
const PART_OF_ACCELERATION: f64 = 0.125;
/// Acceleration along the path as a fraction of the limit: together they stay below it.
const PART_ALONG_PATH: f64 = 0.5;
/// Points below this fraction of the speed are not compared: those at rest, and while starting and stopping.
const PART_OF_SPEED: f64 = 0.5;
/// Fraction of the travel that a circle may take.
const PART_OF_TRAVEL: f64 = 0.9;
/// Range of the position words in counts.
const LARGEST_COUNTS: u32 = 1 << 23;
/// Smallest radius in counts; below it, only the steps of the encoders would be visible.
const LEAST_RADIUS_COUNTS: f64 = 100.0;
/// Number of entries that a FIFO has room for when it signals that it is low.
const REFILL: usize = 40;
/// Number of entries that wait at the start.
const FIRST_FILL: usize = 60;
/// Ticks between two checks of the FIFOs: fewer than the entries left in one that is almost low.
const LOOK_TICKS: u64 = 8;
/// Number of ticks in addition to the plan.
const SPARE_TICKS: u64 = 1000;

/// A circle of the first two axes: once round, counter-clockwise, starting and ending at rest at its rightmost point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Circle {
    /// Radius in m.
    pub radius: f64,
    /// Speed in m/s.
    pub speed: f64,
    /// Acceleration along the path in m/s².
    acceleration: f64,
    /// Jerk along the path in m/s³.
    jerk: f64,
    /// 1, or −1 where the first axis has more room in its positive direction: the circle is then mirrored.
    side: f64,
}

/// Result of a circle.
#[derive(Debug, Clone, PartialEq)]
pub struct Circled {
    /// Distance of the load from the circle, along its radius, in m.
    pub error: ErrorFigures,
    /// Positions `(x, y)` of the load relative to the circle's centre, in m, at every tick in which the command has
    /// at least half the speed.
    pub points: Vec<(f64, f64)>,
    /// Set if the stage did not do what it should.
    pub trouble: Option<Trouble>,
    radius: f64,
}

/// Why a machine cannot drive a circle.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NoCircle {
    /// There are fewer than two axes.
    #[error("a circle needs two axes, but the machine has only one")]
    OneAxis,
    /// An axis is modulo, and turns without an end.
    #[error("axis {0} is modulo: it turns without end")]
    Modulo(String),
    /// No radius that the encoders resolve fits the travel.
    #[error(
        "the travel of axes {x} and {y} has room for a radius of {room}, but the smallest that their encoders resolve is {least}"
    )]
    NoRoom {
        /// Name of the first axis.
        x: String,
        /// Name of the second axis.
        y: String,
        /// Largest radius.
        room: String,
        /// Least radius.
        least: String,
    },
    /// The requested radius does not fit the travel.
    #[error("the travel of axes {x} and {y} has room for a radius of {room}, less than {radius}")]
    TooLarge {
        /// Name of the first axis.
        x: String,
        /// Name of the second axis.
        y: String,
        /// Requested radius.
        radius: String,
        /// Largest radius.
        room: String,
    },
    /// The encoders do not resolve the radius, whether it was requested or follows from the limits of the axes.
    #[error("its radius is {radius}, but the smallest that the encoders of axes {x} and {y} resolve is {least}")]
    TooSmall {
        /// Name of the first axis.
        x: String,
        /// Name of the second axis.
        y: String,
        /// The radius.
        radius: String,
        /// Smallest radius.
        least: String,
    },
}

impl Circle {
    /// A circle that suits the limits of the machine.
    ///
    /// # Errors
    /// [`NoCircle`] where the machine cannot drive one.
    pub fn of_machine(machine: &Machine) -> Result<Self, NoCircle> {
        Self::fitting(machine, None)
    }

    /// A circle with this radius in m, or rad.
    ///
    /// # Errors
    /// [`NoCircle`] where the machine cannot drive one, or the radius does not fit.
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

    /// Points of both axes, from where they stand.
    fn plan(&self, run: &StageRun<'_>, host: &mut Host<'_>) -> Result<[Vec<Entry>; 2], StageRunError> {
        let clock = &run.machine.clock;
        let mut of_axis = |index: usize| {
            let axis = &run.machine.axes[index];
            let unit = axis.loop_counts_per_unit();
            let limits = TickLimits::new(self.speed, self.acceleration, self.jerk, unit, clock.sample_hz);
            // The circle is planned from 0 and then moved to where the axis stands, so that mirroring is a sign.
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
        // With counts of different size the number of ticks may be rounded differently.
        let longer = x.len().max(y.len());
        for entries in [&mut x, &mut y] {
            let last = entries.last().copied();
            entries.extend(last.into_iter().cycle().take(longer - entries.len()));
        }
        Ok([x, y])
    }
}

impl Circled {
    /// Distance of the load outside the circle at each tick: direction from the centre in degrees, from 0 on without
    /// wrapping, and distance in m.
    pub fn distances(&self) -> Vec<(f64, f64)> {
        let mut turned = 0.0;
        let mut distances: Vec<(f64, f64)> = Vec::with_capacity(self.points.len());
        for (x, y) in &self.points {
            let degrees = y.atan2(*x).to_degrees();
            // The direction continues beyond a half turn instead of jumping back.
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

/// Streams the points of both axes, refilling the FIFOs as they ask for it, and waits for the end.
pub(super) fn stream(host: &mut Host<'_>, paths: &[Vec<Entry>; 2]) -> Result<Option<Trouble>, StageRunError> {
    stream_some(host, paths, true)
}

/// Streams points: if they are `whole`, it waits for the end; else it returns once all are written.
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
    if whole { Ok(host.arrive(SPARE_TICKS)?) } else { Ok(None) }
}

/// Drives the circle in the model.
pub(super) fn measure(run: &StageRun<'_>, mut host: Host<'_>, circle: &Circle) -> Result<Circled, StageRunError> {
    let mut trouble = host.switch_on()?;
    if trouble.is_none() {
        let paths = circle.plan(run, &mut host)?;
        trouble = stream(&mut host, &paths)?;
    }
    if trouble.is_none() {
        trouble = host.rest(moves::settle_ticks_of(run))?;
    }
    let samples = run.recorded(&mut host);
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

/// Positions of the load relative to the centre while it goes round.
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
    fn directions_go_on_and_distances_are_along_the_radius() {
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
