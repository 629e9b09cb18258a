//! Counts the resources of a mapped netlist, which Yosys's `write_json` describes.
//!
//! - Logic elements: LUTs, where a bit of a carry chain counts as one, plus the flip-flops that cannot share a LUT's
//!   element (`logic_elements`). A multiplier's own registers take no element (`multiplier_registers`).
//! - ALMs: a 6-input LUT fills one, two smaller LUTs share one; one ALM per four flip-flops where those need more.
//! - Memory bits and multipliers: from the sizes of the black boxes (`cells.v`), the same for every version of the
//!   tool.

use std::ops::AddAssign;

use schemars::JsonSchema;
use serde::Serialize;

use super::family::{Cell, Family};
use super::netlist::{Module, Netlist, NetlistCell};
use super::{logic_elements, m4k, multiplier_registers};

/// Resources of a device that a block takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, JsonSchema)]
pub struct Resources {
    /// Number of logic cells, in the unit of the device.
    pub cells: u64,
    /// Number of flip-flops.
    pub registers: u64,
    /// Bits of block memory, without those that never change.
    pub memory_bits: u64,
    /// Number of multipliers of 18 × 18 bits.
    pub multipliers: u64,
    /// Number of LUTs among `cells`; not counted for Cyclone V, and not in the document.
    #[serde(skip)]
    pub luts: u64,
    /// `cells` if no register were packed with a LUT that does not drive it; like `luts` not in the document.
    #[serde(skip)]
    pub unpacked_cells: u64,
    /// Blocks of 4,608 bits that the memory would take in Cyclone II; not in the document.
    #[serde(skip)]
    pub m4k_blocks: u64,
}

impl AddAssign for Resources {
    fn add_assign(&mut self, other: Self) {
        self.cells = self.cells.saturating_add(other.cells);
        self.registers = self.registers.saturating_add(other.registers);
        self.memory_bits = self.memory_bits.saturating_add(other.memory_bits);
        self.multipliers = self.multipliers.saturating_add(other.multipliers);
        self.luts = self.luts.saturating_add(other.luts);
        self.unpacked_cells = self.unpacked_cells.saturating_add(other.unpacked_cells);
        self.m4k_blocks = self.m4k_blocks.saturating_add(other.m4k_blocks);
    }
}

/// Resources of one instance.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct BlockEstimate {
    /// Name of the instance in the top module; the top module's own name for the logic between its instances.
    pub name: String,
    /// Its resources.
    #[serde(flatten)]
    pub resources: Resources,
}

/// One row per instance in `top`, sorted by name, then one for the logic of `top` itself if there is any.
///
/// # Errors
/// Description of a cell that cannot be counted.
pub(super) fn blocks(netlist: &Netlist, top: &str, family: Family) -> Result<Vec<BlockEstimate>, String> {
    let module = netlist
        .modules
        .get(top)
        .ok_or_else(|| format!("no module {top} in the netlist"))?;
    let mut blocks = Vec::new();
    for (name, cell) in &module.cells {
        if let Some(inner) = netlist.design_module(&cell.kind) {
            let resources = count(netlist, inner, family)?;
            blocks.push(BlockEstimate {
                name: name.clone(),
                resources,
            });
        }
    }
    let own = count(netlist, module, family)?;
    if own != Resources::default() || blocks.is_empty() {
        blocks.push(BlockEstimate {
            name: top.to_owned(),
            resources: own,
        });
    }
    Ok(blocks)
}

/// Counts the cells of one flat module, without its instances of other modules.
fn count(netlist: &Netlist, module: &Module, family: Family) -> Result<Resources, String> {
    let mut total = Resources::default();
    let mut wide_luts = 0;
    let mut half_luts = 0u64;
    let mut luts = Vec::new();
    let mut flip_flops = Vec::new();
    let in_multipliers = multiplier_registers::of(module);
    for (name, cell) in &module.cells {
        match cell.kind.as_str() {
            "cycloneive_lcell_comb" => luts.push(cell),
            "dffeas" => {
                total.registers += 1;
                if !in_multipliers.contains(name.as_str()) {
                    flip_flops.push(cell);
                }
            }
            "MISTRAL_ALUT6" => wide_luts += 1,
            "MISTRAL_FF" => total.registers += 1,
            kind if kind.starts_with("MISTRAL_ALUT") => half_luts += 1,
            "posicast_memory" => {
                let (reads, writes) = (size(cell, "RD_PORTS")?, size(cell, "WR_PORTS")?);
                // A block RAM has two ports; with more readers each needs a copy.
                let copies = if reads.saturating_add(writes) <= 2 { 1 } else { reads };
                let (words, width) = (size(cell, "SIZE")?, size(cell, "WIDTH")?);
                let bits = words.saturating_mul(width);
                let blocks = m4k::blocks(words, width).saturating_mul(copies);
                total.m4k_blocks = total.m4k_blocks.saturating_add(blocks);
                total.memory_bits = total.memory_bits.saturating_add(bits.saturating_mul(copies));
            }
            "posicast_multiplier" => {
                let of_18_bits = multipliers(size(cell, "A_WIDTH")?, size(cell, "B_WIDTH")?, family);
                total.multipliers = total.multipliers.saturating_add(of_18_bits);
            }
            // Inverters are absorbed by the LUT or flip-flop that they feed; the other types cost nothing.
            "$not" | "MISTRAL_NOT" | "GND" | "VCC" | "$scopeinfo" => {}
            kind if netlist.design_module(kind).is_some() => {}
            kind => return Err(format!("cell {name} has type {kind}, unknown to the estimate")),
        }
    }
    match family.device().cell {
        Cell::LogicElement => {
            let elements = logic_elements::count(&luts, &flip_flops);
            total.luts = luts.len() as u64;
            total.cells = elements.packed;
            total.unpacked_cells = elements.unpacked;
        }
        Cell::AdaptiveLogicModule => {
            total.cells = (wide_luts + half_luts.div_ceil(2)).max(total.registers.div_ceil(4));
            total.unpacked_cells = total.cells;
        }
    }
    Ok(total)
}

