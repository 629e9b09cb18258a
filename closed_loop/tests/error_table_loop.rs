//! The error table in the closed loop: a stage on an inaccurate screw, with and without the table. This command prints
//! the figures of `docs/error_table.md`:
//!
//! ```text
//! cargo nextest run --workspace -E 'test(figure_the_error_of_a_screw)' --no-capture
//! ```
#![allow(clippy::unwrap_used)] // helpers of tests, which clippy.toml exempts only inside of #[test]

use std::f64::consts::TAU;

use posicast_blocks::error_table::FULL_WEIGHT;
use posicast_closed_loop::stage_bench::StageBench;
use posicast_machine::machine_file::{self, Machine};
use posicast_machine::motion::{TickLimits, plan_move};
use posicast_machine::plant::axis::PlantOptions;

use crate::support::{XY, bench, stage, verilated};

/// Counts per metre of the example.
const COUNTS_PER_M: f64 = 1e6;
/// Number of ticks after which a move and its vibration are over.
const SETTLED_TICKS: u64 = 400;

/// Error of a screw of 5 mm lead in m, as true minus counted position: 80 µm/m too long, and a periodic error of 3 µm
/// per turn.
fn screw(position: f64) -> f64 {
    80e-6 * position + 3e-6 * (TAU * position / 5e-3).sin()
}

/// The error as an interferometer measures it, every half millimetre over the travel and a little beyond.
fn measured() -> String {
    let rows = (-204..=204).map(|place| f64::from(place) * 0.5e-3);
    let rows = rows.map(|position| format!("{position},{}\n", screw(position)));
    format!("# of the screw of x\nposition,error\n{}", rows.collect::<String>())
}

fn machine(apply: &str) -> Machine {
    let table = format!("[axis.error_table]\nfile = \"errors.csv\"\napply = \"{apply}\"\n\n[axis.limits]");
    let text = XY.replacen("[axis.limits]", &table, 1);
    let beside = |name: &str| match name {
        "errors.csv" => Ok(measured()),
        _ => Err("not there".to_owned()),
    };
    machine_file::parse_beside("xy-stage.toml", &text, &beside).unwrap_or_else(|error| panic!("{error:?}"))
}

struct Bed {
    bench: StageBench,
    limits: TickLimits,
    tick_clocks: u64,
}

impl Bed {
    /// Switches on the machine of X and Y; with `with_verilog` the RTL runs beside the model.
    fn new(apply: &str, with_verilog: bool) -> Self {
        let machine = machine(apply);
        let stage = stage(&machine);
        let device = with_verilog.then(|| verilated(&stage));
        let mut bench = bench(&machine, &stage, &PlantOptions::default(), device, 1);
        assert!(bench.switch_on(20_000_000).unwrap());
        Self {
            bench,
            limits: TickLimits::of_axis(&machine.axes[0], &machine.clock),
            tick_clocks: stage.config.tick.tick_clocks().into(),
        }
    }

    fn ticks(&mut self, ticks: u64) {
        for _ in 0..ticks {
            self.bench.write("x_kick", 0x4b49_434b).unwrap();
            self.bench.write("y_kick", 0x4b49_434b).unwrap();
            self.bench.clocks(self.tick_clocks - 4).unwrap();
        }
    }

    /// Moves X to a position in m and lets it settle.
    fn go(&mut self, position: f64) {
        let from = self.bench.read("x_command_position").unwrap() as i32;
        let to = (position * COUNTS_PER_M * 256.0).round() as i32;
        let entries = plan_move(i64::from(from) << 24, to, &self.limits).unwrap();
        let ticks: u32 = entries.iter().map(|entry| entry.ticks).sum();
        for entry in &entries {
            self.bench.segment("x", entry).unwrap();
        }
        self.bench.write("start", 1).unwrap();
        self.ticks(u64::from(ticks) + SETTLED_TICKS);
        assert_eq!(self.bench.read("x_causes").unwrap(), 0);
        assert_eq!(self.bench.read("x_command_position").unwrap() as i32, to);
    }

    /// Returns the distance of the table from its target in m: the screw is inaccurate everywhere, and the loop sees
    /// only its counter.
    fn off_by(&mut self, position: f64) -> f64 {
        let counted = self.bench.plant(0).motion().position;
        counted + screw(counted) - position
    }
}

fn largest(errors: &[f64]) -> f64 {
    errors.iter().fold(0.0, |largest, error| error.abs().max(largest))
}

/// Positions over the travel, between the entries of the table.
const PLACES: [f64; 4] = [0.0371, 0.0628, -0.0214, -0.0907];

/// Returns the largest errors at rest at these positions.
fn errors(bed: &mut Bed) -> Vec<f64> {
    let off = |position: &f64| {
        bed.go(*position);
        bed.off_by(*position)
    };
    PLACES.iter().map(off).collect()
}

#[test]
fn long_figure_the_error_of_a_screw_with_and_without_its_table() {
    for apply in ["reference", "feedback"] {
        let mut bed = Bed::new(apply, false);
        let without = largest(&errors(&mut bed));
        bed.bench.write("x_homed", 1).unwrap();
        bed.ticks(u64::from(FULL_WEIGHT) + 2);
        let with = largest(&errors(&mut bed));
        let micrometres = |error: f64| format!("{:.2} µm", 1e6 * error);
        println!(
            "{apply}: {} without, {} with the table",
            micrometres(without),
            micrometres(with)
        );
        // Without the table the error is 80 µm/m at 91 mm plus the 3 µm per turn; with it, half a count of 1 µm and the
        // error between two entries.
        assert!(without > 6e-6, "{without}");
        assert!(with < 0.75e-6, "{apply}: {with}");
    }
}

#[test]
fn nothing_jumps_on_the_model_when_the_table_comes_and_goes() {
    nothing_jumps_when_the_table_comes_and_goes(false);
}

#[test]
fn long_lockstep_nothing_jumps_when_the_table_comes_and_goes() {
    nothing_jumps_when_the_table_comes_and_goes(true);
}

fn nothing_jumps_when_the_table_comes_and_goes(with_verilog: bool) {
    let mut bed = Bed::new("reference", with_verilog);
    // After a quarter of a turn the error is 3.1 µm.
    bed.go(0.00125);
    let compensated = bed.bench.probe("x_compensated").unwrap();
    let mut last = bed.bench.at(compensated) as u32 as i32;
    let mut largest_step = 0;
    for homed in [1, 0] {
        bed.bench.write("x_homed", homed).unwrap();
        for _ in 0..40 {
            bed.ticks(1);
            let now = bed.bench.at(compensated) as u32 as i32;
            largest_step = largest_step.max((now - last).abs());
            last = now;
        }
    }
    // These are 3.1 µm in 1024 ticks, rounded: never more than a 256th of a count.
    assert_eq!(largest_step, 1);
    assert_eq!(bed.bench.mismatches(), (0, None));
}
