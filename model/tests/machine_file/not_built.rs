//! Kinds that this version knows but does not build.

use crate::machine_file::files::{SMALL, breaks, built_kinds, right, wrong};
use posicast_model::design::kind::ShaperKind;

#[test]
fn unit_a_kind_that_is_not_built_is_refused_by_name() {
    for (kind, name) in ShaperKind::ALL.iter().filter(|(kind, _)| !kind.is_built()) {
        let expected = format!(
            "m.toml:11: axis.shaper.kind of axis x: not built in this version: {name}; allowed: {}",
            built_kinds(|_| true)
        );
        breaks("\"zvd\"", &format!("\"{kind}\""), &expected);
    }
}

#[test]
fn unit_what_is_not_built_is_said_once_all_else_is_right() {
    let both = SMALL
        .replace("\"zvd\"", "\"optimal\"")
        .replace("damping = 0.1", "damping = 2");
    let expected = "m.toml:14: axis.mode.damping of axis x, mode 1: found 2; allowed: at least 0, below 1";
    assert_eq!(wrong(&both).to_string(), expected);
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
