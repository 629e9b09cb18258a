//! The stage of the example machine: its Verilog compared with its model, and its registers over the bus.

use crate::support;

use posicast_blocks::divider::DividerConfig;
use posicast_blocks::linear_scale::ScaleRatio;
use posicast_blocks::pwm::{ActiveLow, BridgeMode, PwmConfig};
use posicast_blocks::shaper::{ShaperConfig, ShaperMotion};
use posicast_blocks::sliding_mode::{Gain, SettingRow};
use posicast_blocks::stage::{StageCompare, StageConfig, StageScale};
use posicast_blocks::{ClockedBlock, Direction};
use posicast_machine::hardware::{self, MachineStage};
use posicast_machine::machine_file::{self, Machine};
use posicast_machine::plan::design_machine;
use posicast_taps::{Tap, TapTable};
use posicast_testbench::blocks;
use posicast_testbench::blocks::{Block, Sources};
use posicast_testbench::lockstep::TwoValued;
use posicast_testbench::register_tests::{Host, RegisterHardware, TESTS};
use posicast_testbench::stage::{ShortTicksBlock, StageBlock};
use support::{assert_match, caught, icarus_agrees, million_random_clocks};

/// Number of clocks of a PWM period in the random runs.
const PERIOD_CLOCKS: u32 = 80;

fn machine() -> Machine {
    let text = include_str!("../../examples/xy-stage.toml");
    machine_file::parse("xy-stage.toml", text).unwrap()
}

fn stage(machine: &Machine) -> MachineStage {
    hardware::stage(machine, &design_machine(machine).unwrap())
        .unwrap()
        .unwrap()
}

/// Returns this many axes with short ticks, small tables and short times, so that much happens in a million clocks.
/// The PWM modes differ.
fn quick(axes: usize) -> StageConfig {
    let config = stage(&machine()).config;
    let modes = [
        BridgeMode::Locked,
        BridgeMode::Unipolar,
        BridgeMode::HalfBridge,
        BridgeMode::Direction,
    ];
    let half = |delay_samples| Tap {
        delay_samples,
        coefficient: 1 << 15,
    };
    let table = TapTable::new(16, vec![half(0), half(2)]).unwrap();
    let motion = ShaperMotion {
        channels: 3,
        modulo: false,
    };
    let mut quick = StageConfig {
        tick: config.tick,
        axes: Vec::new(),
        capture: None,
        machine_crc: None,
    };
    for (name, mode) in ["x", "y", "z", "phi"].into_iter().zip(modes).take(axes) {
        let mut axis = config.axes[0].clone();
        axis.name = name.to_owned();
        axis.shaper = ShaperConfig::new(32, table.clone())
            .unwrap()
            .for_motion(motion)
            .unwrap();
        axis.shaper = axis.shaper.with_room_for(62, 4).unwrap();
        axis.closed_loop_mut().unwrap().pwm = PwmConfig::new(ActiveLow::default(), 2, 3).unwrap();
        axis.closed_loop_mut().unwrap().pwm_mode = mode;
        axis.closed_loop_mut().unwrap().pwm_period_clocks = PERIOD_CLOCKS;
        axis.modulo = name == "phi";
        // Of four axes, the third is supervised by a scale of 2.5 counts per count of the motor; the fourth runs on
        // one.
        axis.scale = matches!(name, "z" | "phi").then(|| StageScale {
            ratio: ScaleRatio::new(1e6, 2.5e6).unwrap(),
            closes_loop: name == "phi",
            invert: false,
        });
        axis.closed_loop_mut().unwrap().encoder_filter_clocks = 2;
        let settings = &mut axis.closed_loop_mut().unwrap().settings;
        settings.set_gain(SettingRow::Duty, Gain::nearest(0.02, SettingRow::Duty).unwrap());
        settings.set_limit(2000 << 12);
        let watched = &mut axis.supervision;
        (
            watched.filter_clocks,
            watched.brake_release_ticks,
            watched.brake_apply_ticks,
        ) = (3, 1, 1);
        (watched.saturation_ticks, watched.lost_ticks, watched.lost_command) = (3, 3, 50 << 12);
        watched.deviation_limit = if axis.scale.is_some() { 20 } else { 0 };
        watched.deviation_ticks = if name == "z" { 2 } else { 0 };
        (watched.direct_hold_ticks, watched.direct_limit) = (2, 30);
        watched.limits_after_homing = matches!(name, "y" | "z");
        quick.axes.push(axis);
    }
    // This is the shortest tick that holds the schedule, in whole periods.
    let periods = quick.timing().duty_clocks() / PERIOD_CLOCKS + 1;
    quick.tick = DividerConfig::new(u64::from(periods * PERIOD_CLOCKS)).unwrap();
    quick
}

fn block(axes: usize) -> StageBlock {
    StageBlock::new(&quick(axes), "quick_stage").unwrap()
}

