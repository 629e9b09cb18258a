//! Block and mutant side by side, under the same inputs for ever: does any output tell them apart?

use std::time::Duration;

use super::Mutant;
use super::netlist::Netlist;
use crate::Error;
use crate::formal::{ABC, asserted};
use crate::tool::text;

/// What is known of a block and its mutant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Comparison {
    /// No input tells them apart, ever.
    Equivalent,
    /// Some input does.
    Different {
        /// Clocks after power-up, from 0.
        clock: u32,
    },
    /// Neither within the time limit.
    Unknown,
}

/// Compares, for at most twice `limit`.
///
/// Modules that hold a memory are taken out of both: what drives them becomes outputs, what is read from them inputs. That is
/// sufficient, not necessary: a mutant that reads another word, and then does not use it, counts as different.
pub(super) fn compare(netlist: &Netlist<'_>, mutant: &Mutant, limit: Duration) -> Result<Comparison, Error> {
    netlist.yosys("miter", &miter(netlist.top(), &mutant.arguments))?;
    let seconds = limit.as_secs().max(1);
    // First merge what is equal in both by induction over signals; what is left is small, mostly nothing.
    let proof = abc(netlist, &format!("scorr; scorr -F 4; pdr -T {seconds}"))?;
    if proof.contains("Property proved") {
        return Ok(Comparison::Equivalent);
    }
    let mut found = asserted(&proof).next();
    let search;
    if found.is_none() {
        search = abc(netlist, &format!("bmc3 -T {seconds}"))?;
        found = asserted(&search).next();
    }
    Ok(found.map_or(Comparison::Unknown, |(_, clock)| Comparison::Different { clock }))
}

fn abc(netlist: &Netlist<'_>, commands: &str) -> Result<String, Error> {
    let commands = format!("read_aiger miter.aig; fold; strash; orpos; {commands}");
    let mut abc = ABC.command();
    abc.current_dir(netlist.folder()).args(["-c", &commands]);
    ABC.run(&mut abc, "comparing a mutant").map(|output| text(&output))
}

/// Makes modules with memory in them black boxes.
const WITHOUT_MEMORY: &str = "select -set memories t:$mem* %m\nblackbox @memories\n";

/// The script that writes `miter.aig`, whose one output says that an output differs.
fn miter(top: &str, arguments: &str) -> String {
    let side = |name: &str, change: &str| {
        format!(
            "design -load both\n{change}{WITHOUT_MEMORY}flatten\nrename {top} {name}\nexpose -evert {name}\ndesign -stash {name}\n"
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
