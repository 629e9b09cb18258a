//! Pulses of a position compare: a host arms each, moves its axis over a part of its row, and counts.

use super::ClosedLoop;
use super::hosted::behind_a_line;
use crate::run::checks::Check;
use posicast_closed_loop::stage_run::StageRunError;
use posicast_host::{HostError, HostMove, HostedStage, Link, LinkOptions};
use posicast_machine::hardware::StageHardware;
use posicast_machine::machine_file::{AxisSection, CompareDirection, CompareSection, Machine};
use posicast_machine::plant::axis::PlantOptions;
use posicast_testbench::wording::counted;

/// The move passes this many positions at most.
const MOST_POSITIONS: u32 = 500;
/// Below this distance of two positions the last counts of a move may pass one more than once.
const FAR_COUNTS: f64 = 8.0;

/// Result of moving an axis over positions of its compare.
pub(super) struct Pulsed {
    /// Index of the axis.
    axis: usize,
    /// Positions on the way, and pulses; the error says why there are none.
    seen: Result<(u32, u32), String>,
}

/// A way over some positions of a row, in m or rad from where the axis stands: to its beginning, then over them.
struct Way {
    begins: f64,
    over: f64,
    positions: u32,
}

/// Moves every axis that has a position compare, each on a machine of its own.
pub(super) fn all(machine: &Machine, stage: &StageHardware, seed: u64) -> Result<Vec<Pulsed>, StageRunError> {
    let axes = machine.axes.iter().enumerate();
    let with = axes.filter_map(|(index, axis)| Some((index, axis, axis.compare?)));
    with.map(|(index, axis, compare)| one(machine, stage, seed, (index, axis, compare)))
        .collect()
}

fn one(
    machine: &Machine,
    stage: &StageHardware,
    seed: u64,
    (index, axis, compare): (usize, &AxisSection, CompareSection),
) -> Result<Pulsed, StageRunError> {
    let pulsed = |seen| Ok(Pulsed { axis: index, seen });
    let Some(way) = way(axis, &compare) else {
        return pulsed(Err("no position is within its travel".to_owned()));
    };
    let line = behind_a_line(machine, stage, |_| PlantOptions::default(), seed)?;
    let moves = || -> Result<(u32, u32), HostError> {
        let mut host = HostedStage::open(Link::new(line, LinkOptions::default()), machine, stage)?;
        host.switch_on(&[index], false)?;
        let shift = |distance: f64| HostMove {
            axis: index,
            distance: axis.unit.in_file(distance),
            speed: None,
        };
        host.move_axes(&[shift(way.begins)])?;
        host.arm_compare(index, None)?;
        host.move_axes(&[shift(way.over)])?;
        Ok((way.positions, host.compare_state(index)?.passes))
    };
    pulsed(moves().map_err(|error| error.to_string()))
}

/// The way over the positions within the travel, from and to the middle between two positions; `None` if there are none.
fn way(axis: &AxisSection, compare: &CompareSection) -> Option<Way> {
    let travel = axis.limits.as_ref().and_then(|limits| limits.travel);
    let [low, high] = travel.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
    let half = compare.spacing / 2.0;
    let left_out = ((low - (compare.first - half)) / compare.spacing).ceil().max(0.0);
    let begins = compare.first - half + left_out * compare.spacing;
    let reached = ((high - begins) / compare.spacing).floor();
    let positions = reached.min(f64::from(compare.positions) - left_out);
    let positions = positions.min(f64::from(MOST_POSITIONS));
    if positions < 1.0 {
        return None;
    }
    let over = positions * compare.spacing;
    let positions = positions as u32;
    Some(match compare.direction {
        CompareDirection::Down => Way {
            begins: begins + over,
            over: -over,
            positions,
        },
        CompareDirection::Up | CompareDirection::Both => Way {
            begins,
            over,
            positions,
        },
    })
}

impl ClosedLoop<'_> {
    /// The check of the position compares; `None` if there is none.
    pub(super) fn pulsed(&self) -> Option<Check> {
        let name = "a position compare gives as many pulses as it passes positions";
        let axis = |pulsed: &Pulsed| &self.machine.axes[pulsed.axis];
        let exact = |pulsed: &Pulsed| {
            let of = axis(pulsed);
            let spacing = of.compare.map_or(0.0, |compare| compare.spacing * of.counts_per_unit);
            spacing >= FAR_COUNTS
        };
        let is_right = |pulsed: &Pulsed| match pulsed.seen {
            Ok((positions, pulses)) if exact(pulsed) => pulses == positions,
            Ok((positions, pulses)) => pulses >= positions,
            Err(_) => false,
        };
        let said = |pulsed: &Pulsed| {
            let name = &axis(pulsed).name;
            match &pulsed.seen {
                Ok((positions, pulses)) => format!(
                    "axis {name}: {} on the way over {}{}",
                    counted((*pulses).into(), "pulse"),
                    counted((*positions).into(), "position"),
                    if exact(pulsed) {
                        ""
                    } else {
                        ", which are so near that the axis may pass one again"
                    }
                ),
                Err(error) => format!("axis {name}: {error}"),
            }
        };
        self.pulsed.first()?;
        let all: Vec<String> = self.pulsed.iter().map(said).collect();
        Some(Check::new(name, self.pulsed.iter().all(is_right), all.join("; ")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use posicast_machine::machine_file;

    fn scan(from: &str, to: &str) -> AxisSection {
        let text = include_str!("../../../../examples/line-scan.toml").replacen(from, to, 1);
        machine_file::parse("line-scan.toml", &text).unwrap().axes.remove(0)
    }

    fn of(axis: &AxisSection) -> Option<(i64, i64, u32)> {
        let way = way(axis, &axis.compare.unwrap())?;
        let micrometres = |length: f64| (length * 1e6).round() as i64;
        Some((micrometres(way.begins), micrometres(way.over), way.positions))
    }

    #[test]
    fn the_way_lies_within_the_travel_and_begins_between_two_positions() {
        assert_eq!(of(&scan("", "")), Some((-40_005, 5_000, 500)));
        assert_eq!(of(&scan("\"both\"", "\"down\"")), Some((-35_005, -5_000, 500)));
        assert_eq!(of(&scan("positions = 8_001", "positions = 3")), Some((-40_005, 30, 3)));
        assert_eq!(of(&scan("first = -40 ", "first = 49.98 ")), Some((49_975, 20, 2)));
        assert_eq!(
            of(&scan("first = -40 ", "first = -50.02 ")),
            Some((-49_995, 5_000, 500))
        );
        assert_eq!(of(&scan("first = -40 ", "first = 51 ")), None);
    }
}
