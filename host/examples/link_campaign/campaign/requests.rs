//! What the hosts sent, and whether it is what was written.

use posicast_blocks::link::cobs;

/// Commands that write: words at consecutive addresses, and a word at each address.
const WRITE: u8 = 0x11;
const WRITE_LIST: u8 = 0x13;

/// A request with writes, as a host sent it.
struct Sent {
    sequence: u8,
    pairs: Vec<(u16, u32)>,
    /// Whether it may be missing: its host got no reply.
    open: bool,
}

/// The requests with writes of all hosts, in order.
#[derive(Default)]
pub(super) struct Requests {
    /// The frame that the present host is sending.
    frame: Vec<u8>,
    sent: Vec<Sent>,
    /// Requests of hosts that have ended.
    closed: usize,
}

impl Requests {
    /// Takes a byte as a host sent it, before the line.
    pub(super) fn byte(&mut self, byte: u8) {
        if byte != 0 {
            self.frame.push(byte);
            return;
        }
        let frame = std::mem::take(&mut self.frame);
        let Some((sequence, pairs)) = cobs::decode(&frame).and_then(|bytes| writes(&bytes)) else {
            return;
        };
        // A repetition has the number of the request before it.
        if self
            .sent
            .last()
            .is_none_or(|last| last.sequence != sequence || !last.open)
        {
            self.sent.push(Sent {
                sequence,
                pairs,
                open: true,
            });
        }
    }

    /// A host has ended: with success, all of its requests were answered; else all but the last. What it left of a frame is lost.
    pub(super) fn close(&mut self, well: bool) {
        self.frame.clear();
        let count = self.sent.len();
        for (at, sent) in self.sent.iter_mut().enumerate().skip(self.closed) {
            sent.open = at + 1 == count && !well;
        }
        self.closed = count;
        // The next host's first request is never taken for a repetition of this one's last.
        if let Some(last) = self.sent.last_mut()
            && last.open
        {
            last.sequence = 0;
        }
    }

    /// Compares what reached the bus with what was sent: request by request, whole, once and in order.
    pub(super) fn are(&self, written: &[(u16, u32)]) -> Result<(), String> {
        let mut rest = written;
        for (number, request) in self.sent.iter().enumerate() {
            match rest.strip_prefix(request.pairs.as_slice()) {
                Some(behind) => rest = behind,
                None if request.open => {}
                None => {
                    return Err(format!(
                        "request {number} of {} is not what was written: {:x?}",
                        self.sent.len(),
                        rest.first()
                    ));
                }
            }
        }
        match rest {
            [] => Ok(()),
            [first, ..] => Err(format!(
                "{} words were written that nobody sent, first {first:x?}",
                rest.len()
            )),
        }
    }
}

/// Sequence number and writes of a request, if it is one with writes.
fn writes(bytes: &[u8]) -> Option<(u8, Vec<(u16, u32)>)> {
    let [sequence, command, count, rest @ ..] = bytes else {
        return None;
    };
    let count = usize::from(*count);
    let number = |bytes: &[u8]| {
        bytes
            .iter()
            .rev()
            .fold(0, |number: u32, byte| number << 8 | u32::from(*byte))
    };
    let pairs = match *command {
        WRITE => {
            let words = (0..count).map(|at| number(&rest[2 + 4 * at..6 + 4 * at]));
            (number(&rest[..2]) as u16..).zip(words).collect()
        }
        WRITE_LIST => {
            let pairs = (0..count).map(|at| &rest[6 * at..6 * at + 6]);
            pairs
                .map(|pair| (number(&pair[..2]) as u16, number(&pair[2..])))
                .collect()
        }
        _ => return None,
    };
    Some((*sequence, pairs))
}

/// A wrong write must be found: the comparison is tried on writes that are doubled, missing, changed and exchanged.
pub(crate) fn comparison_finds_wrong_writes() {
    let sent = |pairs: &[(u16, u32)]| Sent {
        sequence: 1,
        pairs: pairs.to_vec(),
        open: false,
    };
    let all = Requests {
        sent: vec![sent(&[(1, 5)]), sent(&[(2, 6), (3, 7)])],
        ..Requests::default()
    };
    assert_eq!(all.are(&[(1, 5), (2, 6), (3, 7)]), Ok(()));
    for wrong in [
        &[(1, 5), (1, 5), (2, 6), (3, 7)][..],
        &[(1, 5), (2, 6)],
        &[(1, 5), (2, 6), (3, 8)],
        &[(2, 6), (3, 7), (1, 5)],
        &[(1, 5), (2, 6), (3, 7), (3, 7)],
    ] {
        assert!(all.are(wrong).is_err(), "{wrong:?}");
    }
}
