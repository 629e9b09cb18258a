//! Strobes, rows and states; the trigger, the selection and the memory stand beside.
//!
//! ```text
//! phase  0        1                  2                    3 … 2 + signals
//!        strobe   trigger's signal   compared; signal 0   a word stored; the next signal
//! ```
//!
//! `rows` counts what is there, and stands still while the trigger is waited for: each row that is taken then drops one. So
//! the trigger's row is always `pre_trigger`, and the trace is complete when the memory is full.

use super::memory::TraceMemory;
use super::signal_select::SignalSelect;
use super::trigger::Trigger;
use crate::prelude::*;
use posicast_model::rtl::trace::State;

/// A address bits, R = A + 1 bits of a number of rows.
#[derive(LogicBlock)]
pub(super) struct Trace<const A: usize, const R: usize> {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) strobe: Signal<In, Bit>,
    pub(super) signal: [Signal<In, Signed<32>>; 16],
    pub(super) select_0: Signal<In, Bits<4>>,
    pub(super) select_1: Signal<In, Bits<4>>,
    pub(super) select_2: Signal<In, Bits<4>>,
    pub(super) select_3: Signal<In, Bits<4>>,
    pub(super) signals: Signal<In, Bits<2>>,
    pub(super) decimation: Signal<In, Bits<16>>,
    pub(super) trigger_select: Signal<In, Bits<4>>,
    pub(super) trigger_mode: Signal<In, Bits<2>>,
    pub(super) trigger_level: Signal<In, Signed<32>>,
    pub(super) trigger_event: Signal<In, Bit>,
    pub(super) pre_trigger: Signal<In, Bits<11>>,
    pub(super) arm: Signal<In, Bit>,
    pub(super) halt: Signal<In, Bit>,
    pub(super) read_address: Signal<In, Bits<11>>,
    pub(super) data: Signal<Out, Bits<32>>,
    pub(super) state: Signal<Out, Bits<2>>,
    pub(super) rows: Signal<Out, Bits<12>>,
    pub(super) trigger_row: Signal<Out, Bits<11>>,
    pub(super) missed: Signal<Out, Bit>,
    pub(super) done: Signal<Out, Bit>,

    selector: SignalSelect,
    watch: Trigger,
    memory: TraceMemory<A>,

    active: Dff<Bit>,
    triggered: Dff<Bit>,
    halting: Dff<Bit>,
    phase: Dff<Bits<3>>,
    signals_q: Dff<Bits<2>>,
    pre_trigger_q: Dff<Bits<A>>,
    skip: Dff<Bits<16>>,
    rows_q: Dff<Bits<R>>,
    missed_q: Dff<Bit>,
    done_q: Dff<Bit>,
    select: Dff<Bits<4>>,

    end_rows: Signal<Local, Bits<R>>,
    full: Signal<Local, Bit>,
    waits: Signal<Local, Bit>,
    ready: Signal<Local, Bit>,
    ends: Signal<Local, Bit>,
    compares: Signal<Local, Bit>,
    stores: Signal<Local, Bit>,
    last_phase: Signal<Local, Bits<3>>,
    last_row: Signal<Local, Bits<11>>,
    row_before: Signal<Local, Bits<11>>,

    ready_phase: Constant<Bits<3>>,
    trigger_phase: Constant<Bits<3>>,
    compare_phase: Constant<Bits<3>>,
    store_phase: Constant<Bits<3>>,
    second_phase: Constant<Bits<3>>,
    fourth_phase: Constant<Bits<3>>,
    one_phase: Constant<Bits<3>>,
    one_signal: Constant<Bits<2>>,
    two_signals: Constant<Bits<2>>,
    rows_of_one: Constant<Bits<R>>,
    rows_of_two: Constant<Bits<R>>,
    rows_of_four: Constant<Bits<R>>,
    last_of_one: Constant<Bits<11>>,
    last_of_two: Constant<Bits<11>>,
    last_of_four: Constant<Bits<11>>,
    no_rows: Constant<Bits<R>>,
    one_row: Constant<Bits<R>>,
    no_strobes: Constant<Bits<16>>,
    one_strobe: Constant<Bits<16>>,
    idle_state: Constant<Bits<2>>,
    filling_state: Constant<Bits<2>>,
    waiting_state: Constant<Bits<2>>,
    taking_state: Constant<Bits<2>>,
}

