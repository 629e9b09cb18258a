//! `posicast diff`: two waveform files compared.

use crate::failure::Failure;
use crate::{output, progress};
use posicast_system::output::OutputFiles;
use posicast_testbench::wave::{SealedFiles, write_text};
use std::path::PathBuf;
use std::time::{Duration, Instant};
use wavecmp::WaveError;
use wavecmp::diff::{
    self, Comparison, DiffOptions, DiffVerdict, Progress, Reset, SamplingEdge, UnknownPolicy, parse_time_fs,
};

/// Compare two waveforms (VCD or FST), sampled at the clock
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  posicast diff model.vcd rtl.vcd                        exact, at the rising edges of the only clock
  posicast diff rtl.vcd float.vcd --tolerance x_y=1.5 --view 'x_*=q15.16'
  posicast diff a.vcd b.fst --map top.dut=tb.u_dut --clock clk --show first
  posicast diff pins.vcd pins2.vcd --raw --time-tolerance 2ns --glitch 1ns

A SIGNAL is a full name, its end behind a dot, or a pattern: * within a scope, ** across scopes.

Exit status: 0 equal, 1 different, 2 nothing in common or unreadable.")]
pub(crate) struct Args {
    /// First file
    a: PathBuf,
    /// Second file
    b: PathBuf,
    #[command(flatten)]
    when: When,
    #[command(flatten)]
    which: Which,
    #[command(flatten)]
    how: How,
    /// Write the result as JUnit XML
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    junit: Option<PathBuf>,
    /// Where they differ, write NAME.vcd with both sides, NAME.gtkw and NAME.sucl that open it there, and NAME.svg
    #[arg(long, value_name = "NAME", help_heading = "Output")]
    show: Option<PathBuf>,
    /// Replace a file that posicast did not write, or that was changed since; never one that this command reads
    #[arg(long, help_heading = "Output")]
    force: bool,
    /// Print one JSON document on standard output
    #[arg(long, help_heading = "Output")]
    json: bool,
}

#[derive(clap::Args)]
#[command(next_help_heading = "When to compare")]
struct When {
    /// Sample at the edges of this 1-bit signal [default: the only clock found, else every change]
    #[arg(long, value_name = "NAME")]
    clock: Option<String>,
    /// Which edge samples
    #[arg(long, value_enum, default_value_t = EdgeName::Rising)]
    edge: EdgeName,
    /// Compare from where this 1-bit signal is released on each side; `none`: from the start [default: the only reset found]
    #[arg(long, value_name = "NAME[=0|1]")]
    reset: Option<String>,
    /// Compare at every change, whether there is a clock or not
    #[arg(long, conflicts_with = "clock")]
    raw: bool,
    /// First time that is compared, such as 10us, by the first file
    #[arg(long, value_name = "TIME", value_parser = parse_time_fs)]
    start: Option<u128>,
    /// Last time that is compared
    #[arg(long, value_name = "TIME", value_parser = parse_time_fs)]
    end: Option<u128>,
    /// With --raw: ignore a difference that lasts no longer than this
    #[arg(long, value_name = "TIME", value_parser = parse_time_fs)]
    time_tolerance: Option<u128>,
    /// With --raw: ignore values that last shorter than this, in both files
    #[arg(long, value_name = "TIME", value_parser = parse_time_fs)]
    glitch: Option<u128>,
    /// The signal comes this many samples later in the second file, or with --raw this much time; negative: earlier
    /// (repeatable)
    #[arg(long, value_name = "SIGNAL=SAMPLES|TIME", allow_hyphen_values = true)]
    latency: Vec<String>,
}

#[derive(clap::Args)]
#[command(next_help_heading = "Which signals")]
struct Which {
    /// Scope or signal A of the first file is B of the second; with * in both, a pattern (repeatable)
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
    /// A signal that only one file has is a difference; without it such signals are only listed
    #[arg(long)]
    require_all: bool,
}

