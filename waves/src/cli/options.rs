//! Options of the command line that say when, which and how to compare.

use std::path::{Path, PathBuf};

use super::Args;
use crate::WaveError;
use crate::diff::{DiffOptions, Reset, SamplingEdge, UnknownPolicy, parse_time_fs};

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "When to compare")]
pub(super) struct When {
    /// Sample at the edges of this 1-bit signal [default: the only clock found, else every change]
    #[arg(long, value_name = "NAME")]
    clock: Option<String>,
    /// Edge of the clock at which to sample
    #[arg(long, value_enum, default_value_t = EdgeName::Rising)]
    edge: EdgeName,
    /// Compare from where this 1-bit signal is released on each side; `none`: from the start [default: the only reset
    /// found]
    #[arg(long, value_name = "NAME[=0|1]")]
    reset: Option<String>,
    /// Compare at every change, whether there is a clock or not
    #[arg(long, conflicts_with = "clock")]
    raw: bool,
    /// First time to compare, such as 10us, as the first file counts it
    #[arg(long, value_name = "TIME", value_parser = parse_time_fs)]
    start: Option<u128>,
    /// Last time to compare
    #[arg(long, value_name = "TIME", value_parser = parse_time_fs)]
    end: Option<u128>,
    /// With --raw: ignore differences that last no longer than this
    #[arg(long, value_name = "TIME", value_parser = parse_time_fs)]
    time_tolerance: Option<u128>,
    /// With --raw: remove values that last shorter than this, in both files
    #[arg(long, value_name = "TIME", value_parser = parse_time_fs)]
    glitch: Option<u128>,
    /// Stop at the first difference, and show the state of all signals there
    #[arg(long)]
    first: bool,
    /// Delay of a signal in the second file, in samples or with --raw as a time; negative: earlier (repeatable)
    #[arg(long, value_name = "SIGNAL=SAMPLES|TIME", allow_hyphen_values = true)]
    latency: Vec<String>,
}

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Which signals")]
pub(super) struct Which {
    /// Match scope or signal A of the first file with B of the second; with * in both, a pattern (repeatable)
    #[arg(long, value_name = "A=B")]
    map: Vec<String>,
    /// Read such maps from a file, one per line
    #[arg(long, value_name = "FILE")]
    map_file: Option<PathBuf>,
    /// Compare only what is below this scope of the first file
    #[arg(long, value_name = "SCOPE")]
    root_a: Option<String>,
    /// Compare only what is below this scope of the second file
    #[arg(long, value_name = "SCOPE")]
    root_b: Option<String>,
    /// Compare only these signals or scopes (repeatable)
    #[arg(long, value_name = "SIGNAL")]
    only: Vec<String>,
    /// Leave out these signals or scopes (repeatable)
    #[arg(long, value_name = "SIGNAL")]
    ignore: Vec<String>,
    /// Count a signal that only one file has as a difference; without this option, such signals are only listed
    #[arg(long)]
    require_all: bool,
}

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "How to compare")]
pub(super) struct How {
    /// Largest difference that counts as equal, of one signal or of all: 2 LSB, 0.01abs in its unit, or 0.1%
    /// (repeatable)
    #[arg(long, value_name = "[SIGNAL=]AMOUNT")]
    tolerance: Vec<String>,
    /// Read the bits of a signal as a number: signed, unsigned, q15.16, uq16 (repeatable)
    #[arg(long, value_name = "SIGNAL=VIEW")]
    view: Vec<String>,
    /// Compare a VCD that ends in the middle of a line up to there, instead of refusing it
    #[arg(long)]
    allow_truncated: bool,
    /// What unknown bits (x, z) equal
    #[arg(long, value_enum, default_value_t = UnknownName::Strict)]
    unknown: UnknownName,
}

#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum EdgeName {
    Rising,
    Falling,
}

#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum UnknownName {
    /// Only themselves
    Strict,
    /// Anything
    Wildcard,
    /// 0
    Zero,
}

impl Which {
    pub(super) fn map_file(&self) -> Option<&Path> {
        self.map_file.as_deref()
    }
}

/// Returns the options as data.
pub(super) fn of(args: &Args) -> Result<DiffOptions, WaveError> {
    let Args { when, which, how, .. } = args;
    let mut options = DiffOptions {
        clock: when.clock.clone(),
        edge: match when.edge {
            EdgeName::Rising => SamplingEdge::Rising,
            EdgeName::Falling => SamplingEdge::Falling,
        },
        raw: when.raw,
        reset: Reset::Found,
        start_fs: when.start,
        end_fs: when.end,
        time_tolerance_fs: when.time_tolerance.unwrap_or(0),
        glitch_fs: when.glitch.unwrap_or(0),
        roots: [which.root_a.clone(), which.root_b.clone()],
        only: which.only.clone(),
        ignore: which.ignore.clone(),
        unknown: match how.unknown {
            UnknownName::Strict => UnknownPolicy::Strict,
            UnknownName::Wildcard => UnknownPolicy::Wildcard,
            UnknownName::Zero => UnknownPolicy::Zero,
        },
        require_all: which.require_all,
        first: when.first,
        allow_truncated: how.allow_truncated,
        ..DiffOptions::default()
    };
    if let Some(path) = &which.map_file {
        let text = std::fs::read_to_string(path).map_err(WaveError::file(path, "read"))?;
        options
            .add_map_file(&text)
            .map_err(|error| WaveError::Option(format!("{}: {error}", path.display())))?;
    }
    let mut add = |texts: &[String], add: fn(&mut DiffOptions, &str) -> Result<(), WaveError>| {
        texts.iter().try_for_each(|text| add(&mut options, text))
    };
    add(&which.map, DiffOptions::add_map)?;
    add(&how.tolerance, DiffOptions::add_tolerance)?;
    add(&how.view, DiffOptions::add_view)?;
    add(&when.latency, DiffOptions::add_latency)?;
    if let Some(text) = &when.reset {
        options.set_reset(text)?;
    }
    Ok(options)
}
