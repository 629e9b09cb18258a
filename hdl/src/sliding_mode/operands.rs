//! What a step multiplies: one of eight words, chosen a clock before.
//!
//! One select for each word, and an OR of what they let through: two words per LUT. Which step takes which word is in the
//! table of `kernel`.

use crate::prelude::*;

#[derive(LogicBlock)]
pub(super) struct Operands {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) step: Signal<In, Bits<5>>,
    pub(super) linear: Signal<In, Bit>,
    pub(super) integrates: Signal<In, Bit>,
    pub(super) tracking_error: Signal<In, Signed<24>>,
    pub(super) sliding: Signal<In, Signed<32>>,
    pub(super) held: Signal<In, Signed<32>>,
    pub(super) integral: Signal<In, Signed<32>>,
    pub(super) velocity_reference: Signal<In, Signed<32>>,
    pub(super) acceleration_reference: Signal<In, Signed<32>>,
    pub(super) velocity: Signal<In, Signed<32>>,
    pub(super) word: Signal<In, Signed<32>>,
    pub(super) operand: Signal<Out, Signed<32>>,

    takes_error: Dff<Bit>,
    takes_sliding: Dff<Bit>,
    takes_held: Dff<Bit>,
    takes_integral: Dff<Bit>,
    takes_reference: Dff<Bit>,
    takes_acceleration: Dff<Bit>,
    takes_velocity: Dff<Bit>,
    takes_word: Dff<Bit>,

    error_bits: Signal<Local, Bits<24>>,
    from_error: Signal<Local, Bits<32>>,
    from_sliding: Signal<Local, Bits<32>>,
    from_held: Signal<Local, Bits<32>>,
    from_integral: Signal<Local, Bits<32>>,
    from_reference: Signal<Local, Bits<32>>,
    from_acceleration: Signal<Local, Bits<32>>,
    from_velocity: Signal<Local, Bits<32>>,
    from_word: Signal<Local, Bits<32>>,

    nothing: Constant<Bits<32>>,
    of_reference: Constant<Bits<5>>,
    of_velocity: Constant<Bits<5>>,
    rate_again: Constant<Bits<5>>,
    surface: Constant<Bits<5>>,
    boundary: Constant<Bits<5>>,
    on_rest: Constant<Bits<5>>,
    on_error: Constant<Bits<5>>,
    on_rate: Constant<Bits<5>>,
    fade: Constant<Bits<5>>,
    coulomb: Constant<Bits<5>>,
    on_feedback: Constant<Bits<5>>,
    on_acceleration: Constant<Bits<5>>,
    on_reference: Constant<Bits<5>>,
    on_velocity: Constant<Bits<5>>,
    limit: Constant<Bits<5>>,
    to_sum: Constant<Bits<5>>,
    to_duty: Constant<Bits<5>>,
}

impl Default for Operands {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            step: Signal::default(),
            linear: Signal::default(),
            integrates: Signal::default(),
            tracking_error: Signal::default(),
            sliding: Signal::default(),
            held: Signal::default(),
            integral: Signal::default(),
            velocity_reference: Signal::default(),
            acceleration_reference: Signal::default(),
            velocity: Signal::default(),
            word: Signal::default(),
            operand: Signal::default(),
            takes_error: Dff::default(),
            takes_sliding: Dff::default(),
            takes_held: Dff::default(),
            takes_integral: Dff::default(),
            takes_reference: Dff::default(),
            takes_acceleration: Dff::default(),
            takes_velocity: Dff::default(),
            takes_word: Dff::default(),
            error_bits: Signal::default(),
            from_error: Signal::default(),
            from_sliding: Signal::default(),
            from_held: Signal::default(),
            from_integral: Signal::default(),
            from_reference: Signal::default(),
            from_acceleration: Signal::default(),
            from_velocity: Signal::default(),
            from_word: Signal::default(),
            nothing: Constant::new(from_u64(0)),
            of_reference: Constant::new(from_u64(0)),
            of_velocity: Constant::new(from_u64(1)),
            rate_again: Constant::new(from_u64(2)),
            surface: Constant::new(from_u64(3)),
            boundary: Constant::new(from_u64(4)),
            on_rest: Constant::new(from_u64(5)),
            on_error: Constant::new(from_u64(6)),
            on_rate: Constant::new(from_u64(7)),
            fade: Constant::new(from_u64(8)),
            coulomb: Constant::new(from_u64(9)),
            on_feedback: Constant::new(from_u64(10)),
            on_acceleration: Constant::new(from_u64(11)),
            on_reference: Constant::new(from_u64(12)),
            on_velocity: Constant::new(from_u64(13)),
            limit: Constant::new(from_u64(14)),
            to_sum: Constant::new(from_u64(15)),
            to_duty: Constant::new(from_u64(16)),
        }
    }
}

