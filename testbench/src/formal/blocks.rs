//! Proofs of single blocks whose tasks depend on their configuration.

use posicast_hdl::{
    cascade, component, divider, encoder_generator, excitation, linear_scale, registers, setting_banks,
};
use posicast_model::design::design_machine;
use posicast_model::hardware;
use posicast_model::machine_file;
use posicast_model::rtl::cascade::{self as cascade_model, CascadeConfig};
use posicast_model::rtl::component::Component;
use posicast_model::rtl::divider::{self as divider_model, DividerConfig};
use posicast_model::rtl::encoder_generator as generator_model;
use posicast_model::rtl::registers::{Access, Register, RegisterMap};
use posicast_model::rtl::setting_banks as banks_model;
use posicast_model::rtl::sliding_mode::{Law, Settings};
use posicast_model::rtl::{excitation as excitation_model, linear_scale as scale_model};

use super::stage::empty;
use super::task::{Engine, INDUCTION, Task, part, refused};
use crate::Error;

/// Machine file of the example, with two axes.
const STAGE: &str = include_str!("../../machines/xy-stage.toml");

/// All tasks of this file.
pub(super) fn tasks() -> Result<Vec<Task>, Error> {
    let (settings, stage) = stage()?;
    let controller = Component::sliding_mode(&settings, Law::Pd, false).map_err(refused)?;
    let mut tasks = vec![
        commit_task("bank of sliding_mode", controller.map())?,
        commit_task("bank of a stage of two axes", stage.map())?,
        setting_banks_task(&settings)?,
        law_and_bank_task(&controller)?,
        divider_task(5000)?,
        divider_task(131_071)?,
        encoder_generator_task()?,
        cascade_task(16, vec![3, 5, 7])?,
        cascade_task(32, vec![60; 8])?,
        excitation_task()?,
        linear_scale_task()?,
    ];
    for shift in [1, 0, 16, 31] {
        tasks.push(serial_ratio_task(shift)?);
    }
    Ok(tasks)
}

/// The example's stage, and the settings of its first controller.
fn stage() -> Result<(Settings, Component), Error> {
    let machine = machine_file::parse("xy-stage.toml", STAGE).map_err(refused)?;
    let designs = design_machine(&machine).map_err(refused)?;
    let stage = hardware::stage(&machine, &designs).map_err(refused)?;
    let config = stage.ok_or_else(|| refused("the example has no stage"))?.config;
    let axis = config.axes.first().ok_or_else(|| refused("the example has no axis"))?;
    Ok((axis.settings, Component::stage(&config).map_err(refused)?))
}

/// A task with the staged registers of the map, the first in the lowest bits.
fn commit_task(size: &str, map: &RegisterMap) -> Result<Task, Error> {
    let staged: Vec<&Register> = map
        .registers()
        .iter()
        .filter(|register| register.access == Access::Staged)
        .collect();
    let commit = map.registers().iter().find_map(|register| match &register.access {
        Access::Commit { tick } => Some((register.offset, tick.clone())),
        _ => None,
    });
    let (offset, tick) = commit.ok_or_else(|| refused(format!("`{}` has no commit", map.name())))?;
    let list = |text: &dyn Fn(&Register) -> String| {
        let rows: Vec<String> = staged.iter().rev().map(|register| text(register)).collect();
        format!("{{{}}}", rows.join(", "))
    };
    let fields: Vec<String> = staged
        .iter()
        .flat_map(|register| &register.fields)
        .map(|field| format!("input wire [{}:0] {}", field.width - 1, field.name))
        .collect();
    let address = |offset: u32| format!("{}'d{offset}", map.address_bits());
    let macros = [
        ("ADDRESS_BITS", map.address_bits().to_string()),
        ("REGISTERS", staged.len().to_string()),
        ("COMMIT", address(offset)),
        ("TICK", tick),
        ("FIELDS", fields.join(", ")),
        ("ADDRESSES", list(&|register| address(register.offset))),
        ("BITS", list(&|register| format!("32'd{}", register.mask()))),
        ("RESET", list(&|register| format!("32'd{}", register.reset()))),
        ("IN_FORCE", list(&in_word)),
    ];
    let block = (vec![registers::emit(map, "")?], map.ports().to_vec());
    Ok(Task::new("commit", size, Engine::Pdr, block).properties(&macros, include_str!("../../formal/commit.sv")))
}

