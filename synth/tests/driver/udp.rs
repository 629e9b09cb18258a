//! The server for Linux, at an address of this computer, behind a network that loses, doubles, delays and swaps datagrams.

use super::bridge::{Asked, Bridge, talk};
use super::support::{Driver, beside};
use posicast_blocks::axis::SupervisorState;
use posicast_host::{HostMove, HostedStage, Link, LinkError, LinkOptions};
use posicast_machine::hardware::Hardware;
use posicast_machine::machine_file;
use posicast_machine::plan::design_machine;
use std::cell::RefCell;
use std::net::{SocketAddr, UdpSocket};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;
use std::time::Duration;

/// The word of `udp.c` that says whether the test is over.
const IS_OVER: u32 = 0xff_ffff;

fn driver() -> Driver {
    let text = include_str!("../../../examples/xy-stage.toml").to_owned() + "[link]\nbaud = 3_000_000\n";
    Driver::of(machine_file::parse("xy-stage.toml", &text).unwrap())
}

fn server(driver: &Driver) -> PathBuf {
    let linux = driver.path().join("linux");
    let include = format!("-I{}", linux.display());
    let files = [
        beside("udp.c"),
        linux.join("posicast_server.c"),
        linux.join("posicast_frames.c"),
    ];
    driver.program("udp", &["-DPOSICAST_ACCESS_FUNCTIONS", &include], &files)
}

/// Runs the server, whose accesses `registers` answers, and beside it `host` with its port.
fn serve<T: Send>(
    program: &Path,
    registers: &mut dyn FnMut(Asked<'_>) -> Option<u32>,
    host: impl FnOnce(u16) -> T + Send,
) -> T {
    std::thread::scope(|scope| {
        // It is dropped where this thread panics, so that the host does not wait.
        let (to_host, port) = mpsc::channel();
        let host = scope.spawn(move || host(port.recv().unwrap()));
        talk(program, &[], &mut |asked| match asked {
            Asked::Read(IS_OVER) => Some(host.is_finished().into()),
            Asked::Line("port", port) => {
                to_host.send(port as u16).unwrap();
                None
            }
            asked => registers(asked),
        });
        host.join().unwrap()
    })
}

/// What a network did to datagrams, of which one in `one_in` meets each of these.
#[derive(Debug, Default)]
struct Faults {
    lost: u32,
    doubled: u32,
    /// Another one overtakes it, or many do.
    late: u32,
    old: u32,
}

/// A network between one host at a time and the server.
struct Network {
    /// The end to which hosts send.
    front: UdpSocket,
    /// The end from which it sends to the server.
    back: UdpSocket,
    host: Option<SocketAddr>,
    one_in: u64,
    random: u64,
    /// Datagrams on their way: after how many others each goes on, whether to the server, and what it is.
    waiting: Vec<(u64, bool, Vec<u8>)>,
    faults: Faults,
}

impl Network {
    fn new(server: u16, one_in: u64) -> Self {
        let socket = || {
            let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
            socket.set_read_timeout(Some(Duration::from_micros(200))).unwrap();
            socket
        };
        let (front, back) = (socket(), socket());
        back.connect(("127.0.0.1", server)).unwrap();
        Self {
            front,
            back,
            host: None,
            one_in,
            random: 1,
            waiting: Vec::new(),
            faults: Faults::default(),
        }
    }

    fn address(&self) -> String {
        self.front.local_addr().unwrap().to_string()
    }

    /// xorshift64 (Marsaglia 2003).
    fn below(&mut self, end: u64) -> u64 {
        self.random ^= self.random << 13;
        self.random ^= self.random >> 7;
        self.random ^= self.random << 17;
        self.random % end
    }

    /// Carries datagrams until `ends`, and returns what it did to them.
    fn carry(mut self, ends: &AtomicBool) -> Faults {
        let mut bytes = [0; 1024];
        while !ends.load(Ordering::Relaxed) {
            if let Ok((count, host)) = self.front.recv_from(&mut bytes) {
                self.host = Some(host);
                self.take(true, &bytes[..count]);
            }
            if let Ok(count) = self.back.recv(&mut bytes) {
                self.take(false, &bytes[..count]);
            }
        }
        self.faults
    }

    fn take(&mut self, to_server: bool, datagram: &[u8]) {
        for (left, ..) in &mut self.waiting {
            *left -= 1;
        }
        match self.below(4 * self.one_in) {
            0 => self.faults.lost += 1,
            1 => {
                self.faults.doubled += 1;
                self.give(to_server, datagram);
                let after = self.below(3) + 1;
                self.waiting.push((after, to_server, datagram.to_vec()));
            }
            2 => {
                self.faults.late += 1;
                let after = self.below(6) + 1;
                self.waiting.push((after, to_server, datagram.to_vec()));
            }
            3 => {
                self.faults.old += 1;
                self.give(to_server, datagram);
                let after = self.below(600) + 20;
                self.waiting.push((after, to_server, datagram.to_vec()));
            }
            _ => self.give(to_server, datagram),
        }
        let (due, waiting): (Vec<_>, Vec<_>) = self.waiting.drain(..).partition(|(left, ..)| *left == 0);
        self.waiting = waiting;
        for (_, to_server, datagram) in due {
            self.give(to_server, &datagram);
        }
    }

    /// A datagram that nobody takes is a lost one.
    fn give(&self, to_server: bool, datagram: &[u8]) {
        let _ = match (to_server, self.host) {
            (true, _) => self.back.send(datagram),
            (false, Some(host)) => self.front.send_to(datagram, host),
            (false, None) => return,
        };
    }
}

/// Carries the datagrams of `host` through a network in which each of four faults meets one datagram in `4 * one_in`.
fn behind_a_network<T>(server: u16, one_in: u64, host: impl FnOnce(&str) -> T) -> (T, Faults) {
    let network = Network::new(server, one_in);
    let (address, ends) = (network.address(), AtomicBool::new(false));
    std::thread::scope(|scope| {
        let carries = scope.spawn(|| network.carry(&ends));
        let until = Until(&ends);
        let result = host(&address);
        drop(until);
        (result, carries.join().unwrap())
    })
}

/// Ends the network, also where the host's thread panics.
struct Until<'a>(&'a AtomicBool);

