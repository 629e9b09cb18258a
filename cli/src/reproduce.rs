//! `posicast reproduce`: prints the source papers' tables beside ours.

mod beyond;

use crate::output;
use crate::style;
use crate::table::Table;
use crate::terminal::Terminal;
use clap::builder::PossibleValuesParser;
use posicast_flow::Failure;
use posicast_flow::Observer;
use posicast_flow::plot::{self, Curve, Panel};
use posicast_papers::{Figure, Paper, PaperRow, PaperVerdict, Value};
use posicast_system::output::OutputFiles;
use posicast_testbench::wave::write_text;
use schemars::JsonSchema;
use serde::Serialize;
use std::fmt::Write;
use std::path::{Path, PathBuf};

pub(crate) use beyond::Document as BeyondDocument;

/// Compare the source papers' tables with ours, with a verdict per row
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  posicast reproduce vibrationless\n  posicast reproduce --plot figures\n  posicast reproduce \
                  --beyond\n\nExit status 1: a row that is recorded as reproduced, or as an erratum, no longer is."
)]
pub(crate) struct Args {
    /// Paper [default: all of them]
    #[arg(value_parser = PossibleValuesParser::new(Paper::ALL.map(Paper::name)))]
    paper: Option<String>,
    /// Compare the papers' examples with the shortest closed form and the shortest possible shaper instead
    #[arg(long, conflicts_with_all = ["paper", "plot"])]
    beyond: bool,
    /// Print one JSON document on standard output
    #[arg(long)]
    json: bool,
    /// Draw the papers' figures into this folder, one SVG file per paper
    #[arg(long, value_name = "DIR")]
    plot: Option<PathBuf>,
    /// Replace a file that posicast did not write, or that was changed since; never one that this command reads
    #[arg(long, requires = "plot")]
    force: bool,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    if args.beyond {
        return beyond::run(args.json);
    }
    let named = args.paper.as_deref().and_then(Paper::from_name);
    let papers = named.map_or_else(|| Paper::ALL.to_vec(), |paper| vec![paper]);
    let mut outputs = OutputFiles::new(args.force);
    // A folder that does not exist yet contains nothing that could be replaced.
    for folder in args.plot.iter().filter(|folder| folder.is_dir()) {
        for paper in &papers {
            outputs
                .claim("--plot", &picture(folder, *paper))
                .map_err(Failure::because)?;
        }
    }
    let progress = Terminal.begin("reproducing", Some(papers.len() as u64));
    let mut tables = Vec::with_capacity(papers.len());
    for paper in papers {
        progress.rename(paper.name());
        tables.push((paper, paper.reproduce().map_err(|e| fault(paper, &e))?));
        if let Some(folder) = &args.plot {
            let figures = paper.figures().map_err(|e| fault(paper, &e))?;
            draw(folder, paper, figures)?;
        }
        progress.advance(1);
    }
    drop(progress);
    let counts = Counts::from_tables(&tables);
    if args.json {
        output::print_json(&Document::new(&tables, counts))?;
    } else {
        output::print_styled(&text(&tables, counts))?;
    }
    match counts.not_reproduced {
        0 => Ok(()),
        count => Err(Failure::Check(format!(
            "{count} rows are not as expected; first: {}",
            first_not_reproduced(&tables)
        ))),
    }
}

/// Reports a paper's shaper that cannot be designed, which is not the user's fault.
fn fault(paper: Paper, error: &dyn std::error::Error) -> Failure {
    Failure::Check(format!(
        "{}: a shaper of the paper cannot be designed: {error}",
        paper.name()
    ))
}

type Tables = Vec<(Paper, Vec<PaperRow>)>;

fn first_not_reproduced(tables: &Tables) -> String {
    let mut rows = tables
        .iter()
        .flat_map(|(paper, rows)| rows.iter().map(move |row| (paper, row)));
    let first = rows.find(|(_, row)| row.verdict == PaperVerdict::NotReproduced);
    first.map_or_else(String::new, |(paper, row)| format!("{}, {}", paper.name(), row.item))
}

#[derive(Clone, Copy)]
struct Counts {
    reproduced: usize,
    errata: usize,
    not_comparable: usize,
    not_reproduced: usize,
}

impl Counts {
    fn from_tables(tables: &Tables) -> Self {
        let count = |verdict| {
            let rows = tables.iter().flat_map(|(_, rows)| rows);
            rows.filter(|row| row.verdict == verdict).count()
        };
        Self {
            reproduced: count(PaperVerdict::Reproduced),
            errata: count(PaperVerdict::Erratum),
            not_comparable: count(PaperVerdict::NotComparable),
            not_reproduced: count(PaperVerdict::NotReproduced),
        }
    }
}

