//! Named mutants inside a stage: faults in a stage's Verilog that the check of its folder once missed.
//!
//! ```text
//!  stage's modules ─► one text replaced by another ─► every row of the folder's check whose files have changed ─► found, or not
//! ```
//!
//! The other mutants of this folder are chosen at random, in single blocks. These are deliberate faults, applied to
//! the modules as they are in a stage. They must be found by exactly the rows that `posicast verify DIR` compares
//! there, with its default clocks. A text that is missing, or occurs twice, is an error: a mutant that is not applied
//! proves nothing.

use std::fmt::Write as _;

use posicast_blocks::stage::StageConfig;

use crate::page::Marks;
use posicast_testbench::Error;
use posicast_testbench::asynchronous;
use posicast_testbench::blocks;
use posicast_testbench::blocks::{Block, Sources};
use posicast_testbench::named_mutant::NamedMutant;
use posicast_testbench::stage::{ShortTicksBlock, StageBlock};

/// Marks of the table of these mutants.
pub const INSIDE_MARKS: Marks = Marks {
    begin: "<!-- mutants inside the stage: written by the example `mutate` -->",
    end: "<!-- end of mutants inside the stage -->",
};

/// All of them.
pub const INSIDE: [NamedMutant<'static>; 13] = [
    NamedMutant {
        name: "the velocity's timeout a step late",
        module: Some("velocity"),
        from: "recent = interval[23:16] < timeout;",
        to: "recent = interval[23:16] <= timeout;",
    },
    NamedMutant {
        name: "a handover that ends a sample early",
        module: Some("handover"),
        from: "if (since_q == reach) begin",
        to: "if (next_since == reach) begin",
    },
    NamedMutant {
        name: "a negative overflow of the integrator unseen",
        module: Some("integrator"),
        from: "unfit = turned_sign & (augend[7] == addend[7]);",
        to: "unfit = (turned_sign & (augend[7] == addend[7])) & !augend[7];",
    },
    NamedMutant {
        name: "a limit that acts on a bounce",
        module: Some("axis"),
        from: "(!limit_plus_line_level)",
        to: "(!limit_plus_line_level | !limit_plus_n)",
    },
    NamedMutant {
        name: "a limit whose first look is enough",
        module: Some("axis_monitors"),
        from: "found_next = shown & found;",
        to: "found_next = shown | found;",
    },
    NamedMutant {
        name: "a cause of the upper byte that cuts",
        module: Some("axis_causes"),
        from: "cutting_now = now & off;",
        to: "cutting_now = (now & off) | (now & 16'd4096);",
    },
    NamedMutant {
        name: "a cause of the upper byte that is told to cut and does not",
        module: Some("axis_causes"),
        from: "cutting_now = now & off;",
        to: "cutting_now = (now & off) & 16'd255;",
    },
    NamedMutant {
        name: "the asynchronous fault latch made synchronous",
        module: Some("fault_latch"),
        from: "always @(posedge clk or negedge trip_n) begin",
        to: "always @(posedge clk) begin",
    },
    NamedMutant {
        name: "a 64th entry beside the one that plays",
        module: Some("command_fifo"),
        from: "full = held[6] | (plays & (behind == ALL_BUT_ONE));",
        to: "full = held[6];",
    },
    NamedMutant {
        name: "the group's emergency stop ignored by an axis",
        module: Some("axis"),
        from: "emergency = own_emergency | group_emergency_stop;",
        to: "emergency = own_emergency;",
    },
    NamedMutant {
        name: "the group's emergency stop not passed on",
        module: Some("group"),
        from: "if (emergency_stop_1) begin",
        to: "if (1'd0 & emergency_stop_1) begin",
    },
    NamedMutant {
        name: "a group stop not passed on",
        module: Some("group"),
        from: "if (wants_group_stop_1 & (AXIS_0 != AXIS_1)) begin",
        to: "if (1'd0 & wants_group_stop_1) begin",
    },
    NamedMutant {
        name: "`stop_deceleration` above bit 23 ignored",
        module: Some("integrator"),
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

/// Looks for a mutant with the rows of the folder's check that reach its module, the blocks inside the stage first; `None`
/// where all of them match.
///
/// # Errors
/// As [`NamedMutant::put_into`], and the errors of a simulator.
pub fn hunt(
    mutant: &NamedMutant<'_>,
    config: &StageConfig,
    top: &str,
    clocks: u64,
    seed: u64,
) -> Result<Option<Found>, Error> {
    let stage = StageBlock::new(config, top).map_err(|error| Error::Option(error.to_string()))?;
    let modules = stage.modules()?;
    let mutated = mutant.put_into(&modules)?;
    let changed: Vec<String> = (modules.iter().zip(&mutated))
        .filter(|(before, after)| before != after)
        .map(|(module, _)| format!("{}.v", module.name))
        .collect();
    let broken = Sources::of_modules(&mutated)?;
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

/// The mutants and what found them, as the table of `ladder/RESULTS.md`.
pub fn inside_table(fates: &[(NamedMutant<'_>, Option<Found>)]) -> String {
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
        let _ = writeln!(
            text,
            "| {} | `{}` | {row} | {clock} |",
            mutant.name,
            mutant.module.unwrap_or("any")
        );
    }
    let count = fates.iter().filter(|(_, found)| found.is_some()).count();
    let _ = writeln!(text, "\n{count} of {} found.", fates.len());
    text
}
