//! Records the events of an axis from the fault on, each with its clock.

use posicast_blocks::axis::SupervisorState;
use posicast_blocks::stage::Supervision;

use super::expectation::Seen;
use super::machine::{LOST_TICKS, SATURATION_TICKS};
use crate::stage_bench::{Probe, StageBench};
use posicast_testbench::Error;

/// Nets that are read; an axis with steps has none of a controller, and one without a scale no deviation. They count as 0.
struct Probes {
    state: Probe,
    causes: Probe,
    error: Option<Probe>,
    error_limit: Option<Probe>,
    deviation: Option<Probe>,
    shaped: Probe,
    soft_plus: Probe,
    soft_minus: Probe,
    count: Probe,
    command: Option<Probe>,
    command_position: Probe,
    limited_ticks: Option<Probe>,
    underrun: Probe,
    overflow: Probe,
    cut_high: Option<Probe>,
    cut_low: Option<Probe>,
    steps_tripped: Option<Probe>,
}

/// An axis in the clock in which its state first differed from that at the fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Change {
    /// Number of the clock.
    pub(super) clock: u64,
    /// The new state.
    pub(super) state: u64,
    /// Causes in that state.
    pub(super) causes: u32,
    /// Larger change of the command in the last two ticks, in 1/256 counts.
    pub(super) travel: u32,
}

/// Observation of an axis from the fault on.
pub(super) struct Observation {
    axis: usize,
    probes: Probes,
    /// State at the fault.
    from: SupervisorState,
    lost_command: u32,
    deviation_limit: u32,
    /// Ticks for which a deviation may last, and those for which it has lasted.
    deviation_ticks: u64,
    deviates: u64,
    still: Still,
    pulsing: bool,
    /// Command at the last tick, and its change in each of the last two.
    command: i32,
    travel: [u32; 2],
    /// The first other state.
    pub(super) change: Option<Change>,
    /// Clock in which the detection condition first held.
    pub(super) seen: Option<u64>,
    /// Last clock with a gate on, or in which a step began.
    pub(super) last_gate: u64,
    /// First clock with the drive disabled.
    pub(super) drive_off: Option<u64>,
    /// First clock with the brake applied.
    pub(super) brake: Option<u64>,
    /// First clock after QUICK_STOP.
    pub(super) stood: Option<u64>,
}

/// Consecutive ticks with a command in one direction and without a motion, and the position at their start.
#[derive(Default)]
struct Still {
    count: i32,
    backwards: bool,
    ticks: u64,
}

impl Observation {
    /// Starts the observation of an axis in this state.
    pub(super) fn new(
        bench: &StageBench,
        axis: usize,
        watched: &Supervision,
        from: SupervisorState,
    ) -> Result<Self, Error> {
        let name = &bench.axes()[axis];
        let probe = |net: &str| bench.probe(&format!("{name}_{net}"));
        Ok(Self {
            axis,
            from,
            probes: Probes {
                state: probe("state")?,
                causes: probe("causes")?,
                error: probe("error").ok(),
                error_limit: probe("following_error_limit").ok(),
                deviation: probe("deviation").ok(),
                shaped: probe("shaped_position")?,
                soft_plus: probe("soft_limit_plus")?,
                soft_minus: probe("soft_limit_minus")?,
                count: probe("count")?,
                command: probe("command").ok(),
                command_position: probe("command_position")?,
                limited_ticks: probe("limited_ticks").ok(),
                underrun: probe("segments_underrun")?,
                overflow: probe("segments_overflow")?,
                cut_high: probe("controller_saturated_high").ok(),
                cut_low: probe("controller_saturated_low").ok(),
                steps_tripped: probe("steps_tripped").ok(),
            },
            lost_command: watched.lost_command,
            deviation_limit: watched.deviation_limit,
            deviation_ticks: watched.deviation_ticks.into(),
            deviates: 0,
            still: Still::default(),
            pulsing: false,
            command: bench.at(probe("command_position")?) as u32 as i32,
            travel: [0; 2],
            change: None,
            seen: None,
            last_gate: 0,
            drive_off: None,
            brake: None,
            stood: None,
        })
    }

    /// The state in the next clock.
    pub(super) fn state(&self, bench: &StageBench) -> u64 {
        bench.at(self.probes.state)
    }

