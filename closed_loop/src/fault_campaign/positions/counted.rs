//! Counts from the recorded lines of an encoder or of a drive with steps, after `docs/pulse_counter.md`.
//!
//! Whole records are computed at once, from the lengths of their levels; there is no state per clock as in the block.

use crate::stage_bench::PinChange;

/// Clocks from an edge at an encoder's pin to the count, without the filter.
const COUNT_CLOCKS: u64 = 4;

/// The changes of one recorded pin; the first is its level at the start.
pub(super) fn pin(changes: &[PinChange], bit: usize) -> Vec<(u64, bool)> {
    let mut found: Vec<(u64, bool)> = Vec::new();
    for change in changes {
        let level = change.levels >> bit & 1 != 0;
        if found.last().is_none_or(|last| last.1 != level) {
            found.push((change.clock, level));
        }
    }
    found
}

/// The edges that remain of a line if a level must last for so many clocks: the clock at the pin and the new level. `end` is
/// the first clock that is not recorded.
pub(super) fn lasting_edges(line: &[(u64, bool)], least_clocks: u64, end: u64) -> Vec<(u64, bool)> {
    let mut level = line.first().is_some_and(|first| first.1);
    let mut edges = Vec::new();
    for (at, (clock, now)) in line.iter().enumerate() {
        let until = line.get(at + 1).map_or(end, |next| next.0);
        if *now != level && until - clock >= least_clocks {
            level = *now;
            edges.push((*clock, level));
        }
    }
    edges
}

/// The count of a quadrature encoder with a filter that ignores pulses of up to `filter_clocks`: the clock from which on the
/// counter shows it, and the count. It begins with 0.
pub(super) fn of_quadrature(lines: [Vec<(u64, bool)>; 2], filter_clocks: u64, end: u64) -> Vec<(u64, i64)> {
    let initial = [0, 1].map(|line: usize| lines[line].first().is_some_and(|first| first.1));
    let mut edges: Vec<(u64, usize, bool)> = Vec::new();
    for (line, changes) in lines.iter().enumerate() {
        let lasting = lasting_edges(changes, filter_clocks + 1, end);
        edges.extend(lasting.into_iter().map(|(clock, level)| (clock, line, level)));
    }
    edges.sort_unstable();
    let (mut levels, mut counts) = (initial, vec![(0, 0)]);
    for together in edges.chunk_by(|one, other| one.0 == other.0) {
        let before = phase(levels);
        for (_, line, level) in together {
            levels[*line] = *level;
        }
        // Both lines at once are two phases on, and no step.
        let step = match (phase(levels) + 4 - before) % 4 {
            1 => 1,
            3 => -1,
            _ => continue,
        };
        let count = counts.last().map_or(0, |last| last.1);
        counts.push((together[0].0 + filter_clocks + COUNT_CLOCKS, count + step));
    }
    counts
}

/// Place in the cycle of A and B; upward, A leads.
fn phase(levels: [bool; 2]) -> u32 {
    match levels {
        [false, false] => 0,
        [true, false] => 1,
        [true, true] => 2,
        [false, true] => 3,
    }
}

/// The count of steps and directions: the stage reads its own lines with a pulse counter, without a filter.
pub(super) fn of_steps(step: &[(u64, bool)], direction: &[(u64, bool)]) -> Vec<(u64, i64)> {
    let mut counts = vec![(0, 0)];
    for (clock, _) in step.iter().skip(1).filter(|(_, level)| *level) {
        let known = direction.partition_point(|change| change.0 <= *clock);
        let is_up = known > 0 && direction[known - 1].1;
        let count = counts.last().map_or(0, |last| last.1);
        counts.push((*clock + COUNT_CLOCKS, count + if is_up { 1 } else { -1 }));
    }
    counts
}

/// The count in a clock.
pub(super) fn at(counts: &[(u64, i64)], clock: u64) -> i64 {
    let known = counts.partition_point(|change| change.0 <= clock);
    counts[..known].last().map_or(0, |last| last.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_must_last() {
        let line = [(0, false), (10, true), (13, false), (20, true), (24, false)];
        assert_eq!(lasting_edges(&line, 4, 100), [(20, true), (24, false)]);
        assert_eq!(lasting_edges(&line, 5, 100), []);
        assert_eq!(lasting_edges(&line[..4], 4, 22), []);
    }

    #[test]
    fn quadrature_counts_edges_and_not_two_at_once() {
        let a = vec![(0, false), (100, true), (300, false), (400, true)];
        let b = vec![(0, false), (200, true), (250, false), (252, true), (400, false)];
        let counts = of_quadrature([a, b], 8, 1000);
        assert_eq!(counts, [(0, 0), (112, 1), (212, 2), (312, 3)]);
        assert_eq!([at(&counts, 111), at(&counts, 112), at(&counts, 999)], [0, 1, 3]);
    }

    #[test]
    fn steps_count_in_their_direction() {
        let step = [(0, false), (10, true), (12, false), (20, true), (22, false)];
        assert_eq!(of_steps(&step, &[(0, true), (15, false)]), [(0, 0), (14, 1), (24, 0)]);
    }
}
