//! An axis with an absolute encoder: what is wired otherwise than with A, B and index, and its registers.

use super::axis::{Nets, on};
use super::config::StageAbsolute;
use super::registers::with_the_drive_off;
use crate::absolute_encoder::AbsoluteProtocol;
use crate::composition::Part;
use crate::registers::{Access, Field, Register};

/// Input pins of the encoder, in place of A, B and index.
pub(super) const INPUT_PINS: [&str; 1] = ["encoder_data"];
/// Output pins of the encoder.
pub(super) const OUTPUT_PINS: [&str; 1] = ["encoder_clock"];
/// Pins that the axis does not have.
pub(super) const LACKS_PINS: [&str; 3] = ["a", "b", "z"];
/// Nets from the stage and to it that the axis does not have: its velocity is not divided.
pub(super) const LACKS_NETS: [&str; 5] = ["edge_stamp", "quotient", "quotient_valid", "steps", "elapsed"];
/// The interrupt that the axis does not have.
pub(super) const LACKS_INTERRUPT: &str = "index_seen";
/// Net of the start of the controller.
pub(super) const CONTROL: &str = "encoder_control";
/// Net of the position that belongs to the tick.
pub(super) const POSITION: &str = "count";

const ENCODER: Nets = &[
    ("data", "encoder_data"),
    ("clock_out", "encoder_clock"),
    ("clear_flags", "clear_sources"),
    ("count", "encoder_reading"),
    ("valid", "encoder_valid"),
    ("known", "encoder_known"),
    ("extrapolated", "encoder_extrapolated"),
    ("busy", "encoder_busy"),
    ("lost", "encoder_lost"),
    ("check_failed", "encoder_check_failed"),
    ("silent", "encoder_silent"),
    ("stuck", "encoder_stuck"),
    ("error_bit", "encoder_error_bit"),
    ("warning_bit", "encoder_warning_bit"),
    ("jumped", "encoder_jumped"),
    ("overrun", "encoder_overrun"),
];

const FEEDBACK: Nets = &[
    ("reading", "encoder_reading"),
    ("reading_valid", "encoder_valid"),
    ("reading_known", "encoder_known"),
    ("offset", "encoder_offset"),
    ("invert", "encoder_invert"),
    ("clear_flags", "clear_sources"),
    ("position", "user_position"),
    ("start", CONTROL),
    ("lost", "encoder_lost"),
    ("ready", "encoder_ready"),
    // The axis is homed while its encoder says where it stands.
    ("placed", "homed"),
];

const AXIS: Nets = &[
    ("encoder_illegal", "encoder_lost"),
    // These are a tick old: the reading of a tick ends after it.
    ("captured_position", "watched_position"),
    ("homed", "written_homed"),
    ("drive_ready", "encoder_ready"),
];

/// Wires the encoder.
pub(super) fn encoder(part: Part) -> Part {
    on(part, ENCODER)
}

/// Wires the block that makes count and velocity of its readings.
pub(super) fn feedback(of: &StageAbsolute, part: Part) -> Part {
    let sign = of.encoder.frame().position_bits.min(32) - 1;
    on(part, FEEDBACK).tied("sign_bit", 1 << sign)
}

/// Wires the supervisor: a lost encoder is its `encoder_error`, and the host cannot home the axis.
pub(super) fn supervisor(part: Part) -> Part {
    on(part, AXIS)
        .tied("encoder_disagreement", 0)
        .tied("write_homed", 0)
        .tied("homed_value", 0)
}

/// Registers that only an axis with A, B and index has.
const LACKS_REGISTERS: [&str; 7] = [
    "index",
    "index_arm",
    "index_count",
    "homed",
    "generator",
    "generator_rate",
    "generated_count",
];

/// Fields that only an axis with A, B and index has.
const LACKS_FIELDS: [&str; 7] = [
    "level_a",
    "level_b",
    "level_z",
    "index_armed",
    "encoder_illegal",
    "encoder_disagreement",
    "illegal_count",
];

/// The registers of an axis with an absolute encoder, made from those of an axis with A, B and index.
pub(super) fn registers(of: &StageAbsolute, mut all: Vec<Register>) -> Vec<Register> {
    all.retain(|register| !LACKS_REGISTERS.contains(&register.name.as_str()));
    for register in &mut all {
        register
            .fields
            .retain(|field| !LACKS_FIELDS.contains(&field.name.as_str()));
        match register.name.as_str() {
            "count" => {
                for field in &mut register.fields {
                    field.meaning = "position of the encoder less its offset, which is the loop's position".to_owned();
                }
                register.meaning.clone_from(&register.fields[0].meaning);
            }
            "status" => {
                for field in register.fields.iter_mut().filter(|field| field.name == "homed") {
                    field.meaning = "the encoder says where the axis stands".to_owned();
                }
            }
            "flags" => {
                let lost = "too many readings failed in a row; the next one after `CLEAR_FAULTS` places the axis anew";
                register.fields.push(Field::flag("encoder_lost", 8, lost));
            }
            _ => {}
        }
    }
    all.extend([velocity_filter(), offset(of), state(of)]);
    all
}

fn velocity_filter() -> Register {
    Register::new(
        "velocity_filter",
        0x20,
        Access::Configuration,
        "filter of the velocity",
        vec![Field::new(
            "smoothing",
            8,
            2,
            "k of the velocity's one-pole filter with coefficient 2^-k",
        )],
    )
}

fn offset(of: &StageAbsolute) -> Register {
    Register::new(
        "encoder_offset",
        0x23,
        with_the_drive_off(),
        "zero of the encoder; it acts when a reading places the axis: after a reset, and after a loss",
        vec![
            Field::new("encoder_offset", 0, 32, "reading at which the axis is at 0")
                .with_unit("counts")
                .with_reset(of.offset),
        ],
    )
}

fn state(of: &StageAbsolute) -> Register {
    let mut fields = vec![
        Field::flag("encoder_check_failed", 0, "CRC or parity of a frame was wrong"),
        Field::flag("encoder_silent", 1, "the encoder did not answer"),
        Field::flag(
            "encoder_stuck",
            2,
            "its line was low at a tick, or its frame never began",
        ),
        Field::flag("encoder_error_bit", 3, "a frame had its error bit set"),
        Field::flag("encoder_warning_bit", 4, "a frame had its warning bit set"),
        Field::flag(
            "encoder_jumped",
            5,
            "a reading was farther from the last one than `axis.limits` allows",
        ),
        Field::flag("encoder_overrun", 6, "a tick came during a reading"),
        Field::flag("encoder_known", 8, "now: a reading has said where the axis stands"),
        Field::flag(
            "encoder_extrapolated",
            9,
            "now: the last reading failed, and the count is continued",
        ),
    ];
    if of.encoder.protocol() == AbsoluteProtocol::BissC {
        let meaning = "now: delay of the line, from the second rising edge to the answer";
        fields.push(Field::new("line_delay", 16, 16, meaning).with_unit("clocks"));
    }
    Register::new(
        "encoder_state",
        0x34,
        Access::Live,
        "flags of the encoder, until `CLEAR_FAULTS`, and its state",
        fields,
    )
}
