//! What a host sees of a stage: a window of its own, and one per axis, all alike.

use super::bring_up;
use super::config::{StageAxis, StageConfig};
use crate::rtl::group::MOST_AXES;
use crate::rtl::registers::maps;
use crate::rtl::registers::{Access, Description, Field, Register, Source, WINDOW_WORDS};

/// What an axis can interrupt for: name, meaning. Bit `7 · axis + place` of the interrupt registers.
pub const AXIS_INTERRUPTS: [(&str, &str); 7] = [
    ("notify", "an entry with this flag has ended"),
    ("move_done", "a move has ended at rest, or a quick stop is over"),
    ("fifo_low", "at most `low_water` entries wait"),
    ("halted", "RUN or QUICK_STOP has become HOLD"),
    ("stopping", "a quick stop has begun"),
    ("faulted", "the axis is in FAULT"),
    ("index_seen", "an index was latched"),
];

/// All registers of the stage.
pub(super) fn stage(config: &StageConfig) -> Description {
    let about = "Stage: axes from motion segments to the pins; window 0 is the stage's, then one window per axis.";
    let parameter = |name: &str, bits, meaning: &str, value| Field::new(name, 0, bits, meaning).with_reset(value);
    let parameters = vec![
        parameter("axes", 3, "windows after this one", config.axes.len() as u32),
        parameter("tick_clocks", 17, "from tick to tick", config.tick.tick_clocks()).with_unit("clocks"),
        parameter(
            "control_clocks",
            17,
            "from the tick to the start of the controllers",
            config.timing().control_clocks(),
        )
        .with_unit("clocks"),
        parameter(
            "duty_clocks",
            17,
            "from the tick to the new duty, which the PWM takes at its next boundary",
            config.timing().duty_clocks(),
        )
        .with_unit("clocks"),
    ];
    let mut description = Description::new("stage", about, *b"STGE", (1, 0), parameters)
        .with_windows(config.axes.len() as u32 + 1)
        .with(
            "snapshot",
            0x08,
            Access::Snapshot,
            "freezes the words `SNAPSHOT_...` of all axes",
            vec![],
        )
        .with(
            "commit",
            0x09,
            Access::Commit {
                tick: "tick".to_owned(),
            },
            "the staged registers of all axes, together, at the next tick",
            vec![Field::flag("commit_waits", 0, "a commit waits")],
        )
        .with(
            "start",
            0x0a,
            command("start"),
            "all these axes start in one tick, or none",
            vec![Field::new("start_axes", 0, MOST_AXES as u32, "bit k: axis k")],
        )
        .with(
            "flags",
            0x0b,
            Access::Sticky,
            "what has happened since the flag was cleared",
            vec![
                maps::partial_write(0),
                Field::flag("commit_rejected", 1, "a write was ignored").set_by(Source::CommitRejected),
                Field::flag("start_refused", 2, "an axis could not start, so none did"),
            ],
        )
        .with_interrupts(0x0c, interrupts(config))
        .with_shadowed(
            "time_stamp",
            0x20,
            0x40,
            "clocks since reset",
            vec![Field::new("time_stamp", 0, 32, "modulo 2^32").with_unit("clocks")],
        )
        .with_shadowed(
            "tick_count",
            0x21,
            0x41,
            "ticks since reset",
            vec![Field::new("tick_count", 0, 32, "modulo 2^32").with_unit("ticks")],
        );
    for (window, axis) in (1..).zip(&config.axes) {
        let registers = axis_window(axis).into_iter();
        let placed = registers.map(|register| of_axis(register, &axis.name, window * WINDOW_WORDS));
        description.registers.extend(placed);
    }
    description
}

/// The register under the axis's name and in its window.
fn of_axis(mut register: Register, axis: &str, base: u32) -> Register {
    let named = |name: &mut String| *name = format!("{axis}_{name}");
    named(&mut register.name);
    register.offset += base;
    for field in &mut register.fields {
        named(&mut field.name);
    }
    match &mut register.access {
        Access::Shadow { of } => named(of),
        Access::Command { strobe } => named(strobe),
        Access::Words { strobe, word, .. } => {
            named(strobe);
            named(word);
        }
        _ => {}
    }
    register
}

