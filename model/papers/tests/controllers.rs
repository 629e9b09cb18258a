//! Controllers under friction, compared with independently computed runs.

use posicast_papers::controllers::{ControllerCase, ControllerFigures};
use serde_json::Value;
use std::error::Error;
use std::path::Path;

/// The rows of the golden file, in the order of [`ControllerCase::ALL`].
const NAMES: [&str; 28] = [
    "PD (same linear part as SMC: kp=c k, kd=c+k), no feedforward",
    "PD + acceleration feedforward",
    "PID (ki = 2e5), no feedforward",
    "PID (ki = 2e5) + acceleration feedforward",
    "SMC sgn, c=150 k=50 eps=150 in SI (150 m/s^2)",
    "SMC sgn, c=150 k=50 eps=150 mm/s^2",
    "SMC sgn, eps=4 m/s^2 (> friction bound)",
    "SMC sat, eps=4 m/s^2, phi=0.005 m/s",
    "SMC sat, eps=4 m/s^2, phi=0.02 m/s",
    "SMC sat, eps=4 m/s^2, phi=0.05 m/s",
    "SMC sat, eps=4 m/s^2, phi=0.1 m/s",
    "SMC sat, eps=150 m/s^2 (paper value, SI), phi=0.5 m/s",
    "SMC sat, eps=150 m/s^2 (paper value, SI), phi=1 m/s",
    "SMC sat, eps=4, phi=0.02 + Coulomb feedforward",
    "integral SMC sat, eps=4, phi=0.02, ci=7500",
    "SMC sat, eps=4, phi=0.02, table mass +50 %",
    "PD + ff, table mass +50 %",
    "SMC sat, eps=4, phi=0.02, Ts=1 ms",
    "SMC sgn, eps=4, Ts=1 ms",
    "SMC sat, eps=4, phi=0.05, 1 um scale, velocity = diff + 300 Hz LPF",
    "SMC sat, eps=4, phi=0.05, 0.1 um scale, velocity = diff + 300 Hz LPF",
    "SMC sgn, eps=4, 1 um scale, velocity = diff + 300 Hz LPF",
    "SMC sat in VOLTAGE mode (eq 4-2, L=50 mH, R=1), eps=4 phi=0.02",
    "  same, L = 5 mH",
    "  same, L = 1 mH",
    "  same, L = 0.2 mH",
    "eq 4-11 as printed, voltage mode, full plant",
    "eq 4-11 corrected, voltage mode, full plant",
];

fn figures(golden: &Value) -> [(f64, &'static str); 8] {
    ["e_max", "e_rms", "ev_max", "u_rms", "tv", "s_max", "sat", "switch_hz"]
        .map(|key| (golden[key].as_f64().unwrap(), key))
}

fn numbers(found: &ControllerFigures) -> [f64; 8] {
    [
        found.error_peak,
        found.error_rms,
        found.rate_peak,
        found.command_rms,
        found.chatter,
        found.surface_peak,
        found.limited,
        found.crossings,
    ]
}

#[test]
fn golden_the_laws_in_floating_point_follow_as_computed_elsewhere() {
    let golden: Value = serde_json::from_str(include_str!("../../machine/tests/golden/drive.json")).unwrap();
    let mut faults = vec![];
    for (case, name) in ControllerCase::ALL.iter().zip(NAMES) {
        // A switching law amplifies rounding: its commands are equal, its errors agree to a part in a thousand, or in
        // a hundred in permanent bang-bang.
        let part = match name {
            _ if name.contains("150 in SI") => 2e-2,
            _ if name.contains("sgn") || name.contains("scale") || name.contains("VOLTAGE") => 1e-3,
            _ => 1e-6,
        };
        let found = numbers(&case.float());
        for (found, (expected, key)) in found.into_iter().zip(figures(&golden["smc_runs"][name])) {
            if (found - expected).abs() > part * expected.abs() {
                faults.push(format!("{name}: {key} {found:e} instead of {expected:e}"));
            }
        }
    }
    assert!(faults.is_empty(), "{faults:#?}");
}

#[test]
fn golden_the_bit_exact_controller_follows_as_the_float_law_does() {
    let mut compared = 0;
    for case in ControllerCase::ALL {
        let Some(exact) = case.bit_exact() else { continue };
        // The sign function becomes a steep layer, and a switching law amplifies rounding. The hardware's PID does
        // not wind up at the start.
        let part = match case.name {
            name if name.contains("sgn") => 0.06,
            name if name.starts_with("PID") => 0.03,
            name if name.contains("Coulomb") => 0.01,
            _ => 5e-4,
        };
        let of = |figures: ControllerFigures| [figures.error_peak, figures.error_rms, figures.command_rms];
        for (found, expected) in of(exact).into_iter().zip(of(case.float())) {
            assert!(
                (found / expected - 1.0).abs() < part,
                "{}: {found:e}, float {expected:e}",
                case.name
            );
        }
        compared += 1;
    }
    assert_eq!(compared, 21);
}

const TITLE: &str = "| controller | max \\|e\\| | rms e | max \\|e′\\| | rms command | chatter |";

/// Returns the table of `docs/controllers.md`: each figure in floating point, and bit-exact if the hardware has the
/// law.
fn table() -> String {
    let mut table = format!("{TITLE}\n|---|---|---|---|---|---|\n");
    for case in ControllerCase::ALL {
        let (float, exact) = (case.float(), case.bit_exact());
        let unit = if case.voltage_mode_h.is_some() { "V" } else { "A" };
        let cell = |of: fn(&ControllerFigures) -> f64, factor: f64, digits: usize| {
            let show = |figures: &ControllerFigures| format!("{:.digits$}", of(figures) * factor);
            match &exact {
                Some(exact) => format!("{}; {}", show(&float), show(exact)),
                None => show(&float),
            }
        };
        let row = [
            case.name.to_owned(),
            format!("{} µm", cell(|figures| figures.error_peak, 1e6, 1)),
            format!("{} µm", cell(|figures| figures.error_rms, 1e6, 1)),
            format!("{} mm/s", cell(|figures| figures.rate_peak, 1e3, 1)),
            format!("{} {unit}", cell(|figures| figures.command_rms, 1.0, 3)),
            format!("{} {unit}/s", cell(|figures| figures.chatter, 1.0, 0)),
        ];
        table += &format!("| {} |\n", row.join(" | "));
    }
    table
}

#[test]
fn golden_controller_tables_are_what_the_runs_say() -> Result<(), Box<dyn Error>> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/controllers.md");
    let committed = std::fs::read_to_string(&file)?;
    let (before, rest) = committed.split_once(TITLE).ok_or("docs/controllers.md has no table")?;
    let (_, after) = rest.split_once("\n\n").ok_or("nothing behind the table")?;
    let derived = format!("{before}{}\n{after}", table());
    if std::env::var_os("POSICAST_REGENERATE").is_some() {
        std::fs::write(&file, derived)?;
    } else {
        assert!(
            committed == derived,
            "docs/controllers.md is not what the runs say; if the change is meant: scripts/regenerate"
        );
    }
    Ok(())
}
