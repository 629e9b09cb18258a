//! The PWM's model compared with its pin rule and its fast path, and what a motion engineer expects of it.

use posicast_blocks::pwm::pulses::{Bridge, Half, Latched, Pattern, Timing};
use posicast_blocks::pwm::{ActiveLow, BridgeMode, Gates, Inputs, Outputs, Pwm, PwmConfig};
use proptest::prelude::*;

const MODES: [BridgeMode; 4] = [
    BridgeMode::Direction,
    BridgeMode::HalfBridge,
    BridgeMode::Unipolar,
    BridgeMode::Locked,
];

fn config() -> PwmConfig {
    PwmConfig::new(ActiveLow::default(), 1, 1).unwrap()
}

/// Returns inputs without any fault.
fn healthy(timing: &Timing) -> Inputs {
    Inputs {
        enable: true,
        period: timing.period as u16,
        max_duty: 0xffff,
        dead_time: timing.dead_time as u16,
        minimum_pulse: timing.minimum_pulse as u16,
        fault_n: true,
        pll_locked: true,
        filtered_fault_n: 3,
        ..Inputs::default()
    }
}

fn gates(shown: &Outputs) -> Gates {
    Gates {
        a_high: shown.a_high,
        a_low: shown.a_low,
        b_high: shown.b_high,
        b_low: shown.b_low,
    }
}

/// Returns a PWM that has just begun to run, at the first position of its first period, with `inputs` applied for a
/// long time.
fn started(inputs: &Inputs) -> Pwm {
    let mut pwm = Pwm::new(&config());
    let clears = Inputs {
        clear_trip: true,
        enable: false,
        ..*inputs
    };
    pwm.hold(&clears, 70_000);
    while !pwm.outputs(inputs).running {
        pwm.step(inputs);
    }
    pwm
}

fn timing() -> impl Strategy<Value = Timing> {
    (1i64..=6, 1i64..=9).prop_flat_map(|(dead_time, minimum_pulse)| {
        (64i64..=110).prop_map(move |period| Timing {
            period,
            dead_time,
            minimum_pulse,
        })
    })
}

fn commands() -> impl Strategy<Value = Vec<(usize, i64)>> {
    prop::collection::vec((0usize..40, -120i64..=120), 1..60)
}

/// Returns every gate in every clock, by the pin rule.
fn by_the_rule(timing: &Timing, at_peak: bool, latched: &[Latched]) -> Vec<Gates> {
    let rising = timing.period / 2;
    let mut bridge = Bridge::default();
    let (mut shown, mut now) = (Vec::new(), Gates::default());
    let mut commands = latched.iter();
    'periods: loop {
        for (half, clocks) in [(Half::Rising, rising), (Half::Falling, timing.period - rising)] {
            let updates = half == Half::Rising || at_peak;
            let taken = if updates { commands.next() } else { None };
            if updates && taken.is_none() {
                break 'periods;
            }
            let edges = bridge.half(timing, half, taken);
            for clock in 0..clocks {
                for edge in edges.iter().filter(|edge| edge.clock == clock) {
                    now = edge.gates;
                }
                shown.push(now);
            }
        }
    }
    shown
}

/// Returns every gate in every clock, by the clocked model.
fn by_the_clock(timing: &Timing, at_peak: bool, latched: &[Latched]) -> Vec<Gates> {
    let with = |latched: &Latched| Inputs {
        mode: latched.mode as u8,
        duty: latched.duty as i32,
        max_duty: latched.max_duty as u16,
        update_at_peak: at_peak,
        ..healthy(timing)
    };
    let mut pwm = started(&with(&latched[0]));
    let rising = timing.period / 2;
    let mut shown = Vec::new();
    let mut position = 0;
    for (at, now) in latched.iter().enumerate() {
        let next = latched.get(at + 1).unwrap_or(now);
        let clocks = match (at_peak, at % 2) {
            (false, _) => timing.period,
            (true, 0) => rising,
            (true, _) => timing.period - rising,
        };
        for _ in 0..clocks {
            shown.push(gates(&pwm.step(&with(next))));
            position += 1;
        }
    }
    // The pins come one clock after the position.
    shown.push(gates(&pwm.step(&with(&latched[latched.len() - 1]))));
    assert_eq!(shown.len(), position + 1);
    shown.remove(0);
    shown
}

