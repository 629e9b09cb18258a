//! Makes a uniform time grid from the times of the rows, even if rows are missing.

use super::columns::Table;
use super::{LogError, Remark};
use std::ops::Range;

/// A step counts as off if it is further than this from a whole number of samples.
const OFF: f64 = 0.25;
/// Fraction of steps off the grid above which the times count as irregular, not as regular with missing rows.
const IRREGULAR: f64 = 0.05;
/// Steps longer than this many samples are gaps of an irregular log.
const GAP_OF_IRREGULAR: f64 = 3.0;
/// Fraction of long steps above which times that keep to a uniform grid were only rounded, and have no gaps.
const ROUNDED: f64 = 0.005;
/// Samples that deviate by less than this, in samples, are kept where they are.
const REGULAR: f64 = 0.1;
/// Number of missing rows for each row, above which only the longest part without a gap is used.
const MOST_MISSING: f64 = 3.0;

/// Root mean square of the steps' deviations from their mean, in samples, above which the command between two rows is
/// unknown.
const WAVERING: f64 = 0.1;

/// The rows that are used, and their position on a uniform grid.
pub(super) struct Grid {
    pub(super) sample_s: f64,
    /// Samples that were not measured, in order.
    pub(super) missing: Vec<Range<usize>>,
    /// Root mean square of the deviations of the steps between rows from a whole number of samples, in samples, and the
    /// line with the largest one.
    wavers: (f64, u64),
    range: Range<usize>,
    place: Place,
}

/// Position of the grid's samples between the rows.
enum Place {
    /// Each row is a sample.
    Rows,
    /// For each sample, the row before it and the fraction of the way to the next row; and whether rows are samples.
    Between(Vec<(u32, f32)>, bool),
}

/// Course of a column between two rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Course {
    /// It goes straight from one to the next.
    Straight,
    /// It stays as it is.
    Held,
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

    /// Returns the values of all rows on the grid.
    pub(super) fn of(&self, mut values: Vec<f64>, course: Course) -> Vec<f64> {
        match &self.place {
            Place::Rows => {
                values.truncate(self.range.end);
                values.drain(..self.range.start);
                values
            }
            Place::Between(places, is_regular) => {
                let values = &values[self.range.clone()];
                let at = |&(row, part): &(u32, f32)| {
                    let row = row as usize;
                    let (before, after) = (values[row], values[(row + 1).min(values.len() - 1)]);
                    match course {
                        Course::Held if *is_regular => before,
                        _ => before + f64::from(part) * (after - before),
                    }
                };
                places.iter().map(at).collect()
            }
        }
    }
}

/// Returns the grid of a log; defects that were mended are added to `remarks`.
pub(super) fn grid(table: &Table, remarks: &mut Vec<Remark>) -> Result<Grid, LogError> {
    let times = &table.times_s;
    for row in 1..times.len() {
        if times[row] <= times[row - 1] {
            return Err(LogError::Unsorted {
                line: table.lines.of(row),
                time_s: times[row],
                before_s: times[row - 1],
            });
        }
    }
    let steps = Steps::from_times(times);
    let all = steps.indices(times);
    let missing = all.last().map_or(0, |last| last + 1).saturating_sub(times.len());
    let range = if missing as f64 > MOST_MISSING * times.len() as f64 {
        steps.longest_part(table, remarks)
    } else {
        0..times.len()
    };
    let used = &times[range.clone()];
    let first = all[range.start];
    let indices: Vec<usize> = all[range.clone()].iter().map(|index| index - first).collect();
    let last = indices.last().copied().unwrap_or(0);
    let sample_s = if steps.is_irregular && last + 1 > used.len() {
        steps.sample_s
    } else {
        (used[used.len() - 1] - used[0]) / last.max(1) as f64
    };
    let missing: Vec<Range<usize>> = indices
        .windows(2)
        .filter(|pair| pair[1] > pair[0] + 1)
        .map(|pair| pair[0] + 1..pair[1])
        .collect();
    let (mut square, mut largest) = (0.0, (0.0, 0));
    let (mut worst, mut worst_row) = (0.0, 0);
    for row in 0..used.len() {
        let off = ((used[row] - used[0]) / sample_s - indices[row] as f64).abs();
        if off > worst {
            (worst, worst_row) = (off, row);
        }
        if row > 0 {
            let whole = (indices[row] - indices[row - 1]) as f64;
            let off = ((used[row] - used[row - 1]) / sample_s - whole).abs();
            square += off * off;
            if off > largest.0 {
                largest = (off, row);
            }
        }
    }
    let wavers = (
        (square / (used.len() - 1).max(1) as f64).sqrt(),
        table.lines.of(range.start + largest.1),
    );
    if !missing.is_empty() {
        remarks.push(gaps(table, &range, &indices, sample_s, last + 1));
    }
    let is_regular = worst <= REGULAR;
    if !is_regular {
        remarks.push(Remark::Irregular {
            line: table.lines.of(range.start + worst_row),
            worst,
            rate_hz: 1.0 / sample_s,
        });
    }
    let place = match (is_regular, missing.is_empty()) {
        (true, true) => Place::Rows,
        (true, false) => Place::Between(between_indices(&indices), true),
        (false, _) => Place::Between(between_times(used, sample_s, last + 1), false),
    };
    Ok(Grid {
        sample_s,
        missing,
        wavers,
        range,
        place,
    })
}

