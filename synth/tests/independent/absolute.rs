//! The absolute encoder's Verilog in Icarus, at encoders that are written in Python from the descriptions of SSI and BiSS-C.

use super::{output, python, write};
use posicast_blocks::absolute_encoder::{
    AbsoluteEncoderConfig, AbsoluteFrame, AbsoluteLimits, AbsoluteProtocol, AbsoluteTimes, FrameCheck, FrameStatusBit,
};
use posicast_testbench::absolute_encoder::AbsoluteEncoderBlock;
use posicast_testbench::blocks::Block;
use serde_json::{Value, json};
use std::path::Path;

/// Clock of the bench in ns.
const CLOCK_NS: u64 = 10;
/// What jitter, synchroniser and the edge of the clock need.
const SPARE_NS: u64 = 40;

/// Runs the bench; returns how often each kind of reading came.
fn tally(config: &AbsoluteEncoderConfig, readings: u64, seed: u64) -> Value {
    let (frame, times, limits) = (config.frame(), config.times(), config.limits());
    let jitter_ns = 8;
    let most_delay_ns = match config.protocol() {
        AbsoluteProtocol::Ssi => config.most_ssi_delay_clocks() * CLOCK_NS - jitter_ns,
        AbsoluteProtocol::BissC => 5 * config.period_clocks() * CLOCK_NS,
    };
    let status = |bit: Option<FrameStatusBit>| bit.map(|bit| (bit.place, bit.active_low));
    let built = json!({
        "protocol": config.protocol().name(),
        "leading": frame.leading_bits,
        "position": frame.position_bits,
        "trailing": frame.trailing_bits,
        "gray": frame.gray,
        "check": frame.check.name(),
        "error": status(frame.error),
        "warning": status(frame.warning),
        "period_clocks": config.period_clocks(),
        "pause_clocks": times.pause_clocks,
        "latch_clocks": config.latch_clocks(),
        "tick_clocks": config.least_tick_clocks(),
        "ready_ns": times.pause_clocks * CLOCK_NS - most_delay_ns - jitter_ns - SPARE_NS,
        "most_delay_ns": most_delay_ns,
        "jitter_ns": jitter_ns,
        "largest": limits.largest_jump,
        "tolerated": limits.tolerated,
        "readings": readings,
        "seed": seed,
    });
    let block = AbsoluteEncoderBlock::new(*config, "");
    let folder = tempfile::tempdir().unwrap();
    let modules = block.modules().unwrap();
    let files = modules
        .iter()
        .map(|module| write(folder.path(), &format!("{}.v", module.name), &module.text));
    let (top, build) = (block.top(), folder.path().join("build"));
    let mut run = python("run_cocotb.py");
    run.env("POSICAST_ENCODER", built.to_string());
    let said = output(
        run.args([Path::new("bench_absolute"), Path::new(&top), &build])
            .args(files),
    );
    assert!(said.contains("1 tests, 0 failed"), "{said}");
    let (_, tally) = said.rsplit_once("tally ").unwrap();
    serde_json::from_str(tally.lines().next().unwrap()).unwrap()
}

/// Asserts that a run had at least this many of each.
fn has(tally: &Value, least: &[(&str, u64)]) {
    for (kind, least) in least {
        let count = tally[kind].as_u64().unwrap();
        assert!(count >= *least, "{kind}: {tally}");
    }
}

fn times(half_period_clocks: u64, pause_clocks: u64, answer_clocks: u64) -> AbsoluteTimes {
    AbsoluteTimes {
        half_period_clocks,
        pause_clocks,
        answer_clocks,
    }
}

/// 10 MHz, 26 bits, up to five bits of delay.
fn biss() -> AbsoluteEncoderConfig {
    let limits = AbsoluteLimits {
        largest_jump: 100_000,
        tolerated: 3,
    };
    let times = times(5, 150, 200);
    AbsoluteEncoderConfig::new(AbsoluteProtocol::BissC, AbsoluteFrame::biss_c(26), times, limits).unwrap()
}

/// 2 MHz, 25 bits in Gray code, with an error bit and parity.
fn ssi_gray() -> AbsoluteEncoderConfig {
    let frame = AbsoluteFrame {
        trailing_bits: 1,
        gray: true,
        check: FrameCheck::EvenParity,
        error: Some(FrameStatusBit {
            place: 0,
            active_low: false,
        }),
        ..AbsoluteFrame::ssi(25)
    };
    let limits = AbsoluteLimits {
        largest_jump: 5000,
        tolerated: 2,
    };
    AbsoluteEncoderConfig::new(AbsoluteProtocol::Ssi, frame, times(25, 1200, 0), limits).unwrap()
}

/// 13 bits in binary code between leading and trailing bits, odd parity; the count goes over many turns.
fn ssi_turn() -> AbsoluteEncoderConfig {
    let frame = AbsoluteFrame {
        leading_bits: 2,
        trailing_bits: 3,
        check: FrameCheck::OddParity,
        ..AbsoluteFrame::ssi(13)
    };
    let limits = AbsoluteLimits {
        largest_jump: 1000,
        tolerated: 3,
    };
    AbsoluteEncoderConfig::new(AbsoluteProtocol::Ssi, frame, times(10, 500, 0), limits).unwrap()
}

const FAULTS: [(&str, u64); 5] = [
    ("extrapolated", 20),
    ("check", 3),
    ("silent", 3),
    ("stuck", 3),
    ("jumped", 3),
];

#[test]
fn long_crosssim_absolute_encoder_counts_as_an_encoder_of_biss_c_moves() {
    let tally = tally(&biss(), 300, 1);
    has(&tally, &FAULTS);
    has(&tally, &[("good", 180), ("error", 4), ("delayed", 80)]);
}

#[test]
fn long_crosssim_absolute_encoder_counts_as_an_encoder_of_ssi_in_gray_code_moves() {
    let tally = tally(&ssi_gray(), 160, 2);
    has(&tally, &FAULTS[..1]);
    has(
        &tally,
        &[("good", 90), ("error", 1), ("check", 1), ("silent", 1), ("stuck", 1)],
    );
}

#[test]
fn crosssim_absolute_encoder_counts_turns_of_an_encoder_of_ssi() {
    let tally = tally(&ssi_turn(), 250, 3);
    has(&tally, &FAULTS);
    has(&tally, &[("good", 150)]);
}

#[test]
fn long_absolute_encoders_are_read_ten_thousand_times() {
    for (seed, config) in [(11, biss()), (12, ssi_gray()), (13, ssi_turn())] {
        let tally = tally(&config, 10_000, seed);
        has(&tally, &FAULTS);
        has(&tally, &[("lost", 5)]);
    }
}
