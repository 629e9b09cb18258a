//! Proofs of supervisor, drive command and PWM, and of supervisor and step generator, as a stage wires them.

use posicast_blocks::component::Component;
use posicast_blocks::stage::{Follower, StageAxis, StageConfig};
use posicast_hdl::component;
use posicast_hdl::emit::Module;

use crate::Error;
use crate::axis;
use crate::blocks::library::{stage, stage_with_absolute_encoders, stage_with_steps};
use crate::formal::{INDUCTION, Task, refused};
use crate::step_generator;

/// Blocks of an axis that only give commanded and actual position. They are left out, so that their outputs have any
/// value.
const LEFT_OUT: [&str; 9] = [
    "segments",
    "motion_shaper",
    "sliding_mode",
    "pulse_counter",
    "linear_scale",
    "encoder_generator",
    "error_table",
    "excitation",
    "trace",
];
/// Those of an axis with an absolute encoder.
const LEFT_OUT_BESIDE_ABSOLUTE: [&str; 6] = [
    "segments",
    "motion_shaper",
    "sliding_mode",
    "absolute_encoder_biss_c",
    "absolute_encoder_ssi",
    "absolute_feedback",
];
/// Those of an axis with steps.
const LEFT_OUT_BESIDE_STEPS: [&str; 6] = [
    "segments",
    "motion_shaper",
    "pulse_counter",
    "linear_scale",
    "excitation",
    "trace",
];

/// The axes of the stages that the other rungs of verification use. Two have controllers: one with the blocks for bring-up, one with a
/// linear scale. Three have steps, one for each mode of the lines. Two have absolute encoders.
pub(crate) fn tasks() -> Result<Vec<Task>, Error> {
    let mut tasks = of_stage(&stage()?, &LEFT_OUT)?;
    tasks.extend(of_stage(&stage_with_steps()?, &LEFT_OUT_BESIDE_STEPS)?);
    tasks.extend(of_stage(&stage_with_absolute_encoders()?, &LEFT_OUT_BESIDE_ABSOLUTE)?);
    Ok(tasks)
}

/// The axes of a stage, without these blocks.
fn of_stage(stage: &StageConfig, left_out: &[&str]) -> Result<Vec<Task>, Error> {
    let component = Component::stage(stage).map_err(refused)?;
    let mut modules = component::emit(&component, "stage", "stage")?;
    for block in left_out {
        let of_block = modules.iter_mut().filter(|module| module.is(block));
        if of_block.map(empty).count() == 0 {
            return Err(refused(format!("the stage has no block `{block}`")));
        }
    }
    stage.axes.iter().map(|axis| task(axis, &modules)).collect()
}

/// `modules` are those of the stage, sub-modules first.
fn task(axis: &StageAxis, modules: &[Module]) -> Result<Task, Error> {
    let name = format!("stage_{}", axis.name);
    let at = modules.iter().position(|module| module.name == name);
    let at = at.ok_or_else(|| refused(format!("the stage has no `{name}`")))?;
    let filter_clocks = axis.supervision.filter_clocks;
    let filter = [("FILTER_CLOCKS", format!("7'd{filter_clocks}"))];
    let encoder = if axis.absolute().is_some() {
        " with an absolute encoder"
    } else {
        ""
    };
    let size = format!("axis {}{encoder}, lines filtered for {filter_clocks} clocks", axis.name);
    let block = (modules[..=at].to_vec(), modules[at].ports.clone());
    let task = |name, size: &str| Task::new(name, size, INDUCTION, block).macros(&axis::proofs::macros());
    Ok(match &axis.follower {
        Follower::Loop(_) => task("stage_axis", &size).properties(&filter, include_str!("stage_axis.sv")),
        Follower::Steps(steps) => {
            let [a, b] = steps.mode().line_names();
            let lines = [("LINE_A", a.to_owned()), ("LINE_B", b.to_owned())];
            let size = format!("{size}, {}", steps.mode().name().replace('_', " "));
            task("stage_steps", &size)
                .macros(&step_generator::proofs::lines(steps))
                .properties(&[&filter[..], &lines].concat(), include_str!("stage_steps.sv"))
        }
    })
}

/// Removes everything but the ports of a module: its outputs are free in every clock. Without a wire Yosys would take
/// it for an external module.
pub(crate) fn empty(module: &mut Module) {
    if let Some((ports, _)) = module.text.split_once("\n);\n") {
        module.text = format!("{ports}\n);\n    wire left_out = clk;\nendmodule\n\n`default_nettype wire\n");
    }
}
