//! Two copies of a block, in any two states, are equal after a reset; without the reset of one register they are not.
//!
//! The example `unset` covers all blocks, in `scripts/verify-all`.

use posicast_hdl::emit::Module;
use posicast_ladder::netlist::{EquivalenceVerdict, NetlistParts};
use posicast_ladder::unset::{RESET_CLOCKS, independent};
use posicast_testbench::blocks::library;
use posicast_testbench::named_mutant::NamedMutant;
use std::time::Duration;

fn modules(name: &str) -> (String, Vec<Module>) {
    let blocks = library().unwrap();
    let block = blocks.iter().find(|block| block.name() == name).unwrap();
    (block.top(), block.modules().unwrap())
}

fn verdict(top: &str, modules: Vec<Module>) -> EquivalenceVerdict {
    let folder = tempfile::tempdir().unwrap();
    independent(top, &NetlistParts::of(modules), folder.path(), Duration::from_secs(60)).unwrap()
}

/// Plain registers, pins with synchronisers, and memories.
#[test]
fn long_netlist_nothing_from_before_the_reset_is_shown() {
    for name in ["divider", "pulse_counter", "setting_banks"] {
        let (top, modules) = modules(name);
        assert_eq!(verdict(&top, modules), EquivalenceVerdict::Equivalent, "{name}");
    }
}

#[test]
fn netlist_a_register_without_reset_is_found() {
    let (top, modules) = modules("divider");
    let without_reset = NamedMutant {
        name: "a register without reset",
        module: None,
        from: "        saturated_q <= 1'd0;\n",
        to: "",
    };
    let wrong = without_reset.put_into(&modules).unwrap();
    assert_eq!(
        verdict(&top, wrong),
        EquivalenceVerdict::Different { clock: RESET_CLOCKS }
    );
}
