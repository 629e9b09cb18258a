//! ECP5: the bits are decoded with Project Trellis' database.

pub mod config;
pub mod database;
pub mod decode;
mod distributed_ram;
mod globals;
mod memory;
mod pads;
mod routed;
pub mod routing;
mod slice;
pub mod structure;
mod tile_data;
pub mod tools;
