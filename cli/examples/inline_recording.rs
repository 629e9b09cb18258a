//! Plays the pins of a controller, recorded by `scripts/inline-linuxcnc`, through the bit-exact model of an inline shaper into a machine
//! that rings: `inline_recording MACHINE PINS PERIOD_NS PICTURE [--verilator]`.
//!
//! `PINS` has a line for each period, with its number and the level of every pin of the controller, as LinuxCNC's `halsampler -t` writes.
//! The load of an axis hangs on its motor by the first mode of the axis; the motor stands where the steps put it. Printed are how far the
//! load swings once its motor has stopped, with the shaper and without, and how far it leaves the path. With `--verilator`, the Verilog
//! runs beside the model, and every output is compared in every clock.
//!
//! Exit status: 0 if as many steps came out as went in, 1 if not, or if the Verilog differs, 2 for input that cannot be read.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "this is a program")]

use std::error::Error;
use std::process::ExitCode;

use posicast_blocks::composition::Composed;
use posicast_blocks::step_generator::StepMode;
use posicast_blocks::{ClockedBlock, Direction};
use posicast_flow::plot::{Curve, Panel, svg};
use posicast_machine::hardware::Hardware;
use posicast_machine::machine_file::{self, Machine};
use posicast_machine::plan::design_machine;
use posicast_testbench::blocks::{Sources, compare_with};
use posicast_testbench::inline_shaper::InlineShaperBlock;

/// Inputs before those of the axes: reset, enable, emergency stop (low), bypass, clear.
const SHARED: [u64; 5] = [0, 1, 1, 0, 0];
/// Time for which a controller must not have moved an axis, so that the swing after it is measured, in s.
const STANDS_S: f64 = 0.15;
/// Points of a curve in the picture.
const POINTS: usize = 1500;

fn main() -> ExitCode {
    match run() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}

/// A receiver of steps: it knows only its two lines.
struct Reader {
    mode: StepMode,
    levels: Option<[bool; 2]>,
    steps: i64,
}

impl Reader {
    fn new(mode: StepMode) -> Self {
        Self {
            mode,
            levels: None,
            steps: 0,
        }
    }

    fn reads(&mut self, levels: [bool; 2]) {
        let [a, b] = levels;
        let [a_before, b_before] = self.levels.replace(levels).unwrap_or(levels);
        let rises = |now: bool, before: bool| i64::from(now && !before);
        let code = |a: bool, b: bool| i64::from(b) * 2 + i64::from(a != b);
        self.steps += match self.mode {
            StepMode::StepDirection => rises(a, a_before) * if b { 1 } else { -1 },
            StepMode::UpDown => rises(a, a_before) - rises(b, b_before),
            StepMode::Quadrature => match (code(a, b) - code(a_before, b_before)) & 3 {
                1 => 1,
                3 => -1,
                _ => 0,
            },
        };
    }
}

/// A load on a motor: a mode that the motor's position drives.
struct Load {
    omega: f64,
    damping: f64,
    position: f64,
    velocity: f64,
}

impl Load {
    fn step(&mut self, motor: f64, seconds: f64) {
        let pull = self.omega * self.omega * (motor - self.position);
        self.velocity += (pull - 2.0 * self.damping * self.omega * self.velocity) * seconds;
        self.position += self.velocity * seconds;
    }
}

/// Positions of an axis in mm, one a period.
#[derive(Default)]
struct Track {
    command: Vec<f64>,
    drive: Vec<f64>,
    plain_load: Vec<f64>,
    shaped_load: Vec<f64>,
}

