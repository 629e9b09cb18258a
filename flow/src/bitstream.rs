//! `posicast bitstream`: builds a bitstream of a machine for a board by open tools, reads it back from its bits, and compares what they are
//! with the router's result and with the bit-exact model.

mod bare;
mod checks;
mod document;
mod durations;
mod evidence;
mod machine;
mod subject;
mod too_large;

use self::bare::Bare;
pub use self::bare::{BareMove, BareReport};
use self::document::Evidence;
pub use self::document::{CheckDocument, Document, LockStepDocument};
use self::subject::Subject;
use crate::Outcome;
use crate::design::DesignReport;
use crate::failure::Failure;
use crate::generate::{self, open, tell};
use crate::hardware::Built;
use crate::kit;
use crate::observer::Observer;
use crate::sopc;
use crate::text::json_text;
use crate::verilog;
use posicast_bitstream::BitstreamError;
use posicast_bitstream::boards;
pub use posicast_bitstream::boards::names as board_names;
use posicast_bitstream::toolchain;
use posicast_bitstream::top::TopFiles;
use posicast_synth::package::Package;
use std::path::PathBuf;

/// Folder of the files of a board, in the output folder.
const FOLDER: &str = "bitstream";

/// Options of a bitstream.
#[derive(Debug, Clone)]
pub struct Options {
    /// Machine file.
    pub machine: PathBuf,
    /// Name of the board.
    pub board: String,
    /// Whether the board has no wires: stand-ins take the place of the machine, and no pin but the line's is used.
    pub bare: bool,
    /// A packed file that `posicast bitstream` wrote earlier: it is checked, and nothing is written.
    pub packed: Option<PathBuf>,
    /// Output folder: new, empty, or written by posicast before; `None`: the machine's name.
    pub output: Option<PathBuf>,
    /// Clocks of the lock step; `None`: as many as exercise what the verdict covers, at least two million for shapers and one million for
    /// a stage.
    pub clocks: Option<u64>,
    /// Seed of the random stimuli.
    pub seed: u64,
}

/// Builds a bitstream, reads it back, and compares it; or compares one that was built earlier. The files are written only if every check
/// holds.
///
/// # Errors
/// [`Failure`] for a machine, a board or a folder that cannot be used, and for a missing tool. A check that fails is not an error but
/// gives [`Outcome::failed`].
pub fn bitstream(options: &Options, observer: &dyn Observer) -> Result<Outcome<Document>, Failure> {
    let path = options.machine.as_path();
    let board = boards::board(&options.board).map_err(failure)?;
    let file = self::machine::on_board(path, &board)?;
    let report = DesignReport::new(&file.machine, path)?;
    report.warn(observer);
    let built = Built::new(&report, path, observer)?;
    let bare = if options.bare {
        let stand_ins = self::bare::stand_ins(&file.machine, path, &board)?;
        let stage = report.hardware.stage().ok().flatten();
        stage.map(|stage| Bare {
            machine: &file.machine,
            stage,
            stand_ins,
        })
    } else {
        None
    };
    let subject = Subject::new(&file.machine, &board, &built, bare).map_err(|error| failure(error).in_file(path))?;
    let files = subject.files().map_err(|error| match error {
        BitstreamError::TooManyPins { needed, .. } => failure(error)
            .in_file(path)
            .or_help(&too_large::remedy_for_pins(needed)),
        _ => failure(error).in_file(path),
    })?;
    let tools = toolchain::installed(&board, &files.pins).map_err(failure)?;
    let quartus = sopc::board(&file.machine, path)?;
    let package = match options.packed {
        Some(_) => None,
        None => Some(open(options.output.as_deref(), &file)?),
    };
    let modules = built.modules(path)?;
    let (mut sources, scratch) = verilog::write_scratch(&modules)?;
    let of_kit = kit::files(&file.machine, &modules, &built);
    let needed = ["strobe", "example"].map(|part| format!("kit/{}_{part}.v", file.machine.name));
    let joined = of_kit
        .into_iter()
        .filter(|(name, _)| needed.contains(name))
        .map(|(_, text)| text);
    for (index, text) in joined.chain([files.verilog.clone()]).enumerate() {
        let path = scratch.path().join(format!("top_{index}.v"));
        std::fs::write(&path, text).map_err(Failure::of_file(&path, "write it"))?;
        sources.push(path);
    }
    let run = evidence::Run {
        subject: &subject,
        files: &files,
        tools: tools.as_ref(),
        folder: scratch.path(),
        given: options.packed.as_deref(),
        machine: &file.machine.name,
        axes: file.machine.axes.len(),
        clocks: options.clocks,
        seed: options.seed,
        observer,
    };
    let evidence = run.evidence(&sources).map_err(|error| match &error {
        BitstreamError::TooLarge { .. } => {
            let remedy = too_large::remedy(&sources, &subject.logic(), &board, observer);
            failure(error).in_file(path).or_help(&remedy)
        }
        BitstreamError::ToolFailed { .. } | BitstreamError::Unreadable { .. } | BitstreamError::UnknownCell(_) => {
            let found = tools.versions(scratch.path()).unwrap_or_default();
            match other_versions(&found, tools.tested_versions()) {
                Some(help) => failure(error).or_help(&help),
                None => failure(error),
            }
        }
        _ => failure(error),
    })?;
    let mut document = Document::new(&files, &file.machine, &evidence);
    if let Some(packed) = &options.packed {
        document.checked(packed);
    }
    let failed = document.failed();
    if let (None, Some(mut package)) = (&failed, package) {
        generate::add(&mut package, (&file, path), &built, quartus, observer)?;
        add(&mut package, &files, &evidence, &document)?;
        let root = package.root().to_owned();
        let committed = package.commit().map_err(Failure::because)?;
        tell(&committed, observer);
        document.written(&root, FOLDER, &committed.files);
    }
    Ok(Outcome {
        failed,
        ..Outcome::passed(document)
    })
}

