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

use crate::shaper::{ShaperConfig, ShaperConfigError, ShaperMotion};
use posicast_taps::{Tap, TapTable, TapTableError};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The shapers of all axes of a machine.
#[derive(Debug, Clone, PartialEq)]
pub struct ShaperTables {
    /// Rate of the samples in Hz.
    pub sample_hz: f64,
    /// The axes, in the order of the machine file.
    pub axes: Vec<AxisShaperTables>,
}

/// The shaper of an axis.
#[derive(Debug, Clone, PartialEq)]
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
    /// It is not TOML.
    #[error("not a file of shapers that `posicast generate --hal` writes: {0}")]
    Toml(#[from] toml::de::Error),
    /// A key is missing, not known, or has a value of another form.
    #[error("not a file of shapers that `posicast generate --hal` writes: {0}")]
    Form(String),
    /// A number that is not positive and finite.
    #[error("`{key}` is {found}; it is above 0 and finite")]
    Positive {
        /// The key.
        key: &'static str,
        /// The value that was found.
        found: f64,
    },
    /// An axis has no table.
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
    /// [`ShaperTablesError`] with the value that was found and the allowed ones.
    pub fn parse(text: &str) -> Result<Self, ShaperTablesError> {
        let document = DeTable::parse(text)?;
        let file = Keys(document.get_ref());
        file.only(&["sample_hz", "axis"])?;
        let axes = file.read("axis", "tables [[axis]]", tables_of)?;
        let read = Self {
            sample_hz: file.read("sample_hz", "a number", number)?,
            axes: axes.into_iter().map(AxisShaperTables::read).collect::<Result<_, _>>()?,
        };
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
    fn read(axis: Keys<'_>) -> Result<Self, ShaperTablesError> {
        axis.only(&[
            "name",
            "lsb_per_unit",
            "word_bits",
            "modulo",
            "coefficient_fraction",
            "tables",
        ])?;
        Ok(Self {
            name: axis.read("name", "a text", |value| value.as_str().map(str::to_owned))?,
            lsb_per_unit: axis.read("lsb_per_unit", "a number", number)?,
            word_bits: axis.read("word_bits", "a whole number", integer)?,
            modulo: axis.read("modulo", "true or false", DeValue::as_bool)?,
            coefficient_fraction: axis.read("coefficient_fraction", "a whole number", integer)?,
            tables: axis.read("tables", "lists of [delay, coefficient]", |tables| {
                list(tables, |table| list(table, tap))
            })?,
        })
    }

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

/// The keys of a table of the file. Read by hand: the component for LinuxCNC runs in a real-time thread and gets few libraries.
#[derive(Clone, Copy)]
struct Keys<'d>(&'d DeTable<'d>);

impl<'d> Keys<'d> {
    fn only(self, known: &[&str]) -> Result<(), ShaperTablesError> {
        let unknown = self.0.keys().find(|key| !known.contains(&key.get_ref().as_ref()));
        unknown.map_or(Ok(()), |key| {
            let known = known.join(", ");
            Err(ShaperTablesError::Form(format!(
                "unknown key `{}`; allowed: {known}",
                key.get_ref()
            )))
        })
    }

    fn read<T>(
        self,
        key: &str,
        form: &str,
        read: impl FnOnce(&'d DeValue<'d>) -> Option<T>,
    ) -> Result<T, ShaperTablesError> {
        let value = self.0.get(key).map(Spanned::get_ref);
        let value = value.ok_or_else(|| ShaperTablesError::Form(format!("the key `{key}` is missing")))?;
        read(value).ok_or_else(|| ShaperTablesError::Form(format!("`{key}` is not {form}")))
    }
}

fn number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Float(float) => float.as_str().parse().ok(),
        whole => integer::<i64>(whole).map(|whole| whole as f64),
    }
}

fn integer<T: TryFrom<i64>>(value: &DeValue<'_>) -> Option<T> {
    let digits = value.as_integer()?;
    T::try_from(i64::from_str_radix(digits.as_str(), digits.radix()).ok()?).ok()
}

/// A tap as `[delay in samples, coefficient]`.
fn tap(value: &DeValue<'_>) -> Option<(u32, i32)> {
    let numbers: Vec<i64> = list(value, integer)?;
    let [delay, coefficient] = numbers.try_into().ok()?;
    Some((u32::try_from(delay).ok()?, i32::try_from(coefficient).ok()?))
}

fn list<'d, T>(value: &'d DeValue<'d>, entry: impl Fn(&'d DeValue<'d>) -> Option<T>) -> Option<Vec<T>> {
    value.as_array()?.iter().map(|value| entry(value.get_ref())).collect()
}

fn tables_of<'d>(value: &'d DeValue<'d>) -> Option<Vec<Keys<'d>>> {
    list(value, |axis| axis.as_table().map(Keys))
}

fn positive(key: &'static str, found: f64) -> Result<(), ShaperTablesError> {
    if found.is_finite() && found > 0.0 {
        Ok(())
    } else {
        Err(ShaperTablesError::Positive { key, found })
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
    fn what_is_written_is_read() {
        let tables = ShaperTables {
            sample_hz: 1000.0,
            axes: vec![axis(), AxisShaperTables { modulo: true, ..axis() }],
        };
        assert_eq!(ShaperTables::parse(&tables.text()).unwrap(), tables);
    }

    #[test]
    fn invalid_tables_are_errors_that_name_the_cause() {
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
        let text = ShaperTables {
            sample_hz: 1e3,
            axes: vec![axis()],
        }
        .text();
        for (from, to, said) in [
            ("name = \"x\"\n", "", "the key `name` is missing"),
            (
                "word_bits = 32",
                "word_bits = 32.0",
                "`word_bits` is not a whole number",
            ),
            ("word_bits = 32", "word_bits = -1", "`word_bits` is not a whole number"),
            ("modulo = false", "modulo = 0", "`modulo` is not true or false"),
            ("modulo = false", "modulus = false", "unknown key `modulus`"),
            ("[4, 40116]", "[4]", "`tables` is not lists of [delay, coefficient]"),
            (
                "[4, 40116]",
                "[-4, 40116]",
                "`tables` is not lists of [delay, coefficient]",
            ),
            ("[[axis]]", "[axis]", "`axis` is not tables [[axis]]"),
            ("sample_hz = 1000.0", "sample_hz =", "expected"),
        ] {
            assert!(text.contains(from), "{text}");
            let found = ShaperTables::parse(&text.replace(from, to)).unwrap_err().to_string();
            assert!(found.contains(said), "{found}");
        }
        let said = ShaperTables::parse("sample_hz = 1.0").unwrap_err().to_string();
        assert!(said.contains("axis"), "{said}");
        assert_eq!(
            ShaperTables::parse(&text.replace("1000.0", "1_000")).unwrap().sample_hz,
            1e3
        );
    }
}
