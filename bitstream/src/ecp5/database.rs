//! What is wired to what in a device: Project Trellis' database, which comes with the tools.

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

/// A word in a kind of tile, which has the bits of a part of it.
#[derive(Debug, Default)]
pub struct Word {
    /// The word of a device without settings: its highest bit comes first.
    pub default: String,
    /// Whether its bits, the lowest first, are in the tile.
    pub is_here: Vec<bool>,
}

/// A setting in a kind of tile: its values, each with its bits there.
#[derive(Debug, Default)]
pub struct Setting {
    /// The value of a device without settings.
    default: String,
    /// Values and their bits.
    values: Vec<(String, Vec<String>)>,
}

impl Setting {
    /// The values that a tile shows as this one, because they have the same bits there; `None` for the default, which is not shown.
    #[must_use]
    pub fn values_like(&self, shown: Option<&str>) -> Vec<&str> {
        let shown = shown.unwrap_or(&self.default);
        let bits = self
            .values
            .iter()
            .find(|(value, _)| value == shown)
            .map(|(_, bits)| bits);
        let like = self.values.iter().filter(|(_, other)| Some(other) == bits);
        like.map(|(value, _)| value.as_str()).collect()
    }
}

/// The wires that do not belong to a tile: those of the clock network.
#[derive(Debug)]
struct Globals {
    /// Size in the names of wires of the device's clock network, such as `25K_`.
    size: String,
    quadrants: Vec<Quadrant>,
    /// Columns that the left and the right half of a row's clock tap serve.
    taps: Vec<Tap>,
    /// Place of the spine of a quadrant and a tap's column.
    spines: HashMap<String, (u8, u8)>,
}

#[derive(Debug)]
struct Quadrant {
    name: String,
    columns: [u8; 2],
    rows: [u8; 2],
}

#[derive(Debug)]
struct Tap {
    column: u8,
    left: [u8; 2],
    right: [u8; 2],
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

impl Globals {
    fn read(file: &Value, device: &str) -> Result<Self, BitstreamError> {
        let rows = |key: &str| file[key].as_object().into_iter().flatten();
        let span = |value: &Value, keys: [&str; 2]| Ok([number(value, keys[0])?, number(value, keys[1])?]);
        let quadrants = rows("quadrants").map(|(name, value)| {
            Ok(Quadrant {
                name: name.clone(),
                columns: span(value, ["x0", "x1"])?,
                rows: span(value, ["y0", "y1"])?,
            })
        });
        let taps = rows("taps").map(|(name, value)| {
            let column = name.strip_prefix('C').and_then(|column| column.parse().ok());
            Ok(Tap {
                column: column.ok_or_else(|| unreadable("globals.json: a tap without a column".to_owned()))?,
                left: span(value, ["lx0", "lx1"])?,
                right: span(value, ["rx0", "rx1"])?,
            })
        });
        let spines = rows("spines").map(|(name, value)| Ok((name.clone(), (number(value, "y")?, number(value, "x")?))));
        Ok(Self {
            // LFE5U-25F has the clock network of 25K, and so has the 12F.
            size: match device.rsplit('-').next() {
                Some("45F") => "45K_",
                Some("85F") => "85K_",
                _ => "25K_",
            }
            .to_owned(),
            quadrants: quadrants.collect::<Result<_, BitstreamError>>()?,
            taps: taps.collect::<Result<_, BitstreamError>>()?,
            spines: spines.collect::<Result<_, BitstreamError>>()?,
        })
    }

