//! An axis of an example, from entries of the command FIFO to the machine and back.

use posicast_blocks::divider::{DIVISION_CLOCKS, DividerConfig};
use posicast_blocks::pulse_counter::{self, PulseCounter};
use posicast_blocks::pwm::{self, ActiveLow, Pwm, PwmConfig};
use posicast_blocks::segments::{Entry, Integrator};
use posicast_blocks::shaper::{MotionShaper, ShaperConfig, ShaperMotion};
use posicast_blocks::sliding_mode::{self, SettingRow, TickController};
use posicast_machine::control::{ControlSchedule, Derived, gains, loop_lag_s, schedule_delay_s};
use posicast_machine::machine_file::{self, Machine};
use posicast_machine::plan::design_machine;
use posicast_machine::plant::axis::{AxisMotion, AxisPlant, DrivePins, PlantOptions};
use posicast_shaper::axis::ShaperChoice;
use posicast_shaper::design::kind::ShaperKind;

pub(crate) const VELOCITY: &str = include_str!("../../../../examples/xy-stage.toml");
pub(crate) const TORQUE: &str = include_str!("../../../../examples/xy-stage-torque.toml");
const TICK_CLOCKS: u32 = 5_000;
const PERIOD_CLOCKS: i32 = 2_500;

/// Returns the machine of an example, with its shapers or without.
pub(crate) fn machine(text: &str, shaped: bool) -> Machine {
    let mut machine = machine_file::parse("example.toml", text).unwrap_or_else(|error| panic!("{error:?}"));
    if !shaped {
        for axis in &mut machine.axes {
            axis.shaper = Some(ShaperChoice::of_kind(ShaperKind::None));
        }
    }
    machine
}

/// Level of detail of the simulated hardware.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Pace {
    /// PWM and pulse counter are simulated clock by clock.
    Clocks,
    /// Pulses are ideal, the count is that of the plant, and velocities are counts per tick.
    Ticks,
}

/// Values recorded at a tick.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sample {
    /// Shaped reference in counts.
    pub(crate) reference: f64,
    /// Whether the unshaped command has ended.
    pub(crate) ended: bool,
    pub(crate) machine: AxisMotion,
}

/// The loop of an axis.
pub(crate) struct Chain {
    pace: Pace,
    shaper: MotionShaper,
    pub(crate) derived: Derived,
    divider: DividerConfig,
    control_clocks: u32,
    controller: TickController,
    pwm: Pwm,
    pub(crate) pwm_inputs: pwm::Inputs,
    pub(crate) counter: PulseCounter,
    /// Number of latched indices.
    pub(crate) indices: u32,
    counter_inputs: pulse_counter::Inputs,
    pub(crate) plant: AxisPlant,
    /// Whether the drive is enabled and the brake released.
    pub(crate) powered: bool,
    count_before: i64,
    duty: i32,
}

impl Chain {
    pub(crate) fn new(machine: &Machine, axis: usize, frequency_factor: f64, pace: Pace) -> Self {
        let table = design_machine(machine).unwrap().axes[axis].table.clone();
        let channels = ShaperMotion {
            channels: 3,
            modulo: false,
        };
        let shaper = ShaperConfig::new(32, table).unwrap().for_motion(channels).unwrap();
        let (axis, clock) = (&machine.axes[axis], machine.clock);
        let (pwm, drive) = (axis.pwm.unwrap(), axis.drive.unwrap());
        let periods = (clock.clocks_per_sample(), pwm.period_clocks(&clock) as i32);
        assert_eq!(periods, (TICK_CLOCKS, PERIOD_CLOCKS));
        let schedule = ControlSchedule::controlling(shaper.pass_clocks(shaper.most_products()));
        let lag_s = loop_lag_s(&drive, schedule_delay_s(&clock, &pwm, schedule.clocks()));
        let derived = gains(axis, clock, lag_s).unwrap();
        assert_eq!(derived.warnings, []);
        let (dead_time, minimum_pulse) = (pwm.dead_time_clocks(&clock), pwm.minimum_pulse_clocks(&clock));
        let pins = PwmConfig::new(ActiveLow::default(), dead_time.into(), minimum_pulse.into()).unwrap();
        let options = PlantOptions {
            frequency_factor,
            ..PlantOptions::default()
        };
        Self {
            pace,
            shaper: MotionShaper::new(&shaper),
            derived,
            divider: DividerConfig::new(TICK_CLOCKS.into()).unwrap(),
            control_clocks: schedule.clocks(),
            controller: TickController::default(),
            pwm: Pwm::new(&pins),
            pwm_inputs: pwm::Inputs {
                mode: 3,
                period: PERIOD_CLOCKS as u16,
                max_duty: PERIOD_CLOCKS as u16,
                dead_time: dead_time as u16,
                minimum_pulse: minimum_pulse as u16,
                fault_n: true,
                pll_locked: true,
                filtered_fault_n: 3,
                clear_trip: true,
                ..pwm::Inputs::default()
            },
            counter: PulseCounter::new(),
            indices: 0,
            counter_inputs: pulse_counter::Inputs {
                filter_clocks: axis.encoder.unwrap().filter_clocks as u8,
                timeout: 4,
                index_always: true,
                ..pulse_counter::Inputs::default()
            },
            plant: AxisPlant::new(axis, &clock, &options).unwrap(),
            powered: true,
            count_before: 0,
            duty: 0,
        }
    }

