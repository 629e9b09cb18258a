//! Some blocks as netlists of logic elements: compared with their models, and proven equal to their RTL; and netlists
//! with a fault.
//!
//! The example `netlist` covers all blocks, in `scripts/verify-all`.

use std::time::Duration;

use posicast_hdl::emit::Module;
use posicast_ladder::netlist::{EquivalenceOutcome, EquivalenceVerdict, MappedParts, NetlistParts, check, simulate};
use posicast_synth::yosys::{CellNetlist, Family, Yosys};
use posicast_testbench::blocks::{Block, Sources, library};
use posicast_testbench::lockstep::report;

const CLOCKS: u64 = 20_000;

struct Mapped {
    block: Box<dyn Block>,
    parts: NetlistParts,
    netlist: CellNetlist,
}

impl Mapped {
    fn new(name: &str) -> Self {
        Self::to(Family::Cyclone4e, name, NetlistParts::of)
    }

    fn to(family: Family, name: &str, sorted: fn(Vec<Module>) -> NetlistParts) -> Self {
        let blocks = library().unwrap().into_iter();
        let block = blocks.into_iter().find(|block| block.name() == name).unwrap();
        let parts = sorted(block.modules().unwrap());
        let files = |modules| Sources::of_modules(modules).unwrap();
        let (logic, kept) = (files(&parts.logic), files(&parts.kept));
        let yosys = Yosys::installed().unwrap();
        let netlist = yosys.netlist(logic.files(), kept.files(), &block.top(), family);
        let netlist = netlist.unwrap();
        Self { block, parts, netlist }
    }

    fn mapped(&self) -> MappedParts<'_> {
        MappedParts {
            parts: &self.parts,
            netlist: &self.netlist.verilog,
        }
    }

    fn check(&self, clocks: u64) -> EquivalenceOutcome {
        let limit = Duration::from_secs(60);
        check(self.block.as_ref(), self.mapped(), self.mapped(), (clocks, 1), limit).unwrap()
    }

    /// Replaces the first `from` in the netlist by `to`.
    fn broken(mut self, from: &str, to: &str) -> Self {
        assert!(
            self.netlist.verilog.contains(from),
            "the netlist no longer has `{from}`: adapt the test"
        );
        self.netlist.verilog = self.netlist.verilog.replacen(from, to, 1);
        self
    }
}

/// The blocks have plain logic, carry chains, a chain whose carry-in is a signal, and a kept ROM and RAM.
#[test]
fn long_netlist_is_proven_equal_to_the_rtl() {
    for (name, kept) in [("group", 0), ("divider", 0), ("pwm", 0), ("setting_banks", 2)] {
        let mapped = Mapped::new(name);
        let outcome = mapped.check(0);
        assert_eq!(outcome.verdict, EquivalenceVerdict::Equivalent, "{name}: {outcome:?}");
        assert_eq!(outcome.kept, kept, "{name}");
        let CellNetlist { luts, flip_flops, .. } = mapped.netlist;
        assert!(luts > 5 && flip_flops > 5, "{name}: {luts}, {flip_flops}");
    }
}

#[test]
fn netlist_does_what_the_model_does() {
    let outcome = Mapped::new("group").check(CLOCKS);
    let report = outcome.simulated.unwrap();
    assert_eq!((report.result, report.cycles), (report::LockstepVerdict::Match, CLOCKS));
}

/// One look-up table is inverted, like by a fault of a mapper.
#[test]
fn netlist_with_a_wrong_table_is_found_by_simulation_and_proof() {
    let mapped = Mapped::new("group");
    let mask = mapped.netlist.verilog.split(".lut_mask(16'h").nth(1).unwrap();
    let mask: String = mask.chars().take(4).collect();
    let flipped = u16::from_str_radix(&mask, 16).unwrap() ^ 0xffff;
    let outcome = mapped
        .broken(
            &format!(".lut_mask(16'h{mask})"),
            &format!(".lut_mask(16'h{flipped:04x})"),
        )
        .check(CLOCKS);
    assert_eq!(outcome.simulated.unwrap().result, report::LockstepVerdict::Mismatch);
    assert!(
        matches!(outcome.verdict, EquivalenceVerdict::Different { clock } if clock < 5),
        "{:?}",
        outcome.verdict
    );
}

/// The netlist works from the first reset on, so only the proof, which begins at power-up, finds the fault.
#[test]
fn netlist_with_a_wrong_power_up_is_found_by_the_proof() {
    let outcome = Mapped::new("group")
        .broken(".power_up(\"low\")", ".power_up(\"high\")")
        .check(0);
    assert!(
        matches!(outcome.verdict, EquivalenceVerdict::Different { .. }),
        "{:?}",
        outcome.verdict
    );
}

/// The multipliers are those of the device; its flip-flops begin at 0, so those that begin at 1 are inverted.
#[test]
fn long_netlist_of_cyclone_v_does_what_the_model_does() {
    let mapped = Mapped::to(Family::Cyclone5, "sliding_mode", NetlistParts::with_multipliers_mapped);
    assert_eq!(mapped.netlist.multipliers, 2);
    let report = simulate(mapped.block.as_ref(), mapped.mapped(), CLOCKS, 1).unwrap();
    assert_eq!((report.result, report.cycles), (report::LockstepVerdict::Match, CLOCKS));
}

#[test]
fn netlist_of_cyclone_v_is_proven_equal_to_the_rtl() {
    let mapped = Mapped::to(Family::Cyclone5, "group", NetlistParts::of);
    assert_eq!(mapped.check(0).verdict, EquivalenceVerdict::Equivalent);
    let inverted = mapped.broken("64'h", "~64'h");
    let report = simulate(inverted.block.as_ref(), inverted.mapped(), CLOCKS, 1).unwrap();
    assert_eq!(report.result, report::LockstepVerdict::Mismatch);
}
