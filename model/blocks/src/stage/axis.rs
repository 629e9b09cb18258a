//! Joins the blocks of an axis: the net of each port, and the inputs that are tied to the machine's constants.

use super::absolute;
use super::bring_up::TRACED;
use super::compare;
use super::config::{Follower, StageAxis, StageLoop};
use super::registers::{axis_window, hardware};
use super::steps;
use crate::Direction;
use crate::component::{ComponentPart, JoinedBlocks, Wiring};
use crate::composition::{CompositionError, Part};
use crate::error_table::EntryUnit;
use crate::group::MOST_AXES;
use crate::pwm::PwmConfig;
use crate::registers::trace;

/// Input pins of an axis with a controller.
const INPUT_PINS: [&str; 9] = [
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
/// Input pins of an axis with steps.
const INPUT_PINS_WITH_STEPS: [&str; 5] = ["z", "limit_plus_n", "limit_minus_n", "home", "drive_ready"];
/// Pin of a probe, in place of `z`.
const PROBE_PIN: &str = "probe";
/// Input pins of a linear scale.
const SCALE_PINS: [&str; 2] = ["scale_a", "scale_b"];
/// Output pins of an axis with a controller.
const OUTPUT_PINS: [&str; 7] = [
    "a_high",
    "a_low",
    "b_high",
    "b_low",
    "pwm_trigger",
    "drive_enable",
    "brake_release",
];
/// Output pins of an axis with steps, in addition to its lines.
const OUTPUT_PINS_WITH_STEPS: [&str; 2] = ["drive_enable", "brake_release"];
/// The line that switches all PWMs off.
pub(super) const PLL_LOCKED: &str = "pll_locked";
/// Nets of the stage that axes read.
pub(super) const SHARED: [&str; 8] = [
    "rst",
    "tick",
    "control",
    "edge_stamp",
    "quotient",
    "group_emergency_stop",
    "emergency_stop_n",
    PLL_LOCKED,
];
/// Nets from the stage to this axis.
const FROM_STAGE: [&str; 4] = ["quotient_valid", "axis_start", "group_stop", "hold_feed"];
/// Nets from this axis to the stage.
const TO_STAGE: [&str; 6] = [
    "steps",
    "elapsed",
    "can_start",
    "wants_group_stop",
    "emergency_stop",
    "rests",
];
/// Timeout of the pulse counter, as in the stand-alone one: 5 million clocks.
const VELOCITY_TIMEOUT: u64 = 76;

/// The PWM trips after this many ticks without a command of the controller.
const WATCHDOG_TICKS: u32 = 2;

pub(super) type Nets = &'static [(&'static str, &'static str)];

const SEGMENTS: Nets = &[
    ("enable", "segments_enable"),
    ("write", "segment_write"),
    ("word", "segment_word"),
    ("data", "segment_data"),
    ("quick_stop", "segments_quick_stop"),
    ("restart", "segments_restart"),
    ("preset", "segments_preset"),
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
    ("out_of_range", "segments_out_of_range"),
    ("feed_hold", "hold_feed"),
    ("held", "feed_held"),
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

const SETTING_BANKS: Nets = &[
    ("bank", "law_bank"),
    ("row", "setting_address"),
    ("busy", "controller_busy"),
];

const CONTROLLER: Nets = &[
    ("velocity_reference", "shaped_velocity"),
    ("acceleration_reference", "shaped_acceleration"),
    ("clear_flags", "clear_sources"),
    ("duty", "controller_duty"),
    ("valid", "controller_valid"),
    ("busy", "controller_busy"),
    ("saturated_high", "controller_saturated_high"),
    ("saturated_low", "controller_saturated_low"),
    ("overrun", "controller_overrun"),
];

const PULSE_COUNTER: Nets = &[
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
    ("trigger", "pwm_trigger"),
];

/// Net from which on the deviation counts, where a host corrects it.
const ALIGN: &str = "scale_align";
/// Net of the deviation that has lasted.
const LASTING_DEVIATION: &str = "lasting_deviation";
/// Name of the part that counts the scale's pulses.
const SCALE_COUNTER: &str = "scale_counter";

const SCALE: Nets = &[
    ("a", "scale_a"),
    ("b", "scale_b"),
    ("invert", "scale_invert"),
    ("clear_flags", "clear_sources"),
    ("time_stamp", "edge_stamp"),
];

const LINEAR_SCALE: Nets = &[
    ("motor_position", "count"),
    ("scale_position", "scale_count"),
    ("motor_velocity", "velocity"),
    ("position", "loop_position"),
    ("velocity", "loop_velocity"),
];

const GENERATOR: Nets = &[
    ("rate", "generator_rate"),
    ("pin_a", "a"),
    ("pin_b", "b"),
    ("pin_z", "z"),
    ("a", "counter_a"),
    ("b", "counter_b"),
    ("z", "counter_z"),
    ("a_n", "counter_a_n"),
    ("b_n", "counter_b_n"),
    ("z_n", "counter_z_n"),
];

const EXCITATION: Nets = &[
    ("valid", "shaper_valid"),
    ("y_0", "shaped_position"),
    ("y_1", "shaped_velocity"),
    ("y_2", "shaped_acceleration"),
    ("enable", "excitation_enable"),
    // `can_start` is high in HOLD only, with the brake open and nothing wrong.
    ("allowed", "can_start"),
    ("kind", "excitation_kind"),
    ("amplitude", "excitation_amplitude"),
    ("period_ticks", "excitation_period"),
    ("sweep", "excitation_sweep"),
    ("duration_ticks", "excitation_duration"),
    // The shaper's own rates do not change between its samples.
    ("velocity_reference", "delayed_velocity"),
    ("acceleration_reference", "delayed_acceleration"),
];

const AXIS: Nets = &[
    ("start", "axis_start"),
    ("reference_position", "shaped_position"),
    ("reference_velocity", "shaped_velocity"),
];

const AXIS_WITH_LOOP: Nets = &[
    ("saturated_high", "controller_saturated_high"),
    ("saturated_low", "controller_saturated_low"),
    ("drive_enable", "axis_drive_enable"),
    ("brake_release", "axis_brake_release"),
    ("pwm_enable", "axis_pwm_enable"),
    ("pwm_trip_n", "axis_pwm_trip_n"),
];

/// Input pins of this axis.
pub(super) fn input_pins(axis: &StageAxis) -> Vec<&'static str> {
    let scale: &[&str] = if axis.scale.is_some() { &SCALE_PINS } else { &[] };
    match axis.follower {
        Follower::Loop(_) if axis.absolute().is_some() => {
            let mut pins = [&absolute::INPUT_PINS, &INPUT_PINS[..], scale].concat();
            pins.retain(|pin| !absolute::LACKS_PINS.contains(pin));
            pins
        }
        Follower::Loop(_) => [&INPUT_PINS, scale].concat(),
        Follower::Steps(_) => {
            let pin = |pin: &'static str| match axis.probe {
                Some(_) if pin == "z" => PROBE_PIN,
                _ => pin,
            };
            [&INPUT_PINS_WITH_STEPS.map(pin), scale].concat()
        }
    }
}

