//! Moves: planned on the host, written into the command FIFOs, started together.

use std::io::{Read, Write};

use posicast_blocks::axis::SupervisorState;
use posicast_blocks::segments::Entry;
use posicast_machine::motion::{AxisMove, TickLimits, plan_move};

use crate::stage::{PATIENCE_TICKS, fault};
use crate::{HostError, HostedStage};

/// Fraction bits of a command position in its register, and in the planner.
const WORD_FRACTION: u32 = 8;
const EXACT_FRACTION: u32 = 32;
/// Entries of one request: four words each, 40 words.
const ENTRIES_PER_REQUEST: usize = 10;

/// A move of one axis, relative to its present command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HostMove {
    /// Index of the axis.
    pub axis: usize,
    /// Distance in the unit of the axis.
    pub distance: f64,
    /// Largest speed in the unit of the axis per second; `None`: the velocity limit.
    pub speed: Option<f64>,
}

impl<L: Read + Write> HostedStage<'_, L> {
    /// Moves axes that are switched on. They start in the same tick; the call returns when their shaped commands stand
    /// still.
    ///
    /// # Errors
    /// [`HostError`] for a move that does not fit, in which case no axis moves, and for a fault on the way.
    pub fn move_axes(&mut self, moves: &[HostMove]) -> Result<(), HostError> {
        let axes: Vec<usize> = moves.iter().map(|of| of.axis).collect();
        let ticks = self.begin(moves)?;
        self.end(&axes, ticks)
    }

    /// Queues and starts the moves of axes that stand; returns the ticks within which they must end.
    pub(crate) fn begin(&mut self, moves: &[HostMove]) -> Result<u32, HostError> {
        let axes: Vec<usize> = moves.iter().map(|of| of.axis).collect();
        let all = self.status()?;
        for axis in &axes {
            let status = &all[*axis];
            match status.state {
                Some(SupervisorState::Hold) if status.can_start && status.waiting == 0 => {}
                _ if status.causes != 0 => return Err(fault(status)),
                _ => return Err(HostError::Busy(status.axis.clone())),
            }
        }
        let plans: Result<Vec<Vec<Entry>>, HostError> = moves.iter().map(|of| self.plan(of)).collect();
        let plans = plans?;
        let longest: u64 = plans
            .iter()
            .map(|entries| entries.iter().map(|entry| u64::from(entry.ticks)).sum())
            .max()
            .unwrap_or(0);
        for (axis, entries) in axes.iter().zip(&plans) {
            self.queue(*axis, entries)?;
        }
        self.start(&axes)?;
        Ok(u32::try_from(longest)
            .unwrap_or(u32::MAX)
            .saturating_add(PATIENCE_TICKS))
    }

    /// Moves an axis until `look` finds something, and stops it; `None` where the move ends before.
    pub(crate) fn seek<T>(
        &mut self,
        way: HostMove,
        mut look: impl FnMut(&mut Self) -> Result<Option<T>, HostError>,
    ) -> Result<Option<T>, HostError> {
        let axis = way.axis;
        let ticks = self.begin(&[way])?;
        let mut left = self.patience(ticks)?;
        let found = loop {
            // The state is read first: a move that has ended is looked at to its end.
            let status = self.status()?.swap_remove(axis);
            let found = look(self)?;
            if found.is_some() {
                break found;
            }
            if status.causes != 0 {
                return Err(fault(&status));
            }
            let rests = status.state == Some(SupervisorState::Hold) && status.waiting == 0;
            if rests || !self.pass(&mut left)? {
                break None;
            }
        };
        self.write_one(axis, "stop", 0)?;
        self.end(&[axis], PATIENCE_TICKS.saturating_add(ticks))?;
        Ok(found)
    }

    /// Waits until the commands of these axes, and what their shapers make of them, stand still.
    pub(crate) fn end(&mut self, axes: &[usize], ticks: u32) -> Result<(), HostError> {
        self.wait(axes, ("come to the end of its move", ticks), |status| {
            status.state == Some(SupervisorState::Hold) && status.waiting == 0
        })?;
        let mut settle = 0;
        for axis in axes {
            settle = settle.max(
                self.field(*axis, "settle", "settle_ticks")?
                    .of(self.read_one(*axis, "settle")?),
            );
        }
        self.rest(settle)
    }

    fn plan(&mut self, of: &HostMove) -> Result<Vec<Entry>, HostError> {
        let section = self.axis(of.axis);
        let axis = || section.name.clone();
        let wanted = AxisMove {
            distance: section.unit.to_si(of.distance),
            ..AxisMove::new(section, &self.machine.fixed_point, None, of.speed)
                .map_err(|source| HostError::Move { axis: axis(), source })?
        };
        let start = self.read_one(of.axis, "command_position")? as i32;
        let words = wanted.distance * section.loop_counts_per_unit() * f64::from(1u32 << WORD_FRACTION);
        let end = f64::from(start) + words.round();
        let [plus, minus] = ["soft_limit_plus", "soft_limit_minus"].map(|name| self.read_one(of.axis, name));
        let limits = [minus?, plus?].map(|word| f64::from(word as i32));
        let limited = section
            .limits
            .is_some_and(|limits| limits.travel.is_some() && !limits.soft_limits_after_homing);
        let [minus, plus] = if limited {
            limits
        } else {
            [i32::MIN, i32::MAX].map(f64::from)
        };
        if !(minus..=plus).contains(&end) {
            let counts = |word: f64| word / f64::from(1u32 << WORD_FRACTION);
            return Err(HostError::Beyond {
                axis: axis(),
                end: counts(end),
                minus: counts(minus),
                plus: counts(plus),
            });
        }
        let limits = TickLimits::of_move(section, &self.machine.clock, &wanted);
        let exact = i64::from(start) << (EXACT_FRACTION - WORD_FRACTION);
        plan_move(exact, end as i32, &limits).map_err(|source| HostError::Plan { axis: axis(), source })
    }

    /// Writes entries into the FIFO of an axis.
    fn queue(&mut self, axis: usize, entries: &[Entry]) -> Result<(), HostError> {
        let name = self.axis(axis).name.clone();
        let refusals = [
            self.field(axis, "flags", "segment_refused")?,
            self.field(axis, "flags", "segment_malformed")?,
        ];
        let refusals = refusals
            .map(|field| field.mask())
            .iter()
            .fold(0, |mask, bit| mask | bit);
        let before = self.read_one(axis, "flags")?;
        let address = self.address(&self.of(axis, "segment"))?;
        for part in entries.chunks(ENTRIES_PER_REQUEST) {
            let words = part.iter().flat_map(|entry| (address..).zip(entry.words()));
            self.link.write_list(&words.collect::<Vec<_>>())?;
        }
        match self.read_one(axis, "flags")? & !before & refusals {
            0 => Ok(()),
            _ => Err(HostError::Refused {
                axis: name,
                what: "an entry: its FIFO is full, or the axis stops; switch it off and on again",
            }),
        }
    }

    fn start(&mut self, axes: &[usize]) -> Result<(), HostError> {
        let refused = self
            .register("flags")?
            .fields
            .iter()
            .find(|field| field.name == "start_refused");
        let refused = refused.map_or(0, |field| field.mask());
        let mask = axes.iter().fold(0, |mask, axis| mask | 1 << axis);
        self.write(&[("flags".to_owned(), refused), ("start".to_owned(), mask)])?;
        let flags = self.read(&["flags".to_owned()])?;
        match flags.first().copied().unwrap_or(0) & refused {
            0 => Ok(()),
            _ => Err(HostError::Refused {
                axis: axes
                    .iter()
                    .map(|axis| self.axis(*axis).name.clone())
                    .collect::<Vec<_>>()
                    .join(", "),
                what: "to start: an axis is not in HOLD with its brake open",
            }),
        }
    }
}
