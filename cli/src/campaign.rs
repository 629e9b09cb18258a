//! `posicast campaign`: long checks in parts, for many cores or many machines.

use crate::terminal::Terminal;
use crate::{output, render};
use posicast_flow::campaign::{
    self, CampaignPart, CoverageOptions, FaultOptions, LockStepOptions, MutantOptions, NetlistOptions, Place,
    ProofOptions, SweepOptions, TrialOptions, WaveformOptions, place,
};
use posicast_flow::text::shell_word;
use posicast_flow::verify::DEFAULT_SEED;
use posicast_flow::{Failure, clocks};
use posicast_testbench::shard::Shard;
use std::ffi::OsString;
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

Exit status: 0 every unit passed, 1 a unit failed or a shard is missing, 2 bad input, 3 a tool is missing.")]
pub(crate) struct Args {
    #[command(subcommand)]
    kind: Kind,
}

#[derive(clap::Subcommand)]
enum Kind {
    LockStep(LockStepArgs),
    Faults(FaultsArgs),
    Mutants(MutantsArgs),
    Proofs(ProofsArgs),
    Netlists(NetlistsArgs),
    Coverage(CoverageArgs),
    Identify(IdentifyArgs),
    Waveforms(WaveformsArgs),
    Sweep(SweepArgs),
    Merge(MergeArgs),
}

