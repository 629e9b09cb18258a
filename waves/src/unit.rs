//! Units of time that every viewer reads correctly.
//!
//! A unit is always a second divided by a power of 1000. VCD also allows ten and a hundred of these, but viewers
//! disagree on them: GTKWave multiplies the times of such a file but not those of its session file, which then opens
//! at a wrong time.

use vcd::TimescaleUnit;

/// The units, coarsest first, and the number of femtoseconds in each.
const UNITS: [(TimescaleUnit, u64); 6] = [
    (TimescaleUnit::S, 1_000_000_000_000_000),
    (TimescaleUnit::MS, 1_000_000_000_000),
    (TimescaleUnit::US, 1_000_000_000),
    (TimescaleUnit::NS, 1_000_000),
    (TimescaleUnit::PS, 1_000),
    (TimescaleUnit::FS, 1),
];

/// Returns the coarsest unit that divides `fs` femtoseconds without remainder, and its number of femtoseconds.
pub fn unit_for(fs: u64) -> (TimescaleUnit, u64) {
    let fitting = UNITS
        .into_iter()
        .find(|(_, unit)| fs >= *unit && fs.is_multiple_of(*unit));
    fitting.unwrap_or((TimescaleUnit::FS, 1))
}