/// Number of 18-bit multipliers for one product. Cyclone V can join two to one of 27 × 27 bits.
fn multipliers(a_width: u64, b_width: u64, family: Family) -> u64 {
    let grid = |bits: u64| a_width.div_ceil(bits).saturating_mul(b_width.div_ceil(bits));
    match family {
        Family::Cyclone5 => grid(18).min(grid(27).saturating_mul(2)),
        _ => grid(18),
    }
}

/// A size parameter, which Yosys writes as 32 binary digits and other versions as a number.
fn size(cell: &NetlistCell, parameter: &str) -> Result<u64, String> {
    let value = cell.parameters.get(parameter);
    let number = value.and_then(|v| v.as_u64().or_else(|| u64::from_str_radix(v.as_str()?, 2).ok()));
    number.ok_or_else(|| format!("parameter {parameter} of a {} is not a size: {value:?}", cell.kind))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one(cells: serde_json::Value, family: Family) -> Result<Resources, String> {
        let netlist = serde_json::json!({"modules": {"top": {"cells": cells}}});
        let blocks = blocks(&serde_json::from_value(netlist).unwrap(), "top", family)?;
        Ok(blocks[0].resources)
    }

    #[test]
    fn six_input_luts_fill_a_module() {
        let alm = |kind| serde_json::json!({"type": kind});
        let cells = serde_json::json!({
            "a": alm("MISTRAL_ALUT6"), "b": alm("MISTRAL_ALUT2"), "c": alm("MISTRAL_ALUT5"), "d": alm("MISTRAL_ALUT_ARITH"),
            "e": alm("MISTRAL_NOT"), "f": alm("MISTRAL_FF"),
        });
        let resources = one(cells, Family::Cyclone5).unwrap();
        assert_eq!((resources.cells, resources.registers), (3, 1));
    }

    #[test]
    fn products_are_split_to_the_device() {
        for (a, b, le, alm) in [
            (18, 18, 1, 1),
            (16, 9, 1, 1),
            (32, 18, 2, 2),
            (32, 32, 4, 4),
            (27, 27, 4, 2),
        ] {
            assert_eq!(multipliers(a, b, Family::Cyclone2), le, "{a}×{b}");
            assert_eq!(multipliers(a, b, Family::Cyclone5), alm, "{a}×{b}");
        }
    }

    #[test]
    fn memories_with_many_readers_are_copied() {
        let memory = |reads: u64| {
            let sizes = serde_json::json!({"SIZE": "1000000", "WIDTH": 18, "RD_PORTS": reads, "WR_PORTS": 1});
            serde_json::json!({"ram": {"type": "posicast_memory", "parameters": sizes}})
        };
        assert_eq!(one(memory(1), Family::Cyclone2).unwrap().memory_bits, 64 * 18);
        assert_eq!(one(memory(2), Family::Cyclone2).unwrap().memory_bits, 2 * 64 * 18);
        assert_eq!(one(memory(u64::MAX), Family::Cyclone2).unwrap().memory_bits, u64::MAX);
    }

    #[test]
    fn what_cannot_be_counted_is_an_error() {
        let error = one(serde_json::json!({"u": {"type": "$_DLATCH_P_"}}), Family::Cyclone2).unwrap_err();
        assert!(error.contains("$_DLATCH_P_"), "{error}");
        let error = one(serde_json::json!({"u": {"type": "posicast_memory"}}), Family::Cyclone2).unwrap_err();
        assert!(error.contains("RD_PORTS"), "{error}");
    }
}