/// Which units are done, and where their results go.
#[derive(clap::Args)]
struct PartArgs {
    /// Part of the campaign: 3/40 is the third of forty
    #[arg(long, value_name = "K/N", default_value_t = Shard::WHOLE)]
    shard: Shard,
    /// Run only the unit with this number, from 0, as `merge` prints it
    #[arg(long, value_name = "NUMBER", conflicts_with_all = ["shard", "json"])]
    unit: Option<u64>,
    /// Seed of the campaign; the seed of each unit follows from it
    #[arg(long, default_value_t = DEFAULT_SEED)]
    seed: u64,
    /// File for the results of this part; if it already holds them, the part is not run again
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// Compare the Verilog of a machine with its model in every clock, over many seeds
#[derive(clap::Args)]
struct LockStepArgs {
    /// Machine file, or a folder that `generate` or `run` wrote
    source: PathBuf,
    /// Only the blocks of this name, such as pulse_counter; may be given several times
    #[arg(long = "block", value_name = "NAME")]
    blocks: Vec<String>,
    /// Clocks to compare in every row, rounded up to whole units
    #[arg(long, default_value_t = 100_000_000, value_parser = clocks)]
    clocks: u64,
    /// Clocks of a unit; more if exercising every tap, bank and flag takes more
    #[arg(long, default_value_t = 10_000_000, value_parser = clocks)]
    unit_clocks: u64,
    /// Accept edited Verilog in the folder, judged by the simulation alone
    #[arg(long)]
    edited: bool,
    /// Build the simulations and do nothing else, so that the shards find them built
    #[arg(long, conflicts_with_all = ["shard", "unit", "json"])]
    prepare: bool,
    #[command(flatten)]
    part: PartArgs,
}

/// Inject faults into the stage of the example machine, and check how it reacts
#[derive(clap::Args)]
struct FaultsArgs {
    /// Number of faults, rounded up to whole units
    #[arg(long, default_value_t = 10_000, value_parser = clap::value_parser!(u64).range(1..=1_000_000_000))]
    cases: u64,
    #[command(flatten)]
    part: PartArgs,
}

/// Put mutants into the blocks, and check that lock step or proofs detect each
#[derive(clap::Args)]
struct MutantsArgs {
    /// Only the blocks of this name; may be given several times
    #[arg(long = "block", value_name = "NAME")]
    blocks: Vec<String>,
    /// Number of mutants of each block, rounded up to whole units; fewer if the block has fewer places for them
    #[arg(long, default_value_t = 60, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    mutants: u64,
    #[command(flatten)]
    part: PartArgs,
}

/// Prove the properties of the blocks
#[derive(clap::Args)]
struct ProofsArgs {
    /// Only the properties of the blocks of this name; may be given several times
    #[arg(long = "block", value_name = "NAME")]
    blocks: Vec<String>,
    #[command(flatten)]
    part: PartArgs,
}

/// Compare the netlist of each block with its model and its RTL
#[derive(clap::Args)]
struct NetlistsArgs {
    /// Only the blocks of this name; may be given several times
    #[arg(long = "block", value_name = "NAME")]
    blocks: Vec<String>,
    /// Number of clocks for which each netlist is simulated, such as 1000000 or 1e6
    #[arg(long, default_value = "100000", value_parser = clocks)]
    clocks: u64,
    #[command(flatten)]
    part: PartArgs,
}

/// Measure which lines, nets and bins of the blocks the lock step reaches
#[derive(clap::Args)]
struct CoverageArgs {
    /// Only the blocks of this name; may be given several times
    #[arg(long = "block", value_name = "NAME")]
    blocks: Vec<String>,
    #[command(flatten)]
    part: PartArgs,
}

/// Identify modes in logs of random machines, and compare them with the machines' own modes
#[derive(clap::Args)]
struct IdentifyArgs {
    /// Number of logs, rounded up to whole units
    #[arg(long, default_value_t = 1_000, value_parser = clap::value_parser!(u64).range(1..=1_000_000_000))]
    logs: u64,
    #[command(flatten)]
    part: PartArgs,
}

/// Damage recordings at random, and check that the comparison copes with them
#[derive(clap::Args)]
struct WaveformsArgs {
    /// Small recordings, VCD or FST; each case damages one of them
    #[arg(required = true, value_name = "FILE")]
    recordings: Vec<PathBuf>,
    /// Number of damaged recordings, rounded up to whole units
    #[arg(long, default_value_t = 10_000, value_parser = clap::value_parser!(u64).range(1..=1_000_000_000))]
    cases: u64,
    #[command(flatten)]
    part: PartArgs,
}

/// Design a machine at every combination of values: residual, duration, area, clock
#[derive(clap::Args)]
#[command(after_help = "\
A place is a path in the machine file. An axis is written with its name, a mode with its number:
  --set axis.x.shaper.kind=zv,zvd,ei --set axis.x.mode.1.damping=0.05,0.1 --set clock.sample_hz=2000,10000

A combination that posicast refuses becomes a row with the reason; it is not a failure.")]
struct SweepArgs {
    /// Machine file with all other values
    machine: PathBuf,
    /// A place in the machine file and its values; several places are combined
    #[arg(long = "set", value_name = "PLACE=VALUE,…", required = true, value_parser = place)]
    places: Vec<Place>,
    /// Estimate the area by Yosys: some seconds per combination
    #[arg(long)]
    area: bool,
    /// Estimate the highest clock by place and route: minutes per combination
    #[arg(long)]
    clock: bool,
    #[command(flatten)]
    part: PartArgs,
}

/// Merge the shards of a campaign into one table, and list the failures
#[derive(clap::Args)]
struct MergeArgs {
    /// Folder with the shards' files, and no other `*.json` files
    folder: PathBuf,
    /// Print one JSON document on standard output; it does not depend on the number of shards
    #[arg(long)]
    json: bool,
}

impl PartArgs {
    fn part(&self, given: &[OsString]) -> CampaignPart {
        CampaignPart {
            shard: self.shard,
            unit: self.unit,
            seed: self.seed,
            json: self.json.clone(),
            repeat: repeat(given),
        }
    }
}

/// Runs the campaign that `args` describe; `given` are the command's words, for the line that repeats it.
pub(crate) fn run(args: &Args, given: &[OsString]) -> Result<(), Failure> {
    let started = Instant::now();
    let (kind, part) = match &args.kind {
        Kind::Merge(args) => {
            return output::show(campaign::merge(&args.folder)?, args.json, render::campaign::merged);
        }
        Kind::LockStep(args) => {
            let options = LockStepOptions {
                source: args.source.clone(),
                blocks: args.blocks.clone(),
                clocks: args.clocks,
                unit_clocks: args.unit_clocks,
                edited: args.edited,
            };
            if args.prepare {
                return output::show(
                    campaign::prepare(&options, &Terminal)?,
                    false,
                    render::campaign::prepared,
                );
            }
            (campaign::CampaignKind::LockStep(options), &args.part)
        }
        Kind::Faults(args) => (
            campaign::CampaignKind::Faults(FaultOptions { cases: args.cases }),
            &args.part,
        ),
        Kind::Mutants(args) => {
            let options = MutantOptions {
                blocks: args.blocks.clone(),
                mutants: args.mutants,
            };
            (campaign::CampaignKind::Mutants(options), &args.part)
        }
        Kind::Proofs(args) => {
            let blocks = args.blocks.clone();
            (campaign::CampaignKind::Proofs(ProofOptions { blocks }), &args.part)
        }
        Kind::Netlists(args) => {
            let options = NetlistOptions {
                blocks: args.blocks.clone(),
                clocks: args.clocks,
            };
            (campaign::CampaignKind::Netlists(options), &args.part)
        }
        Kind::Coverage(args) => {
            let blocks = args.blocks.clone();
            (campaign::CampaignKind::Coverage(CoverageOptions { blocks }), &args.part)
        }
        Kind::Identify(args) => (
            campaign::CampaignKind::Identify(TrialOptions { logs: args.logs }),
            &args.part,
        ),
        Kind::Waveforms(args) => {
            let options = WaveformOptions {
                recordings: args.recordings.clone(),
                cases: args.cases,
            };
            (campaign::CampaignKind::Waveforms(options), &args.part)
        }
        Kind::Sweep(args) => {
            let options = SweepOptions {
                machine: args.machine.clone(),
                places: args.places.clone(),
                area: args.area,
                clock: args.clock,
            };
            (campaign::CampaignKind::Sweep(options), &args.part)
        }
    };
    let done = campaign::run(&kind, &part.part(given), started, &Terminal)?;
    output::show(done, false, render::campaign::part)
}

/// The command of these words without the options that choose a part of the campaign.
fn repeat(given: &[OsString]) -> String {
    let mut words = vec!["posicast".to_owned()];
    let mut given = given.iter().skip(1);
    while let Some(word) = given.next() {
        match word.to_string_lossy().as_ref() {
            "--shard" | "--json" => drop(given.next()),
            word if word.starts_with("--shard=") || word.starts_with("--json=") => {}
            word => words.push(shell_word(word.as_ref())),
        }
    }
    words.join(" ")
}
