//! Selects whether a run uses the machine's shapers.

/// The shapers in use.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shaping {
    /// The machine's tap tables.
    Shaped,
    /// A table of one tap, loaded over the bus: the command passes unchanged.
    Unshaped,
}
