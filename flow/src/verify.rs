//! `posicast verify`: compares the RTL with the bit-exact model, clock by clock, block by block.

mod dependence;
mod document;
mod folder;

pub use self::document::{Document, FilesVerdict};
pub use self::folder::ComparedFolder;
use crate::Outcome;
use crate::bench::{self, Bench, Needs, Simulator};
use crate::design::DesignReport;
use crate::failure::Failure;
use crate::hardware::Built;
use crate::observer::Observer;
use crate::replay::Recording;
use crate::{blocks, command, machine, moves, replay};
use posicast_machine::spelling::choose_from;
use posicast_synth::package;
use posicast_testbench::blocks::{Block, Sources};
use posicast_testbench::linked_stage::DenseLinkBlock;
use posicast_testbench::lockstep::report::{LockstepReport, LockstepVerdict};
use posicast_testbench::stage::{ShortTicksBlock, StageBlock};
use std::path::{Path, PathBuf};

/// Options of a comparison.
#[derive(Debug, Clone)]
pub struct Options {
    /// Machine file, or a folder that [`generate`](crate::generate) or [`run`](crate::run) wrote.
    pub source: PathBuf,
    /// Simulator; `None`: Verilator, or RustHDL's, the weaker check, where Verilator is missing.
    pub simulator: Option<Simulator>,
    /// Only the blocks of these names, such as `pulse_counter`; all without any name.
    pub blocks: Vec<String>,
    /// Clocks to compare in every row, with a recording at most this many; `None`: as many as the simulator does in some seconds, and more
    /// if it takes more to exercise every tap, bank and flag.
    pub cycles: Option<u64>,
    /// Seed of the random stimuli.
    pub seed: u64,
    /// Whether both simulators judge edited Verilog of the folder; otherwise it is no match.
    pub edited: bool,
    /// Recorded stimuli.
    pub recording: Recording,
}

/// Default seed, so that every run is the same.
pub const DEFAULT_SEED: u64 = 1;

/// Compares the RTL with the bit-exact model, clock by clock, block by block.
///
/// # Errors
/// [`Failure`] for files that cannot be read or simulated, and for a missing tool. A difference is not an error but gives
/// [`Outcome::failed`].
pub fn verify(options: &Options, observer: &dyn Observer) -> Result<Outcome<Document>, Failure> {
    let mut job = Job::new(&options.source, &options.blocks, options.edited, observer)?;
    if job.folder.is_some() && options.simulator == Some(Simulator::Rusthdl) {
        return Err(Failure::input(format!(
            "`--simulator rusthdl` runs the RustHDL description: it cannot run the Verilog in `{}`",
            options.source.display()
        ))
        .with_help("use --simulator verilator or icarus, or verify the machine file"));
    }
    let simulator = if job.folder.is_some() {
        options.simulator.unwrap_or(Simulator::Verilator)
    } else {
        Simulator::choose(options.simulator, observer)?
    };
    if simulator == Simulator::Rusthdl {
        job.keep_what_is_rusthdl(observer)?;
    }
    let second = job.second(simulator, observer);
    let (mut report, replayed) = match options.recording.stimulus.as_deref() {
        Some(file) => {
            let how = (options.seed, options.cycles.unwrap_or(u64::MAX));
            let simulators: Vec<Simulator> = std::iter::once(simulator).chain(second).collect();
            let (reports, replayed) = replay::run(&job.blocks, file, &options.recording, &simulators, how, observer)?;
            let named = reports.into_iter().zip(&simulators);
            let named = named.enumerate().map(|(index, (report, simulator))| match index {
                0 => report,
                _ => in_second(report, *simulator),
            });
            (LockstepReport::joined(named.collect()), Some(replayed))
        }
        None => {
            job.require_tools(simulator, second)?;
            let report = job.lockstep(simulator, options.cycles, options.seed, observer);
            // An edited machine file may lead to ports that do not fit; the edit is then reported first.
            let mut report = report.inspect_err(|_| {
                job.folder
                    .iter()
                    .for_each(|folder| observer.say(folder.text().trim_end()))
            })?;
            if let Some(second) = second {
                let also = job.lockstep_of_edited(second, options.cycles, options.seed, observer)?;
                report = LockstepReport::joined(vec![report, in_second(also, second)]);
            }
            (report, None)
        }
    };
    if let Some(folder) = job.folder.as_ref().filter(|folder| folder.fails()) {
        report.result = match (report.result, folder.contradicts()) {
            (LockstepVerdict::Mismatch, _) | (_, true) => LockstepVerdict::Mismatch,
            _ => LockstepVerdict::NoVerdict,
        };
    }
    if report.samples == 0 && report.blocks.iter().any(|block| block.samples.is_some()) {
        observer.say("warning: no output sample was among these clocks: compare more with --cycles");
    }
    let mut not_exercised = report.not_exercised_names();
    not_exercised.extend(replayed.iter().flat_map(|replayed| &replayed.not_exercised).cloned());
    let mut document = Document {
        reason: None,
        least_clocks: job.least_clocks(),
        cycles_given: options.cycles.is_some(),
        folder: job.folder,
        not_exercised,
        simulator,
        seed: options.seed,
        replayed,
        report,
    };
    document.reason = document.failed();
    Ok(Outcome {
        failed: document.reason.clone(),
        ..Outcome::passed(document)
    })
}

