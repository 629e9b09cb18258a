//! Counts M4K blocks, the block memory of Cyclone II, by the shape of their ports and not by their bits.

/// Words and bits per word of a block with one port to read and one to write. (Cyclone II Device Handbook, "M4K Memory".)
const SHAPES: [(u64, u64); 6] = [(128, 36), (256, 18), (512, 9), (1024, 4), (2048, 2), (4096, 1)];

/// Returns the smallest number of blocks that hold this many words of this many bits.
pub(super) fn blocks(words: u64, bits: u64) -> u64 {
    let of = |(deep, wide): (u64, u64)| words.div_ceil(deep).saturating_mul(bits.div_ceil(wide));
    SHAPES.map(of).into_iter().min().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_number_of_m4k_blocks_follows_from_the_shape() {
        // These were counted by hand in the datasheets of shaper and cascade.
        let counted = [
            (128, 32, 1),
            (256, 32, 2),
            (4096, 32, 32),
            (1024, 48, 12),
            (8192, 40, 80),
            (64, 25, 1),
            (512, 25, 3),
        ];
        for (words, bits, expected) in counted {
            assert_eq!(blocks(words, bits), expected, "{words} × {bits}");
        }
        assert_eq!(blocks(0, 8), 0);
        assert_eq!(blocks(u64::MAX, u64::MAX), u64::MAX);
    }
}
