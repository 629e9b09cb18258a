//! What a run of a stage reached, measured at its internal nets.
//!
//! The pins show little of a stage, and a host sees only what it reads. Therefore a second model gets the same
//! inputs, and its nets are observed in every clock.

use posicast_blocks::ClockedBlock;
use posicast_blocks::axis::{Cause, SupervisorState, TRANSITIONS};
use posicast_blocks::component::Component;
use posicast_blocks::composition::Composed;
use posicast_blocks::registers::{Access, RegisterMap, WINDOW_WORDS};
use posicast_blocks::stage::AXIS_INTERRUPTS;

/// Words of an axis's window whose flags are counted: states and flags of motion and supervision.
const COUNTED_WORDS: std::ops::Range<u32> = 0x28..0x2e;
/// Nets that never become active in a stage, and the reason.
///
/// | net | reason |
/// |---|---|
/// | `segments_tick_missed`, `shaper_overrun`, `controller_overrun`, `velocity_missed` | the schedule fits its tick, which a test checks |
/// | `encoder_disagreement` | the lines are single-ended: no pair can disagree |
/// | `pwm_unaligned` | the PWM's period divides the tick |
const NEVER: [&str; 6] = [
    "segments_tick_missed",
    "shaper_overrun",
    "controller_overrun",
    "velocity_missed",
    "encoder_disagreement",
    "pwm_unaligned",
];
/// Causes that cannot occur in a stage: a pass that is not over in time, and a deviation from a scale where there is
/// none.
const NEVER_CAUSES: [Cause; 2] = [Cause::Schedule, Cause::Deviation];

/// The event that a counter counts.
#[derive(Debug, Clone, Copy)]
enum Counts {
    /// Clocks in which the bits of a net under this mask have this value.
    Level(u64, u64),
    /// Changes of a net.
    Changes,
    /// Changes of a net from one value to another.
    From(u64, u64),
    /// Rising edges of the bits of a net under this mask.
    Rises(u64),
}

#[derive(Debug, Clone)]
struct Bin {
    name: String,
    /// The net in the model, if there is one of that name.
    net: Option<usize>,
    counts: Counts,
    count: u64,
    before: u64,
}

/// Counts of what a run reached, by name.
pub struct StageCoverage {
    twin: Composed,
    bins: Vec<Bin>,
    outputs: Vec<u64>,
}

impl StageCoverage {
    /// Creates counters at zero.
    pub fn new(component: &Component, axes: &[String]) -> Self {
        let twin = component.model(0);
        let outputs = component.composition().ports().iter();
        let outputs = outputs.filter(|port| port.direction == posicast_blocks::Direction::Output);
        let mut coverage = Self {
            outputs: vec![0; outputs.count()],
            twin,
            bins: Vec::new(),
        };
        for net in ["start_refused", "irq", "tick", "group_emergency_stop"] {
            coverage.bin(net, net, Counts::Rises(1));
        }
        for (window, axis) in (1..).zip(axes) {
            coverage.axis(component.map(), window, axis, axes.len());
        }
        coverage
    }

    fn bin(&mut self, name: &str, net: &str, counts: Counts) {
        self.bins.push(Bin {
            name: name.to_owned(),
            net: self.twin.net(net),
            counts,
            count: 0,
            before: 0,
        });
    }

    fn axis(&mut self, map: &RegisterMap, window: u32, axis: &str, axes: usize) {
        let net = |name: &str| format!("{axis}_{name}");
        let alone = axes == 1;
        for state in SupervisorState::ALL {
            let name = format!("{axis} {}", state.name());
            self.bin(&name, &net("state"), Counts::Level(7, state as u64));
        }
        let mut pairs: Vec<_> = TRANSITIONS.iter().map(|row| (row.from, row.to)).collect();
        pairs.dedup();
        for (from, to) in pairs {
            let name = format!("{axis} {} to {}", from.name(), to.name());
            self.bin(&name, &net("state"), Counts::From(from as u64, to as u64));
        }
        for cause in Cause::ALL {
            let of_others = alone && cause == Cause::GroupStop;
            if !of_others && !NEVER_CAUSES.contains(&cause) {
                let name = format!("{axis} {}", cause.name());
                self.bin(&name, &net("causes"), Counts::Rises(cause.bit().into()));
            }
        }
        let words = map.registers().iter().filter(|register| {
            register.offset / WINDOW_WORDS == window && COUNTED_WORDS.contains(&(register.offset % WINDOW_WORDS))
        });
        let shown = words.filter(|register| matches!(register.access, Access::Live | Access::Sticky));
        for field in shown.flat_map(|register| &register.fields) {
            let never = NEVER.iter().any(|name| field.name == net(name));
            if field.width == 1 && !never {
                self.bin(&field.name, &field.name, Counts::Level(1, 1));
            }
        }
        // An axis with an absolute encoder has no index.
        for (interrupt, _) in AXIS_INTERRUPTS {
            if self.twin.net(&net(interrupt)).is_none() {
                continue;
            }
            let name = format!("{axis} interrupt {interrupt}");
            self.bin(&name, &net(interrupt), Counts::Rises(1));
        }
        for (bit, trip) in ["fault latch", "supervisor", "drive", "PLL"].into_iter().enumerate() {
            let name = format!("{axis} trip by {trip}");
            self.bin(&name, &net("trip_causes"), Counts::Rises(1 << bit));
        }
        let direct = net("direct_active");
        for (name, net, counts) in [
            ("start accepted", net("axis_start"), Counts::Rises(1)),
            ("swap done", net("table_bank"), Counts::Changes),
            ("commit applied", net("law_bank"), Counts::Changes),
            ("law changed", net("law"), Counts::Changes),
            ("direct mode", direct, Counts::Rises(1)),
            ("origin moved", net("origin"), Counts::Changes),
            ("FIFO full", net("fifo_level"), Counts::Level(0x7f, 64)),
        ] {
            self.bin(&format!("{axis} {name}"), &net, counts);
        }
        if !alone {
            self.bin(&format!("{axis} group stop"), &net("group_stop"), Counts::Rises(1));
        }
    }

    /// Adds a clock, given its inputs.
    pub fn observe(&mut self, inputs: &[u64]) {
        if self.twin.step(inputs, &mut self.outputs).is_err() {
            return;
        }
        for bin in &mut self.bins {
            let Some(net) = bin.net else {
                continue;
            };
            let value = self.twin.value(net);
            bin.count += u64::from(match bin.counts {
                Counts::Level(mask, wanted) => value & mask == wanted,
                Counts::Changes => value != bin.before,
                Counts::From(from, to) => (bin.before, value) == (from, to),
                Counts::Rises(bits) => value & !bin.before & bits != 0,
            });
            bin.before = value;
        }
    }

    /// Returns each event's name and count.
    pub fn counts(&self) -> Vec<(String, u64)> {
        self.bins.iter().map(|bin| (bin.name.clone(), bin.count)).collect()
    }
}