/// Properties of the steps from row to row.
struct Steps {
    sample_s: f64,
    is_irregular: bool,
    has_gaps: bool,
}

impl Steps {
    fn from_times(times: &[f64]) -> Self {
        let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let off = |steps: &[f64], usual: f64| {
            let is_off = |step: &&f64| {
                let whole = (**step / usual).round();
                whole < 1.0 || (**step / usual - whole).abs() > OFF * whole.min(2.0)
            };
            steps.iter().filter(is_off).count() as f64 / steps.len() as f64
        };
        // Where half of the rows are missing, half of the steps are longer than one sample.
        let (middle, short) = (steps.len() / 2, steps.len() / 10);
        let short = *steps.select_nth_unstable_by(short, f64::total_cmp).1;
        let middle = *steps.select_nth_unstable_by(middle, f64::total_cmp).1;
        let usual = if off(&steps, short) < IRREGULAR { short } else { middle };
        let is_irregular = off(&steps, usual) > IRREGULAR;
        let longest_step = usual * if is_irregular { GAP_OF_IRREGULAR } else { 1.5 };
        let (mut sum, mut count, mut long) = (0.0, 0usize, 0usize);
        for step in &steps {
            if *step < longest_step {
                (sum, count) = (sum + step, count + 1)
            } else {
                long += 1
            }
        }
        let mean = (times[times.len() - 1] - times[0]) / steps.len() as f64;
        let keeps_to_mean = || {
            let off = |(row, time): (usize, &f64)| ((time - times[0]) / mean - row as f64).abs();
            times.iter().enumerate().map(off).fold(0.0, f64::max) < 1.05
        };
        let has_gaps = long > 0 && !(long as f64 > ROUNDED * steps.len() as f64 && keeps_to_mean());
        Self {
            sample_s: if has_gaps { sum / count.max(1) as f64 } else { mean },
            is_irregular,
            has_gaps,
        }
    }

    /// Number of samples by which the row after a step is later.
    fn samples(&self, step_s: f64) -> usize {
        let whole = (step_s / self.sample_s).round();
        let least = if self.is_irregular { GAP_OF_IRREGULAR } else { 1.5 };
        if self.has_gaps && step_s >= least * self.sample_s {
            whole as usize
        } else {
            1
        }
    }

    /// Sample of each row.
    fn indices(&self, times: &[f64]) -> Vec<usize> {
        let mut index: usize = 0;
        let later = times.windows(2).map(|pair| {
            index = index.saturating_add(self.samples(pair[1] - pair[0]));
            index
        });
        std::iter::once(0).chain(later.collect::<Vec<_>>()).collect()
    }

    /// The longest part without a gap.
    fn longest_part(&self, table: &Table, remarks: &mut Vec<Remark>) -> Range<usize> {
        let times = &table.times_s;
        let is_gap = |row: &usize| self.samples(times[*row] - times[*row - 1]) > 1;
        let ends: Vec<usize> = (1..times.len()).filter(is_gap).chain([times.len()]).collect();
        let (mut begin, mut longest) = (0, 0..0);
        for &end in &ends {
            if end - begin > longest.len() {
                longest = begin..end;
            }
            begin = end;
        }
        remarks.push(Remark::Part {
            line: table.lines.of(ends[0] - 1),
            gap_s: times[ends[0].min(times.len() - 1)] - times[ends[0] - 1],
            from: table.lines.of(longest.start),
            to: table.lines.of(longest.end - 1),
            kept: longest.len(),
        });
        longest
    }
}

/// Returns the remark on missing samples.
fn gaps(table: &Table, range: &Range<usize>, indices: &[usize], sample_s: f64, samples: usize) -> Remark {
    let steps = || indices.windows(2).map(|pair| pair[1] - pair[0] - 1);
    let line = |row: usize| table.lines.of(range.start + row);
    let first = steps().position(|lost| lost > 0).unwrap_or(0);
    let longest = steps().enumerate().max_by_key(|(row, lost)| (*lost, usize::MAX - row));
    let (longest_row, longest) = longest.unwrap_or((0, 0));
    Remark::Gaps {
        missing: steps().sum(),
        samples,
        places: steps().filter(|lost| *lost > 0).count(),
        line: line(first),
        longest_s: longest as f64 * sample_s,
        longest_line: line(longest_row),
    }
}

/// The rows before and after each sample, if rows are samples.
fn between_indices(indices: &[usize]) -> Vec<(u32, f32)> {
    let mut places = Vec::with_capacity(indices.last().map_or(0, |last| last + 1));
    for (row, pair) in indices.windows(2).enumerate() {
        let step = pair[1] - pair[0];
        places.extend((0..step).map(|n| (row as u32, n as f32 / step as f32)));
    }
    places.push((indices.len().saturating_sub(1) as u32, 0.0));
    places
}

/// The rows before and after each sample, if rows are not equally spaced.
fn between_times(times: &[f64], sample_s: f64, samples: usize) -> Vec<(u32, f32)> {
    let mut row = 0;
    let place = |n: usize| {
        let at = times[0] + n as f64 * sample_s;
        while row + 2 < times.len() && times[row + 1] <= at {
            row += 1;
        }
        let part = ((at - times[row]) / (times[row + 1] - times[row])).clamp(0.0, 1.0);
        (row as u32, part as f32)
    };
    (0..samples).map(place).collect()
}