impl Logic for Operands {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module operands");
        comment!("@about The word that a step multiplies.");
        dff_setup!(
            self,
            clk,
            takes_error,
            takes_sliding,
            takes_held,
            takes_integral,
            takes_reference,
            takes_acceleration,
            takes_velocity,
            takes_word
        );

        comment!("Whose turn it is");
        self.takes_error.d.next = (self.step.val() == self.surface.val())
            | (self.step.val() == self.to_sum.val())
            | ((self.step.val() == self.on_error.val()) & self.linear.val());
        self.takes_sliding.d.next = (self.step.val() == self.on_error.val()) & !self.linear.val();
        self.takes_held.d.next = (self.step.val() == self.rate_again.val())
            | (self.step.val() == self.on_rate.val())
            | (self.step.val() == self.on_feedback.val())
            | (self.step.val() == self.to_duty.val());
        self.takes_integral.d.next =
            (self.step.val() == self.limit.val()) | ((self.step.val() == self.on_rest.val()) & self.integrates.val());
        self.takes_reference.d.next = (self.step.val() == self.of_reference.val())
            | (self.step.val() == self.fade.val())
            | (self.step.val() == self.on_reference.val());
        self.takes_acceleration.d.next = self.step.val() == self.on_acceleration.val();
        self.takes_velocity.d.next =
            (self.step.val() == self.of_velocity.val()) | (self.step.val() == self.on_velocity.val());
        self.takes_word.d.next = (self.step.val() == self.boundary.val())
            | (self.step.val() == self.coulomb.val())
            | ((self.step.val() == self.on_rest.val()) & !self.linear.val());

        comment!("One of them, or nothing");
        self.error_bits.next = unsigned_cast(self.tracking_error.val());
        self.from_error.next = self.nothing.val();
        if self.takes_error.q.val() {
            self.from_error.next = bit_cast::<32, 24>(self.error_bits.val()) << 8;
        }
        self.from_sliding.next = self.nothing.val();
        if self.takes_sliding.q.val() {
            self.from_sliding.next = unsigned_cast(self.sliding.val());
        }
        self.from_held.next = self.nothing.val();
        if self.takes_held.q.val() {
            self.from_held.next = unsigned_cast(self.held.val());
        }
        self.from_integral.next = self.nothing.val();
        if self.takes_integral.q.val() {
            self.from_integral.next = unsigned_cast(self.integral.val());
        }
        self.from_reference.next = self.nothing.val();
        if self.takes_reference.q.val() {
            self.from_reference.next = unsigned_cast(self.velocity_reference.val());
        }
        self.from_acceleration.next = self.nothing.val();
        if self.takes_acceleration.q.val() {
            self.from_acceleration.next = unsigned_cast(self.acceleration_reference.val());
        }
        self.from_velocity.next = self.nothing.val();
        if self.takes_velocity.q.val() {
            self.from_velocity.next = unsigned_cast(self.velocity.val());
        }
        self.from_word.next = self.nothing.val();
        if self.takes_word.q.val() {
            self.from_word.next = unsigned_cast(self.word.val());
        }
        self.operand.next = signed_cast(
            self.from_error.val()
                | self.from_sliding.val()
                | self.from_held.val()
                | self.from_integral.val()
                | self.from_reference.val()
                | self.from_acceleration.val()
                | self.from_velocity.val()
                | self.from_word.val(),
        );
    }
}
