//! Scenes: what driver, pins and machine do together so that each cause, stop and handover of a stage is reached.
//!
//! Random plans reach most of it after some time. A scene reaches one thing directly: it enables all axes, brings the
//! *leader* into one fault while the others move or hold, and cleans up. Each scene is played with each axis as the
//! leader, in rounds that alternate between causes that stop the axis and causes that switch it off.

use posicast_blocks::axis::KICK;
use posicast_blocks::segments::{EntryMotion, Point};
use rand::Rng;

use super::{Do, Driver, Moves, Plan};

/// A scene: it plans what happens to its leader.
type Scene = fn(&mut Driver, usize);

/// The scenes of every stage. Those that drive the most wires between the blocks in the fewest ticks come first; the first one loads a
/// table, moves, trips and recovers, and a host at a line does not come much further.
const SCENES: [Scene; 25] = [
    Driver::command_beyond_a_soft_limit,
    Driver::follows_badly,
    Driver::slips,
    Driver::runs_dry,
    Driver::stops_from_speed,
    Driver::by_hand,
    Driver::counts_and_interrupts,
    Driver::soft_limits,
    Driver::overflows,
    Driver::limit_switches,
    Driver::holds_the_feed,
    Driver::clears_in_a_quick_stop,
    Driver::fills_the_fifo,
    Driver::settings_and_laws,
    Driver::leaves_the_range,
    Driver::tables_in_flight,
    Driver::is_disabled_before_it_starts,
    Driver::emergency,
    Driver::forgets_to_kick,
    Driver::drive_not_ready,
    Driver::loses_the_encoder,
    Driver::saturates,
    Driver::fault_line,
    Driver::drive_fault,
    Driver::clock_unlocked,
];

/// The scene of a stage with a position compare, after the others.
const OF_COMPARE: Scene = Driver::passes_positions;

/// Largest jerk of an entry, which has 40 bits.
const JERK_MAX: i64 = (1 << 39) - 1;
/// A jerk that accelerates an axis to some 100 counts per tick within three ticks.
const FAST: i64 = 1 << 36;
/// A jerk that keeps an axis at a few counts per tick.
const SLOW: i64 = 1 << 31;

impl Driver {
    /// Number of scenes of this stage.
    pub(crate) fn scenes(&self) -> usize {
        let compares = |axis: &Plan| self.map.register(&format!("{}_compare_arm", axis.name)).is_some();
        SCENES.len() + usize::from(self.axes.iter().any(compares))
    }

    /// Begins the scene of this number: all scenes with each axis as the leader, then again.
    pub(crate) fn play(&mut self, number: usize) {
        let (axes, scenes) = (self.axes.len(), self.scenes());
        let (leader, rest) = (number % axes, number / axes);
        self.round = (rest / scenes) as u32;
        for axis in 0..axes {
            self.axes[axis].script.clear();
            if axis == leader {
                let enabled = self.rng.next_u32() | self.rng.next_u32();
                self.write(axis, "interrupt_state", u32::MAX);
                self.write(axis, "interrupt_enable", enabled);
            }
            self.axes[axis].switches = 0;
            self.bring_up(axis);
        }
        SCENES.get(rest % scenes).unwrap_or(&OF_COMPARE)(self, leader);
        // A flag of the counter, which is cleared in one clock.
        if self.one_in(2) {
            self.act(leader, Do::Slip);
            self.ticks(leader, 1);
        }
        self.tell(leader, "clear_faults", 0);
    }

    /// Returns whether all scripts are over.
    pub(crate) fn is_idle(&self) -> bool {
        self.axes.iter().all(|axis| axis.script.is_empty())
    }

    fn act(&mut self, axis: usize, what: Do) {
        self.axes[axis].script.push_back(what);
    }

    /// Returns the causes that switch off: all or none, alternating, and never the same for neighbours.
    fn off_causes(&self, axis: usize) -> u32 {
        0xffff * u32::from(self.is_odd(axis))
    }

    /// Returns true for every other axis, and for the remaining ones in the next round.
    fn is_odd(&self, axis: usize) -> bool {
        (self.round + axis as u32) % 2 == 1
    }

