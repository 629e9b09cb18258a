//! The sources that turn the outputs off: the asynchronous fault latch, and the clocked causes.

use super::filtered_fault::FilteredFault;
use crate::prelude::*;

kernel! {
    pub(super) struct Trip;

    inputs {
        rst: Bit,
        running: Bit,
        valley: Bit,
        feed: Bit,
        watchdog_periods: Bits<8>,
        filter_clocks: Bits<8>,
        fault_n: Bit,
        pll_locked: Bit,
        filtered_fault_n: Bits<2>,
        clear_trip: Bit,
    }
    outputs { armed: Bit, tripped: Bit, causes: Bits<5> }
    parts {
        fault_latch: FaultLatch,
        armed_synchroniser: Synchroniser,
        fault_synchroniser: Synchroniser,
        pll_synchroniser: Synchroniser,
        fault_0: FilteredFault,
        fault_1: FilteredFault,
    }
    registers { filtered_0: Bit, filtered_1: Bit, pll: Bit, watchdog: Bit, unfed: Bits<8> }
    wires {
        trip_n: Bit, over: Bit, latched: Bit, waits: Bit, starved: Bit, others: Bit, none: Bits<5>,
        with_latch: Bits<5>, with_fault_0: Bits<5>, with_fault_1: Bits<5>, with_pll: Bits<5>,
    }
    connect {
        fault_latch: trip_n;
        fault_0, fault_1: filter_clocks;
    }
}

impl Logic for Trip {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module pwm_trip");

        comment!("Asynchronous: the pins and the latch");
        self.trip_n.next = self.fault_n.val() & self.pll_locked.val();
        self.armed.next = self.fault_latch.armed.val() & self.trip_n.val();

        comment!("Clear the latch once off and once the cause is over");
        self.armed_synchroniser.pin.next = self.fault_latch.armed.val();
        self.fault_synchroniser.pin.next = self.fault_n.val();
        self.pll_synchroniser.pin.next = !self.pll_locked.val();
        self.latched.next = !self.armed_synchroniser.level.val();
        self.over.next = self.fault_synchroniser.level.val() & !self.pll_synchroniser.level.val();
        self.fault_latch.clear.next =
            self.clear_trip.val() & !self.running.val() & self.latched.val() & self.over.val();

        comment!("Filtered faults and PLL; setting wins");
        self.fault_0.fault_n.next = self.filtered_fault_n.val().get_bit(0);
        self.fault_1.fault_n.next = self.filtered_fault_n.val().get_bit(1);
        self.filtered_0.d.next = self.fault_0.active.val() | (self.filtered_0.q.val() & !self.clear_trip.val());
        self.filtered_1.d.next = self.fault_1.active.val() | (self.filtered_1.q.val() & !self.clear_trip.val());
        self.pll.d.next = self.pll_synchroniser.level.val() | (self.pll.q.val() & !self.clear_trip.val());

        comment!("The watchdog counts valleys without feed");
        self.waits.next = self.running.val() & !self.feed.val();
        self.starved.next = self.watchdog_periods.val().any() & (self.unfed.q.val() >= self.watchdog_periods.val());
        self.watchdog.d.next = (self.waits.val() & self.valley.val() & self.starved.val())
            | (self.watchdog.q.val() & !self.clear_trip.val());
        if self.valley.val() & !self.unfed.q.val().all() {
            self.unfed.d.next = self.unfed.q.val() + 1;
        }
        if !self.waits.val() {
            self.unfed.d.next = 0.into();
        }

        self.others.next = self.filtered_0.q.val() | self.filtered_1.q.val() | self.pll.q.val() | self.watchdog.q.val();
        self.tripped.next = self.latched.val() | self.others.val();
        self.none.next = 0.into();
        self.with_latch.next = self.none.val().replace_bit(0, self.latched.val());
        self.with_fault_0.next = self.with_latch.val().replace_bit(1, self.filtered_0.q.val());
        self.with_fault_1.next = self.with_fault_0.val().replace_bit(2, self.filtered_1.q.val());
        self.with_pll.next = self.with_fault_1.val().replace_bit(3, self.pll.q.val());
        self.causes.next = self.with_pll.val().replace_bit(4, self.watchdog.q.val());
    }
}