    /// The causes in the next clock.
    pub(super) fn causes(&self, bench: &StageBench) -> u32 {
        bench.at(self.probes.causes) as u32
    }

    /// Whether the shaped command has reached the command.
    pub(super) fn settled(&self, bench: &StageBench) -> bool {
        bench.at(self.probes.shaped) == bench.at(self.probes.command_position)
    }

    /// Records, before a clock, what registers show in it.
    pub(super) fn before(&mut self, bench: &StageBench, tick: bool) {
        let (now, state) = (bench.now(), self.state(bench));
        if state != self.from as u64 && self.change.is_none() {
            self.change = Some(Change {
                clock: now,
                state,
                causes: self.causes(bench),
                travel: self.travel[0].max(self.travel[1]),
            });
        }
        if self.change.is_some() && state != SupervisorState::QuickStop as u64 && self.stood.is_none() {
            self.stood = Some(now);
        }
        if tick {
            self.follow_command(bench);
        }
    }

    /// Records the command once per tick.
    pub(super) fn follow_command(&mut self, bench: &StageBench) {
        let command = bench.at(self.probes.command_position) as u32 as i32;
        self.travel = [command.wrapping_sub(self.command).unsigned_abs(), self.travel[0]];
        self.command = command;
    }

    /// Checks the detection condition, which for most monitors counts at ticks only.
    pub(super) fn look_for(&mut self, bench: &StageBench, seen: Seen, tick: bool) {
        let value = |probe: Option<Probe>| probe.map_or(0, |probe| bench.at(probe));
        let signed = |probe: Option<Probe>| value(probe) as u32 as i32;
        let size = |value: i32| (value ^ (value >> 31)) as u32;
        let probes = &self.probes;
        if tick {
            let beyond = size(signed(probes.deviation)) > self.deviation_limit;
            self.deviates = if beyond { self.deviates + 1 } else { 0 };
        }
        let deviates = self.deviation_limit != 0 && self.deviates > self.deviation_ticks;
        let is_stuck = value(probes.limited_ticks) >= SATURATION_TICKS || self.still.ticks >= LOST_TICKS;
        let is = match seen {
            Seen::Segments => (value(Some(probes.underrun)) | value(Some(probes.overflow))) != 0,
            Seen::StepsTripped => value(probes.steps_tripped) != 0,
            Seen::Range => (value(probes.cut_high) | value(probes.cut_low)) & 1 != 0,
            _ if !tick => false,
            Seen::FollowingError => u64::from(size(signed(probes.error))) > value(probes.error_limit),
            Seen::Deviation => deviates,
            Seen::Lost => deviates || is_stuck,
            Seen::SoftLimit => {
                let shaped = signed(Some(probes.shaped));
                shaped > signed(Some(probes.soft_plus)) || shaped < signed(Some(probes.soft_minus))
            }
            Seen::Stuck => is_stuck,
        };
        if is {
            self.seen.get_or_insert(bench.now());
        }
        if tick {
            let (count, command) = (signed(Some(probes.count)), signed(probes.command));
            let motion = count.wrapping_sub(self.still.count);
            let one_way = (command < 0) == self.still.backwards;
            let [backward, forward] = [motion < -4, motion >= 4];
            // A motion against the command does not count as motion, but distances count from there on.
            let its_way = if command < 0 { backward } else { forward };
            if size(command) > self.lost_command && one_way && !its_way {
                self.still.ticks += 1;
                if backward || forward {
                    self.still.count = count;
                }
            } else {
                self.still = Still {
                    count,
                    backwards: command < 0,
                    ticks: 0,
                };
            }
        }
    }

    /// Records, after some clocks, the levels of the pins in the last of them.
    pub(super) fn after(&mut self, bench: &StageBench) {
        let (pins, last) = (bench.pins(self.axis), bench.now() - 1);
        // A pulse that has begun ends in its time: of steps, the beginning counts.
        let begins = pins.a_high && !std::mem::replace(&mut self.pulsing, pins.a_high);
        let on = match self.probes.steps_tripped {
            Some(_) => begins,
            None => pins.a_high || pins.a_low || pins.b_high || pins.b_low,
        };
        if on {
            self.last_gate = last;
        }
        if !pins.drive_enable {
            self.drive_off.get_or_insert(last);
        }
        if !pins.brake_release {
            self.brake.get_or_insert(last);
        }
    }
}
