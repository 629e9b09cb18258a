//! The end of the position word on a stage: checks what stops a command that runs away, with and without soft limits.
//!
//! The encoder's lines follow the shaped command exactly, at most one count per clock. So moving to the end of the word
//! with the outputs off takes as many clocks as counts.
#![allow(clippy::unwrap_used)] // helpers of tests, which clippy.toml exempts only inside of #[test]

use posicast_blocks::axis::Cause;
use posicast_blocks::component::Component;
use posicast_blocks::composition::Composed;
use posicast_blocks::segments::{Entry, EntryMotion, REACH_COUNTS, STAND_COUNTS};
use posicast_blocks::{ClockedBlock, Direction};
use posicast_closed_loop::stage_bench::state;

use crate::support::{XY, machine, stage};

/// One axis of the example, whose encoder is not filtered.
struct Bed {
    component: Component,
    model: Composed,
    inputs: Vec<u64>,
    outputs: Vec<u64>,
    /// Position of its encoder in counts.
    at: i32,
    tick_clocks: u64,
    /// Largest position of the command in counts.
    furthest: i32,
}

impl Bed {
    fn new() -> Self {
        let mut config = stage(&machine(XY)).config;
        config.axes.truncate(1);
        let axis = &mut config.axes[0];
        axis.closed_loop_mut().unwrap().encoder_filter_clocks = 0;
        (axis.supervision.lost_ticks, axis.supervision.saturation_ticks) = (0, 0);
        let component = Component::stage(&config).unwrap();
        let model = component.model(1);
        let count = |direction| model.ports().iter().filter(|port| port.direction == direction).count();
        let mut bed = Self {
            inputs: vec![0; count(Direction::Input)],
            outputs: vec![0; count(Direction::Output)],
            at: 0,
            tick_clocks: config.tick.tick_clocks().into(),
            furthest: 0,
            component,
            model,
        };
        for line in ["emergency_stop_n", "pll_locked", "x_limit_plus_n", "x_limit_minus_n"] {
            bed.set(line, 1);
        }
        for line in ["x_drive_ready", "x_drive_fault_n", "x_fault_n"] {
            bed.set(line, 1);
        }
        bed.set("rst", 1);
        bed.clocks(2);
        bed.set("rst", 0);
        bed
    }

    fn set(&mut self, input: &str, value: u64) {
        let mut inputs = self
            .model
            .ports()
            .iter()
            .filter(|port| port.direction == Direction::Input);
        let place = inputs.position(|port| port.name == input).unwrap();
        self.inputs[place] = value;
    }

    fn clocks(&mut self, clocks: u64) {
        let mut left = clocks;
        while left > 0 {
            left -= self.model.hold(&self.inputs, left, &mut self.outputs).unwrap();
        }
    }

    fn net(&self, name: &str) -> i32 {
        self.model.value(self.model.net(&format!("x_{name}")).unwrap()) as u32 as i32
    }

    fn write(&mut self, register: &str, place: u32, data: u32) {
        let offset = self.component.map().register(register).unwrap().offset + place;
        for (input, value) in [("avs_address", offset), ("avs_writedata", data)] {
            self.set(input, value.into());
        }
        self.set("avs_byteenable", 0xf);
        self.set("avs_write", 1);
        self.clocks(1);
        self.set("avs_write", 0);
    }

    /// Moves the encoder there, one count per clock.
    fn go(&mut self, counts: i32) {
        while self.at != counts {
            self.at += (counts - self.at).signum();
            let place = self.at & 3;
            self.set("x_a", u64::from(place == 1 || place == 2));
            self.set("x_b", u64::from(place >= 2));
            self.clocks(1);
        }
    }

    /// Advances by a tick, in which the axis follows.
    fn tick(&mut self) {
        let before = self.at;
        self.go(self.net("shaped_position") >> 8);
        let spent = u64::from(before.abs_diff(self.at));
        self.clocks(self.tick_clocks - spent.min(self.tick_clocks - 1));
        self.furthest = self.furthest.max(self.net("command_position") >> 8);
    }

