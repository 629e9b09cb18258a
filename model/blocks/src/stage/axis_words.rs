//! Registers of an axis that a host reads: its state, the causes of a fault, and positions and velocities.

use super::config::{StageAxis, StageScale};
use super::registers::with_the_drive_off;
use crate::axis::SupervisorState;
use crate::registers::{Access, Field, Register, tables};

/// The registers, in words of the axis's window.
pub(super) fn registers(axis: &StageAxis) -> Vec<Register> {
    [states(), read_back(axis), motion()].concat()
}

/// Registers of the linear scale of an axis: its direction, its count, and its deviation from the motor.
pub(super) fn of_scale(scale: &StageScale) -> Vec<Register> {
    let live = |name: &str, offset, meaning: &str| {
        let field = Field::new(name, 0, 32, meaning).signed().with_unit("counts");
        Register::new(name, offset, Access::Live, meaning, vec![field])
    };
    vec![
        Register::new(
            "scale_control",
            0x23,
            with_the_drive_off(),
            "direction of the scale",
            vec![Field::flag("scale_invert", 0, "reverses the scale's direction").with_reset(scale.invert.into())],
        ),
        live("scale_count", 0x3b, "steps of the scale since reset"),
        live(
            "deviation",
            0x3c,
            "deviation of the motor from the scale since HOLD, in counts of the loop",
        ),
    ]
}

/// Registers with which a host corrects missing steps.
pub(super) fn of_correction() -> Vec<Register> {
    vec![
        Register::new(
            "realign",
            0x44,
            Access::command("realign"),
            "the deviation counts from now on: a host corrects it by this many steps",
            vec![
                Field::new("realign_steps", 0, 16, "missing steps, up less down")
                    .signed()
                    .with_unit("counts"),
            ],
        ),
        Register::new(
            "corrected",
            0x45,
            Access::Live,
            "steps for which a host has written `REALIGN` since reset",
            vec![
                Field::new("corrected_steps", 0, 32, "corrected steps, up less down")
                    .signed()
                    .with_unit("counts"),
            ],
        ),
    ]
}

fn states() -> Vec<Register> {
    let names = SupervisorState::ALL.map(|state| (state as u32, state.name().to_lowercase(), state.meaning()));
    let states: Vec<_> = (names.iter())
        .map(|(value, name, meaning)| (*value, name.as_str(), *meaning))
        .collect();
    vec![
        Register::new(
            "status",
            0x28,
            Access::Live,
            "state of the axis",
            vec![
                Field::choice("state", 0, 3, "state of the supervisor", &states),
                Field::flag("can_start", 3, "a start would lead to RUN"),
                Field::new("segments_state", 4, 2, "0 hold, 1 move, 2 stop, 3 stopped"),
                Field::flag("direct_active", 6, "direct mode drives the outputs"),
                Field::flag("pwm_running", 7, "the PWM's outputs are on"),
                Field::flag("level_emergency_stop_n", 8, "filtered line: low is an emergency stop"),
                Field::flag("level_limit_plus_n", 9, "filtered line: low while on the switch"),
                Field::flag("level_limit_minus_n", 10, "filtered line: low while on the switch"),
                Field::flag("level_drive_ready", 11, "filtered line"),
                Field::flag("level_home", 12, "filtered line"),
                Field::flag("level_a", 13, "filtered A"),
                Field::flag("level_b", 14, "filtered B"),
                Field::flag("level_z", 15, "filtered Z"),
                Field::flag("swap_pending", 16, "a swap of tables waits, or hands over"),
                Field::new("table_bank", 17, 2, "the shaper's active bank"),
                Field::flag("index_armed", 19, "the next index will be latched"),
                Field::new(
                    "trip_causes",
                    20,
                    5,
                    "0 fault latch, 1 supervisor, 2 drive, 3 PLL, 4 PWM's watchdog",
                ),
                Field::flag(
                    "homed",
                    25,
                    "homed by `HOMED`; cleared when the encoder is lost or has an error",
                ),
                Field::flag("setting_read_waits", 26, "a read by `SETTING_READ` waits"),
                Field::flag("tap_read_waits", 27, "a read by `TAP_READ` waits"),
            ],
        ),
        Register::new(
            "causes",
            0x29,
            Access::Live,
            "causes of a fault, until `CLEAR_FAULTS`: see docs/axis.md",
            vec![Field::new("causes", 0, 17, "one bit per cause")],
        ),
        Register::new(
            "flags",
            0x2a,
            Access::Live,
            "flags of the blocks, until `CLEAR_FAULTS`",
            vec![
                Field::flag("segments_underrun", 0, "there was no entry while moving"),
                Field::flag(
                    "segments_overflow",
                    1,
                    "an acceleration or velocity did not fit its word",
                ),
                Field::flag(
                    "segments_tick_missed",
                    2,
                    "a tick came while another was being processed",
                ),
                Field::flag(
                    "segment_refused",
                    3,
                    "a word was written to a full FIFO, or in a quick stop",
                ),
                Field::flag("segment_malformed", 4, "an entry was dropped"),
                Field::flag("shaper_saturated", 5, "an output was clamped"),
                Field::flag("shaper_overrun", 6, "a sample came while another was being shaped"),
                Field::flag("table_refused", 7, "a tap or a swap was refused"),
                Field::flag("encoder_illegal", 8, "A and B changed together"),
                Field::flag("encoder_disagreement", 9, "the lines of a pair were equal"),
                Field::flag("velocity_missed", 10, "a tick had no new velocity"),
                Field::flag("controller_overrun", 11, "a start came during a computation"),
                Field::flag("limited_high", 12, "the last command was clamped at +limit"),
                Field::flag("limited_low", 13, "the last command was clamped at -limit"),
                Field::flag("pwm_saturated", 14, "a duty was limited"),
                Field::flag("pwm_unaligned", 15, "the PWM was not in phase with the tick"),
                Field::new("illegal_count", 16, 8, "illegal transitions; stops at 255"),
                Field::flag("segments_out_of_range", 24, "the command came near the end of its word"),
            ],
        ),
        Register::new(
            "events",
            0x2b,
            Access::Sticky,
            "events since the flag was cleared",
            vec![
                Field::flag("refused", 0, "a start was refused"),
                Field::flag(
                    "setting_refused",
                    1,
                    "a setting was refused: its bank is in use or cannot be loaded",
                ),
                Field::flag("direct_expired", 2, "direct mode ended because its time ran out"),
            ],
        ),
        Register::new(
            "saturations",
            0x2c,
            Access::Live,
            "values of the controller that were clamped, until `CLEAR_FAULTS`",
            vec![
                Field::new(
                    "controller_saturated_high",
                    0,
                    7,
                    "clamped at the upper end, from bit 0: e, de, s, feedback, integral, command, duty",
                ),
                Field::new(
                    "controller_saturated_low",
                    8,
                    7,
                    "clamped at the lower end, in the same order",
                ),
                Field::new("limited_ticks", 16, 16, "time since which the command has been clamped").with_unit("ticks"),
            ],
        ),
        Register::new(
            "fifo",
            0x2d,
            Access::Live,
            "level of the command FIFO",
            vec![
                Field::new("fifo_level", 0, 7, "waiting entries"),
                Field::flag("fifo_low", 8, "at most `low_water` entries wait"),
                Field::flag("segments_empty", 9, "none"),
                Field::flag("feed_held", 10, "a feed hold keeps the command where it rests"),
                Field::new("late_ticks", 16, 8, "time extrapolated since reset, modulo 2^8").with_unit("ticks"),
            ],
        ),
        Register::new(
            "self_test",
            0x2e,
            Access::Live,
            "on times of the PWM's gates in the last whole period of a self-test",
            vec![
                Field::new(
                    "self_test_high",
                    0,
                    16,
                    "on time of `a_high`, with its pin masked; stops at 65535",
                )
                .with_unit("clocks"),
                Field::new("self_test_low", 16, 16, "on time of `a_low`, likewise").with_unit("clocks"),
            ],
        ),
    ]
}

