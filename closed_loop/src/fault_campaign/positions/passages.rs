//! The pulses that a position compare must give for a recorded count, after `docs/compare.md`.

/// Clocks from the count to the pulse.
const LATENCY_CLOCKS: u64 = 2;

/// Settings that are armed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Row {
    /// The positions, in increasing order.
    pub(super) positions: Vec<i64>,
    /// Whether they are written to the list.
    pub(super) in_list: bool,
    /// Distance of two positions of a row in counts.
    pub(super) spacing: i64,
    /// Whether a passage upward, or downward, gives a pulse.
    pub(super) wanted: [bool; 2],
    pub(super) hysteresis: i64,
    pub(super) pulse_clocks: u64,
}

/// The count while a row is armed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct While {
    /// Clocks in which the count must change for a passage: the first, and the one after the last.
    pub(super) clocks: [u64; 2],
}

/// A passage that gives a pulse.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Passage {
    /// First clock of the pulse.
    pub(super) clock: u64,
    pub(super) pulse_clocks: u64,
}

/// The passages of an armed row.
pub(super) fn of_row(row: &Row, armed: While, counts: &[(u64, i64)]) -> Vec<Passage> {
    let mut found = Vec::new();
    // The position of the last pulse, and whether the count has been far enough from its edge since.
    let mut last: Option<(i64, bool)> = None;
    for pair in counts.windows(2) {
        let [(_, before), (clock, now)] = [pair[0], pair[1]];
        if !(armed.clocks[0]..armed.clocks[1]).contains(&clock) {
            continue;
        }
        if let Some((position, away)) = &mut last {
            let distance = (now - *position).max(*position - 1 - now);
            *away |= distance >= row.hysteresis;
        }
        let [is_up, position] = [i64::from(now > before), now.max(before)];
        let wanted = row.wanted[usize::from(is_up == 0)];
        let again = last.is_none_or(|(last, away)| last != position || away);
        if wanted && again && row.positions.binary_search(&position).is_ok() {
            last = Some((position, row.hysteresis == 0));
            found.push(Passage {
                clock: clock + LATENCY_CLOCKS,
                pulse_clocks: row.pulse_clocks,
            });
        }
    }
    found
}

/// The intervals in which the line is high, from the first clock to the one after the last, before `end`; and whether a
/// passage lengthened a pulse.
pub(super) fn pulses(passages: &[Passage], end: u64) -> (Vec<[u64; 2]>, bool) {
    let mut high: Vec<[u64; 2]> = Vec::new();
    let mut merged = false;
    for passage in passages.iter().filter(|passage| passage.clock < end) {
        let until = passage.clock + passage.pulse_clocks;
        match high.last_mut() {
            Some(last) if passage.clock <= last[1] => {
                merged = true;
                last[1] = until;
            }
            _ => high.push([passage.clock, until]),
        }
    }
    if let Some(last) = high.last_mut() {
        last[1] = last[1].min(end);
    }
    (high, merged)
}

/// The intervals in which a recorded line is high.
pub(super) fn high(line: &[(u64, bool)], end: u64) -> Vec<[u64; 2]> {
    let until = |at: usize| line.get(at + 1).map_or(end, |next| next.0);
    let changes = line.iter().enumerate().filter(|(_, change)| change.1);
    changes.map(|(at, change)| [change.0, until(at)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(hysteresis: i64) -> Row {
        Row {
            positions: vec![3, 5],
            in_list: false,
            spacing: 2,
            wanted: [true, true],
            hysteresis,
            pulse_clocks: 4,
        }
    }

    fn clocks(row: &Row, counts: &[i64]) -> Vec<u64> {
        let counts: Vec<_> = (0..).step_by(10).zip(counts.iter().copied()).collect();
        let armed = While { clocks: [0, u64::MAX] };
        of_row(row, armed, &counts)
            .iter()
            .map(|passage| passage.clock)
            .collect()
    }

    #[test]
    fn a_position_is_the_edge_below_its_count() {
        assert_eq!(clocks(&row(0), &[2, 3, 4, 5, 4, 3, 2]), [12, 32, 42, 62]);
        let upward = Row {
            wanted: [true, false],
            ..row(0)
        };
        assert_eq!(clocks(&upward, &[2, 3, 4, 5, 4, 3, 2]), [12, 32]);
    }

    #[test]
    fn a_position_needs_distance_or_another_one() {
        assert_eq!(clocks(&row(0), &[2, 3, 2, 3]), [12, 22, 32]);
        assert_eq!(clocks(&row(1), &[2, 3, 2, 3, 4, 3, 2]), [12, 62]);
        assert_eq!(clocks(&row(2), &[2, 3, 4, 3, 2, 1, 0, 1, 2, 3]), [12, 92]);
        assert_eq!(clocks(&row(9), &[2, 3, 4, 5, 4, 3, 2]), [12, 32, 62]);
    }

    #[test]
    fn a_passage_during_a_pulse_makes_it_longer() {
        let at = |clock| Passage {
            clock,
            pulse_clocks: 10,
        };
        assert_eq!(pulses(&[at(5), at(12), at(30)], 100), (vec![[5, 22], [30, 40]], true));
        assert_eq!(pulses(&[at(5), at(15)], 100), (vec![[5, 25]], true));
        assert_eq!(pulses(&[at(5), at(16)], 20), (vec![[5, 15], [16, 20]], false));
    }
}
