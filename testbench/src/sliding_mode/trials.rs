//! The sizes that the tests compare, faults in the Verilog that the stimuli find, and faults with which its proofs fail.

use super::SlidingModeBlock;
use crate::Error;
use crate::blocks::{BlockMutant, ProofMutant, Trial};

pub(super) fn all() -> Result<Vec<Trial>, Error> {
    Ok(vec![Trial::new(SlidingModeBlock::new("", "alone"), &[1, 2], 1)])
}

pub(super) const MUTANTS: &[BlockMutant] = &[
    BlockMutant::new(
        "an upper end of the terms that is an lsb too low",
        "LARGEST = 24'sd8388607",
        "LARGEST = 24'sd8388606",
    )
    .within(750_000),
    BlockMutant::new(
        "an upper end of a word that is an lsb too low",
        "LARGEST_WORD = 32'd2147483647",
        "LARGEST_WORD = 32'd2147483646",
    )
    .within(750_000),
    BlockMutant::new(
        "an upper end of a fraction that is an lsb too low",
        "LARGEST_FRACTION = 32'd33554431",
        "LARGEST_FRACTION = 32'd33554430",
    )
    .within(750_000),
    BlockMutant::new(
        "an upper end of the duty that is an lsb too low",
        "LARGEST_DUTY = 32'd131071",
        "LARGEST_DUTY = 32'd131070",
    )
    .within(750_000),
    BlockMutant::new(
        "a lower end of the terms that is an lsb too high",
        "LEAST = 24'sh800000",
        "LEAST = 24'sh800001",
    )
    .within(750_000),
    BlockMutant::new(
        "a lower end that is an lsb too high",
        "$signed(~largest)",
        "$signed(~largest + 32'd1)",
    )
    .within(750_000),
    BlockMutant::new(
        "a lower end of the duty that is that of another word",
        "as_fraction | as_duty",
        "as_fraction",
    )
    .within(750_000),
    BlockMutant::new("an integral of twice the error", "EIGHT = 5'd8", "EIGHT = 5'd7").within(1_000_000),
    BlockMutant::new(
        "an integral that winds up at the upper limit",
        "enable & !cleared & !limited_high",
        "enable & !cleared",
    )
    .within(750_000),
    BlockMutant::new(
        "an integral that winds up at the lower limit",
        "enable & !cleared & !limited_low",
        "enable & !cleared",
    )
    .within(750_000),
    BlockMutant::new(
        "an integral that winds up against the sign of its gain",
        "opposes ^ setting[17]",
        "opposes",
    )
    .within(750_000),
    BlockMutant::new(
        "flags that a clear swallows",
        "flags_q <= kept | by_error | by_sum",
        "flags_q <= clear_flags ? 7'd0 : kept | by_error | by_sum",
    )
    .within(750_000),
    BlockMutant::new(
        "products that are cut instead of rounded",
        "HALF = 53'd1",
        "HALF = 53'd0",
    )
    .within(750_000),
    BlockMutant::new(
        "a limit that is passed by an lsb",
        "({2'd0, limit} << 1)",
        "(({2'd0, limit} << 1) + 33'd2)",
    )
    .within(750_000),
    BlockMutant::new("a limit whose borrow is lost", "| borrow)", ")").within(750_000),
    BlockMutant::new(
        "a rotary axis that does not wrap",
        "difference[31] & modulo",
        "difference[39] & modulo",
    )
    .within(750_000),
    BlockMutant::new(
        "a clear that a sum under way undoes",
        "cleared_next = 1'd1",
        "cleared_next = cleared",
    )
    .within(3_000_000),
];

pub(super) const PROOF_MUTANTS: &[ProofMutant] = &[
    ProofMutant::new(
        "a sum that goes on from the last one",
        "begins_sum = (sequencer_step == OF_REFERENCE)",
        "begins_sum = (sequencer_step == COULOMB)",
    )
    .violates("begins_anew"),
    ProofMutant::new(
        "a shift that loses the sign",
        "by_one = $signed(shifter[50:1])",
        "by_one = $signed({1'b0, shifter[49:1]})",
    )
    .of("scaled_product")
    .violates("half_up"),
    ProofMutant::new(
        "a product that is cut instead of rounded",
        "HALF = 53'd1",
        "HALF = 53'd0",
    )
    .of("accumulator")
    .violates("exact_sum"),
    ProofMutant::new("a limit that is passed by an LSB", "borrow = 33'd1", "borrow = 33'd0")
        .of("limiter")
        .violates("known_over"),
];
