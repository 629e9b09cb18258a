//! The state of a stage, for people and for programs.

use super::{Port, failure};
use crate::output;
use crate::table::Table;
use posicast_blocks::axis::SupervisorState;
use posicast_flow::Failure;
use posicast_flow::text::UnitDocument;
use posicast_host::{AxisStatus, causes};
use posicast_machine::machine_file::{AxisSection, Machine};
use posicast_taps::Tap;
use schemars::JsonSchema;
use serde::Serialize;

/// `host status --json`: positions in m or rad.
#[derive(Serialize, JsonSchema)]
pub(crate) struct Document {
    machine: String,
    axes: Vec<Axis>,
}

#[derive(Serialize, JsonSchema)]
struct Axis {
    name: String,
    #[serde(flatten)]
    unit: UnitDocument,
    state: &'static str,
    causes: Vec<&'static str>,
    position: f64,
    velocity: f64,
    command: f64,
    shaped: f64,
    error: f64,
    homed: bool,
    waiting_entries: u32,
    table_bank: u32,
}

/// Reads and prints the state of all axes.
pub(super) fn status(stage: &mut Port<'_>, json: bool) -> Result<(), Failure> {
    let all = stage.status().map_err(failure)?;
    let machine = stage.machine();
    if json {
        output::print_json(&document(machine, &all))
    } else {
        output::print(&text(machine, &all))
    }
}

/// Prints the taps of a bank of an axis; `active` is the bank in use.
pub(super) fn table(axis: &str, (bank, active): (u32, u32), taps: &[Tap]) -> Result<(), Failure> {
    let whose = if bank == 0 { "the machine's" } else { "loaded" };
    let used = if bank == active { "in use" } else { "not in use" };
    let mut text = format!("axis {axis}: bank {bank}, {whose}, {used}: {} taps\n", taps.len());
    let mut rows = Table::new(&[">delay in samples", ">coefficient"]);
    for tap in taps {
        rows.row([tap.delay_samples.to_string(), tap.coefficient.to_string()]);
    }
    text += &rows.text("  ");
    output::print(&text)
}

fn state(status: &AxisStatus) -> &'static str {
    status.state.map_or("UNKNOWN", SupervisorState::name)
}

fn document(machine: &Machine, all: &[AxisStatus]) -> Document {
    let axis = |(status, axis): (&AxisStatus, &AxisSection)| {
        let si = |counts: f64| counts / axis.loop_counts_per_unit();
        Axis {
            name: axis.name.clone(),
            unit: UnitDocument::new(axis.unit),
            state: state(status),
            causes: causes(status.causes),
            position: si(status.position),
            velocity: si(status.velocity) * machine.clock.sample_hz,
            command: si(status.command),
            shaped: si(status.shaped),
            error: si(status.error),
            homed: status.homed,
            waiting_entries: status.waiting,
            table_bank: status.table_bank,
        }
    };
    Document {
        machine: machine.name.clone(),
        axes: all.iter().zip(&machine.axes).map(axis).collect(),
    }
}

fn text(machine: &Machine, all: &[AxisStatus]) -> String {
    let mut table = Table::new(&[
        "axis",
        "state",
        "causes",
        ">position",
        ">command",
        ">error",
        "homed",
        "table",
    ]);
    for (status, axis) in all.iter().zip(&machine.axes) {
        let show = |counts: f64| axis.unit.as_in_file(counts / axis.loop_counts_per_unit(), "");
        let causes = causes(status.causes).join(", ");
        table.row([
            axis.name.clone(),
            state(status).to_owned(),
            if causes.is_empty() { "none".to_owned() } else { causes },
            show(status.position),
            show(status.command),
            show(status.error),
            if status.homed { "yes" } else { "no" }.to_owned(),
            match status.table_bank {
                0 => "the machine's".to_owned(),
                bank => format!("bank {bank}"),
            },
        ]);
    }
    format!("{}\n{}", machine.name, table.text("  "))
}
