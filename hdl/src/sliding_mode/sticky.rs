//! Sticky flags of one side: seven bits, set wins over clear.
//!
//! e may be cut in any clock; everything else is one `what` at a time.

use crate::prelude::*;
use posicast_model::rtl::sliding_mode::Saturation;

#[derive(LogicBlock)]
pub(super) struct Sticky {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) clear_flags: Signal<In, Bit>,
    pub(super) tracking_error: Signal<In, Bit>,
    pub(super) what: Signal<In, Bits<7>>,
    pub(super) is_cut: Signal<In, Bit>,
    pub(super) flags: Signal<Out, Bits<7>>,

    flags_q: Dff<Bits<7>>,

    kept: Signal<Local, Bits<7>>,
    by_error: Signal<Local, Bits<7>>,
    by_sum: Signal<Local, Bits<7>>,

    nothing: Constant<Bits<7>>,
    of_error: Constant<Bits<7>>,
}

impl Default for Sticky {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            clear_flags: Signal::default(),
            tracking_error: Signal::default(),
            what: Signal::default(),
            is_cut: Signal::default(),
            flags: Signal::default(),
            flags_q: Dff::default(),
            kept: Signal::default(),
            by_error: Signal::default(),
            by_sum: Signal::default(),
            nothing: Constant::new(from_u64(0)),
            of_error: Constant::new(from_u64(u64::from(Saturation::Error.bit()))),
        }
    }
}

impl Logic for Sticky {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module sticky");
        comment!("@about Sticky flags: set wins over clear.");
        dff_setup!(self, clk, flags_q);

        self.kept.next = self.flags_q.q.val();
        if self.clear_flags.val() {
            self.kept.next = self.nothing.val();
        }
        self.by_error.next = self.nothing.val();
        if self.tracking_error.val() {
            self.by_error.next = self.of_error.val();
        }
        self.by_sum.next = self.nothing.val();
        if self.is_cut.val() {
            self.by_sum.next = self.what.val();
        }
        self.flags_q.d.next = self.kept.val() | self.by_error.val() | self.by_sum.val();
        self.flags.next = self.flags_q.q.val();
    }
}
