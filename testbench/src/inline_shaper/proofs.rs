//! Proofs of an axis as an inline shaper wires it, from the lines of the command to those of the drive.

use posicast_blocks::inline_shaper::InlineShaperAxis;
use posicast_blocks::step_generator::StepMode;
use posicast_hdl::emit::Module;
use posicast_hdl::inline_shaper::emit;

use super::{TOP, example, unlimited};
use crate::Error;
use crate::formal::{INDUCTION, Task, refused};
use crate::stage::proofs::empty;

/// The axes of the examples: every kind of lines on both sides. The shaper is left out, so that its output has any value.
pub(super) fn tasks() -> Result<Vec<Task>, Error> {
    let mut tasks = Vec::new();
    for shaper in [example()?, unlimited()?] {
        let mut modules = emit(&shaper, TOP, TOP)?;
        let shapers = modules.iter_mut().filter(|module| module.is("motion_shaper"));
        if shapers.map(empty).count() == 0 {
            return Err(refused("the inline shaper has no `motion_shaper`"));
        }
        for axis in &shaper.config().axes {
            tasks.push(task(axis, &modules)?);
        }
    }
    Ok(tasks)
}

/// `modules` are those of the inline shaper, sub-modules first.
fn task(axis: &InlineShaperAxis, modules: &[Module]) -> Result<Task, Error> {
    let name = format!("{TOP}_{}", axis.name);
    let at = modules.iter().position(|module| module.name == name);
    let at = at.ok_or_else(|| refused(format!("the inline shaper has no `{name}`")))?;
    let kind = |mode: StepMode| {
        let place = StepMode::ALL.iter().position(|other| *other == mode).unwrap_or(0);
        format!("2'd{place}")
    };
    let low = axis.steps.lines_active_low();
    let bit = |is: bool| format!("1'b{}", u8::from(is));
    let [line_a, line_b] = axis.steps.mode().line_names().map(str::to_owned);
    let macros = [
        ("IN_MODE", kind(axis.input)),
        ("OUT_MODE", kind(axis.steps.mode())),
        ("LINE_A", line_a),
        ("LINE_B", line_b),
        ("A_OFF", bit(low.a)),
        ("B_OFF", bit(low.b)),
    ];
    let size = format!("{} to {}", axis.input.name(), axis.steps.mode().name());
    let block = (modules[..=at].to_vec(), modules[at].ports.clone());
    Ok(Task::new("inline_shaper", &size, INDUCTION, block).properties(&macros, include_str!("inline_shaper.sv")))
}
