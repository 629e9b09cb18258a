//! Compares the axis with closed forms, with two masses on a spring, and with itself in other time steps.

use proptest::prelude::*;

use super::*;
use crate::machine_file::{self, Machine, Scale};
use crate::motion::{Cubic, Jump, Trajectory};
use crate::plant::response::response_figures;

const VELOCITY: &str = "mode = \"velocity\"\nfull_scale_velocity = 0.5\n";
const TORQUE: &str = "mode = \"torque\"\nequivalent_mass = 64.274\nforce_constant = 475.01\ncurrent_limit_a = 2.73\n\
    full_scale_a = 3.0\n";
/// Mode Gx of the notes.
const GX: &str = "frequency_hz = 131.117015808451\ndamping = 0.157799065776";

fn machine(drive: &str, mode: &str) -> Machine {
    let text = format!(
        "name = \"one\"\n[clock]\nfrequency_hz = 50_000_000\nsample_hz = 10_000\n[[axis]]\nname = \"x\"\n\
         counts_per_unit = 1_000_000\n[axis.shaper]\nkind = \"zvd\"\n[[axis.mode]]\n{mode}\n[axis.encoder]\nindex = true\n\
         [axis.scale]\ncounts_per_unit = 10_000_000\n[axis.pwm]\nmode = \"locked-antiphase\"\nfrequency_hz = 20_000\n[axis.drive]\n{drive}"
    );
    machine_file::parse("one.toml", &text).unwrap_or_else(|error| panic!("{error:?}"))
}

fn plant(drive: &str, mode: &str, options: PlantOptions) -> AxisPlant {
    let machine = machine(drive, mode);
    AxisPlant::new(&machine.axes[0], &machine.clock, &options).unwrap()
}

/// Pins for full scale forward, or backward for `false`.
fn full(forward: bool) -> DrivePins {
    DrivePins {
        a_high: forward,
        a_low: !forward,
        b_high: !forward,
        b_low: forward,
        drive_enable: true,
        brake_release: true,
    }
}

fn stop() -> DrivePins {
    DrivePins {
        drive_enable: true,
        brake_release: true,
        ..DrivePins::default()
    }
}

#[test]
fn golden_a_short_move_overshoots_as_a_step_does() {
    // A motion of 5 µm within 10 µs is a step for a mode of 131 Hz, for which the notes give 60.53 %.
    let mut axis = plant(VELOCITY, GX, PlantOptions::default());
    axis.clocks(full(true), 500);
    let mut highest = 0.0f64;
    for _ in 0..10_000 {
        axis.clocks(stop(), 100);
        highest = highest.max(axis.motion().load);
    }
    assert!((axis.motion().position - 5e-6).abs() < 1e-18);
    assert!((highest / 5e-6 - 1.0 - 0.60530).abs() < 1e-4, "{highest}");
}

/// A change of the velocity in 25 cells, as the mean over a period makes it.
fn staircase((start_s, velocity): (f64, f64)) -> impl Iterator<Item = Jump> {
    (0..25).map(move |cell| Jump {
        time_s: start_s + f64::from(cell) * 2e-6,
        change: Cubic {
            velocity: velocity / 25.0,
            ..Cubic::default()
        },
    })
}

#[test]
fn the_load_is_that_of_the_plant_in_closed_form() {
    // 1.5 ms at full speed, a ramp and a stop, for any frequency factor.
    for factor in [0.9, 1.0, 1.1] {
        let options = PlantOptions {
            frequency_factor: factor,
            ..PlantOptions::default()
        };
        let mut axis = plant(VELOCITY, GX, options);
        axis.clocks(full(true), 75_000);
        let ringing = axis.motion().vibration;
        axis.clocks(stop(), 2_500);
        let mut highest = axis.motion().load;
        let amplitude = axis.motion().vibration;
        assert!(ringing > 0.0);
        for _ in 0..10_000 {
            axis.clocks(stop(), 100);
            highest = highest.max(axis.motion().load);
        }
        let command = Trajectory::new([(0.0, 0.5), (1.5e-3, -0.5)].into_iter().flat_map(staircase).collect());
        let machine = machine(VELOCITY, GX);
        let closed = Plant::of_axis(&machine.axes[0]).unwrap().scaled(factor);
        let expected = response_figures(&closed, &command);
        assert!(
            (highest / expected.highest - 1.0).abs() < 1e-6,
            "{factor}: {highest} {expected:?}"
        );
        // The amplitude counts from the last step's instant, and 2 µs later.
        let residual = expected.residual_displacement[0];
        assert!(
            (amplitude / residual - 1.0).abs() < 2e-3,
            "{factor}: {amplitude} {residual}"
        );
    }
}

