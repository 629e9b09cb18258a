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
    /// Name of its files.
    fn name(self) -> &'static str {
        match self {
            Self::MemoriesAndProducts => "without_memories_and_products",
            Self::Memories => "without_memories",
            Self::Nothing => "whole",
        }
    }

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

/// What an engine says of a miter, if it finished.
fn told(said: Option<&str>) -> EquivalenceVerdict {
    let Some(said) = said else {
        return EquivalenceVerdict::Unknown;
    };
    let proofs = ["Property proved", "proved unreachable", "Networks are equivalent"];
    if proofs.iter().any(|proof| said.contains(proof)) {
        return EquivalenceVerdict::Equivalent;
    }
    counterexample_clock(said).map_or(EquivalenceVerdict::Unknown, |clock| EquivalenceVerdict::Different {
        clock,
    })
}

/// A mutant beside its block. The quick engines come first, so that a search for a broken property can come before the slow ones.
///
/// A comparison is first made without memories and multipliers; if that gives no proof, with the multipliers, then with the memories too,
/// as registers that begin as 0 in both. The module of the mutant is always included.
pub(super) struct Comparison<'a> {
    netlist: &'a Netlist<'a>,
    mutant: &'a Mutant,
    limit: Duration,
    /// What quick engines found without memories.
    found: Vec<(Without, EquivalenceVerdict)>,
}

impl<'a> Comparison<'a> {
    /// `limit` is of the slow engines' processor time.
    pub(super) fn new(netlist: &'a Netlist<'a>, mutant: &'a Mutant, limit: Duration) -> Self {
        Self {
            netlist,
            mutant,
            limit,
            found: Vec::new(),
        }
    }

    /// Whether the quick engines prove that no output ever differs, for any contents of memories.
    pub(super) fn is_soon_proven(&mut self) -> Result<bool, Error> {
        let products = self.netlist.multiplies().then_some(Without::Memories);
        for without in [Without::MemoriesAndProducts].into_iter().chain(products) {
            let answer = self.quickly(without)?;
            if answer == EquivalenceVerdict::Equivalent {
                return Ok(true);
            }
            self.found.push((without, answer));
        }
        Ok(false)
    }

    /// Decides what [`is_soon_proven`](Self::is_soon_proven) left open. It takes at most about twelve times the limit.
    pub(super) fn verdict(mut self) -> Result<EquivalenceVerdict, Error> {
        let Self { netlist, limit, .. } = self;
        for (without, answer) in &self.found {
            let is_open = *answer == EquivalenceVerdict::Unknown;
            if is_open && self.slowly(*without)? == EquivalenceVerdict::Equivalent {
                return Ok(EquivalenceVerdict::Equivalent);
            }
        }
        if (1..=MOST_MEMORY_BITS).contains(&netlist.memory_bits()) {
            let answer = match self.quickly(Without::Nothing)? {
                EquivalenceVerdict::Unknown => self.slowly(Without::Nothing)?,
                answer => answer,
            };
            if answer == EquivalenceVerdict::Equivalent {
                return Ok(answer);
            }
            self.found.push((Without::Nothing, answer));
        }
        // A difference counts only where the least is left out.
        let least = self.found.last().map_or("", |(without, _)| without.name());
        let search = format!("read_aiger {least}_merged.aig; bmc3 -T {}", patience(limit));
        Ok(told(abc(netlist, &search, limit)?.as_deref()))
    }

    /// Makes the miter, merges what is equal, and asks the engines that take seconds.
    fn quickly(&self, without: Without) -> Result<EquivalenceVerdict, Error> {
        let Self { netlist, limit, .. } = *self;
        let name = without.name();
        netlist.yosys("miter", &miter(netlist.top(), self.mutant, without))?;
        // If the first engine does not finish, the others use its input.
        let at = |end: &str| netlist.folder().join(format!("{name}{end}.aig"));
        std::fs::copy(at(""), at("_merged")).map_err(Error::file(&at("_merged"), "write"))?;
        // Signals that induction proves equal in both are merged; the remainder is small, and mostly empty. Counters that
        // only take few values are fast with BDDs and slow with PDR, which needs a clause for each value.
        let merge = format!(
            "read_aiger {name}.aig; fold; strash; orpos; scorr; scorr -F 4; write_aiger {name}_merged.aig; reach -T {} -F 100000 -B {BDD_NODES}",
            patience(REACH_LIMIT)
        );
        let answer = told(abc(netlist, &merge, limit.saturating_mul(2))?.as_deref());
        if answer != EquivalenceVerdict::Unknown {
            return Ok(answer);
        }
        // Induction, retiming and reachability in turn succeed quickly or not at all.
        let dprove = format!("read_aiger {name}_merged.aig; dprove -T {}", patience(DPROVE_LIMIT));
        Ok(told(abc(netlist, &dprove, DPROVE_LIMIT)?.as_deref()))
    }

    /// Asks the engine that takes as long as it may, after [`quickly`](Self::quickly).
    fn slowly(&self, without: Without) -> Result<EquivalenceVerdict, Error> {
        let pdr = format!(
            "read_aiger {}_merged.aig; pdr -m -T {}",
            without.name(),
            patience(self.limit)
        );
        Ok(told(abc(self.netlist, &pdr, self.limit)?.as_deref()))
    }
}

/// ABC's own limit, in seconds on the clock, of a command that may compute for `limit`.
fn patience(limit: Duration) -> u64 {
    limit.saturating_mul(WAITED).as_secs().max(1)
}

/// Returns ABC's output; `None` if ABC used more than `limit` of processor time.
fn abc(netlist: &Netlist<'_>, commands: &str, limit: Duration) -> Result<Option<String>, Error> {
    abc_within(netlist.folder(), commands, "comparing a mutant", limit)
}

/// Returns the script that writes the miter's file, which has the name of `without`. Its one output is 1 if an output of the two designs
/// differs.
fn miter(top: &str, mutant: &Mutant, without: Without) -> String {
    let Mutant { arguments, module, .. } = mutant;
    let file = without.name();
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
         write_aiger -I -B -zinit -no-startoffset {file}.aig\n"
    )
}
