//! Warns about guards that an axis lacks because the machine file does not request them, and about the consequences; and about
//! cables that are too long for the clock of an encoder.

use crate::warning::Warning;
use posicast_blocks::absolute_encoder::AbsoluteProtocol;
use posicast_machine::control::{LostSign, lost_sign};
use posicast_machine::machine_file::{AxisSection, CABLE_DELAY_S_PER_M, ClockSection, LimitsSection, Machine};
use posicast_shaper::unit::trimmed;

/// A following error of fewer counts than this is most likely meant in another unit.
const LEAST_COUNTS: f64 = 4.0;

/// Largest product of a line's bit rate and its length, bit·m/s: the guideline of TIA-422-B, 10 Mbit/s over 12 m. A clock of f Hz has
/// 2 f bits per s.
const BITS_BY_METRES: f64 = 120e6;
/// Delay of drivers and encoder, s.
const DRIVERS_S: f64 = 300e-9;

/// A guard, whether a file has it, and the possible consequences without it.
struct Guard {
    key: &'static str,
    is_set: fn(&AxisSection, &LimitsSection) -> bool,
    without: &'static str,
}

const GUARDS: [Guard; 4] = [
    Guard {
        key: "following_error",
        is_set: |_, limits| limits.following_error.is_some(),
        without: "an axis that does not follow (a slipping coupling, an encoder line that is stuck) runs on at full command and \
                  raises no cause",
    },
    Guard {
        key: "encoder_lost_s",
        is_set: |_, limits| limits.encoder_lost_s > 0.0,
        without: "an encoder that is unplugged lets the loop drive at full command until something stops it",
    },
    Guard {
        key: "watchdog_s",
        is_set: |_, limits| limits.watchdog_s > 0.0,
        without: "a host that hangs leaves the axis moving, and the outputs on",
    },
    Guard {
        key: "travel",
        is_set: |axis, limits| axis.modulo || limits.travel.is_some(),
        without: "a wrong command drives the axis into its end stops, and posicast cannot check that the position word holds the travel",
    },
];

/// A warning for every guard that an axis with a controller lacks.
pub(crate) fn missing(machine: &Machine) -> Vec<Warning> {
    let axes = machine.axes.iter().enumerate();
    let loops = axes.filter(|(_, axis)| axis.controller.is_some());
    let of_axis = |(index, axis): (usize, &'_ AxisSection)| {
        let limits = axis.limits.unwrap_or_default();
        let absent = GUARDS.iter().filter(|guard| !(guard.is_set)(axis, &limits));
        let texts = absent.map(|guard| {
            let text = format!(
                "axis `{}` has no {} in [axis.limits]: {}",
                axis.name, guard.key, guard.without
            );
            Warning::new(index, format!("axis.limits.{}", guard.key), text)
        });
        let sign = sign(axis, &limits).map(|text| Warning::new(index, "axis.limits.encoder_lost_s", text));
        let tight = tight(axis, &limits).map(|text| Warning::new(index, "axis.limits.following_error", text));
        texts.chain(sign).chain(tight).collect::<Vec<_>>()
    };
    loops.flat_map(of_axis).collect()
}

/// A warning for every cable of an absolute encoder that is too long for its clock.
pub(crate) fn long_cables(machine: &Machine) -> Vec<Warning> {
    let axes = machine.axes.iter().enumerate();
    axes.filter_map(|(index, axis)| {
        let text = long_cable(axis, &machine.clock)?;
        Some(Warning::new(index, "axis.encoder.cable_m", text))
    })
    .collect()
}

fn long_cable(axis: &AxisSection, clock: &ClockSection) -> Option<String> {
    let absolute = axis.absolute_encoder()?;
    let cable_m = absolute.cable_m?;
    let line_hz = absolute.times.line_hz;
    let of_bandwidth = BITS_BY_METRES / (2.0 * line_hz);
    // A bit of SSI is taken three clocks before the next edge, whatever the line delays.
    let of_delay = match absolute.protocol {
        AbsoluteProtocol::Ssi => (1.0 / line_hz - 3.0 / clock.frequency_hz - DRIVERS_S) / CABLE_DELAY_S_PER_M,
        AbsoluteProtocol::BissC => f64::INFINITY,
    };
    let (most_m, why) = if of_delay < of_bandwidth {
        (of_delay.max(0.0), "SSI does not compensate the delay of the line")
    } else {
        (of_bandwidth, "the guideline of RS-422, 10 Mbit/s over 12 m")
    };
    (cable_m > most_m).then(|| {
        format!(
            "axis `{}` reads its encoder at {} kHz over {} m of cable: at most {} m are advisable at that clock ({why}); lower clock_hz",
            axis.name,
            trimmed(line_hz / 1e3, 1),
            trimmed(cable_m, 1),
            trimmed(most_m, 1)
        )
    })
}

/// A warning if the encoder's own steps exceed the following error, which is too small.
fn tight(axis: &AxisSection, limits: &LimitsSection) -> Option<String> {
    let limit = limits.following_error?;
    let counts = limit * axis.loop_counts_per_unit();
    (counts < LEAST_COUNTS).then(|| {
        format!(
            "axis `{}` has a following_error of {}, which is only {} of its encoder's counts: the encoder's own steps switch the axis \
             off; the figure is in the axis's unit, {}",
            axis.name,
            axis.unit.as_in_file(limit, ""),
            trimmed(counts, 2),
            axis.unit
        )
    })
}

/// A warning if neither the following error nor the encoder monitor detects a feedback of the wrong sign.
fn sign(axis: &AxisSection, limits: &LimitsSection) -> Option<String> {
    let remedy = match lost_sign(axis) {
        _ if limits.following_error.is_some() => return None,
        LostSign::Watched => return None,
        LostSign::TooShort { least_s } => format!(
            "within `encoder_lost_s` = {} an axis at `velocity` cannot stop; set following_error, or encoder_lost_s to {:.3} or more",
            limits.encoder_lost_s,
            (1e3 * least_s).ceil() / 1e3
        ),
        LostSign::Unknown => {
            "set following_error, or encoder_lost_s (with a torque drive also velocity, and an encoder_lost_command above 0)"
                .to_owned()
        }
    };
    Some(format!(
        "axis `{}` does not detect a wrong feedback sign (`invert` of [axis.encoder]); it would run away at full command until it is \
         32,768 counts off, {}: {remedy}",
        axis.name,
        axis.unit.show(32_768.0 / axis.loop_counts_per_unit(), 3)
    ))
}
