//! Writes one module per block: leaves from their text, composites from their kernels; equal modules are written
//! once.

use super::collect::{Kind, Node, Signal};
use super::drivers::{Drivers, unread};
use super::error::{EmitCause, EmitError};
use super::leaf;
use super::names;
use super::numbers;
use super::print::{self, Lines};
use super::scope::{NetId, Role, Scope};
use super::statements::{comment_text, statements};
use super::{EmitOptions, Heads, Module, flow, head};
use posicast_blocks::{Direction, Port, PortNote};
use rust_hdl_core::ast::VerilogStatement;
use rust_hdl_core::prelude::Verilog;
use std::collections::{BTreeMap, BTreeSet};

/// The modules written so far, leaves first.
pub(super) struct Modules<'a> {
    options: &'a EmitOptions,
    heads: Heads,
    written: Vec<Module>,
    /// Contents of each module by its name.
    by_name: BTreeMap<String, Content>,
    /// Names of modules without a tag: the path of the first block with these contents.
    untagged: BTreeMap<Content, String>,
}

/// Header and body of a module.
type Content = (Vec<String>, String);

/// A module before it has its final name.
struct Draft {
    /// Base name from the tag of the kernel or leaf.
    tagged: Option<String>,
    /// Whether its contents, or those of a sub-block, depend on the machine.
    of_machine: bool,
    about: Vec<String>,
    /// Text from the port list to `endmodule`.
    body: String,
}

/// Writes `top` and everything in it.
pub(super) fn modules(top: &Node, options: &EmitOptions, heads: Heads) -> Result<Vec<Module>, EmitError> {
    let mut modules = Modules {
        options,
        heads,
        written: Vec::new(),
        by_name: BTreeMap::new(),
        untagged: BTreeMap::new(),
    };
    let draft = modules.draft(top, &options.header.ports)?;
    let top_name = names::module_name(&options.prefix, draft.of_machine, &options.top);
    modules.take(top, &top_name, &draft)?;
    let about: Vec<_> = draft.about.iter().map(String::as_str).collect();
    let header = print::top_header(&top_name, &about, &options.header);
    modules.push(top, top_name, &header, &draft.body);
    if let Some(top) = modules.written.last_mut() {
        top.notes.clone_from(&options.header.ports);
    }
    Ok(modules.written)
}

