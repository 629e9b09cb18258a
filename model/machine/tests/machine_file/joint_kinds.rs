//! What a kind that treats all modes together leaves to its modes.

use crate::machine_file::files::{SMALL, right, wrong};

#[test]
fn simultaneous_leaves_its_modes_zv_or_zvd() {
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
