//! The actions of `posicast host` on a stage, and those that an inline shaper has, too.

use super::inline::InlinePort;
use super::{CompareSwitch, Port, TraceArgs, axis_of, failure};
use crate::output;
use posicast_flow::Failure;
use posicast_flow::design::DesignReport;
use posicast_flow::machine;
use posicast_flow::moves::PerAxis;
use posicast_flow::text::{shell_word, write_text};
use posicast_host::{HostError, HostMove, RecordedTrace, Shake, TraceRequest};
use posicast_machine::machine_file::Machine;
use posicast_system::output::OutputFiles;
use posicast_taps::TapTable;
use posicast_testbench::wording::counted;
use std::fmt::Write as _;
use std::path::Path;

/// Largest amplitude in counts: its 16 bits have 8 fraction bits.
const MOST_COUNTS: f64 = 255.99;

pub(super) fn move_axes<'m>(
    machine: &'m Machine,
    (distance, speed): (&PerAxis, Option<&PerAxis>),
    [clears_faults, holds]: [bool; 2],
    open: impl FnOnce() -> Result<Port<'m>, Failure>,
) -> Result<(), Failure> {
    distance.only_for(machine, "move")?;
    if let Some(speed) = speed {
        speed.only_for(machine, "--speed")?;
    }
    let moves = machine.axes.iter().enumerate().filter_map(|(axis, section)| {
        Some(HostMove {
            axis,
            distance: distance.of(section)?,
            speed: speed.and_then(|speed| speed.of(section)),
        })
    });
    let moves: Vec<HostMove> = moves.collect();
    let nothing = moves.iter().find(|of| !of.distance.is_finite() || of.distance == 0.0);
    if let Some(nothing) = nothing {
        return Err(Failure::input(format!(
            "move: {} for axis {} is not a distance",
            nothing.distance, machine.axes[nothing.axis].name
        ))
        .with_help("give a distance other than 0, or leave the axis out"));
    }
    let axes: Vec<usize> = moves.iter().map(|of| of.axis).collect();
    let mut stage = open()?;
    let corrected = while_on(&mut stage, &axes, [clears_faults, holds], |stage| {
        stage.move_axes(&moves)?;
        correct(stage, &axes)
    })?;
    output::print(&corrected)?;
    super::text::status(&mut stage, false)
}

/// Switches axes on, does something, and switches them off; with `holds` they stay on where all went well.
fn while_on<'m, T>(
    stage: &mut Port<'m>,
    axes: &[usize],
    [clears_faults, holds]: [bool; 2],
    act: impl FnOnce(&mut Port<'m>) -> Result<T, HostError>,
) -> Result<T, Failure> {
    stage.switch_on(axes, clears_faults).map_err(failure)?;
    let done = act(stage);
    // In any case, the axes end as the user wants them: off. A fault has already switched them off.
    let off = if holds && done.is_ok() {
        Ok(())
    } else {
        stage.switch_off(axes)
    };
    done.and_then(|done| off.map(|()| done)).map_err(failure)
}

/// Gives the missing steps of these axes, and reports them.
fn correct(stage: &mut Port<'_>, axes: &[usize]) -> Result<String, HostError> {
    let mut text = String::new();
    for axis in axes {
        let corrected = stage.correct(*axis)?;
        if corrected.steps != 0 {
            let name = &stage.machine().axes[*axis].name;
            let _ = writeln!(
                text,
                "axis {name}: {} missing steps given, {} off now",
                corrected.steps, corrected.left
            );
        }
    }
    Ok(text)
}

pub(super) fn home<'m>(
    machine: &'m Machine,
    (axis, path): (&str, &Path),
    [clears_faults, holds]: [bool; 2],
    open: impl FnOnce() -> Result<Port<'m>, Failure>,
) -> Result<(), Failure> {
    let index = axis_of(machine, axis, path)?;
    if machine.axes[index].absolute_encoder().is_some() {
        return Err(
            Failure::input(format!("{}: axis {axis} has an absolute encoder", path.display())).with_help(
                "it needs no homing: `status` shows its position; correct its zero by `offset` of [axis.encoder]",
            ),
        );
    }
    if machine.axes[index].probe.is_none() {
        return Err(Failure::input(format!("{}: axis {axis} has no probe", path.display()))
            .with_help("add [axis.probe] to the axis, and generate and build the stage anew"));
    }
    let mut stage = open()?;
    while_on(&mut stage, &[index], [clears_faults, holds], |stage| stage.home(index))?;
    super::text::status(&mut stage, false)
}

