//! Where a firmware cannot take a design, the one of its own shapers that leaves least is found, and written on request.

use super::readers::{self, OfKlipper};
use super::{designed, export, mode, printer, refused, residual};
use crate::cli::support::scratch;
use posicast_shaper::analysis::WeightedMode;
use posicast_shaper::firmware::closest::{OwnKind, closest};
use posicast_shaper::firmware::klipper::{EiFormulas, Kind, impulses};
use posicast_shaper::impulse::ImpulseSequence;
use posicast_shaper::mode::Mode;

/// Two modes that were measured on a printer: frequency, damping ratio, share of the tool's motion.
const MODES: [(f64, f64, f64); 2] = [(38.7002, 0.0500062, 0.61541), (71.4997, 0.0399798, 0.38459)];

fn two_modes() -> String {
    MODES
        .map(|(frequency_hz, damping, share)| format!("{}\nparticipation = {share}\n", mode(frequency_hz, damping)))
        .concat()
}

/// What impulses leave of the ringing after a jump of the acceleration, p·a/ω² per mode, with each mode anywhere within ±5 %.
fn left(impulses: &[[f64; 2]]) -> f64 {
    let weight = |(frequency_hz, _, share): (f64, f64, f64)| share / frequency_hz.powi(2);
    let worst = |(frequency_hz, damping, _): (f64, f64, f64)| {
        (-100..=100)
            .map(|step| residual(impulses, frequency_hz * (1.0 + 0.0005 * f64::from(step)), damping))
            .fold(0.0, f64::max)
    };
    let rest: f64 = MODES.iter().map(|mode| weight(*mode) * worst(*mode)).sum();
    rest / MODES.iter().map(|mode| weight(*mode)).sum::<f64>()
}

/// The figures of Klipper's kinds at its default damping ratio, which its own code gives on a grid of 0.2 Hz: 2hump_ei at 58.4 Hz leaves 4.5 %,
/// mzv at 38.6 Hz 9.7 %.
#[test]
fn the_search_finds_the_best_frequency_of_klippers_kinds() {
    let kinds = [Kind::TwoHumpEi, Kind::Mzv];
    let candidates = kinds.map(|kind| OwnKind {
        name: kind.text(),
        damping: [0.0, 0.3],
        frequency_hz: [1.0, 1000.0],
        impulses: Box::new(move |frequency_hz, damping| impulses(kind, EiFormulas::Fits, frequency_hz, damping)),
    });
    let modes = MODES.map(|(frequency_hz, damping, participation)| WeightedMode {
        mode: Mode { frequency_hz, damping },
        participation,
    });
    let found = closest(&candidates, &[modes.to_vec()], Some(0.1));
    let names: Vec<&str> = found
        .iter()
        .map(|of_kind| candidates[of_kind.candidate].name.as_str())
        .collect();
    assert_eq!(names, ["2hump_ei", "mzv"]);
    let pairs = |impulses: &ImpulseSequence| -> Vec<[f64; 2]> {
        impulses.impulses().iter().map(|i| [i.time_s, i.amplitude]).collect()
    };
    for (of_kind, (frequency_hz, percent)) in found.iter().zip([(58.4, 4.5), (38.6, 9.7)]) {
        let make = &candidates[of_kind.candidate].impulses;
        let theirs = left(&pairs(&make(frequency_hz, 0.1).unwrap()));
        assert!((100.0 * theirs - percent).abs() < 0.05, "{theirs}");
        // A finer grid finds at least as much.
        assert!(
            (of_kind.frequency_hz - frequency_hz).abs() < 0.21 && of_kind.left < theirs + 1e-5,
            "{of_kind:?}"
        );
        assert!(
            (left(&pairs(&of_kind.impulses)) - of_kind.left).abs() < 1e-4,
            "{of_kind:?}"
        );
        for offset in [-1.0, -0.5, 0.5, 1.0] {
            let near = make(of_kind.frequency_hz + offset, 0.1).unwrap();
            assert!(left(&pairs(&near)) >= of_kind.left - 1e-4, "{offset}");
        }
    }
    // With the damping ratio free, less is left.
    let free = closest(&candidates, &[modes.to_vec()], None);
    assert!(free[0].left < 0.03 && free[0].damping > 0.02, "{:?}", free[0]);
}

/// The percentage before a word.
fn percent_before(text: &str, words: &str) -> f64 {
    let before = text.split(words).next().unwrap();
    before
        .rsplit(' ')
        .next()
        .unwrap()
        .parse()
        .unwrap_or_else(|_| panic!("{words}: {text}"))
}

