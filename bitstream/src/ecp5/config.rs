//! The settings of a bitstream as text, as ecpunpack writes it: per tile its switches that are on (`arc`), its words and its settings
//! (`enum`), and the contents of the block RAMs.

use crate::BitstreamError;
use crate::report::{FlipKind, TilesReport};
use crate::toolchain::TextBit;
use std::collections::{BTreeMap, BTreeSet};

/// Name of the program that writes the text, for errors.
const TOOL: &str = "ecpunpack";

/// A bitstream's settings.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Config {
    /// Name of the device.
    pub device: String,
    /// The tiles that have settings; a group of tiles has its settings in common.
    pub tiles: Vec<TileGroup>,
    /// Contents of block RAMs by their number: words of 9 bits.
    pub memories: BTreeMap<u32, Vec<u16>>,
}

/// A tile, or several that have their settings in common.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct TileGroup {
    /// Names of the tiles: place and kind, such as `R12C5:PLC2`.
    pub names: Vec<String>,
    /// Switches that are on: the wire that is driven, and its source.
    pub arcs: Vec<[String; 2]>,
    /// Words and settings by name.
    pub settings: Vec<[String; 2]>,
    /// Bits that ecpunpack could not name.
    pub unknown: Vec<String>,
}

impl Config {
    /// Reads the text.
    ///
    /// # Errors
    /// [`BitstreamError::Unreadable`] with the first line of an unknown form.
    pub fn read(text: &str) -> Result<Self, BitstreamError> {
        let mut config = Self::default();
        let mut section = Section::None;
        for line in text.lines() {
            let words: Vec<&str> = line.split_whitespace().collect();
            let known = match (&mut section, words.as_slice()) {
                (_, [] | [".comment" | ".sysconfig" | ".metadata", ..]) => Some(()),
                (_, [".device", device]) => {
                    config.device = (*device).to_owned();
                    Some(())
                }
                (_, [".tile" | ".tile_group", names @ ..]) => {
                    section = Section::Tile;
                    config.tiles.push(TileGroup {
                        names: names.iter().map(|name| (*name).to_owned()).collect(),
                        ..TileGroup::default()
                    });
                    Some(())
                }
                (_, [".bram_init", number]) => number.parse().ok().map(|number| {
                    config.memories.insert(number, Vec::new());
                    section = Section::Memory(number);
                }),
                (Section::Tile, words) => config.tiles.last_mut().and_then(|tile| tile.add(words)),
                (Section::Memory(number), digits) => config.memories.get_mut(number).and_then(|words| {
                    let read = digits.iter().map(|digits| u16::from_str_radix(digits, 16));
                    words.extend(read.collect::<Result<Vec<_>, _>>().ok()?);
                    Some(())
                }),
                _ => None,
            };
            known.ok_or_else(|| BitstreamError::Unreadable {
                tool: TOOL,
                reason: line.to_owned(),
            })?;
        }
        Ok(config)
    }
}

impl Config {
    /// What is set, without differences.
    #[must_use]
    pub fn report(&self) -> TilesReport {
        let groups = self.tiles.iter();
        let set = groups.map(|tile| tile.arcs.len() + tile.settings.len());
        TilesReport {
            tiles: (self.tiles.len() + self.memories.len()) as u64,
            set: set.sum::<usize>() as u64,
            unnamed: self.tiles.iter().map(|tile| tile.unknown.len() as u64).sum(),
            differences: Vec::new(),
        }
    }
}

impl Config {
    /// Bits without a name outside of pads, with their tiles.
    fn unnamed(&self) -> BTreeSet<(&str, &str)> {
        let tiles = self.tiles.iter().flat_map(|tile| {
            let name = tile.names.first().map_or("", String::as_str);
            tile.unknown.iter().map(move |bit| (name, bit.as_str()))
        });
        tiles.filter(|(name, _)| !name.contains(":PIC")).collect()
    }

    /// Bits without a name, outside of pads, that the router did not write.
    #[must_use]
    pub fn unnamed_only_here(&self, routed: &Self) -> Vec<String> {
        let (ours, theirs) = (self.unnamed(), routed.unnamed());
        let here = ours.difference(&theirs);
        here.map(|(tile, bit)| format!("{tile}, bit {bit}")).collect()
    }
}

/// The lines of each tile and memory of a text.
fn sections(text: &str) -> BTreeMap<&str, Vec<&str>> {
    let mut sections: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    let mut heading = "";
    for line in text.lines().filter(|line| !line.trim().is_empty()) {
        if line.starts_with('.') {
            heading = line;
        } else {
            sections.entry(heading).or_default().push(line);
        }
    }
    sections
}

/// The tiles and memories in which two texts differ.
#[must_use]
pub fn different_tiles(text: &str, other: &str) -> Vec<String> {
    let (ours, theirs) = (sections(text), sections(other));
    let all: BTreeSet<&str> = ours.keys().chain(theirs.keys()).copied().collect();
    let differ = all
        .into_iter()
        .filter(|heading| ours.get(heading) != theirs.get(heading));
    differ
        .map(|heading| heading.trim_start_matches('.').to_owned())
        .collect()
}

