//! What is fixed when an error table is built: its places, its format, and the machine's entries.

/// Most entries of a table.
pub const MOST_ENTRIES: usize = 256;
/// Width of an entry.
pub const ENTRY_BITS: u32 = 18;
/// Largest entry, and with its sign the smallest but one.
pub const LARGEST_ENTRY: i32 = (1 << (ENTRY_BITS - 1)) - 1;
/// Entries are at least 2^4 counts apart.
pub const LEAST_SPACING_BITS: u32 = 4;
/// And at most 2^20: 256 of them are more than a position word holds.
pub const MOST_SPACING_BITS: u32 = 20;
/// Neighbours differ by at most 2^−4 of their distance.
pub const STEEPEST_BITS: u32 = 4;
/// The steepest slope of a table: error per position.
pub const STEEPEST: f64 = 1.0 / (1 << STEEPEST_BITS) as f64;

/// Unit of the entries.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum EntryUnit {
    /// 256ths of a count: ±511 counts.
    #[default]
    Fine,
    /// Sixteenths of a count: ±8191 counts.
    Coarse,
}

impl EntryUnit {
    /// Entries of a count are 2 to the power of this.
    pub fn fraction_bits(self) -> u32 {
        match self {
            Self::Fine => 8,
            Self::Coarse => 4,
        }
    }

    /// Counts of an entry of 1.
    pub fn counts(self) -> f64 {
        1.0 / f64::from(1u32 << self.fraction_bits())
    }
}

/// Where the entries are, and what they mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ErrorTableFormat {
    /// User's position of the first entry, in counts.
    pub first_counts: i32,
    /// Entries are 2^`spacing_bits` counts apart.
    pub spacing_bits: u32,
    /// Unit of the entries.
    pub unit: EntryUnit,
}

impl ErrorTableFormat {
    /// By how much neighbours may differ, in entries: [`STEEPEST`] times their distance, or anything where that is more than two entries
    /// can differ by.
    pub fn most_step(&self) -> i32 {
        let bits = self.spacing_bits + self.unit.fraction_bits();
        (1i32 << bits.saturating_sub(STEEPEST_BITS).min(ENTRY_BITS)).min((1 << ENTRY_BITS) - 1)
    }

    /// Fraction bits of a place between two entries, of which 8 are those of a position.
    pub(super) fn fraction_bits(&self) -> u32 {
        self.spacing_bits + 8
    }
}

/// Parameters that are fixed when an error table is built.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ErrorTableConfig {
    format: ErrorTableFormat,
    entries: Vec<i32>,
}

/// Why no error table can be built.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum ErrorTableConfigError {
    /// Too few entries, or too many.
    #[error("an error table of {0} entries: it has 2 to {MOST_ENTRIES}; choose another spacing")]
    Entries(usize),
    /// A spacing that the hardware does not have.
    #[error(
        "entries 2^{0} counts apart: 2^{LEAST_SPACING_BITS} to 2^{MOST_SPACING_BITS} are possible; choose another spacing"
    )]
    Spacing(u32),
    /// An entry that its word does not hold.
    #[error(
        "entry {index} is {found}, beyond ±{LARGEST_ENTRY}: take the coarse unit, or correct what is measured there"
    )]
    Entry {
        /// Its place.
        index: usize,
        /// What it is.
        found: i32,
    },
    /// Neighbours that differ by too much.
    #[error(
        "entries {index} and {} differ by {found}, at most {most} is allowed: a sixteenth of their distance; no screw or scale has an \
         error as steep as that",
        .index + 1
    )]
    Steep {
        /// Place of the first.
        index: usize,
        /// Their difference.
        found: i64,
        /// The largest one.
        most: i32,
    },
}

impl ErrorTableConfig {
    /// A table of these entries: true less counted position, in the format's unit.
    ///
    /// # Errors
    /// [`ErrorTableConfigError`] for fewer than 2 or more than [`MOST_ENTRIES`] entries, a spacing beyond 2^4 to 2^20 counts, entries that
    /// do not fit, and neighbours that differ by more than [`ErrorTableFormat::most_step`].
    pub fn new(format: ErrorTableFormat, entries: Vec<i32>) -> Result<Self, ErrorTableConfigError> {
        if !(2..=MOST_ENTRIES).contains(&entries.len()) {
            return Err(ErrorTableConfigError::Entries(entries.len()));
        }
        if !(LEAST_SPACING_BITS..=MOST_SPACING_BITS).contains(&format.spacing_bits) {
            return Err(ErrorTableConfigError::Spacing(format.spacing_bits));
        }
        let beyond = (entries.iter().enumerate()).find(|(_, entry)| entry.unsigned_abs() > LARGEST_ENTRY as u32);
        if let Some((index, found)) = beyond {
            return Err(ErrorTableConfigError::Entry { index, found: *found });
        }
        let most = format.most_step();
        for (index, pair) in entries.windows(2).enumerate() {
            let found = i64::from(pair[1]) - i64::from(pair[0]);
            if found.abs() > i64::from(most) {
                return Err(ErrorTableConfigError::Steep { index, found, most });
            }
        }
        Ok(Self { format, entries })
    }

    /// Where its entries are, and what they mean.
    pub fn format(&self) -> ErrorTableFormat {
        self.format
    }

    /// The machine's entries, of bank 0.
    pub fn entries(&self) -> &[i32] {
        &self.entries
    }

    /// Place of the last entry.
    pub fn last(&self) -> u8 {
        (self.entries.len() - 1) as u8
    }

    /// Clocks from `valid` to `compensated_valid`.
    pub fn latency_clocks(&self) -> u32 {
        super::PASS_CLOCKS + self.format.fraction_bits()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn format(spacing_bits: u32, unit: EntryUnit) -> ErrorTableFormat {
        ErrorTableFormat {
            first_counts: 0,
            spacing_bits,
            unit,
        }
    }

    #[test]
    fn the_steepest_slope_is_a_sixteenth() {
        for unit in [EntryUnit::Fine, EntryUnit::Coarse] {
            for spacing_bits in LEAST_SPACING_BITS..=MOST_SPACING_BITS {
                let most = format(spacing_bits, unit).most_step();
                let of_slope = STEEPEST * f64::from(1u32 << spacing_bits) / unit.counts();
                assert_eq!(f64::from(most), of_slope.min(262_143.0), "{unit:?} {spacing_bits}");
            }
        }
    }

    #[test]
    fn entries_that_do_not_fit_are_refused() {
        let fine = format(10, EntryUnit::Fine);
        let new = |format, entries: &[i32]| ErrorTableConfig::new(format, entries.to_vec());
        assert!(new(fine, &[0, 16384, 0]).is_ok());
        let steep = ErrorTableConfigError::Steep {
            index: 1,
            found: -16385,
            most: 16384,
        };
        assert_eq!(new(fine, &[0, 16384, -1]), Err(steep));
        assert_eq!(new(fine, &[0]), Err(ErrorTableConfigError::Entries(1)));
        assert_eq!(new(fine, &[0; 257]), Err(ErrorTableConfigError::Entries(257)));
        let wide = format(20, EntryUnit::Fine);
        let entry = ErrorTableConfigError::Entry {
            index: 1,
            found: -131_072,
        };
        assert_eq!(new(wide, &[0, -131_072]), Err(entry));
        for bits in [3, 21] {
            let refused = new(format(bits, EntryUnit::Fine), &[0, 0]);
            assert_eq!(refused, Err(ErrorTableConfigError::Spacing(bits)));
        }
    }
}
