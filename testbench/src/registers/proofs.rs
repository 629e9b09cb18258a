//! The proofs of register banks: one with fields of every kind, and the commit of staged registers.

use posicast_blocks::component::Component;
use posicast_blocks::registers::{Access, Register, RegisterMap};
use posicast_hdl::registers;

use super::pwm_component;
use crate::Error;
use crate::formal::{Engine, Task, refused};
use crate::sliding_mode::proofs::controller;
use crate::stage::example;

/// Returns all of these proofs.
pub(crate) fn tasks() -> Result<Vec<Task>, Error> {
    let stage = Component::stage(&example("")?).map_err(refused)?;
    Ok(vec![
        bank()?,
        commit("bank of sliding_mode", controller()?.map())?,
        commit("bank of a stage of two axes", stage.map())?,
    ])
}

fn bank() -> Result<Task, Error> {
    let component = pwm_component()?;
    let map = component.map();
    let block = (vec![registers::emit(map, "")?], map.ports().to_vec());
    Ok(Task::new("registers", "bank of pwm", Engine::Pdr, block).properties(&[], include_str!("registers.sv")))
}

/// Returns the staged registers of the map, the first in the lowest bits.
fn commit(size: &str, map: &RegisterMap) -> Result<Task, Error> {
    let staged: Vec<&Register> = map
        .registers()
        .iter()
        .filter(|register| register.access == Access::Staged)
        .collect();
    let written = map.registers().iter().find_map(|register| match &register.access {
        Access::Commit { tick } => Some((register.offset, tick.clone())),
        _ => None,
    });
    let (offset, tick) = written.ok_or_else(|| refused(format!("`{}` has no commit", map.name())))?;
    let list = |text: &dyn Fn(&Register) -> String| {
        let rows: Vec<String> = staged.iter().rev().map(|register| text(register)).collect();
        format!("{{{}}}", rows.join(", "))
    };
    let address = |offset: u32| format!("{}'d{offset}", map.address_bits());
    let macros = [
        ("ADDRESS_BITS", map.address_bits().to_string()),
        ("REGISTERS", staged.len().to_string()),
        ("COMMIT", address(offset)),
        ("TICK", tick),
        ("ADDRESSES", list(&|register| address(register.offset))),
        ("BITS", list(&|register| format!("32'd{}", register.mask()))),
        ("RESET", list(&|register| format!("32'd{}", register.reset()))),
        ("IN_FORCE", list(&in_word)),
    ];
    let block = (vec![registers::emit(map, "")?], map.ports().to_vec());
    Ok(Task::new("commit", size, Engine::Pdr, block).properties(&macros, include_str!("commit.sv")))
}

/// Returns a register's word made of the ports of its fields, with 0 between them.
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
