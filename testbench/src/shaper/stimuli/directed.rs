//! Scripts of directed test cases, by name.

use crate::shaper::{AxisLayout, Layout, TableLayout};
use crate::stimuli::Stimuli;

/// One step of a script. All axes do the same, each at its own full scale.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Action {
    /// Asserts `rst` for this many clocks.
    Reset(u32),
    /// Asserts `strobe` for one clock with `x` in 256ths of full scale: 256 is the largest word, −256 the smallest.
    Strobe(i32),
    /// Asserts `strobe` for one clock with this word.
    StrobeExact(i64),
    /// Like [`Action::Strobe`], together with `start`.
    Start(i32),
    /// Asserts `start` without `strobe`.
    StartAlone,
    /// Waits for this many clocks.
    Wait(u32),
    /// Waits until no axis is busy, for 1 to 4096 clocks.
    WaitIdle,
    /// Writes a tap: bank, index, coefficient in 256ths of one, delay. Negative delays count from the largest, which
    /// is −1.
    Tap(u64, u64, i32, i64),
    /// Writes a tap: bank, index, raw coefficient, delay as for [`Action::Tap`].
    TapExact(u64, u64, i32, i64),
    /// Asserts `tap_read` for one clock with the bank and index of a tap. A second read is ignored until the first is
    /// done.
    Read(u64, u64),
    /// Requests this bank.
    Swap(u64),
    /// Asserts `swap` for this bank and `strobe` with this `x` in the same clock.
    SwapAndStrobe(u64, i32),
    /// Requests a bank with a `swap_how`; a shaper without that port swaps at once.
    SwapHow(u64, u64),
    /// Asserts `clear_flags` for one clock.
    Clear,
    /// Asserts `clear_flags` together with a strobe of this `x`.
    ClearAndStrobe(i32),
}

