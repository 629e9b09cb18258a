//! Requests, registers and references around the pass of one bit per clock.

use super::serial_ratio::SerialRatio;
use crate::prelude::*;

#[derive(LogicBlock)]
pub(super) struct LinearScale {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) tick: Signal<In, Bit>,
    pub(super) motor_position: Signal<In, Signed<32>>,
    pub(super) scale_position: Signal<In, Signed<32>>,
    pub(super) motor_velocity: Signal<In, Signed<32>>,
    pub(super) velocity_valid: Signal<In, Bit>,
    pub(super) align: Signal<In, Bit>,
    pub(super) ratio_mantissa: Signal<In, Signed<18>>,
    pub(super) ratio_shift: Signal<In, Bits<5>>,
    pub(super) use_scale: Signal<In, Bit>,
    pub(super) deviation: Signal<Out, Signed<32>>,
    pub(super) deviation_valid: Signal<Out, Bit>,
    pub(super) position: Signal<Out, Signed<32>>,
    pub(super) velocity: Signal<Out, Signed<32>>,

    serial: SerialRatio,

    deviation_q: Dff<Bits<32>>,
    valid_q: Dff<Bit>,
    position_q: Dff<Bits<32>>,
    velocity_q: Dff<Bits<32>>,
    other: Dff<Bits<32>>,
    operand_reference: Dff<Bits<32>>,
    other_reference: Dff<Bits<32>>,
    positions_wait: Dff<Bit>,
    velocity_waits: Dff<Bit>,
    runs: Dff<Bit>,
    of_position: Dff<Bit>,
    asked: Dff<Bit>,
    aligning: Dff<Bit>,

    takes_positions: Signal<Local, Bit>,
    takes_velocity: Signal<Local, Bit>,
    operand_position: Signal<Local, Bits<32>>,
    other_position: Signal<Local, Bits<32>>,
    ends_position: Signal<Local, Bit>,
    ends_velocity: Signal<Local, Bit>,
    positions_next: Signal<Local, Bit>,
    velocity_next: Signal<Local, Bit>,
    free: Signal<Local, Bit>,
    asked_now: Signal<Local, Bit>,
    silent: Signal<Local, Bit>,
    moves_deviation: Signal<Local, Bit>,
    moves_velocity: Signal<Local, Bit>,
    limit: Signal<Local, Bits<32>>,
    entering: Signal<Local, Bits<32>>,
    operand_entering: Signal<Local, Bits<32>>,
    other_entering: Signal<Local, Bits<32>>,

    nothing: Constant<Bits<32>>,
    largest: Constant<Bits<32>>,
    smallest: Constant<Bits<32>>,
}

impl Default for LinearScale {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            tick: Signal::default(),
            motor_position: Signal::default(),
            scale_position: Signal::default(),
            motor_velocity: Signal::default(),
            velocity_valid: Signal::default(),
            align: Signal::default(),
            ratio_mantissa: Signal::default(),
            ratio_shift: Signal::default(),
            use_scale: Signal::default(),
            deviation: Signal::default(),
            deviation_valid: Signal::default(),
            position: Signal::default(),
            velocity: Signal::default(),
            serial: SerialRatio::default(),
            deviation_q: Dff::default(),
            valid_q: Dff::default(),
            position_q: Dff::default(),
            velocity_q: Dff::default(),
            other: Dff::default(),
            operand_reference: Dff::default(),
            other_reference: Dff::default(),
            positions_wait: Dff::default(),
            velocity_waits: Dff::default(),
            runs: Dff::default(),
            of_position: Dff::default(),
            asked: Dff::default(),
            aligning: Dff::default(),
            takes_positions: Signal::default(),
            takes_velocity: Signal::default(),
            operand_position: Signal::default(),
            other_position: Signal::default(),
            ends_position: Signal::default(),
            ends_velocity: Signal::default(),
            positions_next: Signal::default(),
            velocity_next: Signal::default(),
            free: Signal::default(),
            asked_now: Signal::default(),
            silent: Signal::default(),
            moves_deviation: Signal::default(),
            moves_velocity: Signal::default(),
            limit: Signal::default(),
            entering: Signal::default(),
            operand_entering: Signal::default(),
            other_entering: Signal::default(),
            nothing: Constant::new(from_u64(0)),
            largest: Constant::new(from_u64(0x7fff_ffff)),
            smallest: Constant::new(from_u64(0x8000_0000)),
        }
    }
}

impl Logic for LinearScale {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module linear_scale");
        dff_setup!(
            self,
            clk,
            deviation_q,
            valid_q,
            position_q,
            velocity_q,
            other,
            operand_reference,
            other_reference,
            positions_wait,
            velocity_waits,
            runs,
            of_position,
            asked,
            aligning
        );

        comment!("The loop's counter, and the one to be multiplied");
        self.other_position.next = unsigned_cast(self.motor_position.val());
        self.operand_position.next = unsigned_cast(self.scale_position.val());
        if self.use_scale.val() {
            self.other_position.next = unsigned_cast(self.scale_position.val());
            self.operand_position.next = unsigned_cast(self.motor_position.val());
        }
        self.position_q.d.next = self.other_position.val();

