//! The proofs of the controller: the control of a pass, lemmas of its arithmetic, and its component.

use posicast_blocks::component::Component;
use posicast_blocks::sliding_mode::{self as model, Law};
use posicast_hdl::emit::Module;
use posicast_hdl::{component, sliding_mode};

use crate::Error;
use crate::formal::{INDUCTION, Task, part, refused};
use crate::stage::example_settings;
use crate::stage::proofs::empty;

/// Returns all proofs of the block.
pub(crate) fn tasks() -> Result<Vec<Task>, Error> {
    Ok(vec![
        pass()?,
        lemma(
            "scaled_product",
            "51 bits, any product",
            include_str!("scaled_product.sv"),
        )?,
        lemma("accumulator", "52 bits", include_str!("accumulator.sv"))?,
        lemma("limiter", "32 bits", include_str!("limiter.sv"))?,
    ])
}

/// Returns the controller's Verilog with free products: they have no driver, except that one times a word is the word.
fn controller_of_any_products() -> Result<Vec<Module>, Error> {
    let mut modules = sliding_mode::emit("")?;
    for module in &mut modules {
        if module.name.starts_with("smul_") {
            let cut = (module.text)
                .replace("product <= a_q * b_q;", "product <= b_q == 18'sd1 ? a_q : anything;")
                .replace(
                    "    reg signed [17:0] b_q;",
                    "    reg signed [17:0] b_q;\n    wire signed [35:0] anything;",
                );
            if cut == module.text {
                return Err(refused(format!("`{}` has no product of its own name", module.name)));
            }
            module.text = cut;
        }
    }
    Ok(modules)
}

/// The control of a pass.
fn pass() -> Result<Task, Error> {
    let block = (controller_of_any_products()?, model::ports());
    let macros = [("PASS_CLOCKS", format!("10'd{}", model::CONTROL_CLOCKS))];
    Ok(
        Task::new("sliding_mode", "any products", INDUCTION, block)
            .properties(&macros, include_str!("sliding_mode.sv")),
    )
}

/// Creates the proof of a lemma about the arithmetic of one part of the controller.
fn lemma(name: &'static str, size: &str, properties: &str) -> Result<Task, Error> {
    let part = part(controller_of_any_products()?, name)?;
    Ok(Task::new(name, size, INDUCTION, part).properties(&[], properties))
}

/// The controller's component without arithmetic: bank, settings and the sequence of a pass, as they are wired.
pub(crate) fn law_and_bank() -> Result<Task, Error> {
    let controller = controller()?;
    let mut modules = component::emit(&controller, "alone", "")?;
    for part in [
        "tracking",
        "operands",
        "scaled_product",
        "accumulator",
        "limiter",
        "integral",
        "sticky",
    ] {
        let module = modules.iter_mut().find(|module| module.is(part));
        empty(module.ok_or_else(|| refused(format!("the controller has no `{part}`")))?);
    }
    let block = (modules, controller.composition().ports().to_vec());
    Ok(Task::new(
        "law_and_bank",
        "component of sliding_mode, arithmetic left out",
        INDUCTION,
        block,
    )
    .properties(&[], include_str!("law_and_bank.sv")))
}

/// The controller's component of the example's first axis.
pub(crate) fn controller() -> Result<Component, Error> {
    Component::sliding_mode(&example_settings()?, Law::Pd, false).map_err(refused)
}