proptest! {
    #[test]
    fn prop_the_clocked_model_keeps_the_pin_rule(
        timing in timing(), at_peak: bool, commands in commands(), max_duty in prop_oneof![Just(0xffffi64), 1i64..110],
    ) {
        let mut mode = BridgeMode::Unipolar;
        let latched: Vec<Latched> = commands.into_iter().map(|(change, duty)| {
            mode = MODES.get(change).copied().unwrap_or(mode);
            Latched { mode, duty, max_duty }
        }).collect();
        let expected = by_the_rule(&timing, at_peak, &latched);
        let actual = by_the_clock(&timing, at_peak, &latched);
        for (clock, (actual, expected)) in actual.iter().zip(&expected).enumerate() {
            prop_assert_eq!(actual, expected, "clock {} of {:?}, {:?}", clock, timing, latched);
        }
    }

    #[test]
    fn prop_pulses_and_pauses_keep_their_lengths(timing in timing(), at_peak: bool, duties in prop::collection::vec(-120i64..=120, 1..60)) {
        for mode in [BridgeMode::HalfBridge, BridgeMode::Unipolar, BridgeMode::Locked] {
            let latched: Vec<_> = duties.iter().map(|&duty| Latched { mode, duty, max_duty: 0xffff }).collect();
            let shown = by_the_rule(&timing, at_peak, &latched);
            for sides in [|g: &Gates| (g.a_high, g.a_low), |g: &Gates| (g.b_high, g.b_low)] {
                // A run is a sequence of equal states: neither side, high, or low.
                let mut runs: Vec<((bool, bool), i64)> = Vec::new();
                for gates in &shown {
                    match runs.last_mut() {
                        Some((state, clocks)) if *state == sides(gates) => *clocks += 1,
                        _ => runs.push((sides(gates), 1)),
                    }
                }
                prop_assert!(runs.iter().all(|(state, _)| *state != (true, true)));
                // The first and the last run may be cut.
                for (state, clocks) in runs.iter().skip(1).rev().skip(1) {
                    let least = if *state == (false, false) { timing.dead_time } else { timing.minimum_pulse };
                    prop_assert!(*clocks >= least, "{:?} for {} clocks, {:?}", state, clocks, timing);
                }
            }
        }
    }

    #[test]
    fn prop_holding_is_stepping(
        period in prop_oneof![1u16..60, any::<u16>()], duty in -70_000i32..70_000, mode: u8, dead_time in 0u16..30,
        minimum_pulse in 0u16..30, trigger_phase in 0u16..100, at_peak: bool,
        changes in prop::collection::vec((0u8..12, 1u64..700), 1..40),
    ) {
        let mut inputs = Inputs {
            enable: true, mode, period, duty: duty % (i32::from(period) + 5), max_duty: 0xffff, dead_time, minimum_pulse,
            trigger_phase, update_at_peak: at_peak, fault_n: true, pll_locked: true, filtered_fault_n: 3, clear_trip: true,
            watchdog_periods: 3, feed: true, ..Inputs::default()
        };
        let (mut fast, mut slow) = (Pwm::new(&config()), Pwm::new(&config()));
        for (change, clocks) in changes {
            match change {
                0 => inputs.enable ^= true,
                1 => inputs.duty = -inputs.duty,
                2 => inputs.mode = inputs.mode.wrapping_add(1),
                3 => inputs.fault_n ^= true,
                4 => inputs.filtered_fault_n ^= 1,
                5 => inputs.feed ^= true,
                6 => inputs.sync ^= true,
                7 => inputs.clear_trip ^= true,
                8 => inputs.filter_clocks ^= 9,
                9 => inputs.clear_flags ^= true,
                10 => inputs.mask_pins ^= true,
                _ => {}
            }
            fast.hold(&inputs, clocks);
            (0..clocks).for_each(|_| { slow.step(&inputs); });
            prop_assert_eq!(fast.outputs(&inputs), slow.outputs(&inputs));
        }
    }
}

#[test]
fn the_width_is_duty_less_dead_time_down_to_none_and_up_to_full() {
    let timing = Timing {
        period: 100,
        dead_time: 4,
        minimum_pulse: 6,
    };
    let width = |duty| {
        timing.pattern(timing.width(&Latched {
            mode: BridgeMode::HalfBridge,
            duty,
            max_duty: 1000,
        }))
    };
    assert_eq!(width(9), Pattern::Low);
    assert_eq!(width(10), Pattern::Pulse(6));
    assert_eq!(width(90), Pattern::Pulse(86));
    assert_eq!(width(91), Pattern::High);
    assert_eq!(width(65_535), Pattern::High);
    assert_eq!(width(-50), Pattern::Low);
}

