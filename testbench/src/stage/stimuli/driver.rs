//! A driver of a stage with seeded random plans: it configures an axis, switches it on, loads and starts moves,
//! changes tables, settings and limits, kicks watchdogs, and now and then does what a driver should not do.

use std::collections::VecDeque;

use posicast_blocks::axis::KICK;
use posicast_blocks::registers::RegisterMap;
use posicast_blocks::segments::{CubicEntry, ENTRY_WORDS, Entry, EntryMotion, Point};
use posicast_taps::COEFFICIENT_MAX;
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::stimuli::table::{Table, pick};

mod scenes;

/// How an encoder moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Moves {
    /// It does not move.
    Still,
    /// It follows the mean of the gates.
    Follows,
    /// It moves back and forth at random.
    Walks,
}

/// An event at an axis's pins.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Pins {
    /// A line, of the axis or shared, goes low for this many clocks.
    Low(&'static str, u32),
    /// The encoder moves in this way from now on.
    Encoder(Moves),
    /// Both lines of the encoder change at once.
    Slip,
}

/// The next action of a driver.
#[derive(Debug, Clone, Copy)]
enum Do {
    Write(u32, u32),
    /// Writes the position of the axis plus an amount, both with `fraction` bits below the counts.
    Beside {
        offset: u32,
        fraction: u32,
        amount: i32,
    },
    Wait(u32),
    /// Moves the axis onto limit switches: bit 0 is +, bit 1 is −; 0 moves it off them.
    Switch(u32),
    /// Waits until the brake is released, for at most this many clocks.
    Released(u32),
    /// Waits until the drive is disabled, for at most this many clocks.
    Disabled(u32),
    /// Like the same event of [`Pins`].
    Low(&'static str, u32),
    Encoder(Moves),
    Slip,
}

/// State of an axis as its driver sees it.
#[derive(Debug, Clone)]
struct Plan {
    name: String,
    script: VecDeque<Do>,
    /// Approximate position in counts.
    here: i32,
    /// Limit switches that the axis is on: bit 0 is +, bit 1 is −.
    switches: u32,
    /// Whether the brake is released.
    released: bool,
    /// Whether the drive is enabled.
    on: bool,
    /// Pending events at its pins.
    pins: Vec<Pins>,
}

/// A driver of all axes of a stage, each with its own plans, on one bus.
#[derive(Debug, Clone)]
pub(crate) struct Driver {
    rng: Xoshiro256PlusPlus,
    map: RegisterMap,
    tick_clocks: u32,
    axes: Vec<Plan>,
    table: Table,
    /// Number of times that all scenes have been played.
    round: u32,
}

impl Driver {
    /// Creates a driver of the axes of these names. Equal seeds give equal plans.
    pub(crate) fn new(map: &RegisterMap, axes: &[String], seed: u64) -> Self {
        let plan = |name: &String| Plan {
            name: name.clone(),
            script: VecDeque::new(),
            here: 0,
            switches: 0,
            released: false,
            on: false,
            pins: Vec::new(),
        };
        Self {
            rng: Xoshiro256PlusPlus::seed_from_u64(!seed),
            tick_clocks: map.register("tick_clocks").map_or(1000, |register| register.reset()),
            map: map.clone(),
            axes: axes.iter().map(plan).collect(),
            table: Table::with_capacity(256),
            round: 0,
        }
    }

    /// Discards all plans and configures all axes again.
    pub(crate) fn begin_anew(&mut self) {
        for axis in 0..self.axes.len() {
            self.axes[axis].script.clear();
            self.axes[axis].switches = 0;
            self.settle(axis);
        }
    }

    /// Makes a plan for an idle axis, once in `pace` clocks. `on`: its drive is enabled.
    pub(crate) fn plan(&mut self, axis: usize, on: bool, pace: u32) {
        if !self.axes[axis].script.is_empty() || !self.one_in(pace) {
            return;
        }
        self.think_of(axis, on);
    }

    /// Advances by a clock. Returns the register and the word to write in it, if any.
    pub(crate) fn clock(&mut self) -> Option<(u32, u32)> {
        self.pass(0);
        let first = self.below(self.axes.len() as u32) as usize;
        if self.one_in(5) {
            return None;
        }
        self.next_write(first)
    }

    /// Returns at most so many writes that come next, and the mask of the axes that they belong to. Those of an axis stay in
    /// order.
    pub(crate) fn due_writes(&mut self, most: usize) -> (Vec<(u32, u32)>, u32) {
        let (mut writes, mut axes) = (Vec::new(), 0);
        let first = self.below(self.axes.len() as u32) as usize;
        let count = self.axes.len();
        for axis in (0..count).map(|at| (first + at) % count) {
            while writes.len() < most
                && let Some(write) = self.next_write(axis)
            {
                writes.push(write);
                axes |= 1 << axis;
            }
        }
        (writes, axes)
    }

