//! The kinds of tiles, as `tiledata/KIND/bits.db` of Project Trellis' database describes them.

use std::collections::HashMap;

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

/// The wires of a kind of tile that always have the same source, and the source of the others while no switch is on: a wire and its source,
/// by their names in the tile.
pub(super) fn idle_wires(text: &str) -> Vec<[String; 2]> {
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
pub(super) fn switched_wires(text: &str) -> impl Iterator<Item = &str> {
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
pub(super) fn settings(text: &str) -> HashMap<String, Setting> {
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
pub(super) fn words(text: &str) -> HashMap<String, Word> {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fixed_wires_come_before_idle_switches_and_test_outputs_are_left_out() {
        let text = ".mux A0\nF5 F1B3 F4B2\nH00 -\n\n.fixed_conn A0_SLICE A0\n.fixed_conn JA0 JA0_CIBTEST\n";
        assert_eq!(idle_wires(text), [["A0_SLICE", "A0"], ["A0", "H00"]]);
    }
}
