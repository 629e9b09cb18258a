//! The bank's fast path compared with its step, inconsistent register maps, and parts that do not form a component.

use posicast_blocks::ClockedBlock;
use posicast_blocks::composition::{Composition, CompositionError, Part};
use posicast_blocks::divider::{self, DividerConfig};
use posicast_blocks::registers::{Access, Description, Field, FlagSource, MapError, RegisterBank, RegisterMap, maps};
use posicast_blocks::{Direction, Port};
use proptest::prelude::*;

fn description() -> Description {
    let flags = vec![
        Field::flag("fault", 0, "from outside"),
        Field::flag("partial_write", 1, "own").set_by(FlagSource::PartialWrite),
        Field::flag("commit_rejected", 2, "own").set_by(FlagSource::CommitRejected),
    ];
    let command = Access::Command {
        strobe: "start".to_owned(),
    };
    let commit = Access::Commit {
        tick: "tick".to_owned(),
    };
    Description::new("small", "A small one.", *b"TEST", (1, 0), vec![])
        .with("snapshot", 2, Access::Snapshot, "freezes", vec![])
        .with(
            "commit",
            3,
            commit,
            "applies",
            vec![Field::flag("commit_waits", 0, "waits")],
        )
        .with(
            "gain",
            4,
            Access::Staged,
            "at the tick",
            vec![Field::new("gain", 3, 9, "a gain")],
        )
        .with("start", 5, command, "begins", vec![])
        .with("flags", 6, Access::Sticky, "sticky", flags)
        .with_interrupts(8, vec![Field::flag("tick", 0, "a tick")])
        .with_shadowed(
            "position",
            12,
            13,
            "where",
            vec![Field::new("position", 0, 32, "counts").signed()],
        )
}

/// Returns what is wrong with the register map after `change`.
fn refused(change: impl FnOnce(&mut Description)) -> MapError {
    let mut description = description();
    change(&mut description);
    RegisterMap::new(description).unwrap_err()
}

fn fields<'a>(description: &'a mut Description, register: &str) -> &'a mut Vec<Field> {
    let found = description.registers.iter_mut().find(|r| r.name == register);
    &mut found.unwrap().fields
}

#[test]
fn descriptions_that_do_not_hold_together_are_refused() {
    assert!(RegisterMap::new(description()).is_ok());
    let words = |words| Access::Words {
        strobe: "entry_write".to_owned(),
        word: "entry_word".to_owned(),
        words,
    };
    let cases: [(MapError, &str); 16] = [
        (refused(|d| d.windows = 0), "1 to 5"),
        (refused(|d| d.windows = 6), "1 to 5"),
        (refused(|d| d.registers[4].access = words(3)), "2, 4"),
        (refused(|d| d.registers[4].access = words(4)), "free one of 0 to 255"),
        (refused(|d| d.registers[0].offset = 77), "begins with the constants"),
        (refused(|d| d.registers[4].offset = 5), "free one of 0 to 255"),
        (refused(|d| d.registers[4].offset = 256), "free one of 0 to 255"),
        (
            refused(|d| d.registers[4].name = "commit".to_owned()),
            "two registers `commit`",
        ),
        (
            refused(|d| fields(d, "gain")[0].name = "Gain".to_owned()),
            "cannot be a name",
        ),
        (
            refused(|d| fields(d, "gain")[0].name = "avs_read".to_owned()),
            "cannot be a name",
        ),
        (refused(|d| fields(d, "gain")[0].low = 24), "bits 24 to 32"),
        (refused(|d| fields(d, "gain")[0].width = 0), "bits 3 to 2"),
        (refused(|d| fields(d, "gain")[0].reset = 512), "the reset value"),
        (
            refused(|d| fields(d, "gain")[0].name = "start".to_owned()),
            "port `start`",
        ),
        (
            refused(|d| fields(d, "flags").truncate(2)),
            "`CommitRejected` is needed",
        ),
        (refused(|d| fields(d, "interrupt_enable")[0].low = 1), "the same fields"),
    ];
    for (error, expected) in cases {
        assert!(error.to_string().contains(expected), "{error}: {expected}");
    }
    let overlapping = refused(|d| fields(d, "gain").push(Field::new("more", 11, 2, "")));
    assert!(matches!(overlapping, MapError::Bits { .. }));
    let no_snapshot = refused(|d| d.registers.retain(|r| r.access != Access::Snapshot));
    assert!(matches!(no_snapshot, MapError::Missing { access: "snapshot", .. }));
    let dangling = refused(|d| {
        for register in &mut d.registers {
            if let Access::Shadow { of } = &mut register.access {
                "gain".clone_into(of);
            }
        }
    });
    assert!(matches!(dangling, MapError::Shadow { .. }));
}

