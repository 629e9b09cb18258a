//! Takes a new level once it has stood for more than `filter_clocks` clocks; until `ready`, the level follows the input.
//!
//! Counts down from `filter_clocks`, which it takes over in every clock without a difference: a comparison with nothing.

use crate::prelude::*;

#[derive(LogicBlock)]
pub(crate) struct GlitchFilter {
    pub(crate) clk: Signal<In, Clock>,
    pub(crate) rst: Signal<In, Bit>,
    pub(crate) input_level: Signal<In, Bit>,
    pub(crate) ready: Signal<In, Bit>,
    pub(crate) filter_clocks: Signal<In, Bits<6>>,
    pub(crate) level: Signal<Out, Bit>,

    level_q: Dff<Bit>,
    left: Dff<Bits<6>>,

    no_clocks: Constant<Bits<6>>,
    one_clock: Constant<Bits<6>>,
}

impl Default for GlitchFilter {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            input_level: Signal::default(),
            ready: Signal::default(),
            filter_clocks: Signal::default(),
            level: Signal::default(),
            level_q: Dff::default(),
            left: Dff::default(),
            no_clocks: Constant::new(from_u64(0)),
            one_clock: Constant::new(from_u64(1)),
        }
    }
}

impl Logic for GlitchFilter {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module glitch_filter");
        comment!("@about A level passes after filter_clocks + 1.");
        dff_setup!(self, clk, level_q, left);
        self.left.d.next = self.left.q.val() - self.one_clock.val();
        if self.input_level.val() == self.level_q.q.val() {
            self.left.d.next = self.filter_clocks.val();
        }
        if !self.ready.val() | (self.left.q.val() == self.no_clocks.val()) {
            self.level_q.d.next = self.input_level.val();
            self.left.d.next = self.filter_clocks.val();
        }
        self.level.next = self.level_q.q.val();
    }
}
