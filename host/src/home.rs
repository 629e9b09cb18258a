//! Homing by a probe: approach, retract, approach slowly, and let the hardware set the position at the contact.
//!
//! ```text
//!   stands ─► approach ─► touches, stops ─► retract ─► slow approach, PRESET armed ─► touches, stops ─► retract
//! ```
//!
//! The pulse counter latches the position a fixed number of clocks after the contact, as at an index: how fast the host looks does not
//! matter.

use std::io::{Read, Write};

use posicast_blocks::segments::POSITION_FRACTION;
use posicast_machine::machine_file::ProbeSection;

use crate::moves::HostMove;
use crate::{HostError, HostedStage};

/// Where a search ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Until {
    /// The probe touches.
    Touches,
    /// The armed index was latched.
    Latched,
}

impl<L: Read + Write> HostedStage<'_, L> {
    /// Homes an axis that is switched on by its probe, and ends at rest at `retract` from the contact, whose position is that of the
    /// machine file. The soft limits follow, and the axis counts as homed. Returns the count at the contact.
    ///
    /// # Errors
    /// [`HostError::Probe`] if there is no probe, or no contact within its distance; [`HostError`] for a fault on the way.
    pub fn home(&mut self, axis: usize) -> Result<i32, HostError> {
        let section = self.axis(axis);
        let probe = section
            .probe
            .ok_or_else(|| self.no_contact(axis, "it has no [axis.probe]"))?;
        let away = -probe.side.sign() * probe.retract;
        // The approaches go past the contact, where the travel of an earlier homing may end.
        self.write_one(axis, "homed", 0)?;
        if self.touches(axis)? {
            self.shift(axis, away, probe.velocity)?;
        }
        self.free(axis)?;
        if !self.seek_contact(axis, probe.side.sign() * probe.within, probe.velocity, Until::Touches)? {
            return Err(self.no_contact(axis, "there was no contact within `within`"));
        }
        self.shift(axis, away, probe.velocity)?;
        self.free(axis)?;
        self.latch(axis, &probe)?;
        let count = self.read_one(axis, "index_count")? as i32;
        // Behind the contact the axis may be beyond its travel.
        self.shift(axis, away, probe.velocity)?;
        self.limit_travel(axis)?;
        Ok(count)
    }

    /// The slow approach, at whose contact the hardware sets the position.
    fn latch(&mut self, axis: usize, probe: &ProbeSection) -> Result<(), HostError> {
        let position = (probe.position * self.axis(axis).loop_counts_per_unit()).round() as i32;
        let setup = self.read_one(axis, "index")?;
        let [always, presets] = ["index_always", "index_presets"].map(|name| self.field(axis, "index", name));
        let once = setup & !always?.mask() | presets?.mask();
        self.write_one(axis, "preset", position as u32)?;
        self.write_one(axis, "index", once)?;
        self.write_one(axis, "index_arm", 0)?;
        let found = self.seek_contact(
            axis,
            2.0 * probe.side.sign() * probe.retract,
            probe.slow_velocity,
            Until::Latched,
        );
        // A later contact must not move the origin again.
        self.write_one(axis, "index", setup)?;
        match found? {
            true => Ok(()),
            false => Err(self.no_contact(axis, "the contact did not come again")),
        }
    }

    fn no_contact(&self, axis: usize, what: &'static str) -> HostError {
        HostError::Probe {
            axis: self.axis(axis).name.clone(),
            what,
        }
    }

    fn touches(&mut self, axis: usize) -> Result<bool, HostError> {
        let touches = self.field(axis, "status", "level_z")?;
        Ok(touches.of(self.read_one(axis, "status")?) != 0)
    }

    /// Demands that the probe does not touch.
    fn free(&mut self, axis: usize) -> Result<(), HostError> {
        match self.touches(axis)? {
            true => Err(self.no_contact(
                axis,
                "it still touches after `retract`: lengthen that, or look at its line",
            )),
            false => Ok(()),
        }
    }

    fn in_file(&self, axis: usize, distance: f64, velocity: f64) -> HostMove {
        let unit = self.axis(axis).unit;
        HostMove {
            axis,
            distance: unit.in_file(distance),
            speed: Some(unit.in_file(velocity)),
        }
    }

    fn shift(&mut self, axis: usize, distance: f64, velocity: f64) -> Result<(), HostError> {
        self.move_axes(&[self.in_file(axis, distance, velocity)])
    }

    /// Moves over a distance until something is found, and comes to rest; returns whether it was found.
    fn seek_contact(&mut self, axis: usize, distance: f64, velocity: f64, until: Until) -> Result<bool, HostError> {
        let [touches, armed] = ["level_z", "index_armed"].map(|name| self.field(axis, "status", name));
        let (touches, armed) = (touches?, armed?);
        let found = self.seek(self.in_file(axis, distance, velocity), |stage| {
            let word = stage.read_one(axis, "status")?;
            let is = match until {
                Until::Touches => touches.of(word) != 0,
                Until::Latched => armed.of(word) == 0,
            };
            Ok(is.then_some(()))
        });
        Ok(found?.is_some())
    }

    /// Shifts the soft limits of the machine file to the origin, and says that the axis is homed.
    fn limit_travel(&mut self, axis: usize) -> Result<(), HostError> {
        let origin = i64::from(self.read_one(axis, "origin")? as i32) << POSITION_FRACTION;
        // After a reset the registers have the words of the file.
        let words = ["soft_limit_minus", "soft_limit_plus"].map(|name| {
            let register = self.register(&self.of(axis, name))?;
            Ok::<i64, HostError>(i64::from(register.reset() as i32))
        });
        let [minus, plus] = words;
        let (minus, plus) = (minus?, plus?);
        // The axis must not be homed while one limit is still the old one.
        self.write_one(axis, "homed", 0)?;
        if (minus, plus) != (0, 0) {
            let shifted = [minus, plus].map(|word| i32::try_from(word + origin));
            let [Ok(minus), Ok(plus)] = shifted else {
                return Err(self.no_contact(
                    axis,
                    "its travel leaves the position word there: reset the stage nearer to it",
                ));
            };
            self.write_one(axis, "soft_limit_minus", minus as u32)?;
            self.write_one(axis, "soft_limit_plus", plus as u32)?;
        }
        self.write_one(axis, "homed", 1)
    }
}
