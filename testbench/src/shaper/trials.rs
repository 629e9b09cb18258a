//! The sizes that the tests compare, faults in the Verilog that the stimuli find, and faults with which its proofs fail.

use posicast_blocks::shaper::{ShaperConfig, ShaperMotion};
use posicast_taps::TapTable;

use super::{ShaperBlock, tap_table};
use crate::Error;
use crate::blocks::{BlockMutant, ProofMutant, Trial};
use crate::formal::refused;

/// Cases that a million clocks reach often.
const OFTEN: &[&str] = &["swaps", "saturated", "handovers", "handovers over"];

/// A ZVD shaper like that of the XY stage: three impulses with two taps each. The first tap takes what rounding leaves.
fn zvd(fraction: u32) -> Result<TapTable, Error> {
    let taps = [(0, 388), (38, 280), (39, 190), (77, 100), (78, 42)];
    let mut taps = taps.map(|(delay_samples, permille)| (delay_samples, permille * (1 << fraction) / 1000));
    taps[0].1 += (1 << fraction) - taps.iter().map(|(_, coefficient)| coefficient).sum::<i32>();
    tap_table(fraction, &taps)
}

/// Taps of negative impulses, whose output swings beyond full scale.
fn negative(fraction: u32) -> Result<TapTable, Error> {
    let one = 1 << fraction;
    tap_table(fraction, &[(0, one), (7, -2 * one), (15, 2 * one)])
}

fn plain(word_bits: u32, table: TapTable, delay: u32, taps: usize) -> Result<ShaperConfig, Error> {
    let config = ShaperConfig::new(word_bits, table).map_err(refused)?;
    config.with_room_for(delay, taps).map_err(refused)
}

fn motion(config: ShaperConfig, channels: u32, modulo: bool) -> Result<ShaperConfig, Error> {
    config.for_motion(ShaperMotion { channels, modulo }).map_err(refused)
}

pub(super) fn all() -> Result<Vec<Trial>, Error> {
    let standard = plain(32, zvd(16)?, 0, 0)?;
    let sizes = [
        ("32 bits", &[1][..], standard.clone()),
        ("16 bits, negative taps", &[2], plain(16, negative(15)?, 0, 0)?),
        ("24 bits, 256 taps", &[3], plain(24, zvd(12)?, 500, 256)?),
        ("longest ring", &[4], plain(32, negative(1)?, 16_000, 64)?),
        ("one channel", &[11], motion(plain(24, negative(15)?, 0, 0)?, 1, false)?),
        ("three channels", &[12], motion(standard, 3, false)?),
        ("rotary axis", &[13], motion(plain(32, negative(15)?, 0, 0)?, 1, true)?),
        (
            "rotary axis with velocity",
            &[14],
            motion(plain(24, negative(14)?, 0, 0)?, 2, true)?,
        ),
    ];
    let trial = |(size, seeds, config)| {
        let block = ShaperBlock::new(config, "", "alone")?;
        Ok(Trial::new(block, seeds, 1).size(size).often(OFTEN))
    };
    sizes.into_iter().map(trial).collect()
}

pub(super) const MUTANTS: &[BlockMutant] = &[
    BlockMutant::new(
        "a broken multiplier bit",
        "product <= a_q * b_q;",
        "product <= (a_q * b_q) ^ 50'sd1048576;",
    ),
    BlockMutant::new(
        "a broken address bit",
        "address = head - delay;",
        "address = (head - delay) & 7'h7e;",
    ),
    BlockMutant::new("a history that ages a sample late", "delay > age", "delay >= age"),
    BlockMutant::new(
        "a handover that sees a delay too early",
        "tap_delay < since_q",
        "tap_delay <= since_q",
    )
    .of("three channels"),
    BlockMutant::new(
        "a handover that ends a sample early",
        "since_q == reach",
        "next_since == reach",
    )
    .of("three channels"),
    BlockMutant::new("a rest that is a sample too short", "still >= reach", "still > reach").of("three channels"),
    BlockMutant::new(
        "a read-back from the other bank",
        "read_address = write_address;",
        "read_address = write_address ^ 7'd64;",
    ),
    BlockMutant::new(
        "a read-back of a tap that is not loaded",
        "(index < host_taps)",
        "(index <= host_taps)",
    ),
    BlockMutant::new("a read-back in a pass", "& !busy", "").of("three channels"),
    BlockMutant::new("a read-back at the same time as a write", "& !tap_write", "").of("three channels"),
];

pub(super) const PROOF_MUTANTS: &[ProofMutant] = &[
    ProofMutant::new(
        "a product that is subtracted",
        "accumulator + wide_product",
        "accumulator - wide_product",
    )
    .violates("sum_adds"),
    ProofMutant::new(
        "a pass that ends a tap early",
        "tap_number = {1'd0, tap} + 7'd1",
        "tap_number = {1'd0, tap} + 7'd2",
    )
    .violates("pass_"),
    ProofMutant::new("a sample of the wrong side", "= head - delay", "= head + delay").violates("address"),
    ProofMutant::new(
        "a swap to a bank that does not sum to one",
        "(swap_bank == 2'd1) & (sum_1 == UNITY)",
        "(swap_bank == 2'd1)",
    )
    .violates("table_to_come"),
    ProofMutant::new(
        "a result clamped to the wrong end",
        "y_q_next = Y_MAX",
        "y_q_next = Y_MIN",
    )
    .violates("result"),
    ProofMutant::new(
        "a result that is cut instead of rounded",
        "HALF = 26'sd8",
        "HALF = 26'sd0",
    )
    .of("shaper_small")
    .violates("total"),
    ProofMutant::new("a sample that is an older one", "delay > age", "delay >= age")
        .of("shaper_small")
        .violates("stage_coefficient"),
    ProofMutant::new("a tap that is read back in a pass", "& !busy", "")
        .of("shaper_small")
        .violates("read_"),
    ProofMutant::new(
        "a tap of the other bank",
        "read_address = write_address;",
        "read_address = write_address ^ 3'd4;",
    )
    .of("shaper_small")
    .violates("read_word"),
    ProofMutant::new(
        "an increment that goes through both tables",
        "(old_tap == below)",
        "(old_tap & below)",
    )
    .of("shaper_motion")
    .violates("made_"),
    ProofMutant::new(
        "a handover that ends a sample early",
        "since_q == reach",
        "next_since == reach",
    )
    .of("shaper_motion")
    .violates("handover_"),
    ProofMutant::new("a swap that does not wait", "(still >= reach)", "(still >= 6'd1)")
        .of("shaper_motion")
        .violates("swap_takes"),
    ProofMutant::new(
        "a channel that gets the sample of another",
        "if (lasts[4])",
        "if (lasts[5])",
    )
    .of("shaper_motion")
    .violates("pass_sample"),
    ProofMutant::new("a position that clamps where it should wrap", "& !wraps", "")
        .of("channel_sums")
        .violates("result"),
    ProofMutant::new(
        "a product lost between channels",
        "if (busy_q) begin",
        "if (busy_q & (channel != FIRST_CHANNEL)) begin",
    )
    .of("channel_sums")
    .violates("sum_adds"),
];
