//! Tests the components, that is registers and blocks together, through the bus and the pins.

use crate::registers::support::{Bench, assert_match};
use posicast_blocks::component::Component;
use posicast_blocks::divider::DividerConfig;
use posicast_blocks::pwm::{ActiveLow, BridgeMode, PwmConfig};
use posicast_blocks::shaper::{ShaperConfig, ShaperMotion};
use posicast_blocks::sliding_mode::{Gain, Law, SettingRow, Settings};
use posicast_hdl::component::emit;
use posicast_taps::{Tap, TapTable};
use posicast_testbench::component::ComponentRandom;
use posicast_testbench::lockstep::report::LockstepVerdict;

pub(crate) fn pulse_counter() -> Component {
    Component::pulse_counter(DividerConfig::new(127).unwrap(), 3, false).unwrap()
}

pub(crate) fn pwm() -> Component {
    let active_low = ActiveLow {
        a_low: true,
        ..ActiveLow::default()
    };
    Component::pwm(PwmConfig::new(active_low, 4, 3).unwrap(), BridgeMode::HalfBridge, 60).unwrap()
}

pub(crate) fn sliding_mode() -> Component {
    let mut settings = Settings::default();
    for (row, value) in SettingRow::ALL
        .into_iter()
        .zip([0.1, 0.5, 0.2, 0.3, 0.7, 0.4, 0.9, 0.6, 0.8])
    {
        settings.set_gain(row, Gain::nearest(value, row).unwrap());
    }
    settings.set_limit(1000 << 12);
    settings.set_gain(SettingRow::Duty, Gain::nearest(0.25, SettingRow::Duty).unwrap());
    Component::sliding_mode(&settings, Law::Pid, true).unwrap()
}

pub(crate) fn shaper(word_bits: u32, channels: Option<u32>) -> Component {
    let half = |delay_samples| Tap {
        delay_samples,
        coefficient: 1 << 15,
    };
    let table = TapTable::new(16, vec![half(0), half(9)]).unwrap();
    let mut config = ShaperConfig::new(word_bits, table).unwrap();
    if let Some(channels) = channels {
        let modulo = channels == 2;
        config = config.for_motion(ShaperMotion { channels, modulo }).unwrap();
    }
    Component::shaper(config).unwrap()
}

fn bench(component: &Component, from: &str, to: &str) -> Bench {
    Bench::new(component.name(), &emit(component, "alone", "alone").unwrap(), from, to)
}

fn lockstep(component: &Component, cycles: u64) {
    let bench = bench(component, "", "");
    bench.assert_clean();
    let mut changed = Changes::default();
    let report = bench.run(
        &mut component.model(5),
        &mut bench.verilated(),
        &mut ComponentRandom::new(component, cycles),
        cycles,
        &mut |clock| changed.observe(clock.expected),
    );
    assert_match(&report);
    assert!(changed.least() > 100, "{:?}", changed.counts);
}

/// Number of changes of each output.
#[derive(Default)]
struct Changes {
    before: Vec<u64>,
    counts: Vec<u64>,
}

impl Changes {
    fn observe(&mut self, outputs: &[u64]) {
        self.before.resize(outputs.len(), 0);
        self.counts.resize(outputs.len(), 0);
        for ((value, before), count) in outputs.iter().zip(&mut self.before).zip(&mut self.counts) {
            *count += u64::from(value != before);
            *before = *value;
        }
    }

    fn least(&self) -> u64 {
        self.counts.iter().copied().min().unwrap_or(0)
    }
}

fn crosssim(component: &Component) {
    let bench = bench(component, "", "");
    let report = bench.run(
        &mut component.model(6),
        &mut bench.icarus(),
        &mut ComponentRandom::new(component, 6),
        20_000,
        &mut |_| {},
    );
    assert_match(&report);
}

/// Breaks the Verilog and requires a mismatch.
fn caught(component: &Component, from: &str, to: &str) {
    let bench = bench(component, from, to);
    let report = bench.run(
        &mut component.model(7),
        &mut bench.verilated(),
        &mut ComponentRandom::new(component, 7),
        200_000,
        &mut |_| {},
    );
    assert_eq!(report.result, LockstepVerdict::Mismatch, "`{to}` is not found");
}

#[test]
fn lockstep_pulse_counter_random_clocks() {
    lockstep(&pulse_counter(), 300_000);
}

#[test]
fn lockstep_shaper_random_clocks() {
    lockstep(&shaper(16, None), 300_000);
}

#[test]
fn lockstep_shaper_of_three_channels_random_clocks() {
    lockstep(&shaper(32, Some(3)), 300_000);
}

#[test]
fn lockstep_shaper_of_two_channels_and_a_modulo_axis() {
    lockstep(&shaper(24, Some(2)), 300_000);
}

#[test]
fn lockstep_sliding_mode_random_clocks() {
    lockstep(&sliding_mode(), 300_000);
}

#[test]
fn lockstep_pwm_random_clocks() {
    // A PWM that waits for its time base after every change of period runs seldom under random traffic.
    lockstep(&pwm(), 1_000_000);
}

#[test]
fn crosssim_icarus_agrees_with_the_pwm() {
    crosssim(&pwm());
}

#[test]
fn lockstep_catches_a_dead_time_that_is_writable_while_running() {
    caught(&pwm(), "allow_times = !running && ", "allow_times = ");
}

#[test]
fn crosssim_icarus_agrees_with_the_sliding_mode() {
    crosssim(&sliding_mode());
}

#[test]
fn lockstep_catches_settings_of_the_wrong_row() {
    let row = ".row                (setting_address)";
    caught(&sliding_mode(), row, &row.replace("address", "address ^ 4'd1"));
}

#[test]
fn crosssim_icarus_agrees_with_the_pulse_counter() {
    crosssim(&pulse_counter());
}

#[test]
fn crosssim_icarus_agrees_with_the_shaper() {
    crosssim(&shaper(32, Some(1)));
}

#[test]
fn lockstep_catches_a_division_of_the_wrong_clock() {
    caught(&pulse_counter(), ".start       (divide)", ".start       (tick)");
}

#[test]
fn lockstep_catches_flags_that_are_not_cleared() {
    let cleared = ".clear_flags        (1'd1)";
    caught(&shaper(16, None), cleared, &cleared.replace("d1", "d0"));
}