/// Returns the directed cases, each with its name.
pub fn cases() -> Vec<(&'static str, Vec<Action>)> {
    use Action::{
        Clear, ClearAndStrobe, Read, Reset, Start, StartAlone, Strobe, Swap, SwapAndStrobe, Tap, Wait, WaitIdle,
    };
    let samples = |values: &[i32]| values.iter().flat_map(|x| [Strobe(*x), WaitIdle]).collect::<Vec<_>>();
    let held = |x: i32, count: usize| samples(&vec![x; count]);
    let started = |x: i32| vec![Reset(2), Start(x), WaitIdle];
    // 1.5 − 0.5 swings beyond full scale. It is loaded into bank 1; one half and one half go into bank 2.
    let load = |bank: u64, taps: [(i32, i64); 2]| {
        let tap = |(index, (coefficient, delay)): (u64, (i32, i64))| Tap(bank, index, coefficient, delay);
        (0..).zip(taps).map(tap).collect::<Vec<_>>()
    };
    let overshooting = load(1, [(384, 0), (-128, 3)]);
    let halves = load(2, [(128, 0), (128, 5)]);
    vec![
        ("step_to_full_scale", [started(0), held(256, 40)].concat()),
        ("step_to_negative_full_scale", [started(0), held(-256, 40)].concat()),
        (
            "reversal",
            [started(0), held(256, 20), held(-256, 20), held(256, 20)].concat(),
        ),
        ("constant", [started(100), held(100, 40)].concat()),
        (
            "strobes_back_to_back",
            [started(0), vec![Strobe(10); 30], vec![WaitIdle, Clear], held(5, 3)].concat(),
        ),
        (
            "start_at_any_time",
            [
                started(50),
                held(-50, 5),
                vec![
                    StartAlone,
                    Wait(3),
                    Start(200),
                    Start(-200),
                    Wait(1),
                    StartAlone,
                    WaitIdle,
                ],
                held(10, 5),
            ]
            .concat(),
        ),
        (
            "reset_at_any_time",
            (0..24)
                .flat_map(|clocks| [Strobe(77), Wait(clocks), Reset(1), Wait(1), Strobe(-33), WaitIdle])
                .collect(),
        ),
        (
            "swap_in_flight",
            [
                started(0),
                overshooting.clone(),
                halves.clone(),
                held(256, 3),
                vec![Strobe(-256), Wait(1), Swap(1), WaitIdle],
                held(-256, 6),
                held(256, 6),
                vec![SwapAndStrobe(2, 9), WaitIdle],
                held(-256, 6),
                vec![Swap(0), Wait(2), Strobe(256), WaitIdle],
                held(256, 6),
            ]
            .concat(),
        ),
        (
            "saturation",
            [
                started(0),
                overshooting.clone(),
                vec![Swap(1)],
                held(-256, 8),
                held(256, 8),
                vec![Clear],
                held(-256, 8),
            ]
            .concat(),
        ),
        (
            "flag_clear_races",
            [
                started(0),
                overshooting.clone(),
                vec![Swap(1)],
                held(-256, 4),
                vec![Strobe(256)],
                vec![Clear; 40],
                vec![
                    ClearAndStrobe(1),
                    ClearAndStrobe(2),
                    Clear,
                    Wait(1),
                    Clear,
                    WaitIdle,
                    Clear,
                ],
            ]
            .concat(),
        ),
        (
            "illegal_writes",
            [
                started(0),
                vec![
                    Tap(0, 0, 256, 0),
                    Clear,
                    Tap(3, 0, 256, 0),
                    Clear,
                    Tap(1, 1, 256, 0),
                    Clear,
                ],
                vec![
                    Tap(1, 0, 256, -1),
                    Clear,
                    Swap(1),
                    Clear,
                    Tap(1, 0, 255, 0),
                    Swap(1),
                    Clear,
                ],
                vec![Swap(3), Clear, Swap(2), Clear],
                overshooting.clone(),
                vec![Swap(1), Tap(1, 0, 256, 0), Swap(1), Tap(2, 0, 256, 0), Wait(2), Clear],
                held(3, 4),
                vec![Tap(1, 0, 256, 0), Tap(1, 2, 1, 9), Swap(1), Clear],
                held(4, 4),
            ]
            .concat(),
        ),
        (
            "reload_after_reset",
            [
                started(0),
                overshooting.clone(),
                vec![Swap(1), Reset(1), Swap(1), Wait(2)],
                held(7, 3),
                vec![Tap(1, 0, 256, 0), Reset(1), Tap(1, 1, 1, 1), Swap(1), Wait(1)],
                held(7, 3),
                halves.clone(),
                vec![Swap(2), Reset(3)],
                held(9, 3),
            ]
            .concat(),
        ),
        (
            "taps_read_back",
            [
                started(0),
                overshooting,
                vec![Swap(1)],
                held(3, 2),
                halves,
                // Each bank is read, including the active one; then a place without a tap, and, during a pass, the
                // first tap of bank 0.
                [(1, 1), (2, 0), (2, 1), (0, 0), (2, 2), (3, 0)]
                    .map(|(bank, index)| [Read(bank, index), Read(bank, index), Wait(3)])
                    .concat(),
                vec![Strobe(90), Read(1, 0), WaitIdle, Wait(3)],
                held(-90, 5),
            ]
            .concat(),
        ),
    ]
}

