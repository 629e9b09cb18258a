//! The clocks of a computation: 17 steps of 39 phases, and the address of each step's setting. Five steps need fewer
//! phases.
//!
//! ```text
//! phase of a step   0         1         2         3      4 … 34    35    36        37        38
//!                   address   setting,  multiply  load   shift     add   cut to    a word    flag of a cut
//!                             operand   empty                            a word    is taken
//! strobe                      reads     empties   loads  shifts    adds  checks    settles   marks
//! ```
//!
//! A product with one needs no shift: it goes from `load` to `add` at once. e is shifted by eight to the integral's
//! format.

use crate::prelude::*;

kernel! {
    pub(super) struct Sequencer;

    inputs { rst: Bit, start: Bit, law: Bits<2>, clear_flags: Bit }
    outputs {
        step: Bits<5>,
        setting_address: Bits<4>,
        begins: Bit,
        reads: Bit,
        empties: Bit,
        loads: Bit,
        shifts: Bit,
        adds: Bit,
        checks: Bit,
        settles: Bit,
        marks: Bit,
        linear: Bit,
        integrates: Bit,
        busy: Bit,
        valid: Bit,
        overrun: Bit,
        ends: Bit,
    }
    registers {
        busy_q: Bit, step_q: Bits<5>, phase: Bits<6>, valid_q: Bit, overrun_q: Bit, linear_q: Bit,
        integrates_q: Bit,
    }
    wires { begins_pass: Bit, last_phase: Bit, last_step: Bit, is_short: Bit, moves_enough: Bit }
    constants {
        first_step: Bits<5> = from_u64(0),
        one_step: Bits<5> = from_u64(1),
        of_sum: Bits<5> = from_u64(15),
        of_surface: Bits<5> = from_u64(3),
        of_boundary: Bits<5> = from_u64(4),
        of_rest: Bits<5> = from_u64(5),
        of_error: Bits<5> = from_u64(6),
        of_rate: Bits<5> = from_u64(7),
        of_fade: Bits<5> = from_u64(8),
        of_coulomb: Bits<5> = from_u64(9),
        of_feedback: Bits<5> = from_u64(10),
        of_acceleration: Bits<5> = from_u64(11),
        of_reference: Bits<5> = from_u64(12),
        of_velocity: Bits<5> = from_u64(13),
        of_limit: Bits<5> = from_u64(14),
        of_duty: Bits<5> = from_u64(16),
        first_phase: Bits<6> = from_u64(0),
        one_phase: Bits<6> = from_u64(1),
        read_phase: Bits<6> = from_u64(1),
        empty_phase: Bits<6> = from_u64(2),
        load_phase: Bits<6> = from_u64(3),
        eighth_shift: Bits<6> = from_u64(11),
        add_phase: Bits<6> = from_u64(35),
        check_phase: Bits<6> = from_u64(36),
        settle_phase: Bits<6> = from_u64(37),
        mark_phase: Bits<6> = from_u64(38),
        surface: Bits<4> = from_u64(0),
        boundary: Bits<4> = from_u64(1),
        switching: Bits<4> = from_u64(4),
        reaching: Bits<4> = from_u64(3),
        damping: Bits<4> = from_u64(2),
        fade: Bits<4> = from_u64(5),
        coulomb: Bits<4> = from_u64(10),
        feedback: Bits<4> = from_u64(6),
        acceleration: Bits<4> = from_u64(7),
        velocity: Bits<4> = from_u64(8),
        viscous: Bits<4> = from_u64(9),
        limit: Bits<4> = from_u64(11),
        duty: Bits<4> = from_u64(12),
        derivative: Bits<4> = from_u64(13),
        proportional: Bits<4> = from_u64(14),
        integral: Bits<4> = from_u64(15),
        pid: Bits<2> = from_u64(2),
    }
}

impl Logic for Sequencer {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module sequencer");

