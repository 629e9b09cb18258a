//! The table of the largest servo rates in `docs/stage.md`: found by building ever faster machines until one is refused.
//! `scripts/regenerate` writes it again.

use posicast_machine::hardware::Hardware;
use posicast_machine::machine_file;
use posicast_machine::plan::design_machine;
use std::fmt::Write;
use std::path::Path;

const CLOCK_HZ: f64 = 50e6;
/// Numbers of taps of each axis's shaper.
const TAPS: [usize; 7] = [2, 3, 5, 9, 17, 33, 65];
const TITLE: &str = "| axes | taps: 2 |";
/// No machine needs more clocks than this.
const MOST_CLOCKS: u32 = 8192;

/// An axis with a controller.
const LOOP: &str = "
[axis.encoder]
[axis.pwm]
mode = \"locked-antiphase\"
frequency_hz = SAMPLE_HZ
dead_time_s = 0
minimum_pulse_s = 0
[axis.drive]
mode = \"velocity\"
full_scale_velocity = 0.1
[axis.controller]
kind = \"pd\"
[axis.limits]
velocity = 0.05
acceleration = 1
";

/// An axis with steps.
const STEPS: &str = "
[axis.steps]
mode = \"step_direction\"
pulse_s = 40e-9
direction_setup_s = 40e-9
[axis.limits]
velocity = 0.05
acceleration = 1
";

/// Whether a stage of so many axes, each with so many taps, is built with ticks of so many clocks. `last` makes it an axis with a loop
/// or steps.
fn is_built(last: &str, axes: usize, taps: usize, tick_clocks: u32) -> bool {
    let sample_hz = CLOCK_HZ / f64::from(tick_clocks);
    let impulses = (0..taps).map(|tap| format!("[{:?}, {:?}]", tap as f64 / sample_hz, 1.0 / taps as f64));
    let impulses = impulses.collect::<Vec<_>>().join(", ");
    let mut text = format!("name = \"fast\"\n[clock]\nfrequency_hz = {CLOCK_HZ:?}\nsample_hz = {sample_hz:?}\n");
    for axis in 0..axes {
        let _ = write!(
            text,
            "[[axis]]\nname = \"a{axis}\"\nunit = \"m\"\ncounts_per_unit = 1e5\n[axis.shaper]\nkind = \"custom\"\n\
             impulses = [{impulses}]\n{}",
            last.replace("SAMPLE_HZ", &format!("{sample_hz:?}"))
        );
    }
    let machine = machine_file::parse("fast.toml", &text).unwrap_or_else(|error| panic!("{error}\n{error:?}"));
    let Ok(design) = design_machine(&machine) else {
        return false;
    };
    assert!(design.axes.iter().all(|axis| axis.table.taps().len() == taps));
    let Ok(hardware) = Hardware::of(&machine, &design) else {
        return false;
    };
    let shapers_fit = hardware.axes().iter().all(|axis| axis.shaper.is_ok());
    shapers_fit && hardware.stage().is_ok_and(|stage| stage.is_some())
}

/// The shortest tick in clocks with which it is built.
fn least_clocks(last: &str, axes: usize, taps: usize) -> u32 {
    let (mut refused, mut built) = (2, MOST_CLOCKS);
    assert!(is_built(last, axes, taps, built), "{axes} axes with {taps} taps");
    while built - refused > 1 {
        let between = refused.midpoint(built);
        if is_built(last, axes, taps, between) {
            built = between;
        } else {
            refused = between;
        }
    }
    built
}

fn table(last: &str) -> String {
    let columns: Vec<String> = TAPS[1..].iter().map(|taps| format!(" {taps} |")).collect();
    let mut table = format!("{TITLE}{}\n|---|{}\n", columns.concat(), "---|".repeat(TAPS.len()));
    for axes in 1..=4 {
        let cells = TAPS.map(|taps| {
            let clocks = least_clocks(last, axes, taps);
            format!(" {:.1} kHz ({clocks}) |", CLOCK_HZ / f64::from(clocks) / 1e3)
        });
        let _ = writeln!(table, "| {axes} |{}", cells.concat());
    }
    table
}

#[test]
fn golden_the_table_of_rates_is_what_machines_can_have() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/stage.md");
    let committed = std::fs::read_to_string(&page).unwrap();
    let mut parts = committed.split(TITLE);
    let mut derived = parts.next().unwrap().to_owned();
    for (part, last) in parts.by_ref().zip([LOOP, STEPS]) {
        let (_, after) = part.split_once("\n\n").unwrap();
        derived += &format!("{}\n{after}", table(last));
    }
    assert!(parts.next().is_none(), "docs/stage.md has a third table of rates");
    if std::env::var_os("POSICAST_REGENERATE").is_some() {
        std::fs::write(&page, &derived).unwrap();
    } else {
        assert!(
            committed == derived,
            "docs/stage.md: its table of rates is not what machines can have; if the change is meant: scripts/regenerate"
        );
    }
}
