//! Constraints of a simultaneous shaper.

/// Sequence of amplitudes of the impulses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Amplitudes {
    /// Amplitudes 1, −2, 2, …, with partial sums between −1 and 1.
    PartialSum,
    /// Amplitudes 1, −1, 1, …, with partial sums 0 and 1.
    UnitMagnitude,
}

impl Amplitudes {
    /// Amplitude of impulse `index`, from 0.
    pub(super) fn at(self, index: usize) -> f64 {
        let sign = if index.is_multiple_of(2) { 1.0 } else { -1.0 };
        match self {
            Amplitudes::PartialSum if index > 0 => 2.0 * sign,
            _ => sign,
        }
    }

    pub(super) fn text(self) -> &'static str {
        match self {
            Amplitudes::PartialSum => "1, -2, 2, ...",
            Amplitudes::UnitMagnitude => "1, -1, 1, ...",
        }
    }
}

/// Quantities that must be zero at a mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Constraint {
    /// The residual is zero.
    Zv,
    /// The residual and its derivatives with respect to frequency and damping are zero.
    Zvd,
}

impl Constraint {
    pub(super) fn equations(self) -> usize {
        match self {
            Constraint::Zv => 2,
            Constraint::Zvd => 4,
        }
    }
}
