//! The cost and the gain of a shaper in the move of a run: how much later the command arrives, and how much sooner the load rests.

use super::pictures::slowest_period_s;
use posicast_machine::machine_file::{AxisSection, Machine};
use posicast_machine::simulation::AxisSimulation;
use posicast_shaper::analysis::settled_from;
use schemars::JsonSchema;
use serde::Serialize;

/// Where the figures come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum GainSource {
    /// The stage with its controller on the simulated machine.
    ClosedLoop,
    /// The simulated machine, which follows its command exactly.
    OpenLoop,
}

/// The move of an axis with its shaper and without it. All times are in seconds since the command began to move.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub(crate) struct Gain {
    /// Where the figures come from.
    pub(crate) of: GainSource,
    /// One count, in `si_unit`: the load is at rest when it stays within ± this.
    pub(crate) band: f64,
    /// When the command arrives; null if it never moves.
    pub(crate) arrival_unshaped_s: Option<f64>,
    /// When the shaped command arrives.
    pub(crate) arrival_s: Option<f64>,
    /// What the shaper costs: `arrival_s - arrival_unshaped_s`.
    pub(crate) later_s: Option<f64>,
    /// From when on the load is at rest without the shaper; null if it is not seen at rest for a period of its slowest mode before the
    /// simulation ends.
    pub(crate) settled_unshaped_s: Option<f64>,
    /// From when on the load is at rest with the shaper.
    pub(crate) settled_s: Option<f64>,
    /// What the shaper gains: `settled_unshaped_s - settled_s`; negative if it loses.
    pub(crate) sooner_s: Option<f64>,
    /// When the simulation without the shaper ends.
    pub(crate) end_unshaped_s: f64,
    /// When the simulation with it ends.
    pub(crate) end_s: f64,
}

/// A move, sample by sample.
pub(super) struct Track<'a> {
    /// The command before the shaper.
    pub(super) command: &'a [f64],
    /// The command after it.
    pub(super) shaped: &'a [f64],
    /// Distance of the load from where it comes to rest, in the unit of `band`.
    pub(super) off: &'a [f64],
}

/// Number of the sample from which on a command stands still.
fn arrival(command: &[f64]) -> Option<usize> {
    let last = command.last()?;
    command.iter().rposition(|value| value != last).map(|moving| moving + 1)
}

/// Number of the sample at which a command begins to move.
fn begin(command: &[f64]) -> usize {
    let first = command.first();
    command.iter().position(|value| Some(value) != first).unwrap_or(0)
}

impl Gain {
    /// Computes the figures of two moves with the same command. A load counts as at rest only if it stays in the band for a whole period of
    /// its slowest mode.
    pub(super) fn new(
        of: GainSource,
        band: f64,
        sample_hz: f64,
        period_s: f64,
        unshaped: &Track<'_>,
        shaped: &Track<'_>,
    ) -> Self {
        let seconds = |track: &Track<'_>, sample: usize| (sample as f64 - begin(track.command) as f64) / sample_hz;
        let settled = |track: &Track<'_>| {
            arrival(shaped.command)?;
            let first = settled_from(track.off, band)?.max(begin(track.command));
            let is_seen = (track.off.len() - first) as f64 >= period_s * sample_hz;
            is_seen.then(|| seconds(track, first))
        };
        let difference = |a: Option<f64>, b: Option<f64>| Some(a? - b?);
        let arrival_unshaped_s = arrival(shaped.command).map(|sample| seconds(shaped, sample));
        let arrival_s = arrival(shaped.shaped).map(|sample| seconds(shaped, sample));
        let (settled_unshaped_s, settled_s) = (settled(unshaped), settled(shaped));
        Self {
            of,
            band,
            arrival_unshaped_s,
            arrival_s,
            later_s: difference(arrival_s, arrival_unshaped_s),
            settled_unshaped_s,
            settled_s,
            sooner_s: difference(settled_unshaped_s, settled_s),
            end_unshaped_s: seconds(unshaped, unshaped.off.len()),
            end_s: seconds(shaped, shaped.off.len()),
        }
    }

    /// The figures of an axis that follows its command exactly.
    pub(super) fn open_loop(machine: &Machine, axis: &AxisSection, words: &[i64], run: &AxisSimulation) -> Self {
        let counts = f64::from(machine.fixed_point.command_fraction).exp2() * axis.loop_counts_per_unit();
        let target = run.shaped.last().map_or(0.0, |word| *word as f64);
        let off = |positions: &[f64]| positions.iter().map(|at| (at - target) / counts).collect::<Vec<_>>();
        let command: Vec<f64> = words.iter().map(|word| *word as f64).collect();
        let shaped: Vec<f64> = run.shaped.iter().map(|word| *word as f64).collect();
        let [without, with] = [off(&run.position_unshaped), off(&run.position)];
        Self::new(
            GainSource::OpenLoop,
            1.0 / axis.loop_counts_per_unit(),
            machine.clock.sample_hz,
            slowest_period_s(axis),
            &Track {
                command: &command,
                shaped: &command,
                off: &without,
            },
            &Track {
                command: &command,
                shaped: &shaped,
                off: &with,
            },
        )
    }
}