    /// Advances by at most this many ticks; returns whether the state was reached.
    fn until(&mut self, state: u32, most: u32) -> bool {
        for _ in 0..most {
            if self.net("state") == state as i32 {
                return true;
            }
            self.tick();
        }
        false
    }

    /// Goes from OFF or FAULT to READY, once the brake is applied.
    fn make_ready(&mut self) {
        self.write("x_control", 0, 0);
        while self.net("drive_enable") != 0 {
            self.tick();
        }
        self.write("x_clear_faults", 0, 0);
        assert!(self.until(state::READY, 10));
    }

    /// Goes from OFF or FAULT to HOLD, with the brake released.
    fn switch_on(&mut self) {
        self.make_ready();
        self.write("x_control", 0, 1);
        assert!(self.until(state::HOLD, 10));
        for _ in 0..5_000 {
            if self.net("can_start") != 0 {
                return;
            }
            self.tick();
        }
        unreachable!("the brake does not open");
    }

    /// Moves outwards without end at two counts per tick; returns what stopped it. The axis stands still afterwards.
    fn run_away(&mut self) -> u32 {
        for (ticks, jerk) in [(1, 2i64 << 32), (1, -2 << 32), (1 << 20, 0)] {
            let motion = EntryMotion::Jerk(jerk);
            let entry = Entry {
                ticks,
                motion,
                notify: false,
            };
            for (place, word) in (0..).zip(entry.words()) {
                self.write("x_segment", place, word);
            }
        }
        self.write("start", 0, 1);
        self.furthest = 0;
        assert!(self.until(state::RUN, 4));
        assert!(self.until(state::QUICK_STOP, 4_000), "it runs away: {}", self.furthest);
        let causes = self.net("causes") as u32;
        assert!(self.until(state::FAULT, 4_000));
        assert_eq!(self.net("command_velocity"), 0);
        causes
    }
}

#[test]
fn no_command_runs_away_beyond_the_position_word() {
    let mut bed = Bed::new();
    bed.clocks(1000);
    for register in ["watchdog", "following_error_limit", "soft_limit_minus"] {
        bed.write(&format!("x_{register}"), 0, 0);
    }
    let limit = REACH_COUNTS - 1500;
    bed.write("x_soft_limit_plus", 0, (limit << 8) as u32);
    bed.write("x_stop_deceleration", 0, 1 << 24);
    bed.go(REACH_COUNTS - 3000);
    bed.clocks(2 * bed.tick_clocks);
    assert_eq!(bed.net("count"), bed.at);

    // A soft limit stops it, before the end of the range.
    bed.switch_on();
    assert_eq!(bed.run_away(), Cause::SoftLimitPlus.bit());
    assert!((limit..REACH_COUNTS).contains(&bed.furthest), "{}", bed.furthest);
    assert_eq!(bed.net("segments_out_of_range"), 0);

    // Without a soft limit the end of the range stops it, before half of the remaining distance is used up.
    bed.write("x_soft_limit_plus", 0, 0);
    bed.switch_on();
    assert_eq!(bed.run_away(), Cause::Segments.bit());
    assert_eq!(bed.net("segments_out_of_range"), 1);
    assert!((REACH_COUNTS..STAND_COUNTS).contains(&bed.furthest), "{}", bed.furthest);

    // Moved beyond it with the outputs off, the axis cannot be switched on.
    bed.make_ready();
    bed.go(STAND_COUNTS + 1);
    bed.write("x_control", 0, 1);
    bed.clocks(3 * bed.tick_clocks);
    assert_eq!(bed.net("causes") as u32, Cause::Range.bit());
    assert_eq!((bed.net("state"), bed.net("drive_enable")), (state::FAULT as i32, 0));
}
