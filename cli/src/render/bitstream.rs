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
    let Some(folder) = &document.folder else {
        return text + &style::message("FAIL: no bitstream was written") + "\n";
    };
    text += &format!(
        "{} in {folder}: {}\n",
        counted(document.files.len() as u64, "file"),
        entries(document.files.iter().map(Path::new)).join(", ")
    );
    let verdict = format!(
        "PASS: the bits of {} compute the model. Nobody has run it on hardware yet.",
        document.bitstream
    );
    text + &style::message(&verdict) + "\n"
}