    /// Brings an axis from any state to HOLD, with nothing supervised.
    fn bring_up(&mut self, axis: usize) {
        let random = self.below(1 << 31);
        self.act(axis, Do::Encoder(Moves::Follows));
        self.tell(axis, "control", 0);
        self.tell(axis, "settle", random & 1);
        self.tell(axis, "watchdog", self.off_causes(axis) << 16);
        self.unlimited(axis);
        self.tell(axis, "stop_deceleration", 1 << 28 | random >> 4);
        self.tell(axis, "swap", 0);
        self.tell(axis, "law", random >> 4 & 1);
        self.write(axis, "commit", 0);
        self.tell(axis, "pwm_trigger", random >> 8 & 0x3f);
        // Random traffic may have left axes in a feed hold.
        self.write(axis, "feed_hold", 0);
        self.tell(axis, "flush", 0);
        self.ticks(axis, 1);
        // An axis that held its position is off once its brake has closed.
        self.act(axis, Do::Disabled(4 * self.tick_clocks));
        self.tell(axis, "clear_faults", 0);
        self.wait(axis, 24);
        self.tell(axis, "control", 1);
        self.act(axis, Do::Released(12 * self.tick_clocks));
        self.ticks(axis, 1);
    }

    /// Accelerates for three ticks and continues for some; backwards if `back`.
    fn goes(&mut self, axis: usize, jerk: i64, back: bool) {
        let some = self.rng_jerk(jerk);
        let jerk = if back { -some } else { some };
        self.entry(axis, 1, EntryMotion::Jerk(jerk), false);
        self.entry(axis, 1, EntryMotion::Jerk(0), true);
        self.entry(axis, 1, EntryMotion::Jerk(-jerk), false);
        self.entry(axis, 40, EntryMotion::Jerk(0), false);
    }

    /// Returns a jerk of this size, with noise in the bits below.
    fn rng_jerk(&mut self, size: i64) -> i64 {
        size | i64::from(self.below(1 << 31)) & (size - 1)
    }

    /// Moves the other axes back and forth as well; one in three stays at rest.
    fn company(&mut self, leader: usize) {
        for axis in (0..self.axes.len()).filter(|axis| *axis != leader) {
            if !self.one_in(3) {
                self.there_and_back(axis, 8);
                self.write(axis, "start", 1 << axis);
            }
        }
    }

    fn set_off(&mut self, axis: usize) {
        self.write(axis, "start", 1 << axis);
    }

    /// Sets a line low for this many clocks.
    fn low(&mut self, axis: usize, line: &'static str, clocks: u32) {
        self.act(axis, Do::Low(line, clocks));
    }

    /// Makes a line bounce beside the tick, then stay low.
    fn bounces(&mut self, axis: usize, line: &'static str) {
        for _ in 0..6 {
            self.low(axis, line, 1);
            let between = self.below(self.tick_clocks / 3) + 2;
            self.wait(axis, between);
        }
        self.low(axis, line, 2 * self.tick_clocks);
        self.ticks(axis, 4);
    }

    /// Enters the wrong switch, which has no effect, then the one in the direction of motion; then the other way.
    fn limit_switches(&mut self, axis: usize) {
        self.company(axis);
        let back = self.is_odd(axis);
        self.goes(axis, SLOW, back);
        self.set_off(axis);
        self.ticks(axis, 3);
        let lines = ["limit_plus_n", "limit_minus_n"];
        self.low(axis, lines[usize::from(!back)], self.tick_clocks);
        self.ticks(axis, 1);
        self.bounces(axis, lines[usize::from(back)]);
        self.bring_up(axis);
        self.goes(axis, SLOW, !back);
        self.set_off(axis);
        self.ticks(axis, 4);
        self.bounces(axis, lines[usize::from(!back)]);
    }

    /// Crosses one soft limit while the other is far away; in the next round the roles are swapped.
    fn soft_limits(&mut self, axis: usize) {
        let back = self.is_odd(axis);
        let near = self.below(40 << 8) as i32;
        let far = i32::MAX >> (1 + self.below(3)) & !0xff | near;
        if back {
            self.tell(axis, "soft_limit_plus", far as u32);
            self.beside(axis, "soft_limit_minus", -near);
        } else {
            self.beside(axis, "soft_limit_plus", near);
            self.tell(axis, "soft_limit_minus", -far as u32);
        }
        self.tell(axis, "homed", 1);
        self.company(axis);
        self.goes(axis, SLOW << 2, back);
        self.set_off(axis);
        self.ticks(axis, 8);
    }

