//! Step lines as a drive reads them.

use super::pins::{Command, DrivePins};
use crate::machine_file::StepsSection;
use posicast_blocks::step_generator::{StepLinesActiveLow, StepMode};

/// The input of a drive with step inputs: it counts steps while it is enabled.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct StepLines {
    mode: StepMode,
    low: StepLinesActiveLow,
    cell_clocks: u32,
    /// The lines in the last clock, on or off; `None` before the first.
    lines: Option<[bool; 2]>,
    steps: i64,
    /// Steps that came while the drive was disabled, which it does not make.
    ignored_steps: u64,
    enabled: u32,
    released: u32,
}

impl StepLines {
    pub(super) fn new(steps: &StepsSection, cell_clocks: u32) -> Self {
        Self {
            mode: steps.mode,
            low: steps.active_low,
            cell_clocks,
            lines: None,
            steps: 0,
            ignored_steps: 0,
            enabled: 0,
            released: 0,
        }
    }

    /// Holds these pins for some clocks; the lines are [`DrivePins::a_high`] and [`DrivePins::b_high`].
    pub(super) fn add(&mut self, pins: &DrivePins, clocks: u32) {
        let lines = [pins.a_high != self.low.a, pins.b_high != self.low.b];
        let before = self.lines.replace(lines).unwrap_or(lines);
        let given = steps_between(self.mode, before, lines);
        if pins.drive_enable {
            self.steps += given;
        } else {
            self.ignored_steps += given.unsigned_abs();
        }
        self.enabled += u32::from(pins.drive_enable) * clocks;
        self.released += u32::from(pins.brake_release) * clocks;
    }

    /// Ends a cell, and returns its command.
    pub(super) fn take(&mut self) -> Command {
        let command = Command {
            share: 0.0,
            steps: self.steps,
            enabled: self.enabled == self.cell_clocks,
            released: self.released == self.cell_clocks,
        };
        (self.enabled, self.released) = (0, 0);
        command
    }

    pub(super) fn steps(&self) -> i64 {
        self.steps
    }

    pub(super) fn ignored_steps(&self) -> u64 {
        self.ignored_steps
    }
}

/// Steps from one state of the lines to the next one.
fn steps_between(mode: StepMode, before: [bool; 2], now: [bool; 2]) -> i64 {
    let rises = |line: usize| now[line] && !before[line];
    match mode {
        StepMode::StepDirection if rises(0) => {
            if now[1] {
                1
            } else {
                -1
            }
        }
        StepMode::StepDirection => 0,
        StepMode::UpDown => i64::from(rises(0)) - i64::from(rises(1)),
        StepMode::Quadrature => {
            let place = |[a, b]: [bool; 2]| match (a, b) {
                (false, false) => 0,
                (true, false) => 1,
                (true, true) => 2,
                (false, true) => 3,
            };
            match (place(now) + 4 - place(before)) % 4 {
                1 => 1,
                3 => -1,
                _ => 0,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drive_reads_the_steps_of_every_mode() {
        let [off, a, b, both] = [[false, false], [true, false], [false, true], [true, true]];
        let cases = [
            (StepMode::StepDirection, b, both, 1),
            (StepMode::StepDirection, off, a, -1),
            (StepMode::StepDirection, both, b, 0),
            (StepMode::UpDown, off, a, 1),
            (StepMode::UpDown, off, b, -1),
            (StepMode::UpDown, off, both, 0),
            (StepMode::Quadrature, off, a, 1),
            (StepMode::Quadrature, a, both, 1),
            (StepMode::Quadrature, off, b, -1),
            (StepMode::Quadrature, off, both, 0),
        ];
        for (mode, before, now, steps) in cases {
            assert_eq!(steps_between(mode, before, now), steps, "{mode:?} {before:?} {now:?}");
        }
    }
}
