//! Latencies of the supervisor, and the word that kicks its watchdog.

/// The word that kicks the watchdog: `KICK`, in ASCII.
pub const KICK: u32 = 0x4b49_434b;
/// Clocks from `clear_faults` until causes that are over are forgotten; their sources are cleared meanwhile.
pub const CLEAR_CLOCKS: u8 = 8;
/// Clocks after a reset until lines count as known: two for the synchroniser, one for the filter, one to spare.
pub const PRIMING_CLOCKS: u8 = 4;
/// Clocks from a line to the state, in addition to `filter_clocks`: two for the synchroniser, one for the filter, one
/// for the state.
pub const LINE_CLOCKS: u32 = 4;
/// Clocks from a tick to the state that follows from the checks at it: two rounds of five, and one each for the
/// findings, the cause and the state.
pub const WATCH_CLOCKS: u32 = 13;
/// Smallest number of clocks between two ticks: two rounds of checks.
pub const LEAST_TICK_CLOCKS: u32 = 10;