#[test]
fn cli_two_modes_on_klipper_get_the_kind_that_covers_both() {
    let (_folder, machine) = scratch(&printer(&[("x", "kind = \"zv\"", &two_modes())]));
    let said = refused(&machine, &["--to", "klipper", "--firmware-version", "2026-03-31"]);
    assert!(said.contains("one mode per axis, and this axis has 2"), "{said}");
    assert!(
        said.contains("2hump_ei at 58.4 Hz, damping ratio 0.1: leaves 4.5 %"),
        "{said}"
    );
    let design = left(&designed(&machine, 0));
    let of_design = said.split("the design would leave ").nth(1).unwrap();
    assert!(
        (percent_before(of_design, " %") - 100.0 * design).abs() < 0.06,
        "{said}"
    );

    // What is written leaves what was said.
    let text = export(
        &machine,
        &["--to", "klipper", "--firmware-version", "2026-03-31", "--closest"],
    );
    let options = readers::config(&text);
    let (kind, number) = (&options["shaper_type_x"], |key: &str| {
        options[key].parse::<f64>().unwrap()
    });
    let kind = Kind::NAMED.into_iter().find(|of| of.text() == *kind).unwrap();
    let written = impulses(
        kind,
        EiFormulas::Fits,
        number("shaper_freq_x"),
        number("damping_ratio_x"),
    )
    .unwrap();
    let pairs: Vec<[f64; 2]> = written.impulses().iter().map(|i| [i.time_s, i.amplitude]).collect();
    let said = text.split("acceleration: ").nth(1).unwrap();
    assert!(
        (percent_before(said, " % with every mode") - 100.0 * left(&pairs)).abs() < 0.06,
        "{text}"
    );
    assert!(left(&pairs) < 0.03, "{text}");
}

#[test]
fn cli_two_modes_on_other_firmware() {
    let (_folder, machine) = scratch(&printer(&[("x", "kind = \"zv\"", &two_modes())]));
    // Kalico's branch and RepRapFirmware take the impulses of two zv.
    let kalico = export(&machine, &["--to", "kalico"]);
    let OfKlipper::Impulses(impulses) = readers::klipper(&kalico, "x", "new") else {
        panic!("{kalico}");
    };
    for (frequency_hz, damping, _) in MODES {
        assert!(residual(&impulses, frequency_hz, damping) < 1e-9, "{kalico}");
        let reprap = export(&machine, &["--to", "reprapfirmware"]);
        assert!(
            residual(&readers::reprapfirmware(&reprap, true), frequency_hz, damping) < 1e-3,
            "{reprap}"
        );
    }
    for format in ["marlin", "marlin-ft"] {
        assert!(refused(&machine, &["--to", format]).contains("one mode per axis"));
        let text = export(&machine, &["--to", format, "--closest"]);
        let found = match format {
            "marlin" => readers::m593(&text, 'X'),
            _ => readers::m493(&text, 'X', 2),
        };
        let said = text.split("acceleration: ").nth(1).unwrap();
        assert!(
            (percent_before(said, " % with every mode") - 100.0 * left(&found)).abs() < 0.06,
            "{text}"
        );
    }
    // Three impulses for each of two modes are too many.
    let (_folder, zvd) = scratch(&printer(&[("x", "kind = \"zvd\"", &two_modes())]));
    for format in ["kalico", "reprapfirmware"] {
        let said = refused(&zvd, &["--to", format]);
        assert!(
            said.contains("impulses, and this shaper has 9") && said.contains("taps = 5"),
            "{said}"
        );
        assert!(export(&zvd, &["--to", format, "--closest"]).contains("leaves least"));
    }
    // An optimal shaper with few taps goes to both.
    let bands = two_modes().replace("participation", "frequency_band = 0.03\nparticipation");
    let (_folder, optimal) = scratch(&printer(&[("x", "kind = \"optimal\"\ntaps = 5", &bands)]));
    let design = designed(&optimal, 0);
    for (format, found) in [
        ("kalico", {
            let text = export(&optimal, &["--to", "kalico"]);
            match readers::klipper(&text, "x", "new") {
                OfKlipper::Impulses(impulses) => impulses,
                OfKlipper::Smoother(_) => panic!("{text}"),
            }
        }),
        (
            "reprapfirmware",
            readers::reprapfirmware(&export(&optimal, &["--to", "reprapfirmware"]), true),
        ),
    ] {
        for (frequency_hz, damping, _) in MODES {
            let change = residual(&found, frequency_hz, damping) - residual(&design, frequency_hz, damping);
            assert!(change.abs() < 1e-3, "{format}: {change}");
        }
    }
}

#[test]
fn cli_axes_that_share_reprapfirmwares_shaper_get_one_for_both() {
    let axes = [
        ("x", "kind = \"mzv\"", mode(52.4, 0.06)),
        ("y", "kind = \"mzv\"", mode(41.0, 0.05)),
    ];
    let axes = axes
        .each_ref()
        .map(|(name, shaper, modes)| (*name, *shaper, modes.as_str()));
    let (_folder, machine) = scratch(&printer(&axes));
    let said = refused(&machine, &["--to", "reprapfirmware"]);
    assert!(
        said.contains("axis `y`: RepRapFirmware has one shaper for all axes"),
        "{said}"
    );
    let text = export(&machine, &["--to", "reprapfirmware", "--closest"]);
    let found = readers::reprapfirmware(&text, true);
    for (frequency_hz, damping) in [(52.4, 0.06), (41.0, 0.05)] {
        assert!(residual(&found, frequency_hz, damping) < 0.06, "{text}");
    }
}
