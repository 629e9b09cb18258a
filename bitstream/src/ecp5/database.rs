//! What is wired to what in a device: Project Trellis' database, which comes with the tools.

use super::globals::Globals;
use super::tile_data::{Setting, Word, idle_wires, settings, switched_wires, words};
use crate::BitstreamError;
use crate::error::at;
use serde_json::Value;
use std::collections::HashMap;
use std::fs;
use std::path::Path;

/// A wire of the device.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Wire {
    /// Row of the tile at which it begins.
    pub row: u8,
    /// Column of that tile.
    pub column: u8,
    /// Its name there.
    pub name: WireName,
}

/// A name in [`Database::name`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct WireName(u32);

/// A pad.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Pad {
    /// Row of its tile.
    pub row: u8,
    /// Column of its tile.
    pub column: u8,
    /// Its letter in the tile.
    pub letter: char,
}

/// The database of a device.
#[derive(Debug)]
pub struct Database {
    globals: Globals,
    names: Names,
    /// The source of each wire that has always the same, or one while no switch is on.
    idle: HashMap<Wire, Wire>,
    /// Kinds of the tiles at a place.
    kinds: HashMap<(u8, u8), Vec<String>>,
    /// Settings of block RAMs by kind of tile and name.
    memory_settings: HashMap<(String, String), Setting>,
    /// Words of block RAMs by kind of tile and name.
    memory_words: HashMap<(String, String), Word>,
    /// Pads of the package by pin.
    pads: HashMap<String, Pad>,
}

#[derive(Debug, Default)]
struct Names {
    texts: Vec<String>,
    indices: HashMap<String, WireName>,
}

impl Names {
    fn index(&mut self, text: &str) -> WireName {
        if let Some(found) = self.indices.get(text) {
            return *found;
        }
        let name = WireName(self.texts.len() as u32);
        self.texts.push(text.to_owned());
        self.indices.insert(text.to_owned(), name);
        name
    }
}

impl Database {
    /// Reads the database of a device and a package from the folder of the family.
    ///
    /// # Errors
    /// [`BitstreamError::Io`] or [`BitstreamError::Unreadable`] for a file that is missing or of another form.
    pub fn read(folder: &Path, device: &str, package: &str) -> Result<Self, BitstreamError> {
        let file = |name: &str| json(&folder.join(device).join(name));
        let globals = Globals::read(&file("globals.json")?, device)?;
        let grid = file("tilegrid.json")?;
        let tile_names = grid.as_object().into_iter().flat_map(|grid| grid.keys());
        let tiles: Vec<(u8, u8, String)> = tile_names.filter_map(|name| place(name)).collect();
        let mut names = Names::default();
        let (mut memory_settings, mut memory_words) = (HashMap::new(), HashMap::new());
        let mut of_kind: HashMap<&str, Vec<[String; 2]>> = HashMap::new();
        for (_, _, kind) in &tiles {
            if !of_kind.contains_key(kind.as_str()) {
                let path = folder.join("tiledata").join(kind).join("bits.db");
                // Some kinds have neither switches nor fixed wires.
                let text = if path.exists() {
                    fs::read_to_string(&path).map_err(at(&path))?
                } else {
                    String::new()
                };
                for name in switched_wires(&text) {
                    globals.each_name(name, &mut |name| _ = names.index(name));
                }
                if kind.starts_with("MIB_EBR") {
                    let named = settings(&text).into_iter();
                    memory_settings.extend(named.map(|(name, setting)| ((kind.clone(), name), setting)));
                    let named = words(&text).into_iter();
                    memory_words.extend(named.map(|(name, word)| ((kind.clone(), name), word)));
                }
                of_kind.insert(kind, idle_wires(&text));
            }
        }
        let mut idle = HashMap::new();
        let mut kinds: HashMap<(u8, u8), Vec<String>> = HashMap::new();
        for (row, column, kind) in &tiles {
            for ends in &of_kind[kind.as_str()] {
                let wire = |name: &String| globals.place(*row, *column, name);
                if let [Some(sink), Some(source)] = [wire(&ends[0]), wire(&ends[1])] {
                    let [sink, source] = [sink, source].map(|(row, column, name)| Wire {
                        row,
                        column,
                        name: names.index(&name),
                    });
                    idle.entry(sink).or_insert(source);
                }
            }
            kinds.entry((*row, *column)).or_default().push(kind.clone());
        }
        let pads = file("iodb.json")?;
        let pads = pads["packages"][package].as_object().into_iter().flatten();
        let pads = pads.filter_map(|(pin, value)| {
            let pad = Pad {
                row: number(value, "row").ok()?,
                column: number(value, "col").ok()?,
                letter: value["pio"].as_str()?.chars().next()?,
            };
            Some((pin.clone(), pad))
        });
        Ok(Self {
            pads: pads.collect(),
            globals,
            names,
            idle,
            kinds,
            memory_settings,
            memory_words,
        })
    }