fn interrupts(config: &StageConfig) -> Vec<Field> {
    let mut fields = Vec::new();
    for (index, axis) in (0..).zip(&config.axes) {
        for (place, (name, meaning)) in (0..).zip(AXIS_INTERRUPTS) {
            let bit = index * AXIS_INTERRUPTS.len() as u32 + place;
            fields.push(Field::flag(&format!("{}_{name}", axis.name), bit, meaning));
        }
    }
    fields.push(Field::flag("tick", 28, "a tick has passed"));
    fields.push(Field::flag("start_refused", 29, "an axis could not start, so none did"));
    fields
}

/// Names of the hardware that these registers drive, and of that which they read; interrupts read more.
pub(super) fn hardware(registers: &[Register]) -> (Vec<String>, Vec<String>) {
    let (mut driven, mut read) = (Vec::new(), Vec::new());
    for register in registers {
        match &register.access {
            Access::Command { strobe } => driven.push(strobe.clone()),
            Access::Words { strobe, word, .. } => driven.extend([strobe.clone(), word.clone()]),
            _ => {}
        }
        let names = register.fields.iter().map(|field| field.name.clone());
        match &register.access {
            access if access.drives_fields() => driven.extend(names),
            Access::Live | Access::Sticky => read.extend(names),
            _ => {}
        }
    }
    let more = AXIS_INTERRUPTS.iter().map(|(name, _)| (*name).to_owned());
    read.extend(more.filter(|name| !read.contains(name)).collect::<Vec<_>>());
    (driven, read)
}

pub(super) fn command(strobe: &str) -> Access {
    Access::Command {
        strobe: strobe.to_owned(),
    }
}

/// A register of an axis, without the axis's name.
pub(super) fn register(name: &str, offset: u32, access: Access, meaning: &str, fields: Vec<Field>) -> Register {
    Register {
        name: name.to_owned(),
        offset,
        access,
        meaning: meaning.to_owned(),
        fields,
    }
}

/// The registers of an axis, in words of its window, without the axis's name before theirs.
pub fn axis_window(axis: &StageAxis) -> Vec<Register> {
    let mut registers = parameters(axis);
    registers.extend(commands());
    registers.extend(tables(axis));
    registers.extend(supervision(axis));
    registers.extend(encoder());
    registers.extend(states());
    registers.extend(motion());
    if axis.scale.is_some() {
        registers.extend(scale());
    }
    if axis.bring_up.is_some() {
        registers.extend(bring_up::registers());
    }
    registers
}

fn scale() -> Vec<Register> {
    let live = |name: &str, offset, meaning: &str| {
        let field = Field::new(name, 0, 32, meaning).signed().with_unit("counts");
        register(name, offset, Access::Live, meaning, vec![field])
    };
    vec![
        register(
            "scale_control",
            0x23,
            Access::Configuration,
            "how the scale is read",
            vec![Field::flag("scale_invert", 0, "reverses the scale's direction")],
        ),
        live("scale_count", 0x3b, "steps of the scale since reset"),
        live(
            "deviation",
            0x3c,
            "motor against scale since HOLD, in counts of the loop",
        ),
    ]
}

fn parameters(axis: &StageAxis) -> Vec<Register> {
    let constant = |name: &str, offset, meaning: &str, value| {
        let field = Field::new(name, 0, 32, meaning).with_reset(value);
        register(name, offset, Access::Constant, "parameter of the build", vec![field])
    };
    vec![
        constant("pwm_period_clocks", 0x00, "full duty", axis.pwm_period_clocks),
        constant(
            "ring_samples",
            0x01,
            "delays of a table reach up to this less 2",
            1 << axis.shaper.ring_address_bits(),
        ),
        constant("most_taps", 0x02, "taps per bank", axis.shaper.most_taps()),
        constant(
            "machine_taps",
            0x03,
            "taps of bank 0",
            axis.shaper.table().taps().len() as u32,
        ),
        constant(
            "coefficient_fraction",
            0x04,
            "F of the coefficients",
            axis.shaper.coefficient_fraction(),
        ),
    ]
}

