//! The programs for iCE40.

use super::asc::{candidates, compare_tiles, flipped};
use super::structure::compare_cells;
use super::{IceboxNetlist, MEMORY_MODEL, legal_verilog};
use crate::BitstreamError;
use crate::boards::FpgaBoard;
use crate::error::at;
use crate::network::{NetIndex, Network};
use crate::program::{self, BUILD_LIMIT, CONVERT_LIMIT, Program, SEED, Search, cell_types};
use crate::report::{CellsReport, FlipKind, TilesReport};
use crate::toolchain::{self, Routed, Synthesised, TextBit, Toolchain};
use serde_json::Value;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

/// Name of the module that the netlist of the bits becomes.
const NETLIST_MODULE: &str = "chip";

/// The installed programs, for a board.
#[derive(Debug, Clone)]
pub struct Ice40Tools {
    board: FpgaBoard,
    yosys: Program,
    nextpnr: Program,
    icepack: Program,
    iceunpack: Program,
    icebox_vlog: Program,
}

impl Ice40Tools {
    /// Finds the programs.
    ///
    /// # Errors
    /// [`BitstreamError::Missing`] with the names of all that are missing.
    pub fn installed(board: FpgaBoard) -> Result<Self, BitstreamError> {
        let mut search = Search::default();
        let tools = Self {
            board,
            yosys: search.find("POSICAST_YOSYS", &["yosys"]),
            nextpnr: search.find("POSICAST_NEXTPNR_ICE40", &["nextpnr-ice40"]),
            icepack: search.find("", &["icepack"]),
            iceunpack: search.find("", &["iceunpack"]),
            icebox_vlog: search.find("", &["icebox_vlog"]),
        };
        search.end().map(|()| tools)
    }

    /// What Yosys is told.
    fn script(&self, top: &str) -> String {
        let timing = self.board.device.yosys_timing();
        format!("synth_ice40 -device {timing} -top {top} -json top.json")
    }

    fn nextpnr_arguments(&self) -> Vec<OsString> {
        let mhz = (f64::from(self.board.oscillator_hz) / 1e6).to_string();
        let option = self.board.device.nextpnr_option();
        let package = ["--package", self.board.package, "--pcf", "top.pcf"];
        let files = [
            "--json",
            "top.json",
            "--asc",
            "top.asc",
            "--write",
            "routed.json",
            "--report",
            "report.json",
        ];
        let more = ["--freq", &mhz, "--seed", SEED, "-q", "--timing-allow-fail"];
        let words = [option].into_iter().chain(package).chain(files).chain(more);
        words.map(Into::into).collect()
    }
}

impl Toolchain for Ice40Tools {
    fn versions(&self, folder: &Path) -> Result<[String; 2], BitstreamError> {
        Ok([
            self.yosys.version("-V", folder)?,
            self.nextpnr.version("--version", folder)?,
        ])
    }

    fn tested_versions(&self) -> [&'static str; 2] {
        ["Yosys 0.23", "nextpnr-ice40 0.4"]
    }

    fn recipe(&self, top: &str) -> String {
        format!("{} {:?}", self.script(top), self.nextpnr_arguments())
    }

    fn synthesise(&self, files: &[PathBuf], top: &str, folder: &Path) -> Result<Synthesised, BitstreamError> {
        let script = self.script(top);
        let mut arguments: Vec<OsString> = vec!["-q".into(), "-p".into(), script.into()];
        arguments.extend(files.iter().map(Into::into));
        self.yosys
            .run("synthesising the top", &arguments, folder, BUILD_LIMIT)?;
        let types = cell_types(&self.yosys, top, folder)?;
        let count = |begins: &str| types.iter().filter(|of| of.starts_with(begins)).count() as u64;
        Ok(Synthesised {
            logic_cells: count("SB_LUT4").max(count("SB_DFF")),
            memories: count("SB_RAM40_4K"),
        })
    }

