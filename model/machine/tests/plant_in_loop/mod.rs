//! The loop closed over the simulated machine: the axes of the examples, moved by the bit-exact models.
//!
//! ```text
//! entries ─► integrator ─► shaper ─► controller ─► PWM ─► pins ─► plant ─► A, B ─► pulse counter ─┐
//!                                        ▲────────────────────────────────────── divider ◄────────┘
//! ```

mod chain;
mod margins;

use chain::{Chain, Pace, Sample, TORQUE, VELOCITY, machine};
use posicast_blocks::segments::Entry;
use posicast_machine::motion::{TickLimits, Trajectory, plan_circle, plan_move};
use posicast_machine::plant::Plant;
use posicast_machine::plant::axis::{ErrorFigures, contour_error, residual_vibration, tracking_error};
use posicast_machine::plant::response::response_figures;

/// Number of µm per m.
const MICRO: f64 = 1e6;
/// Longest shaper of the examples in ticks: 10.85 ms and one tap.
const SHAPER_TICKS: usize = 110;

/// Returns a move of 5 mm with these limits per s, s², s³.
fn move_of(velocity: f64, acceleration: f64, jerk: f64) -> Vec<Entry> {
    plan_move(0, 5_000 << 8, &TickLimits::new(velocity, acceleration, jerk, 1e6, 1e4)).unwrap()
}

/// Returns the trapezoid of the notes, section 8.5: 0.2 m/s, 8 m/s², its jerk one tick long.
fn trapezoid() -> Vec<Entry> {
    move_of(0.2, 8.0, 80_000.0)
}

/// Returns the move with the limits of the examples.
fn smooth() -> Vec<Entry> {
    move_of(0.25, 8.0, 400.0)
}

/// Returns the distance of the load from 5 mm in µm, beginning this many ticks after the end of the unshaped command.
fn residual(samples: &[Sample], after_ticks: usize) -> ErrorFigures {
    let end = samples.iter().position(|sample| sample.ended).unwrap() + after_ticks;
    let load: Vec<f64> = samples[end..]
        .iter()
        .map(|sample| sample.machine.load * MICRO)
        .collect();
    residual_vibration(&load, 5_000.0)
}

/// Returns the distance of what the encoder sees from the shaped reference in µm.
fn tracking(samples: &[Sample], seen: impl Fn(&Sample) -> f64) -> ErrorFigures {
    let references: Vec<f64> = samples.iter().map(|sample| sample.reference).collect();
    let positions: Vec<f64> = samples.iter().map(|sample| seen(sample) * MICRO).collect();
    tracking_error(&references, &positions)
}

fn run(text: &str, axis: usize, shaped: bool, factor: f64, pace: Pace, entries: &[Entry]) -> (Chain, Vec<Sample>) {
    let mut chain = Chain::new(&machine(text, shaped), axis, factor, pace);
    let samples = chain.play(entries, 400);
    (chain, samples)
}

#[test]
fn golden_the_trapezoid_of_the_notes_rings_without_shaper_and_not_with_it() {
    // Notes 8.5 give for X 11.0 µm unshaped and 0 with ZVD; the loop adds the steps of its encoder.
    for (axis, notes) in [(0, Some(11.0)), (1, None)] {
        let plant = Plant::of_axis(&machine(VELOCITY, false).axes[axis]).unwrap();
        let closed = response_figures(&plant, &Trajectory::trapezoid(0.005, 0.2, 8.0).unwrap());
        let expected = closed.deviation_after * MICRO;
        assert!(
            notes.is_none_or(|notes: f64| (expected - notes).abs() < 0.1),
            "{expected}"
        );
        let left = |shaped: bool, after_ticks| {
            let (chain, samples) = run(VELOCITY, axis, shaped, 1.0, Pace::Clocks, &trapezoid());
            assert_eq!(i64::from(chain.counter.outputs().position), chain.plant.count());
            assert_eq!((chain.plant.count(), chain.plant.shorted_clocks()), (5_000, 0));
            assert!(chain.indices > 0 && !chain.counter.outputs().illegal);
            let seen = tracking(&samples, |sample| sample.machine.position);
            assert!(seen.peak < 1.6 && seen.rms < 0.8, "axis {axis}: {seen:?}");
            residual(&samples, after_ticks).peak
        };
        let (unshaped, shaped) = (left(false, 2), left(true, SHAPER_TICKS));
        assert!(
            (unshaped / expected - 1.0).abs() < 0.1,
            "axis {axis}: {unshaped} of {expected}"
        );
        assert!(shaped < 0.3, "axis {axis}: {shaped} beside {unshaped}");
    }
}

