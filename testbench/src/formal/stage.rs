//! Proofs of supervisor, drive command and PWM as a stage wires them.

use posicast_hdl::component;
use posicast_hdl::emit::Module;
use posicast_model::rtl::component::Component;
use posicast_model::rtl::stage::StageAxis;

use super::task::{INDUCTION, Task, refused};
use crate::Error;
use crate::blocks::library_stage;

/// Blocks of an axis that only determine where it should be and where it is. They are left out, so that their outputs
/// are free.
const LEFT_OUT: [&str; 8] = [
    "segments",
    "motion_shaper",
    "sliding_mode",
    "pulse_counter",
    "linear_scale",
    "encoder_generator",
    "excitation",
    "trace",
];

/// Tasks for the axes of the stage that the other rungs of verification use: one with the blocks for bring-up, one
/// with a linear scale.
pub(super) fn tasks(macros: &[(&str, String)]) -> Result<Vec<Task>, Error> {
    let stage = library_stage()?;
    let component = Component::stage(&stage).map_err(refused)?;
    let mut modules = component::emit(&component, "stage", "stage")?;
    for block in LEFT_OUT {
        let of_block = modules.iter_mut().filter(|module| module.is(block));
        if of_block.map(empty).count() == 0 {
            return Err(refused(format!("the stage has no block `{block}`")));
        }
    }
    stage.axes.iter().map(|axis| task(axis, &modules, macros)).collect()
}

/// A task for an axis; `modules` are those of the stage, sub-modules first.
fn task(axis: &StageAxis, modules: &[Module], macros: &[(&str, String)]) -> Result<Task, Error> {
    let name = format!("stage_{}", axis.name);
    let at = modules.iter().position(|module| module.name == name);
    let at = at.ok_or_else(|| refused(format!("the stage has no `{name}`")))?;
    let filter_clocks = axis.supervision.filter_clocks;
    let mut macros = macros.to_vec();
    macros.push(("FILTER_CLOCKS", format!("7'd{filter_clocks}")));
    let size = format!("axis {}, lines filtered for {filter_clocks} clocks", axis.name);
    let block = (modules[..=at].to_vec(), modules[at].ports.clone());
    Ok(
        Task::new("stage_axis", &size, INDUCTION, block)
            .properties(&macros, include_str!("../../formal/stage_axis.sv")),
    )
}

/// Removes everything but the ports of a module: its outputs are free in every clock. Without a wire Yosys would take
/// it for an external module.
pub(super) fn empty(module: &mut Module) {
    if let Some((ports, _)) = module.text.split_once("\n);\n") {
        module.text = format!("{ports}\n);\n    wire left_out = clk;\nendmodule\n\n`default_nettype wire\n");
    }
}
