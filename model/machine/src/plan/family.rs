//! A family of tap tables for an axis whose modes move with load, position or height.
//!
//! ```text
//! variable   low ──────────────────────────────────────────────── high
//! table 0    ├───────────●───────────┤                                    ● value that it is designed for
//! table 1                        ├──────────●─────────┤                   ├┤ where every mode's residual is within its tolerance
//! table 2                                        ├───────●───────────┤
//!                                  ▲ ▲                                    the tables are changed within the overlap:
//!                                  │ up: to the table above               two thirds through it on the way up,
//!                                  down: to the table below               one third on the way down
//! ```
//!
//! A table covers the connected range of the variable round its own value on which the residual vibration of its
//! integer taps is at most the tolerance of each mode plus what rounding the coefficients may add,
//! `Σ|c_i/2^F − a_i|`. An EI kind leaves exactly its tolerance at its own value, and a little more beside it where
//! the damping changes too; there it may exceed its own residual by a tenth. Neighbours overlap, so that at every
//! value a table is within tolerance. The thresholds lie a third of an overlap apart, so that noise of the variable
//! does not switch tables to and fro, and a third from its ends, so that there is time for the change.
//!
//! # What a handover adds
//! The shaper hands over by increments: those of the command before the change go through the old table A, later ones
//! through the new table B (`docs/shaper.md`). So the shaped command is the sum of two, each shaped by one table: the
//! command up to the change, where it stops at once, and the rest, which starts at once. A command that stops or
//! starts at velocity `v` without a shaper leaves a mode ringing with the amplitude `v/ω_d`, and its shaper leaves
//! the fraction `V` of that. A handover at velocity `v` therefore adds at most
//!
//! ```text
//! (V_A + V_B) · v / ω_d
//! ```
//!
//! to the amplitude of a mode that keeps its frequency until both tables have passed; at rest it adds nothing.
//! `model/machine/tests/family.rs` tries it on random machines, and on one whose mode moves meanwhile.

use crate::machine_file::{AxisSection, FamilySection, MAX_TABLES};
use crate::plan::AxisTables;
use posicast_shaper::analysis::{residual_vibration_at, tap_impulses};
use posicast_shaper::design::{AxisDesign, DesignError, design_axis};
use posicast_shaper::digitise::Digitise;
use posicast_shaper::digitise::{Digitised, digitise};
use posicast_shaper::impulse::Impulse;
use posicast_shaper::mode::Mode;
use posicast_shaper::unit::short;

/// A residual may exceed its tolerance by this factor, as in every insensitivity.
const SLACK: f64 = 1.0 + 1e-6;
/// Largest residual of a table beside its own value, as a multiple of that at its value, where this exceeds the
/// tolerance.
const BESIDE: f64 = 1.1;
/// Largest relative change of a mode's frequency in one step of a search along the variable.
const FREQUENCY_STEP: f64 = 2e-3;
/// Smallest number of steps in which a range is searched.
const LEAST_STEPS: f64 = 256.0;
/// Number of bisections for the end of a range: to 1e-9 of a step.
const BISECTIONS: usize = 30;
/// Number of bisections for the value of the next table, to 1/1024 of the range. Each bisection is a design.
const VALUE_BISECTIONS: usize = 10;
/// Smallest and largest overlap of a table with the next one, as a fraction of the way from its value to its end.
const OVERLAP: [f64; 2] = [0.15, 0.8];
/// Number of parts of an overlap: below both thresholds, between them, and above them.
const PARTS: f64 = 3.0;

/// The tables of an axis whose modes move, in increasing order of the variable.
#[derive(Debug, Clone, PartialEq)]
pub struct TableFamily {
    /// Index of the axis, from 0.
    pub axis: usize,
    /// Index of the table in the ROM, which is in use after a reset.
    pub nominal: usize,
    /// The tables.
    pub members: Vec<FamilyMember>,
    /// Number of tables that cover the range; fewer than `members` where the file asks for more.
    pub needed: usize,
}

/// A table of a family.
#[derive(Debug, Clone, PartialEq)]
pub struct FamilyMember {
    /// Value of the variable for which it is designed.
    pub value: f64,
    /// Part of the family's range in which every mode's residual is within its tolerance.
    pub covers: [f64; 2],
    /// Threshold below which the host changes to the table before; negative infinity for the first table.
    pub down: f64,
    /// Threshold above which the host changes to the table after; infinity for the last table.
    pub up: f64,
    /// The table, with the design and the real taps that it was made of.
    pub tables: AxisTables,
}