#[test]
fn a_machine_that_is_off_by_a_tenth_rings_little() {
    for axis in [0, 1] {
        for factor in [0.9, 1.1] {
            let left = |shaped, after_ticks| {
                let (_, samples) = run(VELOCITY, axis, shaped, factor, Pace::Ticks, &trapezoid());
                residual(&samples, after_ticks).peak
            };
            let (unshaped, shaped) = (left(false, 2), left(true, SHAPER_TICKS));
            assert!(
                unshaped > 8.0 && shaped < 0.7,
                "axis {axis}, {factor}: {shaped} beside {unshaped}"
            );
        }
    }
}

#[test]
fn sliding_mode_follows_in_spite_of_friction_and_does_not_chatter() {
    for axis in [0, 1] {
        let (chain, samples) = run(TORQUE, axis, true, 1.0, Pace::Clocks, &smooth());
        let seen = tracking(&samples, |sample| sample.machine.load);
        assert!(seen.peak < 7.0 && seen.rms < 5.0, "axis {axis}: {seen:?}");
        // Friction holds it where the law gives less than friction: within the steady error of the notes, and one
        // count.
        let left = residual(&samples, 300);
        let allowed = chain.derived.steady_error * MICRO + 1.0;
        assert!(left.peak < allowed, "axis {axis}: {left:?}, {allowed} allowed");
        let rest = &samples[samples.len() - 100..];
        assert!(rest.iter().all(|sample| sample.machine.velocity == 0.0), "axis {axis}");
        let current = samples
            .iter()
            .map(|sample| sample.machine.drive.abs())
            .fold(0.0, f64::max);
        assert!((1.0..2.2).contains(&current), "axis {axis}: {current} A");
        assert_eq!(i64::from(chain.counter.outputs().position), chain.plant.count());
    }
}

#[test]
fn the_fast_pace_is_like_the_clocks() {
    for (text, limit) in [(VELOCITY, 0.5), (TORQUE, 2.5)] {
        let [clocks, ticks] = [Pace::Clocks, Pace::Ticks].map(|pace| run(text, 0, true, 1.0, pace, &smooth()).1);
        let pairs = clocks.iter().zip(&ticks);
        let apart = ErrorFigures::of(pairs.map(|(a, b)| (a.machine.load - b.machine.load) * MICRO));
        assert!(apart.peak < limit, "{apart:?}");
    }
}

#[test]
fn a_stop_in_the_middle_loses_no_count() {
    for (text, brake) in [(VELOCITY, false), (VELOCITY, true), (TORQUE, false), (TORQUE, true)] {
        let mut chain = Chain::new(&machine(text, true), 0, 1.0, Pace::Clocks);
        let entries = smooth();
        chain.play(&entries[..entries.len() / 2], 0);
        let fast = chain.plant.motion().velocity;
        assert!(fast > 0.05, "{fast}");
        chain.pwm_inputs.enable = false;
        chain.powered = !brake;
        for _ in 0..4_000 {
            chain.clock();
        }
        let coasts = text == TORQUE && !brake;
        assert_eq!(chain.plant.motion().velocity > 0.04, coasts);
        let behind = chain.plant.count() - i64::from(chain.counter.outputs().position);
        assert!((0..=i64::from(coasts)).contains(&behind), "{behind}");
    }
}

/// Returns the contour error in µm of a circle of 10 mm at 0.1 m/s, with X as it is and with X later by this many
/// ticks.
fn circle(shaped: bool, x_later_ticks: f64) -> [ErrorFigures; 2] {
    const RADIUS: f64 = 10_000.0;
    let limits = TickLimits::new(0.1, 1.0, 100.0, 1e6, 1e4);
    let paths = plan_circle([0, 0], RADIUS, 1.2, &limits).unwrap();
    let machine = machine(VELOCITY, shaped);
    let [x, y] = [0, 1].map(|axis| {
        let samples = Chain::new(&machine, axis, 1.0, Pace::Ticks).play(&paths[axis], 0);
        samples
            .iter()
            .map(|sample| sample.machine.load * MICRO)
            .collect::<Vec<_>>()
    });
    [0.0, x_later_ticks].map(|later| {
        let x_at = |tick: usize| {
            let (whole, part) = (later.floor() as usize, later.fract());
            x[tick - whole] * (1.0 - part) + x[tick - whole - 1] * part
        };
        // The points begin when the shapers are full; the first of the path is at rest.
        let points: Vec<(f64, f64)> = (SHAPER_TICKS..x.len()).map(|tick| (x_at(tick), y[tick])).collect();
        contour_error(&points, (-RADIUS, 0.0), RADIUS)
    })
}

#[test]
fn golden_the_circle_is_as_wrong_as_the_delays_differ() {
    // Notes 6, tangential start: 9.2 µm unshaped, 71.1 µm with ZVD, 4.2 µm with ZVD and the delays d = Σ A t + 2ζ/ω
    // made equal.
    let [unshaped, _] = circle(false, 0.0);
    let [apart, matched] = circle(true, 13.54);
    for (found, notes) in [(unshaped, 9.2), (apart, 71.1), (matched, 4.2)] {
        assert!((found.peak - notes).abs() < 0.5, "{found:?}, {notes} in the notes");
    }
}
