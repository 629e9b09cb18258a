//! Blocks and kinds that this version knows and does not build.

use crate::files::{EVERYTHING, SMALL, breaks, built_kinds, right, wrong};
use posicast_model::design::kind::Kind;

#[test]
fn unit_what_is_not_built_is_refused_by_name_once_all_else_is_right() {
    let error = wrong(EVERYTHING);
    let lines: Vec<String> = error.to_string().lines().map(str::to_owned).collect();
    let blocks = [
        (37, "axis.scale of axis x", "scale"),
        (70, "axis.limits.following_error of axis x", "following_error"),
        (71, "axis.limits.brake_release_s of axis x", "brake_release_s"),
        (72, "axis.limits.brake_apply_s of axis x", "brake_apply_s"),
        (74, "axis.trace of axis x", "trace"),
        (77, "stage", "stage"),
    ];
    let expected = blocks.map(|(line, key, name)| format!("m.toml:{line}: {key}: not built in this version: {name}"));
    assert_eq!(lines, expected);
    assert_eq!(error.problems()[0].remedy, "leave the table [axis.scale] out");

    let also_wrong = wrong(&EVERYTHING.replace("damping = 0.157799065776", "damping = 2"));
    let expected = "m.toml:30: axis.mode.damping of axis x, mode 1: found 2; allowed: at least 0, below 1";
    assert_eq!(also_wrong.to_string(), expected);
}

#[test]
fn unit_a_kind_that_is_not_built_is_refused_by_name() {
    for (kind, name) in Kind::ALL.iter().filter(|(kind, _)| !kind.is_built()) {
        let expected = format!(
            "m.toml:11: axis.shaper.kind of axis x: not built in this version: {name}; allowed: {}",
            built_kinds(|_| true)
        );
        breaks("\"zvd\"", &format!("\"{kind}\""), &expected);
    }
}

#[test]
fn unit_blocks_that_are_not_built_are_checked_all_the_same() {
    let case = |from: &str, to: &str, expected: &str| {
        assert!(EVERYTHING.contains(from), "{from}");
        assert_eq!(wrong(&EVERYTHING.replace(from, to)).to_string(), expected);
    };
    case(
        "\"monitor\"",
        "\"both\"",
        "m.toml:39: axis.scale.use of axis x: found \"both\"; allowed: monitor, position",
    );
    case(
        "1024",
        "1000",
        "m.toml:75: axis.trace.samples of axis x: found 1000; allowed: 256, 512, 1024, 2048",
    );
    let expected = "m.toml:79: stage.contour_speed: found 0; allowed: above 0, at most 1000000000000";
    case("contour_speed = 0.1", "contour_speed = 0", expected);
    let expected = "m.toml:70: axis.limits.following_error of axis x: found the boolean true; allowed: a number, above 0, at \
                    most 1000000000";
    case("following_error = 0.001", "following_error = true", expected);
}

#[test]
fn unit_simultaneous_leaves_its_modes_zv_or_zvd() {
    let text = |own: &str| {
        SMALL
            .replace("\"zvd\"", "\"simultaneous\"")
            .replace("damping = 0.1", &format!("damping = 0.1\nshaper = \"{own}\""))
    };
    let expected = "m.toml:15: axis.mode.shaper of axis x, mode 1: found shaper = \"ei\" under kind = \"simultaneous\"; \
                    allowed: zv, zvd";
    assert_eq!(wrong(&text("ei")).to_string(), expected);
    right(&text("zvd"));
}
