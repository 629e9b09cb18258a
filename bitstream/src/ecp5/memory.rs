//! Block RAMs of the bits.

use super::decode::Decoder;
use super::routing::{CellPort, OutputPort, Routing};
use crate::BitstreamError;
use crate::network::{BlockRam, HIGH, LOW, NetIndex, RamPort, RamWrite};

/// Bits of a block RAM.
const MEMORY_BITS: u32 = 18_432;
/// Bits of a part of a word that has a write enable of its own, and of a word of the contents in a bitstream.
const PART_BITS: u32 = 9;
/// Words of the contents of a block RAM in a bitstream.
pub(super) const PARTS: usize = (MEMORY_BITS / PART_BITS) as usize;
/// Bits of the word of a port; wider words take both ports.
pub(super) const PORT_BITS: u32 = 18;
/// Bits of an address, those of the enables of a word's parts included.
const ADDRESS_BITS: u32 = 14;
/// Tiles, from left to right, over which the settings of a block RAM are spread.
const TILES: u8 = 3;

/// The settings of a block RAM.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct MemorySettings {
    /// Bits of a word.
    pub(super) bits: u32,
    /// Number of its contents.
    pub(super) contents: u32,
}

impl MemorySettings {
    /// The settings of the block RAM that begins at a tile.
    pub(super) fn new(routing: &Routing<'_>, row: u8, column: u8) -> Result<Self, BitstreamError> {
        let settings = Settings::new(routing, row, column)?;
        for key in ["REGMODE_A", "REGMODE_B"] {
            settings.must_be(key, "NOREG")?;
        }
        for key in ["CLKAMUX", "CLKBMUX"] {
            settings.must_be(key, &key[..4])?;
        }
        let bits = if settings.values("PDPW16KD.DATA_WIDTH_R") == ["36"] {
            2 * PORT_BITS
        } else {
            settings.must_be("MODE", "DP16KD")?;
            let [a, b] = ["A", "B"].map(|port| settings.values(&format!("DP16KD.DATA_WIDTH_{port}")));
            match (a.as_slice(), b.as_slice()) {
                (["18"], ["18"]) => 18,
                (["9"], ["9"]) => 9,
                _ => return Err(settings.unknown(&format!("words of {} and {} bits", a.join(" or "), b.join(" or ")))),
            }
        };
        for key in ["CSDECODE_A", "CSDECODE_B"] {
            if settings.word(key).contains(&false) {
                return Err(settings.unknown(&format!("another {key} than 111")));
            }
        }
        // The number's lowest bit is the word's highest.
        let number = settings.word("WID").into_iter();
        let contents = number.fold(0, |number, bit| number << 1 | u32::from(bit));
        Ok(Self { bits, contents })
    }
}

/// Decodes the block RAM that begins at a tile.
pub(super) fn decode(decoder: &mut Decoder<'_>, row: u8, column: u8) -> Result<BlockRam, BitstreamError> {
    let settings = MemorySettings::new(decoder.routing, row, column)?;
    let bits = settings.bits;
    let is_wide = bits > PORT_BITS;
    let parts = bits / PART_BITS;
    let mut port = |name: &str, half: char| port(decoder, (row, column), (name, half), settings);
    let ports = if is_wide {
        let [write, read] = [port("write", 'A')?, port("read", 'B')?];
        vec![write, read]
    } else {
        vec![port("both", 'A')?, port("both", 'B')?]
    };
    let words = (MEMORY_BITS / bits) as usize;
    let mut contents = vec![0; words];
    let stored = decoder.routing.contents(settings.contents);
    for (index, word) in stored.iter().enumerate() {
        let (at, part) = (index / parts as usize, index as u32 % parts);
        if let Some(to) = contents.get_mut(at) {
            *to |= u64::from(*word) << (PART_BITS * part);
        }
    }
    Ok(BlockRam {
        name: format!("memory_r{row}c{column}"),
        bits,
        contents,
        ports,
    })
}

