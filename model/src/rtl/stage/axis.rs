//! The blocks of an axis, joined: which port is on which net, and what is tied to the machine's constants.

use super::config::StageAxis;
use super::registers::{axis_window, hardware};
use crate::rtl::component::{Block, Joined, Wiring};
use crate::rtl::composition::{CompositionError, Part};

/// Pins of an axis that are inputs.
pub(super) const INPUT_PINS: &[&str] = &[
    "a",
    "b",
    "z",
    "limit_plus_n",
    "limit_minus_n",
    "home",
    "drive_ready",
    "drive_fault_n",
    "fault_n",
];
/// Pins of an axis that are outputs.
pub(super) const OUTPUT_PINS: &[&str] = &["a_high", "a_low", "b_high", "b_low", "drive_enable", "brake_release"];
/// What all axes of a stage read.
pub(super) const SHARED: [&str; 8] = [
    "rst",
    "tick",
    "control",
    "edge_stamp",
    "quotient",
    "group_emergency_stop",
    "emergency_stop_n",
    "pll_locked",
];
/// From the stage to this axis.
const FROM_STAGE: [&str; 3] = ["quotient_valid", "axis_start", "group_stop"];
/// From this axis to the stage.
const TO_STAGE: [&str; 5] = ["steps", "elapsed", "can_start", "wants_group_stop", "emergency_stop"];
/// The pulse counter's timeout, as of the stand-alone one: 5 million clocks.
const VELOCITY_TIMEOUT: u64 = 76;

/// The PWM trips if the controller is silent for so long.
const WATCHDOG_TICKS: u32 = 2;

type Nets = &'static [(&'static str, &'static str)];

const SEGMENTS: Nets = &[
    ("enable", "segments_enable"),
    ("write", "segment_write"),
    ("word", "segment_word"),
    ("data", "segment_data"),
    ("quick_stop", "segments_quick_stop"),
    ("restart", "segments_restart"),
    ("preset", "segments_preset"),
    ("preset_position", "count"),
    ("clear_flags", "clear_sources"),
    ("position", "command_position"),
    ("velocity", "command_velocity"),
    ("acceleration", "command_acceleration"),
    ("valid", "segments_valid"),
    ("state", "segments_state"),
    ("level", "fifo_level"),
    ("low", "fifo_low"),
    ("empty", "segments_empty"),
    ("done", "move_done"),
    ("underrun", "segments_underrun"),
    ("overflow", "segments_overflow"),
    ("refused", "segment_refused"),
    ("malformed", "segment_malformed"),
    ("tick_missed", "segments_tick_missed"),
];

const SHAPER: Nets = &[
    ("strobe", "segments_valid"),
    ("start", "shaper_start"),
    ("x_0", "command_position"),
    ("x_1", "command_velocity"),
    ("x_2", "command_acceleration"),
    ("clear_flags", "clear_sources"),
    ("y_0", "shaped_position"),
    ("y_1", "shaped_velocity"),
    ("y_2", "shaped_acceleration"),
    ("valid", "shaper_valid"),
    ("saturated", "shaper_saturated"),
    ("busy", "shaper_busy"),
    ("overrun", "shaper_overrun"),
    ("bank", "table_bank"),
    ("refused", "table_refused"),
];

const SETTING_BANKS: Nets = &[("bank", "law_bank"), ("row", "setting_address")];

const CONTROLLER: Nets = &[
    ("start", "control"),
    ("position_reference", "shaped_position"),
    ("velocity_reference", "shaped_velocity"),
    ("acceleration_reference", "shaped_acceleration"),
    ("position", "captured_position"),
    ("clear_flags", "clear_sources"),
    ("duty", "controller_duty"),
    ("valid", "controller_valid"),
    ("busy", "controller_busy"),
    ("saturated_high", "controller_saturated_high"),
    ("saturated_low", "controller_saturated_low"),
    ("overrun", "controller_overrun"),
];

const PULSE_COUNTER: Nets = &[
    ("invert", "encoder_invert"),
    ("clear_flags", "clear_sources"),
    ("time_stamp", "edge_stamp"),
    ("illegal", "encoder_illegal"),
    ("disagreement", "encoder_disagreement"),
];

const DRIVE_COMMAND: Nets = &[
    ("axis_state", "state"),
    ("limit_plus_ok", "level_limit_plus_n"),
    ("limit_minus_ok", "level_limit_minus_n"),
];

const PWM: Nets = &[
    ("enable", "pwm_enable"),
    ("sync", "tick"),
    ("clear_trip", "clear_sources"),
    ("clear_flags", "clear_sources"),
    ("running", "pwm_running"),
    ("tripped", "pwm_tripped"),
    ("saturated", "pwm_saturated"),
    ("refused", "pwm_refused"),
    ("below_floor", "pwm_below_floor"),
    ("unaligned", "pwm_unaligned"),
];

