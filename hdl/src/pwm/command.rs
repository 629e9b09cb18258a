//! Computes the pattern and the edges of a half period from a duty, with one adder.
//!
//! The accumulator holds four times the number of clocks from the edge: it counts up in the half with the rising edge
//! and down in the half with the falling edge, so that its sign is the level. In the 16 clocks before a boundary it
//! computes instead; an edge in these clocks is noted before. With U = twice the leg's duty, which is 2 |duty|, or
//! `period` + duty when locked:
//!
//! | step | | valley | peak |
//! |---|---|---|---|
//! | 0 | A = 0; duty and mode are read | | |
//! | 1 | A = \|duty\| | | |
//! | 2, 3 | A > max_duty or > period: limited; A = 0 | | |
//! | 4, 5 | A = U, of the limited duty | | |
//! | 6 … | | A = U − 2 D = 2 W | A = U − 2 P − 2 + 2 D |
//! | | | W < minimum pulse: too short | L < minimum pulse: too long |
//! | | | A = U − 2 P − 2 + 2 D | A = U − 2 D = 2 W |
//! | | | L < minimum pulse: too long | W < minimum pulse: too short |
//! | | | A = − 4 rise | A = 2 W − 2, from the peak to the fall |
//!
//! At a peak that takes no command the accumulator continues to count, and only 4 D is subtracted from it.
//!
//! Each step after the first has a flip-flop, its token, so that its selections need no decoder.

use crate::prelude::*;

kernel! {
    pub(super) struct Command;

    inputs {
        rst: Bit,
        mode: Bits<2>,
        duty: Signed<17>,
        max_duty: Bits<16>,
        update_at_peak: Bit,
        period: Bits<17>,
        dead_time: Bits<10>,
        minimum_pulse: Bits<10>,
        valley_lead: Bit,
        peak_lead: Bit,
        waits: Bit,
    }
    outputs {
        valley_next: Bit,
        peak_next: Bit,
        updates: Bit,
        computes: Bit,
        level: Bit,
        new_mode: Bits<2>,
        negative: Bit,
        saturated: Bit,
        too_short: Bit,
        too_long: Bit,
    }
    registers {
        step: Bits<5>, works: Bit, rises: Bit, takes: Bit, mode_q: Bits<2>, duty_q: Signed<17>,
        accumulator: Bits<19>, early: Bits<4>, level_q: Bit, limited: Bit, short_q: Bit, long_q: Bit,
        size: Bit, over_maximum: Bit, over_period: Bit, once: Bit, twice: Bit, less_dead: Bit, shortness: Bit,
        with_dead: Bit, less_period: Bit, less_periods: Bit, mirror: Bit, longness: Bit, to_rise: Bit,
        plus_period: Bit, plus_periods: Bit, less_dead_first: Bit, to_fall: Bit,
    }
    wires {
        begins_valley: Bit, begins: Bit, taking: Bit, ends: Bit, resumes: Bit, locked: Bit, below_zero: Bit,
        one_sided: Bit, counts: Bit, down: Bit, loads: Bit, turned: Bit, of_period: Bit, of_duty: Bit,
        of_maximum: Bit, of_dead: Bit, of_pulse: Bit, inverts: Bit, carries: Bit, writes: Bit, first_0: Bit,
        first_1: Bit, second_0: Bit, second_1: Bit, wide_duty: Signed<19>, none: Bits<19>, first: Bits<19>,
        second: Bits<19>, chosen: Bits<19>, step_size: Bits<19>, addend: Bits<19>, sum: Bits<19>, under: Bit,
    }
}

impl Logic for Command {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module pwm_command");

        comment!("The last 32 clocks before a valley, 16 at a peak");
        self.begins_valley.next = self.step.q.val() == 16;
        self.begins.next = self.begins_valley.val() | (self.peak_lead.val() & !self.valley_lead.val());
        self.taking.next = self.begins.val() & (self.begins_valley.val() | self.update_at_peak.val());
        self.ends.next = self.step.q.val().all();
        self.resumes.next = (self.step.q.val() == 27) & !self.takes.q.val();
        self.locked.next = self.mode_q.q.val().all();
        self.below_zero.next = self.duty_q.q.val().get_bit(16);
        self.one_sided.next = (self.mode_q.q.val() == 1) & self.below_zero.val();

