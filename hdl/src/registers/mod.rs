//! Register banks in hardware: writes an Avalon-MM agent from its register map.
//!
//! The datasheet is `docs/registers.md`, the reference `posicast_blocks::registers`.
//!
//! A bank is not a RustHDL kernel: the kernel would contain only names, offsets and bits, which are in the map
//! already, and RustHDL's struct of ports would have to be written again for every component. So the Verilog is
//! written from the map, and lock step compares it with the model's interpreter of the same map.

mod blocks;
mod text;
mod verilog;

use crate::emit::{EmitError, Header, Module, Parameter, check_name, digest, own_name, print};
use posicast_blocks::registers::{Access, Field, Register, RegisterMap};

/// Verilog of the bank; [`name`] gives its name.
///
/// # Errors
/// [`EmitError`] where `prefix` or a port is not a valid Verilog name.
pub fn emit(map: &RegisterMap, prefix: &str) -> Result<Module, EmitError> {
    let body = verilog::body(map);
    let name = name(map, prefix);
    check_name(&name).map_err(|cause| EmitError::new(&name, "", cause))?;
    for port in map.ports() {
        check_name(&port.name).map_err(|cause| EmitError::new(&name, &port.name, cause))?;
    }
    let header = Header {
        about: format!(
            "Registers of {}: Avalon-MM agent, 32 bits, word addresses, read latency 1, no waits.\n\
             Commands take whole words only. Reads have no side effect; addresses without a register read as 0.\n\
             Digest of the map: {:08x}.",
            map.name(),
            digest(&body)
        ),
        ports: Vec::new(),
        parameters: parameters(map),
    };
    Ok(Module {
        text: print::file(&name, &print::data_header(&name, &header, "register map"), &body),
        name,
        ports: map.ports().to_vec(),
        clocked: true,
        notes: verilog::notes(map),
    })
}

/// Name of the bank's module: `PREFIX_MAP_registers`, or `registers` where `prefix` is empty. A bank contains offsets,
/// reset values and build parameters, so it belongs to one machine or one axis.
pub fn name(map: &RegisterMap, prefix: &str) -> String {
    match prefix {
        "" => "registers".to_owned(),
        _ => own_name(prefix, &format!("{}_registers", map.name())),
    }
}

/// The build parameters, for the header of a file.
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
