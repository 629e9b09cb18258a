//! What a run of the supervisor reached, and the rules that it must never violate.

use posicast_blocks::Direction;
use posicast_blocks::axis::{
    AT_ONCE, CAUSE_BITS, Cause, HARMLESS, INPUT_PORTS, Inputs, LINE_CLOCKS, OUTPUT_PORTS, Outputs, SupervisorState,
    TRANSITIONS, ports, switching_off,
};

/// Returns the inputs and outputs of a clock as structures; `None` if `state` is not a valid state.
fn typed(inputs: &[u64], outputs: &[u64]) -> Option<(Inputs, Outputs)> {
    let inputs = <&[u64; INPUT_PORTS]>::try_from(inputs).ok()?;
    let outputs = <&[u64; OUTPUT_PORTS]>::try_from(outputs).ok()?;
    let shown = Outputs::from_raw(outputs);
    (shown.to_raw() == *outputs).then(|| (Inputs::from_raw(inputs), shown))
}

/// Rare events that are counted besides states, transitions and causes.
const SPECIAL: [&str; 6] = [
    "host stop",
    "enable low",
    "group stop",
    "fault while the brake closes",
    "quick stop, then the brake",
    "outputs off after the brake",
];

/// Counts of what a run reached.
#[derive(Debug, Clone, Default)]
pub struct AxisCoverage {
    /// Number of clocks in which each one-bit output port was 1.
    levels: [u64; OUTPUT_PORTS],
    /// Number of transitions from a state to another; on the diagonal, the number of clocks in the state.
    changes: [[u64; 6]; 6],
    /// Number of times that each cause became active, and was cleared.
    causes: [[u64; 2]; CAUSE_BITS as usize],
    special: [u64; SPECIAL.len()],
    before: Option<(Inputs, Outputs)>,
}

impl AxisCoverage {
    /// Adds a clock.
    pub fn observe(&mut self, inputs: &[u64], outputs: &[u64]) {
        let Some((now, shown)) = typed(inputs, outputs) else {
            return;
        };
        for (count, value) in self.levels.iter_mut().zip(outputs) {
            *count += value & 1;
        }
        if let Some((inputs, before)) = self.before {
            self.changes(&inputs, &before, &shown);
        }
        self.before = (!now.rst).then_some((now, shown));
    }

    fn changes(&mut self, inputs: &Inputs, before: &Outputs, shown: &Outputs) {
        self.changes[before.state as usize][shown.state as usize] += 1;
        for (bit, [came, went]) in self.causes.iter_mut().enumerate() {
            let is = |causes: u32| u64::from(causes >> bit & 1);
            *came += is(shown.causes & !before.causes);
            *went += is(before.causes & !shown.causes);
        }
        let harmless = shown.causes & !HARMLESS == 0;
        let special = match (before.state, shown.state) {
            (SupervisorState::Run, SupervisorState::QuickStop) if harmless && inputs.stop => 0,
            (SupervisorState::Run, SupervisorState::QuickStop) if harmless && !inputs.enable => 1,
            (SupervisorState::Run, SupervisorState::QuickStop) if harmless => 2,
            (SupervisorState::Hold, SupervisorState::Fault) if shown.drive_enable => 3,
            (SupervisorState::QuickStop, SupervisorState::Fault) if shown.drive_enable => 4,
            (SupervisorState::Fault, SupervisorState::Fault) if before.drive_enable && !shown.drive_enable => 5,
            _ => return,
        };
        self.special[special] += 1;
    }

    /// Returns each event's name and count.
    pub fn counts(&self) -> Vec<(String, u64)> {
        let ports = ports();
        let outputs = ports.iter().filter(|port| port.direction == Direction::Output);
        let one_bit = outputs.zip(self.levels).filter(|(port, _)| port.width == 1);
        let levels = one_bit.map(|(port, count)| (port.name.clone(), count));
        let states =
            SupervisorState::ALL.map(|state| (state.name().to_owned(), self.changes[state as usize][state as usize]));
        let mut transitions: Vec<_> = TRANSITIONS.iter().map(|row| (row.from, row.to)).collect();
        transitions.dedup();
        let transitions = transitions.into_iter().map(|(from, to)| {
            let name = format!("{} to {}", from.name(), to.name());
            (name, self.changes[from as usize][to as usize])
        });
        let causes = Cause::ALL
            .into_iter()
            .zip(self.causes)
            .flat_map(|(cause, [came, went])| {
                [
                    (cause.name().to_owned(), came),
                    (format!("{} forgotten", cause.name()), went),
                ]
            });
        let special = SPECIAL.map(str::to_owned).into_iter().zip(self.special);
        levels
            .chain(states)
            .chain(transitions)
            .chain(causes)
            .chain(special)
            .collect()
    }
}

