//! Registers of an axis that a host writes: enable and commands, tables and settings, limits, and the decoding of its
//! encoder.

use super::config::StageAxis;
use super::registers::with_the_drive_off;
use crate::registers::{Access, Field, Register, tables};

/// The registers in words of the axis's window, preceded by the parameters of its build.
pub(super) fn registers(axis: &StageAxis) -> Vec<Register> {
    [
        parameters(axis),
        commands(),
        loaded_tables(axis),
        supervision(axis),
        encoder(axis),
    ]
    .concat()
}

fn parameters(axis: &StageAxis) -> Vec<Register> {
    let mut registers = vec![tables::parameter(
        "pwm_period_clocks",
        0x00,
        "clocks of the PWM's period, which is full duty",
        axis.closed_loop().map_or(0, |of| of.pwm_period_clocks),
    )];
    registers.extend(tables::axis_shaper(&axis.shaper));
    registers
}

fn commands() -> Vec<Register> {
    vec![
        Register::new(
            "control",
            0x08,
            Access::Configuration,
            "enable and mode of the axis",
            vec![
                Field::flag(
                    "enable",
                    0,
                    "1: outputs on; 0: outputs off, after a quick stop and the brake",
                ),
                Field::flag("direct_enable", 1, "requests direct mode, in READY"),
                Field::flag(
                    "self_test",
                    3,
                    "direct mode is a self-test of the PWM: pins, drive and brake stay off",
                ),
            ],
        ),
        Register::new("stop", 0x09, Access::command("stop"), "quick stop, then HOLD", vec![]),
        Register::new(
            "clear_faults",
            0x0a,
            Access::command("clear_faults"),
            "forgets the causes that are over, and the flags of all blocks",
            vec![],
        ),
        Register::new(
            "flush",
            0x0b,
            Access::command("flush"),
            "drops the waiting entries",
            vec![],
        ),
        Register::new(
            "kick",
            0x0c,
            Access::command("kick"),
            "kicks the host's watchdog",
            vec![Field::new("kick_word", 0, 32, "0x4b49434b, `KICK`")],
        ),
        Register::new(
            "homed",
            0x0f,
            Access::command("write_homed"),
            "sets whether the axis is homed; the machine file may let the soft limits act only then",
            vec![Field::flag(
                "homed_value",
                0,
                "the origin, to which the soft limits refer, is known",
            )],
        ),
        Register::new(
            "direct",
            0x0d,
            Access::command("direct_kick"),
            "duty of direct mode, which expires after some time",
            vec![
                Field::new("direct_duty", 0, 17, "limited by the machine file")
                    .signed()
                    .with_unit("clocks"),
            ],
        ),
        Register::new(
            "fifo_control",
            0x0e,
            Access::Configuration,
            "when the FIFO is low, and how long a move goes on without entries",
            vec![
                Field::new("low_water", 0, 6, "entries").with_reset(16),
                Field::new(
                    "extrapolation",
                    8,
                    8,
                    "at the last velocity where entries are missing, then a quick stop",
                )
                .with_unit("ticks"),
            ],
        ),
        Register::new(
            "segment",
            0x10,
            Access::Words {
                strobe: "segment_write".to_owned(),
                word: "segment_word".to_owned(),
                words: 4,
            },
            "an entry of the FIFO, four words; the last commits: see docs/segments.md",
            vec![Field::new("segment_data", 0, 32, "the word")],
        ),
    ]
}

fn loaded_tables(axis: &StageAxis) -> Vec<Register> {
    let mut registers = tables::axis_taps(&axis.shaper);
    registers.extend([
        tables::setting_address(0x17),
        tables::setting(0x18),
        tables::setting_read(0x26),
        Register::new(
            "law",
            0x19,
            Access::Staged,
            "control law and settings in use",
            vec![
                tables::law().with_reset(axis.closed_loop().map_or(0, |of| of.law as u32)),
                tables::setting_bank("law_bank"),
            ],
        ),
    ]);
    registers
}

