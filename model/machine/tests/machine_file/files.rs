//! The files that the tests read and modify.

use posicast_machine::machine_file::{self, Machine, SpecError};
use posicast_shaper::design::kind::ShaperKind;

pub(crate) const XY_STAGE: &str = include_str!("../../../../examples/xy-stage.toml");
pub(crate) const GANTRY: &str = include_str!("../../../../examples/gantry.toml");
pub(crate) const ROBOT_JOINT: &str = include_str!("../../../../examples/robot-joint.toml");
pub(crate) const CUSTOM_SHAPER: &str = include_str!("../../../../examples/custom-shaper.toml");
pub(crate) const CONTOURING_STAGE: &str = include_str!("../../../../examples/contouring-stage.toml");
/// A file with the whole schema, every optional key included.
pub(crate) const EVERYTHING: &str = include_str!("everything.toml");

/// A valid file of one axis, one key per line, which the tests change in one place each.
pub(crate) const SMALL: &str = r#"name = "slide"
[clock]
frequency_hz = 50_000_000
sample_hz = 10_000
[fixed_point]
command_bits = 32
[[axis]]
name = "x"
counts_per_unit = 1_000_000
[axis.shaper]
kind = "zvd"
[[axis.mode]]
frequency_hz = 40.0
damping = 0.1
"#;

/// Returns the names of some kinds, as messages list them.
pub(crate) fn kinds(wanted: impl Fn(ShaperKind) -> bool) -> String {
    let kinds = ShaperKind::ALL.iter().filter(|kind| wanted(**kind));
    kinds.map(|kind| kind.name()).collect::<Vec<_>>().join(", ")
}

/// Returns the machine of a valid file.
pub(crate) fn right(text: &str) -> Machine {
    machine_file::parse("m.toml", text).unwrap_or_else(|error| panic!("{error}"))
}

/// Returns the error of an invalid file.
pub(crate) fn wrong(text: &str) -> SpecError {
    machine_file::parse("m.toml", text).expect_err("the file is wrong")
}

/// Replaces `from` by `to` in the small file, and expects one problem, with this plain text and a remedy.
#[track_caller]
pub(crate) fn breaks(from: &str, to: &str, expected: &str) {
    assert_eq!(SMALL.matches(from).count(), 1, "{from} stands in the small file once");
    let error = wrong(&SMALL.replace(from, to));
    assert_eq!(error.to_string(), expected);
    assert_eq!(error.problems().len(), 1);
    assert!(!error.problems()[0].remedy.is_empty());
}
