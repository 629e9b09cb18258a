//! Requests and their repetitions.

use std::io::{ErrorKind, Read, Write};
use std::time::{Duration, Instant};

use posicast_blocks::link::{DELIMITER, MOST_REPLY_BYTES, MOST_WORDS, Reply, Request};

use crate::LinkError;

/// Longest time for which a read from a port waits before the time-out is checked.
pub(crate) const LOOK: Duration = Duration::from_millis(5);

/// Time for which a reply is awaited, and number of attempts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LinkOptions {
    /// Time from a request to its reply. It must exceed the time-out of the bridge, which is that of the machine file.
    pub timeout: Duration,
    /// Number of times that a request is sent, at least 1.
    pub attempts: u32,
}

impl Default for LinkOptions {
    fn default() -> Self {
        Self {
            timeout: Duration::from_millis(100),
            attempts: 5,
        }
    }
}

/// Statistics of the line so far.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct LinkStatistics {
    /// Requests that were answered.
    pub answered: u64,
    /// Requests that were sent again.
    pub repeated: u64,
    /// Frames that were not a reply, or were late.
    pub damaged: u64,
    /// Frames that the bridge has dropped since its reset, modulo 256.
    pub dropped_by_bridge: u8,
}

/// Anything that reads and writes bytes, for a link whose kind of line is known only at run time.
pub trait Line: Read + Write {}

impl<T: Read + Write> Line for T {}

/// The link. Words are those of the register tables, at their word addresses.
#[derive(Debug)]
pub struct Link<L> {
    line: L,
    options: LinkOptions,
    /// Sequence number of the last request; 0 before the first.
    sequence: u8,
    begun: bool,
    /// Bytes since the last delimiter.
    frame: Vec<u8>,
    statistics: LinkStatistics,
}

impl Link<Box<dyn serialport::SerialPort>> {
    /// Opens a port: 8 bits, no parity, 1 stop bit, no flow control.
    ///
    /// # Errors
    /// [`LinkError::Open`] if the operating system refuses it.
    pub fn open(port: &str, baud: u32, options: LinkOptions) -> Result<Self, LinkError> {
        match serialport::new(port, baud).timeout(LOOK).open() {
            Ok(line) => Ok(Self::new(line, options)),
            Err(error) => Err(LinkError::Open {
                port: port.to_owned(),
                reason: error.to_string(),
            }),
        }
    }
}

impl<L: Read + Write> Link<L> {
    /// Creates a link over any line. The line's `read` must return after a short while, with the bytes received or with
    /// the error [`ErrorKind::TimedOut`] or [`ErrorKind::WouldBlock`].
    pub fn new(line: L, options: LinkOptions) -> Self {
        Self {
            line,
            options,
            sequence: 0,
            begun: false,
            frame: Vec::new(),
            statistics: LinkStatistics::default(),
        }
    }

    /// Returns the statistics of the line so far.
    pub fn statistics(&self) -> LinkStatistics {
        self.statistics
    }

    /// Returns the line.
    pub fn into_line(self) -> L {
        self.line
    }

    /// Reads `count` words from consecutive addresses, 40 in each request.
    ///
    /// # Errors
    /// [`LinkError`]
    pub fn read(&mut self, address: u16, count: u16) -> Result<Vec<u32>, LinkError> {
        let mut words = Vec::with_capacity(usize::from(count));
        let most = u16::from(MOST_WORDS);
        for done in (0..count).step_by(usize::from(most)) {
            let address = address.saturating_add(done);
            let count = (count - done).min(most) as u8;
            words.extend(self.call(&Request::Read { address, count })?);
        }
        Ok(words)
    }

    /// Reads a word at each address, in this order, at most 40 in the same request.
    ///
    /// # Errors
    /// [`LinkError`]
    pub fn read_list(&mut self, addresses: &[u16]) -> Result<Vec<u32>, LinkError> {
        let mut words = Vec::with_capacity(addresses.len());
        for part in addresses.chunks(usize::from(MOST_WORDS)) {
            words.extend(self.call(&Request::ReadList(part.to_vec()))?);
        }
        Ok(words)
    }

