//! Random settings of a case's compare and capture, and the clocks of its touches.

use rand::RngExt;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::passages::Row;
use super::touches::Touched;
use crate::fault_campaign::case::Case;
use crate::fault_campaign::kind::FaultKind;
use crate::fault_campaign::machine::{FILTER_CLOCKS, TICK_CLOCKS};

/// Counts by which the positions go beyond the move.
const BEYOND_COUNTS: i64 = 40;
/// Least distance of two positions of the list.
const LEAST_IN_LIST: i64 = 4;
/// Largest distance of two positions.
const MOST_APART: i64 = 12;
/// Longest pulse that is not meant to meet the next one.
const MOST_PULSE_CLOCKS: u64 = 200;
/// Longest pulse that is to be on when the row ends.
const LONG_PULSE_CLOCKS: u64 = 3000;
/// A filter with which the capture is as late as the count.
const MATCHING_FILTER: u64 = FILTER_CLOCKS + 2;
/// Ticks of a quick stop, about.
const STOP_TICKS: u64 = 70;

/// A row of positions over the whole move of an axis.
pub(super) fn row(rng: &mut Xoshiro256PlusPlus, case: &Case, axis: usize) -> Row {
    let kind = case.row.kind;
    let is_dense = matches!(kind, FaultKind::CompareGlitch | FaultKind::CompareFast);
    let ends = matches!(kind, FaultKind::CompareArmed | FaultKind::CompareDisarmed);
    let in_list = !is_dense && kind != FaultKind::CompareReversal && rng.random();
    let spacing = match kind {
        _ if is_dense => 1,
        FaultKind::CompareReversal | FaultKind::CompareOverlaps => rng.random_range(1..=3),
        _ => rng.random_range(1..=MOST_APART),
    };
    let target = case.counts[axis];
    let (mut at, last) = (target.min(0) - BEYOND_COUNTS, target.max(0) + BEYOND_COUNTS);
    let mut positions = Vec::new();
    while at <= last {
        positions.push(at);
        at += if in_list {
            rng.random_range(LEAST_IN_LIST..=MOST_APART)
        } else {
            spacing
        };
    }
    let wanted = match rng.random_range(0..4) {
        _ if is_dense || ends || kind == FaultKind::CompareOverlaps => [true, true],
        0 => [true, false],
        1 => [false, true],
        _ => [true, true],
    };
    Row {
        positions,
        in_list,
        spacing,
        wanted,
        hysteresis: match kind {
            _ if is_dense => 0,
            FaultKind::CompareReversal => rng.random_range(1..=4),
            _ => rng.random_range(0..=8),
        },
        pulse_clocks: match kind {
            _ if is_dense => 1,
            _ if ends => rng.random_range(1..=LONG_PULSE_CLOCKS),
            FaultKind::CompareOverlaps => rng.random_range(2 * TICK_CLOCKS..=8 * TICK_CLOCKS),
            _ => rng.random_range(1..=MOST_PULSE_CLOCKS),
        },
    }
}

/// Settings of the capture.
pub(super) fn touched(rng: &mut Xoshiro256PlusPlus, case: &Case) -> Touched {
    let any: u64 = rng.random_range(0..=20);
    let matches: bool = rng.random();
    let both = [true, true];
    let (filter_clocks, wanted) = match case.row.kind {
        FaultKind::ProbeBounces | FaultKind::ProbeShort => (MATCHING_FILTER, both),
        FaultKind::ProbeFull | FaultKind::ProbeTaken | FaultKind::ProbeWindow => (MATCHING_FILTER, both),
        _ => {
            let wanted = [[true, false], [false, true], both][rng.random_range(0..3)];
            (if matches { MATCHING_FILTER } else { any }, wanted)
        }
    };
    let window = (case.row.kind == FaultKind::ProbeWindow).then(|| {
        let axis = rng.random_range(0..2);
        let of = |part: i64| case.counts[axis] * part / 100;
        let [one, other] = [of(rng.random_range(0..60)), of(rng.random_range(20..100))];
        let is_empty = rng.random_range(0..4) == 0;
        let [first, last] = [one.min(other), one.max(other)];
        if is_empty {
            (axis, last + 1, first)
        } else {
            (axis, first, last)
        }
    });
    Touched {
        filter_clocks,
        wanted,
        window,
    }
}

/// Clocks in which the line changes, from `now` on; the fault is at about `fault`. It ends at its first level.
pub(super) fn changes(rng: &mut Xoshiro256PlusPlus, kind: FaultKind, now: u64, fault: u64) -> Vec<u64> {
    let mut found = Vec::new();
    let mut clock = fault.max(now) + 1;
    let mut after = |clocks: u64| {
        clock += clocks;
        found.push(clock);
    };
    match kind {
        FaultKind::ProbeStuck => {}
        FaultKind::ProbeBounces => {
            // 31 changes: the line ends at the other level.
            for _ in 0..2 {
                after(rng.random_range(MATCHING_FILTER..4000));
                (0..30).for_each(|_| after(rng.random_range(1..MATCHING_FILTER)));
            }
        }
        FaultKind::ProbeShort => {
            for _ in 0..20 {
                after(rng.random_range(MATCHING_FILTER..2000));
                after(rng.random_range(1..MATCHING_FILTER));
            }
        }
        FaultKind::ProbeFull => {
            let edges = 2 * rng.random_range(9..=20);
            (0..edges).for_each(|_| after(rng.random_range(MATCHING_FILTER..500)));
        }
        FaultKind::ProbeTaken => (0..30).for_each(|_| after(rng.random_range(400..1500))),
        FaultKind::ProbeWindow | FaultKind::ProbeCleared => {
            (0..12).for_each(|_| after(rng.random_range(500..8 * TICK_CLOCKS)));
        }
        _ => {
            let before = fault.saturating_sub(now) > 4 * TICK_CLOCKS;
            if before {
                found.extend((0..4).map(|_| rng.random_range(now + 1..fault)));
            }
            let at = fault + rng.random_range(0..8);
            found.extend([at, at + rng.random_range(30..2000)]);
            found.extend((0..6).map(|_| rng.random_range(fault..fault + STOP_TICKS * TICK_CLOCKS)));
        }
    }
    found.sort_unstable();
    found
}
