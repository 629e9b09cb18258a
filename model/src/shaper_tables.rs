//! The shapers of a machine for a program that shapes commands in software, such as the component for LinuxCNC: a TOML
//! file that `posicast generate --hal` writes and the component reads.
//!
//! ```toml
//! sample_hz = 1000.0                         # the rate for which the tables were digitised
//!
//! [[axis]]
//! name = "x"
//! lsb_per_unit = 256000.0                    # command words per unit of the controller's position
//! word_bits = 32
//! modulo = false
//! coefficient_fraction = 16
//! tables = [[[0, 25420], [4, 40116]], [[0, 65536]]]    # each a list of [delay in samples, coefficient]
//! ```
//!
//! The first table of an axis is active at the start; the others can be chosen while it moves. What is read is checked
//! as everything of a machine file is: sizes and sums of the tables, and that the shaper of the hardware holds them.

use crate::rtl::shaper::{ShaperConfig, ShaperConfigError, ShaperMotion};
use crate::taps::{Tap, TapTable, TapTableError};
use serde::{Deserialize, Serialize};

/// The shapers of all axes of a machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ShaperTables {
    /// Rate of the samples in Hz.
    pub sample_hz: f64,
    /// The axes, in the order of the machine file.
    #[serde(rename = "axis")]
    pub axes: Vec<AxisShaperTables>,
}

/// The shaper of an axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxisShaperTables {
    /// Name of the axis.
    pub name: String,
    /// Command words per unit of the controller's position, for example per mm.
    pub lsb_per_unit: f64,
    /// Width of a command word in bits.
    pub word_bits: u32,
    /// Whether the position wraps at the ends of the word.
    pub modulo: bool,
    /// Fraction bits F of all coefficients.
    pub coefficient_fraction: u32,
    /// The tables, each a list of delay in samples and coefficient.
    pub tables: Vec<Vec<(u32, i32)>>,
}

/// Why a text is not a file of shapers.
#[derive(Debug, thiserror::Error)]
pub enum ShaperTablesError {
    /// It is not TOML, or has other keys.
    #[error("not a file of shapers that `posicast generate --hal` writes: {0}")]
    Form(#[from] toml::de::Error),
    /// A number that is not positive and finite.
    #[error("`{key}` is {found}; it is above 0 and finite")]
    Positive {
        /// The key.
        key: &'static str,
        /// What was found.
        found: f64,
    },
    /// There is nothing to shape with.
    #[error("axis `{0}` has no table; it has at least one")]
    NoTable(String),
    /// A list of taps is not a table.
    #[error("axis `{axis}`, table {table}: {source}")]
    Table {
        /// The axis.
        axis: String,
        /// Place of the table, from 0.
        table: usize,
        /// The rule that it breaks.
        source: TapTableError,
    },
    /// The shaper of the hardware would not hold the tables.
    #[error("axis `{axis}`: {source}")]
    Size {
        /// The axis.
        axis: String,
        /// The size.
        source: ShaperConfigError,
    },
}

impl ShaperTables {
    /// Reads a file's text and checks it.
    ///
    /// # Errors
    /// [`ShaperTablesError`] says what was found and what is allowed.
    pub fn parse(text: &str) -> Result<Self, ShaperTablesError> {
        let read: Self = toml::from_str(text)?;
        positive("sample_hz", read.sample_hz)?;
        for axis in &read.axes {
            positive("lsb_per_unit", axis.lsb_per_unit)?;
            axis.shaper()?;
        }
        Ok(read)
    }

