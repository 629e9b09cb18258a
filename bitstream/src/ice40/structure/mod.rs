//! Compares the netlist of the bits with the placed netlist of the router: cell by cell, connection by connection.
//!
//! Nets have other names in the two netlists, so they are compared by what drives them: the output or the carry of the logic cell at a
//! place, a bit of the memory at a place, or a pin. A look-up table is compared as a function of its drivers, for all their levels,
//! because the router may swap a table's inputs.

mod netlists;

use crate::BitstreamError;
use crate::boards::FpgaBoard;
use crate::function;
use crate::ice40::{CellPlace, IceboxNetlist, LutCell, MEMORY_WORDS};
use crate::report::CellsReport;
use netlists::{Driver, ReadBack, RoutedNetlist, is_set, parameter};
use serde_json::Value;

/// Ports of a memory: name, width, and level where nothing is connected.
const MEMORY_INPUTS: [(&str, usize, bool); 10] = [
    ("WADDR", 11, false),
    ("RADDR", 11, false),
    ("MASK", 16, false),
    ("WDATA", 16, false),
    ("WE", 1, false),
    ("WCLKE", 1, true),
    ("WCLK", 1, false),
    ("RE", 1, false),
    ("RCLKE", 1, true),
    ("RCLK", 1, false),
];

impl CellsReport {
    /// Counts a connection, and a difference if the drivers differ.
    fn connection(&mut self, what: impl Fn() -> String, routed: Option<Driver>, bits: Option<Driver>) {
        self.connections += 1;
        if routed != bits || bits.is_none() {
            self.differs(format!(
                "{}: {} in the router's netlist, {} in the bits",
                what(),
                named(routed),
                named(bits)
            ));
        }
    }
}

fn named(driver: Option<Driver>) -> String {
    driver.map_or_else(|| "nothing".to_owned(), |driver| driver.to_string())
}

/// Compares the netlist of the bits with the router's.
///
/// # Errors
/// [`BitstreamError::Unreadable`] for a router's netlist of another form, [`BitstreamError::UnknownCell`] for a kind of cell that is not
/// compared here.
pub fn compare_cells(bits: &IceboxNetlist, routed: &Value, board: &FpgaBoard) -> Result<CellsReport, BitstreamError> {
    let routed = RoutedNetlist::read(routed, board)?;
    let mut report = CellsReport::default();
    let read_back = ReadBack::new(bits, &routed, board, &mut report);
    for (place, cell) in &routed.logic {
        logic(&routed, &read_back, *place, cell, &mut report);
    }
    for (place, cell) in &routed.memories {
        memory(&routed, &read_back, *place, cell, &mut report);
    }
    for (pin, net) in &routed.outputs {
        let of_bits = bits
            .outputs
            .iter()
            .find(|(name, _)| name == pin)
            .and_then(|(_, net)| read_back.driver(*net));
        report.connection(|| format!("pin {pin}"), routed.driver(net), of_bits);
    }
    for (pin, _) in bits
        .outputs
        .iter()
        .filter(|(pin, _)| routed.outputs.iter().all(|(other, _)| pin != other))
    {
        report.differs(format!("pin {pin}: an output only in the bits"));
    }
    Ok(report)
}

/// Compares a logic cell: its table, its flip-flop, its carry.
fn logic(routed: &RoutedNetlist<'_>, bits: &ReadBack<'_>, place: CellPlace, cell: &Value, report: &mut CellsReport) {
    let at = |what: &str| format!("{place}, {what}");
    let inputs = ["I0", "I1", "I2", "I3"].map(|port| routed.driver_or(cell, port, false));
    let is_used = cell["connections"]["O"][0].is_u64();
    match bits.luts.get(&place) {
        Some(lut) => {
            report.tables += 1;
            report.connections += inputs
                .iter()
                .filter(|input| !matches!(input, Some(Driver::Constant(_))))
                .count() as u64;
            if !is_same_function(inputs, parameter(cell, "LUT_INIT"), lut, bits) {
                report.differs(at("look-up table: another function of its inputs"));
            }
        }
        None if is_used => report.differs(at("look-up table: not in the bits")),
        None => {}
    }
    let flop = bits.cells.get(&place).and_then(|cell| cell.flop);
    match (is_set(cell, "DFF_ENABLE"), flop) {
        (true, Some(flop)) => {
            report.flip_flops += 1;
            for (port, level, net) in [
                ("CLK", false, flop.clock),
                ("CEN", true, flop.enable),
                ("SR", false, flop.reset),
            ] {
                report.connection(|| at(port), routed.driver_or(cell, port, level), bits.driver(net));
            }
            let has_other_edge = is_set(cell, "NEG_CLK") || is_set(cell, "ASYNC_SR");
            if is_set(cell, "SET_NORESET") != flop.reset_to || has_other_edge {
                report.differs(at("flip-flop: another set, reset or edge"));
            }
        }
        (false, None) => {}
        _ => report.differs(at("flip-flop: in use only in one netlist")),
    }
    match (is_set(cell, "CARRY_ENABLE"), bits.carries.get(&place)) {
        (true, Some(carry)) => {
            report.carries += 1;
            let below = match is_set(cell, "CIN_CONST") {
                true => Some(Driver::Constant(is_set(cell, "CIN_SET"))),
                false if cell["connections"]["CIN"][0].is_u64() => routed.driver(&cell["connections"]["CIN"]),
                // Where nextpnr leads a carry out of its chain, it names it only at the table, which the device gives the same wire.
                false => inputs[3]
                    .filter(|driver| matches!(driver, Driver::Carry(_)))
                    .or(Some(Driver::Constant(false))),
            };
            // The router may swap the inputs of a table, and so those of the carry beside it, which is the same for both orders.
            let routed_pair = [inputs[1], inputs[2]];
            let mut pair = [carry.inputs[0], carry.inputs[1]].map(|net| bits.driver(net));
            if pair != routed_pair {
                pair.reverse();
            }
            let [a, b] = pair;
            for (port, driver, of_bits) in [
                ("I1", inputs[1], a),
                ("I2", inputs[2], b),
                ("CIN", below, bits.driver(carry.inputs[2])),
            ] {
                report.connection(|| at(&format!("carry, {port}")), driver, of_bits);
            }
        }
        // A carry only in the bits is found there.
        (false, _) => {}
        (true, None) => report.differs(at("carry: not in the bits")),
    }
}

