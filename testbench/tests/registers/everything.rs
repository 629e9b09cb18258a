//! A register map with every kind of access, and fields at every kind of position.

use posicast_blocks::registers::{Access, Description, Field, FlagSource, RegisterMap};

pub(crate) fn everything() -> RegisterMap {
    RegisterMap::new(description()).unwrap()
}

fn description() -> Description {
    use Access::{Configuration, Live, Snapshot, Staged, Sticky};
    let named = |name: &str| name.to_owned();
    Description::new(
        "everything",
        "One of each.",
        *b"TEST",
        (2, 7),
        vec![Field::new("size", 0, 12, "a parameter").with_reset(0xabc)],
    )
    .with_windows(2)
    .with("snapshot", 0x08, Snapshot, "freezes", vec![])
    .with(
        "commit",
        0x09,
        Access::Commit { tick: named("tick") },
        "applies",
        vec![Field::flag("commit_waits", 0, "waits")],
    )
    .with(
        "mode",
        0x10,
        Configuration,
        "some fields with gaps",
        vec![
            Field::new("mode", 0, 3, "crosses no byte").with_reset(5),
            Field::new("wide", 5, 13, "crosses two bytes").with_reset(0x1234),
            Field::flag("enabled", 31, "the last bit").with_reset(1),
        ],
    )
    .with(
        "whole",
        0x11,
        Configuration,
        "all bits",
        vec![Field::new("level", 0, 32, "signed").signed().with_reset(0x8000_0001)],
    )
    .with(
        "dead_time",
        0x12,
        Access::Guarded {
            while_low: named("running"),
        },
        "only when off",
        vec![
            Field::new("dead_clocks", 0, 10, "with a floor")
                .with_reset(30)
                .at_least(25),
            Field::new("pulse_clocks", 16, 12, "with a floor")
                .with_reset(7)
                .at_least(5),
        ],
    )
    .with(
        "polarity",
        0x13,
        Access::Guarded {
            while_low: named("running"),
        },
        "only when off",
        vec![Field::flag("polarity", 9, "one bit")],
    )
    .with(
        "gain",
        0x14,
        Staged,
        "at the tick",
        vec![
            Field::new("gain", 0, 18, "signed").signed().with_reset(0x3_fffe),
            Field::new("shift", 24, 5, "right"),
        ],
    )
    .with(
        "limit",
        0x15,
        Staged,
        "at the tick",
        vec![Field::new("limit", 0, 32, "all bits").fixed(16).with_reset(77)],
    )
    .with(
        "sample",
        0x18,
        Access::Command {
            strobe: named("sample_write"),
        },
        "a strobe with data",
        vec![
            Field::new("sample", 4, 16, "signed").signed(),
            Field::new("channel", 24, 2, "which"),
        ],
    )
    .with(
        "start",
        0x19,
        Access::Command { strobe: named("start") },
        "a strobe alone",
        vec![],
    )
    .with(
        "entry",
        0x24,
        Access::Words {
            strobe: named("entry_write"),
            word: named("entry_word"),
            words: 4,
        },
        "a strobe with data and the word's place",
        vec![Field::new("entry", 0, 32, "all bits")],
    )
    .with(
        "flags",
        0x1a,
        Sticky,
        "sticky",
        vec![
            Field::flag("fault", 0, "from outside"),
            Field::flag("overrun", 9, "from outside"),
            Field::flag("partial_write", 16, "own").set_by(FlagSource::PartialWrite),
            Field::flag("guard_refused", 17, "own").set_by(FlagSource::GuardRefused),
            Field::flag("commit_rejected", 18, "own").set_by(FlagSource::CommitRejected),
        ],
    )
    .with_interrupts(
        0x1c,
        vec![
            Field::flag("tick", 0, "a tick"),
            Field::flag("fault", 2, "from outside"),
            Field::flag("lost_write", 31, "own").set_by(FlagSource::PartialWrite),
        ],
    )
    .with(
        "status",
        0x20,
        Live,
        "levels",
        vec![Field::flag("running", 3, "on"), Field::flag("overrun", 4, "level")],
    )
    .with_shadowed(
        "position",
        0x21,
        0x31,
        "where",
        vec![Field::new("position", 0, 32, "counts").signed()],
    )
    .with_shadowed(
        "velocity",
        0x22,
        0x1ff,
        "how fast",
        vec![
            Field::new("velocity", 8, 20, "signed").signed(),
            Field::new("phase", 0, 6, "angle"),
        ],
    )
}