impl<const A: usize, const R: usize> Default for Trace<A, R> {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            strobe: Signal::default(),
            signal: std::array::from_fn(|_| Signal::default()),
            select_0: Signal::default(),
            select_1: Signal::default(),
            select_2: Signal::default(),
            select_3: Signal::default(),
            signals: Signal::default(),
            decimation: Signal::default(),
            trigger_select: Signal::default(),
            trigger_mode: Signal::default(),
            trigger_level: Signal::default(),
            trigger_event: Signal::default(),
            pre_trigger: Signal::default(),
            arm: Signal::default(),
            halt: Signal::default(),
            read_address: Signal::default(),
            data: Signal::default(),
            state: Signal::default(),
            rows: Signal::default(),
            trigger_row: Signal::default(),
            missed: Signal::default(),
            done: Signal::default(),
            selector: SignalSelect::default(),
            watch: Trigger::default(),
            memory: TraceMemory::default(),
            active: Dff::default(),
            triggered: Dff::default(),
            halting: Dff::default(),
            phase: Dff::default(),
            signals_q: Dff::default(),
            pre_trigger_q: Dff::default(),
            skip: Dff::default(),
            rows_q: Dff::default(),
            missed_q: Dff::default(),
            done_q: Dff::default(),
            select: Dff::default(),
            end_rows: Signal::default(),
            full: Signal::default(),
            waits: Signal::default(),
            ready: Signal::default(),
            ends: Signal::default(),
            compares: Signal::default(),
            stores: Signal::default(),
            last_phase: Signal::default(),
            last_row: Signal::default(),
            row_before: Signal::default(),
            ready_phase: Constant::new(from_u64(0)),
            trigger_phase: Constant::new(from_u64(1)),
            compare_phase: Constant::new(from_u64(2)),
            store_phase: Constant::new(from_u64(3)),
            second_phase: Constant::new(from_u64(4)),
            fourth_phase: Constant::new(from_u64(6)),
            one_phase: Constant::new(from_u64(1)),
            one_signal: Constant::new(from_u64(0)),
            two_signals: Constant::new(from_u64(1)),
            rows_of_one: Constant::new(from_u64(1 << A)),
            rows_of_two: Constant::new(from_u64(1 << (A - 1))),
            rows_of_four: Constant::new(from_u64(1 << (A - 2))),
            last_of_one: Constant::new(from_u64((1 << A) - 1)),
            last_of_two: Constant::new(from_u64((1 << (A - 1)) - 1)),
            last_of_four: Constant::new(from_u64((1 << (A - 2)) - 1)),
            no_rows: Constant::new(from_u64(0)),
            one_row: Constant::new(from_u64(1)),
            no_strobes: Constant::new(from_u64(0)),
            one_strobe: Constant::new(from_u64(1)),
            idle_state: Constant::new(from_u64(State::Idle as u64)),
            filling_state: Constant::new(from_u64(State::Filling as u64)),
            waiting_state: Constant::new(from_u64(State::Waiting as u64)),
            taking_state: Constant::new(from_u64(State::Taking as u64)),
        }
    }
}

impl<const A: usize, const R: usize> Logic for Trace<A, R> {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module trace");
        dff_setup!(
            self,
            clk,
            active,
            triggered,
            halting,
            phase,
            signals_q,
            pre_trigger_q,
            skip,
            rows_q,
            missed_q,
            done_q,
            select
        );
        self.selector.clk.next = self.clk.val();
        self.selector.rst.next = self.rst.val();
        self.watch.clk.next = self.clk.val();
        self.watch.rst.next = self.rst.val();
        self.memory.clk.next = self.clk.val();
        self.memory.rst.next = self.rst.val();

        comment!("Where the trace is");
        self.last_phase.next = self.fourth_phase.val();
        self.end_rows.next = self.rows_of_four.val();
        if self.signals_q.q.val() == self.one_signal.val() {
            self.last_phase.next = self.store_phase.val();
            self.end_rows.next = self.rows_of_one.val();
        }
        if self.signals_q.q.val() == self.two_signals.val() {
            self.last_phase.next = self.second_phase.val();
            self.end_rows.next = self.rows_of_two.val();
        }
        self.full.next = (self.rows_q.q.val() & self.end_rows.val()).any();
        self.waits.next =
            !self.triggered.q.val() & (self.rows_q.q.val() == bit_cast::<R, A>(self.pre_trigger_q.q.val()));
        self.ready.next = self.phase.q.val() == self.ready_phase.val();
        self.compares.next = self.phase.q.val() == self.compare_phase.val();
        self.stores.next = self.phase.q.val() >= self.store_phase.val();
        self.ends.next = self.full.val() | self.halting.q.val();

