//! `posicast campaign`: long checks in parts, for many cores or many machines.
//!
//! A file per kind of campaign has the list of units and the work of a unit. This file runs the units of a shard, writes its file, and
//! prints its table; `merge` joins the files.

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

use crate::Outcome;
use crate::failure::Failure;
use crate::observer::Observer;
use crate::text::{Table, shell_word};
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

pub use coverage::CoverageOptions;
pub use faults::FaultOptions;
pub use identify::TrialOptions;
pub use lock_step::{LockStepOptions, prepare};
pub use merge::merge;
pub use mutants::MutantOptions;
pub use netlists::NetlistOptions;
pub use proofs::ProofOptions;
pub use sweep::{Place, SweepOptions, place};
pub use waveforms::WaveformOptions;

/// What a campaign checks.
#[derive(Debug, Clone)]
pub enum CampaignKind {
    /// The Verilog of a machine against its model in every clock, over many seeds.
    LockStep(LockStepOptions),
    /// How the stage of the example machine reacts to faults.
    Faults(FaultOptions),
    /// Whether lock step or proofs notice mutants of the blocks.
    Mutants(MutantOptions),
    /// The properties of the blocks.
    Proofs(ProofOptions),
    /// The netlist of each block against its model and its RTL.
    Netlists(NetlistOptions),
    /// Which lines, nets and bins of the blocks the lock step reaches.
    Coverage(CoverageOptions),
    /// The modes found in logs of random machines.
    Identify(TrialOptions),
    /// Whether comparing recordings survives their damage.
    Waveforms(WaveformOptions),
    /// The design of a machine at every combination of values.
    Sweep(SweepOptions),
}

/// Which units are done, and where their results go.
#[derive(Debug, Clone)]
pub struct CampaignPart {
    /// Part of the campaign.
    pub shard: Shard,
    /// Only this unit, from 0, as [`merge`] names it.
    pub unit: Option<u64>,
    /// Seed of the campaign, from which that of each unit follows.
    pub seed: u64,
    /// File for the results of this part; a part that has its file is not run again.
    pub json: Option<PathBuf>,
    /// The command without the options that select a part: it is stored in the file, and [`merge`] prints it.
    pub repeat: String,
}

/// A campaign: its ordered units, and the work of each.
trait Units {
    /// Name of the kind, as on the command line.
    fn kind(&self) -> &'static str;
    /// The machine of the campaign, if it has one.
    fn machine(&self) -> Option<MachineFileHash>;
    /// All options on which the units and their work depend.
    fn options(&self) -> Map<String, Value>;
    /// Number of units.
    fn count(&self) -> u64;
    /// Name of a unit.
    fn name(&self, unit: u64) -> String;
    /// Names of all units, for [`Units::options`] if the units are named there one by one.
    fn names(&self) -> Value {
        (0..self.count()).map(|unit| self.name(unit)).collect()
    }
    /// Returns an error that names all missing tools of the units.
    fn require_tools(&self) -> Result<(), Failure> {
        Ok(())
    }
    /// Runs a unit from a fresh start. `seed` is that of the campaign.
    fn run(&self, unit: u64, seed: u64) -> Result<UnitOutcome, Failure>;
}

/// Result of a unit.
struct UnitOutcome {
    figures: Map<String, Value>,
    failure: Option<String>,
}

/// Runs a part of a campaign. `started` is the time at which the command began.
///
/// # Errors
/// [`Failure`] for files that cannot be read, built or written, and for a missing tool. A failed unit is not an error but gives
/// [`Outcome::failed`].
pub fn run(
    kind: &CampaignKind,
    part: &CampaignPart,
    started: Instant,
    observer: &dyn Observer,
) -> Result<Outcome<()>, Failure> {
    let run = |campaign: &dyn Units| run_part(campaign, part, started, observer);
    match kind {
        CampaignKind::LockStep(options) => run(&lock_step::LockStep::new(options, observer)?),
        CampaignKind::Faults(options) => run(&faults::of(options)),
        CampaignKind::Mutants(options) => run(&mutants::of(options)?),
        CampaignKind::Proofs(options) => run(&proofs::of(options)?),
        CampaignKind::Netlists(options) => run(&netlists::of(options)?),
        CampaignKind::Coverage(options) => run(&coverage::of(options)?),
        CampaignKind::Identify(options) => run(&identify::of(options)),
        CampaignKind::Waveforms(options) => run(&waveforms::of(options)?),
        CampaignKind::Sweep(options) => run(&sweep::of(options, observer)?),
    }
}

