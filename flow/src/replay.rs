//! `posicast verify --stimulus FILE`: replays a recording into the RTL and the model.

use crate::bench::{self, Needs, Simulator};
use crate::failure::Failure;
use crate::observer::Observer;
use posicast_blocks::{Direction, Port};
use posicast_testbench::Error;
use posicast_testbench::blocks::{Block, Sources};
use posicast_testbench::lockstep::report::LockstepReport;
use posicast_testbench::replay::{Exercised, Extent, Replay, is_timing};
use posicast_testbench::wording::counted;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::{Path, PathBuf};
use wavecmp::WaveError;
use wavecmp::diff::{DiffOptions, Reset};

/// The recording of stimuli, and how its names are read.
#[derive(Debug, Clone, Default)]
pub struct Recording {
    /// A VCD or FST whose inputs drive RTL and model, and whose outputs are compared; `None`: no recording.
    pub stimulus: Option<PathBuf>,
    /// `A=B`: scope or signal A of the recording is B of the block, whose scope is its top module; with * in both, a pattern.
    pub map: Vec<String>,
    /// The scope of the recording that contains the names.
    pub root: Option<String>,
    /// The recorded clock; `None`: the only `clk` or `clock`.
    pub clock: Option<String>,
    /// `NAME[=0|1]`: recorded outputs are compared after the release of this signal; `none`: from the first edge on; `None`: the only reset
    /// found.
    pub reset: Option<String>,
}

impl Recording {
    fn options(&self) -> Result<DiffOptions, Error> {
        let mut options = DiffOptions {
            clock: self.clock.clone(),
            roots: [self.root.clone(), None],
            reset: Reset::Found,
            ..DiffOptions::default()
        };
        self.map.iter().try_for_each(|text| options.add_map(text))?;
        if let Some(text) = &self.reset {
            options.set_reset(text)?;
        }
        Ok(options)
    }
}

/// Result of a replay, beside the rows of the report.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Replayed {
    /// The recording.
    pub file: PathBuf,
    /// Number of clocks that were replayed.
    pub clocks: u64,
    /// Number of clocks in which recorded outputs were compared.
    pub compared: u64,
    /// Inputs that are not in the file and were held at 0.
    pub missing_inputs: Vec<String>,
    /// Outputs that are not in the file, which were compared between RTL and model only.
    pub missing_outputs: Vec<String>,
    /// Number of outputs of the block.
    #[serde(skip)]
    pub outputs: usize,
    /// Inputs in the file that never changed in the clocks that were compared.
    pub unchanged_inputs: Vec<String>,
    /// Outputs of the model that never changed in the clocks that were compared.
    pub unchanged_outputs: Vec<String>,
    /// Other things that a verdict on the block covers and that the recording does not exercise.
    pub not_exercised: Vec<String>,
    /// Number of clocks in which recorded bits of inputs were `x` or `z`, and were taken as 0.
    pub unknown_input_clocks: u64,
    /// Number of clocks in which recorded bits of outputs were `x` or `z`, and were not compared.
    pub unknown_output_clocks: u64,
    /// Number of signals of the file that are not ports.
    pub other_signals: usize,
    /// How clock and reset were found.
    pub notes: Vec<String>,
}

/// Replays the recording, for at most `most_clocks` clocks, into the block that has most ports in it, in each of these simulators, and
/// returns a report for each.
pub(crate) fn run(
    blocks: &[(Box<dyn Block>, Sources)],
    file: &Path,
    args: &Recording,
    simulators: &[Simulator],
    (seed, most_clocks): (u64, u64),
    observer: &dyn Observer,
) -> Result<(Vec<LockstepReport>, Replayed), Failure> {
    let options = args.options().map_err(bench::failure)?;
    let (block, sources, replay) = choose(blocks, file, &options)?;
    has_content(block, &replay, file)?;
    let extent = replay.extent(most_clocks).map_err(bench::failure)?;
    let Extent { clocks, compared, .. } = extent;
    if compared == 0 {
        return Err(Failure::input(format!(
            "`{}` has {}, but no edge after the release of its reset: there is nothing to compare ({})",
            file.display(),
            counted(clocks, "clock edge"),
            replay.notes().join(", ")
        ))
        .with_help("--clock NAME names another clock, --reset none compares from the first edge"));
    }
    let needs: Vec<Needs<'_>> = simulators
        .iter()
        .map(|simulator| (*simulator, vec![(block, sources)]))
        .collect();
    bench::require_tools(&needs, false)?;
    let mut reports = Vec::new();
    let mut exercised = Exercised::default();
    for simulator in simulators {
        simulator.say_sizes(std::iter::once(block), observer);
        let mut device = simulator.device(block, sources, seed).map_err(bench::failure)?;
        let report = replay
            .run(block, device.as_mut(), &extent, seed)
            .map_err(bench::failure)?;
        reports.push(report.0);
        // The model determines this, so it is the same for each simulator.
        exercised = report.1;
    }
    let replayed = Replayed {
        file: file.to_owned(),
        clocks,
        compared,
        missing_inputs: replay.missing_inputs(),
        missing_outputs: replay.missing_outputs(),
        outputs: replay.outputs(),
        unchanged_inputs: exercised.unchanged_inputs,
        unchanged_outputs: exercised.unchanged_outputs,
        not_exercised: exercised.missing,
        unknown_input_clocks: extent.unknown_inputs,
        unknown_output_clocks: extent.unknown_outputs,
        other_signals: replay.strangers(),
        notes: replay.notes().to_vec(),
    };
    if !replayed.missing_inputs.is_empty() {
        observer.say(&format!(
            "warning: not in the recording, and so held at 0: {}",
            replayed.missing_inputs.join(", ")
        ));
    }
    Ok((reports, replayed))
}

