//! The host's end through a pseudo-terminal of the operating system, with the byte-exact bridge behind it.

use std::convert::Infallible;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use crate::faults::{REGISTERS, Registers};
use posicast_blocks::link::LinkBridge;
use posicast_closed_loop::linked_bench::serve;
use posicast_host::{Link, LinkError, LinkOptions};
use serialport::{SerialPort, TTYPort};

const OPTIONS: LinkOptions = LinkOptions {
    timeout: Duration::from_secs(2),
    attempts: 3,
};

/// Serves the bridge at the other end until `ends`; returns what was written.
fn served(mut line: TTYPort, ends: &AtomicBool) -> Vec<(u16, u32)> {
    let (mut bridge, mut registers) = (LinkBridge::new(REGISTERS), Registers::default());
    line.set_timeout(Duration::from_millis(5)).unwrap();
    let served: Result<(), Infallible> = serve(line, ends, |heard| {
        let reply = heard.and_then(|byte| bridge.byte(byte, &mut registers));
        Ok(reply.unwrap_or_default())
    });
    served.unwrap();
    registers.writes
}

/// Ends the bridge, also when the test fails.
struct End<'a>(&'a AtomicBool);

impl Drop for End<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

#[test]
fn requests_pass_through_a_terminal_without_being_changed() {
    let (far, near) = TTYPort::pair().unwrap();
    let port = near.name().unwrap();
    // One program holds a port: the host opens it again.
    drop(near);
    let ends = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let server = scope.spawn(|| served(far, &ends));
        let end = End(&ends);
        let mut link = Link::open(&port, 115_200, OPTIONS).unwrap();
        // Every byte occurs: a terminal that edits lines or handles control characters would change some.
        let words: Vec<u32> = (0..64_u32)
            .map(|word| u32::from_le_bytes([0, 1, 2, 3].map(|byte| (word * 4 + byte) as u8)))
            .collect();
        for (address, part) in (0..).step_by(32).zip(words.chunks(32)) {
            link.write(address, part).unwrap();
        }
        assert_eq!(link.read(3, 2).unwrap(), [0x301, 0x401]);
        assert_eq!(link.statistics().damaged, 0);
        drop(end);
        let expected: Vec<(u16, u32)> = (0..).zip(words).collect();
        assert_eq!(server.join().unwrap(), expected);
    });
}

#[test]
fn a_port_that_is_not_there_is_named() {
    let error = Link::open("/dev/no-such-port", 115_200, OPTIONS).unwrap_err();
    assert!(matches!(error, LinkError::Open { .. }));
    assert!(error.to_string().starts_with("/dev/no-such-port: "), "{error}");
}
