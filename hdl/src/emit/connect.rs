//! Writes the Verilog of a composition: its parts' modules, joined by named nets.

use super::error::{EmitCause, EmitError};
use super::names::{self, Taken};
use super::print::{self, Lines};
use super::types::{BIT, Type};
use super::{Header, Module};
use posicast_blocks::composition::{Composition, Connection};
use posicast_blocks::{Direction, Port};

/// Writes the module `top`: one instance per part of `composition`, of the module with the same index in `modules`.
///
/// Instances are called `u_PART`; nets that are not ports are wires with their own name.
///
/// # Errors
/// An error for names that are reserved or used twice, and for a module whose ports differ from the part's.
pub fn connect(
    top: &str,
    header: &Header,
    composition: &Composition,
    modules: &[&Module],
) -> Result<Module, EmitError> {
    let at = |signal: &str| {
        let signal = signal.to_owned();
        move |cause| EmitError::new(top, &signal, cause)
    };
    check_names(top, composition).map_err(|(name, cause)| at(&name)(cause))?;
    for (place, part) in composition.parts().iter().enumerate() {
        let fits = modules.get(place).is_some_and(|module| module.ports == part.ports());
        if !fits {
            return Err(at(part.name())(EmitCause::PartPorts(part.name().to_owned())));
        }
    }
    let clocked = modules.iter().any(|module| module.clocked);
    let text = print::file(
        top,
        &print::data_header(top, header, "composition"),
        &body(composition, clocked, modules),
    );
    Ok(Module {
        name: top.to_owned(),
        text,
        ports: composition.ports().to_vec(),
        clocked,
    })
}

fn check_names(top: &str, composition: &Composition) -> Result<(), (String, EmitCause)> {
    let mut taken = Taken::default();
    let mut take = |name: &str, owner: &str| {
        let checked = names::check_name(name).and_then(|()| taken.take(name, owner));
        checked.map_err(|cause| (name.to_owned(), cause))
    };
    take(top, "the module")?;
    take("clk", "the clock")?;
    take(super::scope::UNUSED, "the unused nets")?;
    for part in composition.parts() {
        names::check_form(part.name()).map_err(|cause| (part.name().to_owned(), cause))?;
        take(&instance_name(part.name()), "an instance")?;
    }
    for net in composition.nets() {
        take(&net.port.name, "a net")?;
    }
    Ok(())
}

fn instance_name(part: &str) -> String {
    format!("u_{part}")
}

fn port_type(port: &Port) -> Type {
    Type {
        width: port.width,
        signed: port.signed,
    }
}

fn body(composition: &Composition, clocked: bool, modules: &[&Module]) -> String {
    let clock = clocked.then(|| ("input  wire", BIT, "clk".to_owned()));
    let ports = composition.ports().iter().map(|port| {
        let keyword = match port.direction {
            Direction::Input => "input  wire",
            Direction::Output => "output wire",
        };
        (keyword, port_type(port), port.name.clone())
    });
    let list = print::port_list(&clock.into_iter().chain(ports).collect::<Vec<_>>());
    let inside = || {
        composition
            .nets()
            .iter()
            .filter(|net| net.driver.is_some() && !net.is_output)
    };
    let mut lines = Lines::default();
    lines.nest(list.trim_end(), "endmodule", |lines| {
        let wires: Vec<_> = inside()
            .map(|net| ("wire", port_type(&net.port), net.port.name.clone()))
            .collect();
        print::declarations(lines, &wires);
        for (index, ((part, connections), module)) in composition
            .parts()
            .iter()
            .zip(composition.connections())
            .zip(modules)
            .enumerate()
        {
            if index > 0 || !wires.is_empty() {
                lines.line("");
            }
            let clock = module.clocked.then(|| ("clk".to_owned(), "clk".to_owned()));
            let pins = part.ports().iter().zip(connections).map(|(port, connection)| {
                let net = match connection {
                    Connection::Net(net) => composition.nets()[*net].port.name.clone(),
                    Connection::Tied(value) => port_type(port).literal(*value),
                };
                (port.name.clone(), net)
            });
            let pins: Vec<_> = clock.into_iter().chain(pins).collect();
            print::instance(lines, &module.name, &instance_name(part.name()), &pins);
        }
        let unread: Vec<_> = inside()
            .filter(|net| !net.is_read)
            .map(|net| net.port.name.as_str())
            .collect();
        if !unread.is_empty() {
            lines.line("");
            lines.line("// Nets that are never read.");
            lines.line(&format!(
                "wire {} = &{{1'b0, {}}};",
                super::scope::UNUSED,
                unread.join(", ")
            ));
        }
    });
    lines.text
}
