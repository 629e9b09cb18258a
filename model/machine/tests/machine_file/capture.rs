//! `[capture]`: values, defaults, what the hardware gets, and what is refused with which message.

use posicast_blocks::stage::StageCapture;
use posicast_machine::hardware::Hardware;
use posicast_machine::machine_file::{CaptureEdge, CaptureSection};
use posicast_machine::plan::design_machine;

use super::files::{right, wrong};

const XY: &str = include_str!("../../../../examples/xy-stage.toml");

#[test]
fn edge_and_filter_reach_the_hardware() {
    let machine = right(&format!("{XY}\n[capture]\nedge = \"falling\"\nfilter_s = 1.01e-6\n"));
    let design = design_machine(&machine).unwrap();
    let hardware = Hardware::of(&machine, &design).unwrap();
    let stage = hardware.stage().unwrap().unwrap();
    let expected = StageCapture {
        filter_clocks: 51,
        rises: false,
        falls: true,
    };
    assert_eq!(stage.of_machine.config.capture, Some(expected));
}

#[test]
fn an_empty_table_captures_rising_edges_of_a_clock() {
    let machine = right(&format!("{XY}\n[capture]\n"));
    let expected = CaptureSection {
        edge: CaptureEdge::Rising,
        filter_s: 0.0,
    };
    assert_eq!(machine.capture, Some(expected));
    assert_eq!(expected.filter_clocks(&machine.clock), 1);
    assert_eq!(right(XY).capture, None);
}

#[test]
fn a_capture_that_cannot_be_built_is_refused() {
    let refused = |text: &str, expected: &str| {
        let error = wrong(text).to_string();
        assert!(error.contains(expected), "{error}");
    };
    refused(
        &format!("{XY}\n[capture]\nfilter_s = 0.01\n"),
        "at most 1.311 ms, 65535 clocks",
    );
    refused(&format!("{XY}\n[capture]\nedge = \"up\"\n"), "capture.edge");
    // A machine of shapers alone has no count.
    let shapers = include_str!("../../../../examples/varying-load.toml");
    refused(&format!("{shapers}\n[capture]\n"), "which lacks a part of its loop");
    let inline = include_str!("../../../../examples/inline.toml");
    refused(&format!("{inline}\n[capture]\n"), "which has an input");
}
