//! Correction at rest: the steps that a motor has lost, as its scale shows them, are given again.
//!
//! The host first accepts where the scale says that the axis is: it sets the position, shifts the soft limits, and lets the deviation
//! count anew. Then an ordinary move leads the axis back. Wherever the host is interrupted, position and limits are true, and no step
//! is given twice.

use std::io::{Read, Write};

use posicast_blocks::axis::SupervisorState;
use posicast_blocks::segments::POSITION_FRACTION;

use crate::moves::HostMove;
use crate::{HostError, HostedStage};

/// What a correction did.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct HostCorrection {
    /// Missing steps that were given, up less down.
    pub steps: i32,
    /// Deviation that is left, in steps.
    pub left: i32,
}

impl<L: Read + Write> HostedStage<'_, L> {
    /// Corrects an axis that is in HOLD, as `[axis.correction]` says; without the table, nothing is done.
    ///
    /// # Errors
    /// [`HostError::Busy`] for an axis that moves, [`HostError::Deviates`] for a deviation that is too large to be corrected; otherwise
    /// those of [`move_axes`](Self::move_axes).
    pub fn correct(&mut self, axis: usize) -> Result<HostCorrection, HostError> {
        let section = self.axis(axis);
        let Some(correction) = section.correction else {
            return Ok(HostCorrection { steps: 0, left: 0 });
        };
        self.rest((correction.rest_s * self.machine().clock.sample_hz) as u32)?;
        let status = &self.status()?[axis];
        if status.state != Some(SupervisorState::Hold) || !status.can_start || status.waiting != 0 {
            return Err(HostError::Busy(status.axis.clone()));
        }
        let steps = self.read_one(axis, "deviation")? as i32;
        let counts = |length: f64| (length * section.counts_per_unit + 1e-6) as u32;
        if steps.unsigned_abs() <= counts(correction.from) {
            return Ok(HostCorrection { steps: 0, left: steps });
        }
        if steps.unsigned_abs() > counts(correction.most) {
            return Err(HostError::Deviates {
                axis: section.name.clone(),
                steps,
                most: counts(correction.most),
            });
        }
        self.accept(axis, steps)?;
        self.move_axes(&[HostMove {
            axis,
            distance: section.unit.in_file(f64::from(steps) / section.counts_per_unit),
            speed: Some(section.unit.in_file(correction.velocity)),
        }])?;
        let left = self.read_one(axis, "deviation")? as i32;
        Ok(HostCorrection { steps, left })
    }

    /// Takes the scale's position as that of the axis, which stands.
    fn accept(&mut self, axis: usize, steps: i32) -> Result<(), HostError> {
        let names = ["position", "soft_limit_minus", "soft_limit_plus", "status"].map(|name| self.of(axis, name));
        let words = self.read(&names)?;
        let [position, minus, plus, status] = words[..] else {
            return Ok(());
        };
        let homed = self.field(axis, "status", "homed")?.of(status);
        let shifted = |word: u32| (word as i32).saturating_add(steps << POSITION_FRACTION) as u32;
        let mut writes = vec![
            ("preset", (position as i32).wrapping_sub(steps) as u32),
            ("realign", u32::from(steps as i16 as u16)),
        ];
        if (minus, plus) != (0, 0) {
            // The axis must not be homed while one limit is still the old one.
            writes.extend([
                ("homed", 0),
                ("soft_limit_minus", shifted(minus)),
                ("soft_limit_plus", shifted(plus)),
                ("homed", homed),
            ]);
        }
        // One request: nothing comes between.
        let writes: Vec<(String, u32)> = writes
            .into_iter()
            .map(|(name, word)| (self.of(axis, name), word))
            .collect();
        self.write(&writes)
    }
}
