//! The host link's frames and its bridge, byte by byte, over a line that loses, doubles, changes and invents bytes.

use crate::support::random_inputs::Random;
use posicast_blocks::link::{
    Bus, FrameDecoder, FrameEnd, LinkBridge, LinkStatus, MOST_REPLY_BYTES, MOST_REQUEST_BYTES, MOST_WORDS, Reply,
    Request, RequestError, RequestHeader, cobs,
};
use proptest::prelude::*;

const REGISTERS: u16 = 300;

/// Registers that remember what was written to them.
#[derive(Default)]
struct Recorder {
    writes: Vec<(u16, u32)>,
    reads: Vec<u16>,
}

impl Bus for Recorder {
    fn read(&mut self, address: u16) -> u32 {
        self.reads.push(address);
        u32::from(address).wrapping_mul(0x0100_0001)
    }

    fn write(&mut self, address: u16, word: u32) {
        self.writes.push((address, word));
    }
}

/// What a request asks of the registers.
fn wanted(request: &Request) -> Vec<(u16, Option<u32>)> {
    match request {
        Request::Read { address, count } => (0..u16::from(*count)).map(|index| (address + index, None)).collect(),
        Request::Write { address, words } => (*address..).zip(words.iter().map(|word| Some(*word))).collect(),
        Request::ReadList(addresses) => addresses.iter().map(|address| (*address, None)).collect(),
        Request::WriteList(pairs) => pairs.iter().map(|(address, word)| (*address, Some(*word))).collect(),
    }
}

fn sent(bridge: &mut LinkBridge, frame: &[u8], bus: &mut Recorder) -> Option<Reply> {
    let reply = frame
        .iter()
        .fold(None, |reply, byte| bridge.byte(*byte, bus).or(reply))?;
    Some(Reply::decode(reply.strip_suffix(&[0]).unwrap()).unwrap())
}

fn requests() -> impl Strategy<Value = Request> {
    let most = usize::from(MOST_WORDS);
    let word = prop_oneof![any::<u32>(), Just(0), 0_u32..300];
    prop_oneof![
        (0..REGISTERS - 40, 1..=MOST_WORDS).prop_map(|(address, count)| Request::Read { address, count }),
        (0..REGISTERS - 40, prop::collection::vec(word.clone(), 1..=most))
            .prop_map(|(address, words)| Request::Write { address, words }),
        prop::collection::vec(0..REGISTERS, 1..=most).prop_map(Request::ReadList),
        prop::collection::vec((0..REGISTERS, word), 1..=most).prop_map(Request::WriteList),
    ]
}

proptest! {
    #[test]
    fn prop_bytes_survive_cobs_without_a_zero(bytes in prop::collection::vec(prop_oneof![Just(0), any::<u8>()], 0..=253)) {
        let encoded = cobs::encode(&bytes).unwrap();
        prop_assert!(!encoded.contains(&0) && encoded.len() == bytes.len() + 1);
        prop_assert_eq!(cobs::decode(&encoded), Some(bytes));
    }

    #[test]
    fn prop_a_request_is_executed_and_answered(request in requests(), sequence in 1_u8..) {
        let (mut bridge, mut bus) = (LinkBridge::new(REGISTERS), Recorder::default());
        let frame = request.encode(sequence).unwrap();
        prop_assert!(frame.len() <= MOST_REQUEST_BYTES + 2);
        let reply = sent(&mut bridge, &frame, &mut bus).unwrap();
        let wanted = wanted(&request);
        let words: Vec<u32> = wanted.iter().filter(|(_, word)| word.is_none()).map(|(at, _)| u32::from(*at).wrapping_mul(0x0100_0001)).collect();
        let writes: Vec<(u16, u32)> = wanted.iter().filter_map(|(at, word)| Some((*at, (*word)?))).collect();
        prop_assert_eq!((reply.sequence, reply.status, &reply.words), (sequence, LinkStatus::Ok, &words));
        prop_assert!(reply.encode().len() <= MOST_REPLY_BYTES + 2);
        prop_assert_eq!(&bus.writes, &writes);
        prop_assert_eq!(bus.reads.len(), words.len());

        // Again: the same reply, no second effect.
        prop_assert_eq!(sent(&mut bridge, &frame, &mut bus), Some(reply));
        prop_assert_eq!((bus.writes, bus.reads.len()), (writes, words.len()));
    }

    #[test]
    fn prop_a_request_with_one_wrong_address_does_nothing(
        mut pairs in prop::collection::vec((0..REGISTERS, any::<u32>()), 1..=40), at in any::<prop::sample::Index>(), wrong in REGISTERS..,
    ) {
        let place = at.index(pairs.len());
        pairs[place].0 = wrong;
        let (mut bridge, mut bus) = (LinkBridge::new(REGISTERS), Recorder::default());
        let reads = Request::ReadList(pairs.iter().map(|(address, _)| *address).collect());
        for (sequence, request) in [(7, Request::WriteList(pairs)), (8, reads)] {
            let reply = sent(&mut bridge, &request.encode(sequence).unwrap(), &mut bus).unwrap();
            prop_assert_eq!((reply.sequence, reply.status, reply.words.len()), (sequence, LinkStatus::WrongAddress, 0));
        }
        prop_assert_eq!((bus.writes.len(), bus.reads.len()), (0, 0));
    }

    #[test]
    fn prop_whatever_came_before_a_delimiter_does_not_matter(noise in prop::collection::vec(any::<u8>(), 0..600), request in requests()) {
        let (mut bridge, mut bus) = (LinkBridge::new(REGISTERS), Recorder::default());
        noise.iter().for_each(|byte| { bridge.byte(*byte, &mut bus); });
        bridge.byte(0, &mut bus);
        prop_assert_eq!(bus.writes.len(), 0);
        let reply = sent(&mut bridge, &request.encode(200).unwrap(), &mut bus).unwrap();
        prop_assert_eq!((reply.sequence, reply.status), (200, LinkStatus::Ok));
    }

    #[test]
    fn prop_one_byte_lost_doubled_or_changed_is_no_request(request in requests(), at in any::<prop::sample::Index>(), kind in 0..3, flip in 1_u8..) {
        let mut frame = request.encode(3).unwrap();
        frame.pop();
        let place = at.index(frame.len());
        match kind {
            0 => { frame.remove(place); }
            1 => frame.insert(place, frame[place]),
            _ => frame[place] ^= flip,
        }
        frame.push(0);
        let (mut bridge, mut bus) = (LinkBridge::new(REGISTERS), Recorder::default());
        prop_assert_eq!(sent(&mut bridge, &frame, &mut bus), None);
        prop_assert_eq!((bus.writes.len(), bus.reads.len()), (0, 0));
        prop_assert!(bridge.dropped() >= 1);
    }
}