impl Modules<'_> {
    fn draft(&mut self, node: &Node, notes: &[PortNote]) -> Result<Draft, EmitError> {
        match &node.code {
            Verilog::Combinatorial(kernel) => self.composite(node, kernel, notes),
            Verilog::Custom(text) => self.leaf(node, text, notes),
            Verilog::Empty | Verilog::Blackbox(_) | Verilog::Wrapper(_) => {
                let found = "a block without kernel, a black box or a wrapper".to_owned();
                let remedy = "write it as a leaf with `Verilog::Custom`";
                Err(EmitError::new(&node.path, "", EmitCause::Unsupported { found, remedy }))
            }
        }
    }

    fn leaf(&self, node: &Node, text: &str, notes: &[PortNote]) -> Result<Draft, EmitError> {
        let wrong = |cause| EmitError::new(&node.path, "", cause);
        let text = numbers::fill(text, node).map_err(wrong)?;
        let leaf = leaf::parse(&text, node).map_err(wrong)?;
        for port in node.ports() {
            let checked = names::check_name(&names::flatten(&port.raw));
            checked.map_err(|cause| EmitError::new(&node.path, &port.raw, cause))?;
        }
        let mut lines = Lines::default();
        let ports = print::ports(node, &|port| leaf.regs.contains(&port.raw.as_str()), notes);
        lines.nest(ports.trim_end(), "endmodule", |lines| {
            leaf.body.iter().for_each(|line| lines.line(line))
        });
        Ok(Draft {
            tagged: Some(leaf.base_name.to_owned()),
            of_machine: leaf.of_machine,
            about: leaf.about.iter().map(|&line| line.to_owned()).collect(),
            body: lines.text,
        })
    }

    fn composite(&mut self, node: &Node, kernel: &[VerilogStatement], notes: &[PortNote]) -> Result<Draft, EmitError> {
        let scope = Scope::new(node)?;
        let typed = statements(kernel, node, &scope)?;
        flow::check(&typed, &node.path, &scope)?;
        let drivers = Drivers::new(typed, &node.path, &scope)?;
        let clocking = Clocking::find(node, &scope)?;
        let mut bits_read = drivers.bits_read();
        clocking.iter().for_each(|clocking| clocking.mark_read(&mut bits_read));
        let unread = unread(&bits_read, &node.path, &scope)?;

        let mut children = Vec::new();
        let mut of_machine = false;
        for pins in &scope.pins {
            let (name, is_of_machine) = self.child(&node.children[pins.child])?;
            children.push(name);
            of_machine |= is_of_machine;
        }
        let writer = Composite {
            node,
            scope: &scope,
            drivers: &drivers,
            clocking: clocking.as_ref(),
        };
        let body = writer.body(&bits_read, &children, &unread, notes);
        let (tagged, about) = tagged(kernel, node, self.heads)?;
        Ok(Draft {
            tagged,
            of_machine,
            about,
            body,
        })
    }

    /// Writes the module of a sub-block, unless it exists, and returns its name and whether its contents depend on the
    /// machine.
    fn child(&mut self, node: &Node) -> Result<(String, bool), EmitError> {
        let draft = self.draft(node, &[])?;
        let from_path = || node.path.split('.').skip(1).collect::<Vec<_>>().join("_");
        let base = match &draft.tagged {
            Some(tagged) => tagged.clone(),
            None => {
                let content = (draft.about.clone(), draft.body.clone());
                self.untagged.entry(content).or_insert_with(from_path).clone()
            }
        };
        let name = names::module_name(&self.options.prefix, draft.of_machine, &base);
        if self.take(node, &name, &draft)? {
            let about: Vec<_> = draft.about.iter().map(String::as_str).collect();
            self.push(node, name.clone(), &print::part_header(&name, &about), &draft.body);
        }
        Ok((name, draft.of_machine))
    }

    /// Reserves the name for the module. Returns false if an equal module already has it.
    ///
    /// # Errors
    /// [`EmitCause::OtherContent`] where another module has the name.
    fn take(&mut self, node: &Node, name: &str, draft: &Draft) -> Result<bool, EmitError> {
        let content = (draft.about.clone(), draft.body.clone());
        match self.by_name.get(name) {
            None => {
                self.by_name.insert(name.to_owned(), content);
                Ok(true)
            }
            Some(there) if *there == content => Ok(false),
            Some(_) => Err(EmitError::new(&node.path, "", EmitCause::OtherContent(name.to_owned()))),
        }
    }

    fn push(&mut self, node: &Node, name: String, header: &str, body: &str) {
        let ports = node.ports().filter(|port| port.raw != "clk").map(|port| Port {
            name: names::flatten(&port.raw),
            direction: if port.kind == Kind::Input {
                Direction::Input
            } else {
                Direction::Output
            },
            width: port.ty.width,
            signed: port.ty.signed,
        });
        let ports = ports.collect();
        let clocked = node.ports().any(|port| port.raw == "clk");
        let text = print::file(&name, header, body);
        self.written.push(Module {
            name,
            text,
            ports,
            clocked,
            notes: Vec::new(),
        });
    }
}

/// The base name of a kernel's module from its `comment!("@module name")`, and the head of its file.
fn tagged(kernel: &[VerilogStatement], node: &Node, heads: Heads) -> Result<(Option<String>, Vec<String>), EmitError> {
    for statement in kernel {
        let VerilogStatement::Comment(raw) = statement else {
            continue;
        };
        let text = comment_text(raw).unwrap_or_default();
        if let Some(tag) = text.strip_prefix("@module ") {
            let name = numbers::fill(tag, node).and_then(|name| names::check_name(&name).map(|()| name));
            let name = name.map_err(|cause| EmitError::new(&node.path, "", cause))?;
            return Ok((Some(name), head::head(heads, tag)));
        }
    }
    Ok((None, Vec::new()))
}

/// Clock and reset of the registers.
struct Clocking {
    clk: NetId,
    rst: NetId,
}

impl Clocking {
    /// `None` if there are no registers.
    fn find(node: &Node, scope: &Scope) -> Result<Option<Self>, EmitError> {
        let Some(register) = scope.registers.first() else {
            return Ok(None);
        };
        let input = |name: &'static str| {
            let found = scope
                .find(name)
                .filter(|id| scope.net(*id).role == Role::Input && scope.net(*id).ty.width == 1);
            let register = &scope.net(register.now).name;
            found.ok_or_else(|| EmitError::new(&node.path, register, EmitCause::MissingInput(name)))
        };
        Ok(Some(Self {
            clk: input("clk")?,
            rst: input("rst")?,
        }))
    }

    fn mark_read(&self, bits_read: &mut BTreeMap<NetId, u64>) {
        bits_read.insert(self.clk, u64::MAX);
        bits_read.insert(self.rst, u64::MAX);
    }
}

/// A composite, ready to be written.
struct Composite<'a> {
    node: &'a Node,
    scope: &'a Scope,
    drivers: &'a Drivers,
    clocking: Option<&'a Clocking>,
}