/// Simulates motor and table of the notes' X axis on their spring by small steps, and returns the position of the
/// table under a force on the motor.
fn two_masses(force: impl Fn(f64) -> f64, end_s: f64) -> f64 {
    let (motor, table, spring, damper) = (14.274, 50.0, 33.9357e6, 1.3e4);
    let (mut x, mut step) = ([0.0f64; 4], 2e-8);
    let steps = (end_s / step).round();
    step = end_s / steps;
    for index in 0..steps as u32 {
        let inner = spring * (x[0] - x[2]) + damper * (x[1] - x[3]);
        x[1] += step * (force(f64::from(index) * step) - inner) / motor;
        x[3] += step * inner / table;
        x[0] += step * x[1];
        x[2] += step * x[3];
    }
    x[2]
}

#[test]
fn a_torque_axis_with_a_mode_is_two_masses_on_a_spring() {
    // Free vibration of the two: √(K (1/m₁ + 1/m₂)), 278.2 Hz in the notes.
    let mode = "frequency_hz = 278.2393\ndamping = 0.334847";
    let reach = |mode: &str| {
        let mut axis = plant(TORQUE, mode, PlantOptions::default());
        axis.clocks(full(true), 100_000);
        axis.clocks(full(false), 50_000);
        axis.motion()
    };
    let found = reach(mode);
    // The mean is over the last 25 cells, in the last of which the command changes.
    let force = |time_s: f64| {
        let cells = (time_s / 2e-6).floor() + 1.0;
        let turned = (cells - 1000.0).clamp(0.0, 25.0);
        475.01 * (3.0 * (cells.min(25.0) - 2.0 * turned) / 25.0).clamp(-2.73, 2.73)
    };
    let expected = two_masses(force, 3e-3);
    assert!(
        (found.load - expected).abs() < 1e-4 * (found.load - found.position).abs(),
        "{} {expected}",
        found.load
    );
    assert!((found.load - found.position).abs() > 1e-6);
    // A rigid axis would be elsewhere.
    assert!((found.position - expected).abs() > 1e-6);
}

#[test]
fn the_encoder_counts_motor_or_load_as_its_option_selects() {
    let counts = |drive, encoder_at| {
        let options = PlantOptions {
            encoder_at,
            ..PlantOptions::default()
        };
        let mut axis = plant(drive, GX, options);
        axis.clocks(full(true), 200_000);
        let before = axis.motion();
        axis.clocks(full(true), u64::from(axis.cell_clocks()));
        let of = |position: f64, counts_per_unit: f64| (position * counts_per_unit).round() as i64;
        assert_eq!(axis.scale_count(), Some(of(before.load, 1e7)));
        (axis.count(), of(before.position, 1e6), of(before.load, 1e6))
    };
    for (drive, by_default) in [(VELOCITY, Coordinate::Driven), (TORQUE, Coordinate::Load)] {
        for encoder_at in [None, Some(Coordinate::Driven), Some(Coordinate::Load)] {
            let (count, driven, load) = counts(drive, encoder_at);
            assert_ne!(driven, load);
            let expected = match encoder_at.unwrap_or(by_default) {
                Coordinate::Driven => driven,
                Coordinate::Load => load,
            };
            assert_eq!(count, expected, "{drive} {encoder_at:?}");
        }
    }
}

#[test]
fn without_power_or_with_the_brake_nothing_moves() {
    for drive in [VELOCITY, TORQUE] {
        for (drive_enable, brake_release) in [(false, false), (false, true), (true, false)] {
            let pins = DrivePins {
                drive_enable,
                brake_release,
                ..full(true)
            };
            let mut axis = plant(drive, GX, PlantOptions::default());
            axis.clocks(pins, 1_000_000);
            assert_eq!((axis.motion().position, axis.count()), (0.0, 0));
        }
        // The brake stops the axis, and the load rings.
        let mut axis = plant(drive, GX, PlantOptions::default());
        axis.clocks(full(true), 500_000);
        axis.clocks(DrivePins::default(), 100);
        let stopped = axis.motion();
        assert_eq!(stopped.velocity, 0.0);
        axis.clocks(DrivePins::default(), 1_000);
        assert_eq!(axis.motion().position, stopped.position);
        assert!(axis.motion().vibration > 1e-6);
    }
}

#[test]
fn an_index_is_a_count_wide() {
    let options = PlantOptions {
        index_at: 100,
        ..PlantOptions::default()
    };
    let mut axis = plant(VELOCITY, GX, options);
    let mut wide = 0;
    for _ in 0..50_000 {
        wide += u32::from(axis.encoder().z);
        assert_eq!(axis.encoder().z, axis.count() == 100);
        axis.clocks(full(true), 1);
    }
    // The index is a micrometre wide, which takes 2 µs at 0.5 m/s.
    assert!((99..=101).contains(&wide), "{wide}");
}

