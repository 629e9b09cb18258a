//! Impulse sequences: what a shaper is before it is digitised.

/// One impulse of a shaper.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Impulse {
    /// Time after the first impulse, in seconds.
    pub time_s: f64,
    /// Amplitude; those of one sequence sum to one.
    pub amplitude: f64,
}

/// A shaper in continuous time: impulses in order of time, the first at 0, amplitudes that sum to one.
#[derive(Debug, Clone, PartialEq)]
pub struct ImpulseSequence {
    impulses: Vec<Impulse>,
}
