//! ECP5: the bits are decoded with Project Trellis' database.

pub mod config;
pub mod database;
pub mod decode;
mod memory;
pub mod routing;
pub mod structure;
pub mod tools;