const AXIS: Nets = &[
    ("start", "axis_start"),
    ("position", "count"),
    ("reference_position", "shaped_position"),
    ("reference_velocity", "shaped_velocity"),
    ("drive_enable", "axis_drive_enable"),
    ("brake_release", "axis_brake_release"),
    ("pwm_enable", "axis_pwm_enable"),
    ("pwm_trip_n", "axis_pwm_trip_n"),
];

/// Joins the blocks of an axis. The whole has the axis's name; its ports are the nets that registers, stage and pins need.
///
/// `tick_clocks`: from tick to tick, for the PWM's watchdog.
pub(super) fn join(axis: &StageAxis, tick_clocks: u32) -> Result<Joined, CompositionError> {
    let blocks = vec![
        Block::Segments,
        Block::Shaper(Box::new(axis.shaper.clone())),
        Block::SettingBanks(Box::new(axis.settings)),
        Block::SlidingMode,
        Block::PulseCounter,
        Block::DriveCommand,
        Block::Pwm(axis.pwm),
        Block::Axis,
    ];
    let blocks = blocks.into_iter().map(|block| (block.name().to_owned(), block));
    let (driven, read) = hardware(&axis_window(axis));
    let names = |lists: &[&[&str]]| -> Vec<String> {
        let all = lists.iter().flat_map(|list| list.iter());
        all.map(|name| (*name).to_owned()).collect()
    };
    let mut inputs = names(&[&SHARED, &FROM_STAGE, INPUT_PINS]);
    inputs.extend(driven);
    let mut outputs = names(&[&TO_STAGE, OUTPUT_PINS]);
    let more = read.into_iter().filter(|name| !outputs.contains(name));
    let more: Vec<String> = more.collect();
    outputs.extend(more);
    let wiring = Wiring {
        part: Box::new(|block, part| wire(axis, tick_clocks, block, part)),
        inputs,
        outputs,
    };
    Joined::new(&axis.name, blocks.collect(), wiring)
}

fn wire(axis: &StageAxis, tick_clocks: u32, block: &Block, part: Part) -> Part {
    let joined = |part: Part, nets: Nets| nets.iter().fold(part, |part, (port, net)| part.on(port, net));
    let watched = &axis.supervision;
    match block {
        Block::Segments => joined(part, SEGMENTS),
        Block::Shaper(_) => joined(part, SHAPER),
        Block::SettingBanks(_) => joined(part, SETTING_BANKS),
        Block::SlidingMode => joined(part, CONTROLLER).tied("modulo", axis.modulo.into()),
        Block::PulseCounter => joined(part, PULSE_COUNTER)
            .tied("a_n", 0)
            .tied("b_n", 0)
            .tied("z_n", 0)
            .tied("differential", 0)
            .tied("filter_clocks", axis.encoder_filter_clocks.into())
            .tied("mode", 0)
            .tied("swap", 0)
            .tied("timeout", VELOCITY_TIMEOUT)
            .on("position", "user_position"),
        Block::DriveCommand => joined(part, DRIVE_COMMAND)
            .tied("direct_hold_ticks", watched.direct_hold_ticks.into())
            .tied("direct_limit", watched.direct_limit.into()),
        Block::Pwm(config) => {
            let period = u64::from(axis.pwm_period_clocks & 0xffff);
            let watchdog = (WATCHDOG_TICKS * tick_clocks / axis.pwm_period_clocks.max(1)).clamp(1, 255);
            joined(part, PWM)
                .tied("mode", axis.pwm_mode as u64)
                .tied("period", period)
                .tied("max_duty", axis.pwm_period_clocks.min(0xffff).into())
                .tied("update_at_peak", 0)
                .tied("dead_time", config.dead_time_floor_clocks().into())
                .tied("minimum_pulse", config.minimum_pulse_floor_clocks().into())
                .tied("phase", 0)
                .tied("trigger_phase", 0)
                .tied("watchdog_periods", watchdog.into())
                .tied("filter_clocks", watched.filter_clocks.into())
        }
        Block::Axis => joined(part, AXIS)
            .tied("filter_clocks", watched.filter_clocks.into())
            .tied("brake_release_ticks", watched.brake_release_ticks.into())
            .tied("brake_apply_ticks", watched.brake_apply_ticks.into())
            .tied("deviation_limit", 0)
            .tied("deviation", 0)
            .tied("saturation_ticks", watched.saturation_ticks.into())
            .tied("lost_command", watched.lost_command.into())
            .tied("lost_ticks", watched.lost_ticks.into())
            .tied("scale_illegal", 0)
            .tied("scale_disagreement", 0),
        _ => part,
    }
}
