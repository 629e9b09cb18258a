//! The input shaper: `y[n] = sat( (Σ c_i · x[n − d_i] + 2^(F−1)) >> F )`, one tap per clock through one multiplier.

use crate::taps::TapTable;

/// Word widths that the shaper is built for (16 for the stand-alone shaper).
pub const WORD_BITS: [u32; 3] = [16, 24, 32];
/// Ring sizes that the shaper is built for, as bits of address: 2^6 … 2^12 and 2^14 samples.
pub const RING_ADDRESS_BITS: [u32; 8] = [6, 7, 8, 9, 10, 11, 12, 14];
/// Table sizes that the shaper is built for, as bits of index: 16, 64 and 256 taps.
pub const TAP_INDEX_BITS: [u32; 3] = [4, 6, 8];

/// What is fixed when a shaper is built: sizes from the lists above, and the table in its ROM (bank 0).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ShaperConfig {
    word_bits: u32,
    ring_address_bits: u32,
    tap_index_bits: u32,
    table: TapTable,
}
