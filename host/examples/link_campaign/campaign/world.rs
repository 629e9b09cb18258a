//! The line with its faults, and the machine at its end.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::io::{self, ErrorKind, Read, Write};
use std::rc::Rc;
use std::time::Duration;

use posicast_closed_loop::linked_bench::LinkedBench;
use rand::RngExt;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::requests::Requests;

/// Clocks for which a host waits for a reply, in the time of the model.
const REPLY_CLOCKS: u64 = 20_000;
/// How long a host waits in real time. A read from the silent line takes longer, so that it is the only one.
pub(super) const REPLY: Duration = Duration::from_micros(200);
const READ: Duration = Duration::from_micros(250);

/// What the line does.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct LineFaults {
    /// One byte in this many is damaged; 0: none.
    pub(super) damaged_one_in: u32,
    /// Clocks in which nothing passes.
    pub(super) cut: Option<[u64; 2]>,
    /// Clocks in which noise comes.
    pub(super) noise: Option<[u64; 2]>,
}

/// Line and machine.
pub(super) struct World {
    pub(super) linked: LinkedBench,
    pub(super) rng: Xoshiro256PlusPlus,
    pub(super) requests: Requests,
    /// Bytes that were damaged or lost.
    pub(super) faults: u64,
    /// Clock of the last byte of a host.
    pub(super) last_byte: u64,
    /// Where the axes stood when the last move was started, in counts.
    pub(super) starts: [i64; 2],
    /// Address of the register that starts moves.
    start_address: u16,
    line: LineFaults,
    /// Bytes that the present host has sent, and after which it is dead.
    sent_bytes: u64,
    dies_at: Option<u64>,
    coming: VecDeque<u8>,
}

impl World {
    pub(super) fn new(
        linked: LinkedBench,
        (line, dies_at): (LineFaults, Option<u64>),
        start_address: u16,
        rng: Xoshiro256PlusPlus,
    ) -> Self {
        Self {
            linked,
            rng,
            requests: Requests::default(),
            faults: 0,
            last_byte: 0,
            starts: [0; 2],
            start_address,
            line,
            sent_bytes: 0,
            dies_at,
            coming: VecDeque::new(),
        }
    }

    pub(super) fn now(&self) -> u64 {
        self.linked.bench.now()
    }

    /// Lets time pass without a byte.
    pub(super) fn idle(&mut self, clocks: u64) -> Result<(), String> {
        self.linked.idle(clocks).map_err(|error| error.to_string())
    }

    /// Another host begins: it lives, and what was on the way to the one before is lost.
    pub(super) fn new_host(&mut self) {
        (self.dies_at, self.sent_bytes) = (None, 0);
        self.coming.clear();
    }

    fn within(&self, window: Option<[u64; 2]>) -> bool {
        window.is_some_and(|[from, to]| (from..to).contains(&self.now()))
    }

    /// What becomes of a byte on the line.
    fn carry(&mut self, byte: u8) -> Vec<u8> {
        if self.within(self.line.cut) {
            self.faults += 1;
            return vec![];
        }
        if self.within(self.line.noise) && self.rng.random_range(0..4) == 0 {
            self.faults += 1;
            let any = self.rng.random();
            return vec![any, byte];
        }
        let one_in = self.line.damaged_one_in;
        if one_in == 0 || self.rng.random_range(0..one_in) != 0 {
            return vec![byte];
        }
        self.faults += 1;
        let any: u8 = self.rng.random();
        match self.rng.random_range(0..5) {
            0 => vec![],
            1 => vec![byte, byte],
            2 => vec![byte ^ 1 << (any % 8)],
            3 => vec![any, byte],
            _ => vec![any],
        }
    }

    fn host_byte(&mut self, byte: u8) -> io::Result<()> {
        if self.dies_at.is_some_and(|end| self.sent_bytes >= end) {
            return Err(ErrorKind::BrokenPipe.into());
        }
        self.sent_bytes += 1;
        self.requests.byte(byte);
        for carried in self.carry(byte) {
            if self.within(self.line.noise) && self.rng.random_range(0..8) == 0 {
                self.linked.bad_byte();
            }
            let written = self.linked.writes.len();
            let reply = self
                .linked
                .byte(carried)
                .map_err(|error| io::Error::other(error.to_string()))?;
            let writes = &self.linked.writes[written..];
            if writes.iter().any(|(address, _)| *address == self.start_address) {
                // The command moves three ticks later.
                self.starts = [0, 1].map(|axis| self.linked.bench.plant(axis).count());
            }
            for answer in reply {
                let carried = self.carry(answer);
                self.coming.extend(carried);
            }
        }
        self.last_byte = self.now();
        Ok(())
    }
}

/// The line, as a host has it.
pub(super) struct Line(pub(super) Rc<RefCell<World>>);

impl Write for Line {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut world = self.0.borrow_mut();
        bytes.iter().try_for_each(|byte| world.host_byte(*byte))?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Read for Line {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let mut world = self.0.borrow_mut();
        if world.coming.is_empty() {
            world.idle(REPLY_CLOCKS).map_err(io::Error::other)?;
            std::thread::sleep(READ);
            return Err(ErrorKind::TimedOut.into());
        }
        world.coming.read(bytes)
    }
}