/// Figures from their names and values.
fn figures<V: Into<Value>>(list: impl IntoIterator<Item = (&'static str, V)>) -> Map<String, Value> {
    list.into_iter()
        .map(|(name, value)| (name.to_owned(), value.into()))
        .collect()
}

/// Seeds of the cases of a unit with `unit_cases` cases. Campaigns with other seeds share none of them.
fn case_seeds(campaign_seed: u64, unit: u64, unit_cases: u64) -> impl Iterator<Item = u64> {
    let first = campaign_seed.rotate_left(32);
    (unit * unit_cases..(unit + 1) * unit_cases).map(move |case| first.wrapping_add(case))
}

/// Keeps the entries of the blocks with these names; all, if there is no name.
fn only_blocks<T>(list: &mut Vec<T>, wanted: &[String], name: impl Fn(&T) -> &str) -> Result<(), Failure> {
    let mut names: Vec<&str> = list.iter().map(&name).collect();
    names.dedup();
    if let Some(unknown) = wanted.iter().find(|wanted| !names.contains(&wanted.as_str())) {
        let near = did_you_mean(unknown, &names, '`').map_or_else(String::new, |question| format!("{question} Else "));
        return Err(
            Failure::input(format!("--block {unknown}: this campaign has no block of this name"))
                .with_help(format!("{near}choose from: {}", names.join(", "))),
        );
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

fn run_part(
    campaign: &dyn Units,
    part: &CampaignPart,
    started: Instant,
    observer: &dyn Observer,
) -> Result<Outcome<()>, Failure> {
    let units = campaign.count();
    if let Some(unit) = part.unit {
        if unit >= units {
            return Err(
                Failure::input(format!("--unit {unit}: this campaign has {}", counted(units, "unit")))
                    .with_help("units are counted from 0"),
            );
        }
        return Ok(finish(&done(campaign, [unit], part.seed, observer)?, part, ""));
    }
    let head = CampaignHead {
        posicast_campaign: FORMAT,
        version: crate::VERSION.to_owned(),
        kind: campaign.kind().to_owned(),
        machine: campaign.machine(),
        seed: part.seed,
        options: campaign.options(),
        units,
    };
    if let Some(results) = finished(&head, part)? {
        let beside = "; this shard was finished already and was not run again";
        return Ok(finish(&results, part, beside));
    }
    let prepared = Instant::now();
    let results = done(campaign, part.shard.units(units), part.seed, observer)?;
    let Some(path) = &part.json else {
        return Ok(finish(&results, part, ""));
    };
    let document = ShardDocument {
        head,
        shard: part.shard,
        repeat: part.repeat.clone(),
        seconds: prepared.elapsed().as_secs_f64(),
        overhead_seconds: (prepared - started).as_secs_f64(),
        results,
    };
    document.write(path).map_err(Failure::because)?;
    let beside = format!("; written to {}", shell_word(path));
    Ok(finish(&document.results, part, &beside))
}

/// Returns the results in the file of this shard; `None` if there is no file.
fn finished(head: &CampaignHead, part: &CampaignPart) -> Result<Option<Vec<UnitResult>>, Failure> {
    let Some(path) = &part.json else {
        return Ok(None);
    };
    let Some(document) = ShardDocument::read(path).map_err(Failure::because)? else {
        return Ok(None);
    };
    if document.head == *head && document.shard == part.shard {
        return Ok(Some(document.results));
    }
    let what = if document.shard == part.shard {
        "has this shard of another campaign: seed, options, machine or posicast differ".to_owned()
    } else {
        format!("has shard {}", document.shard)
    };
    Err(Failure::input(format!("--json: `{}` {what}", path.display()))
        .with_help("name another file, or another folder for each campaign; nothing was changed"))
}

/// Runs these units one after the other, because each shard has one core.
fn done(
    campaign: &dyn Units,
    units: impl IntoIterator<Item = u64>,
    seed: u64,
    observer: &dyn Observer,
) -> Result<Vec<UnitResult>, Failure> {
    let units: Vec<u64> = units.into_iter().collect();
    campaign.require_tools()?;
    let bar = observer.begin(campaign.kind(), Some(units.len() as u64));
    let mut results = Vec::with_capacity(units.len());
    for unit in units {
        let name = campaign.name(unit);
        bar.rename(&name);
        let UnitOutcome { figures, failure } = campaign.run(unit, seed)?;
        bar.advance(1);
        results.push(UnitResult {
            unit,
            name,
            figures,
            failure,
        });
    }
    Ok(results)
}

/// Returns the table of these results; failed if one of them failed.
fn finish(results: &[UnitResult], part: &CampaignPart, beside: &str) -> Outcome<()> {
    let failed: Vec<&UnitResult> = results.iter().filter(|result| result.failure.is_some()).collect();
    let mut text = table(&shard::rows(results));
    for result in failed.iter().take(MOST_SHOWN) {
        text += &of_failure(result);
    }
    text += &format!("{}{beside}\n", counts(results));
    Outcome {
        failed: problem(results, part.unit.is_none() && part.shard == Shard::WHOLE),
        ..Outcome::passed((), text)
    }
}

/// Returns the numbers of units, of failed and of refused ones.
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

/// Returns why a part of a campaign, or all of it, fails. A part without a unit has checked nothing, nor has a campaign whose units were
/// all refused.
fn problem(results: &[UnitResult], are_all: bool) -> Option<String> {
    let failed = results.iter().filter(|result| result.failure.is_some()).count();
    if results.is_empty() {
        Some("no unit was done: this part of the campaign is empty".to_owned())
    } else if are_all && results.iter().all(is_refused) {
        Some("no unit was done: all were refused".to_owned())
    } else {
        (failed > 0).then(|| format!("{failed} of {} failed", counted(results.len() as u64, "unit")))
    }
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

/// Name of the figure that gives the reason for a unit without others; it becomes a line below the table.
const REFUSED: &str = "refused";
