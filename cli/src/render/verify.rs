//! The rows of `verify`, the findings, and a last line about what was compared and how much.

use crate::style;
use crate::table::Table;
use posicast_flow::replay::Replayed;
use posicast_flow::text::few;
use posicast_flow::verify::{ComparedFolder, Document, FilesVerdict};
use posicast_testbench::lockstep::report::LockstepVerdict;
use posicast_testbench::wording::counted;

/// The rows, the findings and the verdict.
pub(crate) fn verify(document: &Document) -> String {
    let blocks = &document.report.blocks;
    let mut table = Table::new(&["block", "instance", ">clocks", ">mismatches"]);
    for block in blocks {
        let counts = [block.cycles.to_string(), block.mismatches.to_string()];
        table.row([block.name.clone(), block.instance.clone()].into_iter().chain(counts));
    }
    let mut text = table.text("");
    for block in blocks {
        let row = format!("{} {}", block.name, block.instance);
        if let Some(first) = &block.first {
            text += &format!("\n{row}: {first}\n");
        }
        for finding in &block.findings {
            text += &format!("{row}: {finding}\n");
        }
        if !block.not_exercised.is_empty() {
            text += &format!("{row}: not exercised: {}\n", few(&block.not_exercised));
        }
    }
    text += &document.folder.as_ref().map_or_else(String::new, ComparedFolder::text);
    text += &document.replayed.as_ref().map_or_else(String::new, replayed);
    text + &style::message(&verdict(document)) + "\n"
}

/// The same below a table of what the clocks of each row reached: a row per count, with the number that a verdict
/// requires; `–` if there is none.
pub(crate) fn verify_with_reached(document: &Document) -> String {
    let mut table = Table::new(&["block", "instance", "reached", ">count", ">least"]);
    for block in &document.report.blocks {
        for reached in &block.reached {
            let least = match reached.least {
                0 => "–".to_owned(),
                least => least.to_string(),
            };
            let count = reached.count.to_string();
            table.row([
                block.name.clone(),
                block.instance.clone(),
                reached.what.clone(),
                count,
                least,
            ]);
        }
    }
    format!("{}\n{}", table.text(""), verify(document))
}

/// The last line.
fn verdict(document: &Document) -> String {
    let report = &document.report;
    let verdict = match (report.result, report.mismatches(), document.files()) {
        (LockstepVerdict::Match, ..) => "match: every output of every clock is equal to the model's".to_owned(),
        (_, 1.., _) => "MISMATCH".to_owned(),
        (_, 0, FilesVerdict::Contradict) => {
            "MISMATCH: the files are not those of the machine file, although the simulation is equal".to_owned()
        }
        (_, 0, FilesVerdict::Edited) => {
            "NO VERDICT: the simulation is equal, but Verilog was edited, and no simulation \
                                         sees every fault"
                .to_owned()
        }
        (_, 0, FilesVerdict::DependOnTool) => {
            "NO VERDICT: the simulation is equal, but edited Verilog depends on the tool that \
             reads it, and no simulation sees what the other tools read"
                .to_owned()
        }
        (_, 0, FilesVerdict::Agree) if document.replayed.is_some() => {
            "NO VERDICT: nothing differs, but the recording has no data".to_owned()
        }
        (_, 0, FilesVerdict::Agree) => format!(
            "NO VERDICT: the comparison is equal, but {} things were not exercised; {}",
            document.not_exercised.len(),
            document.remedy()
        ),
    };
    let rows = match report.blocks.len() {
        1 => "1 row".to_owned(),
        rows => format!("{rows} rows"),
    };
    let mut compared = vec![
        rows,
        format!("{} clocks", report.cycles),
        format!("{} samples", report.samples),
    ];
    let mut blocks = report.blocks.iter();
    let shapers = blocks.any(|block| block.name == "shaper" && block.samples.is_some());
    if report.result == LockstepVerdict::Match && document.replayed.is_none() {
        compared.push(if shapers {
            "every tap and bank of the shapers and every flag of all rows exercised".to_owned()
        } else {
            "every flag of all rows exercised".to_owned()
        });
    }
    compared.extend(document.replayed.as_ref().map(changed));
    compared.extend(document.folder.as_ref().map(edited));
    let missing = document.replayed.as_ref().map(|replayed| &replayed.missing_inputs);
    if let Some(missing) = missing.filter(|missing| !missing.is_empty()) {
        compared.push(format!(
            "{} inputs that are not in the recording held at 0 ({})",
            missing.len(),
            few(missing)
        ));
    }
    format!(
        "{verdict}; {}, simulator {}, seed {}",
        compared.join(", "),
        document.simulator,
        document.seed
    )
}

/// Summary of the folder's comparison.
fn edited(folder: &ComparedFolder) -> String {
    let same = format!("{} files are what posicast generates", folder.identical);
    match folder.edited() {
        0 => same,
        edited => format!("{same}, {edited} edited (see above)"),
    }
}

/// How many of the block's outputs the recording changes.
fn changed(replayed: &Replayed) -> String {
    let changed = replayed.outputs - replayed.unchanged_outputs.len();
    let mut text = format!(
        "{changed} of {} change in the recording",
        counted(replayed.outputs as u64, "output")
    );
    if !replayed.not_exercised.is_empty() {
        text += &format!(
            ", {} not exercised by it (see above)",
            counted(replayed.not_exercised.len() as u64, "thing")
        );
    }
    text
}

/// What was replayed, and what the recording lacks, in lines.
fn replayed(replayed: &Replayed) -> String {
    let mut text = format!(
        "replayed {}: {}, recorded outputs compared in {} of them\n",
        replayed.file.display(),
        counted(replayed.clocks, "clock"),
        replayed.compared
    );
    let mut line = |names: &[String], what: &str| {
        if !names.is_empty() {
            text += &format!("  {what}: {}\n", few(names));
        }
    };
    line(&replayed.notes, "time");
    line(&replayed.missing_inputs, "inputs not in the file, held at 0");
    line(
        &replayed.missing_outputs,
        "outputs not in the file, compared between RTL and model only",
    );
    line(&replayed.unchanged_inputs, "inputs that never change");
    line(&replayed.unchanged_outputs, "outputs that never change");
    line(&replayed.not_exercised, "not exercised");
    for (clocks, what) in [
        (replayed.unknown_input_clocks, "with x or z in inputs, taken as 0"),
        (
            replayed.unknown_output_clocks,
            "with x or z in outputs, whose bits were not compared",
        ),
    ] {
        if clocks > 0 {
            text += &format!("  clocks {what}: {clocks}\n");
        }
    }
    if replayed.other_signals > 0 {
        text += &format!("  signals of the file that are not ports: {}\n", replayed.other_signals);
    }
    text
}
