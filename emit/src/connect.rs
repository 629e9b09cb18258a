//! Writes the Verilog of a composition: its parts' modules, joined by named nets.

use super::error::{EmitCause, EmitError};
use super::names::{self, Taken};
use super::print::{self, Lines};
use super::types::Type;
use super::{Header, Module};
use posicast_blocks::composition::{Composition, Connection};
use posicast_blocks::{Port, PortNote};

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
    let notes = notes(composition, modules);
    let text = print::file(
        top,
        &print::data_header(top, header, "composition"),
        &body(composition, clocked, modules, &notes),
    );
    Ok(Module {
        name: top.to_owned(),
        text,
        ports: composition.ports().to_vec(),
        clocked,
        notes,
    })
}

/// What the ports are for: an output is that of the part that drives it, an input that of the first part that has it.
fn notes(composition: &Composition, modules: &[&Module]) -> Vec<PortNote> {
    let mut notes: Vec<PortNote> = Vec::new();
    for ((part, connections), module) in composition.parts().iter().zip(composition.connections()).zip(modules) {
        let on_nets = part.ports().iter().zip(connections).filter_map(|(port, connection)| {
            if let Connection::Net(net) = connection {
                Some((port, composition.nets()[*net].port.name.as_str()))
            } else {
                None
            }
        });
        let on_nets: Vec<_> = on_nets.collect();
        for (port, net) in &on_nets {
            let is_port = |outer: &Port| outer.name == *net && outer.direction == port.direction;
            let is_known = notes.iter().any(|note| note.port == *net);
            let note = module.notes.iter().find(|note| note.port == port.name);
            if let Some(note) = note.filter(|_| !is_known && composition.ports().iter().any(is_port)) {
                notes.push(PortNote {
                    port: (*net).to_owned(),
                    text: renamed(&note.text, &on_nets),
                });
            }
        }
    }
    notes
}

/// The text with its ports, which stand between backticks, by the names of their nets.
fn renamed(text: &str, on_nets: &[(&Port, &str)]) -> String {
    let words = text.split('`').enumerate().map(|(at, word)| {
        let net = on_nets.iter().find(|(port, _)| at % 2 == 1 && port.name == word);
        net.map_or(word, |(_, net)| *net)
    });
    words.collect::<Vec<_>>().join("`")
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

fn body(composition: &Composition, clocked: bool, modules: &[&Module], notes: &[PortNote]) -> String {
    let list = print::wire_port_list(clocked, composition.ports(), notes);
    let inside = || {
        composition
            .nets()
            .iter()
            .filter(|net| net.driver.is_some() && !net.is_output)
    };
    let mut lines = Lines::default();
    lines.nest(list.trim_end(), "endmodule", |lines| {
        let wires: Vec<_> = inside()
            .map(|net| ("wire", Type::of(&net.port), net.port.name.clone()))
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
                    Connection::Tied(value) => Type::of(port).literal(*value),
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