        comment!("A strobe begins a row, or is left out");
        self.done_q.d.next = false;
        if self.halt.val() {
            self.halting.d.next = true;
        }
        if self.active.q.val() & self.ready.val() {
            if self.ends.val() {
                self.active.d.next = false;
                self.done_q.d.next = self.full.val();
            } else {
                if self.strobe.val() {
                    self.skip.d.next = self.skip.q.val() - self.one_strobe.val();
                    if !self.skip.q.val().any() {
                        self.skip.d.next = self.decimation.val();
                        self.phase.d.next = self.trigger_phase.val();
                    }
                }
            }
        }
        if !self.ready.val() {
            self.phase.d.next = self.phase.q.val() + self.one_phase.val();
            if self.strobe.val() {
                self.missed_q.d.next = true;
            }
        }

        comment!("Which signal the next clock takes");
        self.select.d.next = self.select_3.val();
        if self.ready.val() {
            self.select.d.next = self.trigger_select.val();
        }
        if self.phase.q.val() == self.trigger_phase.val() {
            self.select.d.next = self.select_0.val();
        }
        if self.compares.val() {
            self.select.d.next = self.select_1.val();
        }
        if self.phase.q.val() == self.store_phase.val() {
            self.select.d.next = self.select_2.val();
        }
        self.selector.select.next = self.select.q.val();
        for i in 0..16 {
            self.selector.signal[i].next = self.signal[i].val();
        }

        comment!("The trigger, once the rows before it are there");
        self.watch.forget.next = self.arm.val();
        self.watch.compare.next = self.compares.val();
        self.watch.value.next = self.selector.chosen.val();
        self.watch.mode.next = self.trigger_mode.val();
        self.watch.level.next = self.trigger_level.val();
        self.watch.happens.next = self.trigger_event.val();
        if self.compares.val() & self.waits.val() & self.watch.comes.val() {
            self.triggered.d.next = true;
        }

        comment!("A word; the last one of a row ends it");
        self.memory.write.next = self.stores.val();
        self.memory.drops.next = self.waits.val();
        self.memory.word.next = self.selector.chosen.val();
        if self.stores.val() & (self.phase.q.val() == self.last_phase.val()) {
            self.phase.d.next = self.ready_phase.val();
            if !self.waits.val() {
                self.rows_q.d.next = self.rows_q.q.val() + self.one_row.val();
            }
        }

        comment!("Arm: forget everything and begin");
        self.last_row.next = self.last_of_four.val();
        if self.signals.val() == self.one_signal.val() {
            self.last_row.next = self.last_of_one.val();
        }
        if self.signals.val() == self.two_signals.val() {
            self.last_row.next = self.last_of_two.val();
        }
        self.row_before.next = self.pre_trigger.val();
        if (self.pre_trigger.val() & !self.last_row.val()).any() {
            self.row_before.next = self.last_row.val();
        }
        self.memory.forget.next = self.arm.val();
        if self.arm.val() {
            self.active.d.next = true;
            self.triggered.d.next = false;
            self.halting.d.next = false;
            self.phase.d.next = self.ready_phase.val();
            self.signals_q.d.next = self.signals.val();
            self.pre_trigger_q.d.next = bit_cast::<A, 11>(self.row_before.val());
            self.skip.d.next = self.no_strobes.val();
            self.rows_q.d.next = self.no_rows.val();
            self.missed_q.d.next = false;
            self.done_q.d.next = false;
        }

        comment!("Reading, and outputs");
        self.memory.full.next = self.full.val();
        self.memory.hidden.next = self.active.q.val();
        self.memory.read_address.next = self.read_address.val();
        self.data.next = self.memory.data.val();
        self.state.next = self.idle_state.val();
        if self.active.q.val() {
            self.state.next = self.filling_state.val();
            if self.waits.val() {
                self.state.next = self.waiting_state.val();
            }
            if self.triggered.q.val() {
                self.state.next = self.taking_state.val();
            }
        }
        self.rows.next = bit_cast::<12, R>(self.rows_q.q.val());
        self.trigger_row.next = bit_cast::<11, A>(self.pre_trigger_q.q.val());
        self.missed.next = self.missed_q.q.val();
        self.done.next = self.done_q.q.val();
    }
}