#[test]
fn locked_antiphase_is_balanced_at_zero() {
    let timing = Timing {
        period: 100,
        dead_time: 4,
        minimum_pulse: 6,
    };
    let latched = [Latched {
        mode: BridgeMode::Locked,
        duty: 0,
        max_duty: 100,
    }; 6];
    let shown = by_the_rule(&timing, false, &latched);
    let last = &shown[500..];
    let clocks = |gate: fn(&Gates) -> bool| last.iter().filter(|gates| gate(gates)).count();
    assert_eq!((clocks(|g| g.a_high), clocks(|g| g.a_low)), (46, 46));
    assert!(last.iter().all(|g| g.a_high == g.b_low && g.a_low == g.b_high));
}

#[test]
fn the_floor_holds_and_running_refuses() {
    let timing = Timing {
        period: 100,
        dead_time: 3,
        minimum_pulse: 4,
    };
    let mut inputs = healthy(&timing);
    let mut pwm = started(&inputs);
    (inputs.dead_time, inputs.period) = (0, 90);
    pwm.hold(&inputs, 500);
    let shown = pwm.outputs(&inputs);
    assert_eq!(
        (shown.dead_time_used, shown.refused, shown.below_floor),
        (3, true, true)
    );
    inputs.enable = false;
    pwm.hold(&inputs, 500);
    assert_eq!(pwm.outputs(&inputs).dead_time_used, 1);
}

/// With 2 · (dead time + minimum pulse) both sides last the minimum and no longer, so that a leg that is late stays
/// late.
#[test]
fn a_period_without_slack_is_not_started() {
    let with_period = |period| {
        let inputs = healthy(&Timing {
            period,
            dead_time: 20,
            minimum_pulse: 15,
        });
        let mut pwm = Pwm::new(&config());
        pwm.hold(
            &Inputs {
                clear_trip: true,
                enable: false,
                ..inputs
            },
            1000,
        );
        pwm.hold(&inputs, 1000);
        (pwm.outputs(&inputs).running, pwm.outputs(&inputs).below_floor)
    };
    assert_eq!(with_period(69), (true, false));
    assert_eq!(with_period(70), (false, true));
    assert_eq!(with_period(71), (true, false));
}

/// With a clock more, a leg that starts late is in phase again after as many periods as it was late by clocks.
#[test]
fn a_leg_that_starts_late_catches_up() {
    let timing = Timing {
        period: 71,
        dead_time: 20,
        minimum_pulse: 15,
    };
    let inputs = Inputs {
        // The low side comes first from off, and then lasts its minimum: the first pulse is late.
        mode: BridgeMode::Direction as u8,
        duty: 35,
        ..healthy(&timing)
    };
    let mut pwm = started(&inputs);
    let mut edge_of = |_: i64| {
        let high: Vec<bool> = (0..timing.period).map(|_| pwm.step(&inputs).a_high).collect();
        high.iter().position(|high| *high)
    };
    let edges: Vec<Option<usize>> = (0..60).map(&mut edge_of).collect();
    assert_eq!((edges[0], edges[27]), (Some(56), edges[59]), "{edges:?}");
    // By the pin rule, half the pulse is before the peak; the pins follow by a clock.
    assert_eq!(edges[59], Some(35 - 15 / 2 + 1));
}

#[test]
fn a_hungry_watchdog_trips_after_so_many_valleys() {
    let timing = Timing {
        period: 100,
        dead_time: 3,
        minimum_pulse: 4,
    };
    let inputs = Inputs {
        watchdog_periods: 2,
        ..healthy(&timing)
    };
    let mut pwm = started(&inputs);
    pwm.hold(&inputs, 299);
    assert!(!pwm.outputs(&inputs).tripped);
    pwm.hold(&inputs, 1);
    assert_eq!(pwm.outputs(&inputs).trip_causes, 0b1_0000);
}