/// Output pins of this axis.
pub(super) fn output_pins(axis: &StageAxis) -> Vec<&'static str> {
    let compare = axis.compare.map(|_| compare::PIN);
    let pins = match &axis.follower {
        Follower::Loop(_) if axis.absolute().is_some() => [&OUTPUT_PINS, &absolute::OUTPUT_PINS[..]].concat(),
        Follower::Loop(_) => OUTPUT_PINS.to_vec(),
        Follower::Steps(config) => [&config.mode().line_names(), &OUTPUT_PINS_WITH_STEPS[..]].concat(),
    };
    pins.into_iter().chain(compare).collect()
}

/// Joins the blocks of an axis. The whole has the axis's name; its ports are the nets that registers, stage and pins
/// need.
///
/// `tick_clocks` are the clocks from tick to tick, for the PWM's watchdog; `axes` is the number of axes of the stage.
pub(super) fn join(axis: &StageAxis, tick_clocks: u32, axes: usize) -> Result<JoinedBlocks, CompositionError> {
    let shaper = ComponentPart::Shaper(Box::new(axis.shaper.clone()));
    let mut blocks = match &axis.follower {
        Follower::Loop(of) => vec![
            ComponentPart::Segments,
            shaper,
            ComponentPart::SettingBanks(Box::new(of.settings)),
            ComponentPart::SlidingMode,
            match of.absolute {
                Some(absolute) => ComponentPart::AbsoluteEncoder(absolute.encoder),
                None => ComponentPart::PulseCounter,
            },
            ComponentPart::DriveCommand,
            ComponentPart::Pwm(of.pwm.on_time_base()),
            ComponentPart::Axis,
        ],
        Follower::Steps(config) => vec![
            ComponentPart::Segments,
            shaper,
            ComponentPart::StepGenerator(*config),
            ComponentPart::PulseCounter,
            ComponentPart::Axis,
        ],
    };
    blocks.extend(axis.absolute().map(|_| ComponentPart::AbsoluteFeedback));
    blocks.extend(axis.probe.map(|_| ComponentPart::ProbeLine));
    blocks.extend(axis.compare.map(|_| ComponentPart::Compare));
    if let Some(trace) = axis.bring_up {
        let counts = axis.closed_loop().filter(|of| of.absolute.is_none());
        let generator = counts.map(|_| ComponentPart::EncoderGenerator);
        blocks.extend(generator);
        blocks.extend([ComponentPart::Excitation, ComponentPart::Trace(trace)]);
    }
    if let Some(of) = &axis.error_table {
        blocks.push(ComponentPart::ErrorTable(Box::new(of.table.clone())));
    }
    let mut blocks: Vec<(String, ComponentPart)> = blocks
        .into_iter()
        .map(|block| (block.name().to_owned(), block))
        .collect();
    if axis.scale.is_some() {
        blocks.push((SCALE_COUNTER.to_owned(), ComponentPart::PulseCounter));
        blocks.push(("linear_scale".to_owned(), ComponentPart::LinearScale));
        if axis.corrects {
            blocks.push(("realign".to_owned(), ComponentPart::Realign));
        }
        if axis.deviation_lasts() {
            blocks.push(("lasting_deviation".to_owned(), ComponentPart::LastingDeviation));
        }
    }
    let (driven, mut read) = hardware(&axis_window(axis));
    if axis.compare.is_some() && axes < MOST_AXES {
        read.push(compare::INTERRUPT.0.to_owned());
    }
    let names = |lists: &[&[&str]]| -> Vec<String> {
        let all = lists.iter().flat_map(|list| list.iter());
        all.map(|name| (*name).to_owned()).collect()
    };
    let mut inputs = names(&[&SHARED, &FROM_STAGE, &input_pins(axis)]);
    inputs.retain(|name| name != PLL_LOCKED || axis.closed_loop().is_some());
    inputs.extend(driven);
    let mut outputs = names(&[&TO_STAGE, &output_pins(axis)]);
    if axis.absolute().is_some() {
        let lacks = |name: &String| absolute::LACKS_NETS.contains(&name.as_str());
        inputs.retain(|name| !lacks(name));
        outputs.retain(|name| !lacks(name));
        read.retain(|name| name != absolute::LACKS_INTERRUPT);
    }
    let more = read.into_iter().filter(|name| !outputs.contains(name));
    let more: Vec<String> = more.collect();
    outputs.extend(more);
    let wiring = Wiring {
        part: Box::new(|block, part| wire(axis, tick_clocks, block, part)),
        inputs,
        outputs,
    };
    JoinedBlocks::new(&axis.name, blocks, wiring)
}