    fn next_write(&mut self, axis: usize) -> Option<(u32, u32)> {
        match self.axes[axis].script.front().copied() {
            Some(Do::Write(offset, data)) => {
                self.axes[axis].script.pop_front();
                Some((offset, data))
            }
            Some(Do::Beside {
                offset,
                fraction,
                amount,
            }) => {
                self.axes[axis].script.pop_front();
                Some((offset, (self.axes[axis].here << fraction).wrapping_add(amount) as u32))
            }
            _ => None,
        }
    }

    /// Lets a clock pass for the axes that are not in the mask `waiting`: those await an access.
    pub(crate) fn pass(&mut self, waiting: u32) {
        let passes = |(at, axis)| (waiting >> at & 1 == 0).then_some(axis);
        for axis in self.axes.iter_mut().enumerate().filter_map(passes) {
            match axis.script.front_mut() {
                Some(Do::Wait(0)) => {
                    axis.script.pop_front();
                }
                Some(Do::Wait(clocks)) => *clocks -= 1,
                Some(Do::Released(clocks)) if axis.released || *clocks == 0 => {
                    axis.script.pop_front();
                }
                Some(Do::Released(clocks)) => *clocks -= 1,
                Some(Do::Disabled(clocks)) if !axis.on || *clocks == 0 => {
                    axis.script.pop_front();
                }
                Some(Do::Disabled(clocks)) => *clocks -= 1,
                Some(Do::Switch(which)) => {
                    axis.switches = *which;
                    axis.script.pop_front();
                }
                Some(Do::Low(line, clocks)) => {
                    axis.pins.push(Pins::Low(line, *clocks));
                    axis.script.pop_front();
                }
                Some(Do::Encoder(moves)) => {
                    axis.pins.push(Pins::Encoder(*moves));
                    axis.script.pop_front();
                }
                Some(Do::Slip) => {
                    axis.pins.push(Pins::Slip);
                    axis.script.pop_front();
                }
                Some(Do::Write(..) | Do::Beside { .. }) | None => {}
            }
        }
    }

    /// Takes the approximate position of an axis in counts, and whether its drive is enabled and its brake released.
    /// Returns the events for its pins.
    pub(crate) fn sees(&mut self, axis: usize, here: i32, on: bool, released: bool) -> Vec<Pins> {
        let plan = &mut self.axes[axis];
        (plan.here, plan.on, plan.released) = (here, on, released);
        std::mem::take(&mut plan.pins)
    }

    /// Returns whether an axis is in a sequence of writes.
    pub(crate) fn writes(&self, axis: usize) -> bool {
        matches!(self.axes[axis].script.front(), Some(Do::Write(..) | Do::Beside { .. }))
    }

    /// Returns the limit switches that an axis is on: bit 0 is +, bit 1 is −.
    pub(crate) fn switches(&self, axis: usize) -> u32 {
        self.axes[axis].switches
    }

    fn one_in(&mut self, clocks: u32) -> bool {
        self.rng.random_range(0..clocks.max(1)) == 0
    }

    fn below(&mut self, end: u32) -> u32 {
        self.rng.random_range(0..end.max(1))
    }

    fn pick<T: Copy>(&mut self, choices: &[T]) -> T {
        *pick(&mut self.rng, choices)
    }

    fn write(&mut self, axis: usize, register: &str, data: u32) {
        let found = self.map.register(register);
        let access = found.map(|register| Do::Write(register.offset, data));
        self.axes[axis].script.extend(access);
    }

    fn tell(&mut self, axis: usize, register: &str, data: u32) {
        let name = format!("{}_{register}", self.axes[axis].name);
        self.write(axis, &name, data);
    }

    /// Writes the axis's position at that time plus these counts, both Q24.8.
    fn beside(&mut self, axis: usize, register: &str, counts: i32) {
        self.beside_in(axis, register, 8, counts);
    }

    /// The same with another number of bits below the counts.
    fn beside_in(&mut self, axis: usize, register: &str, fraction: u32, amount: i32) {
        let name = format!("{}_{register}", self.axes[axis].name);
        let found = self.map.register(&name);
        let access = found.map(|register| Do::Beside {
            offset: register.offset,
            fraction,
            amount,
        });
        self.axes[axis].script.extend(access);
    }

    fn wait(&mut self, axis: usize, clocks: u32) {
        self.axes[axis].script.push_back(Do::Wait(clocks));
    }

