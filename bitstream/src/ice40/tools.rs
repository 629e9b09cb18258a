//! The programs that build a bitstream and read it back. Each has a time limit, and a limit of memory where the system has one.

use crate::BitstreamError;
use crate::boards::FpgaBoard;
use crate::error::at;
use posicast_system::tool::{self, Ended};
use serde_json::Value;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Memory of a program, in KiB.
const MEMORY_KIB: u64 = 2 << 20;
/// Time limit of synthesis, and of place and route.
const BUILD_LIMIT: Duration = Duration::from_secs(1800);
/// Time limit of the programs that convert files.
const CONVERT_LIMIT: Duration = Duration::from_secs(600);
/// Last lines of a program's output that an error repeats.
const LAST_LINES: usize = 8;
/// Seed of place and route: another seed places differently and is another bitstream.
const SEED: &str = "1";
/// Name of the module that the netlist of the bits becomes.
const NETLIST_MODULE: &str = "chip";

/// The installed programs.
#[derive(Debug, Clone)]
pub struct Ice40Tools {
    yosys: PathBuf,
    nextpnr: PathBuf,
    icepack: PathBuf,
    iceunpack: PathBuf,
    icebox_vlog: PathBuf,
}

/// Result of synthesis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Synthesised {
    /// Look-up tables, or flip-flops if there are more of them: the fewest logic cells that hold both.
    pub logic_cells: u64,
    /// Block RAMs.
    pub memories: u64,
}

/// Result of place and route.
#[derive(Debug, Clone)]
pub struct Routed {
    /// The bitstream as text.
    pub asc: String,
    /// The placed and routed netlist, as nextpnr writes it.
    pub netlist: Value,
    /// Highest frequency of the clock in MHz, by nextpnr's timing model.
    pub highest_mhz: f64,
}

impl Ice40Tools {
    /// Finds the programs.
    ///
    /// # Errors
    /// [`BitstreamError::Missing`] with the names of all that are missing.
    pub fn installed() -> Result<Self, BitstreamError> {
        let mut missing = Vec::new();
        let mut find = |variable: &str, names: &[&'static str]| {
            let programs = tool::executables(variable, names);
            let found = programs.iter().find_map(|program| tool::located(program));
            if found.is_none() {
                missing.push(names[0]);
            }
            found.unwrap_or_default()
        };
        let tools = Self {
            yosys: find("POSICAST_YOSYS", &["yosys"]),
            nextpnr: find("POSICAST_NEXTPNR_ICE40", &["nextpnr-ice40"]),
            icepack: find("", &["icepack"]),
            iceunpack: find("", &["iceunpack"]),
            icebox_vlog: find("", &["icebox_vlog"]),
        };
        if missing.is_empty() {
            Ok(tools)
        } else {
            Err(BitstreamError::Missing(missing))
        }
    }

    /// Versions of Yosys and nextpnr, for the report.
    ///
    /// # Errors
    /// The error of a program that does not start.
    pub fn versions(&self, folder: &Path) -> Result<[String; 2], BitstreamError> {
        let first_line = |printed: String| printed.lines().next().unwrap_or_default().trim().to_owned();
        let yosys = run(
            &self.yosys,
            ("yosys", "printing its version"),
            &["-V".into()],
            folder,
            CONVERT_LIMIT,
        )?;
        let arguments = ["--version".into()];
        let nextpnr = run(
            &self.nextpnr,
            ("nextpnr-ice40", "printing its version"),
            &arguments,
            folder,
            CONVERT_LIMIT,
        )?;
        let nextpnr = first_line(nextpnr);
        let version = nextpnr
            .split("(Version ")
            .nth(1)
            .and_then(|rest| rest.split(')').next());
        let nextpnr = version.map_or_else(|| nextpnr.clone(), |version| format!("nextpnr-ice40 {version}"));
        let yosys = first_line(yosys);
        Ok([yosys.split(" (").next().unwrap_or_default().to_owned(), nextpnr])
    }

    /// Synthesises the module `top` of these files into `folder`. Multipliers are made of logic: the netlist of the bits cannot show the
    /// device's own.
    ///
    /// # Errors
    /// The error of Yosys.
    pub fn synthesise(
        &self,
        files: &[PathBuf],
        (top, board): (&str, &FpgaBoard),
        folder: &Path,
    ) -> Result<Synthesised, BitstreamError> {
        let script = format!(
            "synth_ice40 -device {} -top {top} -json top.json",
            board.device.timing()
        );
        let mut arguments: Vec<OsString> = vec!["-q".into(), "-p".into(), script.into()];
        arguments.extend(files.iter().map(Into::into));
        run(
            &self.yosys,
            ("yosys", "synthesising the top"),
            &arguments,
            folder,
            BUILD_LIMIT,
        )?;
        let netlist = json("yosys", &folder.join("top.json"))?;
        let cells = netlist["modules"][top]["cells"].as_object();
        let types = || {
            cells
                .into_iter()
                .flat_map(|cells| cells.values())
                .filter_map(|cell| cell["type"].as_str())
        };
        let count = |begins: &str| types().filter(|of| of.starts_with(begins)).count() as u64;
        let (tables, flops) = (count("SB_LUT4"), count("SB_DFF"));
        Ok(Synthesised {
            logic_cells: tables.max(flops),
            memories: count("SB_RAM40_4K"),
        })
    }