    fn place_and_route(&self, constraints: &str, folder: &Path) -> Result<Routed, BitstreamError> {
        let pcf = folder.join("top.pcf");
        fs::write(&pcf, constraints).map_err(at(&pcf))?;
        let arguments = self.nextpnr_arguments();
        self.nextpnr
            .run("placing and routing the top", &arguments, folder, BUILD_LIMIT)?;
        let (netlist, highest_mhz) = program::routed(&self.nextpnr, folder)?;
        Ok(Routed {
            text: program::text(&folder.join("top.asc"))?,
            netlist,
            highest_mhz,
        })
    }

    fn labelled(&self, text: &str, label: &str) -> String {
        // icepack keeps the lines below the last `.comment`, and nextpnr begins with one that has none.
        let rest = match text.split_once('\n') {
            Some((first, rest)) if first.starts_with(".comment") => rest,
            _ => text,
        };
        format!(".comment\n{label}\n{rest}")
    }

    fn pack(&self, text: &str, folder: &Path) -> Result<Vec<u8>, BitstreamError> {
        let from = ("packed.asc", text.as_bytes());
        self.icepack.convert("packing the bits", from, "packed.bin", folder)
    }

    fn unpack(&self, bits: &[u8], folder: &Path) -> Result<String, BitstreamError> {
        let from = ("unpacked.bin", bits);
        let text = self
            .iceunpack
            .convert("unpacking the bits", from, "unpacked.asc", folder)?;
        Ok(String::from_utf8_lossy(&text).into_owned())
    }

    fn compare_tiles(
        &self,
        routed: &Routed,
        _: &[u8],
        read_back: &str,
        _: &Path,
    ) -> Result<TilesReport, BitstreamError> {
        Ok(compare_tiles(&routed.text, read_back))
    }

    fn different_tiles(&self, text: &str, other: &str) -> Vec<String> {
        compare_tiles(text, other).differences
    }

    fn decode(&self, text: &str, folder: &Path) -> Result<Box<dyn toolchain::BitsNetlist>, BitstreamError> {
        let from = folder.join("decoded.asc");
        fs::write(&from, text).map_err(at(&from))?;
        let package = self.board.package;
        let words = ["-s", "-S", "-l", "-d", package, "-n", NETLIST_MODULE, "decoded.asc"];
        let arguments = words.map(OsString::from);
        let verilog = self
            .icebox_vlog
            .run("decoding the bits", &arguments, folder, CONVERT_LIMIT)?;
        Ok(Box::new(Ice40Bits {
            netlist: IceboxNetlist::read(&verilog)?,
            verilog,
            board: self.board,
        }))
    }

    fn flipped(&self, text: &str, bit: TextBit) -> (String, String) {
        flipped(text, bit)
    }
}

/// The netlist of the bits, with the Verilog that it was read from.
struct Ice40Bits {
    netlist: IceboxNetlist,
    verilog: String,
    board: FpgaBoard,
}

impl toolchain::BitsNetlist for Ice40Bits {
    fn network(&self) -> Network {
        self.netlist.network()
    }

    fn compare_cells(&self, routed: &Value) -> Result<CellsReport, BitstreamError> {
        compare_cells(&self.netlist, routed, &self.board)
    }

    fn net(&self, _: &Value, name: &str) -> Result<NetIndex, BitstreamError> {
        Err(BitstreamError::UnknownCell(format!(
            "the net {name}: nets of iCE40 are not found by name"
        )))
    }

    fn flips(&self, text: &str, kind: FlipKind) -> Vec<TextBit> {
        candidates(text, kind, &self.netlist.memories)
    }

    fn verilog(&self, module: &str) -> Vec<(String, String)> {
        vec![
            (format!("{module}.v"), legal_verilog(&self.verilog)),
            ("SB_RAM40_4K.v".to_owned(), MEMORY_MODEL.to_owned()),
        ]
    }
}