/// Beginning of a line with a switch that is on.
const SWITCH: &str = "arc: ";
/// Bits of a digit of a memory's word.
const DIGIT_BITS: usize = 4;

/// The bits of this kind that a flip may change: the entries of tables that are not constant, the switches before the inputs of logic, and
/// the contents of memories.
#[must_use]
pub fn candidates(text: &str, kind: FlipKind) -> Vec<TextBit> {
    let mut bits = Vec::new();
    let mut heading = "";
    for (line, content) in text.lines().enumerate() {
        if content.starts_with('.') {
            heading = content;
            continue;
        }
        let is_logic = heading.ends_with(":PLC2");
        match kind {
            FlipKind::Table if is_logic && content.contains(".INIT ") => {
                let first = content.rfind(' ').map_or(0, |space| space + 1);
                let entries = &content[first..];
                if entries.contains('0') && entries.contains('1') {
                    bits.extend((first..content.len()).map(|column| TextBit { line, column, bit: 0 }));
                }
            }
            FlipKind::Routing if is_logic && is_logic_input(content) => {
                bits.push(TextBit {
                    line,
                    column: 0,
                    bit: 0,
                });
            }
            FlipKind::Memory if heading.starts_with(".bram_init") => {
                let digits = content.char_indices().filter(|(_, digit)| digit.is_ascii_hexdigit());
                // A word has 9 bits in three digits: the first one has one.
                let columns = digits.enumerate().filter(|(index, _)| index % 3 != 0);
                let bits_of = |(_, (column, _))| (0..DIGIT_BITS).map(move |bit| TextBit { line, column, bit });
                bits.extend(columns.flat_map(bits_of));
            }
            _ => {}
        }
    }
    bits
}

/// Whether a line is a switch that drives an input of a table or of a flip-flop.
fn is_logic_input(line: &str) -> bool {
    let sink = line.strip_prefix(SWITCH).and_then(|arc| arc.split(' ').next());
    sink.is_some_and(|sink| matches!(sink.as_bytes(), [b'A'..=b'D' | b'M', b'0'..=b'7']))
}

/// The text with one bit flipped, or with one switch left out, and its place in words.
#[must_use]
pub fn flipped(text: &str, bit: TextBit) -> (String, String) {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let heading = lines[..bit.line].iter().rfind(|line| line.starts_with('.'));
    let heading = heading.map_or("", |heading| heading.trim_start_matches('.')).to_owned();
    let line = &mut lines[bit.line];
    let place = if let Some(switch) = line.strip_prefix(SWITCH) {
        let place = format!("{heading}, switch {switch} left out");
        lines.remove(bit.line);
        place
    } else {
        let digit = u8::from_str_radix(&line[bit.column..=bit.column], 16).unwrap_or(0);
        line.replace_range(bit.column..=bit.column, &format!("{:x}", digit ^ 1 << bit.bit));
        let setting = line.split(' ').nth(1).filter(|_| line.starts_with("word:"));
        format!(
            "{heading}, {}column {}",
            setting.map_or(String::new(), |name| format!("{name}, ")),
            bit.column
        )
    };
    (lines.join("\n") + "\n", place)
}

/// The part of the text that a line belongs to.
enum Section {
    None,
    Tile,
    Memory(u32),
}

impl TileGroup {
    fn add(&mut self, words: &[&str]) -> Option<()> {
        match words {
            ["arc:", sink, source] => self.arcs.push([sink, source].map(|wire| (*wire).to_owned())),
            ["enum:" | "word:", name, value] => self.settings.push([name, value].map(|word| (*word).to_owned())),
            ["unknown:", bit, ..] => self.unknown.push((*bit).to_owned()),
            _ => return None,
        }
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_groups_and_memories_are_read_and_the_rest_is_refused() {
        let text = ".device LFE5U-25F\n\n.comment Part: x y\n\n.tile R2C3:PLC2\narc: F0 F5A_SLICE\nword: SLICEA.K0.INIT 0000000000000001\n\
                    enum: SLICEA.MODE CCU2\nunknown: F1B8\n\n.tile_group MIB_R25C22:MIB_EBR0 MIB_R25C23:MIB_EBR1\nenum: EBR0.MODE DP16KD\n\n\
                    .bram_init 3\n000 1ff\n002\n";
        let config = Config::read(text).unwrap();
        assert_eq!(config.device, "LFE5U-25F");
        assert_eq!(config.tiles[0].arcs, [["F0".to_owned(), "F5A_SLICE".to_owned()]]);
        assert_eq!((config.tiles[0].settings.len(), config.tiles[0].unknown.len()), (2, 1));
        assert_eq!(config.tiles[1].names.len(), 2);
        assert_eq!(config.memories[&3], [0, 0x1FF, 2]);
        for line in ["flip: F0", ".tiles R2C3:PLC2", "arc: F0"] {
            let error = Config::read(&format!("{text}\n.tile R9C9:PLC2\n{line}\n")).unwrap_err();
            assert!(error.to_string().contains(line), "{error}");
        }
    }
}
