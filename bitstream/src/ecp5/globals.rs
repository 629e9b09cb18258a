//! The clock network of a device, and the places of wires by the names that tiles call them.

use super::database::{number, unreadable};
use crate::BitstreamError;
use serde_json::Value;
use std::collections::HashMap;

/// The wires that do not belong to a tile: those of the clock network.
#[derive(Debug)]
pub(super) struct Globals {
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

impl Globals {
    pub(super) fn read(file: &Value, device: &str) -> Result<Self, BitstreamError> {
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
    pub(super) fn place(&self, row: u8, column: u8, name: &str) -> Option<(u8, u8, String)> {
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
    pub(super) fn each_name(&self, name: &str, each: &mut dyn FnMut(&str)) {
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
}
