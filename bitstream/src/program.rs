//! Runs the programs that build a bitstream and read it back. Each has a time limit.

use crate::BitstreamError;
use crate::error::at;
use posicast_system::tool::{self, Ended};
use serde_json::Value;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Time limit of synthesis, and of place and route.
pub(crate) const BUILD_LIMIT: Duration = Duration::from_secs(3600);
/// Time limit of the programs that convert files.
pub(crate) const CONVERT_LIMIT: Duration = Duration::from_secs(600);
/// Seed of place and route: another seed places differently and is another bitstream.
pub(crate) const SEED: &str = "1";
/// Memory of a program, in KiB.
const MEMORY_KIB: u64 = 2 << 20;
/// Last lines of a program's output that an error repeats.
const LAST_LINES: usize = 8;

/// A program.
#[derive(Debug, Clone)]
pub(crate) struct Program {
    path: PathBuf,
    name: &'static str,
    /// Whether its memory is limited where the system can do that. A program in WebAssembly asks for far more than it uses, and is limited
    /// to 4 GiB by itself.
    is_limited: bool,
}

/// Programs that were looked for.
#[derive(Debug, Default)]
pub(crate) struct Search {
    missing: Vec<&'static str>,
}

impl Search {
    /// Finds a program: what the environment variable names, or the first of these names that is installed.
    pub(crate) fn find(&mut self, variable: &str, names: &[&'static str]) -> Program {
        let programs = tool::executables(variable, names);
        let found = programs.iter().find_map(|program| tool::located(program));
        if found.is_none() {
            self.missing.push(names[0]);
        }
        Program::at(found.unwrap_or_default(), names[0])
    }

    /// Finds a program that comes with another one: in the same folder, or among those that are installed.
    pub(crate) fn find_beside(&mut self, other: &Program, names: &[&'static str]) -> Program {
        let folder = other.path.parent().unwrap_or(Path::new(""));
        let beside = names.iter().map(|name| folder.join(name)).find(|path| path.exists());
        match beside {
            Some(path) if other.path.is_absolute() => Program::at(path, names[0]),
            _ => self.find("", names),
        }
    }

    /// # Errors
    /// [`BitstreamError::Missing`] with the names of all programs that were not found.
    pub(crate) fn end(self) -> Result<(), BitstreamError> {
        if self.missing.is_empty() {
            Ok(())
        } else {
            Err(BitstreamError::Missing(self.missing))
        }
    }
}

impl Program {
    /// The program in this file.
    pub(crate) fn at(path: PathBuf, name: &'static str) -> Self {
        let file = path.file_name().unwrap_or_default().to_string_lossy();
        Self {
            is_limited: !file.starts_with("yowasp"),
            path,
            name,
        }
    }

    /// The program's file.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Runs the program in `folder` and returns its output.
    pub(crate) fn run(
        &self,
        doing: &'static str,
        arguments: &[OsString],
        folder: &Path,
        limit: Duration,
    ) -> Result<String, BitstreamError> {
        let mut command = if cfg!(unix) && self.is_limited {
            let mut shell = tool::command_in("sh", folder);
            shell.args(["-c", &format!("ulimit -v {MEMORY_KIB}; exec \"$0\" \"$@\"")]);
            shell.arg(&self.path);
            shell
        } else {
            tool::command_in(&self.path, folder)
        };
        let tool = self.name;
        match tool::run_within(command.args(arguments), limit).map_err(at(&self.path))? {
            Ended::Well(printed) => Ok(printed),
            Ended::Badly { printed, .. } => Err(BitstreamError::ToolFailed {
                tool,
                doing,
                last_lines: tool::last_lines(&printed, LAST_LINES),
            }),
            Ended::TimeOut => Err(BitstreamError::TimeOut { tool, doing, limit }),
        }
    }

    /// Runs the program on the file `from`, which it turns into the file `to`.
    pub(crate) fn convert(
        &self,
        doing: &'static str,
        (from, contents): (&str, &[u8]),
        to: &str,
        folder: &Path,
    ) -> Result<Vec<u8>, BitstreamError> {
        let (input, output) = (folder.join(from), folder.join(to));
        fs::write(&input, contents).map_err(at(&input))?;
        self.run(doing, &[from.into(), to.into()], folder, CONVERT_LIMIT)?;
        fs::read(&output).map_err(at(&output))
    }

    /// The program's version by the line that it prints.
    pub(crate) fn version(&self, option: &str, folder: &Path) -> Result<String, BitstreamError> {
        let printed = self.run("printing its version", &[option.into()], folder, CONVERT_LIMIT)?;
        let line = tool::version_line(&printed);
        let version = line.split("(Version ").nth(1).and_then(|rest| rest.split(')').next());
        Ok(match version {
            Some(version) => format!("{} {}", self.name, version.trim_start_matches("nextpnr-")),
            None => line.split(" (").next().unwrap_or_default().to_owned(),
        })
    }

    /// An error for a result of an unknown form.
    pub(crate) fn unreadable(&self, reason: &str) -> BitstreamError {
        BitstreamError::Unreadable {
            tool: self.name,
            reason: reason.to_owned(),
        }
    }

    /// Reads a JSON file that the program wrote.
    pub(crate) fn json(&self, path: &Path) -> Result<Value, BitstreamError> {
        serde_json::from_str(&text(path)?).map_err(|error| self.unreadable(&error.to_string()))
    }
}

/// What nextpnr leaves: the placed netlist in `routed.json`, and the highest clock in `report.json`.
pub(crate) fn routed(nextpnr: &Program, folder: &Path) -> Result<(Value, f64), BitstreamError> {
    let report = nextpnr.json(&folder.join("report.json"))?;
    let clocks = report["fmax"].as_object().into_iter().flatten();
    let slowest = clocks
        .filter_map(|(_, clock)| clock["achieved"].as_f64())
        .reduce(f64::min);
    let routed = nextpnr.json(&folder.join("routed.json"))?;
    let modules = routed["modules"].as_object();
    let netlist = modules.and_then(|modules| modules.values().next()).cloned();
    Ok((
        netlist.ok_or_else(|| nextpnr.unreadable("no module in its netlist"))?,
        slowest.ok_or_else(|| nextpnr.unreadable("no clock in its report"))?,
    ))
}

/// Types of the cells of the module `top` in the netlist that Yosys wrote.
pub(crate) fn cell_types(yosys: &Program, top: &str, folder: &Path) -> Result<Vec<String>, BitstreamError> {
    let netlist = yosys.json(&folder.join("top.json"))?;
    let cells = netlist["modules"][top]["cells"].as_object().into_iter().flatten();
    Ok(cells
        .filter_map(|(_, cell)| Some(cell["type"].as_str()?.to_owned()))
        .collect())
}

pub(crate) fn text(path: &Path) -> Result<String, BitstreamError> {
    fs::read_to_string(path).map_err(at(path))
}