fn run() -> Result<bool, Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (file, pins, period_ns, picture, rest) = match arguments.as_slice() {
        [file, pins, period_ns, picture, rest @ ..] => (file, pins, period_ns.parse::<f64>()?, picture, rest),
        _ => return Err("usage: inline_recording MACHINE PINS PERIOD_NS PICTURE [--verilator]".into()),
    };
    let machine = machine_file::parse(file, &std::fs::read_to_string(file)?)?;
    let design = design_machine(&machine)?;
    let hardware = Hardware::of(&machine, &design)?;
    let inline = hardware.inline()?.ok_or("the machine has no [axis.input]")?;
    let recorded = read(pins, 2 * machine.axes.len(), &machine)?;
    let period_s = period_ns * 1e-9;
    let clocks = (period_s * machine.clock.frequency_hz).round() as u64;
    let block = InlineShaperBlock::new(inline.shaper.clone(), "inline", "inline");

    let (tracks, ends) = play(&machine, inline.shaper.model(1), &recorded, (period_s, clocks))?;
    let mut holds = true;
    println!(
        "{} periods of {period_ns} ns: {:.2} s",
        recorded.len(),
        recorded.len() as f64 * period_s
    );
    for ((axis, (sent, given)), track) in machine.axes.iter().zip(&ends).zip(&tracks) {
        let [into, out] = [&track.command, &track.drive].map(|motor| changes(motor));
        let stops = stops(&track.command, period_s);
        let equal = stops
            .iter()
            .filter(|at| (track.command[**at] - track.drive[**at]).abs() < 1e-12)
            .count();
        println!(
            "{}: {into} changes of the position in, {out} out; equal at {equal} of {} stops, and at the end",
            axis.name,
            stops.len()
        );
        holds &= sent == given && equal == stops.len();
    }
    let mut panels = Vec::new();
    for (axis, track) in machine
        .axes
        .iter()
        .zip(&tracks)
        .filter(|(axis, _)| !axis.modes.is_empty())
    {
        let swings = [
            swing(&track.command, &track.plain_load, period_s),
            swing(&track.drive, &track.shaped_load, period_s),
        ];
        println!(
            "{}: {} stops; the load swings by {:.3} mm without the shaper, {:.3} mm with it",
            axis.name,
            swings[0].1,
            swings[0].0 * 1e3,
            swings[1].0 * 1e3
        );
        panels.push(panel(
            &format!("{}: distance of the load from its motor, mm", axis.name),
            track,
            period_s,
        ));
    }
    if let [x, y, ..] = tracks.as_slice() {
        let path = |x: &[f64], y: &[f64]| thinned(x.iter().zip(y).map(|(x, y)| (x * 1e3, y * 1e3)).collect());
        panels.push(Panel {
            title: "Path of the load".to_owned(),
            x_label: "x, mm".to_owned(),
            y_label: "y, mm".to_owned(),
            curves: vec![
                Curve::under("command", path(&x.command, &y.command)),
                // The first is drawn on top.
                Curve::new("with the shaper", path(&x.shaped_load, &y.shaped_load)),
                Curve::new("without the shaper", path(&x.plain_load, &y.plain_load)),
            ],
            ..Panel::default()
        });
        println!(
            "path: the load leaves that of the command by {:.3} mm without the shaper, {:.3} mm with it",
            leaves((&x.command, &y.command), (&x.plain_load, &y.plain_load)) * 1e3,
            leaves((&x.command, &y.command), (&x.shaped_load, &y.shaped_load)) * 1e3
        );
    }
    std::fs::write(picture, svg(&panels).map_err(|error| error.to_string())?)?;
    if rest.iter().any(|word| word == "--verilator") {
        holds &= compare(&block, &recorded, clocks)?;
    }
    Ok(holds)
}

/// Reads the levels of the pins, a row per period.
fn read(file: &str, pins: usize, machine: &Machine) -> Result<Vec<Vec<u64>>, Box<dyn Error>> {
    let mut rows = Vec::new();
    for line in std::fs::read_to_string(file)?.lines() {
        let numbers: Vec<u64> = line.split_whitespace().map(str::parse).collect::<Result<_, _>>()?;
        let row = numbers.get(1..).filter(|row| row.len() == pins);
        rows.push(
            row.ok_or_else(|| format!("{file}: {pins} pins a line for {}", machine.name))?
                .to_vec(),
        );
    }
    Ok(rows)
}

type Ends = Vec<(i64, i64)>;

fn play(
    machine: &Machine,
    mut model: Composed,
    recorded: &[Vec<u64>],
    (period_s, clocks): (f64, u64),
) -> Result<(Vec<Track>, Ends), Box<dyn Error>> {
    let outputs: Vec<String> = (model.ports().iter())
        .filter(|port| port.direction == Direction::Output)
        .map(|port| port.name.clone())
        .collect();
    let at = |name: &str| outputs.iter().position(|output| output == name).ok_or("no such pin");
    let mut axes = Vec::new();
    for axis in &machine.axes {
        let (Some(input), Some(steps)) = (&axis.input, &axis.steps) else {
            return Err("an axis without input or steps".into());
        };
        let [a, b] = steps.mode.line_names();
        let lines = [at(&format!("{}_{a}", axis.name))?, at(&format!("{}_{b}", axis.name))?];
        let mode = axis.modes.first().map(|of| of.mode);
        let load = || Load {
            omega: mode.map_or(0.0, |mode| mode.omega()),
            damping: mode.map_or(0.0, |mode| mode.damping),
            position: 0.0,
            velocity: 0.0,
        };
        let low = input.active_low;
        axes.push((
            Reader::new(input.kind),
            [low.a, low.b],
            Reader::new(steps.mode),
            steps.active_low,
            lines,
            [load(), load()],
        ));
    }
    let mut tracks: Vec<Track> = machine.axes.iter().map(|_| Track::default()).collect();
    let mut shown = vec![0; outputs.len()];
    // The controller stands while the axes are enabled, so that no step is dropped.
    let first = recorded.first().ok_or("no periods")?;
    let settle = (0.05 / period_s) as usize;
    for row in std::iter::repeat_n(first, settle)
        .chain(recorded)
        .chain(std::iter::repeat_n(recorded.last().ok_or("no periods")?, settle))
    {
        let inputs: Vec<u64> = SHARED.iter().chain(row).copied().collect();
        let mut left = clocks;
        while left > 0 {
            // The outputs stand for these clocks; what they are next shows in the call after it.
            left -= model.hold(&inputs, left, &mut shown)?.max(1);
            for (_, _, drive, low, [a, b], _) in &mut axes {
                drive.reads([(shown[*a] == 1) != low.a, (shown[*b] == 1) != low.b]);
            }
        }
        let of_axes = axes.iter_mut().zip(&machine.axes).zip(&mut tracks).zip(row.chunks(2));
        for ((((command, low, drive, _, _, loads), axis), track), pins) in of_axes {
            command.reads([(pins[0] == 1) != low[0], (pins[1] == 1) != low[1]]);
            let metres = |steps: i64| steps as f64 / axis.counts_per_unit;
            let motors = [metres(command.steps), metres(drive.steps)];
            for (load, motor) in loads.iter_mut().zip(motors) {
                load.step(motor, period_s);
            }
            track.command.push(motors[0]);
            track.drive.push(motors[1]);
            track.plain_load.push(loads[0].position);
            track.shaped_load.push(loads[1].position);
        }
    }
    let ends = axes
        .iter()
        .map(|(command, _, drive, ..)| (command.steps, drive.steps))
        .collect();
    Ok((tracks, ends))
}

