//! Makes the pulse: as many clocks high as are set, longer if the next one begins meanwhile.

use crate::prelude::*;

kernel! {
    pub(super) struct Pulse;

    inputs { rst: Bit, fires: Bit, width_clocks: Bits<24> }
    outputs { pulse: Bit, merges: Bit }
    registers { pulse_q: Bit, left: Bits<24> }
    wires { goes_on: Bit }
    constants { one_clock: Bits<24> = from_u64(1) }
}

impl Logic for Pulse {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module compare_pulse");

        self.goes_on.next = self.left.q.val() > self.one_clock.val();
        if self.left.q.val().any() {
            self.left.d.next = self.left.q.val() - self.one_clock.val();
        }
        self.pulse_q.d.next = self.goes_on.val();
        if self.fires.val() {
            self.left.d.next = self.width_clocks.val();
            self.pulse_q.d.next = true;
        }
        self.merges.next = self.fires.val() & self.pulse_q.q.val();
        self.pulse.next = self.pulse_q.q.val();
    }
}