    /// Row and column of a wire that a tile calls by this name, and its name there.
    fn place(&self, row: u8, column: u8, name: &str) -> Option<(u8, u8, String)> {
        let digits = name.len() > 4 && name.as_bytes()[..2].iter().all(u8::is_ascii_digit) && &name[2..4] == "K_";
        let name = if digits {
            name.strip_prefix(self.size.as_str())?
        } else {
            name
        };
        if let Some(rest) = name.strip_prefix("G_HPBX") {
            let within = |span: &[u8; 2]| (span[0]..=span[1]).contains(&column);
            let side = |tap: &Tap| {
                let sides = [("L", &tap.left), ("R", &tap.right)];
                let side = sides.into_iter().find(|(_, span)| within(span))?;
                Some((tap.column, side.0))
            };
            let (tap, side) = self.taps.iter().find_map(side)?;
            return Some((row, tap, format!("{side}_HPBX{rest}")));
        }
        if name.starts_with("G_VPTX") {
            let spine = self.spines.get(&format!("{}{column}", self.quadrant(row, column)?));
            let (row, column) = spine.copied().unwrap_or((row, column));
            return Some((row, column, name.to_owned()));
        }
        if let Some(rest) = name.strip_prefix("G_HPRX") {
            let clock: u8 = rest.get(..2)?.parse().ok()?;
            return Some((0, 0, format!("G_{}PCLK{clock}", self.quadrant(row, column)?)));
        }
        if name.starts_with("G_") {
            return Some((0, 0, name.to_owned()));
        }
        if name.starts_with("L_HPBX") || name.starts_with("R_HPBX") {
            return Some((row, column, name.to_owned()));
        }
        let (rows, columns, name) = way(name);
        let moved = |from: u8, by: i16| u8::try_from(i16::from(from) + by).ok();
        Some((moved(row, rows)?, moved(column, columns)?, name.to_owned()))
    }

    /// Calls `each` with the names that [`place`](Self::place) gives a wire of this name in the tiles.
    fn each_name(&self, name: &str, each: &mut dyn FnMut(&str)) {
        if let Some(rest) = name.strip_prefix("G_HPBX") {
            for side in ["L", "R"] {
                each(&format!("{side}_HPBX{rest}"));
            }
        } else if name.starts_with("G_HPRX") {
            for quadrant in &self.quadrants {
                let place = self.place(quadrant.rows[0], quadrant.columns[0], name);
                place.iter().for_each(|(_, _, name)| each(name));
            }
        } else if name.starts_with("G_VPTX") {
            each(name);
        } else if let Some((_, _, name)) = self.place(u8::MAX / 2, u8::MAX / 2, name) {
            each(&name);
        }
    }

    fn quadrant(&self, row: u8, column: u8) -> Option<&str> {
        let within = |span: &[u8; 2], value: u8| (span[0]..=span[1]).contains(&value);
        let mut quadrants = self.quadrants.iter();
        let found = quadrants.find(|one| within(&one.columns, column) && within(&one.rows, row));
        found.map(|one| one.name.as_str())
    }
}

/// The wires of a kind of tile that always have the same source, and the source of the others while no switch is on: a wire and its source,
/// by their names in the tile.
fn idle_wires(text: &str) -> Vec<[String; 2]> {
    let (mut fixed, mut idle, mut sink) = (Vec::new(), Vec::new(), None);
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words.as_slice() {
            [] => sink = None,
            [".mux", wire] => sink = Some(*wire),
            // The outputs for production tests share the wires of blocks.
            [".fixed_conn", _, source] if source.ends_with("_CIBTEST") => {}
            [".fixed_conn", sink, source] => fixed.push([sink, source].map(|wire| (*wire).to_owned())),
            [source, "-"] => idle.extend(sink.map(|sink| [sink, source].map(str::to_owned))),
            _ => {}
        }
    }
    fixed.append(&mut idle);
    fixed
}

/// All wires of a kind of tile that a switch can join.
fn switched_wires(text: &str) -> impl Iterator<Item = &str> {
    let mut is_switch = false;
    text.lines().filter_map(move |line| {
        let mut words = line.split_whitespace();
        match words.next() {
            Some(".mux") => {
                is_switch = true;
                words.next()
            }
            Some(".fixed_conn") => words.next_back(),
            Some(source) if is_switch && !source.starts_with('.') => Some(source),
            _ => {
                is_switch = false;
                None
            }
        }
    })
}

/// The settings of a kind of tile by their names.
fn settings(text: &str) -> HashMap<String, Setting> {
    let mut settings: HashMap<String, Setting> = HashMap::new();
    let mut current = None;
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        match (words.as_slice(), &current) {
            ([".config_enum", name, default @ ..], _) => {
                let setting = settings.entry((*name).to_owned()).or_default();
                setting.default = default.first().copied().unwrap_or_default().to_owned();
                current = Some((*name).to_owned());
            }
            ([], _) => current = None,
            ([value, bits @ ..], Some(name)) if !value.starts_with('.') => {
                let bits = bits.iter().filter(|bit| **bit != "-").map(|bit| (*bit).to_owned());
                if let Some(setting) = settings.get_mut(name) {
                    setting.values.push(((*value).to_owned(), bits.collect()));
                }
            }
            _ => {}
        }
    }
    settings
}