    /// The kinds of the tiles at a place.
    #[must_use]
    pub fn kinds(&self, row: u8, column: u8) -> &[String] {
        self.kinds.get(&(row, column)).map_or(&[], Vec::as_slice)
    }

    /// A setting of a block RAM in a kind of tile.
    #[must_use]
    pub fn memory_setting(&self, kind: &str, name: &str) -> Option<&Setting> {
        self.memory_settings.get(&(kind.to_owned(), name.to_owned()))
    }

    /// A word of a block RAM in a kind of tile.
    #[must_use]
    pub fn memory_word(&self, kind: &str, name: &str) -> Option<&Word> {
        self.memory_words.get(&(kind.to_owned(), name.to_owned()))
    }

    /// The pad of a pin.
    ///
    /// # Errors
    /// [`BitstreamError::Unreadable`] if the package has no such pin.
    pub fn pad(&self, pin: &str) -> Result<Pad, BitstreamError> {
        let pad = self.pads.get(pin).copied();
        pad.ok_or_else(|| unreadable(format!("iodb.json: no pin {pin} in the package")))
    }

    /// The wire that a tile calls by this name; `None` for a wire that the device does not have.
    ///
    /// A name may begin with the way to the tile where the wire begins: `N2E1_` is two rows up, one column to the right. Wires of the
    /// clock network belong to the device, a quadrant, a spine or a row's tap.
    #[must_use]
    pub fn wire(&self, row: u8, column: u8, name: &str) -> Option<Wire> {
        let (row, column, name) = self.globals.place(row, column, name)?;
        self.own_wire(row, column, &name)
    }

    /// The wire of this name, without a way, that begins at a tile; `None` if no wire has the name.
    #[must_use]
    pub fn own_wire(&self, row: u8, column: u8, name: &str) -> Option<Wire> {
        let name = self.names.indices.get(name).copied()?;
        Some(Wire { row, column, name })
    }

    /// A wire's name.
    #[must_use]
    pub fn name(&self, wire: Wire) -> &str {
        &self.names.texts[wire.name.0 as usize]
    }

    /// The source of a wire while none of its switches is on.
    #[must_use]
    pub fn idle(&self, wire: Wire) -> Option<Wire> {
        self.idle.get(&wire).copied()
    }
}

/// Row, column and kind of a tile by its name, such as `MIB_R25C22:MIB_EBR0`; `None` for a tile without a place.
pub(super) fn place(name: &str) -> Option<(u8, u8, String)> {
    let (place, kind) = name.split_once(':')?;
    let mut parts = place.rsplit('_');
    let (row, column) = parts.find_map(|part| part.strip_prefix('R')?.split_once('C'))?;
    Some((row.parse().ok()?, column.parse().ok()?, kind.to_owned()))
}

pub(super) fn number(value: &Value, key: &str) -> Result<u8, BitstreamError> {
    let number = value[key].as_u64().and_then(|number| u8::try_from(number).ok());
    number.ok_or_else(|| unreadable(format!("no number {key}")))
}

fn json(path: &Path) -> Result<Value, BitstreamError> {
    let text = fs::read_to_string(path).map_err(at(path))?;
    serde_json::from_str(&text).map_err(|error| unreadable(format!("{}: {error}", path.display())))
}

pub(super) fn unreadable(reason: String) -> BitstreamError {
    BitstreamError::Unreadable {
        tool: "Project Trellis' database",
        reason,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_have_their_place_in_their_name() {
        assert_eq!(place("MIB_R25C22:MIB_EBR0"), Some((25, 22, "MIB_EBR0".to_owned())));
        assert_eq!(place("R12C5:PLC2"), Some((12, 5, "PLC2".to_owned())));
        assert_eq!(place("BANKREF8:BANKREF8"), None);
    }
}
