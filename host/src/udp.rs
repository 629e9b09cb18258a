//! The line over UDP: frames in datagrams, to the C driver's server for Linux (`driver/linux/posicast_server.h`).
//!
//! ```text
//! token, 4 bytes | number, 4 bytes | frame         little-endian
//! ```
//!
//! The host asks for a token with a number of its own, and gets one if there is no other host. Its requests have the numbers 1, 2, 3, …; a
//! repetition has the number of the first attempt. A datagram with another token or number is a late reply, and is ignored. A datagram
//! without a frame ends the connection.

use std::collections::VecDeque;
use std::collections::hash_map::RandomState;
use std::hash::{BuildHasher, Hasher};
use std::io::{self, ErrorKind, Read, Write};
use std::net::{SocketAddr, ToSocketAddrs, UdpSocket};
use std::time::Instant;

use posicast_blocks::link::DELIMITER;

use crate::link::LOOK;
use crate::{Link, LinkError, LinkOptions};

/// Bytes of a datagram before the frame.
const HEADER_BYTES: usize = 8;
/// More than the longest datagram.
const DATAGRAM_BYTES: usize = 512;
/// The token of a host without one, and of a server that refuses.
const NO_TOKEN: u32 = 0;

/// A line over UDP.
#[derive(Debug)]
pub struct UdpLine {
    socket: UdpSocket,
    token: u32,
    /// Number of the last request.
    number: u32,
    /// Frame of the last request, without delimiters before it.
    request: Vec<u8>,
    /// Bytes since the last flush.
    going: Vec<u8>,
    /// Bytes of the reply that were not read yet.
    coming: VecDeque<u8>,
}

impl Link<UdpLine> {
    /// Opens a link to a server at `HOST:PORT`.
    ///
    /// # Errors
    /// [`LinkError::Server`] if there is no such address, no server, or already another host.
    pub fn open_udp(address: &str, options: LinkOptions) -> Result<Self, LinkError> {
        Ok(Self::new(UdpLine::open(address, options)?, options))
    }
}

impl UdpLine {
    /// Asks the server at `HOST:PORT` for a token.
    ///
    /// # Errors
    /// [`LinkError::Server`] if there is no such address, no server, or already another host.
    pub fn open(address: &str, options: LinkOptions) -> Result<Self, LinkError> {
        let failed = |reason: String| LinkError::Server {
            address: address.to_owned(),
            reason,
        };
        let found = address.to_socket_addrs().map(Iterator::collect::<Vec<SocketAddr>>);
        let found = found.map_err(|error| failed(format!("{error}; write HOST:PORT")))?;
        let server = found
            .first()
            .ok_or_else(|| failed("the name has no address".to_owned()))?;
        let own: SocketAddr = match server {
            SocketAddr::V4(_) => ([0; 4], 0).into(),
            SocketAddr::V6(_) => ([0; 16], 0).into(),
        };
        let socket = UdpSocket::bind(own).and_then(|socket| {
            socket.connect(server)?;
            socket.set_read_timeout(Some(LOOK))?;
            Ok(socket)
        });
        let mut line = Self {
            socket: socket.map_err(|error| failed(error.to_string()))?,
            token: NO_TOKEN,
            number: 0,
            request: Vec::new(),
            going: Vec::new(),
            coming: VecDeque::new(),
        };
        // Hosts that ask at the same time need different numbers.
        let asked = RandomState::new().build_hasher().finish() as u32;
        line.token = line.ask(asked, options).map_err(failed)?;
        Ok(line)
    }

    /// Asks for a token until there is an answer.
    fn ask(&self, asked: u32, options: LinkOptions) -> Result<u32, String> {
        let attempts = options.attempts.max(1);
        for _ in 0..attempts {
            self.send(asked, &[]).map_err(|error| no_server(&error))?;
            let begin = Instant::now();
            while begin.elapsed() < options.timeout {
                match self.receive() {
                    Ok(Some((NO_TOKEN, number, _))) if number == asked => {
                        return Err(
                            "another host operates the stage; wait until it has left, or is silent for 2 s".to_owned(),
                        );
                    }
                    Ok(Some((token, number, _))) if number == asked => return Ok(token),
                    Ok(_) => {}
                    Err(error) => return Err(no_server(&error)),
                }
            }
        }
        let each = options.timeout.as_millis();
        Err(no_server(&format!("no reply in {attempts} attempts of {each} ms")))
    }

    fn send(&self, number: u32, frame: &[u8]) -> io::Result<()> {
        let mut datagram = Vec::with_capacity(HEADER_BYTES + frame.len());
        datagram.extend(self.token.to_le_bytes());
        datagram.extend(number.to_le_bytes());
        datagram.extend(frame);
        self.socket.send(&datagram).map(drop)
    }

    /// Returns token, number and frame of the next datagram; `None` if none came, or an invalid one.
    fn receive(&self) -> io::Result<Option<(u32, u32, Vec<u8>)>> {
        let mut bytes = [0; DATAGRAM_BYTES];
        let count = match self.socket.recv(&mut bytes) {
            Ok(count) => count,
            Err(error) if is_nothing(&error) => return Ok(None),
            Err(error) => return Err(error),
        };
        let [t0, t1, t2, t3, n0, n1, n2, n3, frame @ ..] = &bytes[..count] else {
            return Ok(None);
        };
        let word = |bytes: [&u8; 4]| u32::from_le_bytes(bytes.map(|byte| *byte));
        Ok(Some((word([t0, t1, t2, t3]), word([n0, n1, n2, n3]), frame.to_vec())))
    }
}

fn no_server(found: &dyn std::fmt::Display) -> String {
    format!("{found}: does posicast_serve run there, at this address and port?")
}

fn is_nothing(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::TimedOut | ErrorKind::WouldBlock | ErrorKind::Interrupted
    )
}

impl Write for UdpLine {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.going.extend(bytes);
        Ok(bytes.len())
    }

    /// Sends what was written since the last flush, a frame, as a datagram.
    fn flush(&mut self) -> io::Result<()> {
        let going = std::mem::take(&mut self.going);
        let begin = going.iter().position(|byte| *byte != DELIMITER).unwrap_or(going.len());
        let frame = &going[begin..];
        // Requests that follow each other have different sequence numbers, so an equal frame is a repetition.
        if frame != self.request {
            self.number = self.number.wrapping_add(1);
            self.request = frame.to_vec();
        }
        self.coming.clear();
        self.send(self.number, frame)
    }
}

impl Read for UdpLine {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        if self.coming.is_empty() {
            match self.receive()? {
                Some((token, number, frame)) if token == self.token && number == self.number => {
                    self.coming.extend(frame)
                }
                Some((NO_TOKEN, number, _)) if number == self.number => {
                    return Err(io::Error::new(
                        ErrorKind::ConnectionAborted,
                        "the server has another host now, or was restarted",
                    ));
                }
                _ => return Err(ErrorKind::TimedOut.into()),
            }
        }
        self.coming.read(bytes)
    }
}

impl Drop for UdpLine {
    /// Releases the server for the next host. If this datagram is lost, the next host has to wait.
    fn drop(&mut self) {
        if self.token != NO_TOKEN {
            let _ = self.send(self.number.wrapping_add(1), &[]);
        }
    }
}
