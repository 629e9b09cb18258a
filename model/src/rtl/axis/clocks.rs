//! How long the supervisor takes, and the word of its watchdog.

/// The word that kicks the watchdog: `KICK`, in ASCII.
pub const KICK: u32 = 0x4b49_434b;
/// Clocks from `clear_faults` until causes that are over are forgotten: what they come from is cleared meanwhile.
pub const CLEAR_CLOCKS: u8 = 8;
/// Clocks after a reset until lines count as known: two of the synchroniser, the filter's, one to spare.
pub const PRIMING_CLOCKS: u8 = 4;
/// Clocks from a line to the state, beside `filter_clocks`: two of the synchroniser, the filter's, the state's.
pub const LINE_CLOCKS: u32 = 4;
/// Clocks from a tick to the state that follows from what is watched at it: two rounds of five, what they found,
/// the cause's, the state's.
pub const WATCH_CLOCKS: u32 = 13;
/// Clocks from a tick to the next one, at least: two rounds of what is watched.
pub const LEAST_TICK_CLOCKS: u32 = 10;
