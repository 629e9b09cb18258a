//! The clocks of a pass: 13 steps of 16 phases, and the address of each step's setting.
//!
//! ```text
//! phase of a step   0         1              2     3      4 … 13    14     15
//!                   address,  setting read   ...   load   shift     add    a register takes the sum
//!                   operand
//! strobe                      reads                loads  shifts    adds   settles
//! ```

use crate::prelude::*;

#[derive(LogicBlock)]
pub(super) struct Sequencer {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) start: Signal<In, Bit>,
    pub(super) law: Signal<In, Bits<2>>,
    pub(super) clear_flags: Signal<In, Bit>,
    pub(super) step: Signal<Out, Bits<4>>,
    pub(super) setting_address: Signal<Out, Bits<4>>,
    pub(super) begins: Signal<Out, Bit>,
    pub(super) reads: Signal<Out, Bit>,
    pub(super) loads: Signal<Out, Bit>,
    pub(super) shifts: Signal<Out, Bit>,
    pub(super) adds: Signal<Out, Bit>,
    pub(super) settles: Signal<Out, Bit>,
    pub(super) linear: Signal<Out, Bit>,
    pub(super) integrates: Signal<Out, Bit>,
    pub(super) busy: Signal<Out, Bit>,
    pub(super) valid: Signal<Out, Bit>,
    pub(super) overrun: Signal<Out, Bit>,

    busy_q: Dff<Bit>,
    step_q: Dff<Bits<4>>,
    phase: Dff<Bits<4>>,
    valid_q: Dff<Bit>,
    overrun_q: Dff<Bit>,
    linear_q: Dff<Bit>,
    integrates_q: Dff<Bit>,

    begins_pass: Signal<Local, Bit>,
    last_phase: Signal<Local, Bit>,
    in_law: Signal<Local, Bit>,

    first_step: Constant<Bits<4>>,
    first_of_law: Constant<Bits<4>>,
    last_of_law: Constant<Bits<4>>,
    last_step: Constant<Bits<4>>,
    to_linear: Constant<Bits<4>>,
    one: Constant<Bits<4>>,
    read_phase: Constant<Bits<4>>,
    load_phase: Constant<Bits<4>>,
    shift_phase: Constant<Bits<4>>,
    add_phase: Constant<Bits<4>>,
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
            loads: Signal::default(),
            shifts: Signal::default(),
            adds: Signal::default(),
            settles: Signal::default(),
            linear: Signal::default(),
            integrates: Signal::default(),
            busy: Signal::default(),
            valid: Signal::default(),
            overrun: Signal::default(),
            busy_q: Dff::default(),
            step_q: Dff::default(),
            phase: Dff::default(),
            valid_q: Dff::default(),
            overrun_q: Dff::default(),
            linear_q: Dff::default(),
            integrates_q: Dff::default(),
            begins_pass: Signal::default(),
            last_phase: Signal::default(),
            in_law: Signal::default(),
            first_step: Constant::new(from_u64(0)),
            first_of_law: Constant::new(from_u64(2)),
            last_of_law: Constant::new(from_u64(4)),
            last_step: Constant::new(from_u64(12)),
            to_linear: Constant::new(from_u64(11)),
            one: Constant::new(from_u64(1)),
            read_phase: Constant::new(from_u64(1)),
            load_phase: Constant::new(from_u64(3)),
            shift_phase: Constant::new(from_u64(4)),
            add_phase: Constant::new(from_u64(14)),
            pid: Constant::new(from_u64(2)),
        }
    }
}

impl Logic for Sequencer {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module sequencer");
        comment!("@about 13 steps of 16 clocks.");
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

        self.begins_pass.next = self.start.val() & !self.busy_q.q.val();
        self.last_phase.next = self.phase.q.val().all();
        if self.clear_flags.val() {
            self.overrun_q.d.next = false;
        }
        self.valid_q.d.next = false;
        if self.busy_q.q.val() {
            self.phase.d.next = self.phase.q.val() + self.one.val();
            if self.last_phase.val() {
                self.step_q.d.next = self.step_q.q.val() + self.one.val();
                if self.step_q.q.val() == self.last_step.val() {
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

        comment!("Steps 2 to 4 of PD and PID have their own gains");
        self.in_law.next =
            (self.step_q.q.val() >= self.first_of_law.val()) & (self.step_q.q.val() <= self.last_of_law.val());
        self.setting_address.next = self.step_q.q.val();
        if self.linear_q.q.val() & self.in_law.val() {
            self.setting_address.next = self.step_q.q.val() + self.to_linear.val();
        }

        comment!("Strobes");
        self.begins.next = self.begins_pass.val();
        self.reads.next = self.phase.q.val() == self.read_phase.val();
        self.loads.next = self.phase.q.val() == self.load_phase.val();
        self.shifts.next = self.phase.q.val() >= self.shift_phase.val();
        self.adds.next = self.phase.q.val() == self.add_phase.val();
        self.settles.next = self.last_phase.val();

        self.step.next = self.step_q.q.val();
        self.linear.next = self.linear_q.q.val();
        self.integrates.next = self.integrates_q.q.val();
        self.busy.next = self.busy_q.q.val();
        self.valid.next = self.valid_q.q.val();
        self.overrun.next = self.overrun_q.q.val();
    }
}
