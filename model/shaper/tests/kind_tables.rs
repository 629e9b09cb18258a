//! The table of kinds in `docs/shaper-design.md` has the figures of this version's designs. `scripts/regenerate` writes
//! it again.

use posicast_shaper::analysis::{Insensitivity, insensitivity};
use posicast_shaper::axis::{AxisMode, ShapedAxis, ShaperChoice};
use posicast_shaper::design::design_axis;
use posicast_shaper::design::kind::ShaperKind;
use posicast_shaper::design::smooth::Kernel;
use posicast_shaper::mode::Mode;
use std::path::Path;

const MARKS: [&str; 2] = ["<!-- figures of the kinds: generated -->", "<!-- end -->"];
/// The mode of the figures: its period is the unit of their durations.
const MODE: Mode = Mode {
    frequency_hz: 1.0,
    damping: 0.0,
};
const TOLERANCE: f64 = 0.05;
/// Samples per period: a kernel is then sampled with 100 taps or more.
const SAMPLE_HZ: f64 = 140.0;

/// Returns impulses, duration and insensitivity of a kind, as text.
fn figures(kind: ShaperKind) -> [String; 3] {
    let mode = AxisMode {
        mode: MODE,
        free: None,
        shaper: None,
        tolerance: None,
        order: None,
        frequency_band: None,
        damping_band: None,
        participation: 1.0,
        points: Vec::new(),
    };
    let choice = ShaperChoice::of_kind(kind);
    let axis = ShapedAxis {
        name: "x",
        shaper: Some(&choice),
        modes: &[mode],
    };
    let impulses = design_axis(axis, SAMPLE_HZ).unwrap().impulses;
    let (count, duration_s) = match Kernel::new(kind, &MODE, TOLERANCE) {
        Ok(kernel) => ("a kernel".to_owned(), kernel.duration_s),
        Err(_) => (impulses.impulses().len().to_string(), impulses.duration_s()),
    };
    let band = insensitivity(impulses.impulses(), &MODE, TOLERANCE).unwrap();
    [count, format!("{duration_s:.2} T"), show(band)]
}

fn show(band: Insensitivity) -> String {
    match band.high {
        Some(high) => format!("{:.1} %", 100.0 * (high - band.low)),
        None => format!("from {:.3} of the mode up", band.low),
    }
}

fn row(kind: ShaperKind) -> String {
    let [count, duration, band] = if kind.treats_modes_together() {
        ["–", "–", "–"].map(str::to_owned)
    } else {
        figures(kind)
    };
    let row = kind.row();
    let order = match row.default_order {
        1 => String::new(),
        order => format!(", order {order}"),
    };

    format!(
        "| `{kind}`{order} | {} | {count} | {duration} | {band} | {} |\n",
        row.about, row.source
    )
}

#[test]
fn golden_the_table_of_kinds_has_the_figures_of_the_designs() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/shaper-design.md");
    let committed = std::fs::read_to_string(&page).unwrap();
    let [begin, end] = MARKS;
    let (before, rest) = committed.split_once(begin).expect("the mark above the table");
    let (_, after) = rest.split_once(end).expect("the mark below the table");
    let rows: String = ShaperKind::ALL.iter().map(|kind| row(*kind)).collect();
    let head =
        "| kind | what it does | impulses | duration | 5 % insensitivity | source |\n|---|---|---|---|---|---|\n";
    let derived = format!("{before}{begin}\n\n{head}{rows}\n{end}{after}");
    if std::env::var_os("POSICAST_REGENERATE").is_some() {
        std::fs::write(&page, &derived).unwrap();
    } else {
        assert!(
            committed == derived,
            "docs/shaper-design.md: the table is not what the designs say; if the change is meant: scripts/regenerate"
        );
    }
}