/// The gain of each axis: in the closed loop if there is one, otherwise on the machine alone.
pub(super) fn of_axes(
    machine: &Machine,
    words: &[Vec<i64>],
    runs: &[AxisSimulation],
    in_loop: impl Fn(usize) -> Option<Gain>,
) -> Vec<Gain> {
    let axes = machine.axes.iter().zip(words).zip(runs).enumerate();
    axes.map(|(index, ((axis, words), run))| {
        in_loop(index).unwrap_or_else(|| Gain::open_loop(machine, axis, words, run))
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Gain for a ramp of 10 samples, after which the load swings by these amounts, 8 samples per period, halving in each.
    fn gain(swings: [f64; 2], samples: usize) -> Gain {
        let ramp = |delay: usize| {
            (0..samples)
                .map(move |n| (n.saturating_sub(delay + 5)).min(10) as f64)
                .collect::<Vec<_>>()
        };
        let (command, late) = (ramp(0), ramp(4));
        let off = |command: &[f64], swing: f64| {
            let swung = command.iter().enumerate().map(|(n, at)| {
                let after = n as f64 - 15.0;
                at - 10.0
                    + if after > 0.0 {
                        swing * 0.5f64.powf(after / 8.0) * (std::f64::consts::TAU * after / 8.0).cos()
                    } else {
                        0.0
                    }
            });
            swung.collect::<Vec<_>>()
        };
        let [without, with] = [off(&command, swings[0]), off(&late, swings[1])];
        Gain::new(
            GainSource::OpenLoop,
            0.5,
            1000.0,
            8e-3,
            &Track {
                command: &command,
                shaped: &command,
                off: &without,
            },
            &Track {
                command: &command,
                shaped: &late,
                off: &with,
            },
        )
    }

    #[test]
    fn the_cost_is_the_later_arrival_and_the_gain_the_earlier_rest() {
        // The ramp begins after sample 5 and ends 10 samples later. The envelope of the swing is 4 · 2^(−n/8): after the peak of −0.5·√½·4
        // = 1.41 at n = 12 it is 1 at 16, 0.71 at 20, and 0.5, which is in the band, at 24.
        let gain = gain([4.0, 0.0], 100);
        assert_eq!((gain.arrival_unshaped_s, gain.arrival_s), (Some(9e-3), Some(13e-3)));
        assert!((gain.later_s.unwrap() - 4e-3).abs() < 1e-12, "{gain:?}");
        let (without, with) = (gain.settled_unshaped_s.unwrap(), gain.settled_s.unwrap());
        assert!((28e-3..=33e-3).contains(&without), "{gain:?}");
        assert_eq!(with, 13e-3);
        assert_eq!(gain.sooner_s, Some(without - with));
    }

    #[test]
    fn a_load_not_seen_at_rest_for_a_period_has_not_settled() {
        let gain = gain([4.0, 0.0], 40);
        assert_eq!((gain.settled_unshaped_s, gain.sooner_s), (None, None));
        assert!(gain.settled_s.is_some() && gain.end_unshaped_s > 33e-3, "{gain:?}");
    }
}
