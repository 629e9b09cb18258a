//! Touches of a probe at the capture line: a host moves each axis to a contact, on the simulated machine.

use super::ClosedLoop;
use super::hosted::{linked, on_machine};
use crate::run::checks::Check;
use posicast_closed_loop::stage_run::StageRunError;
use posicast_closed_loop::touching::{Contact, LOOK_CLOCKS, Touching};
use posicast_host::{HostError, HostMove, HostedStage, Link, LinkOptions};
use posicast_machine::hardware::StageHardware;
use posicast_machine::machine_file::{AxisSection, CaptureEdge, CaptureSection, Machine};
use posicast_machine::motion::AxisMove;
use posicast_machine::plant::axis::PlantOptions;
use posicast_testbench::wording::counted;

/// A probing move is this part of the axis's default move, at this part of its velocity; the contact is half-way.
const PART: f64 = 0.1;
const SLOWER: f64 = 0.25;
/// Clocks from the edge to the capture beside the filter of the line, and the look that comes late.
const LATENCY_CLOCKS: u64 = 2 + LOOK_CLOCKS;
/// Ticks by which the position of an absolute encoder is older than the edge, at most: until the tick, and from there to the reading.
const READING_TICKS: u32 = 2;

/// Result of moving an axis to a contact.
pub(super) struct Touched {
    /// Index of the axis.
    axis: usize,
    /// What the probing move found; the error says why it found nothing.
    seen: Result<Seen, String>,
}

/// Counts of a touch.
struct Seen {
    /// Captured position, less where the machine was when the probe touched.
    off: i64,
    /// Most that latency and speed explain.
    allowed: i64,
}

/// Moves every axis to a contact of its own, each on a machine of its own; nothing without `[capture]`.
pub(super) fn all(machine: &Machine, stage: &StageHardware, seed: u64) -> Result<Vec<Touched>, StageRunError> {
    let Some(capture) = machine.capture else {
        return Ok(Vec::new());
    };
    let axes = 0..machine.axes.len();
    axes.map(|axis| one(machine, stage, seed, (axis, &capture))).collect()
}

fn one(
    machine: &Machine,
    stage: &StageHardware,
    seed: u64,
    (index, capture): (usize, &CaptureSection),
) -> Result<Touched, StageRunError> {
    let touched = |seen| Ok(Touched { axis: index, seen });
    let axis = &machine.axes[index];
    let by_default = match AxisMove::new(axis, &machine.fixed_point, None, None) {
        Ok(by_default) => by_default,
        Err(error) => return touched(Err(error.to_string())),
    };
    let (distance, speed) = (PART * by_default.distance, SLOWER * by_default.velocity);
    let count = (distance / 2.0 * axis.counts_per_unit).round() as i64;
    if count == 0 {
        return touched(Err("its move is shorter than two counts".to_owned()));
    }
    let per_clock = speed * axis.counts_per_unit / machine.clock.frequency_hz;
    let contact = Contact {
        axis: index,
        count,
        is_low: capture.edge == CaptureEdge::Falling,
        fastest: per_clock,
    };
    let bench = on_machine(machine, stage, |_| PlantOptions::default(), seed)?;
    let line = linked(Touching::new(bench, contact), machine, stage);
    let probed = || -> Result<Option<i64>, HostError> {
        let mut host = HostedStage::open(Link::new(line, LinkOptions::default()), machine, stage)?;
        host.switch_on(&[index], false)?;
        let began = host.status()?[index].position.round() as i64;
        let found = host.probe(HostMove {
            axis: index,
            distance: axis.unit.in_file(distance),
            speed: Some(axis.unit.in_file(speed)),
        })?;
        let captured = i64::from(found.found.positions[index]) - began;
        let touched_at = host.into_link().into_line().bench.touched_at();
        Ok(touched_at.map(|touched_at| captured - touched_at))
    };
    touched(match probed() {
        Ok(Some(off)) => Ok(Seen {
            off,
            allowed: allowed(machine, axis, capture, per_clock),
        }),
        Ok(None) => Err("the probe did not touch".to_owned()),
        Err(error) => Err(error.to_string()),
    })
}

/// Counts by which a captured position may differ from the touch, at this speed in counts per clock.
fn allowed(machine: &Machine, axis: &AxisSection, capture: &CaptureSection, per_clock: f64) -> i64 {
    let clock = &machine.clock;
    let line = LATENCY_CLOCKS + u64::from(capture.filter_clocks(clock));
    let reading = match &axis.encoder {
        Some(encoder) if encoder.absolute.is_some() => READING_TICKS * clock.clocks_per_sample(),
        _ => 0,
    };
    1 + (per_clock * (line + u64::from(reading)) as f64).ceil() as i64
}

impl ClosedLoop<'_> {
    /// The check of the capture line; `None` without `[capture]`.
    pub(super) fn touched(&self) -> Option<Check> {
        self.touched.first()?;
        let name = "the capture line takes the position at which a probe touches";
        let is_right = |touched: &Touched| touched.seen.as_ref().is_ok_and(|seen| seen.off.abs() <= seen.allowed);
        let said = |touched: &Touched| {
            let axis = &self.machine.axes[touched.axis].name;
            match &touched.seen {
                Ok(seen) => format!(
                    "axis {axis}: {} off, {} allowed",
                    counted(seen.off.unsigned_abs(), "count"),
                    seen.allowed
                ),
                Err(error) => format!("axis {axis}: {error}"),
            }
        };
        let all: Vec<String> = self.touched.iter().map(said).collect();
        Some(Check::new(name, self.touched.iter().all(is_right), all.join("; ")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use posicast_blocks::component::Component;
    use posicast_machine::plan::design_machine;
    use posicast_machine::{hardware, machine_file};

    #[test]
    fn a_touch_is_captured_to_the_count_and_a_line_of_the_wrong_level_is_refused() {
        let text = include_str!("../../../../examples/xy-stage.toml").to_owned() + "\n[capture]\nedge = \"falling\"\n";
        let machine = machine_file::parse("xy-stage.toml", &text).unwrap();
        let of_machine = hardware::stage(&machine, &design_machine(&machine).unwrap())
            .unwrap()
            .unwrap();
        let component = Component::stage(&of_machine.config).unwrap();
        let stage = StageHardware { of_machine, component };
        let capture = machine.capture.unwrap();
        let seen = |capture| one(&machine, &stage, 1, (0, &capture)).unwrap().seen;
        // At a quarter of 0.25 m/s it takes 800 clocks to a count: latency and look are less than one.
        let Seen { off, allowed } = seen(capture).unwrap();
        assert_eq!((off, allowed), (0, 2));
        let rising = CaptureSection {
            edge: CaptureEdge::Rising,
            ..capture
        };
        let error = seen(rising).err().unwrap();
        assert!(error.contains("the probe touches before the move"), "{error}");
    }
}
