//! Compares the position with the window in the clock of the edge, counts, and keeps the flags.

use super::line::CaptureLine;
use super::memory::CaptureMemory;
use crate::prelude::*;

kernel! {
    pub(super) struct Capture;
    ports posicast_blocks::capture_ports;

    parts { edge_line: CaptureLine, memory: CaptureMemory }
    registers { captured_q: Bit, edges_q: Bits<32>, overflowed_q: Bit, outside_q: Bit }
    wires {
        wanted: Bit, low_pair: Signed<32>, high_pair: Signed<32>, position: Signed<32>, in_window: Bit, edges_before: Bits<32>,
    }
    constants {
        no_edge: Bits<32> = from_u64(0),
        one_edge: Bits<32> = from_u64(1),
    }
    connect {
        edge_line: line, filter_clocks;
        memory: stamp, take, clear;
        outputs from edge_line: level, level_known;
        outputs from memory: entries, entry_valid, entry_stamp, entry_rising;
    }
}

impl Logic for Capture {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module capture");

        comment!("An edge, in the first clock of the new level");
        self.wanted.next = self.edge_line.changed.val()
            & self.enable.val()
            & ((self.edge_line.level.val() & self.rises.val()) | (!self.edge_line.level.val() & self.falls.val()));

        comment!("The window");
        self.low_pair.next = self.count[0].val();
        self.high_pair.next = self.count[2].val();
        if self.window_axis.val().get_bit(0) {
            self.low_pair.next = self.count[1].val();
            self.high_pair.next = self.count[3].val();
        }
        self.position.next = self.low_pair.val();
        if self.window_axis.val().get_bit(1) {
            self.position.next = self.high_pair.val();
        }
        self.in_window.next = !self.windowed.val()
            | ((self.window_first.val() <= self.position.val()) & (self.position.val() <= self.window_last.val()));

        comment!("The memory");
        self.memory.offers.next = self.wanted.val() & self.in_window.val();
        self.memory.rising.next = self.edge_line.level.val();
        for i in 0..4 {
            self.memory.count[i].next = self.count[i].val();
            self.entry_count[i].next = self.memory.entry_count[i].val();
        }
        self.captured_q.d.next = self.memory.captures.val();

        comment!("Edges, captured or not");
        self.edges_before.next = self.edges_q.q.val();
        if self.clear.val() {
            self.edges_before.next = self.no_edge.val();
        }
        self.edges_q.d.next = self.edges_before.val();
        if self.wanted.val() {
            self.edges_q.d.next = self.edges_before.val() + self.one_edge.val();
        }

        comment!("Flags; setting wins");
        self.overflowed_q.d.next = self.memory.overflows.val() | (self.overflowed_q.q.val() & !self.clear_flags.val());
        self.outside_q.d.next =
            (self.wanted.val() & !self.in_window.val()) | (self.outside_q.q.val() & !self.clear_flags.val());

        comment!("Outputs");
        self.captured.next = self.captured_q.q.val();
        self.edges.next = self.edges_q.q.val();
        self.overflowed.next = self.overflowed_q.q.val();
        self.outside.next = self.outside_q.q.val();
    }
}
