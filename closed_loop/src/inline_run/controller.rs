//! A controller that gives step pulses: every step comes when the planned position passes the middle between two steps, in whole clocks,
//! as an ideal step generator gives it.

use posicast_blocks::step_generator::StepMode;

/// A line of an axis that changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Edge {
    /// The clock from which on the line has its new level, from the begin of the move.
    pub(super) clock: u64,
    /// 0 for the first line of the axis, 1 for the second one.
    pub(super) line: usize,
    /// Whether the line is on, whatever its polarity.
    pub(super) on: bool,
}

/// The lines of an axis whose position is `positions` steps after each tick, and 0 before: all their edges, in order of time. All lines
/// are off at first. A pulse lasts `pulse_clocks`; a direction changes half-way between the pulses round it.
pub(super) fn edges(positions: &[f64], tick_clocks: u64, mode: StepMode, pulse_clocks: u64) -> Vec<Edge> {
    let mut edges = Vec::new();
    let mut at = 0_i64;
    let mut direction = None;
    let mut free_from = 0;
    for (clock, up) in steps(positions, tick_clocks) {
        at += if up { 1 } else { -1 };
        let end = clock + pulse_clocks;
        let mut turns = |clock, line, on| edges.push(Edge { clock, line, on });
        match mode {
            StepMode::UpDown => {
                turns(clock, usize::from(!up), true);
                turns(end, usize::from(!up), false);
            }
            StepMode::StepDirection => {
                if direction != Some(up) {
                    turns((free_from + clock) / 2, 1, up);
                    direction = Some(up);
                }
                turns(clock, 0, true);
                turns(end, 0, false);
            }
            StepMode::Quadrature => {
                // The first line leads: it is on at 1 and 2 of 4 steps, the second one at 2 and 3.
                let phase = at.rem_euclid(4);
                turns(clock, 0, matches!(phase, 1 | 2));
                turns(clock, 1, matches!(phase, 2 | 3));
            }
        }
        free_from = end;
    }
    edges.sort_by_key(|edge| edge.clock);
    edges
}

/// The clocks of the steps, and whether they go up, of a position that is linear between ticks.
fn steps(positions: &[f64], tick_clocks: u64) -> Vec<(u64, bool)> {
    let mut steps = Vec::new();
    let (mut before, mut at) = (0.0, 0_i64);
    for (tick, &position) in positions.iter().enumerate() {
        let up = position > before;
        let side = if up { 0.5 } else { -0.5 };
        while (position - (at as f64 + side)) * side >= 0.0 && position != before {
            let part = (at as f64 + side - before) / (position - before);
            steps.push((((tick as f64 + part.clamp(0.0, 1.0)) * tick_clocks as f64) as u64, up));
            at += if up { 1 } else { -1 };
        }
        before = position;
    }
    steps
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two steps up in the first tick, one more and one back in the next ones.
    const POSITIONS: [f64; 3] = [2.0, 2.75, 2.25];

    fn shown(mode: StepMode) -> Vec<(u64, usize, bool)> {
        let edges = edges(&POSITIONS, 1000, mode, 100).into_iter();
        edges.map(|edge| (edge.clock, edge.line, edge.on)).collect()
    }

    #[test]
    fn steps_come_at_the_middles() {
        assert_eq!(
            steps(&POSITIONS, 1000),
            [(250, true), (750, true), (1666, true), (2500, false)]
        );
    }

    #[test]
    fn a_direction_changes_between_the_pulses() {
        let direction: Vec<_> = shown(StepMode::StepDirection)
            .into_iter()
            .filter(|edge| edge.1 == 1)
            .collect();
        assert_eq!(direction, [(125, 1, true), ((1766 + 2500) / 2, 1, false)]);
        let down: Vec<_> = shown(StepMode::UpDown).into_iter().filter(|edge| edge.1 == 1).collect();
        assert_eq!(down, [(2500, 1, true), (2600, 1, false)]);
    }

    #[test]
    fn the_first_line_of_quadrature_leads() {
        let levels = |clock: u64| {
            let edges = edges(&POSITIONS, 1000, StepMode::Quadrature, 100).into_iter();
            edges
                .filter(|edge| edge.clock <= clock)
                .fold([false; 2], |mut lines, edge| {
                    lines[edge.line] = edge.on;
                    lines
                })
        };
        let times = [0, 250, 750, 1666, 2500];
        assert_eq!(
            times.map(levels),
            [[false, false], [true, false], [true, true], [false, true], [true, true]]
        );
    }
}