/// The report of the second simulator, whose name is added to the names of the rows.
fn in_second(mut report: LockstepReport, simulator: Simulator) -> LockstepReport {
    for row in &mut report.blocks {
        row.instance += &format!(", in {simulator}");
    }
    report
}

/// The blocks to compare with their models.
pub(crate) struct Job {
    /// Name of the machine.
    pub(crate) machine: String,
    pub(crate) blocks: Vec<(Box<dyn Block>, Sources)>,
    /// The differences between the files of the folder and those that posicast generates, if the source is a folder.
    folder: Option<ComparedFolder>,
}

impl Job {
    /// Returns the blocks of a machine file or of a folder; only those in `names`, if there are any. `edits_accepted` is that of
    /// [`ComparedFolder`].
    pub(crate) fn new(
        source: &Path,
        names: &[String],
        edits_accepted: bool,
        observer: &dyn Observer,
    ) -> Result<Self, Failure> {
        let (machine, path, folder) = if source.is_dir() {
            let contents = package::read(source).map_err(Failure::because)?;
            let machine = machine::parse(&contents.machine_path, &contents.machine_toml)?;
            (machine, contents.machine_path.clone(), Some(contents))
        } else {
            (machine::read(source)?.machine, source.to_owned(), None)
        };
        let report = DesignReport::new(&machine, source)?;
        // A move that does not fit the words is an error of `run`, but a lock step does not need it.
        let words =
            command::words(&machine, &report.design, None, &moves::by_default(&machine), observer).unwrap_or_default();
        let built = Built::new(&report, source, observer)?;
        let compared = match &folder {
            Some(contents) => {
                let modules = built.modules(&path)?;
                Some(ComparedFolder::compare(source, contents, &modules, edits_accepted)?)
            }
            None => None,
        };
        let mut others = match &folder {
            Some(_) => blocks::of_components(built.components)?,
            None => blocks::others(&report, &built.shapers, built.components, &path)?,
        };
        let (of_stage, of_inline) = if built.stage.is_some() {
            (built.link, None)
        } else {
            (None, built.link)
        };
        if let Some(stage) = built.stage {
            let block = StageBlock::new(&stage.of_machine.config, &stage.block.top())
                .map_err(Failure::because)?
                .with_prefix(&machine.name);
            if folder.is_some() {
                others.extend(block.inner().map_err(bench::failure)?);
            }
            let short = ShortTicksBlock::new(&stage.of_machine.config, &block.top()).map_err(Failure::because)?;
            let short = short.map(|short| short.with_prefix(&machine.name));
            others.push(Box::new(block));
            others.extend(short.map(|block| Box::new(block) as Box<dyn Block>));
            if let Some(link) = of_stage {
                if folder.is_some() {
                    others.push(link.bridge());
                }
                let dense = DenseLinkBlock::new(&stage.of_machine.config, &link).map_err(Failure::because)?;
                others.push(Box::new(link));
                others.extend(dense.map(|block| Box::new(block) as Box<dyn Block>));
            }
        }
        if let Some(inline) = built.inline {
            others.extend(inline.inner().map_err(bench::failure)?);
            others.push(Box::new(inline));
        } else if let Some(link) = of_inline {
            others.extend(link.inner().map_err(bench::failure)?);
            if folder.is_some() {
                others.push(link.bridge());
            }
            others.push(Box::new(link));
        }
        if let Some(bus) = built.buses.first().filter(|_| folder.is_some()) {
            others.push(bus.bridge());
        }
        others.extend(built.buses.into_iter().map(|bus| Box::new(bus) as Box<dyn Block>));
        let folder = folder.map(|contents| contents.rtl);
        if let Some(files) = &folder {
            let there = Sources::found(files.clone());
            others.retain(|block| there.hold(block.as_ref()));
        }
        let mut list: Vec<Box<dyn Block>> = vec![Box::new(blocks::shapers(&machine, built.shapers, &words)?)];
        list.extend(others);
        let sources = |block: &dyn Block| match &folder {
            Some(files) => {
                let reached = Sources::found(files.clone()).reached_by(block);
                reached.and_then(|files| block.adapted(files)).map_err(bench::failure)
            }
            None => Sources::write(block).map_err(bench::failure),
        };
        let chosen = choose(list, names, source)?.into_iter();
        let blocks = chosen.map(|block| sources(block.as_ref()).map(|sources| (block, sources)));
        Ok(Self {
            machine: machine.name.clone(),
            blocks: blocks.collect::<Result<_, _>>()?,
            folder: compared,
        })
    }

    /// Why the folder's files are no match whatever a simulation shows; `None` if they may be one.
    pub(crate) fn folder_fails(&self) -> Option<String> {
        let folder = self.folder.as_ref().filter(|folder| folder.fails());
        folder.map(ComparedFolder::text)
    }

