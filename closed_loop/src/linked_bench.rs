//! A stage with its machine behind its serial line, byte by byte, for hosts that are tested without hardware.
//!
//! ```text
//!  host ─► bytes ─► LinkBridge (model) ─► bus ─► StageBench: stage and machine
//!       ◄─ bytes ◄─
//! ```
//!
//! A byte takes the time that it has on the line, and so does every access; in between the model of the stage runs event by event. Bits
//! and clocks of the bridge are not simulated: the lock step of `uart_bridge` and `linked_stage` compares these.
//!
//! [`InlineBench`](crate::inline_bench::InlineBench) takes the place of the stage with its machine where the line belongs to an inline
//! shaper.
//!
//! A host in the same thread has the bench itself as its line; [`serve`] is for a host at a port.

use std::collections::VecDeque;
use std::io::{self, ErrorKind, Read, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use posicast_blocks::link::{Bus, LinkBridge};
use posicast_machine::machine_file::{ClockSection, LinkSection};

use crate::stage_bench::StageBench;
use posicast_testbench::Error;

/// Clocks from the end of a request to its first access, and from access to access: those of the datasheet for reads.
const FIRST_ACCESS_CLOCKS: u64 = 41;
const ACCESS_CLOCKS: u64 = 34;
/// Time that passes at once while the line is silent, in s.
const SILENT_S: f64 = 200e-6;

/// What is behind a line: registers, and time that passes.
pub trait Registered {
    /// Reads the word at this address; it takes a few clocks.
    ///
    /// # Errors
    /// [`Error`] where the model stops.
    fn read_at(&mut self, address: u32) -> Result<u32, Error>;

    /// Writes the word at this address.
    ///
    /// # Errors
    /// [`Error`] where the model stops.
    fn write_at(&mut self, address: u32, data: u32) -> Result<(), Error>;

    /// Lets time pass.
    ///
    /// # Errors
    /// [`Error`] where the model stops.
    fn clocks(&mut self, clocks: u64) -> Result<(), Error>;
}

impl Registered for StageBench {
    fn read_at(&mut self, address: u32) -> Result<u32, Error> {
        self.read_at(address)
    }

    fn write_at(&mut self, address: u32, data: u32) -> Result<(), Error> {
        self.write_at(address, data)
    }

    fn clocks(&mut self, clocks: u64) -> Result<(), Error> {
        self.clocks(clocks)
    }
}

/// A stage and its machine, or an inline shaper and its controller, behind a serial line.
pub struct LinkedBench<B = StageBench> {
    /// What is behind the line.
    pub bench: B,
    /// Words that were written, in order: address and word.
    pub writes: Vec<(u16, u32)>,
    bridge: LinkBridge,
    clock_hz: f64,
    byte_clocks: f64,
    timeout_clocks: u64,
    /// Clocks since the last byte.
    silent_clocks: u64,
    /// Part of a clock that bytes have taken.
    rest_clocks: f64,
    /// Bytes of replies that a host in the same thread has not read.
    coming: VecDeque<u8>,
}

/// The registers during a request.
struct Registers<'a, B> {
    bench: &'a mut B,
    writes: &'a mut Vec<(u16, u32)>,
    error: Option<Error>,
}

impl<B> Registers<'_, B> {
    fn keep<T: Default>(&mut self, result: Result<T, Error>) -> T {
        result.unwrap_or_else(|error| {
            self.error.get_or_insert(error);
            T::default()
        })
    }
}

impl<B: Registered> Bus for Registers<'_, B> {
    fn read(&mut self, address: u16) -> u32 {
        let word = self.bench.read_at(address.into());
        let word = word.and_then(|word| self.bench.clocks(ACCESS_CLOCKS).map(|()| word));
        self.keep(word)
    }

    fn write(&mut self, address: u16, word: u32) {
        self.writes.push((address, word));
        let written = self.bench.write_at(address.into(), word);
        let written = written.and_then(|()| self.bench.clocks(ACCESS_CLOCKS / 3));
        self.keep(written);
    }
}

impl<B: Registered> LinkedBench<B> {
    /// Puts a bench behind the line `link`, for registers with word addresses below `address_limit`.
    pub fn new(bench: B, link: &LinkSection, clock: &ClockSection, address_limit: u16) -> Self {
        Self {
            bench,
            writes: Vec::new(),
            bridge: LinkBridge::new(address_limit),
            clock_hz: clock.frequency_hz,
            byte_clocks: link.byte_s() * clock.frequency_hz,
            timeout_clocks: (link.timeout_s * clock.frequency_hz) as u64,
            silent_clocks: 0,
            rest_clocks: 0.0,
            coming: VecDeque::new(),
        }
    }