    /// The text of a file with these shapers.
    pub fn text(&self) -> String {
        let mut text = format!("sample_hz = {:?}\n", self.sample_hz);
        for axis in &self.axes {
            text += &format!(
                "\n[[axis]]\nname = {:?}\nlsb_per_unit = {:?}\nword_bits = {}\nmodulo = {}\ncoefficient_fraction = {}\ntables = [\n",
                axis.name, axis.lsb_per_unit, axis.word_bits, axis.modulo, axis.coefficient_fraction
            );
            for table in &axis.tables {
                let taps: Vec<String> = table
                    .iter()
                    .map(|(delay, coefficient)| format!("[{delay}, {coefficient}]"))
                    .collect();
                text += &format!("    [{}],\n", taps.join(", "));
            }
            text += "]\n";
        }
        text
    }
}

impl AxisShaperTables {
    /// The shaper of the hardware with room for all tables, and the tables; one channel, the position.
    ///
    /// # Errors
    /// [`ShaperTablesError`] for a list that is no table, and for one that no hardware holds.
    pub fn shaper(&self) -> Result<(ShaperConfig, Vec<TapTable>), ShaperTablesError> {
        let tables = self.tables.iter().enumerate().map(|(table, taps)| {
            let taps = taps.iter().map(|&(delay_samples, coefficient)| Tap {
                delay_samples,
                coefficient,
            });
            TapTable::new(self.coefficient_fraction, taps.collect()).map_err(|source| ShaperTablesError::Table {
                axis: self.name.clone(),
                table,
                source,
            })
        });
        let tables = tables.collect::<Result<Vec<TapTable>, _>>()?;
        let Some(first) = tables.first() else {
            return Err(ShaperTablesError::NoTable(self.name.clone()));
        };
        let longest = tables.iter().map(TapTable::longest_delay_samples).max().unwrap_or(0);
        let most = tables.iter().map(|table| table.taps().len()).max().unwrap_or(0);
        let motion = ShaperMotion {
            channels: 1,
            modulo: self.modulo,
        };
        let config = ShaperConfig::new(self.word_bits, first.clone())
            .and_then(|config| config.with_room_for(longest, most))
            .and_then(|config| config.for_motion(motion))
            .map_err(|source| ShaperTablesError::Size {
                axis: self.name.clone(),
                source,
            })?;
        Ok((config, tables))
    }
}

fn positive(key: &'static str, found: f64) -> Result<(), ShaperTablesError> {
    match found.is_finite() && found > 0.0 {
        true => Ok(()),
        false => Err(ShaperTablesError::Positive { key, found }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis() -> AxisShaperTables {
        AxisShaperTables {
            name: "x".to_owned(),
            lsb_per_unit: 256e3,
            word_bits: 32,
            modulo: false,
            coefficient_fraction: 16,
            tables: vec![vec![(0, 25420), (4, 40116)], vec![(0, 65536)]],
        }
    }

    #[test]
    fn unit_what_is_written_is_read() {
        let tables = ShaperTables {
            sample_hz: 1000.0,
            axes: vec![axis(), AxisShaperTables { modulo: true, ..axis() }],
        };
        assert_eq!(ShaperTables::parse(&tables.text()).unwrap(), tables);
    }

    #[test]
    fn unit_what_is_wrong_is_named() {
        let said = |change: &dyn Fn(&mut AxisShaperTables)| {
            let mut axis = axis();
            change(&mut axis);
            let axes = vec![axis];
            let text = ShaperTables { sample_hz: 1e3, axes }.text();
            ShaperTables::parse(&text).unwrap_err().to_string()
        };
        assert!(said(&|axis| axis.tables[1][0].1 = 65535).contains("axis `x`, table 1: the coefficients sum to 65535"));
        assert!(said(&|axis| axis.tables[0][1].0 = 20000).contains("axis `x`: the longest delay is 20000"));
        assert!(said(&|axis| axis.tables.clear()).contains("has no table"));
        assert!(said(&|axis| axis.word_bits = 16).contains("command words of 16 bits"));
        assert!(said(&|axis| axis.lsb_per_unit = 0.0).contains("`lsb_per_unit` is 0"));
        let said = ShaperTables::parse("sample_hz = 1.0").unwrap_err().to_string();
        assert!(said.contains("axis"), "{said}");
    }
}
