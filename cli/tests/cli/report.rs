//! `run`: the page `report.html` and the document `report.json` say the same, and the page needs nothing else.

#![cfg(test)] // lets clippy see that this is test code

use crate::cli::support::{assert_fits_schema, example, json, one_axis, posicast, scratch};
use scraper::{Html, Selector};
use serde_json::Value;
use std::path::Path;

/// Largest size of a page, in bytes.
const LARGEST: usize = 3_000_000;

/// A run's page and document, and its exit status.
struct Report {
    page: String,
    document: Value,
    status: Option<i32>,
}

impl Report {
    fn of(machine: &Path, output: &Path, words: &[&str]) -> Self {
        let mut run = posicast();
        run.arg("run").arg(machine).arg("-o").arg(output).args(words);
        let run = run.arg("--json").output().unwrap();
        let said = String::from_utf8_lossy(&run.stderr).into_owned();
        let page = std::fs::read_to_string(output.join("report.html")).unwrap_or_else(|_| panic!("{said}"));
        let document = json(&std::fs::read(output.join("report.json")).unwrap());
        assert_eq!(document, json(&run.stdout));
        Self {
            page,
            document,
            status: run.status.code(),
        }
    }

    /// Checks all that holds for every page, and returns it parsed.
    fn checked(&self) -> Html {
        assert_fits_schema("report", &self.document);
        assert!(self.page.len() < LARGEST, "{} bytes", self.page.len());
        let html = Html::parse_document(&self.page);
        assert!(html.errors.is_empty(), "{:?}", html.errors);
        self.needs_nothing_else(&html);
        self.values_are_those_of_the_document(&html);
        html
    }

    fn needs_nothing_else(&self, html: &Html) {
        for element in html.root_element().descendent_elements() {
            let value = element.value();
            assert!(!matches!(
                value.name(),
                "link" | "img" | "iframe" | "object" | "embed" | "base"
            ));
            for attribute in ["src", "href", "xlink:href", "action", "srcset", "data"] {
                assert_eq!(value.attr(attribute), None, "{} {attribute}", value.name());
            }
        }
        // The only addresses are the names of XML's SVG.
        let rest = self.page.replace("http://www.w3.org/2000/svg", "");
        for part in ["http:", "https:", "//cdn", "@import", "url("] {
            assert!(!rest.contains(part), "{part}");
        }
    }

    fn values_are_those_of_the_document(&self, html: &Html) {
        let mut seen = 0;
        for element in html.select(&Selector::parse("data").unwrap()) {
            let path = element.value().attr("data-path").unwrap();
            let value: f64 = element.value().attr("value").unwrap().parse().unwrap();
            assert_eq!(
                self.document.pointer(path).and_then(Value::as_f64),
                Some(value),
                "{path}"
            );
            let shown: String = element.text().collect();
            assert!(is_shown(&shown, value), "{path}: `{shown}` for {value}");
            seen += 1;
        }
        assert!(seen > 20, "{seen} figures");
    }
}

/// Whether a text shows a value: its number, in a unit that is a power of ten finer or coarser, with as many digits as it has.
fn is_shown(text: &str, value: f64) -> bool {
    let number = text.split([' ', '%']).next().unwrap();
    let Ok(shown) = number.parse::<f64>() else {
        return false;
    };
    if value == 0.0 || shown == 0.0 {
        return shown.abs() < 1e-9 && value.abs() < 1e-9;
    }
    let power = (value.abs() / shown.abs()).log10().round();
    let ratio = value.abs() / shown.abs() / 10f64.powf(power);
    (ratio - 1.0).abs() < 0.05
}

fn text_of_element(element: scraper::ElementRef<'_>, selector: &str) -> String {
    let selector = Selector::parse(selector).unwrap();
    element.select(&selector).flat_map(|element| element.text()).collect()
}

fn text_of(html: &Html, selector: &str) -> String {
    let selector = Selector::parse(selector).unwrap();
    let words = html.select(&selector).flat_map(|element| element.text());
    words.collect::<Vec<_>>().join(" ")
}

/// Every curve, dot and area inside a chart belongs to an entry of the legend, or is a line without a name.
fn each_entry_of_a_legend_hides_what_is_drawn_for_it(html: &Html) {
    let select = |text: &str| Selector::parse(text).unwrap();
    let mut bands = 0;
    for chart in html.select(&select("figure.chart")) {
        let buttons: Vec<&str> = chart
            .select(&select("button"))
            .map(|button| button.value().attr("data-hides").unwrap())
            .collect();
        assert!(!buttons.is_empty());
        for hides in buttons {
            let group = select(&format!("svg g[data-series=\"{hides}\"]"));
            let drawn: Vec<_> = chart.select(&group).flat_map(|group| group.child_elements()).collect();
            assert!(!drawn.is_empty(), "{hides} of {}", text_of_element(chart, "figcaption"));
            // A band has its area and the lines at its ends.
            let names: Vec<&str> = drawn.iter().map(|element| element.value().name()).collect();
            bands += usize::from(names == ["rect", "polyline", "polyline"]);
        }
    }
    assert!(bands > 0);
}