fn supervision(axis: &StageAxis) -> Vec<Register> {
    let watched = &axis.supervision;
    let limit = |name: &str, value: i32| {
        Field::new(name, 0, 32, "limit of the shaped position; both 0: no soft limits")
            .fixed(8)
            .with_unit("counts")
            .with_reset(value as u32)
    };
    vec![
        Register::new(
            "soft_limit_plus",
            0x1a,
            Access::Configuration,
            "end of the travel, in counts since reset: see `ORIGIN`",
            vec![limit("soft_limit_plus", watched.soft_limit_plus)],
        ),
        Register::new(
            "soft_limit_minus",
            0x1b,
            Access::Configuration,
            "the other end of the travel",
            vec![limit("soft_limit_minus", watched.soft_limit_minus)],
        ),
        Register::new(
            "following_error_limit",
            0x1c,
            Access::Configuration,
            "largest following error",
            vec![
                Field::new("following_error_limit", 0, 32, "Q16.16; 0 disables the check")
                    .with_unit("counts / 65536")
                    .with_reset(watched.following_error_limit),
            ],
        ),
        Register::new(
            "watchdog",
            0x1d,
            Access::Configuration,
            "the host's watchdog, and the reaction to each cause",
            vec![
                Field::new(
                    "watchdog_ticks",
                    0,
                    16,
                    "longest time without a kick; 0 disables the watchdog",
                )
                .with_unit("ticks")
                .with_reset(watched.watchdog_ticks.into()),
                Field::new(
                    "off_causes",
                    16,
                    16,
                    "one bit per cause: 1 switches the outputs off, 0 leads to a quick \
                    stop",
                )
                .with_reset(watched.off_causes.into()),
            ],
        ),
        Register::new(
            "stop_deceleration",
            0x1e,
            Access::Configuration,
            "deceleration of a quick stop",
            vec![
                Field::new("stop_deceleration", 0, 31, "Q7.24; 0: the command stops at once")
                    .with_unit("counts/tick^2 / 2^24")
                    .with_reset(watched.stop_deceleration),
            ],
        ),
        Register::new(
            "settle",
            0x1f,
            Access::Configuration,
            "time in which a stop settles: the longest delay of the tables in use",
            vec![
                Field::new("settle_ticks", 0, 16, "time after the command's standstill")
                    .with_unit("ticks")
                    .with_reset(watched.settle_ticks.into()),
            ],
        ),
    ]
}

fn encoder(axis: &StageAxis) -> Vec<Register> {
    vec![
        Register::new(
            "encoder",
            0x24,
            with_the_drive_off(),
            "sign of the loop's feedback",
            vec![
                Field::flag("encoder_invert", 0, "reverses the encoder's direction")
                    .with_reset(axis.closed_loop().is_some_and(|of| of.encoder_invert).into()),
            ],
        ),
        Register::new(
            "pwm_trigger",
            0x25,
            Access::Configuration,
            "phase at which the pin `pwm_trigger` is high for a clock, for an ADC for example",
            vec![Field::new("trigger_phase", 0, 16, "time after the valley").with_unit("clocks")],
        ),
        Register::new(
            "index",
            0x20,
            Access::Configuration,
            "effect of an index, and measurement of the velocity",
            vec![
                Field::flag("index_always", 0, "latches every index"),
                Field::flag("index_presets", 1, "a latched index also presets the position"),
                Field::new(
                    "index_gate",
                    4,
                    4,
                    "bit 0: an index counts only while A equals bit 1; bit 2: only while B equals bit 3",
                ),
                Field::new(
                    "smoothing",
                    8,
                    2,
                    "k of the velocity's one-pole filter with coefficient 2^-k",
                ),
                Field::flag("velocity_m", 12, "velocity is the counts per tick alone"),
            ],
        ),
        Register::new(
            "index_arm",
            0x21,
            Access::command("index_arm"),
            "latches the next index",
            vec![],
        ),
        Register::new(
            "preset",
            0x22,
            Access::command("preset"),
            "sets the user's position; the loop's count does not jump",
            vec![
                Field::new("preset_value", 0, 32, "position")
                    .signed()
                    .with_unit("counts"),
            ],
        ),
    ]
}