fn text(tables: &Tables, counts: Counts) -> String {
    let mut text = String::new();
    for (paper, rows) in tables {
        let _ = writeln!(text, "{}: {}", paper.name(), paper.title());
        let mut table = Table::new(&["item", ">paper", ">ours", ">difference", "verdict", "reason"]);
        for row in rows {
            table.row([
                row.item.clone(),
                row.printed.clone(),
                row.ours.as_ref().map_or_else(|| "–".into(), value_text),
                row.difference().map_or_else(String::new, difference_text),
                verdict_text(row.verdict),
                row.reason.clone(),
            ]);
        }
        text += &table.text("  ");
        text.push('\n');
    }
    let _ = write!(
        text,
        "{} reproduced, {} errata, {} not comparable",
        counts.reproduced, counts.errata, counts.not_comparable
    );
    if counts.not_reproduced > 0 {
        let _ = write!(
            text,
            ", {}",
            style::bad(&format!("{} NOT REPRODUCED", counts.not_reproduced))
        );
    }
    text.push('\n');
    text
}

fn verdict_text(verdict: PaperVerdict) -> String {
    let text = verdict.to_string();
    match verdict {
        PaperVerdict::Reproduced => style::good(&text),
        PaperVerdict::NotReproduced => style::bad(&text),
        PaperVerdict::Erratum | PaperVerdict::NotComparable => style::doubtful(&text),
    }
}

fn value_text(value: &Value) -> String {
    match value {
        Value::Number(number) => number_text(*number),
        Value::Numbers(numbers) => numbers.iter().map(|n| number_text(*n)).collect::<Vec<_>>().join(", "),
        Value::Text(text) => text.clone(),
    }
}

/// A number with six significant digits.
fn number_text(number: f64) -> String {
    let size = number.abs();
    if size == 0.0 || !(1e-4..1e7).contains(&size) {
        return if size < 1e-12 {
            "0".into()
        } else {
            format!("{number:.5e}")
        };
    }
    let decimals = (5 - size.log10().floor() as i32).max(0) as usize;
    let text = format!("{number:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

fn difference_text(difference: f64) -> String {
    if difference.abs() < 1e-12 {
        "0".into()
    } else {
        format!("{difference:+.1e}")
    }
}

/// `reproduce --json`: the command line's contract.
#[derive(Serialize, JsonSchema)]
pub(crate) struct Document<'a> {
    papers: Vec<ReproducedPaper<'a>>,
    reproduced: usize,
    errata: usize,
    not_comparable: usize,
    not_reproduced: usize,
}

#[derive(Serialize, JsonSchema)]
struct ReproducedPaper<'a> {
    name: &'static str,
    rows: Vec<Row<'a>>,
}

#[derive(Serialize, JsonSchema)]
struct Row<'a> {
    item: &'a str,
    paper: PrintedValue<'a>,
    ours: Option<PrintedValue<'a>>,
    verdict: String,
    reason: &'a str,
}

#[derive(Serialize, JsonSchema)]
#[serde(untagged)]
enum PrintedValue<'a> {
    Number(f64),
    Numbers(&'a [f64]),
    Text(&'a str),
}

impl<'a> From<&'a Value> for PrintedValue<'a> {
    fn from(value: &'a Value) -> Self {
        match value {
            Value::Number(number) => Self::Number(*number),
            Value::Numbers(numbers) => Self::Numbers(numbers),
            Value::Text(text) => Self::Text(text),
        }
    }
}

impl<'a> Document<'a> {
    fn new(tables: &'a Tables, counts: Counts) -> Self {
        let row = |row: &'a PaperRow| Row {
            item: &row.item,
            paper: (&row.paper).into(),
            ours: row.ours.as_ref().map(PrintedValue::from),
            verdict: row.verdict.to_string(),
            reason: &row.reason,
        };
        let papers = tables.iter().map(|(paper, rows)| ReproducedPaper {
            name: paper.name(),
            rows: rows.iter().map(row).collect(),
        });
        Self {
            papers: papers.collect(),
            reproduced: counts.reproduced,
            errata: counts.errata,
            not_comparable: counts.not_comparable,
            not_reproduced: counts.not_reproduced,
        }
    }
}

fn draw(folder: &Path, paper: Paper, figures: Vec<Figure>) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|error| {
        Failure::input(format!("cannot make the folder `{}`: {error}", folder.display()))
            .with_help("name a folder that you may write to")
    })?;
    let panels: Vec<Panel> = figures
        .into_iter()
        .map(|figure| Panel {
            title: figure.title,
            x_label: figure.x_label.into(),
            y_label: figure.y_label.into(),
            curves: figure
                .curves
                .into_iter()
                .map(|curve| {
                    if curve.reference {
                        Curve::reference(curve.name, curve.points)
                    } else {
                        Curve::new(curve.name, curve.points)
                    }
                })
                .collect(),
            ..Panel::default()
        })
        .collect();
    write_text(&picture(folder, paper), &plot::svg(&panels)?).map_err(Failure::because)
}

/// Path of the file with the figures of a paper.
fn picture(folder: &Path, paper: Paper) -> PathBuf {
    folder.join(format!("{}.svg", paper.name()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_six_digits() {
        let cases = [
            (0.0, "0"),
            (1e-16, "0"),
            (0.199_725_38, "0.199725"),
            (-47.174_07, "-47.1741"),
            (81.0, "81"),
            (1_302_881.3, "1302881"),
            (66_888_995.6, "6.68890e7"),
            (2e-5, "2.00000e-5"),
        ];
        for (number, text) in cases {
            assert_eq!(number_text(number), text);
        }
    }
}
