//! The programs of a family, and the netlist of its bits, in the form in which a bitstream of any family is built and compared.

use crate::BitstreamError;
use crate::boards::{FpgaBoard, FpgaFamily, TopPin};
use crate::ecp5::tools::Ecp5Tools;
use crate::gowin::tools::GowinTools;
use crate::ice40::tools::Ice40Tools;
use crate::network::{NetIndex, Network};
use crate::report::{CellsReport, FlipKind, TilesReport};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Result of synthesis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Synthesised {
    /// Look-up tables, or flip-flops if there are more of them: the fewest logic cells that hold both.
    pub logic_cells: u64,
    /// Block RAMs.
    pub memories: u64,
}

/// Result of place and route.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Routed {
    /// The bitstream as text.
    pub text: String,
    /// The placed and routed netlist, as nextpnr writes it.
    pub netlist: Value,
    /// Highest frequency of the clock in MHz, by nextpnr's timing model.
    pub highest_mhz: f64,
}

/// The programs of a family. They work in the folder that each step names.
pub trait Toolchain: Send + Sync {
    /// Versions of Yosys and nextpnr, for the report.
    ///
    /// # Errors
    /// The error of a program that does not start.
    fn versions(&self, folder: &Path) -> Result<[String; 2], BitstreamError>;

    /// The versions with which posicast is tested, in the form of [`versions`](Self::versions).
    fn tested_versions(&self) -> [&'static str; 2];

    /// What Yosys and nextpnr are told, but for the files: equal for equal results of equal programs.
    fn recipe(&self, top: &str) -> String;

    /// Synthesises the module `top` of these files into `folder`. Multipliers are made of logic: the netlist of the bits cannot show the
    /// device's own.
    ///
    /// # Errors
    /// The error of Yosys.
    fn synthesise(&self, files: &[PathBuf], top: &str, folder: &Path) -> Result<Synthesised, BitstreamError>;

    /// Places and routes what [`synthesise`](Self::synthesise) left in `folder`, with these constraints.
    ///
    /// # Errors
    /// The error of nextpnr; a clock that is too slow is none.
    fn place_and_route(&self, constraints: &str, folder: &Path) -> Result<Routed, BitstreamError>;

    /// The text of a bitstream with this line among its comments, which the packed file keeps.
    fn labelled(&self, text: &str, label: &str) -> String;

    /// Packs a bitstream that is given as text.
    ///
    /// # Errors
    /// The error of the program.
    fn pack(&self, text: &str, folder: &Path) -> Result<Vec<u8>, BitstreamError>;

    /// Unpacks a packed bitstream into text. A wrong checksum is an error of the program.
    ///
    /// # Errors
    /// The error of the program.
    fn unpack(&self, bits: &[u8], folder: &Path) -> Result<String, BitstreamError>;

    /// Compares what was read back with what the router wrote.
    ///
    /// # Errors
    /// The error of a program.
    fn compare_tiles(
        &self,
        routed: &Routed,
        packed: &[u8],
        read_back: &str,
        folder: &Path,
    ) -> Result<TilesReport, BitstreamError>;

    /// The tiles in which two bitstreams differ.
    fn different_tiles(&self, text: &str, other: &str) -> Vec<String>;

    /// The text with one bit flipped, and the place of the bit in words.
    fn flipped(&self, text: &str, bit: TextBit) -> (String, String);

    /// Decodes an unpacked bitstream into its netlist.
    ///
    /// # Errors
    /// The error of a program; [`BitstreamError::UnknownCell`] for what is not known here.
    fn decode(&self, text: &str, folder: &Path) -> Result<Box<dyn BitsNetlist>, BitstreamError>;
}

/// A bit of a bitstream's text: of the digit at a line and a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TextBit {
    /// Line, from 0.
    pub line: usize,
    /// Column, from 0.
    pub column: usize,
    /// Bit of the digit: only memories have digits of more than one.
    pub bit: usize,
}

/// The netlist of the bits.
pub trait BitsNetlist: Send + Sync {
    /// The netlist in the form that is simulated.
    fn network(&self) -> Network;

    /// Compares it with the router's netlist: cell by cell, connection by connection.
    ///
    /// # Errors
    /// [`BitstreamError::Unreadable`] for a router's netlist of another form, [`BitstreamError::UnknownCell`] for a kind of cell that is
    /// not compared here.
    fn compare_cells(&self, routed: &Value) -> Result<CellsReport, BitstreamError>;

    /// The net of the bits that has this name in the router's netlist.
    ///
    /// # Errors
    /// [`BitstreamError::UnknownCell`] if there is none.
    fn net(&self, routed: &Value, name: &str) -> Result<NetIndex, BitstreamError>;

    /// The bits of this kind that a flip may change, in the text that the netlist was decoded from.
    fn flips(&self, text: &str, kind: FlipKind) -> Vec<TextBit>;

    /// Files with its Verilog, whose main module and file have this name.
    fn verilog(&self, module: &str) -> Vec<(String, String)>;
}

/// Finds the programs for a board, of which a top uses these pins.
///
/// # Errors
/// [`BitstreamError::Missing`] with the names of all that are missing.
pub fn installed(board: &FpgaBoard, pins: &[TopPin]) -> Result<Box<dyn Toolchain>, BitstreamError> {
    Ok(match board.device.family() {
        FpgaFamily::Ice40 => Box::new(Ice40Tools::installed(*board)?),
        FpgaFamily::Ecp5 => Box::new(Ecp5Tools::installed(*board, pins)?),
        FpgaFamily::Gowin => Box::new(GowinTools::installed(*board, pins)?),
    })
}

impl Synthesised {
    /// Checks that the device has enough of everything.
    ///
    /// # Errors
    /// [`BitstreamError::TooLarge`] with the first resource that is too small.
    pub fn check_fit(&self, board: &FpgaBoard) -> Result<(), BitstreamError> {
        let device = board.device;
        let rows = [
            ("logic cells", self.logic_cells, device.logic_cells()),
            ("block RAMs", self.memories, device.memories()),
        ];
        match rows.into_iter().find(|(_, needed, available)| needed > available) {
            Some((resource, needed, available)) => Err(BitstreamError::TooLarge {
                device: device.name(),
                resource,
                needed,
                available,
            }),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boards::board;

    #[test]
    fn a_design_that_is_too_large_names_the_resource_and_what_is_missing() {
        let board = board("icebreaker").unwrap();
        let of = |logic_cells, memories| Synthesised { logic_cells, memories };
        assert!(of(5280, 30).check_fit(&board).is_ok());
        let cells = of(5300, 31).check_fit(&board).unwrap_err().to_string();
        assert_eq!(
            cells,
            "does not fit iCE40UP5K: 5300 logic cells needed, 5280 available, 20 too few"
        );
        let memories = of(1, 31).check_fit(&board).unwrap_err().to_string();
        assert_eq!(
            memories,
            "does not fit iCE40UP5K: 31 block RAMs needed, 30 available, 1 too few"
        );
    }
}
