//! Finds the flip-flops that are the built-in registers of a multiplier, and therefore need no logic element.
//!
//! An embedded multiplier of Cyclone II to IV, Cyclone 10 LP and MAX 10 has a register for each operand and one for
//! the product, without synchronous clear, with one clock and one enable for all (Cyclone II Device Handbook,
//! "Embedded Multipliers in Cyclone II Devices", "Input Registers" and "Output Registers").

use std::collections::{BTreeSet, HashMap};

use super::netlist::{Bit, Module, NetlistCell};

/// Names of the output ports of the cells of a mapped netlist.
const OUTPUTS: [&str; 5] = ["combout", "cout", "q", "Y", "RD_DATA"];

/// A use of a wire: the cell and its port; `None` for a port of the module.
type Use<'a> = Option<(&'a NetlistCell, &'a str)>;

/// Returns the names of the module's flip-flops that are such registers: an operand's if nothing else reads them, a
/// product's if nothing else reads the product; always all bits of a word, or none.
pub(super) fn of(module: &Module) -> BTreeSet<&str> {
    let multipliers: Vec<_> = module
        .cells
        .values()
        .filter(|cell| cell.kind == "posicast_multiplier")
        .collect();
    if multipliers.is_empty() {
        return BTreeSet::new();
    }
    let uses = uses(module);
    let flip_flops = module.cells.iter().filter(|(_, cell)| can_be_built_in(cell));
    let by_output: HashMap<&Bit, (&str, &NetlistCell)> = flip_flops
        .filter_map(|(name, cell)| Some((port(cell, "q").first()?, (name.as_str(), cell))))
        .collect();
    let by_data: HashMap<&Bit, (&str, &NetlistCell)> = (by_output.values())
        .filter_map(|found| Some((port(found.1, "d").first()?, *found)))
        .collect();
    let of_a_multiplier = |found: &Use<'_>| found.is_some_and(|(cell, _)| cell.kind == "posicast_multiplier");
    let is_operand = |bit: &Bit| uses[bit].iter().all(of_a_multiplier);
    let is_product = |bit: &Bit| matches!(uses[bit][..], [Some((_, "d"))]);

    let mut found = BTreeSet::new();
    for multiplier in multipliers {
        let mut registers = Vec::new();
        for operand in ["A", "B"] {
            registers.extend(word(port(multiplier, operand), &by_output, is_operand));
        }
        let read = port(multiplier, "Y").iter().filter(|bit| uses.contains_key(bit));
        registers.extend(word(read, &by_data, is_product));
        // All three share one clock and one enable.
        let controls = |cell| ["clk", "ena"].map(|name| port(cell, name));
        if registers.windows(2).all(|two| controls(two[0].1) == controls(two[1].1)) {
            found.extend(registers.into_iter().map(|(name, _)| name));
        }
    }
    found
}

/// Returns the flip-flops of a word, if each of its wires has its own.
fn word<'a, 'b>(
    bits: impl IntoIterator<Item = &'b Bit>,
    flip_flops: &HashMap<&Bit, (&'a str, &'a NetlistCell)>,
    serves: impl Fn(&Bit) -> bool,
) -> Vec<(&'a str, &'a NetlistCell)> {
    let wires = bits.into_iter().filter(|bit| matches!(bit, Bit::Wire(_)));
    let found: Option<Vec<_>> = wires
        .map(|bit| flip_flops.get(bit).copied().filter(|_| serves(bit)))
        .collect();
    found.unwrap_or_default()
}

/// Whether a flip-flop has no clear. Flip-flops of Cyclone V are not counted here; it has enough registers.
fn can_be_built_in(cell: &NetlistCell) -> bool {
    let constant = |name, value: &str| matches!(port(cell, name), [Bit::Constant(found)] if found == value);
    cell.kind == "dffeas" && constant("sclr", "0") && constant("clrn", "1")
}

fn port<'a>(cell: &'a NetlistCell, name: &str) -> &'a [Bit] {
    cell.connections.get(name).map_or(&[], Vec::as_slice)
}

/// The readers of each wire. Ports of the module count in both directions, because an input does not come from a
/// flip-flop.
fn uses(module: &Module) -> HashMap<&Bit, Vec<Use<'_>>> {
    let mut uses: HashMap<&Bit, Vec<Use<'_>>> = HashMap::new();
    for cell in module.cells.values() {
        for (name, bits) in &cell.connections {
            if !OUTPUTS.contains(&name.as_str()) {
                for bit in bits {
                    uses.entry(bit).or_default().push(Some((cell, name)));
                }
            }
        }
    }
    for bit in module.ports.values().flat_map(|port| &port.bits) {
        uses.entry(bit).or_default().push(None);
    }
    uses
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A product of two registered operands of two bits, registered, after `change` was applied to the cells.
    fn found(change: impl FnOnce(&mut serde_json::Value)) -> Vec<String> {
        let flip_flop = |d: u64, q: u64| {
            serde_json::json!({"type": "dffeas", "connections":
                {"d": [d], "q": [q], "clk": [2], "ena": ["1"], "sclr": ["0"], "clrn": ["1"]}})
        };
        let mut cells = serde_json::json!({
            "product": {"type": "posicast_multiplier", "connections": {"A": [20, 21, 21], "B": [22, "0"], "Y": [30, 31, 32]}},
            "a_0": flip_flop(10, 20), "a_1": flip_flop(11, 21), "b": flip_flop(12, 22),
            "p_0": flip_flop(30, 40), "p_1": flip_flop(31, 41),
        });
        change(&mut cells);
        let module = serde_json::json!({"ports": {"y": {"bits": [40, 41]}}, "cells": cells});
        let module: Module = serde_json::from_value(module).unwrap();
        of(&module).into_iter().map(str::to_owned).collect()
    }

    #[test]
    fn a_multiplier_takes_its_operands_and_its_product() {
        assert_eq!(found(|_| ()), ["a_0", "a_1", "b", "p_0", "p_1"]);
    }

    #[test]
    fn a_word_with_another_reader_stays_outside() {
        let reader = |wire: u64| serde_json::json!({"type": "cycloneive_lcell_comb", "connections": {"dataa": [wire]}});
        assert_eq!(found(|cells| cells["other"] = reader(21)), ["b", "p_0", "p_1"]);
        assert_eq!(found(|cells| cells["other"] = reader(31)), ["a_0", "a_1", "b"]);
    }

    #[test]
    fn a_register_with_a_clear_stays_outside() {
        assert_eq!(
            found(|cells| cells["a_0"]["connections"]["sclr"] = serde_json::json!([3])),
            ["b", "p_0", "p_1"]
        );
    }

    #[test]
    fn registers_with_different_enables_stay_outside() {
        assert!(found(|cells| cells["b"]["connections"]["ena"] = serde_json::json!([3])).is_empty());
    }
}