fn read_back(axis: &StageAxis) -> Vec<Register> {
    vec![tables::setting_loaded(0x3e), tables::tap_loaded(&axis.shaper, 0x3f)]
}

/// Live registers of positions and velocities, and shadows of position and velocity.
fn motion() -> Vec<Register> {
    let word = |name: &str, meaning: &str, fraction, unit: &str| {
        let field = Field::new(name, 0, 32, meaning);
        match fraction {
            0 => field.signed(),
            fraction => field.fixed(fraction),
        }
        .with_unit(unit)
    };
    let live = |name: &str, offset, field: Field| {
        Register::new(name, offset, Access::Live, &field.meaning.clone(), vec![field])
    };
    let shadow = |of: &str, offset, meaning: &str| {
        let access = Access::Shadow { of: of.to_owned() };
        Register::new(&format!("snapshot_{of}"), offset, access, meaning, vec![])
    };
    vec![
        live(
            "position",
            0x30,
            word("user_position", "count minus origin", 0, "counts"),
        ),
        live(
            "count",
            0x31,
            word("count", "steps since reset, which is the loop's position", 0, "counts"),
        ),
        live(
            "velocity",
            0x32,
            word("velocity", "velocity at the last tick", 16, "counts/tick"),
        ),
        live(
            "origin",
            0x33,
            word("origin", "count at which the position is 0", 0, "counts"),
        ),
        live(
            "index_count",
            0x34,
            word("index_count", "count at the index", 0, "counts"),
        ),
        live(
            "command_position",
            0x35,
            word(
                "command_position",
                "position before the shaper, relative to the count",
                8,
                "counts",
            ),
        ),
        live(
            "shaped_position",
            0x36,
            word(
                "shaped_position",
                "position after the shaper, relative to the count",
                8,
                "counts",
            ),
        ),
        live(
            "shaped_velocity",
            0x37,
            word("shaped_velocity", "velocity after the shaper", 16, "counts/tick"),
        ),
        live(
            "error",
            0x38,
            word("error", "position error e of the last tick", 16, "counts"),
        ),
        live(
            "command",
            0x39,
            word("command", "command to the drive", 12, "command units"),
        ),
        live(
            "duty",
            0x3a,
            Field::new("duty", 0, 17, "duty to the PWM")
                .signed()
                .with_unit("clocks"),
        ),
        shadow("position", 0x40, "position at the snapshot"),
        shadow("velocity", 0x41, "velocity at the snapshot"),
    ]
}