    fn ticks(&mut self, axis: usize, ticks: u32) {
        self.wait(axis, ticks * self.tick_clocks);
    }

    /// Writes what a driver writes first, so that the axis can work.
    fn settle(&mut self, axis: usize) {
        let random = self.rng.next_u32();
        self.tell(axis, "settle", random & 3);
        let off_causes = self.pick(&[0, 0, 0xffff, random >> 16]);
        self.tell(axis, "watchdog", off_causes << 16);
        self.unlimited(axis);
        let slowly = 1 << (20 + (random >> 8 & 7));
        let deceleration = self.pick(&[slowly, slowly, slowly, 0]);
        self.tell(axis, "stop_deceleration", deceleration);
        self.tell(axis, "swap", 0);
        self.tell(axis, "law", random >> 4 & 1);
        self.tell(axis, "control", 0);
        // Random writes may have left axes in a feed hold.
        self.write(axis, "feed_hold", 0);
        self.write(axis, "commit", 0);
    }

    /// Plans what a driver does with an axis that is off, or on.
    fn think_of(&mut self, axis: usize, on: bool) {
        let choice = self.below(20);
        match choice {
            _ if !on && choice < 12 => self.switch_on(axis),
            _ if !on && choice < 15 => self.direct(axis),
            0..=3 => self.motion(axis),
            4..=6 => self.swings(axis),
            7..=8 => self.interrupted(axis),
            9..=11 => self.onto_a_switch(axis),
            12..=13 => self.limits(axis),
            14 => self.watchdog(axis),
            15 => self.taps(axis),
            16..=17 => self.settings(axis),
            18 => self.interrupts(axis),
            _ => self.index(axis),
        }
    }

    /// Discards the queued entries. This takes effect at a tick: entries that come before the tick are discarded too.
    fn flush(&mut self, axis: usize) {
        self.tell(axis, "flush", 0);
        self.ticks(axis, 1);
    }

    /// Plans a move that a command interrupts.
    fn interrupted(&mut self, axis: usize) {
        self.flush(axis);
        self.there_and_back(axis, 4);
        self.start(axis);
        let before = self.below(4 * self.tick_clocks);
        self.wait(axis, before);
        match self.below(7) {
            0 => self.start(axis),
            1..=3 => self.tell(axis, "stop", 0),
            4 => self.tell(axis, "control", 0),
            5 => self.held(axis),
            _ => self.tell(axis, "flush", 0),
        }
        self.ticks(axis, 4);
    }

    /// Plans a feed hold for a few ticks, then a continuation.
    fn held(&mut self, axis: usize) {
        self.write(axis, "feed_hold", 1 << axis);
        let ticks = self.below(6);
        self.there_and_back(axis, 1);
        self.ticks(axis, ticks + 1);
        self.write(axis, "feed_hold", 0);
    }

    /// Plans a motion from end to end of the number range, through a table with the largest coefficients.
    fn swings(&mut self, axis: usize) {
        let one = 1 << self.fraction(axis);
        self.tell(axis, "swap", 0);
        self.ticks(axis, 1);
        self.load(axis, 1, &[(COEFFICIENT_MAX, 0), (one - COEFFICIENT_MAX, 1)]);
        self.tell(axis, "swap", 1);
        self.flush(axis);
        if self.one_in(2) {
            // This is more than the sums hold.
            self.entry(axis, 3, EntryMotion::Jerk((1 << 38) - 1), false);
        }
        // The axis stays at rest there, or leaves the range of the position's word.
        let leaves = i32::from(self.one_in(2));
        for position in [i32::MAX, i32::MIN, i32::MAX, 0] {
            let motion = EntryMotion::Point(Point {
                position,
                velocity: leaves * position.signum(),
                acceleration: 0,
            });
            self.entry(axis, 1, motion, false);
        }
        self.start(axis);
        self.ticks(axis, 5);
        self.tell(axis, "swap", 0);
    }

    /// Moves back and forth while the axis is on a switch.
    fn onto_a_switch(&mut self, axis: usize) {
        self.flush(axis);
        self.there_and_back(axis, 2);
        self.start(axis);
        let (clocks, which) = (self.below(3 * self.tick_clocks), self.below(3) + 1);
        self.wait(axis, clocks);
        self.axes[axis].script.push_back(Do::Switch(which));
        self.ticks(axis, 3);
        self.axes[axis].script.push_back(Do::Switch(0));
    }

