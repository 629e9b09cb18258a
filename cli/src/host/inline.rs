//! The actions of `posicast host` on an inline shaper, and its state for people and for programs.

use super::{Action, AnyLine, Switch, actions, axis_of, failure, text};
use crate::output;
use crate::table::Table;
use posicast_flow::Failure;
use posicast_host::{HostedInline, InlineAxisStatus, InlineStatus};
use posicast_machine::machine_file::Machine;
use posicast_taps::TapTable;
use schemars::JsonSchema;
use serde::Serialize;

/// An inline shaper behind a port.
pub(super) type InlinePort<'m> = HostedInline<'m, Box<dyn AnyLine>>;

/// `host status --json` of an inline shaper: counts in steps, modulo 2^32, all of one clock.
#[derive(Serialize, JsonSchema)]
pub(crate) struct Document {
    machine: String,
    /// Whether the axes may follow their inputs.
    run: bool,
    settled: bool,
    bypassed: bool,
    /// Whether the register asks for no shaping.
    bypass_requested: bool,
    fault: bool,
    axes: Vec<Axis>,
}

#[derive(Serialize, JsonSchema)]
struct Axis {
    name: String,
    follows: bool,
    settled: bool,
    causes: Vec<String>,
    input_steps: i32,
    given_steps: i32,
    owed_steps: i32,
    illegal_count: u32,
    table_bank: u32,
}

/// Carries out an action. What an inline shaper does not have is refused before the port is opened.
pub(super) fn run<'m>(
    action: &Action,
    machine: &'m Machine,
    open: impl FnOnce() -> Result<InlinePort<'m>, Failure>,
) -> Result<(), Failure> {
    match action {
        Action::Status { json, .. } => {
            let status = open()?.status().map_err(failure)?;
            if *json {
                output::print_json(&document(machine, &status))
            } else {
                output::print(&shown(machine, &status))
            }
        }
        Action::Bypass { switch, .. } => {
            let on = *switch == Switch::On;
            open()?.bypass(on).map_err(failure)?;
            let now = if on { "no axis is shaped" } else { "all axes are shaped" };
            output::print(&format!("{}: {now}\n", machine.name))
        }
        Action::Load { axis, from, .. } => {
            let load = |index, table: &TapTable| Ok(open()?.load_table(index, table));
            actions::load(machine, axis, from, load)
        }
        Action::Table { axis, bank, line } => {
            let index = axis_of(machine, axis, &line.machine)?;
            let mut inline = open()?;
            let active = inline.status().map_err(failure)?.axes[index].table_bank;
            let bank = bank.unwrap_or(active);
            let taps = inline.read_table(index, bank).map_err(failure)?;
            text::table(axis, (bank, active), &taps)
        }
        Action::Move { line, .. } => Err(lacks("move", "its controller moves the axes", line)),
        Action::Probe { line, .. } => Err(lacks("probe", "its controller probes", line)),
        Action::Compare { line, .. } => Err(lacks("compare", "it has no position compare", line)),
        Action::Home { line, .. } => Err(lacks("home", "its controller homes the axes", line)),
        Action::Trace(trace) => actions::trace_inline(machine, trace, open),
    }
}

fn lacks(action: &str, why: &str, line: &super::Line) -> Failure {
    Failure::input(format!(
        "{}: an inline shaper has no `{action}`: {why}",
        line.machine.display()
    ))
    .with_help("use status, bypass, trace, load or table")
}

fn document(machine: &Machine, status: &InlineStatus) -> Document {
    let axis = |axis: &InlineAxisStatus| Axis {
        name: axis.axis.clone(),
        follows: axis.follows,
        settled: axis.settled,
        causes: axis.causes.clone(),
        input_steps: axis.input_steps,
        given_steps: axis.given_steps,
        owed_steps: axis.owed_steps,
        illegal_count: axis.illegal_count,
        table_bank: axis.table_bank,
    };
    Document {
        machine: machine.name.clone(),
        run: status.run,
        settled: status.settled,
        bypassed: status.bypassed,
        bypass_requested: status.bypass_requested,
        fault: status.fault,
        axes: status.axes.iter().map(axis).collect(),
    }
}

fn shown(machine: &Machine, status: &InlineStatus) -> String {
    let state = match (status.fault, status.run) {
        (true, _) if status.axes.iter().all(|axis| axis.causes.is_empty()) => "stopped by the emergency stop",
        (true, _) => "stopped with a cause",
        (false, true) => "enabled",
        (false, false) => "not enabled",
    };
    let shaping = match (status.bypassed, status.bypass_requested) {
        (true, _) => "no axis is shaped",
        (false, true) => "shaped; no shaping is requested, and begins once all axes are settled",
        (false, false) => "shaped",
    };
    let rest = if status.settled { "settled" } else { "not settled" };
    let mut table = Table::new(&[
        "axis",
        "follows",
        "causes",
        ">steps in",
        ">steps out",
        ">owed",
        "settled",
        "table",
    ]);
    let yes = |is| if is { "yes" } else { "no" }.to_owned();
    for axis in &status.axes {
        let causes = axis.causes.join(", ");
        table.row([
            axis.axis.clone(),
            yes(axis.follows),
            if causes.is_empty() { "none".to_owned() } else { causes },
            axis.input_steps.to_string(),
            axis.given_steps.to_string(),
            axis.owed_steps.to_string(),
            yes(axis.settled),
            match axis.table_bank {
                0 => "the machine's".to_owned(),
                bank => format!("bank {bank}"),
            },
        ]);
    }
    format!("{}: {state}; {shaping}; {rest}\n{}", machine.name, table.text("  "))
}
