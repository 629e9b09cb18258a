//! The kinds of tiles of a Gowin device: which bits of a tile mean what.

use serde::Deserialize;
use std::collections::{BTreeMap, HashMap};

/// A kind of tile. Its bits are numbers: row * width + column.
#[derive(Debug, Deserialize)]
pub struct TileKind {
    /// Columns of bits.
    pub width: usize,
    /// Rows of bits.
    pub height: usize,
    /// The sources of each wire, with the bits that switch each on.
    pub switches: BTreeMap<String, BTreeMap<String, Vec<u16>>>,
    /// The bits that cut an end of a long wire off.
    pub isolated: BTreeMap<String, Vec<u16>>,
    /// Bits that are always set.
    pub fixed: Vec<u16>,
    /// Bits with settings of the whole device and of the banks of pads, whose meaning is not read back.
    pub configuration: Vec<u16>,
    /// The bits of each look-up table: a set bit is an entry that is 0.
    pub tables: Vec<[u16; 16]>,
    /// The slices, each of two look-up tables and two flip-flops.
    pub slices: Vec<CellUses<SliceUse>>,
    /// The pads by letter.
    pub pads: BTreeMap<char, CellUses<PadUse>>,
    /// Wires of the ports of pads (`A.O`) and of the block RAM (`DO0`).
    pub ports: HashMap<String, String>,
    /// The block RAM, of which this is one of three tiles.
    pub memory: Option<CellUses<MemoryUse>>,
}

/// The uses of a cell, each with its bits.
#[derive(Debug, Deserialize)]
pub struct CellUses<U> {
    /// All bits of the cell.
    pub every: Vec<u16>,
    /// Its uses.
    pub forms: Vec<UseBits<U>>,
}

/// A use of a cell and the bits that are set then.
#[derive(Debug, Deserialize)]
pub struct UseBits<U> {
    /// The use.
    #[serde(flatten)]
    pub what: U,
    /// The bits, in ascending order.
    pub bits: Vec<u16>,
}

/// A use of a slice.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub struct SliceUse {
    /// Whether it is part of a carry chain.
    pub carry: bool,
    /// Levels of its flip-flops after configuration and after a reset.
    pub set: [bool; 2],
    /// Their reset; without one, the bits are those of a slice without flip-flops.
    pub reset: Option<SliceReset>,
    /// Whether they take the falling edge.
    pub inverted: bool,
}

/// The reset of a slice.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SliceReset {
    /// At the clock.
    Synchronous,
    /// At once.
    Asynchronous,
}

/// A use of a pad.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
pub struct PadUse {
    /// What for.
    #[serde(rename = "use")]
    pub direction: PadDirection,
    /// Its standard, such as `LVCMOS33`.
    #[serde(rename = "type")]
    pub standard: String,
    /// Its resistor: `NONE`, `UP` or `DOWN`.
    pub pull: String,
}

/// What a pad is used for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PadDirection {
    /// An input.
    Input,
    /// An output.
    Output,
    /// Nothing.
    None,
}

/// A use of a block RAM.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub struct MemoryUse {
    /// Its ports.
    pub kind: MemoryPorts,
    /// What the outputs of each port do in a clock in which it writes: nothing, as the data, or as the word before.
    pub modes: [u8; 2],
    /// Width of its words.
    pub width: u8,
    /// Whether its outputs have a second register.
    pub registered: bool,
    /// Whether its reset acts at once.
    pub asynchronous: bool,
}

/// The ports of a block RAM, as nextpnr names them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum MemoryPorts {
    /// One that writes, and one that reads.
    #[serde(rename = "SDP")]
    Simple,
    /// Two that write and read.
    #[serde(rename = "DP")]
    Dual,
}

impl<U> CellUses<U> {
    /// The bits of the cell that are set in its tile, in ascending order.
    pub fn used(&self, is_set: impl Fn(u16) -> bool) -> Vec<u16> {
        self.every.iter().copied().filter(|bit| is_set(*bit)).collect()
    }
}
