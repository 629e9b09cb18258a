//! The socket to LinuxCNC's component: requests of two words, and one word in return for a read.

use std::io::{self, ErrorKind, Read, Write};
use std::os::unix::net::UnixStream;
use std::time::{Duration, Instant};

/// Time for which LinuxCNC may be silent before the machine runs on by itself.
const SILENCE: Duration = Duration::from_secs(1);
/// Time for which the process waits for the next request without sleeping. A servo period has some twenty reads, one after the other, and
/// waking a sleeping process takes longer than an answer.
const AWAKE: Duration = Duration::from_millis(1);
/// Time for which the process sleeps after that.
const NAP: Duration = Duration::from_micros(100);
/// Bytes of a request.
const REQUEST: usize = 8;

pub(crate) struct Link {
    stream: UnixStream,
    /// Bytes received: whole requests, and at most one incomplete one.
    bytes: Vec<u8>,
    /// Number of bytes that have been taken.
    taken: usize,
    last: Instant,
}

pub(crate) enum Request {
    /// The kind of the request with the register's number, and its data.
    Words([u32; 2]),
    /// Nothing yet.
    None,
    /// Nothing for [`SILENCE`].
    Silence,
    /// LinuxCNC has closed the socket.
    End,
}

impl Link {
    pub(crate) fn new(stream: UnixStream) -> io::Result<Self> {
        stream.set_nonblocking(true)?;
        Ok(Self {
            stream,
            bytes: Vec::new(),
            taken: 0,
            last: Instant::now(),
        })
    }

    /// The next request, if there is one.
    pub(crate) fn request(&mut self) -> io::Result<Request> {
        if let Some((request, _)) = self.bytes[self.taken..].split_first_chunk::<REQUEST>() {
            self.taken += REQUEST;
            self.last = Instant::now();
            let [what, data] = [0, 4].map(|at| u32::from_le_bytes([0, 1, 2, 3].map(|byte| request[at + byte])));
            return Ok(Request::Words([what, data]));
        }
        self.bytes.drain(..self.taken);
        self.taken = 0;
        let mut more = [0; 512 * REQUEST];
        match self.stream.read(&mut more) {
            Ok(0) => Ok(Request::End),
            Ok(count) => {
                self.bytes.extend(&more[..count]);
                Ok(Request::None)
            }
            Err(error) if error.kind() == ErrorKind::WouldBlock => Ok(self.nothing()),
            Err(error) => Err(error),
        }
    }

    fn nothing(&mut self) -> Request {
        match self.last.elapsed() {
            silent if silent > SILENCE => {
                self.last = Instant::now();
                return Request::Silence;
            }
            silent if silent > AWAKE => std::thread::sleep(NAP),
            _ => std::thread::yield_now(),
        }
        Request::None
    }

    /// Answers a read. LinuxCNC takes every answer before it asks again, so the socket has room for it.
    pub(crate) fn answer(&mut self, word: u32) -> io::Result<()> {
        self.stream.write_all(&word.to_le_bytes())
    }
}
