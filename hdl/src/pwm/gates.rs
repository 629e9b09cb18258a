//! The gates: maps the leg to the pins of its mode, with a register each, followed by the asynchronous fault path.

use crate::prelude::*;
use posicast_blocks::pwm::PwmConfig;

kernel! {
    pub(super) struct Gates(config: &PwmConfig);

    inputs {
        rst: Bit,
        armed: Bit,
        mask_pins: Bit,
        mode: Bits<2>,
        negative: Bit,
        awake: Bit,
        high_side: Bit,
        low_side: Bit,
    }
    outputs { a_high: Bit, a_low: Bit, b_high: Bit, b_low: Bit, gates: Bits<4> }
    registers { a_high_gate: Bit, a_low_gate: Bit, b_high_gate: Bit, b_low_gate: Bit, masked: Bit }
    wires { on: Bit, leg_a_high: Bits<4>, leg_a: Bits<4>, leg_b_high: Bits<4> }
    constants {
        no_gate: Bits<4> = from_u64(0),
        a_high_off: Bit = config.active_low().a_high,
        a_low_off: Bit = config.active_low().a_low,
        b_high_off: Bit = config.active_low().b_high,
        b_low_off: Bit = config.active_low().b_low,
    }
}

impl Logic for Gates {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module pwm_gates_${value a_high_off}${value a_low_off}${value b_high_off}${value b_low_off}");

        comment!("Half bridge; the other modes modify it");
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
            comment!("Locked antiphase: the other leg is in antiphase");
            self.b_high_gate.d.next = self.low_side.val();
            self.b_low_gate.d.next = self.high_side.val();
        }

        comment!("Fault path and mask can only switch off");
        self.masked.d.next = self.mask_pins.val();
        self.on.next = self.armed.val() & !self.masked.q.val();
        self.a_high.next = (self.a_high_gate.q.val() & self.on.val()) ^ self.a_high_off.val();
        self.a_low.next = (self.a_low_gate.q.val() & self.on.val()) ^ self.a_low_off.val();
        self.b_high.next = (self.b_high_gate.q.val() & self.on.val()) ^ self.b_high_off.val();
        self.b_low.next = (self.b_low_gate.q.val() & self.on.val()) ^ self.b_low_off.val();

        comment!("Gates before the mask");
        self.leg_a_high.next = self.no_gate.val().replace_bit(0, self.a_high_gate.q.val());
        self.leg_a.next = self.leg_a_high.val().replace_bit(1, self.a_low_gate.q.val());
        self.leg_b_high.next = self.leg_a.val().replace_bit(2, self.b_high_gate.q.val());
        self.gates.next = self.leg_b_high.val().replace_bit(3, self.b_low_gate.q.val());
    }
}
