//! `posicast campaign`: long checks in parts, for many cores or many machines.
//!
//! The list of units, and what one of them does, is in a file per kind of campaign. This file runs the units of a shard, writes its
//! file, and prints its table; `merge` joins the files.

mod coverage;
mod faults;
mod identify;
mod lock_step;
mod merge;
mod mutants;
mod netlists;
mod proofs;
mod sweep;
mod waveforms;

use crate::failure::Failure;
use crate::output::{self, Table};
use crate::progress;
use posicast_machine::spelling::did_you_mean;
use posicast_testbench::blocks::Block;
use posicast_testbench::shard::{
    self, CampaignHead, FORMAT, MachineFileHash, MergedRow, Shard, ShardDocument, UnitResult,
};
use posicast_testbench::wording::counted;
use serde_json::{Map, Value};
use sha2::{Digest, Sha256};
use std::path::PathBuf;
use std::time::Instant;

/// Long checks in parts, for many cores or many machines
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  posicast campaign lock-step examples/xy-stage.toml --clocks 1000000000 --shard 3/40 --json part/3.json
  seq 40 | parallel posicast campaign faults --cases 10000 --shard {}/40 --json part/{}.json
  posicast campaign sweep examples/xy-stage.toml --set axis.x.shaper.kind=zv,zvd,ei --set clock.sample_hz=2000,10000
  posicast campaign merge part

Exit status: 0 every unit holds, 1 one does not, or a shard is missing, 2 bad input, 3 a tool is missing.")]
pub(crate) struct Args {
    #[command(subcommand)]
    kind: Kind,
}

#[derive(clap::Subcommand)]
enum Kind {
    LockStep(lock_step::Args),
    Faults(faults::Args),
    Mutants(mutants::Args),
    Proofs(proofs::Args),
    Netlists(netlists::Args),
    Coverage(coverage::Args),
    Identify(identify::Args),
    Waveforms(waveforms::Args),
    Sweep(sweep::Args),
    Merge(merge::Args),
}

