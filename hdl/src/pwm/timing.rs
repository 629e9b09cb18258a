//! Dead time and minimum pulse: taken while off, and never below the floor.
//!
//! The floors are constants. Compared with them bit by bit, most bits cost nothing; a carry chain would have all ten.

use crate::prelude::*;
use posicast_model::rtl::pwm::PwmConfig;

#[derive(LogicBlock)]
pub(super) struct Timing {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) running: Signal<In, Bit>,
    pub(super) dead_time: Signal<In, Bits<10>>,
    pub(super) minimum_pulse: Signal<In, Bits<10>>,
    pub(super) dead_time_used: Signal<Out, Bits<10>>,
    pub(super) minimum_pulse_used: Signal<Out, Bits<10>>,
    pub(super) below: Signal<Out, Bit>,
    pub(super) settled: Signal<Out, Bit>,

    dead_time_q: Dff<Bits<10>>,
    minimum_pulse_q: Dff<Bits<10>>,

    dead_below: Signal<Local, Bit>,
    pulse_below: Signal<Local, Bit>,
    dead_wanted: Signal<Local, Bits<10>>,
    pulse_wanted: Signal<Local, Bits<10>>,

    dead_time_floor: Constant<Bits<10>>,
    minimum_pulse_floor: Constant<Bits<10>>,
}

impl Timing {
    pub(super) fn new(config: &PwmConfig) -> Self {
        let dead_time = from_u64(config.dead_time_floor_clocks().into());
        let minimum_pulse = from_u64(config.minimum_pulse_floor_clocks().into());
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            running: Signal::default(),
            dead_time: Signal::default(),
            minimum_pulse: Signal::default(),
            dead_time_used: Signal::default(),
            minimum_pulse_used: Signal::default(),
            below: Signal::default(),
            settled: Signal::default(),
            dead_time_q: Dff::new(dead_time),
            minimum_pulse_q: Dff::new(minimum_pulse),
            dead_below: Signal::default(),
            pulse_below: Signal::default(),
            dead_wanted: Signal::default(),
            pulse_wanted: Signal::default(),
            dead_time_floor: Constant::new(dead_time),
            minimum_pulse_floor: Constant::new(minimum_pulse),
        }
    }
}

impl Logic for Timing {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module pwm_timing_${value dead_time_floor}x${value minimum_pulse_floor}");
        comment!("@about Dead time and minimum pulse, and floors.");
        dff_setup!(self, clk, dead_time_q, minimum_pulse_q);

        comment!("Below: the floor has the highest bit that differs");
        self.dead_below.next = false;
        for i in 0..10 {
            if self.dead_time.val().get_bit(i) != self.dead_time_floor.val().get_bit(i) {
                self.dead_below.next = self.dead_time_floor.val().get_bit(i);
            }
        }
        self.dead_wanted.next = self.dead_time.val();
        if self.dead_below.val() {
            self.dead_wanted.next = self.dead_time_floor.val();
        }
        self.pulse_below.next = false;
        for i in 0..10 {
            if self.minimum_pulse.val().get_bit(i) != self.minimum_pulse_floor.val().get_bit(i) {
                self.pulse_below.next = self.minimum_pulse_floor.val().get_bit(i);
            }
        }
        self.pulse_wanted.next = self.minimum_pulse.val();
        if self.pulse_below.val() {
            self.pulse_wanted.next = self.minimum_pulse_floor.val();
        }
        if !self.running.val() {
            self.dead_time_q.d.next = self.dead_wanted.val();
            self.minimum_pulse_q.d.next = self.pulse_wanted.val();
        }
        self.dead_time_used.next = self.dead_time_q.q.val();
        self.minimum_pulse_used.next = self.minimum_pulse_q.q.val();
        self.below.next = self.dead_below.val() | self.pulse_below.val();
        self.settled.next = (self.dead_time_q.q.val() == self.dead_wanted.val())
            & (self.minimum_pulse_q.q.val() == self.pulse_wanted.val());
    }
}
