//! What fails in a case, and what came of it.

/// What fails.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Nothing.
    None,
    /// Bytes are lost, doubled, changed, invented, in both directions.
    Bytes,
    /// The line is cut for a while.
    Cut,
    /// The line is cut for ever.
    CutForEver,
    /// Noise and breaks for a while.
    Noise,
    /// The host dies in the middle of a frame.
    HostDies,
    /// The same, and another host starts.
    HostRestarts,
    /// The same, on a line that damages bytes.
    RestartWithBytes,
    /// The servo thread sends an entry late.
    Late,
    /// The servo thread sends no more entries.
    Missing,
}

impl Kind {
    pub(crate) const ALL: [Self; 10] = [
        Self::None,
        Self::Bytes,
        Self::Cut,
        Self::CutForEver,
        Self::Noise,
        Self::HostDies,
        Self::HostRestarts,
        Self::RestartWithBytes,
        Self::Late,
        Self::Missing,
    ];

    /// Whether a second host starts.
    pub(super) fn restarts(self) -> bool {
        matches!(self, Self::HostRestarts | Self::RestartWithBytes)
    }

    /// Whether the host is a servo thread.
    pub(super) fn streams(self) -> bool {
        matches!(self, Self::Late | Self::Missing)
    }

    /// Its name in the table.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Bytes => "line: bytes damaged",
            Self::Cut => "line: cut for a while",
            Self::CutForEver => "line: cut",
            Self::Noise => "line: noise and breaks",
            Self::HostDies => "host: dies in a frame",
            Self::HostRestarts => "host: dies and restarts",
            Self::RestartWithBytes => "host: the same, bytes damaged",
            Self::Late => "servo thread: late entry",
            Self::Missing => "servo thread: no more entries",
        }
    }
}

/// Result of a case.
#[derive(Debug, Clone)]
pub(crate) struct Outcome {
    pub(crate) kind: Kind,
    /// Whether the move came to its target.
    pub(crate) arrived: bool,
    /// Bytes that were damaged or lost.
    pub(crate) faults: u64,
    /// Words written to the bus.
    pub(crate) writes: usize,
    /// Ticks from the last byte of the last host to outputs off; `None` where it switched them off itself.
    pub(crate) off_ticks: Option<u64>,
    /// What was not as required.
    pub(crate) failures: Vec<String>,
}