/// Returns the directed cases of a motion shaper that come in addition to those of [`cases`].
pub fn motion_cases() -> Vec<(&'static str, Vec<Action>)> {
    use Action::{Clear, Reset, Start, StartAlone, Strobe, Swap, SwapHow, Tap, Wait, WaitIdle};
    let ramp = |from: i32, step: i32, count: i32| {
        let samples = (0..count).flat_map(|n| [Strobe(from + step * n), WaitIdle]);
        samples.collect::<Vec<_>>()
    };
    let (hand_over, when_settled) = (1, 2);
    let begin = vec![
        Reset(2),
        Start(0),
        WaitIdle,
        Tap(1, 0, 100, 0),
        Tap(1, 1, -44, 4),
        Tap(1, 2, 200, 9),
        Tap(2, 0, 256, 0),
    ];
    let refused = vec![
        Swap(0),
        Tap(2, 1, 1, 1),
        SwapHow(2, hand_over),
        SwapHow(2, when_settled),
        Clear,
    ];
    vec![
        (
            "handover_while_moving",
            [
                begin.clone(),
                ramp(0, 2, 12),
                vec![SwapHow(1, hand_over)],
                ramp(24, 2, 90),
                vec![SwapHow(2, hand_over)],
                ramp(200, -3, 30),
            ]
            .concat(),
        ),
        (
            "handover_refuses_what_comes_in_it",
            [
                begin.clone(),
                ramp(0, 5, 3),
                vec![SwapHow(1, hand_over), Clear],
                refused.clone(),
                ramp(20, 5, 5),
                refused.clone(),
                ramp(50, 5, 5),
                vec![SwapHow(2, 3), Clear],
            ]
            .concat(),
        ),
        (
            "handover_cut_off_by_start_and_reset",
            [
                begin.clone(),
                ramp(0, 4, 5),
                vec![SwapHow(1, hand_over)],
                ramp(20, 4, 3),
                vec![StartAlone, Wait(2)],
                ramp(9, 4, 5),
                vec![SwapHow(2, hand_over), Start(70), WaitIdle],
                ramp(70, 1, 5),
                vec![SwapHow(0, hand_over)],
                ramp(90, -2, 4),
                vec![Strobe(5), Strobe(6), Strobe(7), Wait(3), Strobe(8), WaitIdle],
                vec![Reset(1)],
                ramp(0, 1, 3),
            ]
            .concat(),
        ),
        (
            "swap_when_settled",
            [
                begin,
                ramp(0, 4, 5),
                vec![SwapHow(1, when_settled)],
                ramp(20, 1, 4),
                ramp(24, 0, 140),
                vec![SwapHow(2, when_settled)],
                ramp(25, 1, 3),
                refused,
                vec![Start(-40), WaitIdle],
                ramp(-40, 9, 10),
            ]
            .concat(),
        ),
    ]
}

/// Longest wait in clocks for an axis that stays busy.
const IDLE_LIMIT_CLOCKS: u32 = 4096;

/// Plays a script once and then changes nothing.
#[derive(Debug, Clone)]
pub struct Directed {
    layout: Layout,
    script: Vec<Action>,
    at: usize,
    /// Number of clocks already spent in the current action.
    spent: u32,
}

impl Directed {
    /// Creates a player of `script` on all axes of the layout.
    pub fn new(layout: &Layout, script: Vec<Action>) -> Self {
        Self {
            layout: layout.clone(),
            script,
            at: 0,
            spent: 0,
        }
    }

    /// Returns an upper bound of the clocks that the script needs if a pass takes at most `pass_clocks`.
    pub fn clocks(&self, pass_clocks: u32) -> u64 {
        let clocks = |action: &Action| match action {
            Action::Reset(clocks) | Action::Wait(clocks) => *clocks,
            Action::WaitIdle => pass_clocks.min(IDLE_LIMIT_CLOCKS).saturating_add(2),
            _ => 1,
        };
        self.script.iter().map(|action| u64::from(clocks(action))).sum()
    }

    /// Returns whether the current action is over, given the outputs of the previous clock.
    fn over(&self, action: Action, seen: &[u64]) -> bool {
        match action {
            Action::Reset(clocks) | Action::Wait(clocks) => self.spent >= clocks,
            Action::WaitIdle => {
                let busy = self.layout.axes.iter().any(|axis| seen[axis.busy] != 0);
                self.spent > 1 && !busy || self.spent >= IDLE_LIMIT_CLOCKS
            }
            _ => self.spent >= 1,
        }
    }
}

