//! Makes a uniform time grid of the times of the rows.

use super::columns::Table;
use super::{LogError, Remark};
use std::ops::Range;

/// A step longer than this many samples is a gap.
const GAP: f64 = 1.5;
/// Samples that deviate by less than this, in samples, are kept where they are.
const REGULAR: f64 = 0.1;

/// Root mean square of the steps' deviations from their mean, in samples, beyond which it is not known what a command
/// was between two rows.
const WAVERING: f64 = 0.1;

/// The rows that are used, and their position on a uniform grid.
pub(super) struct Grid {
    pub(super) sample_s: f64,
    /// Root mean square of the deviations of the steps between rows from their mean, in samples, and the line with the
    /// largest one.
    wavers: (f64, u64),
    range: Range<usize>,
    /// For irregular rows: for each sample of the grid the row before it, and the fraction of the way to the next
    /// row.
    between: Option<Vec<(usize, f64)>>,
}

impl Grid {
    /// The rows that are used.
    pub(super) fn range(&self) -> Range<usize> {
        self.range.clone()
    }

    /// The deviation of the steps in samples and the line with the largest one, if they are too irregular for a command
    /// that is held between two rows.
    pub(super) fn wavers(&self) -> Option<(f64, u64)> {
        Some(self.wavers).filter(|(deviation, _)| *deviation > WAVERING)
    }

    /// Interpolates values of all rows to the grid.
    pub(super) fn of(&self, values: &[f64]) -> Vec<f64> {
        let values = &values[self.range.clone()];
        match &self.between {
            None => values.to_vec(),
            Some(places) => places
                .iter()
                .map(|&(row, part)| values[row] + part * (values[(row + 1).min(values.len() - 1)] - values[row]))
                .collect(),
        }
    }
}

/// The grid of a log; defects that were mended are added to `remarks`.
pub(super) fn grid(table: &Table, remarks: &mut Vec<Remark>) -> Result<Grid, LogError> {
    let times = &table.times_s;
    for row in 1..times.len() {
        if times[row] <= times[row - 1] {
            return Err(LogError::Unsorted {
                line: table.lines[row],
                time_s: times[row],
                before_s: times[row - 1],
            });
        }
    }
    let range = without_gaps(table, remarks);
    let used = &times[range.clone()];
    let sample_s = (used[used.len() - 1] - used[0]) / (used.len() - 1) as f64;
    let steps = used.windows(2).map(|pair| (pair[1] - pair[0]) / sample_s - 1.0);
    let square: f64 = steps.clone().map(|off| off * off).sum();
    let largest = steps.enumerate().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    let wavers = (
        (square / (used.len() - 1) as f64).sqrt(),
        table.lines[range.start + largest.map_or(0, |(row, _)| row + 1)],
    );
    let off = |row: usize| (used[row] - used[0]) / sample_s - row as f64;
    let worst = (0..used.len())
        .max_by(|a, b| off(*a).abs().total_cmp(&off(*b).abs()))
        .unwrap_or(0);
    if off(worst).abs() <= REGULAR {
        return Ok(Grid {
            sample_s,
            wavers,
            range,
            between: None,
        });
    }
    remarks.push(Remark::Irregular {
        line: table.lines[range.start + worst],
        worst: off(worst).abs(),
        rate_hz: 1.0 / sample_s,
    });
    let mut row = 0;
    let between = (0..used.len()).map(|n| {
        let at = used[0] + n as f64 * sample_s;
        while row + 2 < used.len() && used[row + 1] <= at {
            row += 1;
        }
        (row, ((at - used[row]) / (used[row + 1] - used[row])).clamp(0.0, 1.0))
    });
    Ok(Grid {
        sample_s,
        wavers,
        between: Some(between.collect()),
        range,
    })
}

/// The longest part without a gap.
fn without_gaps(table: &Table, remarks: &mut Vec<Remark>) -> Range<usize> {
    let times = &table.times_s;
    let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let middle = steps.len() / 2;
    let (_, usual, _) = steps.select_nth_unstable_by(middle, f64::total_cmp);
    let usual = *usual;
    let gaps: Vec<usize> = (1..times.len())
        .filter(|&row| times[row] - times[row - 1] > GAP * usual)
        .collect();
    // Gaps in a large part of the steps are not gaps: the whole log is irregular.
    if gaps.is_empty() || gaps.len() > times.len() / 20 {
        return 0..times.len();
    }
    let ends: Vec<usize> = gaps.iter().copied().chain([times.len()]).collect();
    let mut begin = 0;
    let mut longest = 0..0;
    for end in ends {
        if end - begin > longest.len() {
            longest = begin..end;
        }
        begin = end;
    }
    remarks.push(Remark::Gap {
        line: table.lines[gaps[0] - 1],
        gap_s: times[gaps[0]] - times[gaps[0] - 1],
        from: table.lines[longest.start],
        to: table.lines[longest.end - 1],
        kept: longest.len(),
    });
    longest
}
