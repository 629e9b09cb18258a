//! Checks for forbidden states of an axis's pins, in every clock of a bench.

use posicast_machine::plant::axis::{AxisPlant, DrivePins};

/// Number of clocks for which the gates may stay on once the drive is disabled: the gates' register follows the
/// enable's.
const GATES_FOLLOW_CLOCKS: u64 = 1;

/// Observations of an axis since its bench began.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Watched {
    /// Number of clocks with a gate on, more than one clock after the drive was disabled; with steps, the number of steps
    /// while it was disabled. Must be 0.
    pub gates_while_disabled: u64,
    /// Number of clocks with the brake released and the drive disabled. Must be 0.
    pub released_while_disabled: u64,
    /// Largest difference between the counter and the plant's count, since the last reset or
    /// [`rebase`](super::StageBench::rebase). A count that is still in filter and synchroniser makes it 1. Stays 0 with an
    /// absolute encoder, which is not compared.
    pub largest_count_error: u64,
    /// Count of the plant at which the counter is 0.
    pub origin: i64,
    disabled_clocks: u64,
}

impl Watched {
    /// Compares the counter with the plant in one clock.
    pub(super) fn look(&mut self, counter: u64, plant: &AxisPlant) {
        // The position of an absolute encoder comes once per tick: between them the two differ by the axis's motion.
        if plant.is_absolute() {
            return;
        }
        let off_by = (plant.count() - self.origin).abs_diff(signed(counter));
        self.largest_count_error = self.largest_count_error.max(off_by);
    }

    /// Records this many clocks with these pins, after which the plant is as it is now.
    pub(super) fn pass(&mut self, pins: &DrivePins, passed: u64, plant: &AxisPlant) {
        if plant.has_steps() {
            self.gates_while_disabled = plant.ignored_steps();
        }
        if pins.drive_enable {
            self.disabled_clocks = 0;
            return;
        }
        let before = self.disabled_clocks;
        self.disabled_clocks += passed;
        if pins.brake_release {
            self.released_while_disabled += passed;
        }
        if !plant.has_steps() && (pins.a_high || pins.a_low || pins.b_high || pins.b_low) {
            let late = |clocks: u64| clocks.saturating_sub(GATES_FOLLOW_CLOCKS);
            self.gates_while_disabled += late(self.disabled_clocks) - late(before);
        }
    }

    /// Accepts the counter as it is.
    pub(super) fn rebase(&mut self, counter: u64, plant: &AxisPlant) {
        // The count of an absolute encoder does not restart.
        self.origin = if plant.is_absolute() {
            0
        } else {
            plant.count() - signed(counter)
        };
        self.largest_count_error = 0;
    }
}

fn signed(counter: u64) -> i64 {
    i64::from(counter as u32 as i32)
}

#[cfg(test)]
mod tests {
    use posicast_machine::plant::axis::PlantOptions;

    use super::*;

    #[test]
    fn a_gate_may_follow_the_enable_by_one_clock() {
        let text = include_str!("../../../examples/xy-stage.toml");
        let machine = posicast_machine::machine_file::parse("xy-stage.toml", text).unwrap();
        let plant = AxisPlant::new(&machine.axes[0], &machine.clock, &PlantOptions::default()).unwrap();
        let mut watched = Watched::default();
        let pins = DrivePins {
            a_high: true,
            ..DrivePins::default()
        };
        watched.look(0, &plant);
        watched.pass(&pins, 1, &plant);
        assert_eq!(watched.gates_while_disabled, 0);
        watched.look(u64::from(-2_i32 as u32), &plant);
        watched.pass(&pins, 3, &plant);
        assert_eq!((watched.gates_while_disabled, watched.largest_count_error), (3, 2));
        watched.pass(
            &DrivePins {
                brake_release: true,
                ..pins
            },
            2,
            &plant,
        );
        assert_eq!((watched.gates_while_disabled, watched.released_while_disabled), (5, 2));
    }
}