impl TableFamily {
    /// Index of the table for a value, where table `now` is in use: it stays in use up to its thresholds, then the
    /// next one is, and so on.
    pub fn choose(&self, now: usize, value: f64) -> usize {
        let mut chosen = now.min(self.members.len().saturating_sub(1));
        while chosen > 0 && value < self.members[chosen].down {
            chosen -= 1;
        }
        while chosen + 1 < self.members.len() && value > self.members[chosen].up {
            chosen += 1;
        }
        chosen
    }

    /// Largest rate of the variable, per second: the last command given to a table has passed through it before the variable
    /// leaves the table's range. Infinite for a single table.
    pub fn fastest_per_s(&self, sample_hz: f64) -> f64 {
        let pairs = self.members.windows(2).map(|pair| {
            let longest = pair
                .iter()
                .map(|member| member.tables.table.longest_delay_samples())
                .max();
            let longest_s = f64::from(longest.unwrap_or(0).max(1)) / sample_hz;
            (pair[0].covers[1] - pair[0].up).min(pair[1].down - pair[1].covers[0]) / longest_s
        });
        pairs.fold(f64::INFINITY, f64::min)
    }

    /// Largest number of taps of a table.
    pub fn most_taps(&self) -> usize {
        let taps = self.members.iter().map(|member| member.tables.table.taps().len());
        taps.max().unwrap_or(0)
    }

    /// Longest delay of a table, in samples.
    pub fn longest_delay_samples(&self) -> u32 {
        let delays = self
            .members
            .iter()
            .map(|member| member.tables.table.longest_delay_samples());
        delays.max().unwrap_or(0)
    }

    /// Largest amplitude that a handover from table `from` to table `to` adds to this mode, per unit of velocity, in
    /// seconds: `(V_A + V_B)/ω_d`.
    pub fn handover_bound_s(&self, from: usize, to: usize, mode: &Mode, sample_hz: f64) -> f64 {
        let residual = |index: usize| {
            let tables = &self.members[index].tables;
            residual(&tap_impulses(&tables.table, sample_hz), mode)
        };
        (residual(from) + residual(to)) / mode.omega_damped()
    }
}

/// A table of a family before its coefficients are rounded.
pub(super) struct Candidate {
    pub(super) value: f64,
    pub(super) section: AxisSection,
    pub(super) design: AxisDesign,
    pub(super) digitised: Digitised,
    covers: [f64; 2],
}

impl Candidate {
    /// Its longest delay in seconds.
    fn longest_s(&self, sample_hz: f64) -> f64 {
        let last = self.digitised.taps.last();
        last.map_or(0.0, |tap| f64::from(tap.delay_samples)) / sample_hz
    }
}

/// Designs the tables of an axis before rounding, in increasing order of the variable, and counts how many are
/// needed; `None` where no mode moves.
///
/// # Errors
/// [`DesignError`] where a value has no design, its table exceeds the tolerance at its own value, or neighbours do
/// not overlap.
pub(super) fn candidates(
    axis: &AxisSection,
    how: Digitise,
    sample_hz: f64,
) -> Result<(Vec<Candidate>, usize), DesignError> {
    let Some(family) = &axis.family else {
        return Ok((Vec::new(), 0));
    };
    let search = Search {
        axis,
        family,
        how,
        sample_hz,
    };
    let chosen = search.fewest()?;
    if family.values.is_empty() {
        let needed = chosen.len();
        return Ok((chosen, needed));
    }
    let given: Result<Vec<Candidate>, DesignError> = family.values.iter().map(|value| search.at(*value)).collect();
    let given = given?;
    let covers: Vec<[f64; 2]> = given.iter().map(|candidate| candidate.covers).collect();
    if let Some([low, high]) = gap(&covers, family.range) {
        return Err(DesignError::FamilyGap {
            axis: axis.name.clone(),
            low: family.show(low, axis.unit),
            high: family.show(high, axis.unit),
            needed: chosen.len(),
            values: values_text(axis, family, &chosen),
        });
    }
    Ok((given, chosen.len()))
}

