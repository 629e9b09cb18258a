//! Compares the PWM's Verilog with the pin rule alone, over a million periods: every edge on the pins is that of
//! `posicast_blocks::pwm::pulses`, a function of what is latched at the boundary. The clocked model is not used.

use crate::support::broken;
use posicast_blocks::pwm::pulses::{Bridge, Half, Latched, Timing};
use posicast_blocks::pwm::{
    ActiveLow, BridgeMode, COMMAND_CLOCKS, Gates, INPUT_PORTS, Inputs, OUTPUT_PORTS, PwmConfig, SHORTEST_PERIOD_CLOCKS,
    ports,
};
use posicast_hdl::pwm::{emit, name};
use posicast_testbench::blocks::Sources;
use posicast_testbench::pwm::GateSafety;
use posicast_testbench::verilator::{Verilated, VerilogSource};
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Number of PWM periods with the same period, dead time and minimum pulse.
const STRETCH_PERIODS: u64 = 500;
/// Number of clocks from a position of the carrier until the pins show it.
const PIN_CLOCKS: usize = 1;
/// Number of clocks from reset to the first valley, at which the period is taken.
const FIRST_VALLEY: i64 = 32;
const SHORTEST_PERIOD: i64 = SHORTEST_PERIOD_CLOCKS as i64;

/// Compiles the PWM with Verilator, with the first `from` in the Verilog replaced by `to`.
fn verilated(from: &str, to: &str) -> Verilated {
    let config = PwmConfig::new(ActiveLow::default(), 1, 1).unwrap();
    let sources = Sources::of_modules(&broken(&emit(&config, "").unwrap(), from, to)).unwrap();
    let ports = ports();
    let source = VerilogSource {
        files: sources.files(),
        top: &name(&config, ""),
        ports: &ports,
    };
    Verilated::build(&source, 1).unwrap()
}

/// Result of one run with constant times.
#[derive(Debug, Default)]
struct Found {
    periods: u64,
    edges: u64,
    wrong: Option<String>,
}

struct Bench {
    device: Verilated,
    rng: Xoshiro256PlusPlus,
    safety: GateSafety,
    rows: Vec<u64>,
    shown: Vec<u64>,
    expected: Vec<[bool; 4]>,
}

impl Bench {
    fn new(device: Verilated, seed: u64) -> Self {
        Self {
            device,
            rng: Xoshiro256PlusPlus::seed_from_u64(seed),
            safety: GateSafety::new(ActiveLow::default()),
            rows: Vec::new(),
            shown: Vec::new(),
            expected: Vec::new(),
        }
    }

    fn timing(&mut self) -> Timing {
        let (dead_time, minimum_pulse) = (self.rng.random_range(1..=4), self.rng.random_range(1..=4));
        Timing {
            period: self.rng.random_range(SHORTEST_PERIOD..=SHORTEST_PERIOD + 30),
            dead_time,
            minimum_pulse,
        }
    }

    /// Chooses mostly the previous mode, and any duty, often one at the ends.
    fn command(&mut self, timing: &Timing, before: &Latched) -> Latched {
        let rng = &mut self.rng;
        let period = timing.period;
        let within = rng.random_range(-period - 3..=period + 3);
        let duties = [within, within, within, 0, period, -period, before.duty, -before.duty];
        let modes = [
            BridgeMode::Direction,
            BridgeMode::HalfBridge,
            BridgeMode::Unipolar,
            BridgeMode::Locked,
        ];
        let changes = rng.random_range(0..40) == 0;
        Latched {
            mode: if changes {
                modes[rng.random_range(0..4)]
            } else {
                before.mode
            },
            duty: duties[rng.random_range(0..duties.len())],
            max_duty: before.max_duty,
        }
    }