/// That the versions of the programs are not those of the tests; `None` if they are.
fn other_versions(found: &[String; 2], tested: [&str; 2]) -> Option<String> {
    let is_tested = found
        .iter()
        .zip(tested)
        .all(|(found, tested)| found.starts_with(tested));
    (!is_tested).then(|| {
        format!(
            "the programs are {}; posicast is tested with {}",
            found.join(" and "),
            tested.join(" and ")
        )
    })
}

/// Adds the board's files to the folder.
fn add(package: &mut Package, top: &TopFiles, evidence: &Evidence, document: &Document) -> Result<(), Failure> {
    let module = &top.module;
    let family = top.board.device.family();
    let mut texts = vec![
        (format!("{module}.v"), top.verilog.clone()),
        (format!("{module}.{}", family.constraints_ending()), top.constraints()),
        (format!("{module}.json"), json_text(document)?),
        ("Makefile".to_owned(), top.makefile()),
    ];
    texts.extend(evidence.verilog.iter().cloned());
    for (name, text) in texts {
        package
            .add(&format!("{FOLDER}/{name}"), text.as_bytes())
            .map_err(Failure::because)?;
    }
    package
        .add(&format!("{FOLDER}/{}", top.bitstream()), &evidence.packed)
        .map_err(Failure::because)
}

fn failure(error: BitstreamError) -> Failure {
    match error {
        BitstreamError::Missing(_) => Failure::missing_tool(error),
        other => Failure::because(other),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_that_are_not_those_of_the_tests_are_named() {
        let tested = ["Yosys 0.23", "nextpnr-ice40 0.4"];
        let found = |yosys: &str| [yosys.to_owned(), "nextpnr-ice40 0.4-1+b1".to_owned()];
        assert_eq!(other_versions(&found("Yosys 0.23"), tested), None);
        let help = other_versions(&found("Yosys 0.9"), tested).unwrap();
        assert!(
            help.starts_with(
                "the programs are Yosys 0.9 and nextpnr-ice40 0.4-1+b1; posicast is tested with Yosys 0.23 and"
            ),
            "{help}"
        );
    }
}
