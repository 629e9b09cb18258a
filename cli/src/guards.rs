//! What does not watch over an axis, because the machine file does not ask for it, and what can then happen.

use posicast_model::machine_file::{Axis, Limits, Machine};

/// A guard, whether a file has it, and what can happen without.
struct Guard {
    key: &'static str,
    is_set: fn(&Axis, &Limits) -> bool,
    without: &'static str,
}

const GUARDS: [Guard; 4] = [
    Guard {
        key: "following_error",
        is_set: |_, limits| limits.following_error.is_some(),
        without: "an axis that does not follow (a slipping coupling, a wrong feedback sign, an encoder line that is stuck) runs on at \
                  full command and raises no cause",
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
        without: "a wrong command drives the axis into its end stops, and nothing says whether the position word holds its travel",
    },
];

/// A warning for every guard that an axis with a controller lacks.
pub(crate) fn missing(machine: &Machine) -> Vec<String> {
    let loops = machine.axes.iter().filter(|axis| axis.controller.is_some());
    let of_axis = |axis: &'_ Axis| {
        let limits = axis.limits.unwrap_or_default();
        let absent = GUARDS.iter().filter(|guard| !(guard.is_set)(axis, &limits));
        let texts = absent.map(|guard| {
            format!(
                "axis `{}` has no {} in [axis.limits]: {}",
                axis.name, guard.key, guard.without
            )
        });
        texts.collect::<Vec<_>>()
    };
    loops.flat_map(of_axis).collect()
}