        comment!("A product with one is not shifted, except e");
        self.begins_pass.next = self.start.val() & !self.busy_q.q.val();
        self.last_phase.next = self.phase.q.val() == self.mark_phase.val();
        self.last_step.next = self.step_q.q.val() == self.of_duty.val();
        self.is_short.next =
            (self.step_q.q.val() < self.of_surface.val()) | (self.step_q.q.val() == self.of_limit.val());
        self.moves_enough.next = (self.phase.q.val() == self.load_phase.val()) & self.is_short.val();
        if (self.phase.q.val() == self.eighth_shift.val()) & (self.step_q.q.val() == self.of_sum.val()) {
            self.moves_enough.next = true;
        }
        if self.clear_flags.val() {
            self.overrun_q.d.next = false;
        }
        self.valid_q.d.next = false;
        if self.busy_q.q.val() {
            self.phase.d.next = self.phase.q.val() + self.one_phase.val();
            if self.moves_enough.val() {
                self.phase.d.next = self.add_phase.val();
            }
            if self.last_phase.val() {
                self.phase.d.next = self.first_phase.val();
                self.step_q.d.next = self.step_q.q.val() + self.one_step.val();
                if self.last_step.val() {
                    self.step_q.d.next = self.first_step.val();
                    self.busy_q.d.next = false;
                    self.valid_q.d.next = true;
                }
            }
            if self.start.val() {
                self.overrun_q.d.next = true;
            }
        }
        if self.begins_pass.val() {
            self.busy_q.d.next = true;
            self.linear_q.d.next = self.law.val().any();
            self.integrates_q.d.next = self.law.val() == self.pid.val();
        }

        comment!("Rows of the settings; PD and PID have their own");
        self.setting_address.next = self.surface.val();
        if self.step_q.q.val() == self.of_boundary.val() {
            self.setting_address.next = self.boundary.val();
        }
        if self.step_q.q.val() == self.of_rest.val() {
            self.setting_address.next = self.switching.val();
            if self.linear_q.q.val() {
                self.setting_address.next = self.integral.val();
            }
        }
        if self.step_q.q.val() == self.of_error.val() {
            self.setting_address.next = self.reaching.val();
            if self.linear_q.q.val() {
                self.setting_address.next = self.proportional.val();
            }
        }
        if self.step_q.q.val() == self.of_rate.val() {
            self.setting_address.next = self.damping.val();
            if self.linear_q.q.val() {
                self.setting_address.next = self.derivative.val();
            }
        }
        if self.step_q.q.val() == self.of_fade.val() {
            self.setting_address.next = self.fade.val();
        }
        if self.step_q.q.val() == self.of_coulomb.val() {
            self.setting_address.next = self.coulomb.val();
        }
        if self.step_q.q.val() == self.of_feedback.val() {
            self.setting_address.next = self.feedback.val();
        }
        if self.step_q.q.val() == self.of_acceleration.val() {
            self.setting_address.next = self.acceleration.val();
        }
        if self.step_q.q.val() == self.of_reference.val() {
            self.setting_address.next = self.velocity.val();
        }
        if self.step_q.q.val() == self.of_velocity.val() {
            self.setting_address.next = self.viscous.val();
        }
        if self.step_q.q.val() == self.of_limit.val() {
            self.setting_address.next = self.limit.val();
        }
        if self.last_step.val() {
            self.setting_address.next = self.duty.val();
        }

        comment!("Strobes");
        self.begins.next = self.begins_pass.val();
        self.reads.next = self.phase.q.val() == self.read_phase.val();
        self.empties.next = self.phase.q.val() == self.empty_phase.val();
        self.loads.next = self.phase.q.val() == self.load_phase.val();
        self.shifts.next = self.phase.q.val() > self.load_phase.val();
        self.adds.next = self.phase.q.val() == self.add_phase.val();
        self.checks.next = self.phase.q.val() == self.check_phase.val();
        self.settles.next = self.phase.q.val() == self.settle_phase.val();
        self.marks.next = self.last_phase.val();

        self.step.next = self.step_q.q.val();
        self.linear.next = self.linear_q.q.val();
        self.integrates.next = self.integrates_q.q.val();
        self.busy.next = self.busy_q.q.val();
        self.valid.next = self.valid_q.q.val();
        self.overrun.next = self.overrun_q.q.val();
        self.ends.next = self.last_phase.val() & self.last_step.val();
    }
}