fn port(
    decoder: &mut Decoder<'_>,
    (row, column): (u8, u8),
    (task, half): (&str, char),
    settings: MemorySettings,
) -> Result<RamPort, BitstreamError> {
    let bits = settings.bits;
    let is_wide = bits > PORT_BITS;
    let parts = bits / PART_BITS;
    let at = Settings::new(decoder.routing, row, column)?;
    let mut line = |name: String| -> Result<NetIndex, BitstreamError> {
        let net = decoder.source(row, column, &format!("J{name}_EBR"))?;
        let is_inverted = at.is_inverted(&name, bits);
        Ok(if is_inverted { decoder.inverse(net) } else { net })
    };
    let clock = line(format!("CLK{half}"))?;
    let enable = line(format!("CE{half}"))?;
    if line(format!("RST{half}"))? != LOW {
        return Err(at.unknown("a reset"));
    }
    // Words of one part have no enable of the part; the address begins where it would be.
    let low_bits = match parts {
        4 => 5,
        2 => 4,
        _ => 3,
    };
    let address = (low_bits..ADDRESS_BITS).map(|bit| line(format!("AD{half}{bit}")));
    let address = address.collect::<Result<Vec<_>, _>>()?;
    // A wide memory writes whenever its port is enabled; the bit of its mode is also that of the inverted write enable.
    let write_enable = match task {
        "write" => HIGH,
        "read" => LOW,
        _ => line(format!("WE{half}"))?,
    };
    let write = if write_enable == LOW || enable == LOW {
        None
    } else {
        let data: Vec<String> = if is_wide {
            (0..bits)
                .map(|bit| match bit.checked_sub(PORT_BITS) {
                    None => format!("DIA{bit}"),
                    Some(bit) => format!("DIB{bit}"),
                })
                .collect()
        } else {
            (0..bits).map(|bit| format!("DI{half}{bit}")).collect()
        };
        let data = data.into_iter().map(&mut line).collect::<Result<Vec<_>, _>>()?;
        let parts = match parts {
            1 => Ok(vec![HIGH]),
            parts => (0..parts).map(|part| line(format!("AD{half}{part}"))).collect(),
        };
        Some(RamWrite {
            enable: write_enable,
            data,
            parts: parts?,
        })
    };
    let outputs = match task {
        "write" => Vec::new(),
        // What was written at DIA comes out of DOA.
        "read" => (0..bits)
            .map(|bit| match bit.checked_sub(PORT_BITS) {
                None => OutputPort::MemoryA(bit as u8),
                Some(bit) => OutputPort::MemoryB(bit as u8),
            })
            .collect(),
        _ if half == 'A' => (0..bits as u8).map(OutputPort::MemoryA).collect(),
        _ => (0..bits as u8).map(OutputPort::MemoryB).collect(),
    };
    let outputs = outputs
        .into_iter()
        .map(|port| decoder.net(CellPort { row, column, port }));
    Ok(RamPort {
        clock,
        enable,
        address,
        // What a port shows while it writes is not known here; a design that looks at it is refused for an output that nothing drives.
        outputs: if write.is_some() { Vec::new() } else { outputs.collect() },
        write,
    })
}

/// Whether the level of an input makes a difference with words of this many bits. The others may be tied to any level.
pub(super) fn is_used(port: &str, word_bits: u32) -> bool {
    let is_wide = word_bits > PORT_BITS;
    let part_enables = match (is_wide, word_bits > PART_BITS) {
        (true, _) => 4,
        (false, true) => 2,
        (false, false) => 0,
    };
    let first_address = match (is_wide, word_bits > PART_BITS) {
        (true, _) => 5,
        (false, true) => 4,
        (false, false) => 3,
    };
    let bit = |name: &str| port.strip_prefix(name).and_then(|bit| bit.parse::<u32>().ok());
    match (bit("ADA"), bit("ADB"), port) {
        (Some(bit), _, _) => bit < part_enables || bit >= first_address,
        (_, Some(bit), _) => (bit < part_enables && !is_wide) || bit >= first_address,
        // With wide words, the mode makes one port write and the other read.
        (_, _, "WEA" | "WEB") => !is_wide,
        // The word that enables the memory is checked as a setting; outputs have no register.
        (_, _, port) => !port.starts_with("CS") && !port.starts_with("OCE"),
    }
}

/// The inputs of a block RAM.
pub(super) fn inputs() -> impl Iterator<Item = String> {
    let bits = |name: &'static str, bits: u32| (0..bits).map(move |bit| format!("{name}{bit}"));
    let of_port = move |half: [&'static str; 3]| {
        let [data, address, select] = half;
        bits(data, PORT_BITS)
            .chain(bits(address, ADDRESS_BITS))
            .chain(bits(select, 3))
    };
    let lines = [
        "CLKA", "CLKB", "CEA", "CEB", "OCEA", "OCEB", "WEA", "WEB", "RSTA", "RSTB",
    ];
    of_port(["DIA", "ADA", "CSA"])
        .chain(of_port(["DIB", "ADB", "CSB"]))
        .chain(lines.map(str::to_owned))
}

/// The settings of a block RAM as its tiles have them.
pub(super) struct Settings<'a> {
    routing: &'a Routing<'a>,
    row: u8,
    column: u8,
    /// Its number among the four that share nine tiles.
    number: u8,
}

