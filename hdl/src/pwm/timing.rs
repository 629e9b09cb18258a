//! Dead time and minimum pulse: taken while off, and never below their lower limits.
//!
//! The lower limits are constants. With a bit-by-bit comparison most bits cost nothing; a carry chain would use all
//! ten.

use crate::prelude::*;
use posicast_blocks::pwm::PwmConfig;

kernel! {
    pub(super) struct Timing(config: &PwmConfig);

    inputs { rst: Bit, running: Bit, dead_time: Bits<10>, minimum_pulse: Bits<10> }
    outputs { dead_time_used: Bits<10>, minimum_pulse_used: Bits<10>, below: Bit, settled: Bit }
    registers {
        dead_time_q: Bits<10> = from_u64(config.dead_time_floor_clocks().into()),
        minimum_pulse_q: Bits<10> = from_u64(config.minimum_pulse_floor_clocks().into()),
    }
    wires { dead_below: Bit, pulse_below: Bit, dead_wanted: Bits<10>, pulse_wanted: Bits<10> }
    constants {
        dead_time_floor: Bits<10> = from_u64(config.dead_time_floor_clocks().into()),
        minimum_pulse_floor: Bits<10> = from_u64(config.minimum_pulse_floor_clocks().into()),
    }
}

impl Logic for Timing {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module pwm_timing_${value dead_time_floor}x${value minimum_pulse_floor}");

        comment!("Below: the limit has the highest differing bit");
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