    /// Makes the feedback `factor` times as strong.
    pub(crate) fn with_feedback(mut self, factor: f64) -> Self {
        let rows = [
            SettingRow::Damping,
            SettingRow::Reaching,
            SettingRow::Switching,
            SettingRow::Derivative,
            SettingRow::Proportional,
            SettingRow::Integral,
        ];
        let gains = &mut self.derived.gains;
        for row in rows {
            gains.set(row, factor * gains.get(row));
        }
        self.derived.settings = gains.quantise().unwrap();
        self
    }

    /// Holds a position this many counts away from the current one. Returns the load's distance from it in counts, at
    /// each tick.
    pub(crate) fn hold(&mut self, counts: i32, ticks: u32) -> Vec<f64> {
        let distances = (0..ticks).map(|_| {
            self.tick_at_once([counts << 8, 0, 0]);
            self.plant.count() as f64 - f64::from(counts)
        });
        distances.collect()
    }

    /// Plays entries from rest at 0, and this many ticks after their end.
    pub(crate) fn play(&mut self, entries: &[Entry], settle_ticks: u32) -> Vec<Sample> {
        let mut at = Integrator::default();
        let ticks = entries
            .iter()
            .flat_map(|entry| (0..entry.ticks).map(|tick| Some((entry.motion, tick == 0))));
        let ticks = ticks.chain((0..settle_ticks).map(|_| None));
        let samples = ticks.map(|played| {
            if let Some((motion, is_first)) = played {
                at.play(&motion, is_first).unwrap();
            }
            let shaped = self.shaper.push(at.rounded().map(i64::from)).map(|word| word as i32);
            let machine = self.plant.motion();
            match self.pace {
                Pace::Clocks => self.tick_by_clocks(shaped),
                Pace::Ticks => self.tick_at_once(shaped),
            }
            Sample {
                reference: f64::from(shaped[0]) / 256.0,
                ended: played.is_none(),
                machine,
            }
        });
        samples.collect()
    }

    /// Advances hardware and machine by a clock.
    pub(crate) fn clock(&mut self) {
        let lines = self.plant.encoder();
        (self.counter_inputs.a, self.counter_inputs.b, self.counter_inputs.z) = (lines.a, lines.b, lines.z);
        let gates = self.pwm.step(&self.pwm_inputs);
        self.indices += u32::from(self.counter.step(&self.counter_inputs).index_seen);
        self.counter_inputs.time_stamp = (self.counter_inputs.time_stamp + 1) & 0xff_ffff;
        let pins = DrivePins {
            a_high: gates.a_high,
            a_low: gates.a_low,
            b_high: gates.b_high,
            b_low: gates.b_low,
            drive_enable: self.powered,
            brake_release: self.powered,
        };
        self.plant.clocks(pins, 1);
    }

    /// Runs what follows a tick: capture, divide, control, and the new duty at the PWM's next boundary.
    fn tick_by_clocks(&mut self, shaped: [i32; 3]) {
        let position = self.counter.outputs().position;
        (self.counter_inputs.tick, self.pwm_inputs.sync) = (true, true);
        self.clock();
        (self.counter_inputs.tick, self.pwm_inputs.sync) = (false, false);
        for clock in 1..TICK_CLOCKS {
            self.counter_inputs.quotient_valid = clock == DIVISION_CLOCKS + 2;
            if self.counter_inputs.quotient_valid {
                let shown = self.counter.outputs();
                self.counter_inputs.quotient = self.divider.divide(shown.steps, shown.elapsed).0 as i32;
            }
            if clock == self.control_clocks {
                let velocity = self.counter.outputs().velocity;
                self.control(shaped, position, velocity);
            }
            self.clock();
        }
        self.pwm_inputs.enable = true;
        self.pwm_inputs.clear_trip = false;
    }

    fn tick_at_once(&mut self, shaped: [i32; 3]) {
        let count = self.plant.count();
        let velocity = (count - self.count_before) << 16;
        self.count_before = count;
        self.pulse();
        self.control(shaped, count as i32, velocity as i32);
        self.pulse();
    }

    /// Plays a period of the PWM with its duty: one polarity in the middle, the other before and after.
    fn pulse(&mut self) {
        let on = ((PERIOD_CLOCKS + self.duty) / 2).clamp(0, PERIOD_CLOCKS) as u64;
        let rest = PERIOD_CLOCKS as u64 - on;
        for (forward, clocks) in [(false, rest / 2), (true, on), (false, rest - rest / 2)] {
            let pins = DrivePins {
                a_high: forward,
                a_low: !forward,
                b_high: !forward,
                b_low: forward,
                drive_enable: true,
                brake_release: true,
            };
            self.plant.clocks(pins, clocks);
        }
    }

    fn control(&mut self, shaped: [i32; 3], position: i32, velocity: i32) {
        let [position_reference, velocity_reference, acceleration_reference] = shaped;
        let motion = sliding_mode::TickMotion {
            position_reference,
            velocity_reference,
            acceleration_reference,
            position,
            velocity,
        };
        let Derived { law, settings, .. } = &self.derived;
        self.duty = self.controller.control(*law, false, &motion, settings).duty;
        self.pwm_inputs.duty = self.duty;
    }
}
