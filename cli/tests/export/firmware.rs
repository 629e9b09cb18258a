//! Each firmware reads the impulses of the design: for every kind that it takes, with six damping ratios.

use super::readers::{self, OfKlipper};
use super::{DAMPINGS, designed, export, mode, printer, residual};
use crate::cli::support::scratch;
use posicast_shaper::firmware::klipper::{EiFormulas, Kind, impulses};

const HZ: f64 = 52.4;

/// Two damping ratios a machine: the fewest runs of the command.
fn pairs() -> impl Iterator<Item = [f64; 2]> {
    DAMPINGS.chunks(2).map(|pair| [pair[0], pair[1]])
}

/// Exports a kind for each damping ratio, and compares what the reader's impulses leave at the mode with what the design leaves.
fn compare(words: &[&str], kinds: &[&str], allowed: f64, read: impl Fn(&str, &str, f64) -> f64) {
    for kind in kinds {
        for dampings in pairs() {
            let shaper = format!("kind = \"{kind}\"");
            let [x, y] = dampings.map(|damping| mode(HZ, damping));
            let (_folder, machine) = scratch(&printer(&[("x", &shaper, &x), ("y", &shaper, &y)]));
            let text = export(&machine, words);
            for (index, axis) in ["x", "y"].into_iter().enumerate() {
                let damping = dampings[index];
                let design = residual(&designed(&machine, index), HZ, damping);
                let found = read(&text, axis, damping);
                assert!(
                    (found - design).abs() <= allowed,
                    "{words:?} {kind} {damping}: {found} instead of {design}\n{text}"
                );
            }
        }
    }
}

fn of_klipper(version: &'static str) -> impl Fn(&str, &str, f64) -> f64 {
    move |text, axis, damping| match readers::klipper(text, axis, version) {
        OfKlipper::Impulses(impulses) => residual(&impulses, HZ, damping),
        OfKlipper::Smoother(smoother) => smoother.residual(HZ, damping),
    }
}

const EXACT: [&str; 3] = ["zv", "zvd", "mzv"];
const EI: [&str; 3] = ["ei", "two-hump-ei", "three-hump-ei"];

/// What an output says that the firmware leaves at the mode of an axis, in percent.
fn said_to_leave(text: &str, axis: usize) -> f64 {
    let line = text
        .lines()
        .filter(|line| line.contains("it leaves "))
        .nth(axis)
        .unwrap();
    let (_, said) = line.split_once("it leaves ").unwrap();
    said.split(' ').next().unwrap().parse().unwrap()
}

#[test]
fn cli_klipper_has_the_residual_of_the_design() {
    compare(&["--to", "klipper"], &EXACT, 1e-9, of_klipper("new"));
    // Its fits of the EI kinds are within 0.6 % of the command.
    compare(&["--to", "klipper"], &EI, 0.006, of_klipper("new"));
}

#[test]
fn cli_kalico_and_the_advanced_branch_have_the_residual_of_every_kinds_design() {
    for words in [
        ["--to", "kalico", "--firmware-version", "bleeding-edge"],
        ["--to", "klipper", "--firmware-version", "advanced-features"],
    ] {
        // The impulses themselves.
        let kinds = [
            "zv",
            "zvd",
            "zvdd",
            "zvddd",
            "mzv",
            "ei",
            "two-hump-ei",
            "three-hump-ei",
            "um-zv",
            "ps-zv",
            "ps-zvd",
        ];
        compare(&words, &kinds, 1e-9, of_klipper("new"));
    }
}

#[test]
fn cli_kalico_takes_smooth_kinds_as_polynomials_that_leave_as_little() {
    let kinds = [
        "smooth_zv",
        "smooth_mzv",
        "smooth_ei",
        "smooth_zvd",
        "smooth_si",
        "smooth_zvd_ei",
        "smooth_2hump_ei",
    ];
    // The design is sampled, which costs up to 0.1 % in the longest kernels.
    compare(&["--to", "kalico"], &kinds, 0.002, of_klipper("new"));
}

#[test]
fn cli_older_klipper_and_kalicos_main_report_the_residual_of_their_ei_kinds() {
    for (words, version) in [
        (["--to", "klipper", "--firmware-version", "0.12"], "old"),
        (["--to", "kalico", "--firmware-version", "main"], "old"),
        (["--to", "klipper", "--firmware-version", "2026-03-30"], "lost"),
    ] {
        compare(&words, &EXACT, 1e-9, of_klipper(version));
        for kind in EI {
            for dampings in pairs() {
                let shaper = format!("kind = \"{kind}\"");
                let [x, y] = dampings.map(|damping| mode(HZ, damping));
                let (_folder, machine) = scratch(&printer(&[("x", &shaper, &x), ("y", &shaper, &y)]));
                let text = export(&machine, &words);
                for (axis, damping) in ["x", "y"].into_iter().zip(dampings) {
                    let found = 100.0 * of_klipper(version)(&text, axis, damping);
                    let said = said_to_leave(&text, usize::from(axis == "y"));
                    assert!(
                        (found - said).abs() < 6e-4,
                        "{words:?} {kind} {damping}: {found} %\n{text}"
                    );
                }
            }
        }
    }
}