#[test]
fn cli_the_page_of_a_run_says_what_its_document_says() {
    let machine =
        one_axis("kind = \"zvd\"", "frequency_hz = 50.0\ndamping = 0.2").replace("\"x\"", "\"x\"\nunit = \"mm\"");
    let machine = machine.replace("counts_per_unit = 1_000_000", "counts_per_unit = 4");
    let (folder, file) = scratch(&machine);
    let command = folder.path().join("ramp.csv");
    std::fs::write(&command, "time_s,position\n0,0\n0.03,20\n").unwrap();
    let words = ["--simulator", "icarus", "--command", command.to_str().unwrap()];
    let report = Report::of(&file, &folder.path().join("out"), &words);
    let html = report.checked();
    assert_eq!(report.status, Some(0));
    let heading = text_of(&html, "h1");
    assert!(heading.starts_with("PASS"), "{heading}");

    // The ZVD of 50 Hz and 20 % lasts a damped period, 20 ms / √0.96 = 20.41 ms. At the end of the ramp the load begins to ring by
    // 667 mm/s / 314 rad/s = 2.1 mm, which falls to a count, 0.25 mm, after ln(8.5) / 62.8 = 34 ms, give or take half a period.
    let gain = &report.document["axes"][0]["gain"];
    let of = |name: &str| gain[name].as_f64().unwrap();
    assert!((of("later_s") - 0.0204).abs() < 2.1e-4, "{gain}");
    assert!((of("settled_unshaped_s") - 0.064).abs() < 0.01, "{gain}");
    assert!(of("settled_s") < of("arrival_s") && gain["of"] == "open-loop", "{gain}");
    assert!(
        (of("sooner_s") - (of("settled_unshaped_s") - of("settled_s"))).abs() < 1e-12,
        "{gain}"
    );
    let sentence = text_of(&html, ".gains li");
    assert!(
        sentence.contains("20 ms later") && sentence.contains("sooner"),
        "{sentence}"
    );

    for title in [
        "Impulses and command",
        "Sensitivity",
        "Residual over",
        "Response",
        "One sample",
        "Kinds of shaper",
        "Area",
    ] {
        assert!(text_of(&html, "h2").contains(title), "{title}");
    }
    assert_eq!(
        html.select(&Selector::parse("main section").unwrap()).count() - 2,
        html.select(&Selector::parse("p.command").unwrap()).count(),
        "each part with pictures names its command"
    );
    assert!(text_of(&html, ".waves text").contains("x_valid"));
    // The folder has all that its command needs.
    assert!(text_of(&html, "header code").ends_with("--command input/ramp.csv --simulator icarus"));
    let copy = std::fs::read_to_string(folder.path().join("out/input/ramp.csv")).unwrap();
    assert_eq!(copy, std::fs::read_to_string(&command).unwrap());
    each_entry_of_a_legend_hides_what_is_drawn_for_it(&html);
    assert!(text_of(&html, "main").contains("nothing ran on hardware"));
}

#[test]
fn cli_the_page_of_a_failed_run_begins_with_the_failure_and_its_cause() {
    let (folder, file) = scratch(&one_axis("kind = \"zv\"", "frequency_hz = 50.0\ndamping = 0.1"));
    let command = folder.path().join("<still & \"quiet\">.csv");
    std::fs::write(&command, "time_s,position\n0,0\n0.01,0\n").unwrap();
    let words = [
        "--simulator",
        "icarus",
        "--cycles",
        "20000",
        "--command",
        command.to_str().unwrap(),
    ];
    let report = Report::of(&file, &folder.path().join("out"), &words);
    let html = report.checked();
    assert_eq!((report.status, &report.document["result"]), (Some(1), &"fail".into()));
    let heading = text_of(&html, "h1");
    assert!(
        heading.starts_with("FAIL") && heading.contains("do not put this Verilog"),
        "{heading}"
    );
    let first = text_of(&html, "main > section:first-child");
    assert!(
        first.contains("the command moves every axis") && first.contains("Likely cause"),
        "{first}"
    );
    // The name of the file is a text, not markup.
    assert!(report.page.contains("&lt;still &amp; "), "{}", text_of(&html, "header"));
    assert!(text_of(&html, ".gains li").contains("the command does not move it"));
}

#[test]
fn long_cli_the_page_of_a_stage_shows_its_closed_loop() {
    let folder = tempfile::tempdir().unwrap();
    let report = Report::of(&example("xy-stage.toml"), &folder.path().join("out"), &[]);
    let html = report.checked();
    assert_eq!(report.status, Some(0));
    let titles = text_of(&html, "h2");
    assert!(
        titles.contains("Closed loop: the move") && titles.contains("Circle"),
        "{titles}"
    );
    let gain = &report.document["axes"][0]["gain"];
    assert_eq!(gain["of"], "closed-loop");
    // The ZVD of 131.1 Hz lasts 7.72 ms, which is 78 samples.
    assert!((gain["later_s"].as_f64().unwrap() - 7.8e-3).abs() < 1.1e-4, "{gain}");
}