fn wire(axis: &StageAxis, tick_clocks: u32, block: &ComponentPart, part: Part) -> Part {
    let on_scale = axis.scale.is_some_and(|scale| scale.closes_loop);
    let loop_position = if on_scale { "loop_position" } else { "count" };
    let watched = &axis.supervision;
    match block {
        ComponentPart::Segments => on(part, SEGMENTS)
            .tied("modulo", axis.modulo.into())
            .on("preset_position", loop_position),
        ComponentPart::Shaper(_) => on(part, SHAPER),
        ComponentPart::SettingBanks(_) => on(part, SETTING_BANKS),
        ComponentPart::SlidingMode => on(part, CONTROLLER)
            .tied("modulo", axis.modulo.into())
            .on("position", measured(axis))
            .on(
                "start",
                if axis.absolute().is_some() {
                    absolute::CONTROL
                } else {
                    "control"
                },
            )
            .on("velocity", if on_scale { "loop_velocity" } else { "velocity" })
            .on("position_reference", reference(axis)),
        ComponentPart::PulseCounter if part.name() == SCALE_COUNTER => scale_counter(axis, part),
        ComponentPart::PulseCounter => {
            let part = on(part, PULSE_COUNTER).on("position", "user_position");
            match (&axis.follower, axis.bring_up) {
                (Follower::Steps(config), _) => steps::counter(config, axis.probe.is_some(), part),
                (Follower::Loop(of), Some(_)) => encoder(of, part)
                    .on("a", "counter_a")
                    .on("b", "counter_b")
                    .on("z", "counter_z"),
                (Follower::Loop(of), None) => encoder(of, part),
            }
        }
        ComponentPart::AbsoluteEncoder(_) => absolute::encoder(part),
        ComponentPart::AbsoluteFeedback => match axis.absolute() {
            Some(of) => absolute::feedback(of, part),
            None => part,
        },
        ComponentPart::StepGenerator(config) => steps::generator(config, reference(axis), part),
        ComponentPart::DriveCommand => on(part, DRIVE_COMMAND)
            .tied("direct_hold_ticks", watched.direct_hold_ticks.into())
            .tied("direct_limit", watched.direct_limit.into()),
        ComponentPart::Pwm(config) => match axis.closed_loop() {
            Some(of) => pwm(of, config, tick_clocks, on(part, PWM)).tied("filter_clocks", watched.filter_clocks.into()),
            None => part,
        },
        ComponentPart::Axis => supervisor(axis, part)
            .tied("modulo", axis.modulo.into())
            .on("position", loop_position),
        ComponentPart::LinearScale => match axis.scale {
            Some(scale) => on(part, LINEAR_SCALE)
                .on("align", if axis.corrects { ALIGN } else { "enabled" })
                .tied("ratio_mantissa", u64::from(scale.ratio.mantissa() as u32 & 0x3_ffff))
                .tied("ratio_shift", scale.ratio.shift().into())
                .tied("use_scale", on_scale.into()),
            None => part,
        },
        ComponentPart::Realign => part.on("align", ALIGN).on("correct", "realign"),
        ComponentPart::ProbeLine => match axis.probe {
            Some(probe) => part
                .tied("active_low", probe.active_low.into())
                .tied("filter_clocks", probe.filter_clocks.into())
                .on("touched", steps::TOUCHED),
            None => part,
        },
        ComponentPart::Compare => on(part, compare::NETS),
        ComponentPart::LastingDeviation => part
            .tied("limit", watched.deviation_limit.into())
            .tied("ticks", watched.deviation_ticks.into())
            .on("lasting", LASTING_DEVIATION),
        ComponentPart::ErrorTable(table) => part
            .on("measured", measured(axis))
            .on(
                "drive_enable",
                match axis.follower {
                    Follower::Loop(_) => "axis_drive_enable",
                    Follower::Steps(_) => "drive_enable",
                },
            )
            .on("position_reference", uncompensated(axis))
            .on(
                "valid",
                match axis.bring_up {
                    Some(_) => "reference_valid",
                    None => "shaper_valid",
                },
            )
            .tied(
                "on_measured",
                axis.error_table.as_ref().is_some_and(|of| of.on_measured).into(),
            )
            .tied("coarse", (table.format().unit == EntryUnit::Coarse).into()),
        ComponentPart::EncoderGenerator => on(part, GENERATOR)
            .tied("pin_a_n", 0)
            .tied("pin_b_n", 0)
            .tied("pin_z_n", 0),
        ComponentPart::Excitation => on(part, EXCITATION)
            .tied("amplitude_limit", watched.excitation_limit.into())
            .tied("modulo", axis.modulo.into()),
        ComponentPart::Trace(_) => trace(axis, part),
        _ => part,
    }
}

