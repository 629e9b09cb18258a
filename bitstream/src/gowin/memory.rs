//! A block RAM of a Gowin device: port A writes, and port B reads words of the same width.
//!
//! Its contents lie in frames behind those of the device, 256 for each row of block RAMs. A word of 18 bits has its bits in one of them; the
//! lowest two bits of its address choose a quarter, and the highest two the columns.

use super::database::GowinDatabase;
use super::decode::{GowinDecoder, unknown};
use super::frames::GowinFrames;
use super::kind::MemoryUse;
use super::routing::{GowinOutput, GowinPort, GowinRouting, GowinSource, MEMORY_OUTPUTS};
use crate::BitstreamError;
use crate::network::{BlockRam, HIGH, LOW, NetIndex, RamPort, RamWrite};
use crate::toolchain::TextBit;

/// Words of 18 bits.
pub(super) const WORDS: usize = 1024;
/// Bits of such a word.
pub(super) const WORD_BITS: usize = 18;
/// Frames of a row of block RAMs.
const ROW_FRAMES: usize = 256;
/// Tiles of a block RAM.
const TILES: u8 = 3;
/// Bits of an address, of which those of a single bit are the lowest.
const ADDRESS_BITS: u8 = 14;
/// Bits of a part of a word with an enable of its own.
const PART_BITS: u8 = 9;

/// The contents of the block RAMs.
#[derive(Debug, Clone, Copy)]
pub struct StoredContents<'a> {
    /// The file.
    pub frames: &'a GowinFrames,
    /// The database of its device.
    pub database: &'a GowinDatabase,
}

impl StoredContents<'_> {
    /// The row and column of the file's bits with a bit of a block RAM; `None` in a file without contents.
    fn place(&self, (row, column): (u8, u8), word: usize, bit: usize) -> Option<(usize, usize)> {
        const QUARTERS: [usize; 4] = [0x00, 0x80, 0x40, 0xC0];
        let rows = self.database.memory_rows();
        let index = rows.iter().position(|of| *of == row)?;
        let frame = QUARTERS[word & 3] + (word >> 2 & 0x3F);
        let frame = ROW_FRAMES * index + ROW_FRAMES - 1 - frame;
        let (_, left) = self.database.corner(row, column);
        let column = left + self.database.memory_column(bit, word >> 8)?;
        (frame < self.frames.memory_frames()).then(|| (self.database.bits().0 + frame, column))
    }

    /// The contents of a block RAM: words of 18 bits.
    pub(super) fn words(&self, place: (u8, u8)) -> Vec<u64> {
        let word = |word| {
            let bits = (0..WORD_BITS).filter(|bit| {
                let at = self.place(place, word, *bit);
                at.is_some_and(|(row, column)| self.frames.bit(row, column))
            });
            bits.fold(0, |value, bit| value | 1 << bit)
        };
        (0..WORDS).map(word).collect()
    }

    /// The digits of the contents of a block RAM.
    pub(super) fn digits(&self, place: (u8, u8)) -> Vec<TextBit> {
        let bits = (0..WORDS).flat_map(|word| (0..WORD_BITS).map(move |bit| (word, bit)));
        bits.filter_map(|(word, bit)| self.place(place, word, bit))
            .map(|(row, column)| self.frames.place(row, column))
            .collect()
    }
}

/// The uses of a block RAM, which the bits of its three tiles say together: those that differ do so in what is not in use here.
///
/// # Errors
/// [`BitstreamError::UnknownCell`] for other uses than words of 9, 18 or 36 bits without output registers.
pub(super) fn uses(routing: &GowinRouting<'_>, (row, column): (u8, u8)) -> Result<Vec<MemoryUse>, BitstreamError> {
    let refused = |what: &str| {
        Err(BitstreamError::UnknownCell(format!(
            "R{row}C{column} block RAM: {what}"
        )))
    };
    let tiles = (column..column + TILES).map(|column| {
        let settings = routing.tiles().tile_settings(row, column);
        settings.map_or(&[][..], |settings| settings.memory.as_slice())
    });
    let tiles: Vec<&[MemoryUse]> = tiles.collect();
    let common = tiles[0]
        .iter()
        .filter(|one| tiles.iter().all(|uses| uses.contains(one)));
    let common: Vec<MemoryUse> = common.copied().collect();
    let Some(first) = common.first() else {
        return refused("a use that is not known");
    };
    let what = |of: &MemoryUse| (of.width, of.registered, of.asynchronous);
    if common.iter().any(|other| what(other) != what(first)) {
        return refused("bits that several uses have");
    }
    if first.registered {
        return refused("a second register at its outputs");
    }
    if !first.width.is_multiple_of(PART_BITS) {
        return refused(&format!("words of {} bits", first.width));
    }
    Ok(common)
}

/// The width of the words of a block RAM.
fn width(routing: &GowinRouting<'_>, place: (u8, u8)) -> Result<u8, BitstreamError> {
    Ok(uses(routing, place)?[0].width)
}