    /// Resets, starts, and plays `periods` periods with new values at every boundary.
    fn stretch(&mut self, periods: u64, found: &mut Found) {
        let timing = self.timing();
        let update_at_peak = self.rng.random_range(0..2) == 0;
        let limited = self.rng.random_range(1..=timing.period);
        let mut latched = Latched {
            mode: BridgeMode::HalfBridge,
            duty: 0,
            max_duty: if self.rng.random_range(0..3) == 0 {
                limited
            } else {
                0xffff
            },
        };
        let inputs = |latched: &Latched| Inputs {
            enable: true,
            mode: latched.mode as u8,
            period: timing.period as u16,
            duty: latched.duty as i32,
            max_duty: latched.max_duty as u16,
            update_at_peak,
            dead_time: timing.dead_time as u16,
            minimum_pulse: timing.minimum_pulse as u16,
            fault_n: true,
            pll_locked: true,
            filtered_fault_n: 3,
            ..Inputs::default()
        };
        self.rows.clear();
        self.expected.clear();
        let reset = Inputs {
            rst: true,
            ..inputs(&latched)
        };
        self.rows.extend(reset.to_raw());
        // The first valley takes the period. The trip is cleared; the last of four periods enables the outputs, and the
        // next one runs.
        let run_in = 1 + FIRST_VALLEY + 4 * timing.period;
        for clock in 1..run_in {
            let waits = Inputs {
                clear_trip: true,
                enable: clock >= run_in - timing.period,
                ..inputs(&latched)
            };
            self.rows.extend(waits.to_raw());
        }
        let first = self.rows.len() / INPUT_PORTS;

        let mut bridge = Bridge::default();
        let mut gates = Gates::default();
        let rising = timing.period / 2;
        for _ in 0..periods {
            for (half, clocks) in [(Half::Rising, rising), (Half::Falling, timing.period - rising)] {
                let updates = half == Half::Rising || update_at_peak;
                let taken = latched;
                let edges = bridge.half(&timing, half, updates.then_some(&taken));
                let next = self.command(&timing, &latched);
                let mut edges = edges.iter().peekable();
                for clock in 0..clocks {
                    while let Some(edge) = edges.next_if(|edge| edge.clock == clock) {
                        gates = edge.gates;
                        found.edges += 1;
                    }
                    self.expected
                        .push([gates.a_high, gates.a_low, gates.b_high, gates.b_low]);
                    // The next boundary reads its command this many clocks before; until then it can have any value.
                    let left = clocks - clock;
                    let row = if left == i64::from(COMMAND_CLOCKS) + 1 {
                        inputs(&next)
                    } else {
                        let noise = self.rng.next_u32();
                        Inputs {
                            duty: (noise as i32) >> 20,
                            mode: (noise & 3) as u8,
                            ..inputs(&next)
                        }
                    };
                    self.rows.extend(row.to_raw());
                }
                if half == Half::Falling || update_at_peak {
                    latched = next;
                }
            }
        }
        let clocks = self.rows.len() / INPUT_PORTS;
        self.shown.clear();
        self.shown.resize(clocks * OUTPUT_PORTS, 0);
        self.device.run(&self.rows, &mut self.shown).unwrap();
        self.compare(first, found);
        found.periods += periods;
    }

    /// Checks the edges; `first` is the clock of the first position that runs.
    fn compare(&mut self, first: usize, found: &mut Found) {
        for (clock, shown) in self.shown.chunks_exact(OUTPUT_PORTS).enumerate() {
            self.safety.observe(shown);
            let Some(at) = clock.checked_sub(first + PIN_CLOCKS) else {
                continue;
            };
            let Some(expected) = self.expected.get(at) else {
                continue;
            };
            let actual = [0, 1, 2, 3].map(|gate: usize| shown[gate] != 0);
            if actual != *expected && found.wrong.is_none() {
                found.wrong = Some(format!("clock {at}: {actual:?} instead of {expected:?}"));
            }
        }
        if let Some(violation) = self.safety.violation() {
            found.wrong.get_or_insert(violation.to_owned());
        }
    }
}

fn run(device: Verilated, seed: u64, periods: u64) -> Found {
    let mut bench = Bench::new(device, seed);
    let mut found = Found::default();
    while found.periods < periods && found.wrong.is_none() {
        bench.stretch(STRETCH_PERIODS, &mut found);
    }
    found
}

#[track_caller]
fn every_edge_is_that_of_the_pin_rule(periods: u64) {
    let found = run(verilated("", ""), 1, periods);
    assert_eq!(found.wrong, None);
    assert!(found.edges > 2 * found.periods, "{found:?}");
}

#[test]
fn lockstep_every_edge_of_many_periods_is_that_of_the_pin_rule() {
    every_edge_is_that_of_the_pin_rule(50_000);
}

#[test]
fn long_lockstep_every_edge_of_a_million_periods_is_that_of_the_pin_rule() {
    every_edge_is_that_of_the_pin_rule(1_000_000);
}

/// Breaks the Verilog and requires a wrong edge.
fn caught(from: &str, to: &str) {
    let found = run(verilated(from, to), 1, 20_000);
    assert!(found.wrong.is_some(), "`{to}` is not found");
}

#[test]
fn lockstep_catches_a_dead_time_a_clock_too_short() {
    caught("lasts = dead_time;", "lasts = dead_time - 10'd1;");
}

#[test]
fn lockstep_catches_a_minimum_pulse_a_clock_too_short() {
    caught("{18'd0, carries}", "{17'd0, shortness, carries}");
}

#[test]
fn lockstep_catches_a_direction_that_turns_from_the_high_side() {
    caught("may_turn = !leg_awake | leg_low_side", "may_turn = 1'd1");
}
