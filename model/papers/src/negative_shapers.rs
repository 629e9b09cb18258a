//! The shapers of "negative-hybrid", and the robot that they are designed for.

use super::designs::hybrid;
use posicast_machine::plant::{Plant, PlantMode};
use posicast_shaper::design::DesignError;
use posicast_shaper::design::kind::ShaperKind;
use posicast_shaper::impulse::ImpulseSequence;
use posicast_shaper::mode::Mode;

/// The two modes, by eq. (2) with undamped frequencies.
pub(super) const MODES: [Mode; 2] = [
    Mode {
        frequency_hz: 76.6,
        damping: 0.057,
    },
    Mode {
        frequency_hz: 231.2,
        damping: 0.017,
    },
];

pub(super) const NEGATIVE: [(&str, ShaperKind); 3] = [
    ("NZV", ShaperKind::PsZv),
    ("NZVD", ShaperKind::PsZvd),
    ("NEI", ShaperKind::PsEi),
];

/// The six pairs of different kinds: 0 is ZV, 1 is ZVD, 2 is EI.
pub(super) const PAIRS: [(usize, usize); 6] = [(0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1)];
/// The three pairs of one kind.
pub(super) const PLAIN: [(usize, usize); 3] = [(0, 0), (1, 1), (2, 2)];

/// Returns the negative hybrid of a pair, with its name.
pub(super) fn negative((first, second): (usize, usize)) -> Result<(String, ImpulseSequence), DesignError> {
    let name = format!("{}-{}", NEGATIVE[first].0, NEGATIVE[second].0);
    let shaper = hybrid(&[(NEGATIVE[first].1, MODES[0]), (NEGATIVE[second].1, MODES[1])])?;
    Ok((name, shaper))
}

/// Returns the positive hybrid of a pair, with its name.
pub(super) fn positive((first, second): (usize, usize)) -> Result<(String, ImpulseSequence), DesignError> {
    const POSITIVE: [(&str, ShaperKind); 3] =
        [("ZV", ShaperKind::Zv), ("ZVD", ShaperKind::Zvd), ("EI", ShaperKind::Ei)];
    let name = format!("{}-{}", POSITIVE[first].0, POSITIVE[second].0);
    let shaper = hybrid(&[(POSITIVE[first].1, MODES[0]), (POSITIVE[second].1, MODES[1])])?;
    Ok((name, shaper))
}

/// Returns the plant: both modes with equal shares.
pub(super) fn plant() -> Plant {
    Plant::of_shares(MODES.map(|mode| PlantMode { mode, share: 0.5 }).to_vec())
}
