//! A whole stage: a time base and two axes, each from the command FIFO to the gates, with encoder and supervisor.

use crate::pins::encoder;
use crate::stage::{axis, pwm_config, settings, shaper_config, stage as joined};
use crate::{TICK_CLOCKS, Whole};
use posicast_hdl::emit::{Header, Module, connect};
use posicast_hdl::{axis as supervisor, divider, pulse_counter, pwm, segments, setting_banks, shaper};
use posicast_hdl::{sliding_mode, time_base};
use posicast_model::rtl::composition::Composed;
use posicast_model::rtl::divider::DividerConfig;
use posicast_model::rtl::segments::{ENTRY_WORDS, Entry, Motion};

pub(crate) fn stage() -> Whole {
    let (composition, blocks) = joined(TICK_CLOCKS, |(composition, blocks)| {
        Box::new(Composed::new(composition, blocks))
    });
    let config = DividerConfig::new(TICK_CLOCKS).unwrap();
    let time_base = time_base::emit(&config, "stage").unwrap();
    let axis = axis_modules(&config);
    let header = header("A stage of two axes.");
    let [of_time_base, of_axis] = [&time_base, &axis].map(|modules| modules.last().unwrap());
    let top = connect("stage", &header, &composition, &[of_time_base, of_axis, of_axis]).unwrap();
    Whole {
        name: "stage",
        modules: [time_base, axis, vec![top]].concat(),
        model: Composed::new(composition, blocks),
        input: Box::new(input),
    }
}

fn header(about: &str) -> Header {
    Header {
        about: about.to_owned(),
        parameters: Vec::new(),
    }
}

/// The modules of an axis, in the order of its parts, each behind those that it consists of; then the axis.
fn axis_modules(config: &DividerConfig) -> Vec<Module> {
    let prefix = "stage";
    let parts = [
        segments::emit(prefix).unwrap(),
        shaper::emit(&shaper_config(), prefix).unwrap(),
        pulse_counter::emit(prefix).unwrap(),
        divider::emit(config, prefix).unwrap(),
        sliding_mode::emit(prefix).unwrap(),
        setting_banks::emit(&settings(), prefix).unwrap(),
        pwm::emit(&pwm_config(), prefix).unwrap(),
        supervisor::emit(prefix).unwrap(),
    ];
    let tops: Vec<&Module> = parts.iter().map(|modules| modules.last().unwrap()).collect();
    let (composition, _) = axis(TICK_CLOCKS);
    let top = connect("stage_of_blocks", &header("An axis."), &composition, &tops).unwrap();
    [parts.concat(), vec![top]].concat()
}

/// Both axes are enabled, and move back and forth by an entry per tick.
fn input(name: &str, clock: u64) -> u64 {
    let (tick, phase) = (clock / TICK_CLOCKS, clock % TICK_CLOCKS);
    let [a, b] = encoder(clock);
    let [later_a, later_b] = encoder(clock + 140);
    let word = (phase as usize).checked_sub(100).filter(|word| *word < ENTRY_WORDS);
    let jerk = [1i64, -1, -1, 1][tick as usize % 4] << 30;
    let entry = Entry {
        ticks: 1,
        motion: Motion::Jerk(jerk),
        notify: false,
    };
    match name {
        "x_a" => a,
        "x_b" => b,
        "y_a" => later_a,
        "y_b" => later_b,
        "x_write" | "y_write" => u64::from(word.is_some()),
        "word" => word.unwrap_or(0) as u64,
        "data" => word.map_or(0, |word| entry.words()[word].into()),
        "emergency_stop_n" | "limit_plus_n" | "limit_minus_n" | "drive_ready" => 1,
        "x_fault_n" | "y_fault_n" | "pll_locked" | "clear_flags" => 1,
        "filtered_fault_n" => 3,
        "clear_trip" => u64::from(clock == 20),
        "clear_faults" => u64::from(clock == 40),
        "x_axis_enable" | "y_axis_enable" => u64::from(clock > 80),
        "axis_start" => u64::from(phase == 4000),
        "filter_clocks" => 5,
        "smoothing" => 2,
        "timeout" => 8,
        "stop_deceleration" => 1 << 24,
        "pwm_mode" => 2,
        "period" | "max_duty" => 2500,
        "pwm_duty" if phase >= 250 => tick * 100 % 2000,
        "dead_time" => 25,
        "minimum_pulse" => 50,
        _ => 0,
    }
}
