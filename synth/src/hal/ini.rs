//! The INI file: the machine's limits in LinuxCNC's units.

use super::{HalAxis, HalMachine};
use std::fmt::Write;

/// Servo periods from a command to the end of the stage's FIFO: two in the FIFO, one that is played, one for the
/// interpolation.
const LATENCY_PERIODS: f64 = 4.0;
/// Fraction of the largest velocity at which an axis searches for its index.
const INDEX_SEARCH: f64 = 0.02;
/// Following error that LinuxCNC allows if the stage has no limit: the distance covered in this time in seconds at full
/// velocity.
const FOLLOWING_S: f64 = 0.01;
/// Travel in mm or degrees if the machine file has none.
const TRAVEL: [f64; 2] = [-1e6, 1e6];

/// Returns the text of the file.
pub(super) fn text(machine: &HalMachine<'_>, letters: &[char]) -> String {
    let coordinates: String = letters.iter().collect();
    let spaced: Vec<String> = letters.iter().map(char::to_string).collect();
    let linear = machine.axes.iter().filter(|axis| !axis.rotary);
    let velocity = linear.map(|axis| axis.velocity).fold(0.0, f64::max);
    let velocity = if velocity > 0.0 {
        velocity
    } else {
        machine.axes.iter().map(|axis| axis.velocity).fold(0.0, f64::max)
    };
    let mut text = format!(
        "# {name} in LinuxCNC. Written by posicast; docs/linuxcnc.md says how to begin.
[EMC]
MACHINE = {name}
VERSION = 1.1

[POSICAST]
# The stage's registers: uio:/dev/uio0, or unix:PATH of a simulated stage.
STAGE = uio:/dev/uio0
# How long the servo thread may be silent before the stage stops the axes.
WATCHDOG_MS = 20

[DISPLAY]
DISPLAY = axis

[RS274NGC]
PARAMETER_FILE = {name}.var

[EMCMOT]
EMCMOT = motmod
COMM_TIMEOUT = 1.0
SERVO_PERIOD = {servo_ns}

[TASK]
TASK = milltask
CYCLE_TIME = 0.010

[HAL]
HALFILE = {name}.hal

[TRAJ]
COORDINATES = {spaced}
LINEAR_UNITS = mm
ANGULAR_UNITS = degree
DEFAULT_LINEAR_VELOCITY = {default}
MAX_LINEAR_VELOCITY = {velocity}

[EMCIO]
EMCIO = io
CYCLE_TIME = 0.1

[KINS]
KINEMATICS = trivkins coordinates={coordinates}
JOINTS = {joints}
",
        name = machine.name,
        servo_ns = machine.servo_ns(),
        spaced = spaced.join(" "),
        default = figure(velocity / 5.0),
        velocity = figure(velocity),
        joints = machine.axes.len(),
    );
    for (number, (axis, letter)) in machine.axes.iter().zip(letters).enumerate() {
        write_axis(&mut text, machine, number, axis, *letter);
    }
    text
}

fn write_axis(text: &mut String, machine: &HalMachine<'_>, number: usize, axis: &HalAxis<'_>, letter: char) {
    let [low, high] = axis.travel.unwrap_or(TRAVEL);
    let lag = axis.velocity * (axis.delay_s + LATENCY_PERIODS / machine.servo_hz);
    let following = lag + axis.following_error.unwrap_or(FOLLOWING_S * axis.velocity);
    let limits = format!(
        "MIN_LIMIT = {}\nMAX_LIMIT = {}\nMAX_VELOCITY = {}\nMAX_ACCELERATION = {}\n",
        figure(low),
        figure(high),
        figure(axis.velocity),
        figure(axis.acceleration),
    );
    let [home, offset] = axis.probe.map_or([0.0; 2], |probe| [probe.rest, probe.position]);
    let homing = match (axis.probe, axis.index) {
        // One approach, at the velocity at which the contact counts: the hardware latches it.
        (Some(probe), _) => format!(
            "HOME_SEARCH_VEL = 0\nHOME_LATCH_VEL = {}\nHOME_USE_INDEX = YES\n",
            figure(probe.velocity)
        ),
        // This is only for the index: an axis with a switch also needs HOME_SEARCH_VEL.
        (None, true) => format!(
            "HOME_SEARCH_VEL = 0\nHOME_LATCH_VEL = {}\nHOME_USE_INDEX = YES\n",
            figure(INDEX_SEARCH * axis.velocity)
        ),
        (None, false) if axis.absolute => {
            "HOME_SEARCH_VEL = 0\nHOME_LATCH_VEL = 0\nHOME_ABSOLUTE_ENCODER = 2\n".to_owned()
        }
        (None, false) => "HOME_SEARCH_VEL = 0\nHOME_LATCH_VEL = 0\n".to_owned(),
    };
    let kind = if axis.rotary { "ANGULAR" } else { "LINEAR" };
    let _ = write!(
        text,
        "\n[AXIS_{letter}]\n{limits}
[JOINT_{number}]
TYPE = {kind}
{limits}# The stage's limit, and what shaper and FIFO are behind at full velocity.
FERROR = {following}
MIN_FERROR = {following}
HOME = {home}
HOME_OFFSET = {offset}
{homing}HOME_SEQUENCE = 0
",
        following = figure(following),
        home = figure(home),
        offset = figure(offset),
    );
}

/// A figure with at most six significant digits, because the machine file's conversion leaves rounding errors.
fn figure(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    rounded.to_string()
}
