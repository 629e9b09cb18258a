//! The blocks of the drive: the controller and the bridge.

use crate::{Block, CLOCKS, TICK_CLOCKS, TICKS, hold};
use posicast_blocks::pwm::{self as pwm_model, ActiveLow, Pwm, PwmConfig};
use posicast_blocks::sliding_mode::{Gain, Inputs, Law, SettingRow, Settings, SlidingMode, TickController, TickMotion};
use posicast_hdl::{pwm, sliding_mode};
use std::hint::black_box;

/// Returns the sliding-mode controller with one pass per tick.
pub(crate) fn sliding_mode() -> Block {
    let mut settings = Settings::default();
    for (row, gain) in [
        (SettingRow::Proportional, 0.5),
        (SettingRow::Derivative, 3.0),
        (SettingRow::Feedback, 1.0),
    ] {
        settings.set_gain(row, Gain::nearest(gain, row).unwrap());
    }
    settings.set_limit(1000 << 12);
    let motion = |tick: u64| TickMotion {
        position_reference: (tick as i32 * 300) << 8,
        velocity_reference: 300 << 16,
        position: tick as i32 * 299,
        velocity: 299 << 16,
        ..TickMotion::default()
    };
    let mut model = SlidingMode::new();
    let mut setting = 0;
    let mut inputs = Vec::new();
    for clock in 0..CLOCKS {
        let row = Inputs {
            start: clock % TICK_CLOCKS == 200,
            law: LAW as u8,
            setting,
            ..motion(clock / TICK_CLOCKS).into()
        };
        // The memory of the settings answers one clock later.
        setting = settings.word(usize::from(model.step(&row).setting_address));
        inputs.extend(row.to_raw());
    }
    let mut fast = TickController::default();
    Block {
        name: "sliding_mode",
        modules: sliding_mode::emit("").unwrap(),
        model: Box::new(SlidingMode::new()),
        inputs,
        fast: Box::new(move || {
            let control = |tick| i64::from(fast.control(LAW, false, &black_box(motion(tick)), &settings).command);
            (0..TICKS).map(control).sum()
        }),
    }
}

const LAW: Law = Law::SlidingMode;

/// Returns the PWM of a full bridge at 20 kHz with a new duty in every tick.
pub(crate) fn pwm() -> Block {
    let config = PwmConfig::new(ActiveLow::default(), 25, 50).unwrap();
    let input = |clock: u64| pwm_model::Inputs {
        enable: true,
        mode: 2,
        period: 2500,
        duty: (clock / TICK_CLOCKS) as i32 * 230 - 2300,
        max_duty: 2500,
        dead_time: 25,
        minimum_pulse: 50,
        feed: clock % TICK_CLOCKS == 300,
        watchdog_periods: 4,
        fault_n: true,
        pll_locked: true,
        filtered_fault_n: 3,
        clear_trip: clock < 20,
        ..pwm_model::Inputs::default()
    };
    let events = hold((0..CLOCKS).map(input));
    let mut fast = Pwm::new(&config);
    Block {
        name: "pwm",
        modules: pwm::emit(&config, "").unwrap(),
        model: Box::new(Pwm::new(&config)),
        inputs: (0..CLOCKS).flat_map(|clock| input(clock).to_raw()).collect(),
        fast: Box::new(move || {
            for (inputs, clocks) in &events {
                fast.hold(black_box(inputs), *clocks);
            }
            i64::from(fast.outputs(&events[0].0).a_high)
        }),
    }
}
