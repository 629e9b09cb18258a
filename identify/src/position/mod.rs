//! Modes from a position log: time, command, response.