/// The words of a kind of tile by their names.
fn words(text: &str) -> HashMap<String, Word> {
    let mut words: HashMap<String, Word> = HashMap::new();
    let mut current = None;
    for line in text.lines() {
        match (line.split_whitespace().collect::<Vec<_>>().as_slice(), &current) {
            ([".config", name, default @ ..], _) => {
                let word = words.entry((*name).to_owned()).or_default();
                word.default = default.first().copied().unwrap_or_default().to_owned();
                current = Some((*name).to_owned());
            }
            ([], _) => current = None,
            (bits, Some(name)) => {
                if let Some(word) = words.get_mut(name) {
                    word.is_here.push(*bits != ["-"]);
                }
            }
            _ => {}
        }
    }
    words
}

/// Row, column and kind of a tile by its name, such as `MIB_R25C22:MIB_EBR0`; `None` for a tile without a place.
pub(super) fn place(name: &str) -> Option<(u8, u8, String)> {
    let (place, kind) = name.split_once(':')?;
    let mut parts = place.rsplit('_');
    let (row, column) = parts.find_map(|part| part.strip_prefix('R')?.split_once('C'))?;
    Some((row.parse().ok()?, column.parse().ok()?, kind.to_owned()))
}

/// The way at the beginning of a wire's name, as rows down and columns to the right, and the rest of the name.
fn way(name: &str) -> (i16, i16, &str) {
    let Some((first, rest)) = name.split_once('_') else {
        return (0, 0, name);
    };
    let mut way = [0, 0];
    let mut part = first.chars();
    while let Some(direction) = part.next() {
        let rest = part.as_str();
        let digits = rest.find(|digit: char| !digit.is_ascii_digit()).unwrap_or(rest.len());
        let Ok(steps) = rest[..digits].parse::<i16>() else {
            return (0, 0, name);
        };
        match direction {
            'N' => way[0] -= steps,
            'S' => way[0] += steps,
            'W' => way[1] -= steps,
            'E' => way[1] += steps,
            _ => return (0, 0, name),
        }
        part = rest[digits..].chars();
    }
    (way[0], way[1], rest)
}

fn number(value: &Value, key: &str) -> Result<u8, BitstreamError> {
    let number = value[key].as_u64().and_then(|number| u8::try_from(number).ok());
    number.ok_or_else(|| unreadable(format!("no number {key}")))
}

fn json(path: &Path) -> Result<Value, BitstreamError> {
    let text = fs::read_to_string(path).map_err(at(path))?;
    serde_json::from_str(&text).map_err(|error| unreadable(format!("{}: {error}", path.display())))
}

fn unreadable(reason: String) -> BitstreamError {
    BitstreamError::Unreadable {
        tool: "Project Trellis' database",
        reason,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_of_a_wire_is_followed() {
        assert_eq!(way("N2E1_V02N0001"), (-2, 1, "V02N0001"));
        assert_eq!(way("W3_H06W0003"), (0, -3, "H06W0003"));
        assert_eq!(way("F5A_SLICE"), (0, 0, "F5A_SLICE"));
        assert_eq!(way("JF0"), (0, 0, "JF0"));
    }

    #[test]
    fn tiles_have_their_place_in_their_name() {
        assert_eq!(place("MIB_R25C22:MIB_EBR0"), Some((25, 22, "MIB_EBR0".to_owned())));
        assert_eq!(place("R12C5:PLC2"), Some((12, 5, "PLC2".to_owned())));
        assert_eq!(place("BANKREF8:BANKREF8"), None);
    }

    #[test]
    fn fixed_wires_come_before_idle_switches_and_test_outputs_are_left_out() {
        let text = ".mux A0\nF5 F1B3 F4B2\nH00 -\n\n.fixed_conn A0_SLICE A0\n.fixed_conn JA0 JA0_CIBTEST\n";
        assert_eq!(idle_wires(text), [["A0_SLICE", "A0"], ["A0", "H00"]]);
    }
}
