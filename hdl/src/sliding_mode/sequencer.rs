//! The clocks of a pass: 17 steps of 39 phases, and the address of each step's setting. Five steps need fewer.
//!
//! ```text
//! phase of a step   0         1         2         3      4 … 34    35    36        37        38
//!                   address   setting,  multiply  load   shift     add   cut to    a word    flag of a cut
//!                             operand   empty                            a word    is taken
//! strobe                      reads     empties   loads  shifts    adds  checks    settles   marks
//! ```
//!
//! What is multiplied by one needs no shift: from `load` to `add` at once. e moves by eight to the integral's format.

use crate::prelude::*;

#[derive(LogicBlock)]
pub(super) struct Sequencer {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) start: Signal<In, Bit>,
    pub(super) law: Signal<In, Bits<2>>,
    pub(super) clear_flags: Signal<In, Bit>,
    pub(super) step: Signal<Out, Bits<5>>,
    pub(super) setting_address: Signal<Out, Bits<4>>,
    pub(super) begins: Signal<Out, Bit>,
    pub(super) reads: Signal<Out, Bit>,
    pub(super) empties: Signal<Out, Bit>,
    pub(super) loads: Signal<Out, Bit>,
    pub(super) shifts: Signal<Out, Bit>,
    pub(super) adds: Signal<Out, Bit>,
    pub(super) checks: Signal<Out, Bit>,
    pub(super) settles: Signal<Out, Bit>,
    pub(super) marks: Signal<Out, Bit>,
    pub(super) linear: Signal<Out, Bit>,
    pub(super) integrates: Signal<Out, Bit>,
    pub(super) busy: Signal<Out, Bit>,
    pub(super) valid: Signal<Out, Bit>,
    pub(super) overrun: Signal<Out, Bit>,
    pub(super) ends: Signal<Out, Bit>,

    busy_q: Dff<Bit>,
    step_q: Dff<Bits<5>>,
    phase: Dff<Bits<6>>,
    valid_q: Dff<Bit>,
    overrun_q: Dff<Bit>,
    linear_q: Dff<Bit>,
    integrates_q: Dff<Bit>,

    begins_pass: Signal<Local, Bit>,
    last_phase: Signal<Local, Bit>,
    last_step: Signal<Local, Bit>,
    is_short: Signal<Local, Bit>,
    moves_enough: Signal<Local, Bit>,

    first_step: Constant<Bits<5>>,
    one_step: Constant<Bits<5>>,
    of_sum: Constant<Bits<5>>,
    of_surface: Constant<Bits<5>>,
    of_boundary: Constant<Bits<5>>,
    of_rest: Constant<Bits<5>>,
    of_error: Constant<Bits<5>>,
    of_rate: Constant<Bits<5>>,
    of_fade: Constant<Bits<5>>,
    of_coulomb: Constant<Bits<5>>,
    of_feedback: Constant<Bits<5>>,
    of_acceleration: Constant<Bits<5>>,
    of_reference: Constant<Bits<5>>,
    of_velocity: Constant<Bits<5>>,
    of_limit: Constant<Bits<5>>,
    of_duty: Constant<Bits<5>>,
    first_phase: Constant<Bits<6>>,
    one_phase: Constant<Bits<6>>,
    read_phase: Constant<Bits<6>>,
    empty_phase: Constant<Bits<6>>,
    load_phase: Constant<Bits<6>>,
    eighth_shift: Constant<Bits<6>>,
    add_phase: Constant<Bits<6>>,
    check_phase: Constant<Bits<6>>,
    settle_phase: Constant<Bits<6>>,
    mark_phase: Constant<Bits<6>>,
    surface: Constant<Bits<4>>,
    boundary: Constant<Bits<4>>,
    switching: Constant<Bits<4>>,
    reaching: Constant<Bits<4>>,
    damping: Constant<Bits<4>>,
    fade: Constant<Bits<4>>,
    coulomb: Constant<Bits<4>>,
    feedback: Constant<Bits<4>>,
    acceleration: Constant<Bits<4>>,
    velocity: Constant<Bits<4>>,
    viscous: Constant<Bits<4>>,
    limit: Constant<Bits<4>>,
    duty: Constant<Bits<4>>,
    derivative: Constant<Bits<4>>,
    proportional: Constant<Bits<4>>,
    integral: Constant<Bits<4>>,
    pid: Constant<Bits<2>>,
}

