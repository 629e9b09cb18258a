//! The device families that can be estimated, with one device of each for comparison.

use std::fmt;
use std::str::FromStr;

use posicast_machine::machine_file::FAMILIES;
use posicast_machine::spelling::did_you_mean;
use schemars::JsonSchema;
use serde::{Serialize, Serializer};

/// A device family, with its name in the machine file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, JsonSchema)]
#[schemars(with = "String")]
pub enum Family {
    /// Cyclone II. Yosys has no such target, so Cyclone IV E, which has the same logic element, represents it.
    Cyclone2,
    /// Cyclone IV E.
    Cyclone4e,
    /// Cyclone 10 LP, with the logic element of Cyclone IV E.
    Cyclone10lp,
    /// Cyclone V, which Yosys maps best. It is the default where a machine file names no family.
    #[default]
    Cyclone5,
    /// MAX 10, with the logic element of Cyclone IV E.
    Max10,
}

/// Unit in which a family's logic is counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
pub enum Cell {
    /// Logic element: a 4-input LUT and a flip-flop.
    #[serde(rename = "LE")]
    LogicElement,
    /// Adaptive logic module: two LUTs of up to 5 inputs or one of 6, and four flip-flops.
    #[serde(rename = "ALM")]
    AdaptiveLogicModule,
}

/// Resources of a device.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
pub struct FpgaDevice {
    /// Order code.
    pub name: &'static str,
    /// Unit of `cells`.
    pub cell: Cell,
    /// Number of logic cells.
    pub cells: u64,
    /// Number of flip-flops in those cells.
    pub registers: u64,
    /// Bits of block memory.
    pub memory_bits: u64,
    /// Number of multipliers of 18 × 18 bits.
    pub multipliers: u64,
}

/// The device family is not known.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("unknown device family {found:?}; known: {}{}", FAMILIES.join(", "), question(.found))]
pub struct UnknownFamily {
    /// Name that was found.
    pub found: String,
}

impl Family {
    /// All families.
    pub const ALL: [Self; 5] = [
        Self::Cyclone2,
        Self::Cyclone4e,
        Self::Cyclone10lp,
        Self::Cyclone5,
        Self::Max10,
    ];

    /// Name of the family in the machine file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Cyclone2 => "cyclone2",
            Self::Cyclone4e => "cyclone4e",
            Self::Cyclone10lp => "cyclone10lp",
            Self::Cyclone5 => "cyclone5",
            Self::Max10 => "max10",
        }
    }

    /// The device with which an estimate is compared: that of the family's most common board. Capacities are from the
    /// device handbooks and Quartus's fitter reports.
    pub fn device(self) -> FpgaDevice {
        match self {
            // DE1. 52 M4K blocks of 4,608 bits.
            Self::Cyclone2 => logic_elements("EP2C20F484C7", 18_752, 239_616, 26),
            // DE0-Nano. 66 M9K blocks of 9,216 bits.
            Self::Cyclone4e => logic_elements("EP4CE22F17C6", 22_320, 608_256, 66),
            // Cyclone 10 LP evaluation kit. 66 M9K blocks.
            Self::Cyclone10lp => logic_elements("10CL025YU256I7G", 24_624, 608_256, 66),
            // DE10-Lite. 182 M9K blocks.
            Self::Max10 => logic_elements("10M50DAF484C7G", 49_760, 1_677_312, 144),
            // DE1-SoC. 397 M10K blocks of 10,240 bits; 87 DSP blocks of two 18-bit multipliers each.
            Self::Cyclone5 => FpgaDevice {
                name: "5CSEMA5F31C6",
                cell: Cell::AdaptiveLogicModule,
                cells: 32_070,
                registers: 4 * 32_070,
                memory_bits: 4_065_280,
                multipliers: 174,
            },
        }
    }

    /// Yosys's name of the target to which the family is mapped.
    pub fn mapped_as(self) -> &'static str {
        match self.device().cell {
            Cell::LogicElement => "cycloneive",
            Cell::AdaptiveLogicModule => "cyclonev",
        }
    }
}

fn logic_elements(name: &'static str, cells: u64, memory_bits: u64, multipliers: u64) -> FpgaDevice {
    FpgaDevice {
        name,
        cell: Cell::LogicElement,
        cells,
        registers: cells,
        memory_bits,
        multipliers,
    }
}

/// Asks whether a similar name was meant.
fn question(found: &str) -> String {
    did_you_mean(found, &FAMILIES, '"').map_or_else(String::new, |question| format!("; {question}"))
}

impl FromStr for Family {
    type Err = UnknownFamily;

    fn from_str(name: &str) -> Result<Self, UnknownFamily> {
        let found = Self::ALL.into_iter().find(|family| family.name() == name);
        found.ok_or_else(|| UnknownFamily { found: name.to_owned() })
    }
}

impl fmt::Display for Family {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl Serialize for Family {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back() {
        for family in Family::ALL {
            assert_eq!(family.name().parse(), Ok(family));
        }
        assert_eq!(Family::ALL.map(Family::name), FAMILIES, "those of the machine file");
        let error = "CycloneV".parse::<Family>().unwrap_err();
        assert!(error.to_string().ends_with("did you mean \"cyclone5\"?"), "{error}");
        let error = "stratix".parse::<Family>().unwrap_err();
        assert!(error.to_string().contains("cyclone10lp"), "{error}");
    }

    #[test]
    fn memory_is_whole_blocks() {
        let block_bits = |family| match family {
            Family::Cyclone2 => 4_608,
            Family::Cyclone5 => 10_240,
            _ => 9_216,
        };
        for family in Family::ALL {
            assert_eq!(family.device().memory_bits % block_bits(family), 0, "{family}");
        }
    }
}
