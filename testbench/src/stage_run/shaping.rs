//! With the machine's shapers, and without.

/// What the shapers do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shaping {
    /// The machine's tap tables.
    Shaped,
    /// A table of one tap, loaded over the bus: the command goes through as it is.
    Unshaped,
}