/// The outputs with a word, lowest bit first: narrow words come out at the upper half.
fn outputs(width: u8) -> impl Iterator<Item = u8> {
    let first = if width == MEMORY_OUTPUTS { 0 } else { MEMORY_OUTPUTS / 2 };
    first..first + width
}

/// The lowest bit of an address that selects a word: the bits below it are enables of a word's parts, or not in use.
fn first_address_bit(width: u8) -> u8 {
    match width {
        36 => 5,
        18 => 4,
        _ => 3,
    }
}

pub(super) fn decode(
    decoder: &mut GowinDecoder<'_>,
    stored: &StoredContents<'_>,
    place: (u8, u8),
) -> Result<BlockRam, BitstreamError> {
    let (row, column) = place;
    let routing = decoder.routing;
    let width = width(routing, place)?;
    let of = GowinOutput {
        row,
        column,
        port: GowinPort::Memory(0),
    };
    let source = |port: &str| port_source(routing, place, port);
    for (port, level) in constant_ports(width) {
        if source(port)? != GowinSource::Constant(level) {
            return Err(unknown(
                of,
                &format!("{port} of the memory is not always {}", u8::from(level)),
            ));
        }
    }
    let mut net = |port: &str| {
        let source = port_source(routing, place, port)?;
        decoder.driven(source, of)
    };
    let address = |letter: char, net: &mut dyn FnMut(&str) -> Result<NetIndex, BitstreamError>| {
        let bits = first_address_bit(width)..ADDRESS_BITS;
        bits.map(|bit| net(&format!("AD{letter}{bit}")))
            .collect::<Result<Vec<_>, _>>()
    };
    let (write_address, read_address) = (address('A', &mut net)?, address('B', &mut net)?);
    let parts = match width / PART_BITS {
        1 => vec![HIGH],
        parts => (0..parts)
            .map(|part| net(&format!("ADA{part}")))
            .collect::<Result<_, _>>()?,
    };
    let [write_clock, write_enable, write] = ["CLKA", "CEA", "WREA"].map(&mut net);
    let [read_clock, read_enable] = ["CLKB", "CEB"].map(&mut net);
    // A bit that nothing drives is not written, and must not be read.
    let mut data = Vec::new();
    let mut read = Vec::new();
    for (bit, output) in outputs(width).enumerate() {
        let port = GowinPort::Memory(output);
        let source = port_source(routing, place, &format!("DI{bit}"))?;
        if source == GowinSource::Nothing {
            data.push(LOW);
            read.push(decoder.network.new_net(format!("r{row}c{column}_unwritten{output}")));
        } else {
            data.push(decoder.driven(source, of)?);
            read.push(decoder.net(GowinOutput { port, ..of }));
        }
    }
    let words = stored.words(place);
    let contents = match width {
        36 => words.chunks(2).map(|pair| pair[0] | pair[1] << WORD_BITS).collect(),
        18 => words,
        _ => words
            .iter()
            .flat_map(|word| [word & 0x1FF, word >> PART_BITS])
            .collect(),
    };
    Ok(BlockRam {
        name: format!("r{row}c{column}_memory"),
        bits: u32::from(width),
        contents,
        ports: vec![
            RamPort {
                clock: write_clock?,
                enable: write_enable?,
                address: write_address,
                write: Some(RamWrite {
                    enable: write?,
                    data,
                    parts,
                }),
                outputs: Vec::new(),
            },
            RamPort {
                clock: read_clock?,
                enable: read_enable?,
                address: read_address,
                write: None,
                outputs: read,
            },
        ],
    })
}

/// Ports that must have a level: without it, the memory does something else.
fn constant_ports(width: u8) -> [(&'static str, bool); 8] {
    [
        ("BLKSELA0", false),
        ("BLKSELA1", false),
        ("BLKSELA2", false),
        ("BLKSELB0", false),
        ("BLKSELB1", false),
        ("BLKSELB2", false),
        ("RESETB", false),
        // Words of 36 bits take both ports' halves, as if both wrote; the other port of narrower words must not write.
        ("WREB", width == MEMORY_OUTPUTS),
    ]
}

/// What drives a port of a block RAM.
pub(super) fn port_source(
    routing: &GowinRouting<'_>,
    (row, column): (u8, u8),
    port: &str,
) -> Result<GowinSource, BitstreamError> {
    let kind = routing.database().kind(row, column);
    let wire = kind.and_then(|kind| kind.ports.get(port));
    match wire {
        Some(wire) => routing.source(row, column, wire),
        None => Err(BitstreamError::UnknownCell(format!(
            "R{row}C{column} block RAM: a port {port}"
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_have_as_many_address_bits_as_there_are() {
        for (width, words) in [(9, 2048), (18, 1024), (36, 512)] {
            assert_eq!(1 << (ADDRESS_BITS - first_address_bit(width)), words);
            assert_eq!(outputs(width).count(), usize::from(width));
            assert!(outputs(width).all(|bit| bit < MEMORY_OUTPUTS));
        }
    }
}