    fn switch_on(&mut self, axis: usize) {
        if self.one_in(3) {
            self.settle(axis);
        }
        let invert = self.below(4) & 1;
        self.tell(axis, "control", 0);
        // This works only while the drive is off; otherwise it is refused.
        self.tell(axis, "encoder", invert);
        self.tell(axis, "scale_control", invert);
        self.tell(axis, "clear_faults", 0);
        let while_clearing = self.pick(&[20, 40, self.tick_clocks]);
        self.wait(axis, while_clearing);
        self.tell(axis, "control", 1);
        if self.one_in(4) {
            let ticks = self.below(3);
            self.ticks(axis, ticks);
            let refused = self.below(2);
            self.tell(axis, "encoder", refused);
        }
        let ticks = self.below(3) + 1;
        self.ticks(axis, ticks);
    }

    fn direct(&mut self, axis: usize) {
        self.tell(axis, "control", 0);
        self.tell(axis, "clear_faults", 0);
        self.wait(axis, 40);
        self.tell(axis, "control", 2);
        for _ in 0..=self.below(3) {
            // The second is mostly beyond the limit of a manual duty.
            let duty = [self.below(80) as i32 - 40, self.below(1 << 16) as i32 - (1 << 15)];
            let duty = self.pick(&duty);
            self.tell(axis, "direct", duty as u32);
            let ticks = self.below(5);
            self.ticks(axis, ticks);
        }
        let leave = self.pick(&[0, 0, 3]);
        self.tell(axis, "control", leave);
    }

    fn entry(&mut self, axis: usize, ticks: u32, motion: EntryMotion, notify: bool) {
        self.write_entry(axis, Entry { ticks, motion, notify }.words());
    }

    fn write_entry(&mut self, axis: usize, words: [u32; ENTRY_WORDS]) {
        let name = format!("{}_segment", self.axes[axis].name);
        let base = self.map.register(&name).map_or(0, |register| register.offset);
        let words = (base..).zip(words);
        let writes = words.map(|(offset, word)| Do::Write(offset, word));
        self.axes[axis].script.extend(writes);
    }

    /// Moves there and back: the jerks j, −2·j, j end at rest.
    fn there_and_back(&mut self, axis: usize, ticks: u32) {
        let any = self.rng.random_range(-(1i64 << 39)..1 << 39);
        let jerk = any >> self.rng.random_range(6..26);
        for (ticks, jerk) in [(ticks, jerk), (2 * ticks, -jerk), (ticks, jerk)] {
            let notify = self.one_in(2);
            self.entry(axis, ticks, EntryMotion::Jerk(jerk), notify);
        }
    }

    /// Plans moves that end at rest, and some that do not.
    fn motion(&mut self, axis: usize) {
        if self.one_in(2) {
            self.flush(axis);
        }
        for _ in 0..=self.below(2) {
            let ticks = self.below(2) + 1;
            self.there_and_back(axis, ticks);
        }
        match self.below(24) {
            0..=2 => self.point(axis),
            // This entry does not end at rest.
            3..=6 => self.entry(axis, 2, EntryMotion::Jerk(1 << 28), true),
            9..=11 => self.batch(axis),
            // An entry of 0 ticks is ignored.
            7 => self.entry(axis, 0, EntryMotion::Jerk(1), true),
            // These are more entries than the FIFO holds.
            8 => (0..70).for_each(|_| self.entry(axis, 1, EntryMotion::Jerk(0), false)),
            _ => {}
        }
        self.start(axis);
        let ticks = self.below(10);
        self.ticks(axis, ticks);
    }

    /// Cubics that are taken together, the last one at a standstill; now and then one of them is wrong.
    fn batch(&mut self, axis: usize) {
        let any = self.rng.next_u32() as i32;
        let cubic = |velocity, acceleration, jerk| Entry {
            ticks: 2,
            motion: EntryMotion::Cubic(CubicEntry {
                jerk,
                velocity,
                acceleration,
            }),
            notify: false,
        };
        let moves = cubic(any >> 12, any << 7 >> 9, any << 9 >> 5);
        let mut words = Entry::batch(&[moves, moves, cubic(0, 0, 0)]);
        if self.one_in(4) {
            words[1][3] |= 1 << 24;
        }
        for words in words {
            self.write_entry(axis, words);
        }
    }

    fn point(&mut self, axis: usize) {
        let any = self.rng.next_u32() as i32;
        let (velocity, acceleration) = self.pick(&[(0, 0), (0, 0), (any >> 4, any >> 9)]);
        let motion = EntryMotion::Point(Point {
            position: self.pick(&[any >> 20, any >> 12, any]),
            velocity,
            acceleration,
        });
        let ticks = self.below(3) + 1;
        self.entry(axis, ticks, motion, true);
    }

