//! Counts the logic elements of Cyclone II to IV, Cyclone 10 LP and MAX 10 that hold LUTs and flip-flops.
//!
//! An element has a LUT of four inputs and a flip-flop. The flip-flop takes its data from the LUT, or, if the LUT
//! leaves the third input free, from that input: then both serve unrelated functions, which the handbooks call
//! register packing (Cyclone IV Device Handbook, "LE Features"; Intel Cyclone 10 LP Core Fabric Handbook, 1.1.1).
//! Quartus does as much of it as the design needs to fit (Settings File Reference Manual,
//! `QII_AUTO_PACKED_REGISTERS`, "Auto"). Here no flip-flop is packed with a bit of a carry chain, although some of
//! these handbooks allow it.

use std::collections::BTreeSet;

use super::netlist::{Bit, NetlistCell};

const INPUTS: [&str; 4] = ["dataa", "datab", "datac", "datad"];

/// Number of logic elements for LUTs and flip-flops together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct LogicElements {
    /// With register packing: the smallest number that holds them.
    pub(super) packed: u64,
    /// Without: a flip-flop only shares the element of the LUT that drives it.
    pub(super) unpacked: u64,
}

/// Counts the elements for `cycloneive_lcell_comb` and `dffeas`.
pub(super) fn count(luts: &[&NetlistCell], flip_flops: &[&NetlistCell]) -> LogicElements {
    let data: BTreeSet<u64> = flip_flops.iter().filter_map(|cell| wire(cell, "d")).collect();
    let (driving, others): (Vec<&NetlistCell>, Vec<&NetlistCell>) = luts
        .iter()
        .partition(|lut| wire(lut, "combout").is_some_and(|output| data.contains(&output)));
    let alone = flip_flops.len() - driving.len();
    let with_room = others.iter().filter(|lut| has_room(lut)).count();
    LogicElements {
        packed: (luts.len() + alone.saturating_sub(with_room)) as u64,
        unpacked: (luts.len() + alone) as u64,
    }
}

/// Whether the element of the LUT has room for a flip-flop of another function.
fn has_room(lut: &NetlistCell) -> bool {
    let inputs: BTreeSet<u64> = INPUTS.iter().filter_map(|input| wire(lut, input)).collect();
    let in_carry_chain = lut.parameters.get("sum_lutc_input").is_some_and(|value| value == "cin");
    inputs.len() < INPUTS.len() && !in_carry_chain
}

/// The wire at a port of one bit; `None` if it is a constant.
fn wire(cell: &NetlistCell, port: &str) -> Option<u64> {
    match cell.connections.get(port).map(Vec::as_slice) {
        Some([Bit::Wire(wire)]) => Some(*wire),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cells(list: serde_json::Value) -> Vec<NetlistCell> {
        serde_json::from_value(list).unwrap()
    }

    fn flip_flop(data: serde_json::Value) -> serde_json::Value {
        serde_json::json!({"type": "dffeas", "connections": {"d": [data]}})
    }

    /// A LUT of this many inputs with its output on wire 5.
    fn lut(inputs: usize, mode: &str) -> serde_json::Value {
        let mut connections = serde_json::json!({"combout": [5], "datad": ["1"]});
        for (wire, input) in INPUTS[..inputs].iter().enumerate() {
            connections[*input] = serde_json::json!([10 + wire]);
        }
        serde_json::json!({"type": "cycloneive_lcell_comb", "parameters": {"sum_lutc_input": mode}, "connections": connections})
    }

    fn packed_and_unpacked(luts: serde_json::Value, flip_flops: serde_json::Value) -> (u64, u64) {
        let (luts, flip_flops) = (cells(luts), cells(flip_flops));
        let found = count(&luts.iter().collect::<Vec<_>>(), &flip_flops.iter().collect::<Vec<_>>());
        (found.packed, found.unpacked)
    }

    #[test]
    fn a_flip_flop_shares_its_lut_once() {
        let three = serde_json::json!([flip_flop(5.into()), flip_flop(5.into()), flip_flop("0".into())]);
        assert_eq!(packed_and_unpacked(serde_json::json!([lut(3, "datac")]), three), (3, 3));
    }

    #[test]
    fn a_lut_of_three_inputs_leaves_room_for_an_unrelated_flip_flop() {
        let stranger = || serde_json::json!([flip_flop(7.into())]);
        assert_eq!(
            packed_and_unpacked(serde_json::json!([lut(3, "datac")]), stranger()),
            (1, 2)
        );
        assert_eq!(
            packed_and_unpacked(serde_json::json!([lut(4, "datac")]), stranger()),
            (2, 2)
        );
        assert_eq!(
            packed_and_unpacked(serde_json::json!([lut(2, "cin")]), stranger()),
            (2, 2)
        );
    }
}