/// Which units are done, and where their results go.
#[derive(clap::Args)]
struct Part {
    /// Part of the campaign: 3/40 is the third of forty
    #[arg(long, value_name = "K/N", default_value_t = Shard::WHOLE)]
    shard: Shard,
    /// Only this unit, from 0, as `merge` names it
    #[arg(long, value_name = "NUMBER", conflicts_with_all = ["shard", "json"])]
    unit: Option<u64>,
    /// Seed of the campaign, from which that of each unit follows
    #[arg(long, default_value_t = crate::verify::DEFAULT_SEED)]
    seed: u64,
    /// File for the results of this part; a part that has its file is not run again
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// A campaign: its units in order, and what one of them does.
trait Units {
    /// Name of the kind, as on the command line.
    fn kind(&self) -> &'static str;
    /// The machine that it is about.
    fn machine(&self) -> Option<MachineFileHash>;
    /// All options that decide what the units are and do.
    fn options(&self) -> Map<String, Value>;
    /// Number of units.
    fn count(&self) -> u64;
    /// Name of a unit.
    fn name(&self, unit: u64) -> String;
    /// Names of all units, for [`Units::options`] where each stands for itself.
    fn names(&self) -> Value {
        (0..self.count()).map(|unit| self.name(unit)).collect()
    }
    /// Refuses to begin where a tool is missing that a unit needs: all of them are named.
    fn require_tools(&self) -> Result<(), Failure> {
        Ok(())
    }
    /// Does a unit from a fresh start. `seed` is that of the campaign.
    fn run(&self, unit: u64, seed: u64) -> Result<Outcome, Failure>;
}

/// Result of a unit.
struct Outcome {
    figures: Map<String, Value>,
    failure: Option<String>,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let started = Instant::now();
    match &args.kind {
        Kind::LockStep(args) => lock_step::run(args, started),
        Kind::Faults(args) => run_part(&faults::of(args), &args.part, started),
        Kind::Mutants(args) => run_part(&mutants::of(args)?, &args.part, started),
        Kind::Proofs(args) => run_part(&proofs::of(args)?, &args.part, started),
        Kind::Netlists(args) => run_part(&netlists::of(args)?, &args.part, started),
        Kind::Coverage(args) => run_part(&coverage::of(args)?, &args.part, started),
        Kind::Identify(args) => run_part(&identify::of(args), &args.part, started),
        Kind::Waveforms(args) => run_part(&waveforms::of(args)?, &args.part, started),
        Kind::Sweep(args) => run_part(&sweep::of(args)?, &args.part, started),
        Kind::Merge(args) => merge::run(args),
    }
}

/// Figures from their names and values.
fn figures<V: Into<Value>>(list: impl IntoIterator<Item = (&'static str, V)>) -> Map<String, Value> {
    list.into_iter()
        .map(|(name, value)| (name.to_owned(), value.into()))
        .collect()
}

/// Seeds of the cases of a unit that has this many. Campaigns of other seeds have none of them.
fn case_seeds(campaign_seed: u64, unit: u64, unit_cases: u64) -> impl Iterator<Item = u64> {
    let first = campaign_seed.rotate_left(32);
    (unit * unit_cases..(unit + 1) * unit_cases).map(move |case| first.wrapping_add(case))
}

/// Keeps what belongs to the blocks of these names; all, if there is no name.
fn only_blocks<T>(list: &mut Vec<T>, wanted: &[String], name: impl Fn(&T) -> &str) -> Result<(), Failure> {
    let mut names: Vec<&str> = list.iter().map(&name).collect();
    names.dedup();
    if let Some(unknown) = wanted.iter().find(|wanted| !names.contains(&wanted.as_str())) {
        let near = did_you_mean(unknown, &names, '`').map_or_else(String::new, |question| format!("{question} Else "));
        return Err(Failure::from(miette::miette!(
            help = format!("{near}choose from: {}", names.join(", ")),
            "--block {unknown}: this campaign has no block of this name"
        )));
    }
    list.retain(|of| wanted.is_empty() || wanted.iter().any(|wanted| wanted == name(of)));
    Ok(())
}

/// Name of a block's row.
fn row_name(block: &dyn Block) -> String {
    format!("{} {}", block.name(), block.instance()).trim_end().to_owned()
}

/// SHA-256 of these texts, in hexadecimal digits.
fn hash_of<'a>(texts: impl IntoIterator<Item = &'a [u8]>) -> String {
    let mut hash = Sha256::new();
    for text in texts {
        // The length is hashed too, so that texts cannot run into each other.
        hash.update((text.len() as u64).to_le_bytes());
        hash.update(text);
    }
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

fn run_part(campaign: &dyn Units, part: &Part, started: Instant) -> Result<(), Failure> {
    let units = campaign.count();
    if let Some(unit) = part.unit {
        if unit >= units {
            return Err(Failure::from(miette::miette!(
                help = "units are counted from 0",
                "--unit {unit}: this campaign has {}",
                counted(units, "unit")
            )));
        }
        return finish(&done(campaign, [unit], part.seed)?, part, "");
    }
    let head = CampaignHead {
        posicast_campaign: FORMAT,
        version: env!("POSICAST_VERSION").to_owned(),
        kind: campaign.kind().to_owned(),
        machine: campaign.machine(),
        seed: part.seed,
        options: campaign.options(),
        units,
    };
    if let Some(results) = finished(&head, part)? {
        return finish(
            &results,
            part,
            "; this shard was finished already and was not run again",
        );
    }
    let prepared = Instant::now();
    let results = done(campaign, part.shard.units(units), part.seed)?;
    let Some(path) = &part.json else {
        return finish(&results, part, "");
    };
    let document = ShardDocument {
        head,
        shard: part.shard,
        repeat: repeat(),
        seconds: prepared.elapsed().as_secs_f64(),
        overhead_seconds: (prepared - started).as_secs_f64(),
        results,
    };
    document.write(path).map_err(Failure::because)?;
    finish(
        &document.results,
        part,
        &format!("; written to {}", output::shell_word(path)),
    )
}

/// The results that the file of this shard has already; `None` if there is no file.
fn finished(head: &CampaignHead, part: &Part) -> Result<Option<Vec<UnitResult>>, Failure> {
    let Some(path) = &part.json else {
        return Ok(None);
    };
    let Some(document) = ShardDocument::read(path).map_err(Failure::because)? else {
        return Ok(None);
    };
    if document.head == *head && document.shard == part.shard {
        return Ok(Some(document.results));
    }
    let what = match document.shard == part.shard {
        true => "has this shard of another campaign: seed, options, machine or posicast differ".to_owned(),
        false => format!("has shard {}", document.shard),
    };
    Err(Failure::from(miette::miette!(
        help = "name another file, or another folder for each campaign; nothing was changed",
        "--json: `{}` {what}",
        path.display()
    )))
}

/// Does these units, one after the other: a core is given to each shard.
fn done(campaign: &dyn Units, units: impl IntoIterator<Item = u64>, seed: u64) -> Result<Vec<UnitResult>, Failure> {
    let units: Vec<u64> = units.into_iter().collect();
    campaign.require_tools()?;
    let bar = progress::bar(campaign.kind(), units.len() as u64);
    let mut results = Vec::with_capacity(units.len());
    for unit in units {
        let name = campaign.name(unit);
        bar.set_message(name.clone());
        let Outcome { figures, failure } = campaign.run(unit, seed)?;
        bar.inc(1);
        results.push(UnitResult {
            unit,
            name,
            figures,
            failure,
        });
    }
    bar.finish_and_clear();
    Ok(results)
}

/// Prints the table of these results; it is the failure of a check if one does not hold.
fn finish(results: &[UnitResult], part: &Part, beside: &str) -> Result<(), Failure> {
    let failed: Vec<&UnitResult> = results.iter().filter(|result| result.failure.is_some()).collect();
    let mut text = table(&shard::rows(results));
    for result in failed.iter().take(MOST_SHOWN) {
        text += &of_failure(result);
    }
    text += &format!("{}{beside}\n", counts(results));
    output::print_styled(&text)?;
    verdict(results, part.unit.is_none() && part.shard == Shard::WHOLE)
}

/// How many units there were, how many failed, and how many were refused.
fn counts(results: &[UnitResult]) -> String {
    let failed = results.iter().filter(|result| result.failure.is_some()).count();
    let refused = match results.iter().filter(|result| is_refused(result)).count() {
        0 => String::new(),
        count => format!(", {count} refused"),
    };
    format!("{}, {failed} failed{refused}", counted(results.len() as u64, "unit"))
}

fn is_refused(result: &UnitResult) -> bool {
    result.figures.contains_key(REFUSED)
}

/// Number of failures that are shown in words.
const MOST_SHOWN: usize = 5;

fn of_failure(result: &UnitResult) -> String {
    let why = result.failure.as_deref().unwrap_or_default();
    format!("unit {}, {}: {why}\n", result.unit, result.name)
}

/// The verdict on a part of a campaign, or on all of it. One without a unit has checked nothing, nor has a campaign of which every unit was refused.
fn verdict(results: &[UnitResult], are_all: bool) -> Result<(), Failure> {
    let failed = results.iter().filter(|result| result.failure.is_some()).count();
    let problem = if results.is_empty() {
        "no unit was done: this part of the campaign is empty".to_owned()
    } else if are_all && results.iter().all(is_refused) {
        "no unit was done: all were refused".to_owned()
    } else if failed > 0 {
        format!("{failed} of {} failed", counted(results.len() as u64, "unit"))
    } else {
        return Ok(());
    };
    Err(Failure::Check(problem))
}

/// A table with a row for each name, and a column for each figure.
fn table(rows: &[MergedRow]) -> String {
    let mut columns: Vec<&str> = Vec::new();
    for row in rows {
        for name in row.figures.keys().filter(|name| *name != REFUSED) {
            if !columns.contains(&name.as_str()) {
                columns.push(name);
            }
        }
    }
    let headings: Vec<String> = columns.iter().map(|column| format!(">{column}")).collect();
    let headings = ["name", ">units"]
        .into_iter()
        .chain(headings.iter().map(String::as_str));
    let mut table = Table::new(&headings.collect::<Vec<_>>());
    for row in rows {
        let cell = |column: &&str| match row.figures.get(*column) {
            None | Some(Value::Null) => "–".to_owned(),
            Some(Value::String(text)) => text.clone(),
            Some(other) => other.to_string(),
        };
        let cells = columns.iter().map(cell);
        table.row([row.name.clone(), row.units.to_string()].into_iter().chain(cells));
    }
    let refused = rows
        .iter()
        .filter_map(|row| Some((&row.name, row.figures.get(REFUSED)?.as_str()?)));
    table.text("")
        + &refused
            .map(|(name, why)| {
                format!(
                    "{name}: {}\n",
                    why.lines().map(str::trim).collect::<Vec<_>>().join("; ")
                )
            })
            .collect::<String>()
}

/// Name of the figure that says why a unit has no others; it is a line below the table.
const REFUSED: &str = "refused";

/// This command without the options that choose a part of the campaign.
fn repeat() -> String {
    let mut words = vec!["posicast".to_owned()];
    let mut given = std::env::args().skip(1);
    while let Some(word) = given.next() {
        match word.as_str() {
            "--shard" | "--json" => drop(given.next()),
            _ if word.starts_with("--shard=") || word.starts_with("--json=") => {}
            _ => words.push(output::shell_word(word.as_ref())),
        }
    }
    words.join(" ")
}
