//! Shaper design: from modes and a kind to impulses.

pub mod kind;
