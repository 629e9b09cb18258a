//! The settings of slices: two look-up tables with a carry chain, and two flip-flops.

use super::decode::unknown;
use super::routing::{CellPort, OutputPort, Routing, Source, slice_letter};
use crate::BitstreamError;

/// A table without settings.
const OPEN_TABLE: u16 = u16::MAX;

/// What drives an input of a table.
pub(super) fn table_input(
    routing: &Routing<'_>,
    (row, column): (u8, u8),
    table: u8,
    pin: &str,
) -> Result<Source, BitstreamError> {
    let key = format!("SLICE{}.{pin}{}MUX", slice_letter(table / 2), table % 2);
    match routing.setting(row, column, &key) {
        Some("1") => Ok(Source::Constant(true)),
        _ => routing.source(row, column, &format!("{pin}{table}_SLICE")),
    }
}

/// The table whose carry goes into a table; `None` where the chain begins.
pub(super) fn carry_before(routing: &Routing<'_>, row: u8, column: u8, table: u8) -> Option<CellPort> {
    let (row, column, before) = match table.checked_sub(1) {
        Some(before) => (row, column, before),
        None => {
            let (row, column) = routing.carry_from(row, column)?;
            (row, column, 7)
        }
    };
    routing.is_carry_chain(row, column, before / 2).then_some(CellPort {
        row,
        column,
        port: OutputPort::Carry(before),
    })
}

/// The settings of a table's half of a slice.
pub(super) struct SliceSettings<'a> {
    routing: &'a Routing<'a>,
    row: u8,
    column: u8,
    table: u8,
}

impl<'a> SliceSettings<'a> {
    pub(super) fn new(routing: &'a Routing<'a>, row: u8, column: u8, table: u8) -> Self {
        Self {
            routing,
            row,
            column,
            table,
        }
    }

    fn of_slice(&self, key: &str) -> Option<&'a str> {
        let key = format!("SLICE{}.{key}", slice_letter(self.table / 2));
        self.routing.setting(self.row, self.column, &key)
    }

    pub(super) fn mode(&self) -> &'a str {
        self.of_slice("MODE").unwrap_or("LOGIC")
    }

    /// The values of the table: bit `i` for inputs A, B, C and D whose levels are the bits of `i`.
    pub(super) fn table(&self) -> Result<u16, BitstreamError> {
        let key = format!("K{}.INIT", self.table % 2);
        match self.of_slice(&key) {
            None => Ok(OPEN_TABLE),
            Some(digits) => u16::from_str_radix(digits, 2).map_err(|_| self.unknown(&format!("{key} {digits}"))),
        }
    }

    /// Whether the table passes the carry on without adding it, and makes none.
    pub(super) fn is_carry_alone(&self) -> Result<bool, BitstreamError> {
        let key = format!("CCU2.INJECT1_{}", self.table % 2);
        match self.of_slice(&key) {
            None | Some("YES") => Ok(true),
            Some("NO") => Ok(false),
            Some(other) => Err(self.unknown(&format!("{key} {other}"))),
        }
    }

    fn unknown(&self, what: &str) -> BitstreamError {
        let output = CellPort {
            row: self.row,
            column: self.column,
            port: OutputPort::Table(self.table),
        };
        unknown(output, what)
    }
}

/// How a flip-flop is enabled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Enable {
    Always,
    Never,
    Line { is_inverted: bool },
}

/// The reset of a flip-flop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct ResetLine {
    /// 0 or 1 of the tile's two.
    pub(super) line: u8,
    pub(super) is_inverted: bool,
    pub(super) is_asynchronous: bool,
}

/// The settings of a flip-flop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct FlopSettings {
    /// Whether it takes its data from the table beside it, not from its own wire.
    pub(super) is_from_table: bool,
    /// Its clock: 0 or 1 of the tile's two.
    pub(super) clock: Option<u8>,
    pub(super) enable: Enable,
    pub(super) reset: Option<ResetLine>,
    /// Its value after a reset, and after configuration.
    pub(super) reset_to: bool,
}

impl FlopSettings {
    pub(super) fn new(routing: &Routing<'_>, row: u8, column: u8, flop: u8) -> Result<Self, BitstreamError> {
        let output = CellPort {
            row,
            column,
            port: OutputPort::Flop(flop),
        };
        let (slice, half) = (flop / 2, flop % 2);
        let letter = slice_letter(slice);
        let setting = |key: String| routing.setting(row, column, &key);
        let one_of = |key: String, default: &'static str, known: [&'static str; 2]| {
            let value = setting(key.clone()).unwrap_or(default);
            let index = known.iter().position(|name| *name == value);
            index
                .ok_or_else(|| unknown(output, &format!("{key} {value}")))
                .map(|index| index == 1)
        };
        // The tile's clock or reset that a slice takes.
        let line = |wire: String| {
            let name = routing.driver_name(row, column, &wire)?;
            name.as_bytes().last().map(|digit| digit - b'0')
        };
        let register = |key: &str| format!("SLICE{letter}.REG{half}.{key}");
        if one_of(register("LSRMODE"), "LSR", ["LSR", "PRLD"])? {
            return Err(unknown(output, "a flip-flop that loads at its reset"));
        }
        let clock = line(format!("MUXCLK{slice}"));
        if let Some(clock) = clock
            && one_of(format!("CLK{clock}.CLKMUX"), "CLK", ["CLK", "INV"])?
        {
            return Err(unknown(output, "a flip-flop at the falling edge"));
        }
        let reset = match line(format!("MUXLSR{slice}")) {
            None => None,
            Some(reset) => {
                let mode = format!("LSR{reset}.SRMODE");
                Some(ResetLine {
                    line: reset,
                    is_inverted: one_of(format!("LSR{reset}.LSRMUX"), "LSR", ["LSR", "INV"])?,
                    is_asynchronous: one_of(mode, "LSR_OVER_CE", ["LSR_OVER_CE", "ASYNC"])?,
                })
            }
        };
        let enable = match setting(format!("SLICE{letter}.CEMUX")).unwrap_or("CE") {
            "CE" => Enable::Line { is_inverted: false },
            "INV" => Enable::Line { is_inverted: true },
            "1" => Enable::Always,
            "0" => Enable::Never,
            other => return Err(unknown(output, &format!("CEMUX {other}"))),
        };
        Ok(Self {
            is_from_table: one_of(register("SD"), "1", ["0", "1"])?,
            clock,
            enable,
            reset,
            reset_to: one_of(register("REGSET"), "SET", ["RESET", "SET"])?,
        })
    }
}