#[test]
fn addresses_end_where_the_registers_do() {
    let (mut bridge, mut bus) = (LinkBridge::new(REGISTERS), Recorder::default());
    let last = Request::Write {
        address: REGISTERS - 2,
        words: vec![1, 2],
    };
    let beyond = Request::Write {
        address: REGISTERS - 2,
        words: vec![1, 2, 3],
    };
    let around = Request::Write {
        address: u16::MAX,
        words: vec![1, 2],
    };
    for (sequence, request, status) in [
        (1, last, LinkStatus::Ok),
        (2, beyond, LinkStatus::WrongAddress),
        (3, around, LinkStatus::WrongAddress),
    ] {
        let reply = sent(&mut bridge, &request.encode(sequence).unwrap(), &mut bus).unwrap();
        assert_eq!(reply.status, status);
    }
    assert_eq!(bus.writes, [(REGISTERS - 2, 1), (REGISTERS - 1, 2)]);
}

#[test]
fn requests_that_are_none_are_refused_on_both_sides() {
    let words = |words: usize| Request::Write {
        address: 0,
        words: vec![5; words],
    };
    assert_eq!(words(0).encode(1), Err(RequestError::Words(0)));
    assert_eq!(words(41).encode(1), Err(RequestError::Words(41)));
    assert_eq!(words(1).encode(0), Err(RequestError::Sequence));
    assert_eq!(
        Request::Read { address: 0, count: 0 }.encode(1),
        Err(RequestError::Words(0))
    );

    let header = |sequence, command, count| RequestHeader {
        sequence,
        command,
        count,
    };
    let judged = |sequence, command, count, length| header(sequence, command, count).status(length);
    assert_eq!(judged(1, 0x10, 1, 9), LinkStatus::Ok);
    assert_eq!(judged(0, 0x10, 1, 9), LinkStatus::Ok);
    assert_eq!(judged(1, 0x13, 40, 247), LinkStatus::Ok);
    for command in [0x00, 0x14, 0x20, 0xf0] {
        assert_eq!(judged(1, command, 1, 9), LinkStatus::UnknownCommand);
    }
    assert_eq!(judged(1, 0x10, 0, 9), LinkStatus::WrongLength);
    assert_eq!(judged(1, 0x10, 41, 9), LinkStatus::WrongLength);
    assert_eq!(judged(1, 0x11, 1, 12), LinkStatus::WrongLength);
    assert_eq!(judged(0, 0x11, 1, 13), LinkStatus::WriteWithoutSequence);
}

#[test]
fn a_request_with_the_sequence_number_0_is_executed_each_time() {
    let (mut bridge, mut bus) = (LinkBridge::new(REGISTERS), Recorder::default());
    let frame = Request::Read { address: 4, count: 2 }.encode(0).unwrap();
    for reads in [2, 4] {
        assert!(sent(&mut bridge, &frame, &mut bus).is_some());
        assert_eq!(bus.reads.len(), reads);
    }
}