/// Number of periods in which the position changes.
fn changes(motor: &[f64]) -> usize {
    motor.windows(2).filter(|ends| (ends[1] - ends[0]).abs() > 0.0).count()
}

/// The periods in which the motor has stood for [`STANDS_S`] after a move.
fn stops(motor: &[f64], period_s: f64) -> Vec<usize> {
    let long = stands_periods(period_s);
    let (mut stops, mut since) = (Vec::new(), 0);
    for at in 1..motor.len() {
        if (motor[at] - motor[at - 1]).abs() > 0.0 {
            since = at;
        }
        if at - since == long && since > 0 {
            stops.push(at);
        }
    }
    stops
}

fn stands_periods(period_s: f64) -> usize {
    (STANDS_S / period_s) as usize
}

/// Largest distance of the load from its motor while that stands, and the number of stops.
fn swing(motor: &[f64], load: &[f64], period_s: f64) -> (f64, usize) {
    let stops = stops(motor, period_s);
    let away = stops.iter().flat_map(|at| at - stands_periods(period_s)..*at);
    let largest = away.map(|at| (load[at] - motor[at]).abs()).fold(0.0, f64::max);
    (largest, stops.len())
}

/// Largest distance of a path from all points of another.
fn leaves((command_x, command_y): (&[f64], &[f64]), (x, y): (&[f64], &[f64])) -> f64 {
    let points: Vec<(f64, f64)> = thinned(command_x.iter().copied().zip(command_y.iter().copied()).collect());
    let nearest = |x: f64, y: f64| {
        let lines = points.windows(2).map(|ends| {
            let ((ax, ay), (bx, by)) = (ends[0], ends[1]);
            let (dx, dy) = (bx - ax, by - ay);
            let length = dx * dx + dy * dy;
            let along = if length > 0.0 {
                ((x - ax) * dx + (y - ay) * dy) / length
            } else {
                0.0
            };
            let along = along.clamp(0.0, 1.0);
            (x - ax - along * dx).hypot(y - ay - along * dy)
        });
        lines.fold(f64::INFINITY, f64::min)
    };
    let of_load = thinned(x.iter().copied().zip(y.iter().copied()).collect());
    of_load.iter().map(|(x, y)| nearest(*x, *y)).fold(0.0, f64::max)
}

fn thinned(points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    let every = points.len().div_ceil(POINTS).max(1);
    points.into_iter().step_by(every).collect()
}

fn panel(title: &str, track: &Track, period_s: f64) -> Panel {
    let away = |motor: &[f64], load: &[f64]| {
        let points = motor.iter().zip(load).enumerate();
        thinned(
            points
                .map(|(at, (motor, load))| (at as f64 * period_s, (load - motor) * 1e3))
                .collect(),
        )
    };
    Panel {
        title: title.to_owned(),
        x_label: "time, s".to_owned(),
        y_label: "distance, mm".to_owned(),
        curves: vec![
            Curve::new("with the shaper", away(&track.drive, &track.shaped_load)),
            Curve::new("without the shaper", away(&track.command, &track.plain_load)),
        ],
        ..Panel::default()
    }
}

/// Runs the Verilog beside the model on the recorded pins.
fn compare(block: &InlineShaperBlock, recorded: &[Vec<u64>], clocks: u64) -> Result<bool, Box<dyn Error>> {
    let mut device = Sources::write(block)?.verilated(block, 1)?;
    let mut clock = 0;
    let mut stimuli = |_: &[u64], inputs: &mut [u64]| {
        let row = recorded.get((clock / clocks) as usize).map_or(&[][..], Vec::as_slice);
        for (input, value) in inputs.iter_mut().zip(SHARED.iter().chain(row)) {
            *input = *value;
        }
        clock += 1;
    };
    let cycles = recorded.len() as u64 * clocks;
    let run = compare_with(block, &mut device, &mut stimuli, cycles, 1, &mut |_| {})?;
    println!("Verilog: {} wrong outputs in {cycles} clocks", run.report.mismatches());
    Ok(run.report.mismatches() == 0)
}