    /// Places and routes what [`synthesise`](Self::synthesise) left in `folder`, with these constraints.
    ///
    /// # Errors
    /// The error of nextpnr; a clock that is too slow is none.
    pub fn place_and_route(
        &self,
        board: &FpgaBoard,
        constraints: &str,
        folder: &Path,
    ) -> Result<Routed, BitstreamError> {
        let pcf = folder.join("top.pcf");
        fs::write(&pcf, constraints).map_err(at(&pcf))?;
        let mhz = (f64::from(board.oscillator_hz) / 1e6).to_string();
        let words = [
            board.device.option(),
            "--package",
            board.package,
            "--json",
            "top.json",
            "--pcf",
            "top.pcf",
            "--asc",
        ];
        let more = [
            "top.asc",
            "--write",
            "routed.json",
            "--report",
            "report.json",
            "--freq",
            &mhz,
            "--seed",
            SEED,
            "-q",
        ];
        let mut arguments: Vec<OsString> = words.iter().chain(&more).map(Into::into).collect();
        arguments.push("--timing-allow-fail".into());
        let task = ("nextpnr-ice40", "placing and routing the top");
        run(&self.nextpnr, task, &arguments, folder, BUILD_LIMIT)?;
        let report = json("nextpnr-ice40", &folder.join("report.json"))?;
        let clocks = report["fmax"]
            .as_object()
            .into_iter()
            .flat_map(|clocks| clocks.values());
        let slowest = clocks.filter_map(|clock| clock["achieved"].as_f64()).reduce(f64::min);
        let routed = json("nextpnr-ice40", &folder.join("routed.json"))?;
        let modules = routed["modules"].as_object();
        let netlist = modules.and_then(|modules| modules.values().next());
        Ok(Routed {
            asc: text(&folder.join("top.asc"))?,
            netlist: netlist
                .cloned()
                .ok_or_else(|| unreadable("nextpnr-ice40", "no module in its netlist"))?,
            highest_mhz: slowest.ok_or_else(|| unreadable("nextpnr-ice40", "no clock in its report"))?,
        })
    }

    /// Packs a bitstream that is given as text.
    ///
    /// # Errors
    /// The error of icepack.
    pub fn pack(&self, asc: &str, folder: &Path) -> Result<Vec<u8>, BitstreamError> {
        let (from, to) = (folder.join("packed.asc"), folder.join("packed.bin"));
        fs::write(&from, asc).map_err(at(&from))?;
        let arguments = ["packed.asc".into(), "packed.bin".into()];
        run(
            &self.icepack,
            ("icepack", "packing the bits"),
            &arguments,
            folder,
            CONVERT_LIMIT,
        )?;
        fs::read(&to).map_err(at(&to))
    }

    /// Unpacks a packed bitstream into text. A wrong checksum is an error of iceunpack.
    ///
    /// # Errors
    /// The error of iceunpack.
    pub fn unpack(&self, bits: &[u8], folder: &Path) -> Result<String, BitstreamError> {
        let (from, to) = (folder.join("unpacked.bin"), folder.join("unpacked.asc"));
        fs::write(&from, bits).map_err(at(&from))?;
        let arguments = ["unpacked.bin".into(), "unpacked.asc".into()];
        run(
            &self.iceunpack,
            ("iceunpack", "unpacking the bits"),
            &arguments,
            folder,
            CONVERT_LIMIT,
        )?;
        text(&to)
    }

    /// Decodes an unpacked bitstream into a netlist in Verilog, whose ports are called `pin_` and the pin.
    ///
    /// # Errors
    /// The error of icebox_vlog.
    pub fn netlist(&self, board: &FpgaBoard, asc: &str, folder: &Path) -> Result<String, BitstreamError> {
        let from = folder.join("decoded.asc");
        fs::write(&from, asc).map_err(at(&from))?;
        let words = [
            "-s",
            "-S",
            "-l",
            "-d",
            board.package,
            "-n",
            NETLIST_MODULE,
            "decoded.asc",
        ];
        let arguments: Vec<OsString> = words.iter().map(Into::into).collect();
        run(
            &self.icebox_vlog,
            ("icebox_vlog", "decoding the bits"),
            &arguments,
            folder,
            CONVERT_LIMIT,
        )
    }
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

fn unreadable(tool: &'static str, reason: &str) -> BitstreamError {
    BitstreamError::Unreadable {
        tool,
        reason: reason.to_owned(),
    }
}

fn text(path: &Path) -> Result<String, BitstreamError> {
    fs::read_to_string(path).map_err(at(path))
}

fn json(tool: &'static str, path: &Path) -> Result<Value, BitstreamError> {
    serde_json::from_str(&text(path)?).map_err(|error| unreadable(tool, &error.to_string()))
}

/// Runs a program in `folder` and returns its output.
fn run(
    program: &Path,
    (tool, doing): (&'static str, &'static str),
    arguments: &[OsString],
    folder: &Path,
    limit: Duration,
) -> Result<String, BitstreamError> {
    let mut command = if cfg!(unix) {
        let mut shell = tool::command_in("sh", folder);
        shell.args(["-c", &format!("ulimit -v {MEMORY_KIB}; exec \"$0\" \"$@\"")]);
        shell.arg(program);
        shell
    } else {
        tool::command_in(program, folder)
    };
    match tool::run_within(command.args(arguments), limit).map_err(at(program))? {
        Ended::Well(printed) => Ok(printed),
        Ended::Badly { printed, .. } => Err(BitstreamError::ToolFailed {
            tool,
            doing,
            last_lines: tool::last_lines(&printed, LAST_LINES),
        }),
        Ended::TimeOut => Err(BitstreamError::TimeOut { tool, doing, limit }),
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