/// Makes the family of an axis from its rounded tables.
///
/// # Errors
/// [`DesignError::FamilyGap`] where rounding left two neighbours without an overlap.
pub(super) fn of_tables(
    index: usize,
    axis: &AxisSection,
    family: &FamilySection,
    members: Vec<(f64, AxisTables)>,
    needed: usize,
    sample_hz: f64,
) -> Result<TableFamily, DesignError> {
    let covers: Vec<[f64; 2]> = members
        .iter()
        .map(|(value, tables)| {
            let taps = tap_impulses(&tables.table, sample_hz);
            covered(axis, family, &taps, *value, tables.quantising_error())
        })
        .collect();
    if let Some([low, high]) = gap(&covers, family.range) {
        return Err(DesignError::FamilyGap {
            axis: axis.name.clone(),
            low: family.show(low, axis.unit),
            high: family.show(high, axis.unit),
            needed: members.len() + 1,
            values: "a list of your own, closer to each other".to_owned(),
        });
    }
    let thresholds: Vec<[f64; 2]> = covers
        .windows(2)
        .map(|pair| {
            let (low, high) = (pair[1][0], pair[0][1]);
            [low + (high - low) / PARTS, high - (high - low) / PARTS]
        })
        .collect();
    let nominal = members
        .iter()
        .position(|(value, _)| *value == family.nominal)
        .unwrap_or(0);
    let members = members
        .into_iter()
        .enumerate()
        .map(|(place, (value, tables))| FamilyMember {
            value,
            covers: covers[place],
            down: place
                .checked_sub(1)
                .map_or(f64::NEG_INFINITY, |below| thresholds[below][0]),
            up: thresholds.get(place).map_or(f64::INFINITY, |threshold| threshold[1]),
            tables,
        });
    Ok(TableFamily {
        axis: index,
        nominal,
        members: members.collect(),
        needed,
    })
}

/// The first part of the range that no table covers, or in which neighbours only touch; `None` if there is none.
fn gap(covers: &[[f64; 2]], range: [f64; 2]) -> Option<[f64; 2]> {
    let mut reached = range[0];
    for (place, [low, high]) in covers.iter().enumerate() {
        if *low > reached || (place > 0 && *low == reached) {
            return Some([reached, *low]);
        }
        reached = reached.max(*high);
    }
    (reached < range[1]).then_some([reached, range[1]])
}

fn values_text(axis: &AxisSection, family: &FamilySection, chosen: &[Candidate]) -> String {
    let in_file = |value: f64| {
        if family.is_position() {
            axis.unit.from_si(value)
        } else {
            value
        }
    };
    let values: Vec<String> = chosen.iter().map(|candidate| short(in_file(candidate.value))).collect();
    format!("values = [{}]", values.join(", "))
}

/// The search for the values of a family.
struct Search<'a> {
    axis: &'a AxisSection,
    family: &'a FamilySection,
    how: Digitise,
    sample_hz: f64,
}

