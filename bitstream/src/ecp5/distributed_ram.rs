//! Distributed RAM: 16 words of four bits in the look-up tables of slices A and B, whose write port is slice C.
//!
//! ```text
//!  slice C, inputs of its tables          A0 B0 C0 D0   C1 A1 D1 B1
//!                                          └──┴──┴──┴─ address  └──┴──┴──┴─ data of tables 0, 1 (slice A), 2, 3 (slice B)
//!  tables 0 to 3, inputs                   A  B  C  D ─ address that is read, at once
//!  the tile's CLK1 and LSR1                clock and write enable
//! ```
//!
//! The order of the address is that of the tables' inputs. Sources: `TRELLIS_SLICE` in Yosys' `techlibs/ecp5/cells_sim.v` (modes `RAMW` and
//! `DPRAM`), and nextpnr's packing of `TRELLIS_DPR16X4`. One bit of the tile puts all three slices into this mode, and one inverts the wire
//! of the write enable, for flip-flops, too (Project Trellis' database, `PLC2/bits.db`).

use super::decode::unknown;
use super::routing::{CellPort, OutputPort, Routing};
use crate::BitstreamError;

/// Tables that are memories.
pub(super) const TABLES: u8 = 4;
/// Bits of an address, and bits of a word.
pub(super) const BITS: u8 = 4;

/// The write enable of a distributed RAM.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum WriteEnable {
    Never,
    Always,
    Line { is_inverted: bool },
}

/// The input of slice C that is this bit of the write port, as its pin and table 4 or 5; `None` for an output of another cell.
pub(super) fn write_port_input(port: OutputPort) -> Option<(&'static str, u8)> {
    let (pins, table, bit) = match port {
        OutputPort::WriteAddress(bit) => (["D", "B", "C", "A"], 4, bit),
        OutputPort::WriteData(bit) => (["C", "A", "D", "B"], 5, bit),
        _ => return None,
    };
    pins.get(usize::from(bit)).map(|pin| (*pin, table))
}

/// The wires into a table that write it.
pub(super) struct WriteWires {
    pub(super) clock: String,
    pub(super) enable: String,
    /// In the order of the table's inputs A, B, C and D.
    pub(super) address: [String; 4],
    pub(super) data: String,
}

/// The wires that write table 0 to 3 of a tile.
pub(super) fn write_wires(table: u8) -> WriteWires {
    let (slice, half) = (table / 2, table % 2);
    let letter = ["A", "B"][usize::from(slice % 2)];
    WriteWires {
        clock: format!("WCK{slice}_SLICE"),
        enable: format!("WRE{slice}_SLICE"),
        address: [3, 1, 2, 0].map(|bit| format!("WAD{bit}{letter}_SLICE")),
        data: format!("WD{half}{letter}_SLICE"),
    }
}

/// The write enable of the distributed RAM in a tile, of which `output` is a table.
///
/// # Errors
/// [`BitstreamError::UnknownCell`] if the tile is not one, or writes at the falling edge.
pub(super) fn write_enable(routing: &Routing<'_>, output: CellPort) -> Result<WriteEnable, BitstreamError> {
    let setting = |key: &str| routing.setting(output.row, output.column, key);
    let is_table = matches!(output.port, OutputPort::Table(table) if table < TABLES);
    if !is_table || setting("SLICEC.MODE") != Some("RAMW") {
        return Err(unknown(output, "a distributed RAM without its write port"));
    }
    if setting("CLK1.CLKMUX") == Some("INV") {
        return Err(unknown(output, "a distributed RAM that is written at the falling edge"));
    }
    let is_line_inverted = setting("LSR1.LSRMUX") == Some("INV");
    Ok(match setting("SLICEA.WREMUX").unwrap_or("WRE") {
        "WRE" => WriteEnable::Line {
            is_inverted: is_line_inverted,
        },
        "INV" => WriteEnable::Line { is_inverted: true },
        "1" => WriteEnable::Always,
        "0" => WriteEnable::Never,
        other => return Err(unknown(output, &format!("WREMUX {other}"))),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `WADO0 = D0, WADO1 = B0, WADO2 = C0, WADO3 = A0`, and `RAD0 = D, RAD1 = B, RAD2 = C, RAD3 = A` in Yosys' model of a slice.
    #[test]
    fn an_input_of_slice_c_addresses_the_entries_that_the_same_input_of_a_table_reads() {
        let wires = write_wires(2);
        for (pin, wire) in ["A", "B", "C", "D"].into_iter().zip(&wires.address) {
            let bit = wire.as_bytes()[3] - b'0';
            assert_eq!(
                write_port_input(OutputPort::WriteAddress(bit)),
                Some((pin, 4)),
                "{wire}"
            );
            assert!(wire.ends_with("B_SLICE"));
        }
    }

    /// `WDO0 = C1, WDO1 = A1, WDO2 = D1, WDO3 = B1` in the same model.
    #[test]
    fn a_bit_of_the_data_has_its_input() {
        let pins = [0, 1, 2, 3].map(|bit| write_port_input(OutputPort::WriteData(bit)));
        assert_eq!(pins, ["C", "A", "D", "B"].map(|pin| Some((pin, 5))));
        assert_eq!(
            [0, 1, 2, 3].map(|table| write_wires(table).data),
            ["WD0A_SLICE", "WD1A_SLICE", "WD0B_SLICE", "WD1B_SLICE"]
        );
        assert_eq!(write_port_input(OutputPort::Flop(0)), None);
    }
}
