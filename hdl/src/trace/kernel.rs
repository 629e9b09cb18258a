//! Strobes, rows and states of the trace memory; trigger, selection and memory are parts of it.
//!
//! ```text
//! phase  0        1                  2                    3 … 2 + signals
//!        strobe   trigger's signal   compared; signal 0   a word stored; the next signal
//! ```
//!
//! `rows` counts the recorded rows, and stays constant while the block waits for the trigger, because each new row
//! drops one. So the trigger's row is always `pre_trigger`, and the trace is complete when the memory is full.

use super::memory::TraceMemory;
use super::signal_select::SignalSelect;
use super::trigger::Trigger;
use crate::prelude::*;
use posicast_blocks::trace::{TraceConfig, TraceState};

kernel! {
    /// Sizes: A address bits, R = A + 1 bits of a number of rows.
    ///
    /// A trace memory for `config`, whose size must not exceed this one.
    pub(super) struct Trace<const A: usize, const R: usize>(config: &TraceConfig) where R == A + 1;
    ports posicast_blocks::trace_ports;

    parts { selector: SignalSelect, watch: Trigger, memory: TraceMemory<A> = TraceMemory::new(config) }
    registers {
        active: Bit, triggered: Bit, halting: Bit, phase: Bits<3>, signals_q: Bits<2>, pre_trigger_q: Bits<A>,
        skip: Bits<16>, rows_q: Bits<R>, missed_q: Bit, done_q: Bit, select: Bits<4>,
    }
    wires {
        end_rows: Bits<R>, full: Bit, waits: Bit, ready: Bit, ends: Bit, compares: Bit, stores: Bit,
        last_phase: Bits<3>, last_row: Bits<11>, row_before: Bits<11>,
    }
    constants {
        ready_phase: Bits<3> = from_u64(0),
        trigger_phase: Bits<3> = from_u64(1),
        compare_phase: Bits<3> = from_u64(2),
        store_phase: Bits<3> = from_u64(3),
        second_phase: Bits<3> = from_u64(4),
        fourth_phase: Bits<3> = from_u64(6),
        one_phase: Bits<3> = from_u64(1),
        one_signal: Bits<2> = from_u64(0),
        two_signals: Bits<2> = from_u64(1),
        rows_of_one: Bits<R> = from_u64(words(config)),
        rows_of_two: Bits<R> = from_u64(words(config) / 2),
        rows_of_four: Bits<R> = from_u64(words(config) / 4),
        last_of_one: Bits<11> = from_u64(words(config) - 1),
        last_of_two: Bits<11> = from_u64(words(config) / 2 - 1),
        last_of_four: Bits<11> = from_u64(words(config) / 4 - 1),
        no_rows: Bits<R> = from_u64(0),
        one_row: Bits<R> = from_u64(1),
        no_strobes: Bits<16> = from_u64(0),
        one_strobe: Bits<16> = from_u64(1),
        idle_state: Bits<2> = from_u64(TraceState::Idle as u64),
        filling_state: Bits<2> = from_u64(TraceState::Filling as u64),
        waiting_state: Bits<2> = from_u64(TraceState::Waiting as u64),
        taking_state: Bits<2> = from_u64(TraceState::Taking as u64),
    }
    connect {
        memory: full, read_address;
    }
}

/// Words in the memory.
fn words(config: &TraceConfig) -> u64 {
    u64::from(config.samples())
}

impl<const A: usize, const R: usize> Logic for Trace<A, R> {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module trace");

        comment!("Progress of the trace");
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

        comment!("Signal that the next clock takes");
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

        comment!("The trigger, once the rows before it are complete");
        self.watch.forget.next = self.arm.val();
        self.watch.compare.next = self.compares.val();
        self.watch.value.next = self.selector.chosen.val();
        self.watch.mode.next = self.trigger_mode.val();
        self.watch.level.next = self.trigger_level.val();
        self.watch.happens.next = self.trigger_event.val();
        if self.compares.val() & self.waits.val() & self.watch.comes.val() {
            self.triggered.d.next = true;
        }

        comment!("Store a word; the last one of a row ends it");
        self.memory.write.next = self.stores.val();
        self.memory.drops.next = self.waits.val();
        self.memory.word.next = self.selector.chosen.val();
        if self.stores.val() & (self.phase.q.val() == self.last_phase.val()) {
            self.phase.d.next = self.ready_phase.val();
            if !self.waits.val() {
                self.rows_q.d.next = self.rows_q.q.val() + self.one_row.val();
            }
        }

        comment!("Arm: discard everything and begin");
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
        self.memory.hidden.next = self.active.q.val();
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