/// Where the axis is at the tick.
fn measured(axis: &StageAxis) -> &'static str {
    match axis.absolute() {
        Some(_) => absolute::POSITION,
        None => "captured_position",
    }
}

/// Where the axis is to be.
fn reference(axis: &StageAxis) -> &'static str {
    match axis.error_table {
        Some(_) => "compensated",
        None => uncompensated(axis),
    }
}

/// Connections of the PWM, whose mode and times the machine file fixes.
fn pwm(of: &StageLoop, config: &PwmConfig, tick_clocks: u32, part: Part) -> Part {
    let period = u64::from(of.pwm_period_clocks & 0xffff);
    let watchdog = (WATCHDOG_TICKS * tick_clocks / of.pwm_period_clocks.max(1)).clamp(1, 255);
    part.tied("mode", of.pwm_mode as u64)
        .tied("period", period)
        .tied("max_duty", of.pwm_period_clocks.min(0xffff).into())
        .tied("update_at_peak", 0)
        .tied("dead_time", config.dead_time_floor_clocks().into())
        .tied("minimum_pulse", config.minimum_pulse_floor_clocks().into())
        .tied("phase", 0)
        .tied("watchdog_periods", watchdog.into())
}

/// Where the axis is to be, without its error table.
fn uncompensated(axis: &StageAxis) -> &'static str {
    match axis.bring_up {
        Some(_) => "position_reference",
        None => "shaped_position",
    }
}

