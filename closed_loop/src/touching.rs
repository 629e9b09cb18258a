//! A stage with its machine and a touch probe at its capture line.

use posicast_testbench::Error;

use crate::linked_bench::Registered;
use crate::stage_bench::StageBench;

/// Clocks after which the probe looks again where its axis is, near the contact and far from it.
pub const LOOK_CLOCKS: u64 = 10;
const FAR_LOOK_CLOCKS: u64 = 2000;

/// What the probe touches: anything at a position of an axis and beyond it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// Index of the axis.
    pub axis: usize,
    /// Counts from where the axis begins; the contact lies on the side of its sign. With 0 the probe touches all the time.
    pub count: i64,
    /// Whether the line is low while the probe touches.
    pub is_low: bool,
    /// Largest speed at which the axis comes to the contact, in counts per clock: it decides how often the probe looks.
    pub fastest: f64,
}

/// The stage, its machine and its probe, for a host behind a line.
pub struct Touching {
    /// The stage with its machine.
    pub bench: StageBench,
    contact: Contact,
    touched_at: Option<i64>,
}

impl Touching {
    /// Puts a probe at the capture line of `bench`.
    pub fn new(bench: StageBench, contact: Contact) -> Self {
        Self {
            bench,
            contact,
            touched_at: None,
        }
    }

    /// Counts from where the axis begins, as the machine stood at the last touch; `None` if there was none.
    pub fn touched_at(&self) -> Option<i64> {
        self.touched_at
    }

    /// Drives the line. Returns the clocks until the next look: never past the half of the way to the contact.
    fn look(&mut self) -> Result<u64, Error> {
        let Contact {
            axis,
            count,
            is_low,
            fastest,
        } = self.contact;
        let is_at = self.bench.plant(axis).count();
        let left = (count - is_at) * count.signum();
        let touches = left <= 0;
        if !touches {
            self.touched_at = None;
        } else if self.touched_at.is_none() {
            self.touched_at = Some(is_at);
        }
        self.bench.set("capture_line", u64::from(touches != is_low))?;
        let far = left as f64 / (2.0 * fastest);
        Ok((far as u64).clamp(LOOK_CLOCKS, FAR_LOOK_CLOCKS))
    }
}

impl Registered for Touching {
    fn read_at(&mut self, address: u32) -> Result<u32, Error> {
        self.bench.read_at(address)
    }

    fn write_at(&mut self, address: u32, data: u32) -> Result<(), Error> {
        self.bench.write_at(address, data)
    }

    fn clocks(&mut self, mut clocks: u64) -> Result<(), Error> {
        while clocks > 0 {
            let some = clocks.min(self.look()?);
            self.bench.clocks(some)?;
            clocks -= some;
        }
        Ok(())
    }
}