pub(super) fn probe<'m>(
    machine: &'m Machine,
    (axis, path): (&str, &Path),
    (distance, speed): (f64, f64),
    [clears_faults, holds]: [bool; 2],
    open: impl FnOnce() -> Result<Port<'m>, Failure>,
) -> Result<(), Failure> {
    let index = axis_of(machine, axis, path)?;
    if machine.capture.is_none() {
        return Err(
            Failure::input(format!("{}: the stage has no position capture", path.display()))
                .with_help("add [capture] to the machine file, and generate and build the stage anew"),
        );
    }
    if !distance.is_finite() || distance == 0.0 {
        return Err(Failure::input(format!("probe: {distance} is not a distance")).with_help("give one other than 0"));
    }
    let mut stage = open()?;
    let way = HostMove {
        axis: index,
        distance,
        speed: Some(speed),
    };
    let probed = while_on(&mut stage, &[index], [clears_faults, holds], |stage| stage.probe(way))?;
    let in_unit = |axis: usize, counts: i32| {
        let section = &machine.axes[axis];
        let length = f64::from(counts) / section.counts_per_unit;
        format!("{} {}", section.name, section.unit.show(length, 6))
    };
    let edge = if probed.found.rising { "rising" } else { "falling" };
    let positions = probed.found.positions.iter().enumerate();
    let positions: Vec<String> = positions.map(|(axis, counts)| in_unit(axis, *counts)).collect();
    let overrun = in_unit(index, probed.overrun);
    output::print(&format!(
        "{edge} edge at {}, clock {}; went on by {overrun}\n",
        positions.join(", "),
        probed.found.stamp
    ))
}

pub(super) fn compare<'m>(
    machine: &'m Machine,
    (axis, path): (&str, &Path),
    (switch, at): (CompareSwitch, &[f64]),
    open: impl FnOnce() -> Result<Port<'m>, Failure>,
) -> Result<(), Failure> {
    let index = axis_of(machine, axis, path)?;
    if machine.axes[index].compare.is_none() {
        return Err(
            Failure::input(format!("{}: axis {axis} has no position compare", path.display()))
                .with_help("add [axis.compare] to the axis, and generate and build the stage anew"),
        );
    }
    if switch != CompareSwitch::On && !at.is_empty() {
        return Err(Failure::input("--at: only `on` takes positions".to_owned()).with_help("leave --at out"));
    }
    let mut stage = open()?;
    let state = match switch {
        CompareSwitch::On => stage.arm_compare(index, (!at.is_empty()).then_some(at)),
        CompareSwitch::Off => stage.disarm_compare(index),
        CompareSwitch::Show => stage.compare_state(index),
    };
    let state = state.map_err(failure)?;
    let mut text = format!(
        "axis {axis}: {}, {}",
        match (state.armed, state.ready) {
            (false, _) => "disarmed",
            (true, false) => "looks for its place",
            (true, true) => "armed",
        },
        counted(state.passes.into(), "pulse")
    );
    if state.merged {
        text.push_str("; pulses merged: pulse_s is longer than the time between two positions");
    }
    if state.jumped {
        text.push_str("; the count jumped, and positions between were not passed");
    }
    text.push('\n');
    output::print(&text)
}

/// Refuses a file name for the trace if the file cannot be written.
pub(super) fn check_output(args: &TraceArgs) -> Result<(), Failure> {
    is_vcd(&args.output)?;
    outputs(args).map(drop)
}

fn outputs(args: &TraceArgs) -> Result<OutputFiles, Failure> {
    let mut outputs = OutputFiles::new(args.force);
    outputs.input("--machine", &args.line.machine);
    outputs.claim("-o", &args.output).map_err(Failure::because)?;
    Ok(outputs)
}

fn is_vcd(path: &Path) -> Result<bool, Failure> {
    match path.extension().and_then(|end| end.to_str()) {
        Some("csv") => Ok(false),
        Some("vcd") => Ok(true),
        _ => Err(
            Failure::input(format!("-o {}: a trace is written as CSV or VCD", path.display()))
                .with_help("give it a name that ends in .csv or .vcd"),
        ),
    }
}

pub(super) fn trace<'m>(
    machine: &'m Machine,
    args: &TraceArgs,
    open: impl FnOnce() -> Result<Port<'m>, Failure>,
) -> Result<(), Failure> {
    let path = args.line.machine.as_path();
    let axis = traced(machine, args)?;
    let section = &machine.axes[axis];
    let on_scale = section.scale.is_some();
    let names: &[&str] = match (args.shake, on_scale) {
        (None, _) => &["command_position", "shaped_position", "captured_position", "error"],
        (Some(_), true) => &["captured_position", "deviation"],
        (Some(_), false) => &["command", "captured_position"],
    };
    let shake = args
        .shake
        .map(|counts| shake(machine, axis, (counts, args.bit), path))
        .transpose()?;
    let request = TraceRequest {
        axis,
        signals: signals(args, names),
        every_ticks: args.every.unwrap_or(if shake.is_some() && on_scale { 2 } else { 1 }),
        shake,
    };
    let mut stage = open()?;
    let trace = match request.shake {
        None => stage.trace(&request).map_err(failure)?,
        Some(_) => while_on(&mut stage, &[axis], [args.faults.clear_faults, false], |stage| {
            stage.trace(&request)
        })?,
    };
    write(args, &trace)
}

/// The axis of a trace, if it has a memory.
fn traced(machine: &Machine, args: &TraceArgs) -> Result<usize, Failure> {
    let path = args.line.machine.as_path();
    let axis = axis_of(machine, &args.axis, path)?;
    if machine.axes[axis].trace.is_none() {
        return Err(
            Failure::input(format!("{}: axis {} has no trace memory", path.display(), args.axis))
                .with_help("add [axis.trace] to the axis, and generate and build the hardware anew"),
        );
    }
    Ok(axis)
}