    /// Clears faults during a quick stop, which must not clear the flags of any block: each has one, and the stop takes ticks.
    fn clears_in_a_quick_stop(&mut self, axis: usize) {
        // The cause of the stop does not switch off, whatever the round is.
        self.tell(axis, "watchdog", 0);
        let deceleration = 1 << 26 | self.below(1 << 25);
        self.tell(axis, "stop_deceleration", deceleration);
        self.tell(axis, "settle", 3);
        // Refused: a tap for the machine's own bank, a swap to no bank, an entry of no ticks.
        self.tell(axis, "tap_address", 0);
        self.tell(axis, "tap", 1);
        self.tell(axis, "swap", 3);
        self.entry(axis, 0, EntryMotion::Jerk(1), false);
        let back = self.is_odd(axis);
        self.goes(axis, FAST, back);
        self.set_off(axis);
        self.ticks(axis, 4);
        self.act(axis, Do::Slip);
        let before = self.below(self.tick_clocks);
        self.wait(axis, self.tick_clocks / 2 + before);
        for _ in 0..3 {
            self.tell(axis, "clear_faults", 0);
            let between = 20 + self.below(self.tick_clocks);
            self.wait(axis, between);
        }
        self.ticks(axis, 4);
    }

    /// Moves the command slowly beyond a soft limit, which the shaped position crosses some ticks later, when the last taps come.
    fn command_beyond_a_soft_limit(&mut self, axis: usize) {
        // The command begins where the encoder was when the brake opened. The encoder stays there, so that it is near the limit.
        self.act(axis, Do::Encoder(Moves::Still));
        let fraction = self.fraction(axis);
        // A table of its own: a quarter at once, the rest some ticks later.
        let late = 5 + u64::from(self.below(4));
        self.load(axis, 1, &[(1 << (fraction - 2), 0), (3 << (fraction - 2), late)]);
        self.tell(axis, "swap", 1);
        self.tell(axis, "settle", 12);
        self.ticks(axis, 2);
        let way = 60 << 8;
        let back = self.is_odd(axis);
        let sign = if back { -1 } else { 1 };
        let (limit, far) = (sign * (way + way / 4), -sign * (1 << 29));
        let [plus, minus] = if back { [far, limit] } else { [limit, far] };
        self.beside(axis, "soft_limit_plus", plus);
        self.beside(axis, "soft_limit_minus", minus);
        self.tell(axis, "homed", 1);
        self.company(axis);
        // 60 counts in four ticks, as the jerks j, -j, -j, j of a tick each make 2 j. Then 4 counts in each tick: a limit that is crossed
        // slowly shows a wrong bit of the position.
        let jerk = i64::from(sign) * (i64::from(way) << 24) / 2;
        let slow = i64::from(sign) << 33;
        for jerk in [jerk, -jerk, -jerk, jerk, slow, 0, -slow] {
            self.entry(axis, 1, EntryMotion::Jerk(jerk), false);
        }
        self.entry(axis, 20, EntryMotion::Jerk(0), false);
        self.set_off(axis);
        self.ticks(axis, 15);
        self.unlimited(axis);
        self.tell(axis, "swap", 0);
        self.ticks(axis, 1);
    }

    /// Sets a limit of the following error, with an encoder that does not follow.
    fn follows_badly(&mut self, axis: usize) {
        self.company(axis);
        let limit = self.below(20 << 16) + 1;
        self.tell(axis, "following_error_limit", limit);
        self.act(axis, Do::Encoder(Moves::Still));
        let back = self.one_in(2);
        self.goes(axis, SLOW << 3, back);
        self.set_off(axis);
        self.ticks(axis, 7);
    }

    /// Stands still under a command without a limit of the following error, so that only the supervision of the
    /// encoder or of the command can stop the axis.
    fn loses_the_encoder(&mut self, axis: usize) {
        self.act(axis, Do::Encoder(Moves::Still));
        let back = self.one_in(2);
        self.goes(axis, FAST, back);
        self.set_off(axis);
        self.ticks(axis, 14);
    }

    /// Accelerates to a velocity whose command is beyond the limit, whatever the law is. The encoder follows the motor,
    /// so that it does not count as lost before the time limit of saturation is over.
    fn saturates(&mut self, axis: usize) {
        let some = self.rng_jerk(FAST);
        let jerk = if self.is_odd(axis) { -some } else { some };
        for (ticks, jerk) in [(1, jerk), (3, 0), (1, -jerk), (40, 0)] {
            self.entry(axis, ticks, EntryMotion::Jerk(jerk), false);
        }
        self.set_off(axis);
        self.ticks(axis, 14);
    }

