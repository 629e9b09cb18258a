//! Logs on a uniform time grid, independent of files and units.

use std::ops::Range;

/// Course of a command between two samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Between {
    /// It is held (zero-order hold), as a digital controller's command.
    #[default]
    Held,
    /// It goes straight to the next value, as a motion that was measured.
    Straight,
}

/// Command and response of an axis, sampled together.
#[derive(Debug, Clone, PartialEq)]
pub struct PositionLog {
    /// Time between samples in seconds.
    pub sample_s: f64,
    /// Command in any unit; empty where the log has none.
    pub command: Vec<f64>,
    /// Course of the command between samples.
    pub between: Between,
    /// Response at each sample, before the command of that sample acts; as many values as commands, where there are
    /// commands.
    pub response: Vec<f64>,
    /// Samples that were not measured, in order; the values there only fill the grid.
    pub missing: Vec<Range<usize>>,
}

/// A drive's command and the position of its own motor, sampled together.
#[derive(Debug, Clone, PartialEq)]
pub struct DriveLog {
    /// Time between samples in seconds.
    pub sample_s: f64,
    /// Command of the drive, of its torque, force, current, duty or velocity, in any unit; held between samples.
    pub drive: Vec<f64>,
    /// Position of the motor at each sample, in any unit.
    pub position: Vec<f64>,
    /// Samples that were not measured, in order; the values there only fill the grid.
    pub missing: Vec<Range<usize>>,
}

/// Accelerations that a sensor on an axis measured.
#[derive(Debug, Clone, PartialEq)]
pub struct AccelerationLog {
    /// Time between samples in seconds.
    pub sample_s: f64,
    /// The directions of the sensor, each with its name and its acceleration in m/s²; all have the same number of
    /// samples.
    pub directions: Vec<(String, Vec<f64>)>,
    /// Samples that were not measured, in order; the values there only fill the grid.
    pub missing: Vec<Range<usize>>,
}

impl AccelerationLog {
    /// Writes the log in the format of printer firmware: `#time,NAME,…` in s and mm/s².
    ///
    /// # Errors
    /// The errors of the writer.
    pub fn write_csv(&self, out: &mut impl std::io::Write) -> std::io::Result<()> {
        let names: Vec<&str> = self.directions.iter().map(|(name, _)| name.as_str()).collect();
        writeln!(out, "#time,{}", names.join(","))?;
        let samples = self
            .directions
            .iter()
            .map(|(_, record)| record.len())
            .min()
            .unwrap_or(0);
        for n in 0..samples {
            write!(out, "{:.6}", n as f64 * self.sample_s)?;
            for (_, record) in &self.directions {
                write!(out, ",{:.3}", 1e3 * record[n])?;
            }
            writeln!(out)?;
        }
        Ok(())
    }
}

/// The part of some ranges of samples that lies in `range`, counted from its start.
pub(crate) fn within(ranges: &[Range<usize>], range: Range<usize>) -> Vec<Range<usize>> {
    let cut = |part: &Range<usize>| {
        let (start, end) = (part.start.max(range.start), part.end.min(range.end));
        (start < end).then(|| start - range.start..end - range.start)
    };
    ranges.iter().filter_map(cut).collect()
}
