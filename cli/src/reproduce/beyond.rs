//! `posicast reproduce --beyond`: the paper's shaper, the shortest closed form and the shortest possible shaper, side
//! by side.

use crate::output;
use crate::table::Table;
use crate::terminal::Terminal;
use posicast_flow::Failure;
use posicast_flow::Observer;
use posicast_papers::{BeyondRow, beyond};
use posicast_testbench::wording::counted;
use schemars::JsonSchema;
use serde::Serialize;

/// Designs all examples, and prints the table or the JSON document.
///
/// # Errors
/// A failed check: an example cannot be designed, or a result is not proven to be the shortest.
pub(super) fn run(json: bool) -> Result<(), Failure> {
    let progress = Terminal.begin("designing", None);
    let rows = beyond().map_err(|error| Failure::Check(format!("an example cannot be designed: {error}")))?;
    drop(progress);
    if json {
        let rows = rows.iter().map(Row::new).collect();
        output::print_json(&Document { beyond: rows })?;
    } else {
        output::print(&text(&rows))?;
    }
    match rows.iter().find(|row| !row.proven) {
        None => Ok(()),
        Some(row) => Err(Failure::Check(format!("{}: not proven to be the shortest", row.item))),
    }
}

fn text(rows: &[BeyondRow]) -> String {
    let mut table = Table::new(&[
        "example",
        ">paper s",
        "",
        ">closed form s",
        "",
        ">optimal s",
        ">grid s",
        "",
        "",
    ]);
    let duration = |found: &Option<(f64, String)>| match found {
        Some((duration_s, name)) => [format!("{duration_s:.6}"), name.clone()],
        None => ["–".to_owned(), String::new()],
    };
    for row in rows {
        let ([paper_s, paper], [closed_s, closed]) = (duration(&row.paper), duration(&row.closed_form));
        table.row([
            row.item.clone(),
            paper_s,
            paper,
            closed_s,
            closed,
            format!("{:.6}", row.optimal_s),
            format!("{}", row.sample_s),
            counted(row.taps as u64, "tap"),
            if row.proven { "proven" } else { "not proven" }.into(),
        ]);
    }
    format!(
        "{}\nclosed form: the shortest kind of posicast whose residual is within the tolerance over the band, and whose command is within the bounds\n",
        table.text("  ")
    )
}

/// `reproduce --beyond --json`.
#[derive(Serialize, JsonSchema)]
pub(crate) struct Document<'a> {
    beyond: Vec<Row<'a>>,
}

#[derive(Serialize, JsonSchema)]
struct Row<'a> {
    item: &'a str,
    paper: Option<Duration<'a>>,
    closed_form: Option<Duration<'a>>,
    optimal_s: f64,
    taps: usize,
    sample_s: f64,
    proven: bool,
}

#[derive(Serialize, JsonSchema)]
struct Duration<'a> {
    duration_s: f64,
    name: &'a str,
}

impl<'a> Row<'a> {
    fn new(row: &'a BeyondRow) -> Self {
        let duration = |found: &'a Option<(f64, String)>| {
            found.as_ref().map(|(duration_s, name)| Duration {
                duration_s: *duration_s,
                name,
            })
        };
        Self {
            item: &row.item,
            paper: duration(&row.paper),
            closed_form: duration(&row.closed_form),
            optimal_s: row.optimal_s,
            taps: row.taps,
            sample_s: row.sample_s,
            proven: row.proven,
        }
    }
}
