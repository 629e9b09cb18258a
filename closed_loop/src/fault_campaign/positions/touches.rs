//! The entries that a position capture must have for a recorded line, after `docs/capture.md`.

use super::counted::lasting_edges;

/// Number of entries that wait.
const ENTRIES: usize = 16;
/// Clocks from the first sample of a new level to the clock whose positions are taken, without the filter.
const LATENCY_CLOCKS: u64 = 2;

/// Settings of the capture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Touched {
    pub(super) filter_clocks: u64,
    /// Whether rising, and whether falling edges are wanted.
    pub(super) wanted: [bool; 2],
    /// Axis, and lowest and highest position.
    pub(super) window: Option<(usize, i64, i64)>,
}

/// A wanted edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Edge {
    /// Clock whose positions are taken.
    pub(super) clock: u64,
    pub(super) rising: bool,
}

/// The wanted edges of the line between two clocks.
pub(super) fn edges(of: &Touched, line: &[(u64, bool)], [from, end]: [u64; 2]) -> Vec<Edge> {
    let filter_clocks = of.filter_clocks.max(1);
    let edges = lasting_edges(line, filter_clocks, end).into_iter();
    let taken = edges.map(|(clock, rising)| Edge {
        clock: clock + filter_clocks + LATENCY_CLOCKS,
        rising,
    });
    let wanted = taken.filter(|edge| of.wanted[usize::from(!edge.rising)]);
    wanted.filter(|edge| (from..end).contains(&edge.clock)).collect()
}

/// The edges of which the entries wait if nothing is taken, and whether others were dropped, or outside the window.
pub(super) fn waiting(of: &Touched, edges: &[Edge], at: impl Fn(usize, u64) -> i64) -> (Vec<Edge>, bool, bool) {
    let inside = |edge: &&Edge| {
        of.window
            .is_none_or(|(axis, first, last)| (first..=last).contains(&at(axis, edge.clock)))
    };
    let offered: Vec<Edge> = edges.iter().filter(inside).copied().collect();
    let is_outside = offered.len() < edges.len();
    let waiting = offered[..offered.len().min(ENTRIES)].to_vec();
    let is_full = waiting.len() < offered.len();
    (waiting, is_full, is_outside)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_that_bounces_has_the_edge_of_its_last_contact() {
        let line = [(0, false), (50, true), (53, false), (55, true), (90, false)];
        let of = Touched {
            filter_clocks: 10,
            wanted: [true, false],
            window: None,
        };
        let edge = Edge {
            clock: 67,
            rising: true,
        };
        assert_eq!(edges(&of, &line, [0, 200]), [edge]);
        assert_eq!(edges(&of, &line, [68, 200]), []);
    }

    #[test]
    fn the_oldest_sixteen_wait() {
        let of = Touched {
            filter_clocks: 1,
            wanted: [true, true],
            window: Some((0, 0, 100)),
        };
        let all: Vec<Edge> = (0..20).map(|clock| Edge { clock, rising: true }).collect();
        let (waiting_now, is_full, is_outside) = waiting(&of, &all, |_, clock| clock as i64 - 2);
        assert_eq!((waiting_now.len(), waiting_now[0].clock), (16, 2));
        assert!(is_full && is_outside);
    }
}
