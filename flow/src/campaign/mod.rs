//! `posicast campaign`: long checks in parts, for many cores or many machines.
//!
//! A file per kind of campaign has the list of units and the work of a unit. This file runs the units of a shard, and writes its file;
//! `merge` joins the files.

mod coverage;
mod document;
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
use posicast_machine::spelling::choose_from;
use posicast_testbench::blocks::Block;
use posicast_testbench::shard::{CampaignHead, FORMAT, MachineFileHash, Shard, ShardDocument, UnitResult};
use posicast_testbench::wording::counted;
use serde_json::{Map, Value};
use sha2::{Digest, Sha256};
use std::path::PathBuf;
use std::time::Instant;

pub use coverage::CoverageOptions;
use document::problem;
pub use document::{Document, MergedShards, PartFile, PreparedSimulations, ShardCosts, UnitCounts};
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
) -> Result<Outcome<Document>, Failure> {
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
        return Err(
            Failure::input(format!("--block {unknown}: this campaign has no block of this name"))
                .with_help(choose_from(unknown, &names)),
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
) -> Result<Outcome<Document>, Failure> {
    let units = campaign.count();
    if let Some(unit) = part.unit {
        if unit >= units {
            return Err(
                Failure::input(format!("--unit {unit}: this campaign has {}", counted(units, "unit")))
                    .with_help("units are counted from 0"),
            );
        }
        return Ok(finish(
            &done(campaign, [unit], part.seed, observer)?,
            part,
            PartFile::None,
        ));
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
        return Ok(finish(&results, part, PartFile::Finished));
    }
    let prepared = Instant::now();
    let results = done(campaign, part.shard.units(units), part.seed, observer)?;
    let Some(path) = &part.json else {
        return Ok(finish(&results, part, PartFile::None));
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
    Ok(finish(&document.results, part, PartFile::Written(path.clone())))
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

/// Returns the document of these results; failed if one of them failed.
fn finish(results: &[UnitResult], part: &CampaignPart, file: PartFile) -> Outcome<Document> {
    Outcome {
        failed: problem(results, part.unit.is_none() && part.shard == Shard::WHOLE),
        ..Outcome::passed(Document::new(results, file))
    }
}

/// Name of the figure that gives the reason for a unit without others.
pub const REFUSED: &str = "refused";