/// Whether a table of the router's netlist and one of the bits are the same function of what drives their inputs.
fn is_same_function(inputs: [Option<Driver>; 4], table: Vec<bool>, lut: &LutCell, bits: &ReadBack<'_>) -> bool {
    let of_bits: Option<Vec<Driver>> = lut.inputs.iter().map(|net| bits.driver(*net)).collect();
    let (Some(of_bits), [Some(a), Some(b), Some(c), Some(d)]) = (of_bits, inputs) else {
        return false;
    };
    let table = table
        .iter()
        .rev()
        .fold(0u16, |table, value| table << 1 | u16::from(*value));
    let constant = |driver: Driver| match driver {
        Driver::Constant(level) => Some(level),
        _ => None,
    };
    function::is_same(constant, (&[a, b, c, d], table), (&of_bits, lut.table))
}

/// Compares a memory: its modes, contents and connections.
fn memory(routed: &RoutedNetlist<'_>, bits: &ReadBack<'_>, place: CellPlace, cell: &Value, report: &mut CellsReport) {
    let at = |what: &str| format!("{place}, memory, {what}");
    let Some(memory) = bits.memories.get(&place) else {
        report.differs(at("not in the bits"));
        return;
    };
    report.memories += 1;
    let number = |bits: Vec<bool>| {
        bits.iter()
            .rev()
            .fold(0u64, |number, bit| number << 1 | u64::from(*bit))
    };
    for (key, mode) in [("WRITE_MODE", memory.write_mode), ("READ_MODE", memory.read_mode)] {
        if number(parameter(cell, key)) != u64::from(mode) {
            report.differs(at(key));
        }
    }
    if is_set(cell, "NEG_CLK_R") || is_set(cell, "NEG_CLK_W") {
        report.differs(at("the edge of its clock"));
    }
    // What the design leaves open is 0.
    let rows = (0..16).map(|row| parameter(cell, &format!("INIT_{row:X}")));
    let contents = rows.flat_map(|mut bits| {
        bits.resize(256, false);
        bits.chunks(16)
            .map(|word| number(word.to_vec()) as u16)
            .collect::<Vec<_>>()
    });
    let contents: Vec<u16> = contents.collect();
    let differ = (0..MEMORY_WORDS).filter(|word| contents.get(*word) != memory.contents.get(*word));
    for word in differ {
        report.differs(at(&format!("word {word}")));
    }
    for (port, width, level) in MEMORY_INPUTS {
        for bit in 0..width {
            let name = if width == 1 {
                port.to_owned()
            } else {
                format!("{port}_{bit}")
            };
            let net = memory.port(port).get(bit).and_then(|net| bits.driver(*net));
            report.connection(|| at(&name), routed.driver_or(cell, &name, level), net);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boards::board;
    use serde_json::json;

    /// A flip-flop that drives the line to the host, with its table and a carry.
    const BITS: &str = "\
module chip (input pin_35, input pin_6, output pin_9);
assign n2 = /* LUT    1  2  3 */ (pin_9 ? pin_6 : 1'b0);
assign n4 = /* CARRY  1  2  3 */ (pin_6 & 1'b0) | ((pin_6 | 1'b0) & n3);
assign n3 = 1;
/* FF  1  2  3 */ always @(posedge pin_35) if (1'b1) pin_9 <= pin_6 ? 1'b0 : n2;
endmodule
";

    fn routed() -> Value {
        let pin = |net: u64, port: &str, inside: u64| json!({"type": "SB_IO", "attributes": {}, "connections": {"PACKAGE_PIN": [net], port: [inside]}});
        json!({
            "ports": {"clk": {"bits": [2]}, "serial_rx": {"bits": [3]}, "serial_tx": {"bits": [4]}},
            "cells": {
                "clk_pin": pin(2, "D_IN_0", 5),
                "rx_pin": pin(3, "D_IN_0", 7),
                "tx_pin": pin(4, "D_OUT_0", 8),
                "buffer": {"type": "SB_GB", "connections": {"USER_SIGNAL_TO_GLOBAL_BUFFER": [5], "GLOBAL_BUFFER_OUTPUT": [6]}},
                "cell": {
                    "type": "ICESTORM_LC",
                    "attributes": {"NEXTPNR_BEL": "X1/Y2/lc3"},
                    "parameters": {
                        "DFF_ENABLE": "1", "CARRY_ENABLE": "1", "CIN_CONST": "1", "CIN_SET": "1",
                        "SET_NORESET": "0", "NEG_CLK": "0", "ASYNC_SR": "0"
                    },
                    "connections": {"O": [8], "I0": ["x"], "I1": [7], "I2": [], "I3": [8], "CLK": [6], "CEN": [], "SR": [7], "COUT": [9]}
                }
            }
        })
    }

    fn compared(bits: &str, routed: &Value) -> CellsReport {
        let netlist = IceboxNetlist::read(bits).unwrap();
        compare_cells(&netlist, routed, &board("icebreaker").unwrap()).unwrap()
    }

    /// The router's netlist with this table, highest entry first.
    fn with_table(table: &str) -> Value {
        let mut routed = routed();
        routed["cells"]["cell"]["parameters"]["LUT_INIT"] = json!(table);
        routed
    }

    #[test]
    fn equal_netlists_have_no_difference_and_what_was_compared_is_counted() {
        let report = compared(BITS, &with_table("0000010000000000"));
        assert_eq!(
            (report.differences, report.tables, report.flip_flops, report.carries),
            (0, 1, 1, 1),
            "{report:?}"
        );
        // Two inputs of the table, three of the flip-flop, three of the carry, one pin.
        assert_eq!(report.connections, 9);
        // Entries that the open inputs cannot select do not count.
        assert_eq!(compared(BITS, &with_table("1000010000000010")).differences, 0);
        assert_eq!(compared(BITS, &with_table("0000000000000000")).differences, 1);
    }

    #[test]
    fn every_difference_of_a_cell_is_found() {
        let routed = with_table("0000010000000000");
        let cell = "/* FF  1  2  3 */ always @(posedge pin_35) if (1'b1) pin_9 <= pin_6 ? 1'b0 : n2;";
        for (from, to) in [
            ("(pin_9 ? pin_6 : 1'b0)", "(pin_9 ? 1'b0 : pin_6)"),
            ("(pin_9 ? pin_6 : 1'b0)", "(pin_9 ? n4 : 1'b0)"),
            (
                "(pin_6 & 1'b0) | ((pin_6 | 1'b0) & n3)",
                "(pin_6 & pin_9) | ((pin_6 | pin_9) & n3)",
            ),
            ("n3 = 1", "n3 = 0"),
            ("if (1'b1)", "if (pin_6)"),
            ("pin_6 ? 1'b0 : n2", "pin_6 ? 1'b1 : n2"),
            ("pin_6 ? 1'b0 : n2", "1'b0 ? 1'b0 : n2"),
            ("posedge pin_35", "posedge pin_6"),
            (cell, "/* FF  1  2  3 */ assign pin_9 = n2;"),
            ("LUT    1  2  3", "LUT    1  2  4"),
            ("CARRY  1  2  3", "CARRY  1  2  4"),
            (
                "endmodule",
                "assign n9 = /* LUT 5 5 0 */ !pin_6;\n/* FF 5 5 0 */ assign n8 = n9;\nendmodule",
            ),
            (
                "endmodule",
                "/* FF 5 5 0 */ always @(posedge pin_35) if (1'b1) n8 <= 1'b0 ? 1'b0 : n2;\nendmodule",
            ),
            ("output pin_9", "output pin_9, output pin_11"),
        ] {
            let bits = BITS.replace(from, to);
            assert_ne!(bits, BITS, "{from}");
            assert!(compared(&bits, &routed).differences > 0, "{to}");
        }
    }

    #[test]
    fn a_cell_that_only_passes_a_net_is_followed() {
        let passed = "assign n9 = /* LUT 5 5 0 */ pin_6;\n/* FF 5 5 0 */ assign n8 = n9;\nendmodule";
        let bits = BITS
            .replace("(pin_9 ? pin_6 : 1'b0)", "(pin_9 ? n8 : 1'b0)")
            .replace("endmodule", passed);
        let report = compared(&bits, &with_table("0000010000000000"));
        assert_eq!((report.differences, report.passed_through), (0, 1), "{report:?}");
    }
}