#[test]
fn the_time_base_sets_the_phase_while_off() {
    let timing = Timing {
        period: 100,
        dead_time: 3,
        minimum_pulse: 4,
    };
    let mut inputs = Inputs {
        enable: false,
        phase: 12,
        trigger_phase: 12,
        ..healthy(&timing)
    };
    let mut pwm = Pwm::new(&config());
    pwm.hold(&inputs, 150);
    for turn in 0..5 {
        inputs.sync = true;
        pwm.step(&inputs);
        inputs.sync = false;
        // The first `sync` finds it elsewhere, and it waits at 12 for the second. From then on the position is 12 in
        // the clock after `sync`; the trigger comes with the pins, another clock later.
        pwm.step(&inputs);
        assert_eq!(pwm.outputs(&inputs).trigger, turn > 0, "turn {turn}");
        pwm.hold(&inputs, 298);
    }
}

/// Returns, for a host that enables at once, the clocks from reset to `running`, and whether the PWM was ever out of
/// phase.
fn first_start(config: &PwmConfig, inputs: &Inputs, tick_clocks: u64) -> (Option<u64>, bool) {
    let mut pwm = Pwm::new(config);
    let mut start = None;
    for clock in 0..6 * tick_clocks {
        let shown = pwm.step(&Inputs {
            sync: clock % tick_clocks == tick_clocks - 1,
            clear_trip: true,
            ..*inputs
        });
        start = start.or(shown.running.then_some(clock));
        if shown.unaligned {
            return (start, true);
        }
    }
    (start, false)
}

#[test]
fn on_a_time_base_it_does_not_start_before_it_is_in_phase() {
    let timing = Timing {
        period: 100,
        dead_time: 3,
        minimum_pulse: 4,
    };
    let alone = PwmConfig::new(ActiveLow::default(), 1, 1).unwrap();
    for phase in [0, 1, 31, 32, 50, 99] {
        let inputs = Inputs {
            phase,
            ..healthy(&timing)
        };
        let (start, unaligned) = first_start(&alone.on_time_base(), &inputs, 1000);
        assert!(!unaligned, "phase {phase}");
        assert!(
            start.is_some_and(|clock| (1000..3200).contains(&clock)),
            "phase {phase}: {start:?}"
        );
    }
    // Alone, it cannot know of a time base before the first `sync`.
    assert!(first_start(&alone, &healthy(&timing), 1000).1);
}

/// Another period, set while it is off: the PWM is in phase by chance only, and waits for the next `sync`.
#[test]
fn with_another_period_it_waits_for_the_time_base_again() {
    for config in [config(), config().on_time_base()] {
        let mut pwm = Pwm::new(&config);
        let mut inputs = Inputs {
            period: 125,
            clear_trip: true,
            ..healthy(&Timing {
                period: 100,
                dead_time: 3,
                minimum_pulse: 4,
            })
        };
        let mut ran = [false; 2];
        for clock in 0..12_000 {
            (inputs.period, inputs.enable) = if clock < 5300 {
                (125, clock > 2500 && clock < 5200)
            } else {
                (100, true)
            };
            inputs.sync = clock % 1000 == 999;
            let shown = pwm.step(&inputs);
            ran[usize::from(clock >= 5300)] |= shown.running;
            assert!(!shown.unaligned, "clock {clock}");
        }
        assert_eq!(ran, [true; 2]);
    }
}

#[test]
fn a_mask_takes_the_pins_and_nothing_else() {
    let timing = Timing {
        period: 100,
        dead_time: 3,
        minimum_pulse: 4,
    };
    let open = Inputs {
        mode: BridgeMode::Unipolar as u8,
        duty: 30,
        ..healthy(&timing)
    };
    let masked = Inputs {
        mask_pins: true,
        ..open
    };
    let (mut bare, mut hidden) = (started(&open), started(&open));
    let mut on = 0;
    for clock in 0..800 {
        let inputs = if (200..600).contains(&clock) { &masked } else { &open };
        let (expected, shown) = (bare.step(&open), hidden.step(inputs));
        // A register shows it one clock later.
        let pins = if (201..601).contains(&clock) {
            Gates::default()
        } else {
            gates(&expected)
        };
        assert_eq!(gates(&shown), pins, "clock {clock}");
        let rest = |shown: Outputs| Outputs {
            a_high: false,
            a_low: false,
            b_high: false,
            b_low: false,
            ..shown
        };
        assert_eq!(rest(shown), rest(expected), "clock {clock}");
        assert_eq!(shown.gates, gates(&expected), "clock {clock}");
        on += usize::from((200..600).contains(&clock) && shown.gates.a_high);
    }
    assert_eq!(on, 4 * (30 - 3));
}
