//! Position compare: arms the row of the machine file, or a list of positions, and shows what it did.

use std::io::{Read, Write};

use posicast_blocks::compare::{LEAST_DISTANCE_COUNTS, LIST_POSITIONS};

use crate::{HostError, HostedStage};

/// State of an axis's position compare.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CompareState {
    /// Whether it is armed.
    pub armed: bool,
    /// Whether the positions beside the count are known: passages give pulses.
    pub ready: bool,
    /// Pulses since it was armed.
    pub passes: u32,
    /// Whether a pulse began during another.
    pub merged: bool,
    /// Whether the count jumped, so that positions between were not passed.
    pub jumped: bool,
}

impl<L: Read + Write> HostedStage<'_, L> {
    /// Arms the position compare of an axis, and waits until it is ready. Its positions are those of the machine file, or the list
    /// `at`: positions of the axis, in its unit. They count from the origin as it is now.
    ///
    /// # Errors
    /// [`HostError::Compare`] for an axis without `[axis.compare]`, and for a list that is empty, too long, or has positions that are
    /// nearer than four counts or leave the position word; otherwise [`HostError`] of the line.
    pub fn arm_compare(&mut self, axis: usize, at: Option<&[f64]>) -> Result<CompareState, HostError> {
        let section = self.axis(axis);
        let Some(compare) = section.compare else {
            return Err(self.no_compare(axis, "it has no [axis.compare]".to_owned()));
        };
        let origin = i64::from(self.read_one(axis, "origin")? as i32);
        let entries = at.map(|at| self.entries(axis, at, origin)).transpose()?;
        let first = (compare.first * section.counts_per_unit).round() as i64 + origin;
        let first = i32::try_from(first)
            .map_err(|_| self.no_compare(axis, "its first position leaves the position word".to_owned()))?;
        let list = self.field(axis, "compare_control", "compare_use_list")?.mask();
        let control = self.register(&self.of(axis, "compare_control"))?.reset();
        self.write_one(axis, "compare_disarm", 0)?;
        match &entries {
            Some(entries) => {
                self.write_one(axis, "compare_clear", 0)?;
                for entry in entries {
                    self.write_one(axis, "compare_entry", *entry as u32)?;
                }
                self.write_one(axis, "compare_control", control | list)?;
            }
            None => {
                self.write_one(axis, "compare_first", first as u32)?;
                self.write_one(axis, "compare_control", control & !list)?;
            }
        }
        self.write_one(axis, "compare_arm", 0)?;
        let most_clocks = u64::from(compare.positions).max(4 * LIST_POSITIONS as u64);
        let ticks = most_clocks / u64::from(self.machine().clock.clocks_per_sample()) + 100;
        let mut left = self.patience(u32::try_from(ticks).unwrap_or(u32::MAX))?;
        loop {
            let state = self.compare_state(axis)?;
            if state.ready {
                return Ok(state);
            }
            if !self.pass(&mut left)? {
                return Err(self.no_compare(axis, "it was not ready in time: does the axis jump?".to_owned()));
            }
        }
    }

    /// Disarms the position compare of an axis; a pulse that has begun goes on.
    ///
    /// # Errors
    /// As [`arm_compare`](Self::arm_compare).
    pub fn disarm_compare(&mut self, axis: usize) -> Result<CompareState, HostError> {
        let state = self.compare_state(axis)?;
        self.write_one(axis, "compare_disarm", 0)?;
        Ok(CompareState { armed: false, ..state })
    }

    /// State of the position compare of an axis.
    ///
    /// # Errors
    /// As [`arm_compare`](Self::arm_compare).
    pub fn compare_state(&mut self, axis: usize) -> Result<CompareState, HostError> {
        if self.axis(axis).compare.is_none() {
            return Err(self.no_compare(axis, "it has no [axis.compare]".to_owned()));
        }
        let names = ["compare_state", "compare_passes"].map(|name| self.of(axis, name));
        let [word, passes] = self.read(&names)?[..] else {
            return Err(HostError::NoRegister(self.of(axis, "compare_state")));
        };
        let flag =
            |name: &str| -> Result<bool, HostError> { Ok(self.field(axis, "compare_state", name)?.of(word) != 0) };
        Ok(CompareState {
            armed: flag("compare_armed")?,
            ready: flag("compare_ready")?,
            passes,
            merged: flag("compare_merged")?,
            jumped: flag("compare_jumped")?,
        })
    }

    /// The positions as increasing counts since reset.
    fn entries(&self, axis: usize, at: &[f64], origin: i64) -> Result<Vec<i32>, HostError> {
        let section = self.axis(axis);
        let per_unit = section.unit.counts_in_file(section.counts_per_unit);
        let refused = |what: String| Err(self.no_compare(axis, what));
        if at.is_empty() || at.len() > LIST_POSITIONS {
            return refused(format!("a list has 1 to {LIST_POSITIONS} positions, not {}", at.len()));
        }
        let mut entries: Vec<i32> = Vec::new();
        for position in at {
            let count = (position * per_unit).round() + origin as f64;
            if !(f64::from(i32::MIN)..=f64::from(i32::MAX)).contains(&count) {
                return refused(format!("position {position} leaves the position word"));
            }
            let count = count as i32;
            let near = entries.last().map(|last| i64::from(count) - i64::from(*last));
            if near.is_some_and(|distance| distance < LEAST_DISTANCE_COUNTS) {
                return refused(format!(
                    "position {position} is {} counts above the one before: positions increase, by {LEAST_DISTANCE_COUNTS} counts or more",
                    near.unwrap_or(0)
                ));
            }
            entries.push(count);
        }
        Ok(entries)
    }

    fn no_compare(&self, axis: usize, what: String) -> HostError {
        HostError::Compare {
            axis: self.axis(axis).name.clone(),
            what,
        }
    }
}