        comment!("The pass, on deviation or velocity");
        self.serial.clk.next = self.clk.val();
        self.serial.rst.next = self.rst.val();
        self.serial.runs.next = self.runs.q.val();
        self.serial.of_position.next = self.of_position.q.val();
        self.serial.use_scale.next = self.use_scale.val();
        self.serial.ratio_mantissa.next = self.ratio_mantissa.val();
        self.serial.ratio_shift.next = self.ratio_shift.val();
        self.serial.operand_bit.next = self.velocity_q.q.val().get_bit(0);
        if self.of_position.q.val() {
            self.serial.operand_bit.next = self.deviation_q.q.val().get_bit(0);
        }
        self.serial.operand_reference_bit.next = self.operand_reference.q.val().get_bit(0);
        self.serial.other_bit.next = self.other.q.val().get_bit(0);
        self.serial.other_reference_bit.next = self.other_reference.q.val().get_bit(0);
        self.ends_position.next = self.serial.last.val() & self.of_position.q.val();
        self.ends_velocity.next = self.serial.last.val() & !self.of_position.q.val();

        comment!("What waits; positions go first");
        self.takes_positions.next = self.tick.val() & !self.positions_wait.q.val();
        self.takes_velocity.next = self.velocity_valid.val() & !self.velocity_waits.q.val();
        self.positions_next.next =
            (self.positions_wait.q.val() & !self.ends_position.val()) | self.takes_positions.val();
        self.velocity_next.next = (self.velocity_waits.q.val() & !self.ends_velocity.val())
            | (self.takes_velocity.val() & self.use_scale.val());
        self.positions_wait.d.next = self.positions_next.val();
        self.velocity_waits.d.next = self.velocity_next.val();
        self.free.next = !self.runs.q.val() | self.serial.last.val();
        self.asked_now.next = self.asked.q.val() | self.align.val();
        self.asked.d.next = self.asked_now.val();
        if self.free.val() {
            self.runs.d.next = self.positions_next.val() | self.velocity_next.val();
            self.of_position.d.next = self.positions_next.val();
            if self.positions_next.val() {
                self.aligning.d.next = self.asked_now.val();
                self.asked.d.next = false;
            }
        }

        comment!("Beyond 32 bits");
        self.limit.next = self.largest.val();
        if self.serial.negative.val() {
            self.limit.next = self.smallest.val();
        }
        self.entering.next = self.nothing.val();
        if self.serial.result_bit.val() {
            self.entering.next = self.smallest.val();
        }

        comment!("The operand leaves, the deviation enters");
        self.moves_deviation.next = self.runs.q.val() & self.of_position.q.val() & self.serial.moves.val();
        self.silent.next = self.asked_now.val() | self.aligning.q.val();
        self.valid_q.d.next = self.ends_position.val();
        if self.moves_deviation.val() {
            self.deviation_q.d.next = (self.deviation_q.q.val() >> 1) | self.entering.val();
        }
        if self.ends_position.val() & self.serial.overflows.val() {
            self.deviation_q.d.next = self.limit.val();
        }
        if (self.ends_position.val() & self.silent.val()) | (self.align.val() & !self.positions_wait.q.val()) {
            self.deviation_q.d.next = self.nothing.val();
        }
        if self.takes_positions.val() {
            self.deviation_q.d.next = self.operand_position.val();
            self.other.d.next = self.other_position.val();
        }

        comment!("So with the velocity");
        self.moves_velocity.next = self.runs.q.val() & !self.of_position.q.val() & self.serial.moves.val();
        if self.moves_velocity.val() {
            self.velocity_q.d.next = (self.velocity_q.q.val() >> 1) | self.entering.val();
        }
        if self.ends_velocity.val() & self.serial.overflows.val() {
            self.velocity_q.d.next = self.limit.val();
        }
        if self.takes_velocity.val() {
            self.velocity_q.d.next = unsigned_cast(self.motor_velocity.val());
        }

        comment!("References turn round, or take what passes");
        self.operand_entering.next = self.operand_reference.q.val() << 31;
        self.other_entering.next = self.other_reference.q.val() << 31;
        if self.aligning.q.val() {
            self.operand_entering.next = self.deviation_q.q.val() << 31;
            self.other_entering.next = self.other.q.val() << 31;
        }
        if self.runs.q.val() & self.of_position.q.val() & self.serial.takes_operand.val() {
            self.operand_reference.d.next = (self.operand_reference.q.val() >> 1) | self.operand_entering.val();
        }
        if self.runs.q.val() & self.of_position.q.val() & self.serial.takes_other.val() {
            self.other_reference.d.next = (self.other_reference.q.val() >> 1) | self.other_entering.val();
            self.other.d.next = self.other.q.val() >> 1;
        }

        comment!("Outputs");
        self.deviation.next = signed_cast(self.deviation_q.q.val());
        self.deviation_valid.next = self.valid_q.q.val();
        self.position.next = signed_cast(self.position_q.q.val());
        self.velocity.next = signed_cast(self.velocity_q.q.val());
    }
}
