//! Checks the safety rules at the pins of a PWM or of a stage's axis in every clock, under any traffic.
//!
//! The two sides of a leg are never on together, and the dead time separates them. No gate is on in a clock of a raw
//! fault. With the drive disabled no gate is on, and the brake is applied.

use posicast_blocks::pwm::ActiveLow;
use posicast_blocks::{Direction, Port};
use posicast_testbench::lockstep::Clock;
use posicast_testbench::pwm::GateSafety;

/// The pins of an axis, or of a component alone.
pub(crate) struct Pins {
    name: String,
    gates: [usize; 4],
    raw_faults: Vec<usize>,
    enable_and_brake: Option<[usize; 2]>,
    safety: GateSafety,
    dead_time: u64,
    disabled_clocks: u64,
    violation: Option<String>,
}

impl Pins {
    /// Returns all pins of a block with these ports whose gates are active high.
    pub(crate) fn of(ports: &[Port], dead_time: u64) -> Vec<Self> {
        let place = |direction, name: &str| {
            let mut names = ports.iter().filter(|port| port.direction == direction);
            names.position(|port| port.name == name)
        };
        let output = |name: &str| place(Direction::Output, name);
        let prefixes = ports.iter().filter_map(|port| port.name.strip_suffix("a_high"));
        let pins = prefixes.filter_map(|prefix| {
            let name = |pin: &str| format!("{prefix}{pin}");
            let gate = |pin: &str| output(&name(pin));
            let faults = [name("fault_n"), "pll_locked".to_owned()];
            Some(Self {
                gates: [gate("a_high")?, gate("a_low")?, gate("b_high")?, gate("b_low")?],
                raw_faults: faults.iter().filter_map(|pin| place(Direction::Input, pin)).collect(),
                enable_and_brake: output(&name("drive_enable"))
                    .zip(output(&name("brake_release")))
                    .map(Into::into),
                safety: GateSafety::new(ActiveLow::default()),
                name: prefix.to_owned(),
                dead_time,
                disabled_clocks: 0,
                violation: None,
            })
        });
        pins.collect()
    }

    pub(crate) fn observe(&mut self, clock: &Clock<'_>) {
        let mut shown = [0; 16];
        for (gate, at) in shown.iter_mut().zip(self.gates) {
            *gate = clock.actual[at];
        }
        // `GateSafety` reads the dead time here.
        shown[15] = self.dead_time;
        self.safety.observe(&shown);
        let on = shown[..4].iter().any(|gate| *gate != 0);
        let mut broken = Vec::new();
        if on && self.raw_faults.iter().any(|at| clock.inputs[*at] == 0) {
            broken.push("a gate on under a raw fault");
        }
        if let Some([enable, brake]) = self.enable_and_brake {
            let enabled = clock.actual[enable] != 0;
            self.disabled_clocks = if enabled { 0 } else { self.disabled_clocks + 1 };
            if !enabled && clock.actual[brake] != 0 {
                broken.push("the brake released with the drive disabled");
            }
            // The gates' register comes after that of the enable.
            if on && self.disabled_clocks > 1 {
                broken.push("a gate on with the drive disabled");
            }
        }
        if let (Some(rule), None) = (broken.first(), &self.violation) {
            self.violation = Some(format!("{}clock {}: {rule}", self.name, clock.time));
        }
    }

    pub(crate) fn violation(&self) -> Option<&str> {
        self.violation.as_deref().or(self.safety.violation())
    }

    /// Returns whether a gate is on.
    pub(crate) fn is_on(&self, clock: &Clock<'_>) -> bool {
        self.gates.iter().any(|at| clock.actual[*at] != 0)
    }
}