    /// Writes words to consecutive addresses: all of them or none.
    ///
    /// # Errors
    /// [`LinkError`]; [`LinkError::Request`] for more than 40 words.
    pub fn write(&mut self, address: u16, words: &[u32]) -> Result<(), LinkError> {
        let words = words.to_vec();
        self.call(&Request::Write { address, words }).map(drop)
    }

    /// Writes a word at each address, in this order: all of them or none.
    ///
    /// # Errors
    /// [`LinkError`]; [`LinkError::Request`] for more than 40 words.
    pub fn write_list(&mut self, pairs: &[(u16, u32)]) -> Result<(), LinkError> {
        self.call(&Request::WriteList(pairs.to_vec())).map(drop)
    }

    /// Sends a request until its reply comes, and returns the words of the reply.
    ///
    /// # Errors
    /// [`LinkError`]
    pub fn call(&mut self, request: &Request) -> Result<Vec<u32>, LinkError> {
        if !self.begun {
            // The first request of a host has the number 0, which the bridge never takes for a repetition, and only
            // reads.
            let first = Request::Read { address: 0, count: 1 };
            self.exchange(&first, 0)?;
            self.begun = true;
        }
        self.sequence = self.sequence % u8::MAX + 1;
        let reply = self.exchange(request, self.sequence)?;
        if !reply.status.is_ok() {
            return Err(LinkError::Refused(reply.status));
        }
        let asked = if request.is_write() { 0 } else { request.words() };
        if reply.words.len() == asked {
            Ok(reply.words)
        } else {
            Err(LinkError::Words {
                asked,
                found: reply.words.len(),
            })
        }
    }

    fn exchange(&mut self, request: &Request, sequence: u8) -> Result<Reply, LinkError> {
        let frame = request.encode(sequence)?;
        let damaged = self.statistics.damaged;
        let attempts = self.options.attempts.max(1);
        for attempt in 0..attempts {
            if attempt > 0 || sequence == 0 {
                // The delimiter ends what the bridge may have taken for the beginning of a frame.
                self.line.write_all(&[DELIMITER])?;
            }
            self.statistics.repeated += u64::from(attempt > 0);
            self.line.write_all(&frame)?;
            self.line.flush()?;
            if let Some(reply) = self.reply(sequence)? {
                self.statistics.answered += 1;
                self.statistics.dropped_by_bridge = reply.dropped;
                return Ok(reply);
            }
        }
        Err(LinkError::NoReply {
            attempts,
            timeout: self.options.timeout,
            damaged: self.statistics.damaged - damaged,
            written: request.is_write(),
        })
    }

    /// Waits for the reply with this number; `None` if it does not come in time.
    fn reply(&mut self, sequence: u8) -> Result<Option<Reply>, LinkError> {
        let begin = Instant::now();
        let mut bytes = [0; MOST_REPLY_BYTES];
        while begin.elapsed() < self.options.timeout {
            let count = match self.line.read(&mut bytes) {
                Ok(count) => count,
                Err(error)
                    if matches!(
                        error.kind(),
                        ErrorKind::TimedOut | ErrorKind::WouldBlock | ErrorKind::Interrupted
                    ) =>
                {
                    0
                }
                Err(error) => return Err(error.into()),
            };
            let mut found = None;
            for byte in &bytes[..count] {
                if *byte != DELIMITER {
                    self.frame.push(*byte);
                    // Endless noise must not fill the memory.
                    self.frame.truncate(2 * MOST_REPLY_BYTES);
                    continue;
                }
                let frame = std::mem::take(&mut self.frame);
                match Reply::decode(&frame) {
                    Ok(reply) if reply.sequence == sequence => found = Some(reply),
                    _ if frame.is_empty() => {}
                    _ => self.statistics.damaged += 1,
                }
            }
            if found.is_some() {
                return Ok(found);
            }
        }
        Ok(None)
    }
}
