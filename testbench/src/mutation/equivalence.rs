//! Block and mutant side by side, under the same inputs for ever: does any output tell them apart?

use std::time::Duration;

use super::Mutant;
use super::netlist::Netlist;
use crate::Error;
use crate::formal::{ABC, asserted};
use crate::netlist::Verdict;

/// Most nodes of ABC's BDDs: a few seconds.
const BDD_NODES: u32 = 200_000;

/// Compares, for at most about four times `limit`.
///
/// Modules that hold a memory are taken out of both: what drives them becomes outputs, what is read from them inputs. That is
/// sufficient, not necessary: a mutant that reads another word, and then does not use it, counts as different.
pub(super) fn compare(netlist: &Netlist<'_>, mutant: &Mutant, limit: Duration) -> Result<Verdict, Error> {
    netlist.yosys("miter", &miter(netlist.top(), &mutant.arguments))?;
    let seconds = limit.as_secs().max(1);
    // What is equal in both, by induction over signals, is merged; what is left is small, mostly nothing. Counters that
    // never get far are quick with BDDs, and slow with PDR, which needs a clause for each value.
    let at = |name: &str| netlist.folder().join(name);
    // If the first engine comes to no end, the others take what it was given.
    std::fs::copy(at("miter.aig"), at("merged.aig")).map_err(Error::file(&at("merged.aig"), "write"))?;
    let engines = [
        format!(
            "read_aiger miter.aig; fold; strash; orpos; scorr; scorr -F 4; write_aiger merged.aig; reach -T 20 -F 100000 -B {BDD_NODES}"
        ),
        format!("read_aiger merged.aig; pdr -T {seconds}"),
        format!("read_aiger merged.aig; bmc3 -T {seconds}"),
    ];
    for commands in engines {
        let mut abc = ABC.command();
        abc.current_dir(netlist.folder()).args(["-c", &commands]);
        let Some(said) = ABC.run_within(&mut abc, "comparing a mutant", limit.saturating_mul(2))? else {
            continue;
        };
        if ["Property proved", "proved unreachable"]
            .iter()
            .any(|proof| said.contains(proof))
        {
            return Ok(Verdict::Equivalent);
        }
        if let Some((_, clock)) = asserted(&said).next() {
            return Ok(Verdict::Different { clock });
        }
    }
    Ok(Verdict::Unknown)
}

/// Makes modules with memory in them black boxes.
const WITHOUT_MEMORY: &str = "select -set memories t:$mem* %m\nblackbox @memories\n";

/// The script that writes `miter.aig`, whose one output says that an output differs.
fn miter(top: &str, arguments: &str) -> String {
    let side = |name: &str, change: &str| {
        format!(
            "design -load both\n{change}{WITHOUT_MEMORY}flatten\nrename {top} {name}\nexpose -evert {name}/c:*\ndesign -stash {name}\n"
        )
    };
    let (block, mutant) = (side("block", ""), side("mutant", &format!("mutate {arguments}\n")));
    format!(
        "read_ilang block.il\ndesign -save both\n{block}{mutant}\
         design -copy-from block block\ndesign -copy-from mutant mutant\n\
         miter -equiv -flatten -make_assert block mutant miter\nhierarchy -top miter\ndelete -output\n\
         opt -nodffe -nosdff -fast\nmemory\nasync2sync\ndffunmap\ntechmap\nopt -fast\ndffunmap\nabc -g AND -fast\nopt_clean\n\
         write_aiger -I -B -zinit -no-startoffset miter.aig\n"
    )
}
