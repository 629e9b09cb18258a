//! What `generate` wrote, and what to do next.

use super::files::entries;
use posicast_flow::block_kit::BlockDocument;
use posicast_flow::generate::Document;
use posicast_flow::text::shell_word;
use posicast_testbench::wording::counted;
use std::path::Path;

/// Number of files by folder, the top modules, and the next step.
pub(crate) fn generate(document: &Document) -> String {
    let folder = Path::new(&document.folder);
    let top = match (document.top.as_slice(), document.line) {
        ([shapers, inline], _) if document.has_inline => {
            format!("top modules: {inline} (the inline shaper), {shapers} (the shapers alone)")
        }
        ([shapers, link, inline], Some(line)) if document.has_inline => format!(
            "top modules: {inline} (the inline shaper), {link} (the inline shaper with its {line}), {shapers} (the shapers alone)"
        ),
        ([shapers, stage], _) => format!("top modules: {shapers} (the shapers), {stage} (the whole stage)"),
        ([shapers, stage, link], Some(line)) => {
            format!(
                "top modules: {shapers} (the shapers), {stage} (the whole stage), {link} (the stage with its {line})"
            )
        }
        _ => format!("top module: {} (the shapers)", document.top.join(", ")),
    };
    let on_bus = match document.bus {
        Some(bus) => format!("\non {bus}: {}", document.on_bus.join(", ")),
        None => String::new(),
    };
    format!(
        "{} in {}: {}\n{top}{on_bus}\nnext: read {}; `posicast verify {}` compares this Verilog with its model\n",
        counted(document.files.len() as u64, "file"),
        folder.display(),
        entries(document.files.iter().map(Path::new)).join(", "),
        folder.join("README.md").display(),
        shell_word(folder),
    )
}

/// Every file, one a line.
pub(crate) fn list(document: &Document) -> String {
    listed(&document.folder, &document.files)
}

/// Number of files of a block's kit by folder, its top modules, and the next step.
pub(crate) fn block(document: &BlockDocument) -> String {
    let folder = Path::new(&document.folder);
    let on_bus = match document.on_bus.as_slice() {
        [] => String::new(),
        tops => format!("\nbehind registers: {}", tops.join(", ")),
    };
    let proofs = match document.proofs {
        0 => String::new(),
        proofs => format!(", `make prove` {}", counted(proofs as u64, "proof")),
    };
    format!(
        "{} in {}: {}\ntop module: {} ({}, {}){on_bus}\nnext: read {}; in the folder, `make bench` compares {} with the model{proofs}\n",
        counted(document.files.len() as u64, "file"),
        folder.display(),
        entries(document.files.iter().map(Path::new)).join(", "),
        document.top,
        document.block,
        document.instance,
        folder.join("README.md").display(),
        counted(document.bench_clocks, "clock"),
    )
}

/// Every file of a block's kit, one a line.
pub(crate) fn list_block(document: &BlockDocument) -> String {
    listed(&document.folder, &document.files)
}

fn listed(folder: &str, files: &[String]) -> String {
    let folder = Path::new(folder);
    files
        .iter()
        .map(|file| format!("{}\n", folder.join(file).display()))
        .collect()
}