/// Returns the line of the Verilog that begins with `begins` and contains `has`.
fn line(block: &StageBlock, begins: &str, has: &str) -> String {
    let modules = block.modules().unwrap();
    let mut lines = modules.iter().flat_map(|module| module.text.lines());
    let found = lines.find(|line| line.trim_start().starts_with(begins) && line.contains(has));
    found
        .unwrap_or_else(|| panic!("no line with `{begins}` and `{has}`: adapt the test"))
        .to_owned()
}

/// Connects a port to another net, and requires that the error is found.
fn rewired(axes: usize, port: &str, net: &str, other: &str) {
    let block = block(axes);
    let line = line(&block, &format!(".{port} "), &format!("({net})"));
    caught(&block, &line, &line.replace(&format!("({net})"), other), 300_000);
}

/// Returns the sum of what two runs reached: a rare event occurs in one of the two.
fn reached(axes: usize, seeds: [u64; 2]) -> Vec<(String, u64)> {
    let [mut counts, more] = seeds.map(|seed| million_random_clocks(&block(axes), seed, 0).coverage);
    for ((_, count), (_, more)) in counts.iter_mut().zip(more) {
        *count += more;
    }
    counts
}

#[test]
fn long_lockstep_one_axis_two_million_random_clocks() {
    let counts = reached(1, [11, 13]);
    let never: Vec<_> = counts.iter().filter(|(_, count)| *count == 0).collect();
    assert!(never.is_empty(), "{never:?} of {counts:?}");
}

#[test]
fn lockstep_two_axes_under_random_traffic() {
    let block = block(2);
    let mut device = Sources::write(&block).unwrap().verilated(&block, 5).unwrap();
    let report = blocks::check(&block, &mut device, 300_000, 5, &mut |_| {}).unwrap();
    assert_match(&report, "two axes");
}

#[test]
fn long_lockstep_two_axes_two_million_random_clocks() {
    let counts = reached(2, [5, 15]);
    let hit = |name: &str| counts.iter().any(|(other, count)| other == name && *count > 0);
    for (name, _) in counts.iter().filter(|(_, count)| *count == 0) {
        let of_both = [name.replacen('y', "x", 1), name.replacen('x', "y", 1)];
        assert!(of_both.iter().any(|other| hit(other)), "{name} is reached by no axis");
    }
}

#[test]
fn long_lockstep_four_axes_a_million_random_clocks() {
    // The counters of two axes suffice: four have longer ticks, and less happens in as many clocks.
    million_random_clocks(&block(4), 3, 0);
}

#[test]
fn lockstep_the_machine_under_random_traffic() {
    let config = stage(&machine()).config;
    let block = StageBlock::new(&config, "xy_stage").unwrap();
    let mut device = Sources::write(&block).unwrap().verilated(&block, 5).unwrap();
    let report = blocks::check(&block, &mut device, 300_000, 5, &mut |_| {}).unwrap();
    assert_match(&report, "the machine's stage");
}

#[test]
fn long_crosssim_icarus_agrees_with_two_axes() {
    icarus_agrees(&block(2));
}

#[test]
fn lockstep_catches_the_nets_of_another_axis() {
    rewired(2, "can_start_0", "x_can_start", "(y_can_start)");
}

#[test]
fn long_lockstep_catches_a_tap_of_the_other_bank() {
    caught(
        &block(1),
        "read_address = write_address;",
        "read_address = write_address ^ 7'd64;",
        300_000,
    );
}

#[test]
fn long_lockstep_catches_a_start_of_an_axis_that_cannot() {
    caught(&block(2), "& !can_start_0)", "& 1'd0)", 300_000);
}

#[test]
fn lockstep_catches_divisions_in_another_order() {
    caught(
        &block(2),
        "next_turn = FIRST_CHANNEL;",
        "next_turn = LAST_CHANNEL;",
        300_000,
    );
}

#[test]
fn long_lockstep_catches_controllers_that_start_a_clock_early() {
    caught(&block(1), "(since == LAST)", "(since + 17'd1 == LAST)", 300_000);
}

#[test]
fn long_lockstep_catches_an_axis_that_does_not_stop_the_others() {
    caught(
        &block(2),
        "wants_group_stop_0 & (AXIS_1 != AXIS_0)",
        "wants_group_stop_0 & (AXIS_1 == AXIS_0)",
        300_000,
    );
}

#[test]
fn long_lockstep_catches_a_stop_that_does_not_wait_for_the_shaper() {
    rewired(1, "settle_ticks", "settle_ticks", "(16'd0)");
}

#[test]
fn long_lockstep_catches_a_preset_that_takes_the_users_position() {
    rewired(1, "preset_position", "count", "(user_position)");
}

