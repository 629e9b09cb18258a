//! The coupling of a stage's axes: they start in one clock, and when one stops for a fault, all do.
//!
//! ```text
//! clock            0   1   2
//! start           ‾‾‾\_________   with the axes in start_axes
//! axis_start_k    ____/‾‾‾\____   of all of them in one clock, if all show can_start; else
//! start_refused   ____/‾‾‾\____   and none starts
//! ```
//!
//! - `group_stop_k`: another axis wants all axes to stop. `group_emergency_stop`: an axis has its emergency stop.
//!   Both come a clock late.
//! - Feed hold: the axes of `feed_hold_k` are held by `hold_feed_k` while all of them rest. So they stand in the same
//!   tick or not at all, and continue in the same tick. It comes a clock late.
//! - A start of no axis, or of an axis that does not exist, is refused.

use super::{ClockedBlock, FOREVER, Moore, Port, StepError, ports, show_each};

/// Number of lists of inputs with a port per axis.
const LISTS: usize = 5;

/// Largest number of axes of a stage.
pub const MOST_AXES: usize = 4;

ports! {
    group_ports(N);

    inputs {
        /// Synchronous reset.
        rst: Bit;
        /// One clock: the axes in `start_axes` shall start.
        start: Bit;
        /// Axes to start, one bit per axis.
        start_axes: Bits(4);
        /// `can_start` of the axis.
        can_start[N]: Bit;
        /// `wants_group_stop` of the axis.
        wants_group_stop[N]: Bit;
        /// `emergency_stop` of the axis.
        emergency_stop[N]: Bit;
        /// The axis shall hold its feed.
        feed_hold[N]: Bit;
        /// `rests` of the axis's segments.
        rests[N]: Bit;
    }

    outputs {
        /// One clock: to `start` of the axis.
        axis_start[N]: Bit;
        /// To the axis: another axis wants all axes to stop.
        group_stop[N]: Bit;
        /// To `feed_hold` of the axis's segments.
        hold_feed[N]: Bit;
        /// To all axes: one of them has its emergency stop.
        group_emergency_stop: Bit;
        /// One clock: a start was refused.
        start_refused: Bit;
    }
}

/// The cycle-accurate model of the group.
#[derive(Debug, Clone)]
pub struct Group {
    ports: Vec<Port>,
    axes: usize,
    state: State,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct State {
    /// Axes to start, one bit per axis.
    starts: u64,
    stops: u64,
    holds: u64,
    emergency_stop: bool,
    refused: bool,
}

impl Group {
    /// The state after reset, for 1 to [`MOST_AXES`] axes.
    pub fn new(axes: usize) -> Self {
        Self {
            ports: ports(axes),
            axes,
            state: State::default(),
        }
    }
}

impl State {
    /// The registers after a clock. `can`, `wants`, `emergency`, `feed_hold` and `rests` have one bit per axis.
    fn after(axes: usize, start: Option<u64>, [can, wants, emergency, feed_hold, rests]: [u64; LISTS]) -> Self {
        let wanted = start.unwrap_or(0);
        let granted = wanted & !can == 0;
        let others = |axis: usize| wants & !(1 << axis) != 0;
        Self {
            starts: if granted { wanted } else { 0 },
            refused: start.is_some() && (!granted || wanted == 0),
            stops: (0..axes).fold(0, |stops, axis| stops | u64::from(others(axis)) << axis),
            emergency_stop: emergency != 0,
            holds: if feed_hold & !rests == 0 { feed_hold } else { 0 },
        }
    }
}

impl Moore for Group {
    fn show(&self, outputs: &mut [u64]) {
        let bits = |word: u64| (0..self.axes).map(move |axis| word >> axis & 1);
        let State {
            starts,
            stops,
            holds,
            emergency_stop,
            refused,
        } = self.state;
        let shown = bits(starts).chain(bits(stops)).chain(bits(holds));
        let shown = shown.chain([emergency_stop.into(), refused.into()]);
        show_each(outputs, shown);
    }

    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        if (inputs[0] | inputs[1]) & 1 != 0 {
            return 0;
        }
        let next = State::after(self.axes, None, words(inputs, self.axes));
        if next == self.state { FOREVER } else { 0 }
    }
}

/// Packs each list of inputs into a word with one bit per axis.
fn words(inputs: &[u64], axes: usize) -> [u64; LISTS] {
    std::array::from_fn(|list| (0..axes).fold(0, |word, axis| word | (inputs[3 + list * axes + axis] & 1) << axis))
}

impl ClockedBlock for Group {
    fn ports(&self) -> &[Port] {
        &self.ports
    }

    fn step(&mut self, inputs: &[u64], outputs: &mut [u64]) -> Result<(), StepError> {
        let axes = self.axes;
        if (inputs.len(), outputs.len()) != (3 + LISTS * axes, 2 + 3 * axes) {
            return Err(StepError(format!(
                "{} inputs and {} outputs: a group of {axes} axes has {} and {}",
                inputs.len(),
                outputs.len(),
                3 + LISTS * axes,
                2 + 3 * axes
            )));
        }
        self.show(outputs);
        self.state = if inputs[0] & 1 != 0 {
            State::default()
        } else {
            let start = (inputs[1] & 1 != 0).then_some(inputs[2] & ((1 << MOST_AXES) - 1));
            State::after(axes, start, words(inputs, axes))
        };
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Outputs one clock after these inputs.
    fn after(axes: usize, inputs: &[u64]) -> Vec<u64> {
        let mut group = Group::new(axes);
        let mut outputs = vec![0; 2 + 3 * axes];
        group.step(inputs, &mut outputs).unwrap();
        group.show(&mut outputs);
        outputs
    }

    #[test]
    fn all_start_or_none() {
        for wanted in 0..16u64 {
            for can in 0..8u64 {
                let can_start = [can & 1, can >> 1 & 1, can >> 2 & 1];
                let inputs = [vec![0, 1, wanted], can_start.to_vec(), vec![0; 12]].concat();
                let granted = wanted != 0 && wanted & !can == 0;
                let bit = |axis: u64| u64::from(granted) & wanted >> axis & 1;
                let wanted = [bit(0), bit(1), bit(2), 0, 0, 0, 0, 0, 0, 0, u64::from(!granted)];
                assert_eq!(after(3, &inputs), wanted);
            }
        }
        assert_eq!(after(1, &[0, 0, 1, 1, 0, 0, 0, 0]), [0; 5]);
    }

    #[test]
    fn a_stop_reaches_the_others_and_an_emergency_all() {
        assert_eq!(
            after(2, &[0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0]),
            [0, 0, 0, 1, 0, 0, 0, 0]
        );
        assert_eq!(
            after(2, &[0, 0, 0, 0, 0, 1, 1, 0, 1, 0, 0, 0, 0]),
            [0, 0, 1, 1, 0, 0, 1, 0]
        );
        assert_eq!(after(1, &[0, 0, 0, 0, 1, 1, 0, 0]), [0, 0, 0, 1, 0]);
    }

    #[test]
    fn a_feed_hold_waits_until_all_its_axes_rest() {
        for wanted in 0..8u64 {
            for resting in 0..8u64 {
                let bits = |word: u64| [word & 1, word >> 1 & 1, word >> 2 & 1];
                let inputs = [vec![0; 3 + 9], bits(wanted).to_vec(), bits(resting).to_vec()].concat();
                let held = if wanted & !resting == 0 { wanted } else { 0 };
                assert_eq!(after(3, &inputs)[6..9], bits(held), "{wanted} {resting}");
            }
        }
    }
}
