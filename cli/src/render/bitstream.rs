//! A bitstream and the checks of its bits.

use super::files::entries;
use crate::style;
use crate::table::Table;
use posicast_flow::bitstream::Document;
use posicast_testbench::wording::counted;
use std::path::Path;

/// The board, the checks with what each covers, what none of them covers, and the verdict.
pub(crate) fn bitstream(document: &Document) -> String {
    let mhz = f64::from(document.oscillator_hz) / 1e6;
    let mut text = format!(
        "{} on {} ({}, {}): {mhz} MHz oscillator, {} Hz samples\n{}\n",
        document.name,
        document.title,
        document.device,
        document.package,
        document.sample_hz,
        document.tools.join(", ")
    );
    let mut table = Table::new(&["check", "", "what it covers"]);
    for check in &document.checks {
        let verdict = if check.ok {
            style::good("ok")
        } else {
            style::bad("FAILED")
        };
        table.row([check.name.to_owned(), verdict, check.what.clone()]);
    }
    text += &table.text("  ");
    text += "not covered by these checks:\n";
    for what in &document.not_covered {
        text += &format!("  {what}\n");
    }
    let holds = document.checks.iter().all(|check| check.ok);
    let verdict = match (holds, document.checked_only) {
        (true, _) => format!(
            "PASS: the bits of {} compute the model. Nobody has run it on hardware yet.",
            document.bitstream
        ),
        (false, true) => format!("FAIL: the bits of {} are not those of this design", document.bitstream),
        (false, false) => "FAIL: no bitstream was written".to_owned(),
    };
    if let Some(folder) = &document.folder {
        text += &format!(
            "{} in {folder}: {}\n",
            counted(document.files.len() as u64, "file"),
            entries(document.files.iter().map(Path::new)).join(", ")
        );
    }
    text + &style::message(&verdict) + "\n"
}
