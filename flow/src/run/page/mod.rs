//! `report.html`: the results of a run on one page, which needs no other file and no network.
//!
//! The verdict comes first, then what each shaper costs and gains, then the checks, then the pictures, each with the command
//! that makes it. Every figure in a sentence or a table carries its place in `report.json` (`data-path`). All text of users passes through `maud`, which escapes it.

mod drawings;
mod pictures;
mod sentences;
mod tables;

use super::checks::Check;
use super::report::RunReport;
use super::sentence::RunSentence;
use crate::bench::Simulator;
use crate::failure::Failure;
use crate::plot::{Inline, Panel, inline, style_rules};
use maud::{DOCTYPE, Markup, PreEscaped, html};

const STYLE: &str = include_str!("style.css");
const SCRIPT: &str = include_str!("script.js");

/// Content of the page beside the results of the run.
pub(crate) struct Extra {
    /// Panels of the closed loop, with the name of their file.
    pub(crate) closed_loop: Vec<(&'static str, Vec<Panel>)>,
    /// Panels of `plots/sensitivity.svg`.
    pub(crate) sensitivity: Vec<Panel>,
    /// Panels of `plots/response.svg`.
    pub(crate) response: Vec<Panel>,
}

/// A figure of the page with its JSON pointer in `report.json`; a dash if there is no value.
fn figure_at(pointer: &str, figure: impl Into<Option<f64>>, shown: impl Fn(f64) -> String) -> Markup {
    match figure.into() {
        Some(number) => html! { data value=(number) data-path=(pointer) { (shown(number)) } },
        None => html! { "–" },
    }
}

/// A part of the page with pictures.
struct Part {
    title: &'static str,
    /// Description of the pictures, and what to look for.
    about: String,
    /// The command that makes them, to be called in the output folder.
    command: String,
    pictures: Vec<Markup>,
    /// Tables below the pictures.
    more: Markup,
}

impl RunReport<'_> {
    /// The page.
    pub(crate) fn page(&self, extra: &Extra) -> Result<String, Failure> {
        let is_failed = self.checks.iter().any(|check| !check.passed);
        let RunSentence { word, rest, remark } = RunSentence::of(self.checks, self.simulator);
        let rest = rest.trim_start_matches([':', ',', ' ']);
        let class = match (is_failed, word) {
            (true, "FAIL") => "bad",
            (true, _) => "open",
            (false, _) => "good",
        };
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    title { (word) ": " (self.machine.name) }
                    style { (PreEscaped(style_rules())) (PreEscaped(STYLE)) }
                }
                body {
                    header class=(class) {
                        p.name { (self.machine.name) }
                        h1 { strong { (word) } ": " (rest) }
                        @if let Some(remark) = remark { p { (remark) } }
                        p { "Made by " code { (self.command) } " with posicast " (env!("CARGO_PKG_VERSION")) "; simulator: " (self.tool()) "." }
                    }
                    main {
                        @if is_failed { (self.failures()) }
                        section {
                            h2 { "What the shapers cost and gain" }
                            (self.sentences())
                            (self.axes_table())
                        }
                        section {
                            h2 { "What was checked" }
                            (self.checks_table())
                            (self.not_exercised())
                        }
                        @for part in self.parts(extra)? { (shown(&part)) }
                    }
                    footer {
                        p { "Figures in sentences and tables are those of " code { "report.json" } ". Run the commands in the folder that holds this page, with the files that they name beside it." }
                    }
                    script { (PreEscaped(SCRIPT)) }
                }
            }
        };
        Ok(page.into_string())
    }

    /// The failed checks, each with its likely cause.
    fn failures(&self) -> Markup {
        html! {
            section.failures {
                h2 { "Why it failed" }
                @for check in self.checks.iter().filter(|check| !check.passed) {
                    article {
                        h3 { (check.name) }
                        (detail(check))
                        @if let Some(advice) = check.advice() {
                            p { strong { "Likely cause: " } (with_code(advice.cause)) "." }
                            p { strong { "Try this: " } (with_code(advice.remedies[0])) "; or " (with_code(advice.remedies[1])) "." }
                        }
                    }
                }
            }
        }
    }

    fn checks_table(&self) -> Markup {
        let class = |check: &Check| match (check.passed, check.is_open()) {
            (false, _) => "bad",
            (true, true) => "open",
            (true, false) => "good",
        };
        html! {
            div.wide { table {
                thead { tr { th { "result" } th { "check" } th { "what was compared" } } }
                tbody {
                    @for check in self.checks {
                        tr {
                            td class=(class(check)) { (check.verdict().trim()) }
                            td { (check.name) }
                            td { (detail(check)) }
                        }
                    }
                }
            } }
        }
    }

    /// The parts of the machine that this run does not exercise.
    fn not_exercised(&self) -> Markup {
        let mut names = self.lockstep.not_exercised_names();
        names.extend(
            self.checks
                .iter()
                .filter(|check| check.is_open())
                .map(|check| check.name.to_owned()),
        );
        if self.simulator == Simulator::Rusthdl {
            names.push("the Verilog itself".to_owned());
        }
        if self.estimate.is_none() {
            names.push("the area (Yosys is not installed)".to_owned());
        }
        if self.closed_loop.is_none() {
            names.push("a closed loop (the machine file describes no stage)".to_owned());
        }
        html! {
            @if !names.is_empty() { p { "Not exercised by this run: " (names.join(", ")) "." } }
            p {
                "All of this was simulated, on the machine that the machine file describes. Nothing was compiled in Quartus, \
                 and nothing ran on hardware: clock rate, pins and the real machine are not checked."
            }
        }
    }
}