impl Composite<'_> {
    fn body(
        &self,
        bits_read: &BTreeMap<NetId, u64>,
        children: &[String],
        unread: &[(NetId, u32, u32)],
        notes: &[PortNote],
    ) -> String {
        let (scope, drivers) = (self.scope, self.drivers);
        let variables = drivers.procedural_targets();
        let is_variable = |port: &Signal| scope.find(&port.raw).is_some_and(|id| variables.contains(&id));
        let mut lines = Lines::default();
        let ports = print::ports(self.node, &is_variable, notes);
        lines.nest(ports.trim_end(), "endmodule", |lines| {
            let start = lines.text.len();
            lines.section(|lines| self.constants(lines, bits_read));
            lines.section(|lines| self.nets(lines, &variables));
            for (pins, module) in scope.pins.iter().zip(children) {
                lines.section(|lines| {
                    let child = &self.node.children[pins.child];
                    pins.nets.iter().for_each(|id| self.notes(lines, *id));
                    let names = child.ports().map(|port| names::flatten(&port.raw));
                    let nets = pins.nets.iter().map(|id| self.source(*id).to_owned());
                    let name = format!("u_{}", names::flatten(&child.raw));
                    print::instance(lines, module, &name, &names.zip(nets).collect::<Vec<_>>());
                });
            }
            lines.section(|lines| print::assigns(lines, &drivers.continuous, scope));
            if !drivers.procedural.is_empty() {
                lines.section(|lines| {
                    lines.nest("always @(*) begin", "end", |lines| {
                        print::block(lines, &drivers.procedural, scope)
                    });
                });
            }
            self.registers(lines);
            lines.section(|lines| print::unused(lines, unread, scope));
            // The first section needs no blank line above it.
            if lines.text[start..].starts_with('\n') {
                lines.text.remove(start);
            }
        });
        lines.text
    }

    /// The source to which an input of a sub-block or register is connected.
    fn source(&self, id: NetId) -> &str {
        match self.drivers.direct.get(&id) {
            Some(source) => &source.text,
            None => &self.scope.net(id).name,
        }
    }

    /// Writes the comments for the wiring of this input.
    fn notes(&self, lines: &mut Lines, id: NetId) {
        for text in self.drivers.notes.get(&id).into_iter().flatten() {
            lines.line(&format!("// {text}"));
        }
    }

    fn constants(&self, lines: &mut Lines, bits_read: &BTreeMap<NetId, u64>) {
        let read = self.scope.iter().filter(|(id, _)| bits_read.contains_key(id));
        let declared = read.filter_map(|(_, net)| match net.role {
            Role::Constant(pattern) => {
                let definition = format!("{} = {}", net.name, net.ty.literal(pattern));
                Some(("localparam", net.ty, definition))
            }
            _ => None,
        });
        print::declarations(lines, &declared.collect::<Vec<_>>());
    }

    /// Declares the nets; a register and its value after the next clock share a line.
    fn nets(&self, lines: &mut Lines, variables: &BTreeSet<NetId>) {
        let registers = self.scope.registers.iter();
        let next: BTreeMap<_, _> = registers
            .filter(|register| variables.contains(&register.next))
            .map(|register| (register.now, register.next))
            .collect();
        let declared = self.scope.iter().filter_map(|(id, net)| {
            let keyword = match net.role {
                Role::Register => "reg",
                Role::PinOut => "wire",
                Role::Output => return None,
                Role::Next if variables.contains(&id) => return None,
                role if role.is_driven() && variables.contains(&id) => "reg",
                role if role.is_driven() && !self.drivers.direct.contains_key(&id) => "wire",
                _ => return None,
            };
            let names = match next.get(&id) {
                Some(next) => format!("{}, {}", net.name, self.scope.net(*next).name),
                None => net.name.clone(),
            };
            Some((keyword, net.ty, names))
        });
        print::declarations(lines, &declared.collect::<Vec<_>>());
    }

    fn registers(&self, lines: &mut Lines) {
        let Some(clocking) = self.clocking else { return };
        let scope = self.scope;
        let initial = |lines: &mut Lines, assign: &str| {
            for register in &scope.registers {
                let net = scope.net(register.now);
                lines.line(&format!(
                    "{} {assign} {};",
                    net.name,
                    net.ty.literal(register.tag.initial)
                ));
            }
        };
        let (clk, rst) = (&scope.net(clocking.clk).name, &scope.net(clocking.rst).name);
        lines.section(|lines| {
            let open = format!("always @(posedge {clk}) if ({rst}) begin");
            lines.nest(&open, "end else begin", |lines| initial(lines, "<="));
            lines.nest_rest("end", |lines| {
                for register in &scope.registers {
                    self.notes(lines, register.next);
                    let next = self.source(register.next);
                    lines.line(&format!("{} <= {next};", scope.net(register.now).name));
                }
            });
        });
        // The block follows `always @(*)`: an event simulator must have started that one when these values change.
        lines.section(|lines| lines.nest("initial begin", "end", |lines| initial(lines, "=")));
    }
}