pub(super) fn on(part: Part, nets: Nets) -> Part {
    nets.iter().fold(part, |part, (port, net)| part.on(port, net))
}

/// Connections that all counters have in common.
pub(super) fn counter(part: Part) -> Part {
    let zeros = ["a_n", "b_n", "z_n", "differential", "swap"];
    zeros
        .iter()
        .fold(part, |part, port| part.tied(port, 0))
        .tied("timeout", VELOCITY_TIMEOUT)
}

/// Connections of the counter of an encoder.
fn encoder(of: &StageLoop, part: Part) -> Part {
    quadrature(of.encoder_filter_clocks, part).on("invert", "encoder_invert")
}

fn quadrature(filter_clocks: u32, part: Part) -> Part {
    counter(part)
        .tied("filter_clocks", filter_clocks.into())
        .tied("mode", 0)
}

/// Connections of the scale's counter, which only counts: its velocity is not divided.
fn scale_counter(axis: &StageAxis, part: Part) -> Part {
    let filter_clocks = axis
        .closed_loop()
        .map_or(steps::SCALE_FILTER_CLOCKS, |of| of.encoder_filter_clocks);
    let part = quadrature(filter_clocks, on(part, SCALE));
    let zeros = [
        "z",
        "index_arm",
        "index_always",
        "index_presets",
        "index_gate",
        "preset",
        "preset_value",
        "velocity_m",
        "smoothing",
        "quotient_valid",
        "quotient",
    ];
    let part = zeros.iter().fold(part, |part, port| part.tied(port, 0));
    let outputs: Vec<String> = part
        .ports()
        .iter()
        .filter(|port| port.direction == Direction::Output)
        .map(|port| port.name.clone())
        .collect();
    outputs
        .iter()
        .fold(part, |part, name| part.on(name, &format!("scale_{name}")))
}

fn supervisor(axis: &StageAxis, part: Part) -> Part {
    let watched = &axis.supervision;
    let part = on(part, AXIS)
        .tied("filter_clocks", watched.filter_clocks.into())
        .tied("brake_release_ticks", watched.brake_release_ticks.into())
        .tied("brake_apply_ticks", watched.brake_apply_ticks.into())
        .tied("deviation_limit", watched.deviation_limit.into())
        .tied("saturation_ticks", watched.saturation_ticks.into())
        .tied("limits_after_homing", watched.limits_after_homing.into())
        .tied("lost_command", watched.lost_command.into())
        .tied("lost_ticks", watched.lost_ticks.into())
        .tied("watches_direction", watched.watches_direction.into());
    let part = match axis.follower {
        Follower::Loop(_) => on(part, AXIS_WITH_LOOP),
        Follower::Steps(_) => steps::supervisor(part),
    };
    let part = match axis.absolute() {
        Some(_) => absolute::supervisor(part),
        None => part,
    };
    match axis.scale {
        Some(_) if axis.deviation_lasts() => part.on("deviation", LASTING_DEVIATION),
        Some(_) => part,
        None => part
            .tied("deviation", 0)
            .tied("scale_illegal", 0)
            .tied("scale_disagreement", 0),
    }
}

/// Connections of the trace memory. A signal of a block that is not built is recorded as 0.
fn trace(axis: &StageAxis, part: Part) -> Part {
    let strobe = match axis.follower {
        Follower::Loop(_) => "controller_valid",
        Follower::Steps(_) => "control",
    };
    let nets = TRACED.map(|(net, _)| {
        let lacks = match net {
            "deviation" => axis.scale.is_none(),
            net => axis.steps().is_some() && steps::LACKS_SIGNALS.contains(&net),
        };
        let net = if net == "captured_position" {
            measured(axis)
        } else {
            net
        };
        (!lacks).then_some(net)
    });
    trace::connect(part, nets)
        .on("strobe", strobe)
        .on("trigger_event", "started")
}