        comment!("Counts where nothing is computed");
        self.counts.next = !self.works.q.val()
            | (!self.takes.q.val()
                & !(self.less_dead_first.q.val()
                    | self.less_dead.q.val()
                    | self.shortness.q.val()
                    | self.to_fall.q.val()));
        self.down.next = !self.works.q.val() & !self.rises.q.val();

        comment!("Operands that the step adds");
        self.loads.next = self.once.q.val() | (self.twice.q.val() & !self.locked.val());
        self.turned.next = self.below_zero.val()
            & (self.size.q.val() | (self.loads.val() & (self.limited.q.val() == self.locked.val())));
        self.of_period.next = self.over_period.q.val()
            | self.less_period.q.val()
            | self.less_periods.q.val()
            | self.plus_period.q.val()
            | self.plus_periods.q.val()
            | (self.twice.q.val() & self.locked.val());
        self.of_duty.next = self.size.q.val() | (self.loads.val() & !self.limited.q.val());
        self.of_maximum.next = self.over_maximum.q.val() | (self.loads.val() & self.limited.q.val());
        self.of_dead.next =
            self.less_dead_first.q.val() | self.less_dead.q.val() | self.with_dead.q.val() | self.mirror.q.val();
        self.of_pulse.next = self.shortness.q.val() | self.longness.q.val();
        self.carries.next = self.turned.val()
            | self.down.val()
            | self.less_dead.q.val()
            | self.shortness.q.val()
            | self.less_dead_first.q.val()
            | self.plus_period.q.val()
            | self.plus_periods.q.val();
        self.inverts.next = self.turned.val()
            | self.down.val()
            | self.less_dead.q.val()
            | self.shortness.q.val()
            | self.less_dead_first.q.val()
            | self.over_maximum.q.val()
            | self.over_period.q.val()
            | self.less_period.q.val()
            | self.less_periods.q.val()
            | self.to_fall.q.val();
        self.writes.next = self.counts.val()
            | self.size.q.val()
            | (self.loads.val() & !self.one_sided.val())
            | (self.of_period.val() & !self.over_period.q.val())
            | self.of_dead.val()
            | self.to_rise.q.val()
            | self.to_fall.q.val();

        comment!("Operand: 01 duty or limit, 10 twice dead time or");
        comment!("pulse, 11 period; two bits select in one LUT");
        self.first_0.next = self.of_duty.val() | self.of_period.val();
        self.first_1.next = self.of_maximum.val() | self.of_period.val();
        self.second_0.next = self.of_dead.val() | self.of_period.val();
        self.second_1.next = self.of_pulse.val() | self.of_period.val();
        self.wide_duty.next = signed_bit_cast::<19, 17>(self.duty_q.q.val());
        self.none.next = 0.into();
        self.first.next = self.none.val();
        if self.first_0.val() {
            self.first.next = unsigned_cast(self.wide_duty.val());
        }
        if self.first_1.val() {
            self.first.next = bit_cast::<19, 16>(self.max_duty.val());
            if self.first_0.val() {
                self.first.next = !self.none.val();
            }
        }
        self.second.next = self.none.val();
        if self.second_0.val() {
            self.second.next = bit_cast::<19, 10>(self.dead_time.val()) << 1;
        }
        if self.second_1.val() {
            self.second.next = bit_cast::<19, 10>(self.minimum_pulse.val()) << 1;
            if self.second_0.val() {
                self.second.next = !self.none.val();
            }
        }
        self.chosen.next = (self.first.val() & self.second.val() & bit_cast::<19, 17>(self.period.val()))
            | (self.first.val() ^ self.second.val());
        if self.inverts.val() {
            self.chosen.next = !((self.first.val() & self.second.val() & bit_cast::<19, 17>(self.period.val()))
                | (self.first.val() ^ self.second.val()));
        }

        comment!("Small constants, if no operand is selected");
        self.step_size.next = 0.into();
        if self.counts.val() {
            self.step_size.next = 4.into();
        }
        if self.resumes.val() {
            self.step_size.next = 20.into();
        }
        if self.to_rise.q.val() {
            self.step_size.next = 2.into();
            if self.period.val().get_bit(0) {
                self.step_size.next = 4.into();
            }
        }
        if self.to_fall.q.val() {
            self.step_size.next = 1.into();
        }
        self.addend.next = self.chosen.val() ^ self.step_size.val();
        self.sum.next = self.accumulator.q.val() + self.addend.val() + bit_cast::<19, 1>(self.carries.val().into());
        self.under.next = self.sum.val().get_bit(18);