    /// Removes blocks that RustHDL's simulator cannot run, with a note; returns an error if nothing is left.
    fn keep_what_is_rusthdl(&mut self, observer: &dyn Observer) -> Result<(), Failure> {
        let all = std::mem::take(&mut self.blocks);
        let (kept, left_out): (Vec<_>, Vec<_>) = all.into_iter().partition(|(block, _)| block.in_rusthdl());
        let names = left_out
            .iter()
            .map(|(block, _)| format!("{} {}", block.name(), block.instance()));
        let names = names.collect::<Vec<_>>().join("; ");
        if kept.is_empty() {
            return Err(Failure::input(format!(
                "`--simulator rusthdl` runs RustHDL descriptions, and these are written from register maps: {names}"
            ))
            .with_help("use --simulator verilator or icarus"));
        }
        if !left_out.is_empty() {
            observer.say(&format!(
                "note: left out, because RustHDL's simulator cannot run blocks that are generated from register maps: {names}"
            ));
        }
        self.blocks = kept;
        Ok(())
    }

    /// Number of clocks that exercise everything that a verdict on any of the rows covers.
    fn least_clocks(&self) -> u64 {
        self.blocks
            .iter()
            .map(|(block, _)| block.least_clocks())
            .max()
            .unwrap_or(0)
    }

    fn lockstep(
        &self,
        simulator: Simulator,
        cycles: Option<u64>,
        seed: u64,
        observer: &dyn Observer,
    ) -> Result<LockstepReport, Failure> {
        compare(self.blocks.iter(), simulator, (cycles, seed), observer)
    }

    /// Returns the simulator that must also agree if Verilog was edited and the simulation decides, because an edit may mean different
    /// things to each simulator.
    fn second(&self, simulator: Simulator, observer: &dyn Observer) -> Option<Simulator> {
        self.edited_blocks().next()?;
        match simulator {
            Simulator::Icarus if bench::IS_STATIC => {
                observer.say(
                    "note: this posicast cannot load what Verilator builds: Icarus alone judges the edited Verilog",
                );
                None
            }
            Simulator::Icarus => Some(Simulator::Verilator),
            Simulator::Verilator | Simulator::Rusthdl => Some(Simulator::Icarus),
        }
    }

    /// The blocks whose Verilog has a file that was edited.
    fn edited_blocks(&self) -> impl Iterator<Item = &(Box<dyn Block>, Sources)> {
        let edited = self.folder.as_ref().map_or_else(Vec::new, ComparedFolder::accepted);
        self.blocks.iter().filter(move |(_, sources)| {
            let names = sources.files().iter().filter_map(|file| file.file_name()?.to_str());
            names.into_iter().any(|name| edited.contains(&name))
        })
    }

    /// Like [`Self::lockstep`], for the blocks with edited Verilog. The second simulator may be slow, so it compares no more clocks than by
    /// default.
    fn lockstep_of_edited(
        &self,
        simulator: Simulator,
        cycles: Option<u64>,
        seed: u64,
        observer: &dyn Observer,
    ) -> Result<LockstepReport, Failure> {
        let most = simulator.usual_cycles().max(self.least_clocks());
        let cycles = cycles.map(|cycles| cycles.min(most));
        compare(self.edited_blocks(), simulator, (cycles, seed), observer)
    }

    /// Returns an error if a tool is missing.
    fn require_tools(&self, simulator: Simulator, second: Option<Simulator>) -> Result<(), Failure> {
        let all = self.blocks.iter().map(|(block, sources)| (block.as_ref(), sources));
        let edited = self.edited_blocks().map(|(block, sources)| (block.as_ref(), sources));
        let mut needs: Vec<Needs<'_>> = vec![(simulator, all.collect())];
        needs.extend(second.map(|second| (second, edited.collect())));
        bench::require_tools(&needs, true)
    }
}

fn compare<'a>(
    blocks: impl Iterator<Item = &'a (Box<dyn Block>, Sources)>,
    simulator: Simulator,
    (cycles, seed): (Option<u64>, u64),
    observer: &dyn Observer,
) -> Result<LockstepReport, Failure> {
    let benches = blocks.map(|(block, sources)| Bench {
        block: block.as_ref(),
        sources,
        cycles,
    });
    bench::compare_all(&benches.collect::<Vec<_>>(), simulator, seed, observer)
}

/// The blocks with these names; all of them without names.
fn choose(blocks: Vec<Box<dyn Block>>, names: &[String], source: &Path) -> Result<Vec<Box<dyn Block>>, Failure> {
    let mut known: Vec<String> = blocks.iter().map(|block| block.name().to_owned()).collect();
    known.sort_unstable();
    known.dedup();
    if let Some(unknown) = names.iter().find(|name| !known.contains(name)) {
        let names: Vec<&str> = known.iter().map(String::as_str).collect();
        return Err(Failure::input(format!(
            "--block {unknown}: `{}` has no block of this name",
            source.display()
        ))
        .with_help(choose_from(unknown, &names)));
    }
    let wanted = |name: &str| names.is_empty() || names.iter().any(|chosen| chosen == name);
    Ok(blocks.into_iter().filter(|block| wanted(block.name())).collect())
}
