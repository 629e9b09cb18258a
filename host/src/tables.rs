//! Tap tables: loads them into the unused bank, reads them back, and hands over to them.

use std::io::{Read, Write};

use posicast_blocks::registers::Format;
use posicast_taps::{Tap, TapTable};

use crate::stage::PATIENCE_TICKS;
use crate::{HostError, HostedStage};

impl<L: Read + Write> HostedStage<'_, L> {
    /// Loads a table into the unused bank, reads it back, and hands over to it; the axis may stand or move. Returns the bank.
    ///
    /// # Errors
    /// [`HostError::Table`] for a table that does not fit the hardware or that differs when it is read back; there is no handover then.
    pub fn load_table(&mut self, axis: usize, table: &TapTable) -> Result<u32, HostError> {
        self.table_fits(axis, table)?;
        let active = self.settled_bank(axis, table.longest_delay_samples())?;
        let bank = if active == 1 { 2 } else { 1 };
        let taps = table.taps();
        let mut words = Vec::new();
        for (index, tap) in (0..).zip(taps) {
            words.push((self.of(axis, "tap_address"), self.place(axis, index, bank)?));
            words.push((self.of(axis, "tap"), self.word(axis, tap)?));
        }
        // An address and its tap stay in one request.
        self.write(&words)?;
        for (index, tap) in (0..).zip(taps) {
            let found = self.tap(axis, index, bank)?;
            let expected = self.word(axis, tap)?;
            if found != expected {
                return Err(self.no_table(
                    axis,
                    format!("tap {index} reads {found:#x} after {expected:#x} was written: load it again"),
                ));
            }
        }
        let longest = table.longest_delay_samples();
        // An inline shaper waits for the longest delay of any table.
        if let Ok(settle) = self.field(axis, "settle", "settle_ticks")
            && longest > settle.of(self.read_one(axis, "settle")?)
        {
            self.write_one(axis, "settle", longest << settle.low)?;
        }
        let how = self.field(axis, "swap", "swap_how")?;
        let Format::Enumeration(choices) = &how.format else {
            return Err(HostError::NoRegister("SWAP.swap_how".to_owned()));
        };
        let handover = choices
            .iter()
            .find(|choice| choice.name == "handover")
            .map_or(0, |choice| choice.value);
        let word = bank << self.field(axis, "swap", "swap_bank")?.low | handover << how.low;
        self.write_one(axis, "swap", word)?;
        let mut left = self.patience(longest.saturating_add(PATIENCE_TICKS))?;
        while self.table_bank(axis)? != bank {
            if !self.pass(&mut left)? {
                return Err(self.no_table(
                    axis,
                    "the shaper did not hand over to the table: it may be moving; try again".to_owned(),
                ));
            }
        }
        Ok(bank)
    }

    /// The bank in use, once no handover to it is under way: until then the shaper takes no taps.
    fn settled_bank(&mut self, axis: usize, ticks: u32) -> Result<u32, HostError> {
        let [pending, bank] = ["swap_pending", "table_bank"].map(|name| self.field(axis, "status", name));
        let (pending, bank) = (pending?, bank?);
        let ring = self.read_one(axis, "ring_samples")?.max(ticks);
        let mut left = self.patience(ring.saturating_add(PATIENCE_TICKS))?;
        loop {
            let status = self.read_one(axis, "status")?;
            if pending.of(status) == 0 {
                return Ok(bank.of(status));
            }
            if !self.pass(&mut left)? {
                return Err(self.no_table(
                    axis,
                    "the shaper is still handing over to another table: try again".to_owned(),
                ));
            }
        }
    }

    /// Reads the table in a bank: 0 is the machine's, 1 and 2 can be loaded. A bank into which nothing was loaded has no taps.
    ///
    /// # Errors
    /// [`HostError`]
    pub fn read_table(&mut self, axis: usize, bank: u32) -> Result<Vec<Tap>, HostError> {
        let most = self.read_one(axis, "most_taps")?;
        let delay = self.field(axis, "tap", "tap_delay")?;
        let coefficient = self.field(axis, "tap", "tap_coefficient")?;
        let above = u32::BITS - coefficient.width;
        let mut taps = Vec::new();
        for index in 0..most {
            let word = self.tap(axis, index, bank)?;
            let value = (coefficient.of(word) << above) as i32 >> above;
            if value == 0 {
                break;
            }
            taps.push(Tap {
                delay_samples: delay.of(word),
                coefficient: value,
            });
        }
        Ok(taps)
    }

    fn no_table(&self, axis: usize, what: String) -> HostError {
        HostError::Table {
            axis: self.axis(axis).name.clone(),
            what,
        }
    }

    fn table_fits(&mut self, axis: usize, table: &TapTable) -> Result<(), HostError> {
        let names = ["ring_samples", "most_taps", "coefficient_fraction"].map(|name| self.of(axis, name));
        let words = self.read(&names)?;
        let [ring, most, fraction] = words[..] else {
            return Ok(());
        };
        let count = table.taps().len();
        let longest = table.longest_delay_samples();
        let wrong = if table.coefficient_fraction() != fraction {
            format!(
                "the coefficients have {} fraction bits, and those of the hardware {fraction}: set `coefficient_fraction = {fraction}` in \
                 [fixed_point]",
                table.coefficient_fraction()
            )
        } else if count > most as usize {
            format!("the table has {count} taps, and the hardware holds {most}: choose a shorter shaper")
        } else if longest > ring.saturating_sub(2) {
            format!(
                "the table's longest delay is {longest} samples, and the hardware holds {}: choose a shorter shaper",
                ring.saturating_sub(2)
            )
        } else {
            return Ok(());
        };
        Err(self.no_table(axis, wrong))
    }

    fn place(&self, axis: usize, index: u32, bank: u32) -> Result<u32, HostError> {
        let index = index << self.field(axis, "tap_address", "tap_index")?.low;
        Ok(index | bank << self.field(axis, "tap_address", "tap_bank")?.low)
    }

    fn word(&self, axis: usize, tap: &Tap) -> Result<u32, HostError> {
        let [delay, coefficient] = ["tap_delay", "tap_coefficient"].map(|field| self.field(axis, "tap", field));
        let (delay, coefficient) = (delay?, coefficient?);
        Ok((tap.delay_samples << delay.low) & delay.mask()
            | ((tap.coefficient as u32) << coefficient.low) & coefficient.mask())
    }

    /// Reads a tap back, in the format of the register `TAP`.
    fn tap(&mut self, axis: usize, index: u32, bank: u32) -> Result<u32, HostError> {
        let place = self.place(axis, index, bank)?;
        self.write(&[(self.of(axis, "tap_address"), place), (self.of(axis, "tap_read"), 0)])?;
        let waits = self.field(axis, "status", "tap_read_waits")?;
        let mut left = self.patience(PATIENCE_TICKS)?;
        while waits.of(self.read_one(axis, "status")?) != 0 {
            if !self.pass(&mut left)? {
                return Err(self.no_table(axis, "a tap is not read back in time: try again".to_owned()));
            }
        }
        let loaded = self.read_one(axis, "tap_loaded")?;
        let part = |name: &str, to: &str| {
            let value = self.field(axis, "tap_loaded", name)?.of(loaded);
            let field = self.field(axis, "tap", to)?;
            Ok::<u32, HostError>((value << field.low) & field.mask())
        };
        Ok(part("loaded_delay", "tap_delay")? | part("loaded_coefficient", "tap_coefficient")?)
    }
}