    fn slips(&mut self, axis: usize) {
        self.company(axis);
        self.ticks(axis, 1);
        self.act(axis, Do::Slip);
        self.ticks(axis, 3);
    }

    /// Stops from some speed, by a deceleration with its upper bits set.
    fn stops_from_speed(&mut self, axis: usize) {
        let deceleration = 1 << 28 | self.below(1 << 29);
        self.tell(axis, "stop_deceleration", deceleration);
        let back = self.one_in(2);
        self.goes(axis, FAST, back);
        self.set_off(axis);
        self.ticks(axis, 4);
        self.tell(axis, "stop", 0);
        self.ticks(axis, 5);
    }

    fn emergency(&mut self, axis: usize) {
        self.company(axis);
        self.goes(axis, SLOW, false);
        self.set_off(axis);
        self.ticks(axis, 2);
        self.low(axis, "emergency_stop_n", 1);
        self.wait(axis, self.tick_clocks / 2);
        self.low(axis, "emergency_stop_n", self.tick_clocks);
        self.ticks(axis, 3);
    }

    /// Plays entries that end while the axis moves.
    fn runs_dry(&mut self, axis: usize) {
        self.company(axis);
        let jerk = self.rng_jerk(SLOW << 1);
        let extrapolation = self.pick(&[0, 0, 2]);
        self.tell(axis, "fifo_control", extrapolation << 8);
        self.entry(axis, 2, EntryMotion::Jerk(jerk), true);
        self.set_off(axis);
        self.ticks(axis, 8);
    }

    /// Queues 64 entries and more in HOLD, and the same while one plays.
    fn fills_the_fifo(&mut self, axis: usize) {
        for _ in 0..65 {
            self.entry(axis, 3, EntryMotion::Jerk(0), false);
        }
        self.set_off(axis);
        self.ticks(axis, 1);
        for _ in 0..2 {
            self.entry(axis, 1, EntryMotion::Jerk(1), false);
        }
        self.ticks(axis, 2);
        for _ in 0..2 {
            self.entry(axis, 1, EntryMotion::Jerk(1), false);
        }
        let low_water = 50 + self.below(14);
        self.tell(axis, "fifo_control", low_water);
        self.ticks(axis, 4);
        self.tell(axis, "flush", 0);
        self.ticks(axis, 2);
    }

    fn forgets_to_kick(&mut self, axis: usize) {
        self.company(axis);
        self.tell(axis, "watchdog", 2 | self.off_causes(axis) << 16);
        self.there_and_back(axis, 4);
        self.set_off(axis);
        for word in [KICK, KICK, KICK ^ (1 << (self.round % 32))] {
            self.tell(axis, "kick", word);
            self.wait(axis, 3 * self.tick_clocks / 2);
        }
        self.ticks(axis, 3);
        self.tell(axis, "watchdog", self.off_causes(axis) << 16);
    }

    /// Sets a line low during a move.
    fn on_the_way(&mut self, axis: usize, line: &'static str) {
        self.company(axis);
        self.there_and_back(axis, 3);
        self.set_off(axis);
        self.ticks(axis, 2);
        self.low(axis, "home", self.tick_clocks);
        self.low(axis, line, self.tick_clocks / 2);
        self.ticks(axis, 4);
    }

    fn drive_not_ready(&mut self, axis: usize) {
        self.on_the_way(axis, "drive_ready");
        // Enabled while the drive is not ready, the axis waits in READY, where an emergency stop finds it.
        self.tell(axis, "control", 0);
        self.ticks(axis, 1);
        self.tell(axis, "clear_faults", 0);
        self.wait(axis, 24);
        self.low(axis, "drive_ready", 3 * self.tick_clocks);
        self.wait(axis, 16);
        self.tell(axis, "control", 1);
        self.ticks(axis, 1);
        self.low(axis, "emergency_stop_n", 16);
        self.ticks(axis, 1);
    }

    fn drive_fault(&mut self, axis: usize) {
        self.on_the_way(axis, "drive_fault_n");
    }

    fn fault_line(&mut self, axis: usize) {
        self.on_the_way(axis, "fault_n");
    }

    fn clock_unlocked(&mut self, axis: usize) {
        self.on_the_way(axis, "pll_locked");
    }

    /// Plays sums that overflow the integrator's words, upwards and downwards.
    fn overflows(&mut self, axis: usize) {
        for jerk in [JERK_MAX, -JERK_MAX] {
            self.entry(axis, 4, EntryMotion::Jerk(jerk), false);
            self.set_off(axis);
            self.ticks(axis, 5);
            self.bring_up(axis);
        }
    }