fn commands() -> Vec<Register> {
    vec![
        register(
            "control",
            0x08,
            Access::Configuration,
            "what is wanted of the axis",
            vec![
                Field::flag("enable", 0, "outputs on; low: off, through a quick stop and the brake"),
                Field::flag("direct_enable", 1, "direct mode, in READY"),
                Field::flag("encoder_invert", 2, "reverses the encoder's direction"),
                Field::flag(
                    "self_test",
                    3,
                    "direct mode tests the PWM: pins, drive and brake stay off",
                ),
            ],
        ),
        register("stop", 0x09, command("stop"), "quick stop, then HOLD", vec![]),
        register(
            "clear_faults",
            0x0a,
            command("clear_faults"),
            "forgets the causes that are over, and the flags of all blocks",
            vec![],
        ),
        register("flush", 0x0b, command("flush"), "drops the entries that wait", vec![]),
        register(
            "kick",
            0x0c,
            command("kick"),
            "of the host's watchdog",
            vec![Field::new("kick_word", 0, 32, "0x4b49434b, `KICK`")],
        ),
        register(
            "direct",
            0x0d,
            command("direct_kick"),
            "direct mode: a duty, held for some time only",
            vec![
                Field::new("direct_duty", 0, 17, "limited by the machine file")
                    .signed()
                    .with_unit("clocks"),
            ],
        ),
        register(
            "fifo_control",
            0x0e,
            Access::Configuration,
            "when the FIFO is low",
            vec![Field::new("low_water", 0, 6, "entries").with_reset(16)],
        ),
        register(
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

fn tables(axis: &StageAxis) -> Vec<Register> {
    let laws = [
        (0, "sliding_mode", "c de + k s + eps sat(s / phi)"),
        (1, "pd", "proportional and derivative"),
        (2, "pid", "the same and the integral"),
    ];
    let banks = [
        (0, "machine", "the machine's, a ROM"),
        (1, "loaded_1", "what was loaded into bank 1"),
        (2, "loaded_2", "what was loaded into bank 2"),
    ];
    vec![
        register(
            "tap_address",
            0x14,
            Access::Configuration,
            "which tap `TAP` is",
            maps::tap_address(&axis.shaper),
        ),
        register(
            "tap",
            0x15,
            command("tap_write"),
            "writes a tap",
            maps::tap(&axis.shaper),
        ),
        register(
            "swap",
            0x16,
            command("swap"),
            "makes a bank active",
            maps::swap(&axis.shaper),
        ),
        register(
            "setting_address",
            0x17,
            Access::Configuration,
            "which setting `SETTING` is",
            vec![
                Field::new("setting_row", 0, 4, "its place: see docs/sliding_mode.md"),
                Field::new("setting_bank", 8, 2, "bank 1 or 2"),
            ],
        ),
        register(
            "setting",
            0x18,
            command("setting_write"),
            "writes a setting",
            vec![Field::new("setting_word", 0, 32, "mantissa and shift, or the limit")],
        ),
        register(
            "law",
            0x19,
            Access::Staged,
            "what computes the command",
            vec![
                Field::choice("law", 0, 2, "the law", &laws).with_reset(axis.law as u32),
                Field::choice("law_bank", 8, 2, "settings in use; bank 3 is all 0", &banks),
            ],
        ),
    ]
}

fn supervision(axis: &StageAxis) -> Vec<Register> {
    let watched = &axis.supervision;
    let limit = |name: &str, value: i32| {
        Field::new(name, 0, 32, "of the shaped position; both 0: none")
            .fixed(8)
            .with_unit("counts")
            .with_reset(value as u32)
    };
    vec![
        register(
            "soft_limit_plus",
            0x1a,
            Access::Configuration,
            "end of the travel, in counts since reset: see `ORIGIN`",
            vec![limit("soft_limit_plus", watched.soft_limit_plus)],
        ),
        register(
            "soft_limit_minus",
            0x1b,
            Access::Configuration,
            "the other end",
            vec![limit("soft_limit_minus", watched.soft_limit_minus)],
        ),
        register(
            "following_error_limit",
            0x1c,
            Access::Configuration,
            "largest error",
            vec![
                Field::new("following_error_limit", 0, 32, "Q16.16; 0: not watched")
                    .with_unit("counts / 65536")
                    .with_reset(watched.following_error_limit),
            ],
        ),
        register(
            "watchdog",
            0x1d,
            Access::Configuration,
            "of the host, and what follows from a cause",
            vec![
                Field::new("watchdog_ticks", 0, 16, "without a kick; 0: no watchdog")
                    .with_unit("ticks")
                    .with_reset(watched.watchdog_ticks.into()),
                Field::new("off_causes", 16, 16, "per cause: 1 outputs off, 0 quick stop")
                    .with_reset(watched.off_causes.into()),
            ],
        ),
        register(
            "stop_deceleration",
            0x1e,
            Access::Configuration,
            "of a quick stop",
            vec![
                Field::new("stop_deceleration", 0, 31, "Q7.24; 0: at once")
                    .with_unit("counts/tick^2 / 2^24")
                    .with_reset(watched.stop_deceleration),
            ],
        ),
        register(
            "settle",
            0x1f,
            Access::Configuration,
            "how long a stop rings: the longest delay of the tables in use",
            vec![
                Field::new("settle_ticks", 0, 16, "after the command stands")
                    .with_unit("ticks")
                    .with_reset(watched.settle_ticks.into()),
            ],
        ),
    ]
}

fn encoder() -> Vec<Register> {
    vec![
        register(
            "index",
            0x20,
            Access::Configuration,
            "what an index does, and how the velocity is measured",
            vec![
                Field::flag("index_always", 0, "latches every index"),
                Field::flag("index_presets", 1, "a latched index also presets"),
                Field::new(
                    "index_gate",
                    4,
                    4,
                    "bit 0: only while A is as bit 1; bit 2: only while B is as bit 3",
                ),
                Field::new(
                    "smoothing",
                    8,
                    2,
                    "k of the velocity's one-pole filter with coefficient 2^-k",
                ),
                Field::flag("velocity_m", 12, "velocity by counts per tick alone"),
            ],
        ),
        register(
            "index_arm",
            0x21,
            command("index_arm"),
            "latches the next index",
            vec![],
        ),
        register(
            "preset",
            0x22,
            command("preset"),
            "the user's position becomes this; the loop's count never jumps",
            vec![
                Field::new("preset_value", 0, 32, "position")
                    .signed()
                    .with_unit("counts"),
            ],
        ),
    ]
}

fn states() -> Vec<Register> {
    let states = [
        (0, "off", "outputs off"),
        (1, "ready", "outputs off, nothing wrong"),
        (2, "hold", "outputs on, the command stands"),
        (3, "run", "segments play"),
        (4, "quick_stop", "slowing down"),
        (5, "fault", "a cause, until it is cleared"),
    ];
    vec![
        register(
            "status",
            0x28,
            Access::Live,
            "what the axis is doing",
            vec![
                Field::choice("state", 0, 3, "state of the supervisor", &states),
                Field::flag("can_start", 3, "a start would lead to RUN"),
                Field::new("segments_state", 4, 2, "0 hold, 1 move, 2 stop, 3 stopped"),
                Field::flag("direct_active", 6, "direct mode drives the outputs"),
                Field::flag("pwm_running", 7, "the PWM's outputs are on"),
                Field::flag("level_emergency_stop_n", 8, "filtered line: low is a stop"),
                Field::flag("level_limit_plus_n", 9, "filtered line: low is on the switch"),
                Field::flag("level_limit_minus_n", 10, "filtered line: low is on the switch"),
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
            ],
        ),
        register(
            "causes",
            0x29,
            Access::Live,
            "what went wrong, until `CLEAR_FAULTS`: see docs/axis.md",
            vec![Field::new("causes", 0, 16, "bit per cause")],
        ),
        register(
            "flags",
            0x2a,
            Access::Live,
            "what the blocks have flagged, until `CLEAR_FAULTS`",
            vec![
                Field::flag("segments_underrun", 0, "no entry was there while moving"),
                Field::flag("segments_overflow", 1, "a sum did not fit"),
                Field::flag("segments_tick_missed", 2, "a tick came while one was played"),
                Field::flag("segment_refused", 3, "a word was written to a full FIFO, or in a stop"),
                Field::flag("segment_malformed", 4, "an entry was dropped"),
                Field::flag("shaper_saturated", 5, "an output was clamped"),
                Field::flag("shaper_overrun", 6, "a sample came while a pass ran"),
                Field::flag("table_refused", 7, "a tap or a swap was refused"),
                Field::flag("encoder_illegal", 8, "A and B changed together"),
                Field::flag("encoder_disagreement", 9, "the lines of a pair were equal"),
                Field::flag("velocity_missed", 10, "a tick had no velocity"),
                Field::flag("controller_overrun", 11, "a start came while a pass ran"),
                Field::flag("limited_high", 12, "the last command was cut at +limit"),
                Field::flag("limited_low", 13, "the last command was cut at -limit"),
                Field::flag("pwm_saturated", 14, "a duty was limited"),
                Field::flag("pwm_unaligned", 15, "the PWM was not in step with the tick"),
                Field::new("illegal_count", 16, 8, "illegal transitions; stops at 255"),
            ],
        ),
        register(
            "events",
            0x2b,
            Access::Sticky,
            "what has happened since the flag was cleared",
            vec![
                Field::flag("refused", 0, "a start led to nothing"),
                Field::flag(
                    "setting_refused",
                    1,
                    "a setting for a bank in use, or for none that can be loaded",
                ),
                Field::flag("direct_expired", 2, "direct mode was not held"),
            ],
        ),
        register(
            "saturations",
            0x2c,
            Access::Live,
            "where the controller was cut, until `CLEAR_FAULTS`",
            vec![
                Field::new(
                    "controller_saturated_high",
                    0,
                    7,
                    "e, de, s, feedback, integral, command, duty",
                ),
                Field::new("controller_saturated_low", 8, 7, "the same, at the lower end"),
                Field::new("limited_ticks", 16, 16, "ticks in a row that commands were cut").with_unit("ticks"),
            ],
        ),
        register(
            "fifo",
            0x2d,
            Access::Live,
            "how much of the motion is left",
            vec![
                Field::new("fifo_level", 0, 7, "entries that wait"),
                Field::flag("fifo_low", 8, "at most `low_water`"),
                Field::flag("segments_empty", 9, "none"),
            ],
        ),
        register(
            "self_test",
            0x2e,
            Access::Live,
            "gates of the PWM in the last whole period of a self-test",
            vec![
                Field::new(
                    "self_test_high",
                    0,
                    16,
                    "on time of `a_high`, behind no pin; stops at 65535",
                )
                .with_unit("clocks"),
                Field::new("self_test_low", 16, 16, "the same of `a_low`").with_unit("clocks"),
            ],
        ),
    ]
}

/// What moves: live words, and shadows of position and velocity.
fn motion() -> Vec<Register> {
    let word = |name: &str, meaning: &str, fraction, unit: &str| {
        let field = Field::new(name, 0, 32, meaning);
        match fraction {
            0 => field.signed(),
            fraction => field.fixed(fraction),
        }
        .with_unit(unit)
    };
    let live =
        |name: &str, offset, field: Field| register(name, offset, Access::Live, &field.meaning.clone(), vec![field]);
    let shadow = |of: &str, offset, meaning: &str| {
        let access = Access::Shadow { of: of.to_owned() };
        register(&format!("snapshot_{of}"), offset, access, meaning, vec![])
    };
    vec![
        live(
            "position",
            0x30,
            word("user_position", "count less origin", 0, "counts"),
        ),
        live(
            "count",
            0x31,
            word("count", "steps since reset: the loop's position", 0, "counts"),
        ),
        live(
            "velocity",
            0x32,
            word("velocity", "at the last tick", 16, "counts/tick"),
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
            word("command_position", "before the shaper, of the count", 8, "counts"),
        ),
        live(
            "shaped_position",
            0x36,
            word("shaped_position", "after the shaper, of the count", 8, "counts"),
        ),
        live(
            "shaped_velocity",
            0x37,
            word("shaped_velocity", "after the shaper", 16, "counts/tick"),
        ),
        live("error", 0x38, word("error", "e of the last tick", 16, "counts")),
        live("command", 0x39, word("command", "to the drive", 12, "command units")),
        live(
            "duty",
            0x3a,
            Field::new("duty", 0, 17, "to the PWM").signed().with_unit("clocks"),
        ),
        shadow("position", 0x40, "position at the snapshot"),
        shadow("velocity", 0x41, "velocity at the snapshot"),
    ]
}