#[test]
fn extreme_numbers_in_a_description_are_refused() {
    for value in [33, 1 << 31, u32::MAX] {
        refused(|d| fields(d, "gain")[0].low = value);
        refused(|d| fields(d, "gain")[0].width = value);
        refused(|d| fields(d, "gain")[0].minimum = value);
        refused(|d| d.registers[3].offset = value.max(256));
    }
}

#[test]
fn maps_of_the_components_hold_together() {
    let divider = DividerConfig::new(131_071).unwrap();
    assert!(RegisterMap::new(maps::pulse_counter(&divider, 63, false)).is_ok());
    assert!(RegisterMap::new(maps::sliding_mode(2, true)).is_ok());
}

fn parts() -> [Part; 2] {
    let ports = divider::ports();
    let second = ["quotient", "done", "busy", "saturated", "overrun"];
    let part = Part::new("second", &ports);
    let part = second
        .iter()
        .fold(part, |part, port| part.on(port, &format!("second_{port}")));
    [Part::new("first", &ports), part]
}

fn composed(parts: [Part; 2], outputs: &[&str]) -> Result<Composition, CompositionError> {
    let inputs = ["rst", "start", "steps", "elapsed", "clear_flags"];
    Composition::new(parts.to_vec(), &inputs, outputs)
}

#[test]
fn parts_that_make_no_whole_are_refused() {
    let [first, second] = parts();
    let both = |first: Part, second: Part| composed([first, second], &["quotient"]);
    assert!(both(first.clone(), second.clone()).is_ok());
    let errors = [
        both(first.clone(), Part::new("first", second.ports())).unwrap_err(),
        both(first.clone(), Part::new("second", second.ports())).unwrap_err(),
        both(first.clone(), second.clone().on("start", "nothing")).unwrap_err(),
        both(first.clone(), second.clone().on("strat", "start")).unwrap_err(),
        both(first.clone(), second.clone().on("elapsed", "quotient")).unwrap_err(),
        both(first.clone(), second.clone().tied("start", 2)).unwrap_err(),
        composed([first.clone(), second.clone()], &["steps"]).unwrap_err(),
        composed([first, second], &["nothing"]).unwrap_err(),
    ];
    let found: Vec<String> = errors.iter().map(ToString::to_string).collect();
    for (found, expected) in found.iter().zip([
        "two parts are called `first`",
        "driven by `second.quotient`",
        "nothing drives the net `nothing`",
        "no unconnected port `strat`",
        "other bits than the net `quotient`",
        "cannot be tied to 2",
        "`steps` cannot be a port of the whole",
        "`nothing` cannot be a port of the whole",
    ]) {
        assert!(found.contains(expected), "{found}: {expected}");
    }
}

/// Returns inputs of the small bank: a rare reset, the rest at random, held for some clocks.
fn traffic() -> impl Strategy<Value = Vec<(Vec<u64>, u64)>> {
    let inputs = (
        0u32..40,
        0u64..16,
        any::<bool>(),
        any::<bool>(),
        0u64..32,
        any::<u32>(),
        0u64..8,
        any::<u32>(),
    );
    let row = inputs.prop_map(|(reset, address, read, write, bytes, data, pins, position)| {
        let bytes = bytes.min(15);
        vec![
            u64::from(reset == 0),
            address,
            read.into(),
            write.into(),
            bytes,
            data.into(),
            pins & 1,
            pins >> 1 & 1,
            position.into(),
        ]
    });
    proptest::collection::vec((row, 0u64..50), 1..60)
}

proptest! {
    #[test]
    fn prop_holding_is_stepping(traffic in traffic()) {
        let map = RegisterMap::new(description()).unwrap();
        let names: Vec<&str> = map.ports().iter().filter(is_input).map(|port| port.name.as_str()).collect();
        prop_assert_eq!(&names[6..], ["tick", "fault", "position"]);
        let (mut stepped, mut held) = (RegisterBank::new(&map), RegisterBank::new(&map));
        let outputs = map.ports().len() - names.len();
        let (mut expected, mut actual) = (vec![0; outputs], vec![0; outputs]);
        for (inputs, clocks) in traffic {
            for _ in 0..clocks {
                stepped.step(&inputs, &mut expected).unwrap();
            }
            held.hold(&inputs, clocks).unwrap();
            stepped.step(&inputs, &mut expected).unwrap();
            held.step(&inputs, &mut actual).unwrap();
            prop_assert_eq!(&expected, &actual);
        }
    }
}

fn is_input(port: &&Port) -> bool {
    port.direction == Direction::Input
}