    /// Holds the feed while a rest plays with a move queued, which then continues.
    fn holds_the_feed(&mut self, axis: usize) {
        self.company(axis);
        self.entry(axis, 3, EntryMotion::Jerk(0), false);
        self.there_and_back(axis, 1);
        self.set_off(axis);
        self.ticks(axis, 1);
        self.write(axis, "feed_hold", 1 << axis);
        self.ticks(axis, 4);
        self.write(axis, "feed_hold", 0);
        self.ticks(axis, 6);
    }

    /// Makes a start that is accepted and has no effect: the axis is disabled before the tick.
    fn is_disabled_before_it_starts(&mut self, axis: usize) {
        self.there_and_back(axis, 1);
        self.set_off(axis);
        self.tell(axis, "control", 0);
        self.ticks(axis, 3);
    }

    fn leaves_the_range(&mut self, axis: usize) {
        self.company(axis);
        // The axis is at the end of the range, and not at rest.
        let position = if self.is_odd(axis) { i32::MIN } else { i32::MAX };
        let motion = EntryMotion::Point(Point {
            position,
            velocity: position.signum() << 16,
            acceleration: 0,
        });
        self.entry(axis, 2, motion, false);
        self.set_off(axis);
        self.ticks(axis, 5);
        self.bring_up(axis);
        self.swings(axis);
    }

    /// Swaps two short tables in turn during a move: at once, by a handover and when settled.
    fn tables_in_flight(&mut self, axis: usize) {
        let (one, count) = (self.fraction(axis), self.below(3) as usize + 2);
        for bank in [1, 2] {
            self.table.draw(&mut self.rng, count, one, 4);
            let taps = self.table.taps.clone();
            self.load(axis, bank, &taps);
        }
        let back = self.one_in(2);
        self.goes(axis, SLOW, back);
        self.set_off(axis);
        for (bank, how) in [(1, 0), (2, 1), (1, 2), (2, 2), (1, 1), (2, 0)] {
            self.tell(axis, "swap", bank | how << 4);
            let ticks = self.below(4) + 4;
            self.ticks(axis, ticks);
        }
        self.tell(axis, "stop", 0);
        self.ticks(axis, 6);
    }

    /// Changes the gains, and each law with them, during a move.
    fn settings_and_laws(&mut self, axis: usize) {
        let back = self.one_in(2);
        self.goes(axis, SLOW << 1, back);
        self.set_off(axis);
        for _ in 0..3 {
            self.settings(axis);
        }
    }

    /// Sets a manual duty within its time and beyond it, and runs the self-test of the pins.
    fn by_hand(&mut self, axis: usize) {
        self.direct(axis);
        self.ticks(axis, 1);
        self.tell(axis, "control", 0);
        self.tell(axis, "clear_faults", 0);
        self.wait(axis, 40);
        self.tell(axis, "control", 6);
        self.tell(axis, "direct", 17);
        self.ticks(axis, 7);
        self.tell(axis, "control", 0);
    }

    fn counts_and_interrupts(&mut self, axis: usize) {
        self.act(axis, Do::Encoder(Moves::Walks));
        self.low(axis, "home", self.tick_clocks);
        for _ in 0..3 {
            self.index(axis);
            self.interrupts(axis);
            self.ticks(axis, 2);
        }
    }

    /// Arms the compare with a row of positions on both sides of the axis, and passes some of them there and back.
    fn passes_positions(&mut self, axis: usize) {
        const POSITIONS: i32 = 4096;
        let spacing = self.below(4) as i32 + 1;
        let [hysteresis, pulse_clocks] = [4, 60].map(|below| self.below(below));
        self.tell(axis, "compare_control", 0b11 | hysteresis << 16);
        self.tell(axis, "compare_spacing", spacing as u32);
        self.tell(axis, "compare_positions", POSITIONS as u32);
        self.beside_in(axis, "compare_first", 0, -spacing * POSITIONS / 2);
        self.tell(axis, "compare_pulse", pulse_clocks);
        self.tell(axis, "compare_arm", 0);
        self.company(axis);
        let back = self.is_odd(axis);
        for back in [back, !back] {
            self.goes(axis, FAST, back);
            self.set_off(axis);
            self.ticks(axis, 8);
            self.tell(axis, "stop", 0);
            self.ticks(axis, 4);
            self.bring_up(axis);
        }
    }
}