        if !self.waits.val() {
            comment!("Steps count from the lead on");
            if self.step.q.val().any() | self.valley_lead.val() | self.peak_lead.val() {
                self.step.d.next = self.step.q.val() + 1;
            }
            if self.peak_lead.val() {
                self.step.d.next = 17.into();
            }
            if self.valley_lead.val() {
                self.step.d.next = 1.into();
            }
            self.works.d.next = self.begins.val() | (self.works.q.val() & !self.to_fall.q.val() & !self.ends.val());

            comment!("A command is read");
            if self.begins.val() {
                self.rises.d.next = self.begins_valley.val();
                self.takes.d.next = self.taking.val();
            }
            if self.taking.val() {
                self.mode_q.d.next = self.mode.val();
                self.duty_q.d.next = self.duty.val();
            }

            comment!("Tokens of the steps");
            self.size.d.next = self.taking.val();
            self.over_maximum.d.next = self.size.q.val();
            self.over_period.d.next = self.over_maximum.q.val();
            self.once.d.next = self.over_period.q.val();
            self.twice.d.next = self.once.q.val();
            self.less_dead.d.next = (self.twice.q.val() & self.rises.q.val()) | self.less_dead_first.q.val();
            self.shortness.d.next = self.less_dead.q.val();
            self.with_dead.d.next = self.shortness.q.val() & self.rises.q.val();
            self.less_period.d.next = (self.twice.q.val() & !self.rises.q.val()) | self.with_dead.q.val();
            self.less_periods.d.next = self.less_period.q.val();
            self.mirror.d.next = self.less_periods.q.val();
            self.longness.d.next = self.mirror.q.val();
            self.to_rise.d.next = self.longness.q.val() & self.rises.q.val();
            self.plus_period.d.next = self.longness.q.val() & !self.rises.q.val();
            self.plus_periods.d.next = self.plus_period.q.val();
            self.less_dead_first.d.next = self.plus_periods.q.val() | self.resumes.val();
            self.to_fall.d.next = self.shortness.q.val() & !self.rises.q.val();

            comment!("Results");
            if self.writes.val() {
                self.accumulator.d.next = self.sum.val();
            }
            if self.taking.val() | self.over_period.q.val() {
                self.accumulator.d.next = 0.into();
            }
            if self.over_maximum.q.val() {
                self.limited.d.next = !self.under.val();
            }
            if (self.over_period.q.val() & !self.under.val()) | (self.once.q.val() & self.one_sided.val()) {
                self.limited.d.next = true;
            }
            if self.shortness.q.val() & self.takes.q.val() {
                self.short_q.d.next = self.under.val();
            }
            if self.longness.q.val() {
                self.long_q.d.next = !self.under.val();
            }

            comment!("Level: the sign, or the edge noted before");
            if self.begins.val() {
                self.early.d.next = self.accumulator.q.val().get_bits::<4>(2);
                if self.rises.q.val() {
                    self.early.d.next = !self.accumulator.q.val().get_bits::<4>(2);
                }
            }
            if !self.works.q.val() | self.ends.val() {
                self.level_q.d.next = !self.under.val();
            } else {
                if self.early.q.val() == self.step.q.val().get_bits::<4>(0) {
                    self.level_q.d.next = !self.rises.q.val();
                }
            }
        }

        self.valley_next.next = self.ends.val() & self.rises.q.val() & !self.waits.val();
        self.peak_next.next = self.ends.val() & !self.rises.q.val() & !self.waits.val();
        self.updates.next = self.ends.val() & self.takes.q.val() & !self.waits.val();
        self.computes.next = self.works.q.val();
        self.level.next = self.level_q.q.val();
        self.new_mode.next = self.mode_q.q.val();
        self.negative.next = self.below_zero.val();
        self.saturated.next = self.limited.q.val();
        self.too_short.next = self.short_q.q.val();
        self.too_long.next = self.long_q.q.val();
    }
}