/// A register's word from the ports of its fields, with 0 between them.
fn in_word(register: &Register) -> String {
    let mut fields: Vec<_> = register.fields.iter().collect();
    fields.sort_by_key(|field| field.low);
    let mut parts = Vec::new();
    let mut place = 0;
    for field in fields {
        if field.low > place {
            parts.push(format!("{}'d0", field.low - place));
        }
        parts.push(field.name.clone());
        place = field.low + field.width;
    }
    if place < 32 {
        parts.push(format!("{}'d0", 32 - place));
    }
    parts.reverse();
    parts.join(", ")
}

fn setting_banks_task(settings: &Settings) -> Result<Task, Error> {
    let block = (setting_banks::emit(settings, "")?, banks_model::ports());
    Ok(
        Task::new("setting_banks", "32 rows, contents left out", Engine::Pdr, block)
            .properties(&[], include_str!("../../formal/setting_banks.sv")),
    )
}

/// The controller's component without its arithmetic: register bank, settings and sequencer, as they are wired.
fn law_and_bank_task(controller: &Component) -> Result<Task, Error> {
    let mut modules = component::emit(controller, "alone", "")?;
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
    .properties(&[], include_str!("../../formal/law_and_bank.sv")))
}

fn divider_task(tick_clocks: u64) -> Result<Task, Error> {
    let config = DividerConfig::new(tick_clocks).map_err(refused)?;
    let macros = [
        ("TICK_CLOCKS", format!("17'd{tick_clocks}")),
        ("DIVISION_CLOCKS", format!("7'd{}", divider_model::DIVISION_CLOCKS)),
    ];
    let block = (divider::emit(&config, "")?, divider_model::ports());
    let size = format!("{tick_clocks} clocks per tick, full width");
    Ok(Task::new("divider", &size, INDUCTION, block).properties(&macros, include_str!("../../formal/divider.sv")))
}

fn encoder_generator_task() -> Result<Task, Error> {
    let block = (encoder_generator::emit("")?, generator_model::ports());
    Ok(Task::new("encoder_generator", "all rates", INDUCTION, block)
        .properties(&[], include_str!("../../formal/encoder_generator.sv")))
}

fn cascade_task(word_bits: u32, delays_samples: Vec<u32>) -> Result<Task, Error> {
    let config = CascadeConfig::new(word_bits, delays_samples).map_err(refused)?;
    let macros = [
        ("WORD", word_bits.to_string()),
        ("SUM", config.sum_bits().to_string()),
        ("INDEX", config.stage_index_bits().to_string()),
        ("ADDRESS", config.ring_address_bits().to_string()),
        ("STAGES", config.stages().to_string()),
        (
            "PASS_CLOCKS",
            format!("6'd{}", cascade_model::pass_clocks(config.stages())),
        ),
    ];
    let block = (
        cascade::emit(&config, "")?,
        cascade_model::ports(config.word_bits() as usize),
    );
    let size = format!("{word_bits} bits, {} stages, contents left out", config.stages());
    Ok(Task::new("cascade", &size, INDUCTION, block).properties(&macros, include_str!("../../formal/cascade.sv")))
}

fn excitation_task() -> Result<Task, Error> {
    let block = (excitation::emit("")?, excitation_model::ports());
    Ok(Task::new("excitation", "all signals", INDUCTION, block)
        .properties(&[], include_str!("../../formal/excitation.sv")))
}

fn linear_scale_task() -> Result<Task, Error> {
    let block = (linear_scale::emit("")?, scale_model::ports());
    Ok(Task::new("linear_scale", "all ratios", INDUCTION, block)
        .properties(&[], include_str!("../../formal/linear_scale.sv")))
}

/// The arithmetic of the linear scale, which is a part of it, by itself.
fn serial_ratio_task(shift: u32) -> Result<Task, Error> {
    let block = part(linear_scale::emit("")?, "serial_ratio")?;
    let size = format!("all mantissas, 2^-{shift}");
    Ok(Task::new("serial_ratio", &size, INDUCTION, block).properties(
        &[("SHIFT", format!("5'd{shift}"))],
        include_str!("../../formal/serial_ratio.sv"),
    ))
}