impl Default for Sequencer {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            start: Signal::default(),
            law: Signal::default(),
            clear_flags: Signal::default(),
            step: Signal::default(),
            setting_address: Signal::default(),
            begins: Signal::default(),
            reads: Signal::default(),
            empties: Signal::default(),
            loads: Signal::default(),
            shifts: Signal::default(),
            adds: Signal::default(),
            checks: Signal::default(),
            settles: Signal::default(),
            marks: Signal::default(),
            linear: Signal::default(),
            integrates: Signal::default(),
            busy: Signal::default(),
            valid: Signal::default(),
            overrun: Signal::default(),
            ends: Signal::default(),
            busy_q: Dff::default(),
            step_q: Dff::default(),
            phase: Dff::default(),
            valid_q: Dff::default(),
            overrun_q: Dff::default(),
            linear_q: Dff::default(),
            integrates_q: Dff::default(),
            begins_pass: Signal::default(),
            last_phase: Signal::default(),
            last_step: Signal::default(),
            is_short: Signal::default(),
            moves_enough: Signal::default(),
            first_step: Constant::new(from_u64(0)),
            one_step: Constant::new(from_u64(1)),
            of_sum: Constant::new(from_u64(15)),
            of_surface: Constant::new(from_u64(3)),
            of_boundary: Constant::new(from_u64(4)),
            of_rest: Constant::new(from_u64(5)),
            of_error: Constant::new(from_u64(6)),
            of_rate: Constant::new(from_u64(7)),
            of_fade: Constant::new(from_u64(8)),
            of_coulomb: Constant::new(from_u64(9)),
            of_feedback: Constant::new(from_u64(10)),
            of_acceleration: Constant::new(from_u64(11)),
            of_reference: Constant::new(from_u64(12)),
            of_velocity: Constant::new(from_u64(13)),
            of_limit: Constant::new(from_u64(14)),
            of_duty: Constant::new(from_u64(16)),
            first_phase: Constant::new(from_u64(0)),
            one_phase: Constant::new(from_u64(1)),
            read_phase: Constant::new(from_u64(1)),
            empty_phase: Constant::new(from_u64(2)),
            load_phase: Constant::new(from_u64(3)),
            eighth_shift: Constant::new(from_u64(11)),
            add_phase: Constant::new(from_u64(35)),
            check_phase: Constant::new(from_u64(36)),
            settle_phase: Constant::new(from_u64(37)),
            mark_phase: Constant::new(from_u64(38)),
            surface: Constant::new(from_u64(0)),
            boundary: Constant::new(from_u64(1)),
            switching: Constant::new(from_u64(4)),
            reaching: Constant::new(from_u64(3)),
            damping: Constant::new(from_u64(2)),
            fade: Constant::new(from_u64(5)),
            coulomb: Constant::new(from_u64(10)),
            feedback: Constant::new(from_u64(6)),
            acceleration: Constant::new(from_u64(7)),
            velocity: Constant::new(from_u64(8)),
            viscous: Constant::new(from_u64(9)),
            limit: Constant::new(from_u64(11)),
            duty: Constant::new(from_u64(12)),
            derivative: Constant::new(from_u64(13)),
            proportional: Constant::new(from_u64(14)),
            integral: Constant::new(from_u64(15)),
            pid: Constant::new(from_u64(2)),
        }
    }
}

impl Logic for Sequencer {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module sequencer");
        comment!("@about 17 steps of up to 39 clocks.");
        dff_setup!(
            self,
            clk,
            busy_q,
            step_q,
            phase,
            valid_q,
            overrun_q,
            linear_q,
            integrates_q
        );

        comment!("Steps of ones move nothing, but that of e");
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