/// Refuses a recording without a data input or without an output, because nothing would be compared.
fn has_content(block: &dyn Block, replay: &Replay, file: &Path) -> Result<(), Failure> {
    let ports = block.model(0).ports().to_vec();
    let lacks_all = |direction: Direction, missing: &[String]| {
        let of = |port: &&Port| port.direction == direction && !is_timing(port);
        let mut of = ports.iter().filter(of).peekable();
        of.peek().is_some() && of.all(|port| missing.contains(&port.name))
    };
    let what = match (
        lacks_all(Direction::Input, &replay.missing_inputs()),
        lacks_all(Direction::Output, &replay.missing_outputs()),
    ) {
        (false, false) => return Ok(()),
        (true, true) => "none of the data inputs and none of the outputs",
        (true, false) => "none of the data inputs",
        (false, true) => "none of the outputs",
    };
    let inputs = replay.missing_inputs().into_iter().chain(replay.missing_outputs());
    let some = inputs.take(6).collect::<Vec<_>>().join(", ");
    let lacking = format!(
        "`{}` has {what} of {} {}: its replay would compare nothing. Not found: {some}, …",
        file.display(),
        block.name(),
        block.instance()
    );
    Err(Failure::input(lacking).with_help(format!(
        "match the signals of the file with those of the block, by --map SCOPE=TOP or --map SIGNAL=TOP.PORT, or choose \
         another block with --block; its top is `{}`",
        block.top()
    )))
}

type Chosen<'a> = (&'a dyn Block, &'a Sources, Replay);

/// The block with the most ports in the file.
fn choose<'a>(
    blocks: &'a [(Box<dyn Block>, Sources)],
    file: &Path,
    options: &DiffOptions,
) -> Result<Chosen<'a>, Failure> {
    let mut best: Vec<Chosen<'a>> = Vec::new();
    let mut refused = None;
    for (block, sources) in blocks {
        let block = block.as_ref();
        match Replay::new(block, file, options) {
            Ok(None) => {}
            Ok(Some(replay)) => {
                let most = best.first().map_or(0, |(_, _, best)| best.found());
                if replay.found() > most {
                    best.clear();
                }
                if replay.found() >= most {
                    best.push((block, sources, replay));
                }
            }
            // Another block may have the port of a map that this one lacks.
            Err(error @ Error::Wave(WaveError::Option(_))) => refused = refused.or(Some(error)),
            Err(error) => return Err(bench::failure(error)),
        }
    }
    if best.len() > 1 {
        let names = best
            .iter()
            .map(|(block, ..)| format!("{} {} (top {})", block.name(), block.instance(), block.top()));
        return Err(Failure::input(format!(
            "`{}` fits several blocks equally well: {}",
            file.display(),
            names.collect::<Vec<_>>().join("; ")
        ))
        .with_help("choose with --block NAME, or map the recorded scope to a top: --map SCOPE=TOP"));
    }
    match (best.pop(), refused) {
        (Some(chosen), _) => Ok(chosen),
        (None, Some(error)) => Err(bench::failure(error)),
        (None, None) => {
            let strange = format!(
                "`{}` has no signal in common with the ports of any block",
                file.display()
            );
            Err(Failure::input(strange).with_help(
                "match a scope or signal A of the file with B of the block by --map A=B, or choose the block with --block",
            ))
        }
    }
}
