//! Constants of an axis that no motion of a healthy stage shows: `docs/stage.md`, settings.
//!
//! They take seconds of the machine or a controller that has stopped, so the lock step of the stage does not see them.
#![allow(clippy::unwrap_used)] // helpers of tests, which clippy.toml exempts only inside of #[test]

use posicast_hdl::emit::Module;
use posicast_ladder::mutation::{WireMutant, with_wires};
use posicast_testbench::named_mutant::NamedMutant;

use super::bed::*;

/// pulse_counter.md: the unit of `timeout`.
const TIMEOUT_UNIT_CLOCKS: u64 = 65_536;
/// A period of the example's PWM: 20 kHz at 50 MHz.
const PERIOD_CLOCKS: u64 = 2500;
/// The controller's duty has arrived this many clocks after the tick; the register `DUTY_CLOCKS` states fewer.
const AFTER_THE_DUTY: u64 = 1000;

/// Whole units of the time-out after the last step in which each axis's velocity becomes 0.
fn velocity_ends(bed: &mut Bed) -> [u64; 2] {
    bed.clocks(1000);
    // The first step after a silence has no velocity.
    bed.step([1, -1]);
    bed.ticks(1);
    bed.clocks(1000);
    let stepped = bed.now;
    bed.step([1, -1]);
    bed.ticks(2);
    assert!(
        [0, 1]
            .map(|axis| bed.of(axis, VELOCITY))
            .iter()
            .all(|velocity| *velocity != 0)
    );
    bed.idle(74 * TIMEOUT_UNIT_CLOCKS);
    let mut ends = [None; 2];
    for _ in 0..60 {
        bed.next_tick();
        let units = (bed.now - stepped) / TIMEOUT_UNIT_CLOCKS;
        bed.clocks(AFTER_THE_DUTY);
        for (axis, end) in ends.iter_mut().enumerate() {
            if bed.of(axis, VELOCITY) == 0 {
                end.get_or_insert(units);
            }
        }
    }
    ends.map(|end| end.unwrap_or(0))
}

/// PWM periods from a tick to the trip of each axis, whose controller does not start in the next ticks: its `home` pin, which
/// [`with_constants`] has put there, stops it.
fn watchdog_acts(bed: &mut Bed) -> [u64; 2] {
    let mut periods = [0; 2];
    for (axis, name) in AXES.into_iter().enumerate() {
        bed.set("rst", 1);
        bed.clocks(4);
        bed.set("rst", 0);
        bed.hold();
        bed.ticks(1);
        let tick = bed.now;
        bed.clocks(AFTER_THE_DUTY);
        bed.set(&format!("{name}_home"), 1);
        while bed.pin(&format!("{name}_drive_enable")) == 1 && bed.now < tick + 20 * PERIOD_CLOCKS {
            bed.clock();
        }
        periods[axis] = (bed.now - tick) / PERIOD_CLOCKS;
        bed.set(&format!("{name}_home"), 0);
        // Bit 4 of the causes of the trip: the PWM's watchdog.
        assert_eq!(bed.of(axis, STATUS) >> 20 & 0x1f, 1 << 4, "{name}");
    }
    periods
}

/// Returns the stage with a line in each axis that stops its controller. The input `mutsel` chooses which of these constants replaces
/// the original one.
fn with_constants(port: [&str; 2], from: u64, to: &[(&str, u64)]) -> Vec<Module> {
    let stopped = AXES.iter().fold(modules(), |modules, axis| {
        let start = ".start                  (control),";
        let mutant = NamedMutant {
            name: "a controller that can be stopped",
            module: Some(&format!("xy_stage_{axis}")),
            from: start,
            to: &start.replace("(control)", "(control & ~home)"),
        };
        mutant.put_into(&modules).unwrap()
    });
    let constant = |value| format!("8'd{value}");
    let mutant = |(axis, to): &(&str, u64)| WireMutant::exchange(axis, port, &constant(from), &constant(*to));
    with_wires(&stopped, &to.iter().map(mutant).collect::<Vec<_>>()).unwrap()
}

fn bed(modules: &[Module], mutant: u64) -> Bed {
    let mut bed = Bed::new(modules);
    bed.set("mutsel", mutant);
    bed
}

/// stage.md: 76 · 65,536 clocks. A constant beside it is seen in each axis, so this finds it.
#[test]
fn long_the_velocity_of_each_axis_times_out_as_the_data_sheet_says() {
    let modules = with_constants(["pulse_counter", "timeout"], 76, &[("x", 75), ("y", 77)]);
    for (mutant, ends) in (0..).zip([[76, 76], [75, 76], [76, 77]]) {
        assert_eq!(velocity_ends(&mut bed(&modules, mutant)), ends);
    }
}

/// stage.md: two ticks, which are four periods, without a command; pwm.md: the next valley trips.
#[test]
fn long_the_watchdog_of_each_pwm_acts_as_the_data_sheet_says() {
    let others = [("x", 3), ("x", 5), ("y", 3), ("y", 5)];
    let modules = with_constants(["pwm", "watchdog_periods"], 4, &others);
    for (mutant, periods) in (0..).zip([[5, 5], [4, 5], [6, 5], [5, 4], [5, 6]]) {
        assert_eq!(watchdog_acts(&mut bed(&modules, mutant)), periods);
    }
}
