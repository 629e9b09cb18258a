//! Checks whether a block and a mutant are equivalent: with the same inputs, no output ever differs.

use std::time::Duration;

use super::Mutant;
use super::netlist::Netlist;
use crate::netlist::EquivalenceVerdict;
use posicast_testbench::Error;
use posicast_testbench::yosys::{WAITED, abc_within, counterexample_clock};

/// Largest number of bits of memories that are converted to registers.
const MOST_MEMORY_BITS: u32 = 8192;
/// Largest number of nodes of ABC's BDDs: a few seconds.
const BDD_NODES: u32 = 200_000;

/// Cells that are removed from both sides of a comparison: their inputs become outputs, and their outputs become
/// inputs. Equivalence without them is sufficient, but not necessary: a mutant that reads another word, and then does
/// not use it, counts as different.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Without {
    MemoriesAndProducts,
    Memories,
    Nothing,
}

impl Without {
    /// Returns the commands that remove modules with such cells, except `kept`. ROMs stay, because their words are known.
    fn script(self, kept: &str) -> String {
        let cells = match self {
            Self::MemoriesAndProducts => "t:$memwr* %m t:$mul %m %u",
            Self::Memories => "t:$memwr* %m",
            Self::Nothing => return String::new(),
        };
        format!("select -set boxes {cells} {kept} %d\nblackbox @boxes\n")
    }
}

/// Processor time of ABC's `dprove`, which either finishes within seconds or not at all.
const DPROVE_LIMIT: Duration = Duration::from_secs(10);
/// Processor time of ABC's `reach`, which has the rest of its engine's time beside it.
const REACH_LIMIT: Duration = Duration::from_secs(20);

/// Compares a mutant with its block. It takes at most about twelve times `limit` of processor time.
///
/// It first compares without memories and multipliers; if that gives no proof, with the multipliers, then with the
/// memories too, as registers that begin as 0 in both. The module of the mutant is always included.
pub(super) fn compare(netlist: &Netlist<'_>, mutant: &Mutant, limit: Duration) -> Result<EquivalenceVerdict, Error> {
    let mut ways = vec![Without::MemoriesAndProducts];
    if netlist.multiplies() {
        ways.push(Without::Memories);
    }
    if (1..=MOST_MEMORY_BITS).contains(&netlist.memory_bits()) {
        ways.push(Without::Nothing);
    }
    for without in &ways {
        netlist.yosys("miter", &miter(netlist.top(), mutant, *without))?;
        if prove(netlist, limit)? {
            return Ok(EquivalenceVerdict::Equivalent);
        }
    }
    // A difference counts only where the least is left out.
    let commands = format!("read_aiger merged.aig; bmc3 -T {}", patience(limit));
    let said = abc(netlist, &commands, limit)?;
    let clock = said.and_then(|said| counterexample_clock(&said));
    Ok(
        clock.map_or(EquivalenceVerdict::Unknown, |clock| EquivalenceVerdict::Different {
            clock,
        }),
    )
}

/// Whether `miter.aig` is proven to have no difference.
fn prove(netlist: &Netlist<'_>, limit: Duration) -> Result<bool, Error> {
    // Signals that induction proves equal in both are merged; the remainder is small, and mostly empty. Counters that
    // only take few values are fast with BDDs and slow with PDR, which needs a clause for each value.
    let at = |name: &str| netlist.folder().join(name);
    // If the first engine does not finish, the others use its input.
    std::fs::copy(at("miter.aig"), at("merged.aig")).map_err(Error::file(&at("merged.aig"), "write"))?;
    let engines = [
        (
            format!(
                "read_aiger miter.aig; fold; strash; orpos; scorr; scorr -F 4; write_aiger merged.aig; reach -T {} -F 100000 -B {BDD_NODES}",
                patience(REACH_LIMIT)
            ),
            limit.saturating_mul(2),
        ),
        // Induction, retiming and reachability in turn succeed quickly or not at all.
        (
            format!("read_aiger merged.aig; dprove -T {}", patience(DPROVE_LIMIT)),
            DPROVE_LIMIT,
        ),
        (format!("read_aiger merged.aig; pdr -m -T {}", patience(limit)), limit),
    ];
    for (commands, limit) in engines {
        let Some(said) = abc(netlist, &commands, limit)? else {
            continue;
        };
        if ["Property proved", "proved unreachable", "Networks are equivalent"]
            .iter()
            .any(|proof| said.contains(proof))
        {
            return Ok(true);
        }
        if counterexample_clock(&said).is_some() {
            return Ok(false);
        }
    }
    Ok(false)
}

/// ABC's own limit, in seconds on the clock, of a command that may compute for `limit`.
fn patience(limit: Duration) -> u64 {
    limit.saturating_mul(WAITED).as_secs().max(1)
}

/// Returns ABC's output; `None` if ABC used more than `limit` of processor time.
fn abc(netlist: &Netlist<'_>, commands: &str, limit: Duration) -> Result<Option<String>, Error> {
    abc_within(netlist.folder(), commands, "comparing a mutant", limit)
}

/// Returns the script that writes `miter.aig`. Its one output is 1 if an output of the two designs differs.
fn miter(top: &str, mutant: &Mutant, without: Without) -> String {
    let Mutant { arguments, module, .. } = mutant;
    let boxes = without.script(module);
    let side = |name: &str, change: &str| {
        format!(
            "design -load both\n{change}{boxes}\
             flatten\nrename {top} {name}\nexpose -evert {name}/c:*\ndesign -stash {name}\n"
        )
    };
    let (block, mutant) = (side("block", ""), side("mutant", &format!("mutate {arguments}\n")));
    format!(
        "read_ilang block.il\ndesign -save both\n{block}{mutant}\
         design -copy-from block block\ndesign -copy-from mutant mutant\n\
         miter -equiv -flatten -make_assert block mutant miter\nhierarchy -top miter\ndelete -output\n\
         opt -nodffe -nosdff -fast\nmemory\nsetundef -init -zero\nasync2sync\ndffunmap\ntechmap\nopt -fast\ndffunmap\nabc -g AND -fast\nopt_clean\n\
         write_aiger -I -B -zinit -no-startoffset miter.aig\n"
    )
}
