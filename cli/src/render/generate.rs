//! What `generate` wrote, and what to do next.

use super::files::entries;
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
    let folder = Path::new(&document.folder);
    let files = document.files.iter();
    files.map(|file| format!("{}\n", folder.join(file).display())).collect()
}