    /// Starts one axis, some axes, or a mask with invalid axes; mostly after the group stop of another axis has been
    /// cleared.
    fn start(&mut self, axis: usize) {
        if !self.one_in(4) {
            self.tell(axis, "clear_faults", 0);
            self.wait(axis, 16);
        }
        let one = 1 << axis;
        let any = self.below(16);
        let mask = self.pick(&[one, one, one, one, any]);
        self.write(axis, "start", mask);
    }

    fn limits(&mut self, axis: usize) {
        let here = self.axes[axis].here << 8;
        let some = |driver: &mut Self| driver.below(40 << 8) as i32;
        let (plus, minus) = (here + some(self), here - some(self));
        let plus = self.pick(&[plus, plus, minus]);
        self.tell(axis, "soft_limit_plus", plus as u32);
        self.tell(axis, "soft_limit_minus", minus as u32);
        self.tell(axis, "homed", 1);
        if self.one_in(2) {
            let error = self.below(3 << 16);
            self.tell(axis, "following_error_limit", error);
        }
        self.motion(axis);
        if !self.one_in(4) {
            self.unlimited(axis);
        }
    }

    fn unlimited(&mut self, axis: usize) {
        for register in ["following_error_limit", "soft_limit_plus", "soft_limit_minus"] {
            self.tell(axis, register, 0);
        }
    }

    fn watchdog(&mut self, axis: usize) {
        let ticks = self.below(5) + 1;
        let off_causes = self.pick(&[0, 1 << 13]);
        self.tell(axis, "watchdog", ticks | off_causes << 16);
        for _ in 0..self.below(4) {
            let wrong = KICK ^ 1 << self.below(32);
            let word = self.pick(&[KICK, KICK, KICK, wrong]);
            self.tell(axis, "kick", word);
            let clocks = self.below(2 * self.tick_clocks);
            self.wait(axis, clocks);
        }
        let ticks = self.below(7);
        self.ticks(axis, ticks);
        self.tell(axis, "watchdog", off_causes << 16);
    }

    fn fraction(&self, axis: usize) -> u32 {
        let name = format!("{}_coefficient_fraction", self.axes[axis].name);
        self.map.register(&name).map_or(16, |register| register.reset())
    }

    fn load(&mut self, axis: usize, bank: u32, taps: &[(i32, u64)]) {
        for (index, (coefficient, delay)) in (0..).zip(taps) {
            self.tell(axis, "tap_address", index | bank << 8);
            self.tell(axis, "tap", *coefficient as u32 & 0x3_ffff | (*delay as u32) << 18);
        }
    }

    /// Loads a table into bank 1 or 2, then swaps in any of the ways.
    fn taps(&mut self, axis: usize) {
        let (fraction, count) = (self.fraction(axis), self.below(4) as usize + 1);
        self.table.draw(&mut self.rng, count, fraction, 4);
        let bank = self.below(2) + 1;
        let taps = self.table.taps.clone();
        self.load(axis, bank, &taps);
        let how = self.below(4);
        self.tell(axis, "swap", bank | how << 4);
        let ticks = self.below(4);
        self.ticks(axis, ticks);
    }

    fn settings(&mut self, axis: usize) {
        let bank = self.below(2) + 1;
        for row in 0..16 {
            let (any, bit) = (self.rng.next_u32(), 1 << self.below(32));
            let small = any >> self.below(32);
            let setting = self.pick(&[any, any, small, bit, !bit, 0, u32::MAX]);
            self.tell(axis, "setting_address", row | bank << 8);
            self.tell(axis, "setting", setting);
        }
        let law = self.below(4);
        self.tell(axis, "law", law | bank << 8);
        self.write(axis, "commit", 0);
        let ticks = self.below(4);
        self.ticks(axis, ticks);
    }

    fn interrupts(&mut self, axis: usize) {
        let any = self.rng.next_u32();
        self.write(axis, "interrupt_enable", any);
        self.write(axis, "interrupt_state", u32::MAX);
        self.write(axis, "snapshot", 0);
        let test = any.rotate_left(9) & any;
        self.write(axis, "interrupt_test", test);
        self.write(axis, "flags", u32::MAX);
        self.tell(axis, "events", u32::MAX);
    }

    fn index(&mut self, axis: usize) {
        let any = self.rng.next_u32();
        self.tell(axis, "index", any & 0x13f3);
        self.tell(axis, "velocity_filter", any & 0x300);
        self.tell(axis, "index_arm", 0);
        let preset = any >> 16;
        self.tell(axis, "preset", preset);
        let extrapolation = self.pick(&[0, 0, 1, 3, 255]);
        self.tell(axis, "fifo_control", extrapolation << 8 | any & 0x3f);
    }
}
