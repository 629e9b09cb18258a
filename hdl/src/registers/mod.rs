//! Register banks in hardware: an Avalon-MM agent written from its register map.
//!
//! The datasheet is `docs/registers.md`, the reference `posicast_model::rtl::registers`.
//!
//! A bank is not a RustHDL kernel: what a kernel could say of it are names, offsets and bits, which stand in the map
//! already, and RustHDL's struct of ports would have to be written once more for every component. So the Verilog is
//! written from the map, and the interpreter of the same map in the model holds it in lock step.

mod blocks;
mod text;
mod verilog;

use crate::emit::names::check_name;
use crate::emit::{EmitError, Header, Module, Parameter, digest, print, shared_name};
use posicast_model::rtl::registers::{Access, Field, Register, RegisterMap};

/// The bank's Verilog, called as [`name`] says.
///
/// # Errors
/// [`EmitError`] where `prefix` or a port makes no Verilog name.
pub fn emit(map: &RegisterMap, prefix: &str) -> Result<Module, EmitError> {
    let body = verilog::body(map);
    let name = name_of(map, &body, prefix);
    check_name(&name).map_err(|cause| EmitError::new(&name, "", cause))?;
    for port in map.ports() {
        check_name(&port.name).map_err(|cause| EmitError::new(&name, &port.name, cause))?;
    }
    let header = Header {
        about: format!(
            "Registers of {}: Avalon-MM agent, 32 bits, word addresses, read latency 1, no waits.\n\
             Commands take whole words only. Reads have no side effect; what is not mapped reads as 0.",
            map.name()
        ),
        ports: Vec::new(),
        parameters: parameters(map),
    };
    Ok(Module {
        text: print::file(&name, &print::data_header(&name, &header, "register map"), &body),
        name,
        ports: map.ports().to_vec(),
        clocked: true,
    })
}

/// The name of the bank's module: `posicast_MAP_registers_DIGEST`, or `registers` where `prefix` is empty.
///
/// A bank holds offsets, reset values and parameters of its build, far too many for a name. Their digest stands for them, so
/// that two banks of one name are the same.
pub fn name(map: &RegisterMap, prefix: &str) -> String {
    name_of(map, &verilog::body(map), prefix)
}

fn name_of(map: &RegisterMap, body: &str, prefix: &str) -> String {
    match prefix {
        "" => "registers".to_owned(),
        // What the header says of the build stands in the body too, but for the meaning of a parameter.
        _ => shared_name(prefix, &format!("{}_registers_{:08x}", map.name(), digest(body))),
    }
}

/// The build's parameters, as a file's header tells them.
pub(crate) fn parameters(map: &RegisterMap) -> Vec<Parameter> {
    let is_parameter = |register: &&Register| register.access == Access::Constant && register.offset > 1;
    let fields = map
        .registers()
        .iter()
        .filter(is_parameter)
        .flat_map(|register| &register.fields);
    let row = |field: &Field| Parameter {
        name: field.name.clone(),
        value: field.reset.to_string(),
        meaning: field.meaning.clone(),
    };
    fields.map(row).collect()
}
