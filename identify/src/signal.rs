//! Logs on a uniform grid of time, free of files and of units.

/// What an axis was told and what it did, sampled together.
#[derive(Debug, Clone, PartialEq)]
pub struct PositionLog {
    /// Time between samples in seconds.
    pub sample_s: f64,
    /// Command, held constant from each sample to the next (zero-order hold), in any unit; empty where the log has none.
    pub command: Vec<f64>,
    /// Response at each sample, before the command of that sample acts; as many as there are commands, where there are any.
    pub response: Vec<f64>,
}