/// Checks rules for pins, brake and transitions that must hold in every clock, for any inputs.
#[derive(Debug, Clone, Default)]
pub struct AxisSafety {
    clock: u64,
    before: Option<(Inputs, Outputs)>,
    /// `off_causes` one clock earlier still.
    off_causes: u16,
    /// Number of ticks with the outputs on and the brake applied, and the number allowed.
    braked: Option<(u64, u64)>,
    /// Number of clocks since the emergency stop's line went low, and the longest filter during that time.
    low: (u64, u64),
    filter_before: u64,
    violations: Vec<String>,
}

impl AxisSafety {
    /// Checks a clock, given its inputs and the outputs before its edge.
    pub fn observe(&mut self, inputs: &[u64], outputs: &[u64]) {
        let Some((inputs, shown)) = typed(inputs, outputs) else {
            self.violated("an invalid state");
            return;
        };
        self.pins(&shown);
        self.brake(&inputs, &shown);
        self.emergency(&inputs, &shown);
        if let Some((inputs, before)) = self.before {
            self.transition(&inputs, &before, &shown);
        }
        self.off_causes = self.before.map_or(0, |(inputs, _)| inputs.off_causes);
        self.before = (!inputs.rst).then_some((inputs, shown));
        self.clock += 1;
    }

    /// Returns the first few violations, each with its clock and rule.
    pub fn violations(&self) -> &[String] {
        &self.violations
    }

    fn violated(&mut self, rule: &str) {
        if self.violations.len() < 20 {
            self.violations.push(format!("clock {}: {rule}", self.clock));
        }
    }

    fn pins(&mut self, shown: &Outputs) {
        let Outputs { state, .. } = *shown;
        let (on, released) = (shown.drive_enable, shown.brake_release);
        let is_on = matches!(
            state,
            SupervisorState::Hold | SupervisorState::Run | SupervisorState::QuickStop
        );
        let moves = matches!(state, SupervisorState::Run | SupervisorState::QuickStop);
        let rules = [
            (on != shown.pwm_enable, "drive and PWM differ"),
            (
                on && matches!(state, SupervisorState::Off | SupervisorState::Ready),
                "outputs on in OFF or READY",
            ),
            (is_on && !on, "outputs off in HOLD, RUN or QUICK_STOP"),
            (released && !on, "brake released with the outputs off"),
            (released && state == SupervisorState::Fault, "brake released in FAULT"),
            (moves && !released, "motion against the brake"),
            (
                shown.segments_enable != (state == SupervisorState::Run),
                "segments play outside of RUN",
            ),
            (shown.segments_preset == on, "command and position apart while off"),
            (!on && !shown.shaper_start, "shaper not held at the position while off"),
        ];
        for (broken, rule) in rules {
            if broken {
                self.violated(rule);
            }
        }
    }

    fn brake(&mut self, inputs: &Inputs, shown: &Outputs) {
        if !shown.drive_enable || shown.brake_release {
            self.braked = None;
            return;
        }
        // The timer is loaded in the first clock of the state.
        let at_entry = u64::from(inputs.brake_apply_ticks);
        let (ticks, allowed) = self.braked.unwrap_or((0, at_entry + 1));
        if ticks >= allowed {
            self.violated("outputs on against the brake for too long");
        }
        self.braked = Some((ticks + u64::from(inputs.tick), allowed));
    }

    fn emergency(&mut self, inputs: &Inputs, shown: &Outputs) {
        let (clocks, longest) = self.low;
        if clocks >= longest + u64::from(LINE_CLOCKS) && shown.drive_enable {
            self.violated("outputs on after an emergency stop");
        }
        let filter = u64::from(inputs.filter_clocks);
        self.low = match clocks {
            _ if inputs.emergency_stop_n || inputs.rst => (0, 0),
            0 => (1, filter.max(self.filter_before)),
            clocks => (clocks + 1, longest.max(filter)),
        };
        self.filter_before = filter;
    }

    /// Checks a transition. `inputs` and `before` are those of the clock before `shown`.
    fn transition(&mut self, inputs: &Inputs, before: &Outputs, shown: &Outputs) {
        let (from, to) = (before.state, shown.state);
        if from != to && !TRANSITIONS.iter().any(|row| (row.from, row.to) == (from, to)) {
            self.violated(&format!("{from:?} to {to:?} is not in the table"));
        }
        // A cause that is still active switches off by the value that `off_causes` had when it was registered.
        let stand = before.causes & shown.causes;
        let lines = shown.causes & !stand & AT_ONCE;
        let cut = switching_off(lines, inputs.off_causes) != 0
            || switching_off(stand, inputs.off_causes & self.off_causes) != 0;
        let at_once = inputs.pwm_tripped || inputs.group_emergency_stop;
        let is_off = !shown.drive_enable && matches!(to, SupervisorState::Fault | SupervisorState::Off);
        if (cut || at_once) && !is_off {
            self.violated("outputs on a clock after a cause that switches off");
        }
        let acts = lines | stand;
        if acts & !HARMLESS != 0
            && matches!(
                to,
                SupervisorState::Ready | SupervisorState::Hold | SupervisorState::Run
            )
        {
            self.violated("a cause without a stop");
        }
        if acts != 0 && to == SupervisorState::Run {
            self.violated("RUN with a cause");
        }
    }
}
