//! The pads of the bits.

use super::database::{Database, Pad};
use super::routing::{CellPort, OutputPort, Routing};
use crate::BitstreamError;
use crate::boards::{PinUse, TopPin};

impl Pad {
    /// What the pad drives inside the device.
    #[must_use]
    pub fn output(self) -> CellPort {
        CellPort {
            row: self.row,
            column: self.column,
            port: OutputPort::Pad(self.letter),
        }
    }
}

/// The beginning of the setting of a pad in this direction.
fn base_type(direction: PinUse) -> &'static str {
    match direction {
        PinUse::Input => "INPUT_",
        PinUse::Output => "OUTPUT_",
    }
}

/// Checks that the pads in use are those of the board's pins, each in its direction.
pub(super) fn check(routing: &Routing<'_>, database: &Database, pins: &[TopPin]) -> Result<(), BitstreamError> {
    let expected = pins.iter().map(|pin| Ok((database.pad(pin.pin)?, pin.direction)));
    let expected = expected.collect::<Result<Vec<_>, BitstreamError>>()?;
    for (row, column) in routing.places() {
        for (name, value) in routing.settings(row, column) {
            let letter = name
                .strip_prefix("PIO")
                .and_then(|name| name.strip_suffix(".BASE_TYPE"));
            let (Some(letter), true) = (letter, value != "NONE") else {
                continue;
            };
            // The settings of a pad lie in its tile, or in the one beside or below it.
            let is_here = |(pad, direction): &(Pad, PinUse)| {
                let near = pad.row.abs_diff(row) <= 2 && pad.column.abs_diff(column) <= 1;
                near && letter.starts_with(pad.letter) && value.starts_with(base_type(*direction))
            };
            if !expected.iter().any(is_here) {
                return Err(BitstreamError::UnknownCell(format!(
                    "a pad that the top does not use, PIO{letter} at R{row}C{column}: {value}"
                )));
            }
        }
    }
    Ok(())
}
