//! The table of what the clocks of each row reached, for `verify --verbose`.

use crate::text::Table;
use posicast_testbench::lockstep::report::LockstepReport;

/// A row per count, with the number that a verdict requires; `–` if there is none.
pub(super) fn text(report: &LockstepReport) -> String {
    let mut table = Table::new(&["block", "instance", "reached", ">count", ">least"]);
    for block in &report.blocks {
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
    table.text("")
}
