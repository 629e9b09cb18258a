//! Composes a structural module: instances side by side, with common inputs shared, and every other port exported
//! with its instance's name as prefix.

use super::error::{EmitCause, EmitError};
use super::names::{self, Taken};
use super::print::{self, Lines};
use super::types::Type;
use super::{Header, Module};
use posicast_blocks::{Direction, Port};

/// One instance in a composed module.
#[derive(Debug, Clone, Copy)]
pub struct ModuleInstance<'a> {
    /// Name of the instance, for example of the axis; its ports become `<name>_<port>`.
    pub name: &'a str,
    /// The module that is instantiated.
    pub module: &'a Module,
}

/// Writes the module `top` with `instances` side by side.
///
/// `clk` is connected to all instances that have it. The inputs named in `shared_inputs`, for example `rst` and
/// `strobe`, are connected to every instance that has them; every other port `p` of the instance `i` becomes the port
/// `i_p`.
///
/// # Errors
/// An error for names that are reserved, malformed or used twice, and for a shared input that no instance has, that
/// differs between instances, or that is an output of one.
pub fn compose(
    top: &str,
    header: &Header,
    shared_inputs: &[&str],
    instances: &[ModuleInstance<'_>],
) -> Result<Module, EmitError> {
    let at = |signal: &str| {
        let signal = signal.to_owned();
        move |cause| EmitError::new(top, &signal, cause)
    };
    names::check_name(top).map_err(at(""))?;
    let mut taken = Taken::default();
    // Verilator's C++ cannot handle a port with the module's own name.
    taken.take(top, "the module").map_err(at(top))?;
    let clocked = instances.iter().any(|instance| instance.module.clocked);
    if clocked {
        taken.take("clk", "the clock").map_err(at("clk"))?;
    }
    let mut ports = Vec::new();
    for &name in shared_inputs.iter().filter(|name| **name != "clk") {
        ports.push(shared_input(name, instances).map_err(at(name))?);
        taken.take(name, "a shared input").map_err(at(name))?;
    }
    for instance in instances {
        names::check_form(instance.name).map_err(at(instance.name))?;
        taken
            .take(&instance_name(instance), "an instance")
            .map_err(at(instance.name))?;
        if instance.module.name == top {
            let cause = EmitCause::NameCollision {
                name: top.to_owned(),
                other: format!("instance {}", instance.name),
            };
            return Err(at(instance.name)(cause));
        }
        for port in instance
            .module
            .ports
            .iter()
            .filter(|port| !shared_inputs.contains(&port.name.as_str()))
        {
            let name = lifted(instance, port);
            names::check_name(&name).map_err(at(&name))?;
            taken
                .take(&name, &format!("{}.{}", instance.name, port.name))
                .map_err(at(&name))?;
            ports.push(Port { name, ..port.clone() });
        }
    }
    let text = print::file(
        top,
        &print::top_header(top, &[], header),
        &body(&ports, clocked, shared_inputs, instances),
    );
    Ok(Module {
        name: top.to_owned(),
        text,
        ports,
        clocked,
        notes: Vec::new(),
    })
}

fn instance_name(instance: &ModuleInstance<'_>) -> String {
    format!("u_{}", instance.name)
}

fn lifted(instance: &ModuleInstance<'_>, port: &Port) -> String {
    format!("{}_{}", instance.name, port.name)
}

/// The input `name`, which must have the same type in all instances that have it.
fn shared_input(name: &str, instances: &[ModuleInstance<'_>]) -> Result<Port, EmitCause> {
    names::check_name(name)?;
    let mut shared: Option<&Port> = None;
    for instance in instances {
        let Some(port) = instance.module.ports.iter().find(|port| port.name == name) else {
            continue;
        };
        if port.direction == Direction::Output {
            return Err(EmitCause::SharedOutput(name.to_owned()));
        }
        match shared {
            Some(first) if Type::of(first) != Type::of(port) => {
                return Err(EmitCause::SharedType {
                    name: name.to_owned(),
                    first: Type::of(first),
                    instance: instance.name.to_owned(),
                    second: Type::of(port),
                });
            }
            _ => shared = Some(port),
        }
    }
    shared.cloned().ok_or_else(|| EmitCause::NoSuchInput(name.to_owned()))
}

fn body(ports: &[Port], clocked: bool, shared_inputs: &[&str], instances: &[ModuleInstance<'_>]) -> String {
    let list = print::wire_port_list(clocked, ports, &[]);
    let mut lines = Lines::default();
    lines.nest(list.trim_end(), "endmodule", |lines| {
        for (index, instance) in instances.iter().enumerate() {
            if index > 0 {
                lines.line("");
            }
            let clock = instance.module.clocked.then(|| ("clk".to_owned(), "clk".to_owned()));
            let pins = instance.module.ports.iter().map(|port| {
                let is_shared = shared_inputs.contains(&port.name.as_str());
                (
                    port.name.clone(),
                    if is_shared {
                        port.name.clone()
                    } else {
                        lifted(instance, port)
                    },
                )
            });
            let pins: Vec<_> = clock.into_iter().chain(pins).collect();
            print::instance(lines, &instance.module.name, &instance_name(instance), &pins);
        }
    });
    lines.text
}