#[test]
fn cli_reprapfirmware_has_the_residual_of_the_design() {
    let kinds = [
        "zv",
        "zvd",
        "zvdd",
        "zvddd",
        "mzv",
        "ei",
        "two-hump-ei",
        "three-hump-ei",
    ];
    for kind in kinds {
        for damping in DAMPINGS {
            let (_folder, machine) = scratch(&printer(&[("x", &format!("kind = \"{kind}\""), &mode(HZ, damping))]));
            let design = residual(&designed(&machine, 0), HZ, damping);
            for (version, from_3_6) in [("3.5", false), ("3.6", true)] {
                let text = export(&machine, &["--to", "reprapfirmware", "--firmware-version", version]);
                let found = residual(&readers::reprapfirmware(&text, from_3_6), HZ, damping);
                // Times are rounded to 1.33 µs.
                assert!(
                    (found - design).abs() < 3e-4,
                    "{kind} {damping} {version}: {found} instead of {design}\n{text}"
                );
            }
        }
    }
}

#[test]
fn cli_marlins_m593_has_the_residual_of_the_design_up_to_its_rounding() {
    // Half of 1/128, twice: in the first and in the second amplitude.
    compare(&["--to", "marlin"], &["zv"], 1.0 / 128.0, |text, axis, damping| {
        residual(
            &readers::m593(text, axis.to_uppercase().chars().next().unwrap()),
            HZ,
            damping,
        )
    });
}

#[test]
fn cli_fixed_time_motion_reports_the_residual_of_its_samples() {
    let kinds = [
        "zv",
        "zvd",
        "zvdd",
        "zvddd",
        "mzv",
        "ei",
        "two-hump-ei",
        "three-hump-ei",
    ];
    for (version, number) in [("2", 2), ("1", 1)] {
        for kind in kinds {
            for dampings in pairs() {
                // 50 Hz without damping is on the samples; 52.4 Hz is not.
                let shaper = format!("kind = \"{kind}\"");
                let [x, y] = dampings.map(|damping| mode(HZ, damping));
                let (_folder, machine) = scratch(&printer(&[("x", &shaper, &x), ("y", &shaper, &y)]));
                let text = export(&machine, &["--to", "marlin-ft", "--firmware-version", version]);
                for (index, (axis, damping)) in ['X', 'Y'].into_iter().zip(dampings).enumerate() {
                    let found = 100.0 * residual(&readers::m493(&text, axis, number), HZ, damping);
                    let said = said_to_leave(&text, index);
                    assert!((found - said).abs() < 6e-4, "{kind} {damping}: {found} %\n{text}");
                }
            }
        }
    }
    // Where half a period is whole samples, the design is what is left.
    let (_folder, machine) = scratch(&printer(&[("x", "kind = \"zvd\"", &mode(50.0, 0.0))]));
    let text = export(&machine, &["--to", "marlin-ft"]);
    // The least damping ratio that it takes is 0.01.
    assert!(residual(&readers::m493(&text, 'X', 2), 50.0, 0.0) < 1e-3, "{text}");
}

#[test]
fn our_klipper_is_klippers_own() {
    let text = include_str!("klipper.txt");
    let mut compared = 0;
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        let words: Vec<&str> = line.split(' ').collect();
        let formulas = match words[0] {
            "new" => EiFormulas::Fits,
            "old" => EiFormulas::Classic,
            _ => EiFormulas::FitsWithoutCubes,
        };
        let kind = match words[1] {
            "ei(v_tol=0.1)" => Kind::EiOf { tolerance: 0.1 },
            "ei(v_tol=0.02)" => Kind::EiOf { tolerance: 0.02 },
            name if name.starts_with("mzv(") => {
                let (n, t) = name["mzv(n=".len()..].trim_end_matches(')').split_once(",t=").unwrap();
                Kind::MzvOf {
                    impulses: n.parse().unwrap(),
                    periods: t.parse().unwrap(),
                }
            }
            name => *Kind::NAMED.iter().find(|kind| kind.text() == name).unwrap(),
        };
        assert_eq!(kind.text(), words[1]);
        let damping: f64 = words[2].parse().unwrap();
        let theirs = readers::klippers_own(words[0], words[1], damping).unwrap();
        let ours = impulses(kind, formulas, 50.0, damping).unwrap();
        assert_eq!(ours.impulses().len(), theirs.len(), "{line}");
        for (ours, [time, amplitude]) in ours.impulses().iter().zip(theirs) {
            assert!(
                (ours.time_s - time).abs() < 1e-9 && (ours.amplitude - amplitude).abs() < 1e-9,
                "{line}: {ours:?}"
            );
        }
        compared += 1;
    }
    assert_eq!(compared, 96);
}