#[test]
fn a_silence_within_a_frame_spoils_it_and_one_between_frames_does_not() {
    let (mut bridge, mut bus) = (LinkBridge::new(REGISTERS), Recorder::default());
    let frame = Request::Write {
        address: 1,
        words: vec![2],
    }
    .encode(9)
    .unwrap();
    let (front, rest) = frame.split_at(5);
    assert_eq!(sent(&mut bridge, front, &mut bus), None);
    bridge.silence();
    assert_eq!(sent(&mut bridge, rest, &mut bus), None);
    assert_eq!((bus.writes.len(), bridge.dropped()), (0, 1));
    bridge.silence();
    assert!(sent(&mut bridge, &frame, &mut bus).is_some());
    assert_eq!(bus.writes, [(1, 2)]);
}

#[test]
fn the_longest_request_fits_and_a_byte_more_is_dropped() {
    let mut decoder = FrameDecoder::default();
    let mut ends = |bytes: usize| {
        let encoded = cobs::encode(&vec![9; bytes]).unwrap();
        encoded.iter().for_each(|byte| assert_eq!(decoder.byte(*byte), None));
        (decoder.byte(0), decoder.bytes().len())
    };
    assert_eq!(
        ends(MOST_REQUEST_BYTES + 1),
        (Some(FrameEnd::Dropped), MOST_REQUEST_BYTES)
    );
    let longest = Request::WriteList(vec![(1, 2); 40]).encode(1).unwrap();
    assert_eq!(longest.len(), MOST_REQUEST_BYTES + 2);
    let end = longest.iter().fold(None, |end, byte| decoder.byte(*byte).or(end));
    assert_eq!(
        (end, decoder.bytes().len()),
        (Some(FrameEnd::Whole), MOST_REQUEST_BYTES)
    );
}

/// A line that damages about one byte in `one_in`.
struct Line {
    random: Random,
    one_in: u64,
    faults: u64,
}

impl Line {
    fn carry(&mut self, bytes: &[u8]) -> Vec<u8> {
        let mut carried = Vec::new();
        for byte in bytes {
            let any = self.random.next() as u8;
            let fault = match self.random.below(self.one_in) {
                0 => self.random.below(6),
                _ => 6,
            };
            self.faults += u64::from(fault < 6);
            match fault {
                0 => {}
                1 => carried.extend([*byte, *byte]),
                2 => carried.push(any),
                3 => carried.push(byte ^ 1 << (any % 8)),
                4 => carried.extend([any, *byte]),
                5 => carried.push(0),
                _ => carried.push(*byte),
            }
        }
        carried
    }
}

/// A host writes words that never repeat over the damaged line, and tries each request up to five times. What reaches the
/// registers is what it sent, in that order, each word once; what was acknowledged has reached them.
fn campaign(faults: u64, seed: u64) {
    let (mut bridge, mut bus) = (LinkBridge::new(REGISTERS), Recorder::default());
    let mut line = Line {
        random: Random(seed),
        one_in: 40,
        faults: 0,
    };
    let (mut sequence, mut word) = (0, 0_u32);
    let (mut acknowledged, mut repeated, mut given_up) = (0, 0, 0);
    while line.faults < faults {
        sequence = sequence % 255 + 1;
        let words = 1 + line.random.below(8) as u8;
        let mut next = || {
            word += 1;
            word.wrapping_mul(0x9e37_79b1)
        };
        let request = match line.random.below(3) {
            0 => Request::Read {
                address: 0,
                count: words,
            },
            1 => Request::Write {
                address: 5,
                words: (0..words).map(|_| next()).collect(),
            },
            _ => Request::WriteList((0..words).map(|index| (u16::from(index) * 37, next())).collect()),
        };
        let expected: Vec<(u16, u32)> = wanted(&request)
            .into_iter()
            .filter_map(|(at, word)| Some((at, word?)))
            .collect();
        let before = bus.writes.len();
        let mut frame = request.encode(sequence).unwrap();
        let mut done = false;
        for attempt in 0..5 {
            let mut heard = Vec::new();
            for byte in line.carry(&frame) {
                heard.extend(bridge.byte(byte, &mut bus).unwrap_or_default());
            }
            bridge.silence();
            let heard = line.carry(&heard);
            let replies = heard
                .split(|byte| *byte == 0)
                .filter_map(|frame| Reply::decode(frame).ok());
            done = replies.into_iter().any(|reply| reply.sequence == sequence);
            if done {
                acknowledged += 1;
                break;
            }
            if attempt == 0 {
                frame.insert(0, 0);
                repeated += 1;
            }
        }
        given_up += u64::from(!done);
        let written = &bus.writes[before..];
        assert!(
            written == expected || (!done && written.is_empty()),
            "{written:?} is not {expected:?}"
        );
        bus.writes.clear();
    }
    assert!(
        acknowledged > faults / 100 && repeated > faults / 100,
        "{acknowledged} {repeated} {given_up}"
    );
}

#[test]
fn prop_50_000_faults_write_nothing_wrong_and_nothing_twice() {
    campaign(50_000, 1);
}

#[test]
fn long_a_million_faults_write_nothing_wrong_and_nothing_twice() {
    campaign(1_000_000, 2);
}