#[derive(clap::Args)]
#[command(next_help_heading = "How to compare")]
struct How {
    /// Largest difference that counts as equal, of one signal or of all: 2 LSB, 0.01abs in its unit, or 0.1% (repeatable)
    #[arg(long, value_name = "[SIGNAL=]AMOUNT")]
    tolerance: Vec<String>,
    /// Read the bits of a signal as a number: signed, unsigned, q15.16, uq16 (repeatable)
    #[arg(long, value_name = "SIGNAL=VIEW")]
    view: Vec<String>,
    /// What unknown bits (x, z) are equal to
    #[arg(long, value_enum, default_value_t = UnknownName::Strict)]
    unknown: UnknownName,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum EdgeName {
    Rising,
    Falling,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum UnknownName {
    /// Only themselves
    Strict,
    /// Anything
    Wildcard,
    /// The value 0
    Zero,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let options = options(args)?;
    let outputs = outputs(args)?;
    output::one_document(&outputs, args.json)?;
    let mut bar = LateBar::new();
    let comparison =
        diff::compare(&args.a, &args.b, &options, &mut |progress| bar.show(progress)).map_err(Failure::because)?;
    bar.clear();
    if let Some(path) = &args.junit {
        let name = format!("{} {}", args.a.display(), args.b.display());
        write_text(path, &diff::junit(&comparison, &name)).map_err(Failure::because)?;
    }
    if let (Some(base), DiffVerdict::Different) = (&args.show, comparison.result)
        && diff::show(&SealedFiles, base, &args.a, &args.b, &comparison).map_err(Failure::because)?
    {
        output::say(&format!(
            "shown in {}",
            base.with_extension("{vcd,gtkw,sucl,svg}").display()
        ));
    }
    if args.json {
        output::print_json(&comparison)?;
    } else {
        output::print_beside(&outputs, &(comparison.to_string() + "\n"))?;
    }
    verdict(&comparison)
}

/// The output files, each of which was asked for.
fn outputs(args: &Args) -> Result<OutputFiles, Failure> {
    let mut outputs = OutputFiles::new(args.force);
    outputs.input("the first file", &args.a);
    outputs.input("the second file", &args.b);
    if let Some(maps) = &args.which.map_file {
        outputs.input("the file of maps", maps);
    }
    let junit = args.junit.iter().map(|path| ("--junit", path.clone()));
    let shown = args.show.iter().flat_map(|base| diff::shown_files(base));
    for (option, path) in junit.chain(shown.map(|path| ("--show", path))) {
        outputs.claim(option, &path).map_err(Failure::because)?;
    }
    Ok(outputs)
}

fn options(args: &Args) -> Result<DiffOptions, Failure> {
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
        ..DiffOptions::default()
    };
    if let Some(path) = &which.map_file {
        let text = std::fs::read_to_string(path);
        let text = text.map_err(|e| Failure::from(miette::miette!("{}: cannot read: {e}", path.display())))?;
        options
            .add_map_file(&text)
            .map_err(|error| Failure::because(error).in_file(path))?;
    }
    let mut add = |texts: &[String], add: fn(&mut DiffOptions, &str) -> Result<(), WaveError>| {
        texts
            .iter()
            .try_for_each(|text| add(&mut options, text).map_err(Failure::because))
    };
    add(&which.map, DiffOptions::add_map)?;
    add(&how.tolerance, DiffOptions::add_tolerance)?;
    add(&how.view, DiffOptions::add_view)?;
    add(&when.latency, DiffOptions::add_latency)?;
    if let Some(text) = &when.reset {
        options.set_reset(text).map_err(Failure::because)?;
    }
    Ok(options)
}

/// A progress bar over the bytes of both files that appears only when the work takes long.
struct LateBar {
    start: Instant,
    bar: Option<indicatif::ProgressBar>,
}

const LATE: Duration = Duration::from_secs(2);

impl LateBar {
    fn new() -> Self {
        Self {
            start: Instant::now(),
            bar: None,
        }
    }

    fn show(&mut self, progress: Progress) {
        if self.bar.is_none() && self.start.elapsed() >= LATE {
            self.bar = Some(match progress.total_bytes {
                Some(total) => progress::bar("comparing", total),
                None => progress::spinner("comparing"),
            });
        }
        if let Some(bar) = &self.bar {
            bar.set_position(progress.bytes);
        }
    }

    fn clear(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

fn verdict(comparison: &Comparison) -> Result<(), Failure> {
    match comparison.result {
        DiffVerdict::Equal => Ok(()),
        DiffVerdict::Different => Err(Failure::Check(comparison.differing())),
        DiffVerdict::Incomparable => Err(Failure::from(miette::miette!(
            help = "name the clock with --clock, or say with --map A=B which scope or signal is which",
            "the files have nothing in common that can be compared"
        ))),
    }
}
