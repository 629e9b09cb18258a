//! Measures which lines, nets and bins of the blocks the lockstep runs reach, and explains those that are not
//! reached: `cargo run --release --example coverage [-- OPTIONS]`.
//!
//! ```text
//! --block NAME    only these blocks; may be given several times
//! --clocks N      per block (1,000,000): with fewer, more is not reached, and explained nowhere
//! --write         renews the table in ladder/RESULTS.md, or the rows of the block
//! ```
//!
//! Prints the table, and errors on standard error. Exit status: 0 if every hole is explained and no explanation is
//! outdated, 1 otherwise, 2 if it cannot run, 3 if a tool is missing.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "this is a program")]

use std::process::ExitCode;

use posicast_ladder::coverage::{CLOCKS, explanation, measure, outdated, subjects, table};
use posicast_system::cores;
use posicast_testbench::Error;
use posicast_testbench::blocks::Block;

fn main() -> ExitCode {
    match cover() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(if error.is_missing_tool() { 3 } else { 2 })
        }
    }
}

struct Arguments {
    blocks: Vec<String>,
    clocks: u64,
    write: bool,
}

impl Arguments {
    fn read() -> Result<Self, Error> {
        let mut found = Self {
            blocks: Vec::new(),
            clocks: CLOCKS,
            write: false,
        };
        let mut words = std::env::args().skip(1);
        while let Some(word) = words.next() {
            let mut value = || {
                words
                    .next()
                    .ok_or_else(|| Error::Option(format!("`{word}` needs a value")))
            };
            match word.as_str() {
                "--block" => found.blocks.push(value()?),
                "--clocks" => {
                    let clocks = value()?.parse().ok().filter(|clocks| *clocks > 0);
                    found.clocks = clocks.ok_or_else(|| Error::Option("--clocks needs a whole number".to_owned()))?;
                }
                "--write" => found.write = true,
                _ => {
                    let known = "the options are --block, --clocks and --write";
                    return Err(Error::Option(format!("`{word}`: {known}")));
                }
            }
        }
        if found.write && found.clocks != CLOCKS {
            let reason = "--write is for the clocks of the explanations: leave out --clocks";
            return Err(Error::Option(reason.to_owned()));
        }
        Ok(found)
    }
}

fn cover() -> Result<bool, Error> {
    let arguments = Arguments::read()?;
    let all = subjects()?;
    if let Some(unknown) = arguments
        .blocks
        .iter()
        .find(|name| !all.iter().any(|block| block.name() == *name))
    {
        return Err(Error::Option(format!("--block {unknown}: no such block")));
    }
    let is_wanted = |name: &str| arguments.blocks.is_empty() || arguments.blocks.iter().any(|wanted| wanted == name);
    let blocks = all.iter().map(AsRef::as_ref);
    let blocks: Vec<&dyn Block> = blocks.filter(|block: &&dyn Block| is_wanted(block.name())).collect();
    let explanations = explanation::all()?;
    let one = |block: &dyn Block| {
        let of = measure(block, arguments.clocks)?;
        let problems = of.problems(&explanations);
        Ok::<_, Error>((of, problems))
    };
    let show = |(_, problems): &(_, Vec<String>)| problems.iter().for_each(|problem| eprintln!("{problem}"));
    let (measured, problems): (Vec<_>, Vec<_>) = cores::each(&blocks, |block| one(*block), show)?.into_iter().unzip();
    let outdated = outdated(&measured, &all, &explanations);
    outdated.iter().for_each(|problem| eprintln!("{problem}"));
    let table = table::markdown(&measured, &explanations);
    print!("{table}");
    if arguments.write {
        table::MARKS.renew(|old| table::merged(old, &table, &all))?;
    }
    Ok(problems.iter().all(Vec::is_empty) && outdated.is_empty())
}
