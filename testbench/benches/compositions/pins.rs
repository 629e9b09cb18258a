//! Pins of a machine: an encoder that moves.

/// Returns A and B of an encoder with an edge every 300 clocks, which counts up for a hundred edges, then down.
pub(crate) fn encoder(clock: u64) -> [u64; 2] {
    let edge = clock / 300;
    let angle = if (edge / 100).is_multiple_of(2) {
        edge % 4
    } else {
        3 - edge % 4
    };
    [[0, 0], [1, 0], [1, 1], [0, 1]][angle as usize]
}
