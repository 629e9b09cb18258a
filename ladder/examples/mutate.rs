//! Puts mutants into the blocks and finds out whether each is detected:
//! `cargo run --release --example mutate [-- OPTIONS]`.
//!
//! ```text
//! --block NAME    only this block                    --mutants N   per block (60)
//! --seed S        of the choice of mutants (1)       --clocks C    per run of stimuli (1,000,000)
//! --write         renews the table in ladder/RESULTS.md, or the rows of the block
//! --search        searches inputs and proofs for the mutants listed there as unknown again, as --write does: up to eight minutes each
//! --wires         each constant and wire of the description of two stages instead, those of examples/xy-stage.toml and
//!                 examples/printer.toml; --mutants takes so many of each
//! --inside        the named mutants inside the stage of examples/xy-stage.toml instead, as `verify DIR` looks for them
//! ```
//!
//! Prints the table, and a line per block while it works. Exit status: 0 if ladder/RESULTS.md lists each
//! mutant that stays unknown, 1 if one is not listed, 2 if it cannot run, 3 if a tool is missing. `POSICAST_MUTATE_KEEP` names a folder that keeps all files.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "this is a program")]

use std::panic::resume_unwind;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Instant;

use posicast_blocks::stage::StageConfig;
use posicast_ladder::mutation::{
    INSIDE, INSIDE_MARKS, MARKS, MutationOptions, MutationRow, STEPS_WIRES_MARKS, Subject, WIRES_MARKS, all, hunt,
    inside_table, merged, named, run_beside, table, unknown_of, unlisted, wires, wires_table,
};
use posicast_machine::plan::design_machine;
use posicast_machine::{hardware, machine_file};
use posicast_system::cores;
use posicast_testbench::Error;

fn main() -> ExitCode {
    match mutate() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(if error.is_missing_tool() { 3 } else { 2 })
        }
    }
}

struct Arguments {
    block: Option<String>,
    options: MutationOptions,
    write: bool,
    search: bool,
    inside: bool,
    /// The most mutants of the wires, if they are asked for.
    wires: Option<usize>,
}

/// An example machine whose stage gets mutants.
struct Example {
    file: &'static str,
    text: &'static str,
    /// The top of its stage.
    top: &'static str,
}

/// The machine whose stage gets the named mutants.
const XY_STAGE: Example = Example {
    file: "xy-stage.toml",
    text: include_str!("../../examples/xy-stage.toml"),
    top: "xy_stage_stage",
};

/// The machine whose axes have steps.
const PRINTER: Example = Example {
    file: "printer.toml",
    text: include_str!("../../examples/printer.toml"),
    top: "printer_stage",
};

impl Arguments {
    fn read() -> Result<Self, Error> {
        let mut found = Self {
            block: None,
            options: MutationOptions::default(),
            write: false,
            search: false,
            inside: false,
            wires: None,
        };
        let mut mutants = None;
        let mut words = std::env::args().skip(1);
        while let Some(word) = words.next() {
            let mut value = || {
                let missing = || Error::Option(format!("`{word}` needs a value"));
                words.next().ok_or_else(missing)
            };
            match word.as_str() {
                "--block" => found.block = Some(value()?),
                "--mutants" => mutants = Some(number(&word, &value()?)?),
                "--seed" => found.options.seed = number(&word, &value()?)?,
                "--clocks" => found.options.clocks = number(&word, &value()?)?,
                "--write" => found.write = true,
                "--search" => found.search = true,
                "--inside" => found.inside = true,
                "--wires" => found.wires = Some(usize::MAX),
                other => {
                    return Err(Error::Option(format!(
                        "`{other}`: the options are --block, --mutants, --seed, --clocks, --write, --search, --wires and --inside"
                    )));
                }
            }
        }
        match (&mut found.wires, mutants) {
            (Some(wires), Some(most)) => *wires = most,
            (None, Some(mutants)) => found.options.mutants = mutants,
            (_, None) => {}
        }
        if found.write && found.options != MutationOptions::default() {
            return Err(Error::Option(
                "--write keeps the table that the defaults give: leave --mutants, --seed and --clocks away".to_owned(),
            ));
        }
        Ok(found)
    }
}

fn number<T: std::str::FromStr>(option: &str, text: &str) -> Result<T, Error> {
    text.parse()
        .map_err(|_| Error::Option(format!("{option} {text}: a whole number is needed")))
}