/// The detail of a check; one of several lines keeps its columns.
fn detail(check: &Check) -> Markup {
    if check.detail.contains('\n') {
        html! { pre { (check.detail) } }
    } else {
        html! { span { (check.detail) } }
    }
}

/// A text in which the parts between backticks are formatted as code.
fn with_code(text: &str) -> Markup {
    html! {
        @for (index, part) in text.split('`').enumerate() {
            @if index % 2 == 1 { code { (part) } } @else { (part) }
        }
    }
}

fn shown(part: &Part) -> Markup {
    html! {
        section {
            h2 { (part.title) }
            p { (part.about) }
            p.command { code { (part.command) } }
            @if !part.pictures.is_empty() {
                div.pictures { @for picture in &part.pictures { (picture) } }
            }
            (part.more)
        }
    }
}

/// The panels as pictures.
fn drawn<'a>(panels: impl IntoIterator<Item = &'a Panel>) -> Result<Vec<Markup>, Failure> {
    panels.into_iter().map(|panel| Ok(figure(&inline(panel)?))).collect()
}

/// A picture with its title, its legend and the readout of the pointer.
fn figure(picture: &Inline) -> Markup {
    let window = &picture.window;
    let places = window.edges.map(|edge| edge.to_string()).join(" ");
    let values = [window.x.0, window.x.1, window.y.0, window.y.1]
        .map(|value| value.to_string())
        .join(" ");
    html! {
        figure.chart data-edges=(places) data-values=(values) data-x=(window.labels[0]) data-y=(window.labels[1]) data-points=[points(picture)] {
            figcaption { (picture.title) }
            ul.legend {
                @for (series, entry) in picture.legend.iter().enumerate() {
                    li { button type="button" aria-pressed="true" data-hides=(series) {
                        svg.sample viewBox="0 0 26 12" aria-hidden="true" { (sample(entry.form, &entry.colour)) }
                        span { (entry.name) }
                    } }
                }
            }
            (PreEscaped(&picture.svg))
            output {}
        }
    }
}

/// The names of a picture's points, for the script; `None` if it has none.
fn points(picture: &Inline) -> Option<String> {
    (!picture.points.is_empty()).then(|| serde_json::json!(picture.points).to_string())
}

fn sample(form: &str, colour: &str) -> Markup {
    match form {
        "area" => html! { rect x="1" y="0" width="24" height="12" fill=(colour) {} },
        "dot" => html! { circle cx="13" cy="6" r="4" fill=(colour) {} },
        "dash" => html! { path d="M1 6h7m4 0h7m4 0h2" stroke=(colour) stroke-width="2" fill="none" {} },
        _ => html! { path d="M1 6h24" stroke=(colour) stroke-width="3" fill="none" {} },
    }
}