/// The signals that the user named; without any, these.
fn signals(args: &TraceArgs, usual: &[&str]) -> Vec<String> {
    match args.signals.as_slice() {
        [] => usual.iter().map(|name| (*name).to_owned()).collect(),
        named => named.to_vec(),
    }
}

/// Records positions of an axis of an inline shaper.
pub(super) fn trace_inline<'m>(
    machine: &'m Machine,
    args: &TraceArgs,
    open: impl FnOnce() -> Result<InlinePort<'m>, Failure>,
) -> Result<(), Failure> {
    let path = args.line.machine.as_path();
    let axis = traced(machine, args)?;
    if args.shake.is_some() {
        return Err(Failure::input(format!(
            "{}: --shake: an inline shaper makes no test signal",
            path.display()
        ))
        .with_help("leave out --shake, and let the controller move the axis while it is recorded"));
    }
    let request = TraceRequest {
        axis,
        signals: signals(args, &["input_position", "output_position"]),
        every_ticks: args.every.unwrap_or(1),
        shake: None,
    };
    let trace = open()?.trace(&request).map_err(failure)?;
    write(args, &trace)
}

/// Returns the test signal, if the machine file allows it.
fn shake(machine: &Machine, axis: usize, (counts, bit_s): (f64, f64), path: &Path) -> Result<Shake, Failure> {
    let section = &machine.axes[axis];
    let limit = section
        .limits
        .and_then(|limits| limits.excitation)
        .map(|limit| limit * section.loop_counts_per_unit());
    let most = limit.unwrap_or(4.0).min(MOST_COUNTS);
    // The hardware would clamp it without a message.
    if !(counts > 0.0 && counts <= most * (1.0 + 1e-9)) {
        return Err(machine::at_key(
            path,
            axis,
            "axis.limits.excitation",
            format_args!("--shake: found {counts}; allowed: above 0, at most {most:.2} counts (4 without this key)"),
        ));
    }
    let ticks = bit_s * machine.clock.sample_hz;
    if !(0.5..=65_535.0).contains(&ticks) {
        return Err(Failure::input(format!(
            "--bit: found {bit_s} s; allowed: {} s to {} s",
            1.0 / machine.clock.sample_hz,
            65_535.0 / machine.clock.sample_hz
        ))
        .with_help("a fifth of the mode's period is a good choice"));
    }
    Ok(Shake {
        amplitude_counts: counts,
        bit_ticks: ticks.round() as u32,
    })
}

fn write(args: &TraceArgs, trace: &RecordedTrace) -> Result<(), Failure> {
    let outputs = outputs(args)?;
    let text = if is_vcd(&args.output)? {
        let mut bytes = Vec::new();
        trace.vcd(&mut bytes).map_err(Failure::because)?;
        String::from_utf8_lossy(&bytes).into_owned()
    } else {
        trace.csv()
    };
    write_text(&args.output, text.as_str())?;
    let names: Vec<&str> = trace.signals.iter().map(|signal| signal.name.as_str()).collect();
    let next = if args.shake.is_some() && !is_vcd(&args.output)? {
        format!("next: posicast identify {}\n", shell_word(&args.output))
    } else {
        String::new()
    };
    output::print_beside(
        &outputs,
        &format!(
            "axis {}: {} rows of {}, {} s apart, in {}\n{next}",
            trace.axis,
            trace.rows(),
            names.join(", "),
            trace.row_s,
            args.output.display()
        ),
    )
}

/// Loads the table of an axis of the file `from`; `load` opens the hardware and loads it, and returns the bank.
pub(super) fn load(
    machine: &Machine,
    axis: &str,
    from: &Path,
    load: impl FnOnce(usize, &TapTable) -> Result<Result<u32, HostError>, Failure>,
) -> Result<(), Failure> {
    let index = axis_of(machine, axis, from)?;
    let other = machine::read(from)?.machine;
    let of_other = axis_of(&other, axis, from)?;
    if other.clock.sample_hz != machine.clock.sample_hz {
        return Err(machine::at_key(
            from,
            0,
            "clock.sample_hz",
            format_args!(
                "{} Hz here, but {} Hz in the hardware: a table fits one sample rate only",
                other.clock.sample_hz, machine.clock.sample_hz
            ),
        ));
    }
    let report = DesignReport::new(&other, from)?;
    let table = &report.design.axes[of_other].table;
    // An inline shaper refuses shapers for which the lines of its drives are too slow.
    report
        .hardware
        .inline()
        .map_err(|error| machine::of_hardware(&error, from))?;
    let bank = load(index, table)?.map_err(|error| match error {
        HostError::Table { .. } => Failure::because(error).in_file(from),
        error => failure(error),
    })?;
    output::print(&format!(
        "axis {axis}: {} taps of {}, read back and in use, in bank {bank} until the next reset; the longest delay is {} samples\n",
        table.taps().len(),
        from.display(),
        table.longest_delay_samples()
    ))
}