/// With its default number of clocks, a run of Icarus reaches every flag of every row inside the stage and of the
/// stage. The model runs beside itself, so this tests the stimuli alone.
#[test]
fn the_clocks_of_a_verdict_drive_every_flag() {
    let config = stage(&machine()).config;
    let block = StageBlock::new(&config, "xy_stage_stage").unwrap();
    let mut rows = block.inner().unwrap();
    rows.push(Box::new(block));
    let short = ShortTicksBlock::new(&config, "xy_stage_stage").unwrap();
    rows.push(Box::new(short.expect("ticks of 5,000 clocks can be shorter")));
    for row in rows {
        let seed = blocks::row_seed(row.as_ref(), 1);
        let mut twin = TwoValued(row.model(seed));
        // These are the clocks that the command line gives to a row of the slow simulators.
        let fewest = row.least_clocks().max(20_000);
        let report = blocks::judge(row.as_ref(), &mut twin, fewest..=10 * fewest, seed, &mut |_| {}).unwrap();
        assert_eq!(report.not_exercised_names(), [""; 0], "{fewest} clocks");
    }
}

/// A row that is not exercised enough names the missing flags.
#[test]
fn a_row_without_a_list_of_its_own_names_the_flags_that_stayed() {
    let block = posicast_testbench::segments::SegmentsBlock::new("few", "alone");
    let mut twin = TwoValued(block.model(1));
    let report = blocks::judge(&block, &mut twin, 100..=100, 1, &mut |_| {}).unwrap();
    assert_eq!(
        report.result,
        posicast_testbench::lockstep::report::LockstepVerdict::NoVerdict
    );
    let missing = report.not_exercised_names();
    assert!(
        missing.iter().any(|what| what == "segments alone: `overflow` = 1"),
        "{missing:?}"
    );
    assert!(
        report.blocks[0]
            .unchanged
            .iter()
            .any(|bits| bits.starts_with("position["))
    );
}

/// The schedule fits its tick for any host: no pass is late, and none starts while the last one is running.
#[test]
fn no_pass_is_ever_missed() {
    for axes in [1, 4] {
        let config = quick(axes);
        let block = block(axes);
        let mut model = block.component().model(1);
        let mut stimuli = block.stimuli(0, 1);
        let count = |direction| model.ports().iter().filter(|port| port.direction == direction).count();
        let (mut inputs, mut outputs) = (vec![0; count(Direction::Input)], vec![0; count(Direction::Output)]);
        let late = [
            "segments_tick_missed",
            "shaper_overrun",
            "controller_overrun",
            "velocity_missed",
            "pwm_unaligned",
        ];
        let names = config
            .axes
            .iter()
            .flat_map(|axis| late.map(|flag| format!("{}_{flag}", axis.name)));
        let nets: Vec<(String, usize)> = names
            .map(|name| {
                let net = model.net(&name).unwrap();
                (name, net)
            })
            .collect();
        for clock in 0..300_000 {
            stimuli.fill(&outputs, &mut inputs);
            model.step(&inputs, &mut outputs).unwrap();
            for (name, net) in &nets {
                assert_eq!(model.value(*net), 0, "{name} of {axes} axes in clock {clock}");
            }
        }
    }
}

#[test]
fn lockstep_the_registers_keep_their_promises() {
    let block = block(2);
    let component = block.component();
    let mut verilated = Sources::write(&block).unwrap().verilated(&block, 1).unwrap();
    let mut model = component.model(1);
    for (name, test) in TESTS {
        for device in [&mut model as &mut dyn ClockedBlock, &mut verilated] {
            let mut host = Host::new(component.map(), device, RegisterHardware::Running).unwrap();
            assert_eq!(test(&mut host), Ok(()), "{name}");
        }
    }
}

/// The machine's row is far away: only the stimuli can bring a pulse.
#[test]
fn every_seed_passes_positions_of_a_compare() {
    let mut config = quick(1);
    config.axes[0].compare = Some(StageCompare {
        first: 1_000_000,
        spacing: 1,
        positions: 1,
        rises: true,
        falls: false,
        hysteresis: 0,
        pulse_clocks: 1,
    });
    let block = StageBlock::new(&config, "comparing_stage").unwrap();
    let ports = block.component().composition().ports();
    let (ins, outs): (Vec<_>, Vec<_>) = ports.iter().partition(|port| port.direction == Direction::Input);
    let pulse = outs.iter().position(|port| port.name == "x_compare").unwrap();
    for seed in 1..=5 {
        let (mut stimuli, mut model) = (block.stimuli(0, seed), block.model(seed));
        let (mut inputs, mut outputs) = (vec![0; ins.len()], vec![0; outs.len()]);
        let mut pulses = 0;
        for _ in 0..500_000 {
            let before = outputs[pulse];
            stimuli.fill(&outputs.clone(), &mut inputs);
            model.step(&inputs, &mut outputs).unwrap();
            pulses += u64::from(before == 0 && outputs[pulse] == 1);
        }
        assert!(pulses > 0, "seed {seed}");
    }
}