impl<'a> Settings<'a> {
    pub(super) fn new(routing: &'a Routing<'a>, row: u8, column: u8) -> Result<Self, BitstreamError> {
        let kinds = routing.database().kinds(row, column).iter();
        let number = kinds
            .filter_map(|kind| kind.strip_prefix("MIB_EBR")?.parse::<u8>().ok())
            .next();
        let number = number
            .ok_or_else(|| BitstreamError::UnknownCell(format!("R{row}C{column}: a block RAM where none begins")))?;
        Ok(Self {
            routing,
            row,
            column,
            number: number / 2,
        })
    }

    fn key(&self, key: &str) -> String {
        format!("EBR{}.{key}", self.number)
    }

    /// The values of a setting that all tiles allow: its bits are spread over them, and a tile shows only its part.
    fn values(&self, key: &str) -> Vec<&'a str> {
        let key = self.key(key);
        let database = self.routing.database();
        let mut allowed: Option<Vec<&str>> = None;
        for column in self.column..self.column.saturating_add(TILES) {
            let shown = self.routing.setting(self.row, column, &key);
            for kind in database.kinds(self.row, column) {
                if let Some(setting) = database.memory_setting(kind, &key) {
                    let here = setting.values_like(shown);
                    allowed = Some(match allowed {
                        None => here,
                        Some(before) => before.into_iter().filter(|value| here.contains(value)).collect(),
                    });
                }
            }
        }
        allowed.unwrap_or_default()
    }

    /// A word, whose bits are spread over the tiles; its lowest bit comes first.
    fn word(&self, key: &str) -> Vec<bool> {
        let key = self.key(key);
        let database = self.routing.database();
        let mut word: Vec<bool> = Vec::new();
        for column in self.column..self.column.saturating_add(TILES) {
            for kind in database.kinds(self.row, column) {
                let Some(of) = database.memory_word(kind, &key) else {
                    continue;
                };
                let shown = self.routing.setting(self.row, column, &key).unwrap_or(&of.default);
                word.resize(of.is_here.len(), false);
                let digits = shown.bytes().rev().zip(&of.is_here).enumerate();
                for (bit, (digit, _)) in digits.filter(|(_, (_, is_here))| **is_here) {
                    word[bit] = digit == b'1';
                }
            }
        }
        word
    }

    /// The value of a setting that lies in one tile; `None` if no tile shows it.
    fn only(&self, key: &str) -> Option<&'a str> {
        let key = self.key(key);
        let mut columns = self.column..self.column.saturating_add(TILES);
        columns.find_map(|column| self.routing.setting(self.row, column, &key))
    }

    /// Whether an input is inverted.
    pub(super) fn is_inverted(&self, port: &str, word_bits: u32) -> bool {
        // In a memory of wide words, this bit belongs to the mode.
        let is_of_mode = port == "WEA" && word_bits > PORT_BITS;
        !is_of_mode && self.only(&format!("{port}MUX")) == Some("INV")
    }

    /// Whether the tiles allow this value of a parameter of the router's netlist; `None` if it is no setting of the tiles.
    pub(super) fn routed_values(&self, parameter: &str, value: &str) -> Option<bool> {
        let key = match parameter {
            "REGMODE_A" | "REGMODE_B" | "RESETMODE" | "ASYNC_RESET_RELEASE" | "GSR" => parameter.to_owned(),
            "WRITEMODE_A" | "WRITEMODE_B" => format!("DP16KD.{parameter}"),
            // Of wide words, port A has no setting, and port B has one of its own.
            "DATA_WIDTH_A" | "DATA_WIDTH_B" => return self.routed_width(parameter, value),
            _ => return None,
        };
        let values = self.values(&key);
        (!values.is_empty()).then(|| values.contains(&value))
    }

    fn routed_width(&self, parameter: &str, digits: &str) -> Option<bool> {
        let bits = u32::from_str_radix(digits, 2).ok()?;
        // Of wide words, port A has no setting, and port B has one of its own.
        let key = match (bits > PORT_BITS, parameter) {
            (true, "DATA_WIDTH_A") => return None,
            (true, _) => "PDPW16KD.DATA_WIDTH_R".to_owned(),
            (false, _) => format!("DP16KD.{parameter}"),
        };
        Some(self.values(&key).contains(&bits.to_string().as_str()))
    }

    fn must_be(&self, key: &str, value: &str) -> Result<(), BitstreamError> {
        let values = self.values(key);
        if values.is_empty() || values.contains(&value) {
            Ok(())
        } else {
            Err(self.unknown(&format!("{key} {}", values.join(" or "))))
        }
    }

    fn unknown(&self, what: &str) -> BitstreamError {
        BitstreamError::UnknownCell(format!("R{}C{}, block RAM: {what}", self.row, self.column))
    }
}
