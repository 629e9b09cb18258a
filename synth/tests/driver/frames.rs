//! The frames of the link in C against the byte-exact model of the hardware's bridge.

use super::bridge::{Asked, talk};
use super::support::{Driver, beside};
use posicast_blocks::link::{Bus, Crc, LinkBridge, MOST_WORDS, Request, VERSION, cobs};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

/// Addresses of registers.
const LIMIT: u16 = 300;
const FRAMES: usize = 2000;

/// What happens at the registers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Access {
    Read(u16),
    Write(u16, u32),
}

#[derive(Default)]
struct Registers(Vec<Access>);

/// What a register reads.
fn word_at(address: u16) -> u32 {
    u32::from(address).wrapping_mul(0x9e37_0001)
}

impl Bus for Registers {
    fn read(&mut self, address: u16) -> u32 {
        self.0.push(Access::Read(address));
        word_at(address)
    }

    fn write(&mut self, address: u16, word: u32) {
        self.0.push(Access::Write(address, word));
    }
}

/// A frame that the host would send, one with other commands, counts and lengths, or a damaged one: without a 0 within.
fn frame() -> impl Strategy<Value = Vec<u8>> {
    let address = || prop_oneof![400 => 0..LIMIT, 1 => LIMIT - 3..LIMIT + 3, 1 => any::<u16>()];
    let count = || 1..=usize::from(MOST_WORDS);
    let request = prop_oneof![
        (address(), 1..=MOST_WORDS).prop_map(|(address, count)| Request::Read { address, count }),
        (address(), prop::collection::vec(any::<u32>(), count()))
            .prop_map(|(address, words)| Request::Write { address, words }),
        prop::collection::vec(address(), count()).prop_map(Request::ReadList),
        prop::collection::vec((address(), any::<u32>()), count()).prop_map(Request::WriteList),
    ];
    // Few numbers, so that many requests are taken for repetitions.
    let sent = (request, 1_u8..4)
        .prop_map(|(request, sequence)| request.encode(sequence).unwrap())
        .boxed();
    let command = prop_oneof![9 => (0_u8..4).prop_map(|kind| VERSION << 4 | kind), 1 => any::<u8>()];
    let header = (0_u8..3, command, 0_u8..MOST_WORDS + 3);
    let odd = (header, prop::collection::vec(any::<u8>(), 0..20)).prop_map(|((sequence, command, count), rest)| {
        let mut bytes = [&[sequence, command, count][..], &rest[..]].concat();
        bytes.extend(Crc::of(&bytes).to_le_bytes());
        let mut frame = cobs::encode(&bytes).unwrap();
        frame.push(0);
        frame
    });
    let damaged = (sent.clone(), any::<prop::sample::Index>(), 1..=u8::MAX, 0..4).prop_map(|(sent, at, byte, how)| {
        let mut frame = sent;
        // Not the 0 behind it.
        let at = at.index(frame.len() - 1);
        match how {
            0 => drop(frame.remove(at)),
            1 => frame.insert(at, byte),
            2 => frame[at] = byte,
            _ => frame.truncate(at),
        }
        frame
    });
    prop_oneof![6 => sent, 2 => odd, 2 => damaged]
}

#[test]
fn prop_the_frames_in_c_are_answered_as_by_the_hardware() {
    let driver = Driver::write();
    let linux = driver.path().join("linux");
    let include = format!("-I{}", linux.display());
    let files = [beside("frames.c"), linux.join("posicast_frames.c")];
    let program = driver.program("frames", &["-DPOSICAST_ACCESS_FUNCTIONS", &include], &files);
    let mut runner = TestRunner::deterministic();
    let frames: Vec<Vec<u8>> = (0..FRAMES)
        .map(|_| frame().new_tree(&mut runner).unwrap().current())
        .collect();

    let (mut model, mut of_model) = (LinkBridge::new(LIMIT), Registers::default());
    let (mut next, mut in_c, mut reply) = (0, Vec::new(), Vec::new());
    let [mut executed, mut repeated, mut dropped] = [0; 3];
    talk(&program, &[], &mut |asked| match asked {
        Asked::Read(0x1_0000) => Some(LIMIT.into()),
        Asked::Read(0x1_0001) => Some(frames.get(next).map_or(u32::MAX, |frame| frame.len() as u32)),
        Asked::Read(word @ 0x2_0000..) => Some(frames[next][word as usize - 0x2_0000].into()),
        Asked::Read(word) => {
            let address = u16::try_from(word).unwrap();
            in_c.push(Access::Read(address));
            Some(word_at(address))
        }
        Asked::Write(0x4_0000, dropped_in_c) => {
            // A datagram ends a frame, as the 0 does on the line.
            let line = frames[next].iter().chain(&[0]);
            let answers = line.filter_map(|byte| model.byte(*byte, &mut of_model));
            let answer = answers.collect::<Vec<_>>().concat();
            assert_eq!(reply, answer, "frame {next}: {:02x?}", frames[next]);
            assert_eq!(in_c, of_model.0, "frame {next}: {:02x?}", frames[next]);
            assert_eq!(dropped_in_c, u32::from(model.dropped()));
            match (answer.is_empty(), in_c.is_empty()) {
                (true, _) => dropped += 1,
                (false, true) => repeated += 1,
                (false, false) => executed += 1,
            }
            next += 1;
            reply.clear();
            in_c.clear();
            of_model.0.clear();
            None
        }
        Asked::Write(word @ 0x3_0000.., byte) => {
            assert_eq!(word as usize - 0x3_0000, reply.len());
            reply.push(byte as u8);
            None
        }
        Asked::Write(word, data) => {
            in_c.push(Access::Write(word.try_into().unwrap(), data));
            None
        }
        _ => None,
    });
    assert_eq!(next, FRAMES);
    assert!(
        executed > FRAMES / 4 && repeated > FRAMES / 8 && dropped > FRAMES / 16,
        "{executed}, {repeated}, {dropped}"
    );
}
