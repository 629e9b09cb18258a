//! The sizes that the tests compare, faults in the Verilog that the stimuli find, and faults with which its proofs fail.

use posicast_blocks::cascade::CascadeConfig;

use super::CascadeBlock;
use crate::Error;
use crate::blocks::{BlockMutant, ProofMutant, Trial};
use crate::formal::refused;

pub(super) fn all() -> Result<Vec<Trial>, Error> {
    let of = |word_bits, delays: &[u32]| -> Result<CascadeBlock, Error> {
        let config = CascadeConfig::new(word_bits, delays.to_vec()).map_err(refused)?;
        Ok(CascadeBlock::new(config, ""))
    };
    let longest: Vec<u32> = (1..=16).map(|stage| 7 * stage).collect();
    Ok(vec![
        Trial::new(of(32, &[38, 31, 26, 62])?, &[1], 11).size("4 stages"),
        Trial::new(of(16, &[1])?, &[1], 11).size("1 stage"),
        Trial::new(of(32, &[38, 31, 26, 62, 1])?, &[2], 11).size("5 stages"),
        Trial::new(of(24, &longest)?, &[3], 11).size("16 stages"),
    ])
}

pub(super) const MUTANTS: &[BlockMutant] = &[
    BlockMutant::new("a history that ages a sample late", ">= age", "> age").of("4 stages"),
    BlockMutant::new("rounding down", "HALF = 36'sd8", "HALF = 36'sd7").of("4 stages"),
];

pub(super) const PROOF_MUTANTS: &[ProofMutant] = &[
    ProofMutant::new(
        "halves that are dropped",
        "assign rounded = sum + HALF",
        "assign rounded = sum",
    )
    .violates("result"),
    ProofMutant::new(
        "a sample from before the start",
        "delays_data >= age",
        "delays_data > age",
    )
    .violates("before_known"),
];