impl Search<'_> {
    /// As few tables as cover the range, from the nominal value to both sides, each as far from the last as their
    /// overlap allows.
    fn fewest(&self) -> Result<Vec<Candidate>, DesignError> {
        let [low, high] = self.family.range;
        let mut members = vec![self.at(self.family.nominal)?];
        while let Some(last) = members.last().filter(|last| last.covers[1] < high) {
            let next = self.next(last, high)?;
            members.push(next);
            self.check_count(members.len())?;
        }
        while let Some(first) = members.first().filter(|first| first.covers[0] > low) {
            let next = self.next(first, low)?;
            members.insert(0, next);
            self.check_count(members.len())?;
        }
        Ok(members)
    }

    fn check_count(&self, found: usize) -> Result<(), DesignError> {
        if found > MAX_TABLES {
            Err(DesignError::FamilySize {
                axis: self.axis.name.clone(),
                most: MAX_TABLES,
            })
        } else {
            Ok(())
        }
    }

    /// The table farthest from `from` towards `end` that still overlaps it.
    fn next(&self, from: &Candidate, end: f64) -> Result<Candidate, DesignError> {
        let upward = end > from.value;
        let (near, far) = if upward { (0, 1) } else { (1, 0) };
        let edge = from.covers[far];
        let overlaps = |candidate: &Candidate, way: f64| {
            // At full speed, a command must have passed through a table before the variable leaves the table's range.
            let passed =
                PARTS * self.fastest_per_s() * from.longest_s(self.sample_hz).max(candidate.longest_s(self.sample_hz));
            let overlap = passed.clamp(OVERLAP[0] * way, OVERLAP[1] * way);
            if upward {
                candidate.covers[near] <= edge - overlap
            } else {
                candidate.covers[near] >= edge + overlap
            }
        };
        let last = self.at(end)?;
        let mut way = (edge - from.value).abs();
        if overlaps(&last, way) {
            return Ok(last);
        }
        // A table at the edge itself overlaps this one, unless it reaches much less far: the humps of a two-hump EI exceed the tolerance
        // by a few thousandths for some damping ratios, and its range then ends before them.
        let mut best = self.at(edge)?;
        if !overlaps(&best, way) {
            way = way.min((edge - best.covers[near]).abs());
        }
        if !overlaps(&best, way) {
            return Err(DesignError::FamilyUncovered {
                axis: self.axis.name.clone(),
                value: self.family.show(edge, self.axis.unit),
            });
        }
        let mut beyond = end;
        for _ in 0..VALUE_BISECTIONS {
            let candidate = self.at(f64::midpoint(best.value, beyond))?;
            if overlaps(&candidate, way) {
                best = candidate
            } else {
                beyond = candidate.value
            }
        }
        Ok(best)
    }

    /// Largest rate of the variable by the machine file: the axis's velocity if the variable is its position, otherwise
    /// infinite, since the rate is unknown.
    fn fastest_per_s(&self) -> f64 {
        let velocity = self.axis.limits.and_then(|limits| limits.velocity);
        velocity.filter(|_| self.family.is_position()).unwrap_or(0.0)
    }

    /// Designs the table for a value.
    fn at(&self, value: f64) -> Result<Candidate, DesignError> {
        let section = self.axis.at_value(value);
        let design = design_axis(section.shaped(), self.sample_hz)?;
        let digitised = digitise(&design, self.how, self.sample_hz)?;
        let impulses = digitised.impulses(self.sample_hz);
        let covers = covered(self.axis, self.family, &impulses, value, 0.0);
        if covers[0] == covers[1] {
            return Err(DesignError::FamilyUncovered {
                axis: self.axis.name.clone(),
                value: self.family.show(value, self.axis.unit),
            });
        }
        Ok(Candidate {
            value,
            section,
            design,
            digitised,
            covers,
        })
    }
}

/// The connected range of the variable round `value` on which every mode's residual is within its bound; a single
/// point where a mode exceeds its tolerance at `value` itself.
fn covered(axis: &AxisSection, family: &FamilySection, impulses: &[Impulse], value: f64, rounding: f64) -> [f64; 2] {
    let limits = axis.modes.iter().map(|mode| {
        let tolerance = axis.shaped().tolerance_of(mode) * SLACK + rounding;
        let here = residual(impulses, &mode.at(value));
        (here <= tolerance).then_some((mode, tolerance.max(BESIDE * here)))
    });
    let Some(limits) = limits.collect::<Option<Vec<_>>>() else {
        return [value, value];
    };
    let within = |value: f64| {
        let mut limits = limits.iter();
        limits.all(|(mode, allowed)| residual(impulses, &mode.at(value)) <= *allowed)
    };
    family.range.map(|end| {
        let mut inside = value;
        while inside != end {
            let next = inside + step(axis, family, inside, end);
            if !within(next) {
                return bisected(inside, next, within);
            }
            inside = next;
        }
        end
    })
}

/// Next value on the way from `from` to `end`, at most `end`, such that no mode's frequency changes much.
fn step(axis: &AxisSection, family: &FamilySection, from: f64, end: f64) -> f64 {
    let longest = (family.range[1] - family.range[0]) / LEAST_STEPS;
    let mut step = (end - from).clamp(-longest, longest);
    let hardly_changes = |step: f64| {
        let mut modes = axis.modes.iter();
        modes.all(|mode| {
            let (here, there) = (mode.at(from).frequency_hz, mode.at(from + step).frequency_hz);
            (there / here - 1.0).abs() <= FREQUENCY_STEP
        })
    };
    while !hardly_changes(step) && from + step / 2.0 != from {
        step /= 2.0;
    }
    // This returns exactly `end`, without the rounding of a sum.
    if step == end - from { end - from } else { step }
}

/// Bisects for the end of a range between a value inside and one outside.
fn bisected(mut inside: f64, mut outside: f64, within: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..BISECTIONS {
        let middle = f64::midpoint(inside, outside);
        if within(middle) {
            inside = middle
        } else {
            outside = middle
        }
    }
    inside
}

/// Residual of impulses in order of time, referred to the last one even where it is zero, so that a tap that rounds
/// to zero does not change the residual by a jump.
fn residual(impulses: &[Impulse], mode: &Mode) -> f64 {
    residual_vibration_at(impulses, mode, impulses.last().map_or(0.0, |last| last.time_s))
}
