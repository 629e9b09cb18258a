//! The position capture of the stage: its nets, its pin and its registers.

use super::config::{StageCapture, StageConfig};
use crate::capture::AXES;
use crate::composition::Part;
use crate::registers::{Access, Description, Field};

/// Pin of the line.
pub(super) const PIN: &str = "capture_line";
/// Interrupt of an entry: name, bit and meaning.
pub(super) const INTERRUPT: (&str, u32, &str) = ("captured", 30, "an edge of the capture was written");

/// Nets that have another name than the port.
const NETS: [(&str, &str); 23] = [
    ("line", PIN),
    ("filter_clocks", "capture_filter_clocks"),
    ("enable", "capture_enable"),
    ("rises", "capture_rises"),
    ("falls", "capture_falls"),
    ("stamp", "time_stamp"),
    ("windowed", "capture_windowed"),
    ("window_axis", "capture_window_axis"),
    ("window_first", "capture_window_first"),
    ("window_last", "capture_window_last"),
    ("take", "capture_take"),
    // One command forgets entries and flags.
    ("clear", "capture_clear"),
    ("clear_flags", "capture_clear"),
    ("level", "capture_level"),
    ("level_known", "capture_level_known"),
    ("entries", "capture_entries"),
    ("edges", "capture_edges"),
    ("entry_valid", "capture_valid"),
    ("entry_stamp", "capture_stamp"),
    ("entry_rising", "capture_rising"),
    ("overflowed", "capture_overflowed"),
    ("outside", "capture_outside"),
    ("captured", INTERRUPT.0),
];

/// Connects the block to the counts of the axes, in their order.
pub(super) fn wire(config: &StageConfig, part: Part) -> Part {
    let part = NETS.iter().fold(part, |part, (port, net)| part.on(port, net));
    (0..AXES).fold(part, |part, place| {
        let entry = part.on(&format!("entry_count_{place}"), &format!("capture_count_{place}"));
        match config.axes.get(place) {
            Some(axis) => entry.on(&format!("count_{place}"), &format!("{}_count", axis.name)),
            None => entry.tied(&format!("count_{place}"), 0),
        }
    })
}

/// Adds the registers, in words of the stage's own window.
pub(super) fn described(description: Description, of: &StageCapture, config: &StageConfig) -> Description {
    let count = |name: &str, meaning: &str| Field::new(name, 0, 32, meaning).signed().with_unit("counts");
    let window = |name: &str, meaning: &str| vec![count(name, meaning)];
    let described = description
        .with(
            "capture_control",
            0x50,
            Access::Configuration,
            "which edges of `capture_line` take the positions",
            vec![
                Field::flag("capture_enable", 0, "edges are counted and captured"),
                Field::flag("capture_rises", 1, "rising edges").with_reset(of.rises.into()),
                Field::flag("capture_falls", 2, "falling edges").with_reset(of.falls.into()),
                Field::flag("capture_windowed", 3, "only while an axis is in the window"),
                Field::new("capture_window_axis", 4, 2, "that axis, in the order of the windows"),
                Field::new(
                    "capture_filter_clocks",
                    16,
                    16,
                    "time for which the line must have a new level",
                )
                .with_unit("clocks")
                .with_reset(of.filter_clocks.into()),
            ],
        )
        .with(
            "capture_window_first",
            0x51,
            Access::Configuration,
            "lowest position in the window",
            window("capture_window_first", "in counts since reset"),
        )
        .with(
            "capture_window_last",
            0x52,
            Access::Configuration,
            "highest position in the window",
            window("capture_window_last", "in counts since reset"),
        )
        .with(
            "capture_take",
            0x53,
            Access::command("capture_take"),
            "drops the oldest entry",
            vec![],
        )
        .with(
            "capture_clear",
            0x54,
            Access::command("capture_clear"),
            "drops all entries, counts edges from 0, and clears the flags",
            vec![],
        )
        .with(
            "capture_state",
            0x55,
            Access::Live,
            "state of the capture; its flags stay until `CAPTURE_CLEAR`",
            vec![
                Field::new("capture_entries", 0, 5, "entries in the memory"),
                Field::flag("capture_valid", 8, "the oldest entry can be read"),
                Field::flag("capture_rising", 9, "the oldest entry: a rising edge"),
                Field::flag("capture_overflowed", 10, "an edge was lost: the memory was full"),
                Field::flag("capture_outside", 11, "an edge came outside the window"),
                Field::flag("capture_level", 12, "filtered line"),
                Field::flag("capture_level_known", 13, "the line has had a level since the reset"),
            ],
        )
        .with(
            "capture_edges",
            0x56,
            Access::Live,
            "wanted edges since `CAPTURE_CLEAR`, captured or not",
            vec![Field::new("capture_edges", 0, 32, "number of edges, modulo 2^32")],
        )
        .with(
            "capture_stamp",
            0x57,
            Access::Live,
            "the oldest entry: its time",
            vec![Field::new("capture_stamp", 0, 32, "value of `TIME_STAMP`").with_unit("clocks")],
        );
    let axes = config.axes.iter().enumerate();
    axes.fold(described, |described, (place, axis)| {
        let name = format!("capture_count_{place}");
        let meaning = format!("the oldest entry: count of axis {}", axis.name);
        let field = count(&name, "in counts since reset");
        described.with(&name, 0x58 + place as u32, Access::Live, &meaning, vec![field])
    })
}