impl Drop for Until<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Opens a link; a host whose farewell was lost keeps the next one waiting for two seconds.
fn open(address: &str, options: LinkOptions) -> Link<posicast_host::UdpLine> {
    for _ in 0..500 {
        match Link::open_udp(address, options) {
            Ok(link) => return link,
            Err(LinkError::Server { .. }) => std::thread::sleep(Duration::from_millis(20)),
            Err(error) => panic!("{error}"),
        }
    }
    panic!("the server takes no host");
}

/// Each write has another word, and they rise. So each may come to the registers once, and none behind a larger one.
#[test]
fn prop_writes_through_a_bad_network_are_done_once_and_in_order() {
    const SESSIONS: u32 = 4;
    const WRITES: u32 = 400;
    let driver = driver();
    let program = server(&driver);
    let written = RefCell::new(Vec::new());
    let mut registers = |asked: Asked<'_>| match asked {
        Asked::Read(word) => Some(word),
        Asked::Write(_, data) => {
            written.borrow_mut().push(data);
            None
        }
        _ => None,
    };
    let (calls, faults) = serve(&program, &mut registers, |port| {
        behind_a_network(port, 4, |address| {
            let mut calls = Vec::new();
            for session in 0..SESSIONS {
                // Every second host gives up at once: then a write may have been done, but never later than the next one.
                let attempts = if session % 2 == 0 { 20 } else { 1 };
                let timeout = Duration::from_millis(10);
                let open = || {
                    let line = open(address, LinkOptions { timeout, attempts: 5 }).into_line();
                    Link::new(line, LinkOptions { timeout, attempts })
                };
                let mut link = open();
                for write in 0..WRITES {
                    let word = session * WRITES + write + 1;
                    match link.write_list(&[(7, word)]) {
                        Ok(()) => calls.push((word, true)),
                        Err(LinkError::NoReply { .. }) => calls.push((word, false)),
                        // An old question of another host made its offer void.
                        Err(LinkError::Line(_)) => link = open(),
                        Err(error) => panic!("{error}"),
                    }
                }
            }
            calls
        })
    });
    let written = written.into_inner();
    assert!(written.is_sorted_by(|a, b| a < b), "twice, or late: {written:?}");
    let done: Vec<u32> = calls.iter().filter(|(_, done)| *done).map(|(word, _)| *word).collect();
    for word in &done {
        assert!(written.binary_search(word).is_ok(), "{word} was not written");
    }
    let failed = calls.len() - done.len();
    assert!(done.len() > 1000 && failed > 20, "{} done, {failed} failed", done.len());
    let Faults {
        lost,
        doubled,
        late,
        old,
    } = faults;
    assert!(
        [lost, doubled, late, old].iter().all(|count| *count > 100),
        "{faults:?}"
    );
    println!("{} writes done, {failed} without a reply, {faults:?}", done.len());
}