impl Stimuli for Directed {
    fn fill(&mut self, seen: &[u64], inputs: &mut [u64]) {
        inputs.fill(0);
        while let Some(action) = self.script.get(self.at).copied() {
            if !self.over(action, seen) {
                break;
            }
            self.at += 1;
            self.spent = 0;
        }
        let Some(action) = self.script.get(self.at).copied() else {
            return;
        };
        self.spent += 1;
        match action {
            Action::Reset(_) => inputs[self.layout.rst] = 1,
            Action::Strobe(_)
            | Action::StrobeExact(_)
            | Action::Start(_)
            | Action::SwapAndStrobe(..)
            | Action::ClearAndStrobe(_) => {
                inputs[self.layout.strobe] = 1;
            }
            _ => {}
        }
        for axis in &self.layout.axes {
            drive(axis, action, inputs);
        }
    }
}

/// Sets the words of all channels, each to a different part of `x` 256ths of full scale.
fn command(axis: &AxisLayout, x: i32, inputs: &mut [u64]) {
    let word = |x: i32| {
        let word = i128::from(axis.largest_word()) * i128::from(x) / 256;
        word.clamp(-i128::from(axis.largest_word()) - 1, i128::from(axis.largest_word())) as i64 as u64
    };
    for channel in 0..axis.channels {
        let x = x / (1 + channel as i32);
        // −256/256 of full scale is the smallest word, one below the negative of the largest.
        inputs[axis.x + channel] = if x == -256 { word(x).wrapping_sub(1) } else { word(x) };
    }
}

fn drive(axis: &AxisLayout, action: Action, inputs: &mut [u64]) {
    match action {
        Action::Strobe(x) | Action::SwapAndStrobe(_, x) => command(axis, x, inputs),
        Action::StrobeExact(word) => inputs[axis.x..axis.x + axis.channels].fill(word as u64),
        Action::Start(x) => {
            command(axis, x, inputs);
            inputs[axis.start] = 1;
        }
        Action::StartAlone => inputs[axis.start] = 1,
        Action::Clear => inputs[axis.clear_flags] = 1,
        Action::ClearAndStrobe(x) => {
            inputs[axis.clear_flags] = 1;
            command(axis, x, inputs);
        }
        _ => {}
    }
    if let Some(tables) = &axis.tables {
        drive_tables(tables, action, inputs);
    }
}

fn drive_tables(tables: &TableLayout, action: Action, inputs: &mut [u64]) {
    match action {
        Action::Tap(bank, index, coefficient, delay) => {
            let one = 1i64 << tables.coefficient_fraction;
            write_tap(tables, bank, index, i64::from(coefficient) * one / 256, delay, inputs);
        }
        Action::TapExact(bank, index, coefficient, delay) => {
            write_tap(tables, bank, index, i64::from(coefficient), delay, inputs);
        }
        Action::Read(bank, index) => {
            inputs[tables.tap_read] = 1;
            inputs[tables.tap_bank] = bank;
            inputs[tables.tap_index] = index;
        }
        Action::Swap(bank) | Action::SwapHow(bank, _) | Action::SwapAndStrobe(bank, _) => {
            inputs[tables.swap] = 1;
            inputs[tables.swap_bank] = bank;
            if let (Action::SwapHow(_, how), Some(swap_how)) = (action, tables.swap_how) {
                inputs[swap_how] = how;
            }
        }
        _ => {}
    }
}

fn write_tap(tables: &TableLayout, bank: u64, index: u64, coefficient: i64, delay: i64, inputs: &mut [u64]) {
    inputs[tables.tap_write] = 1;
    inputs[tables.tap_bank] = bank;
    inputs[tables.tap_index] = index;
    inputs[tables.tap_coefficient] = coefficient as u64;
    inputs[tables.tap_delay] = delay as u64;
}