#[test]
fn invalid_plants_are_errors_that_name_the_cause() {
    let machine = machine(TORQUE, GX);
    let of = |change: &dyn Fn(&mut AxisSection), options: PlantOptions| {
        let mut axis = machine.axes[0].clone();
        change(&mut axis);
        AxisPlant::new(&axis, &machine.clock, &options).unwrap_err().to_string()
    };
    let default = PlantOptions::default();
    assert!(of(&|axis| axis.pwm = None, default).contains("no [axis.pwm]"));
    assert!(of(&|axis| axis.drive = None, default).contains("no [axis.drive]"));
    assert!(of(&|axis| axis.modes[0].participation = -1.0, default).contains("participations"));
    assert!(of(&|axis| axis.counts_per_unit = 1e12, default).contains("counts per clock"));
    for frequency_factor in [0.0, -1.0, f64::NAN, f64::INFINITY, 10.1] {
        let options = PlantOptions {
            frequency_factor,
            ..default
        };
        assert!(of(&|_| (), options).contains("frequency factor"));
    }
    for position in [f64::NAN, f64::INFINITY, 1e9] {
        let options = PlantOptions { position, ..default };
        assert!(of(&|_| (), options).contains("2^40"));
    }
    for counts in [f64::NAN, f64::INFINITY] {
        let mut axis = machine.axes[0].clone();
        axis.scale = axis.scale.map(|scale| Scale {
            counts_per_unit: counts,
            ..scale
        });
        assert!(AxisPlant::new(&axis, &machine.clock, &default).is_err());
    }
}

fn any_pins() -> impl Strategy<Value = DrivePins> {
    any::<[bool; 6]>().prop_map(|[a_high, a_low, b_high, b_low, drive, brake]| DrivePins {
        a_high,
        a_low,
        b_high,
        b_low,
        // The drive is enabled most of the time.
        drive_enable: drive || a_high,
        brake_release: brake || b_high,
    })
}

proptest! {
    #[test]
    fn prop_it_does_not_matter_how_time_is_cut(
        stretches in prop::collection::vec((any_pins(), 1u64..3_000), 1..12),
        cuts in prop::collection::vec(1u64..700, 1..20),
        torque: bool,
    ) {
        let drive = if torque { TORQUE } else { VELOCITY };
        let whole = plant(drive, GX, PlantOptions::default());
        let [mut by_clock, mut by_cut, mut by_stretch] = [whole.clone(), whole.clone(), whole];
        let mut cuts = cuts.into_iter().cycle();
        for (pins, clocks) in stretches {
            let mut quiet = (0, by_clock.encoder(), by_clock.scale());
            for _ in 0..clocks {
                if quiet.0 == 0 {
                    quiet = (by_clock.quiet_clocks(), by_clock.encoder(), by_clock.scale());
                    prop_assert!(quiet.0 > 0);
                }
                let (before, scale) = (by_clock.encoder(), by_clock.scale());
                prop_assert_eq!((before, scale), (quiet.1, quiet.2));
                quiet.0 -= 1;
                by_clock.clocks(pins, 1);
                let after = by_clock.encoder();
                prop_assert!(before.a == after.a || before.b == after.b);
            }
            let mut left = clocks;
            while left > 0 {
                let now = cuts.next().unwrap().min(left);
                by_cut.clocks(pins, now);
                left -= now;
            }
            by_stretch.clocks(pins, clocks);
            prop_assert_eq!(&by_clock, &by_cut);
            prop_assert_eq!(&by_clock, &by_stretch);
        }
    }

    #[test]
    fn prop_no_machine_file_makes_it_panic(
        exponents in prop::array::uniform5(-300f64..12.0),
        damping in 0f64..1.0,
        pins in prop::collection::vec(any_pins(), 1..20),
    ) {
        let [mass, constant, current, bandwidth, friction] = exponents.map(|exponent| 10f64.powf(exponent));
        let drive = format!(
            "mode = \"torque\"\nequivalent_mass = {mass:e}\nforce_constant = {constant:e}\ncurrent_limit_a = {current:e}\n\
             full_scale_a = {current:e}\nbandwidth_hz = {bandwidth:e}\nviscous = {friction:e}\ncoulomb = {friction:e}\n"
        );
        let machine = machine(&drive, &format!("frequency_hz = 30.0\ndamping = {damping}"));
        if let Ok(mut axis) = AxisPlant::new(&machine.axes[0], &machine.clock, &PlantOptions::default()) {
            for pins in pins {
                axis.clocks(pins, 5_000);
            }
            prop_assert!(axis.motion().load.is_finite());
        }
    }
}
