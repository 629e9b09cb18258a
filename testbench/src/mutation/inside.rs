//! Named mutants inside a stage: faults in a stage's Verilog that a check of its folder once did not find.
//!
//! ```text
//!  stage's modules ─► one text replaced by another ─► every row of the folder's check whose files have changed ─► found, or not
//! ```
//!
//! The other mutants of this folder are chosen at random, in blocks that stand alone. These are faults that were
//! thought of by name, put into the modules as they are in a stage, and searched by exactly the rows that
//! `posicast verify DIR` compares there, with its default clocks. A text that no longer exists, or exists twice, is
//! an error: a mutant that is not applied proves nothing.

use std::fmt::Write as _;

use posicast_hdl::emit::Module;
use posicast_model::rtl::stage::StageConfig;

use crate::Error;
use crate::asynchronous;
use crate::blocks::{self, Block, ShortTicksBlock, Sources, StageBlock};
use crate::page::Marks;

/// Marks of the table of these mutants.
pub const INSIDE_MARKS: Marks = Marks {
    begin: "<!-- mutants inside the stage: written by the example `mutate` -->",
    end: "<!-- end of mutants inside the stage -->",
};

/// A named mutant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Inside {
    /// Description of the fault.
    pub name: &'static str,
    /// Name of the module without a size; all modules with this name get the fault.
    pub module: &'static str,
    /// Text that the module contains exactly once.
    pub from: &'static str,
    /// Text that replaces it.
    pub to: &'static str,
}

/// All named mutants.
pub const INSIDE: [Inside; 13] = [
    Inside {
        name: "the velocity's timeout a step late",
        module: "velocity",
        from: "recent = interval[23:16] < timeout;",
        to: "recent = interval[23:16] <= timeout;",
    },
    Inside {
        name: "a handover that ends a sample early",
        module: "handover",
        from: "if (since_q == reach) begin",
        to: "if (next_since == reach) begin",
    },
    Inside {
        name: "a negative overflow of the integrator unseen",
        module: "integrator",
        from: "unfit = turned_sign & (augend[7] == addend[7]);",
        to: "unfit = (turned_sign & (augend[7] == addend[7])) & !augend[7];",
    },
    Inside {
        name: "a limit that acts on a bounce",
        module: "axis",
        from: "(!limit_plus_line_level)",
        to: "(!limit_plus_line_level | !limit_plus_n)",
    },
    Inside {
        name: "a limit whose first look is enough",
        module: "axis_monitors",
        from: "found_next = shown & found;",
        to: "found_next = shown | found;",
    },
    Inside {
        name: "a cause of the upper byte that cuts",
        module: "axis_causes",
        from: "cutting_now = now & off;",
        to: "cutting_now = (now & off) | (now & 16'd4096);",
    },
    Inside {
        name: "a cause of the upper byte that is told to cut and does not",
        module: "axis_causes",
        from: "cutting_now = now & off;",
        to: "cutting_now = (now & off) & 16'd255;",
    },
    Inside {
        name: "the asynchronous fault latch made synchronous",
        module: "fault_latch",
        from: "always @(posedge clk or negedge trip_n) begin",
        to: "always @(posedge clk) begin",
    },
    Inside {
        name: "a 64th entry beside the one that plays",
        module: "command_fifo",
        from: "full = level_q[6] | (plays & (waiting == ALL_BUT_ONE));",
        to: "full = level_q[6];",
    },
    Inside {
        name: "the group's emergency stop ignored by an axis",
        module: "axis",
        from: "emergency = own_emergency | group_emergency_stop;",
        to: "emergency = own_emergency;",
    },
    Inside {
        name: "the group's emergency stop not passed on",
        module: "group",
        from: "if (emergency_stop_1) begin",
        to: "if (1'd0 & emergency_stop_1) begin",
    },
    Inside {
        name: "a group stop not passed on",
        module: "group",
        from: "if (wants_group_stop_1 & (AXIS_0 != AXIS_1)) begin",
        to: "if (1'd0 & wants_group_stop_1) begin",
    },
    Inside {
        name: "`stop_deceleration` above bit 23 ignored",
        module: "integrator",
        from: "deceleration = {9'd0, stop_deceleration} << 8;",
        to: "deceleration = {16'd0, stop_deceleration[23:0]} << 8;",
    },
];

