//! Gowin: the bits are decoded with apycula's chip database.

pub mod database;
pub mod decode;
mod flips;
pub mod frames;
pub mod kind;
pub mod memory;
mod routed;
pub mod routing;
pub mod structure;
mod table;
pub mod tiles;
pub mod tools;