    fn bytes_pass(&mut self, count: usize) -> Result<(), Error> {
        self.rest_clocks += count as f64 * self.byte_clocks;
        let clocks = self.rest_clocks as u64;
        self.rest_clocks -= clocks as f64;
        self.bench.clocks(clocks)
    }

    /// A byte comes from the host. Returns the reply that it completes, after the time of its last byte.
    ///
    /// # Errors
    /// [`Error::Step`] where the model stops.
    pub fn byte(&mut self, byte: u8) -> Result<Vec<u8>, Error> {
        self.bytes_pass(1)?;
        self.silent_clocks = 0;
        let mut registers = Registers {
            bench: &mut self.bench,
            writes: &mut self.writes,
            error: None,
        };
        let reply = self.bridge.byte(byte, &mut registers);
        if let Some(error) = registers.error {
            return Err(error);
        }
        let reply = reply.unwrap_or_default();
        if !reply.is_empty() {
            self.bench.clocks(FIRST_ACCESS_CLOCKS)?;
            self.bytes_pass(reply.len())?;
        }
        Ok(reply)
    }

    /// A byte without its stop bit: a break, noise.
    pub fn bad_byte(&mut self) {
        self.bridge.bad_byte();
    }

    /// Lets time pass without a byte.
    ///
    /// # Errors
    /// [`Error::Step`] where the model stops.
    pub fn idle(&mut self, clocks: u64) -> Result<(), Error> {
        self.silent_clocks = self.silent_clocks.saturating_add(clocks);
        if self.silent_clocks >= self.timeout_clocks {
            self.bridge.silence();
        }
        self.bench.clocks(clocks)
    }

    /// Number of frames that the bridge has dropped since the reset, modulo 256.
    pub fn dropped(&self) -> u8 {
        self.bridge.dropped()
    }

    /// Serves a host at this line until `ends`. Each byte advances the simulated time, and silence advances it in steps of a fifth of a
    /// millisecond, so a host should take its time from the stage. The line's `read` must return after a short while, with
    /// [`ErrorKind::TimedOut`] if no byte has arrived.
    ///
    /// # Errors
    /// [`Error::Step`] where the model stops. Errors of the line are ignored: they mean that the host has gone.
    pub fn serve(&mut self, line: impl Read + Write, ends: &AtomicBool) -> Result<(), Error> {
        let silent_clocks = (self.clock_hz * SILENT_S) as u64;
        serve(line, ends, |heard| match heard {
            Some(byte) => self.byte(byte),
            None => self.idle(silent_clocks).map(|()| Vec::new()),
        })
    }
}

/// Serves a host at `line` until `ends`. `answer` gets each byte and returns the reply that it completes. It gets `None` if no byte has
/// arrived while a read waited.
///
/// # Errors
/// Those of `answer`. Errors of the line are ignored: they mean that the host has gone.
pub fn serve<E>(
    mut line: impl Read + Write,
    ends: &AtomicBool,
    mut answer: impl FnMut(Option<u8>) -> Result<Vec<u8>, E>,
) -> Result<(), E> {
    let mut bytes = [0; 256];
    while !ends.load(Ordering::Relaxed) {
        let count = match line.read(&mut bytes) {
            Ok(count) => count,
            Err(error) => {
                // Before the host opens its end, and after it has closed it, there is nobody at the line.
                if error.kind() != ErrorKind::TimedOut {
                    std::thread::sleep(Duration::from_millis(1));
                }
                0
            }
        };
        for byte in &bytes[..count] {
            let reply = answer(Some(*byte))?;
            // The host may have gone.
            let _ = line.write_all(&reply);
        }
        if count == 0 {
            answer(None)?;
        }
    }
    Ok(())
}

/// A host in the same thread sends.
impl<B: Registered> Write for LinkedBench<B> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        for byte in bytes {
            let reply = self.byte(*byte).map_err(io::Error::other)?;
            self.coming.extend(reply);
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// A host in the same thread reads; no time passes.
impl<B> Read for LinkedBench<B> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        if self.coming.is_empty() {
            Err(ErrorKind::TimedOut.into())
        } else {
            self.coming.read(bytes)
        }
    }
}