#[test]
fn one_host_at_a_time() {
    let driver = driver();
    let program = server(&driver);
    let options = LinkOptions::default();
    serve(
        &program,
        &mut |asked| matches!(asked, Asked::Read(_)).then_some(5),
        |port| {
            let address = format!("127.0.0.1:{port}");
            let mut first = Link::open_udp(&address, options).unwrap();
            assert_eq!(first.read(0, 2).unwrap(), [5, 5]);
            let refused = Link::open_udp(&address, options).unwrap_err().to_string();
            assert!(refused.contains("another host operates the stage"), "{refused}");
            assert_eq!(first.read(0, 1).unwrap(), [5]);
            // It leaves, and the next one may come.
            drop(first);
            let mut second = Link::open_udp(&address, options).unwrap();
            assert_eq!(second.read(0, 1).unwrap(), [5]);
            // It is silent for so long that it counts as dead.
            std::thread::sleep(Duration::from_millis(2100));
            let mut third = Link::open_udp(&address, options).unwrap();
            assert_eq!(third.read(0, 1).unwrap(), [5]);
            let over = second.read(0, 1).unwrap_err().to_string();
            assert!(over.contains("the server has another host now"), "{over}");
        },
    );
}

/// The stage and its machine behind the server, and a network with faults before it.
#[test]
fn a_host_in_the_network_moves_the_machine() {
    let driver = driver();
    let program = server(&driver);
    let machine = driver.machine.clone();
    let mut bridge = Bridge::new(&driver, "refused.c", false);
    let bench = &mut bridge.bench;
    let mut registers = |asked: Asked<'_>| match asked {
        Asked::Read(word) => Some(bench.read_at(word).unwrap()),
        Asked::Write(word, data) => {
            bench.write_at(word, data).unwrap();
            None
        }
        Asked::Pause => {
            bench.clocks(20_000).unwrap();
            None
        }
        Asked::Line(..) => None,
    };
    let (status, faults) = serve(&program, &mut registers, |port| {
        behind_a_network(port, 20, |address| {
            let design = design_machine(&machine).unwrap();
            let hardware = Hardware::of(&machine, &design).unwrap();
            let stage = hardware.stage().unwrap().unwrap();
            let options = LinkOptions {
                timeout: Duration::from_millis(100),
                attempts: 20,
            };
            let mut host = HostedStage::open(open(address, options), &machine, stage).unwrap();
            host.switch_on(&[0, 1], false).unwrap();
            let of = |axis, distance| HostMove {
                axis,
                distance,
                speed: None,
            };
            host.move_axes(&[of(0, 0.002), of(1, -0.001)]).unwrap();
            let there = host.status().unwrap();
            host.switch_off(&[0, 1]).unwrap();
            there
        })
    });
    assert_eq!(status[0].state, Some(SupervisorState::Hold));
    assert_eq!([status[0].command, status[1].command], [2000.0, -1000.0]);
    let at = [0, 1].map(|axis| bridge.bench.plant(axis).count());
    assert!((at[0] - 2000).abs() <= 2 && (at[1] + 1000).abs() <= 2, "{at:?}");
    assert!(faults.lost > 0 && faults.doubled > 0 && faults.old > 0, "{faults:?}");
}