/// Check that found a mutant.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Found {
    /// Name and instance of the row.
    pub row: String,
    /// The first wrong clock; `None` if a directed test between clocks found it.
    pub clock: Option<u64>,
}

impl Inside {
    /// Returns these modules with the fault in them.
    ///
    /// # Errors
    /// [`Error::Option`] where no module has that name, or its text does not occur exactly once.
    pub fn put_into(&self, modules: &[Module]) -> Result<Vec<Module>, Error> {
        let mut modules = modules.to_vec();
        let mut found = false;
        for module in modules.iter_mut().filter(|module| module.is(self.module)) {
            let times = module.text.matches(self.from).count();
            if times != 1 {
                let text = format!("`{}` is {times} times in `{}`", self.from, module.name);
                return Err(self.outdated(text));
            }
            module.text = module.text.replacen(self.from, self.to, 1);
            found = true;
        }
        match found {
            true => Ok(modules),
            false => Err(self.outdated(format!("there is no module `{}`", self.module))),
        }
    }

    fn outdated(&self, why: String) -> Error {
        Error::Option(format!("the mutant `{}` cannot be put in: {why}", self.name))
    }

    /// Searches the fault with the rows of the folder's check that contain the module, the blocks inside the stage
    /// first; `None` if all of them match.
    ///
    /// # Errors
    /// Those of [`Self::put_into`], and the errors of the simulator.
    pub fn hunt(&self, config: &StageConfig, top: &str, clocks: u64, seed: u64) -> Result<Option<Found>, Error> {
        let stage = StageBlock::new(config, top).map_err(|error| Error::Option(error.to_string()))?;
        let modules = stage.modules()?;
        let broken = Sources::of_modules(&self.put_into(&modules)?)?;
        let changed: Vec<String> = (modules.iter())
            .filter(|module| module.is(self.module))
            .map(|module| format!("{}.v", module.name))
            .collect();
        let mut rows = stage.inner()?;
        rows.push(Box::new(stage));
        let short = ShortTicksBlock::new(config, top).map_err(|error| Error::Option(error.to_string()))?;
        rows.extend(short.map(|block| Box::new(block) as Box<dyn Block>));
        for row in rows {
            let sources = broken.reached_by(row.as_ref())?;
            if !sources
                .files()
                .iter()
                .any(|file| changed.iter().any(|changed| file.ends_with(changed)))
            {
                continue;
            }
            let sources = row.adapted(sources)?;
            if let Some(found) = look(row.as_ref(), &sources, clocks.max(row.least_clocks()), seed)? {
                return Ok(Some(found));
            }
        }
        Ok(None)
    }
}

/// Runs the row's lock step, and its test between clocks.
fn look(row: &dyn Block, sources: &Sources, clocks: u64, seed: u64) -> Result<Option<Found>, Error> {
    let found = |clock| Found {
        row: format!("{} {}", row.name(), row.instance()),
        clock,
    };
    if let Some(report) = asynchronous::check(row, sources)?
        && report.mismatches() > 0
    {
        return Ok(Some(found(None)));
    }
    let seed = blocks::row_seed(row, seed);
    let mut device = sources.verilated(row, seed)?;
    let report = blocks::judge(row, &mut device, clocks..=clocks, seed, &mut |_| {})?;
    let first = report.blocks.iter().find_map(|block| block.first.as_ref());
    Ok(first.map(|first| found(Some(first.time))))
}

/// The mutants with what found them, as the table of `docs/verification.md`.
pub fn inside_table(fates: &[(Inside, Option<Found>)]) -> String {
    let mut text = "| mutant | module | found by | first wrong clock |\n|---|---|---|---|\n".to_owned();
    for (mutant, found) in fates {
        let (row, clock) = match found {
            None => ("**not found**", String::new()),
            Some(found) => {
                let clock = found
                    .clock
                    .map_or_else(|| "between clocks".to_owned(), |clock| clock.to_string());
                (found.row.as_str(), clock)
            }
        };
        // Writing to a `String` cannot fail.
        let _ = writeln!(text, "| {} | `{}` | {row} | {clock} |", mutant.name, mutant.module);
    }
    let count = fates.iter().filter(|(_, found)| found.is_some()).count();
    let _ = writeln!(text, "\n{count} of {} found.", fates.len());
    text
}
