//! The gates: the leg on the pins of its mode, a register each, and behind it the fault path without a clock.

use crate::prelude::*;
use posicast_model::rtl::pwm::PwmConfig;

#[derive(LogicBlock)]
pub(super) struct Gates {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) armed: Signal<In, Bit>,
    pub(super) mask_pins: Signal<In, Bit>,
    pub(super) mode: Signal<In, Bits<2>>,
    pub(super) negative: Signal<In, Bit>,
    pub(super) awake: Signal<In, Bit>,
    pub(super) high_side: Signal<In, Bit>,
    pub(super) low_side: Signal<In, Bit>,
    pub(super) a_high: Signal<Out, Bit>,
    pub(super) a_low: Signal<Out, Bit>,
    pub(super) b_high: Signal<Out, Bit>,
    pub(super) b_low: Signal<Out, Bit>,
    pub(super) gates: Signal<Out, Bits<4>>,

    a_high_gate: Dff<Bit>,
    a_low_gate: Dff<Bit>,
    b_high_gate: Dff<Bit>,
    b_low_gate: Dff<Bit>,
    masked: Dff<Bit>,

    on: Signal<Local, Bit>,
    leg_a_high: Signal<Local, Bits<4>>,
    leg_a: Signal<Local, Bits<4>>,
    leg_b_high: Signal<Local, Bits<4>>,
    no_gate: Constant<Bits<4>>,

    a_high_off: Constant<Bit>,
    a_low_off: Constant<Bit>,
    b_high_off: Constant<Bit>,
    b_low_off: Constant<Bit>,
}

impl Gates {
    pub(super) fn new(config: &PwmConfig) -> Self {
        let off = config.active_low();
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            armed: Signal::default(),
            mask_pins: Signal::default(),
            mode: Signal::default(),
            negative: Signal::default(),
            awake: Signal::default(),
            high_side: Signal::default(),
            low_side: Signal::default(),
            a_high: Signal::default(),
            a_low: Signal::default(),
            b_high: Signal::default(),
            b_low: Signal::default(),
            gates: Signal::default(),
            a_high_gate: Dff::default(),
            a_low_gate: Dff::default(),
            b_high_gate: Dff::default(),
            b_low_gate: Dff::default(),
            masked: Dff::default(),
            on: Signal::default(),
            leg_a_high: Signal::default(),
            leg_a: Signal::default(),
            leg_b_high: Signal::default(),
            no_gate: Constant::new(from_u64(0)),
            a_high_off: Constant::new(off.a_high),
            a_low_off: Constant::new(off.a_low),
            b_high_off: Constant::new(off.b_high),
            b_low_off: Constant::new(off.b_low),
        }
    }
}

impl Logic for Gates {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module pwm_gates_${value a_high_off}${value a_low_off}${value b_high_off}${value b_low_off}");
        comment!("@about The leg on its pins: a register each, then");
        comment!("@about fault path and mask, then the polarity.");
        dff_setup!(self, clk, a_high_gate, a_low_gate, b_high_gate, b_low_gate, masked);

        comment!("Half bridge; and the other modes from there");
        self.a_high_gate.d.next = self.high_side.val();
        self.a_low_gate.d.next = self.low_side.val();
        self.b_high_gate.d.next = false;
        self.b_low_gate.d.next = false;
        if self.mode.val() == 0 {
            comment!("PWM and direction");
            self.a_low_gate.d.next = false;
            self.b_high_gate.d.next = self.negative.val() & self.awake.val();
        }
        if self.mode.val() == 2 {
            comment!("Unipolar: the other leg stays low");
            self.b_low_gate.d.next = self.awake.val();
            if self.negative.val() {
                self.a_high_gate.d.next = false;
                self.a_low_gate.d.next = self.awake.val();
                self.b_high_gate.d.next = self.high_side.val();
                self.b_low_gate.d.next = self.low_side.val();
            }
        }
        if self.mode.val() == 3 {
            comment!("Locked antiphase: the other leg is against it");
            self.b_high_gate.d.next = self.low_side.val();
            self.b_low_gate.d.next = self.high_side.val();
        }

        comment!("Fault path and mask only ever add off");
        self.masked.d.next = self.mask_pins.val();
        self.on.next = self.armed.val() & !self.masked.q.val();
        self.a_high.next = (self.a_high_gate.q.val() & self.on.val()) ^ self.a_high_off.val();
        self.a_low.next = (self.a_low_gate.q.val() & self.on.val()) ^ self.a_low_off.val();
        self.b_high.next = (self.b_high_gate.q.val() & self.on.val()) ^ self.b_high_off.val();
        self.b_low.next = (self.b_low_gate.q.val() & self.on.val()) ^ self.b_low_off.val();

        comment!("What the mask hides");
        self.leg_a_high.next = self.no_gate.val().replace_bit(0, self.a_high_gate.q.val());
        self.leg_a.next = self.leg_a_high.val().replace_bit(1, self.a_low_gate.q.val());
        self.leg_b_high.next = self.leg_a.val().replace_bit(2, self.b_high_gate.q.val());
        self.gates.next = self.leg_b_high.val().replace_bit(3, self.b_low_gate.q.val());
    }
}