fn mutate() -> Result<bool, Error> {
    let Arguments {
        block,
        options,
        write,
        search,
        inside,
        wires: most_wires,
    } = Arguments::read()?;
    if let Some(most) = most_wires {
        return mutate_wires(most, &options, write);
    }
    if inside {
        return mutate_inside(&options, write);
    }
    let subjects = match &block {
        Some(name) => named(name)?,
        None => all()?,
    };
    // The table keeps the rows of all blocks, not only of those that were chosen.
    let everything = all()?;
    let page = MARKS.read()?;
    let temporary = std::env::temp_dir().join(format!("posicast-mutate-{}", std::process::id()));
    let kept = std::env::var_os("POSICAST_MUTATE_KEEP").map(PathBuf::from);
    let folder = kept.clone().unwrap_or_else(|| temporary.clone());
    let subjects: Vec<(usize, Subject)> = subjects.into_iter().enumerate().collect();
    let written = Mutex::new(());
    let one = |(at, subject): &(usize, Subject)| {
        let start = Instant::now();
        let name = subject.block().name();
        let listed = if write || search {
            Vec::new()
        } else {
            unknown_of(&page, subject)
        };
        let fates = run_beside(subject, &options, &listed, &folder.join(format!("{at}_{name}")))?;
        let row = MutationRow::new(subject, &fates);
        let _one_by_one = written.lock().unwrap_or_else(PoisonError::into_inner);
        eprintln!(
            "{name}, {}: {} mutants, {} by lock step, {} by a property, {} equivalent, {} unknown, {:.1} s",
            subject.size(),
            row.mutants,
            row.lockstep,
            row.property,
            row.equivalent,
            row.unknown.len(),
            start.elapsed().as_secs_f64()
        );
        if write {
            // Each row is written as soon as it is there, so that finished results are not lost if a later one fails.
            MARKS.renew(|old| merged(old, std::slice::from_ref(&row), &everything))?;
        }
        Ok::<_, Error>(row)
    };
    let rows = cores::each(&subjects, one, |_| ())?;
    if kept.is_none() {
        // A file that cannot be deleted stays in the temporary folder; that is no reason to fail.
        let _ = std::fs::remove_dir_all(&temporary);
    }
    print!("{}", table(&rows));
    let unlisted = unlisted(&MARKS.read()?, &rows);
    for mutant in &unlisted {
        eprintln!(
            "unknown, and not listed in ladder/RESULTS.md: {}",
            mutant.trim_start_matches("- ")
        );
    }
    Ok(unlisted.is_empty())
}

impl Example {
    /// Its stage.
    fn stage(&self) -> Result<StageConfig, Error> {
        let refused = |error: &dyn std::fmt::Display| Error::Option(format!("examples/{}: {error}", self.file));
        let machine = machine_file::parse(self.file, self.text).map_err(|error| refused(&error))?;
        let design = design_machine(&machine).map_err(|error| refused(&error))?;
        let stage = hardware::stage(&machine, &design).map_err(|error| refused(&error))?;
        Ok(stage.ok_or_else(|| refused(&"it has no stage"))?.config)
    }
}

/// Tries the constants and wires of the stages of two machines, side by side; true if the page lists each that was not found.
fn mutate_wires(most: usize, options: &MutationOptions, write: bool) -> Result<bool, Error> {
    let stages = [
        ("stage", XY_STAGE, WIRES_MARKS),
        ("stage with steps", PRINTER, STEPS_WIRES_MARKS),
    ];
    let found = thread::scope(|scope| {
        let searches = stages.each_ref().map(|(_, example, _)| {
            scope.spawn(|| {
                let folder =
                    std::env::temp_dir().join(format!("posicast-mutate-{}-{}", std::process::id(), example.top));
                let found = wires(&example.stage()?, example.top, most, options, &folder);
                // A file that cannot be deleted stays in the temporary folder; that is no reason to fail.
                let _ = std::fs::remove_dir_all(&folder);
                found
            })
        });
        searches.map(|search| search.join().unwrap_or_else(|panic| resume_unwind(panic)))
    });
    let mut is_listed = true;
    for ((name, _, marks), found) in stages.iter().zip(found) {
        let (all, fates) = found?;
        let table = wires_table(name, all, &fates, options.clocks);
        if write {
            marks.renew(|_| table.clone())?;
        }
        println!("{table}");
        let page = marks.read()?;
        let unseen = fates.iter().filter(|fate| fate.kill.is_none());
        for mutant in unseen.map(|fate| fate.mutant.describe()) {
            if !page.contains(&mutant) {
                eprintln!("{name}: not found, and not listed in ladder/RESULTS.md: {mutant}");
                is_listed = false;
            }
        }
    }
    Ok(is_listed)
}

/// Tries the named mutants, each in the stage of the example machine.
fn mutate_inside(options: &MutationOptions, write: bool) -> Result<bool, Error> {
    let stage = XY_STAGE.stage()?;
    let mut fates = Vec::new();
    for mutant in INSIDE {
        let start = Instant::now();
        let found = hunt(&mutant, &stage, XY_STAGE.top, options.clocks, options.seed)?;
        let by = found
            .as_ref()
            .map_or("NOT FOUND".to_owned(), |found| format!("{found:?}"));
        eprintln!("{}: {by}, {:.1} s", mutant.name, start.elapsed().as_secs_f64());
        fates.push((mutant, found));
    }
    let table = inside_table(&fates);
    if write {
        INSIDE_MARKS.renew(|_| table.clone())?;
    }
    print!("{table}");
    Ok(fates.iter().all(|(_, found)| found.is_some()))
}
