//! Converts RustHDL's object tree to a tree of nodes, each a block with its signals, sub-blocks and kernel, so that the
//! following passes do not depend on RustHDL's walk.

use super::CONNECTIONS_TAG;
use super::error::{EmitCause, EmitError};
use super::types::Type;
use rust_hdl_core::prelude::{Atom, AtomKind, Block, Probe, TypeDescriptor, TypeKind, Verilog, VerilogLiteral};
use std::collections::BTreeMap;

/// Role of a declared signal in its block.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Input,
    Output,
    Local,
    /// A constant with its bit pattern.
    Constant(u64),
}

/// A signal as its block declares it.
#[derive(Debug, Clone)]
pub(super) struct Signal {
    /// RustHDL's name: the field, with `$` between the parts of an array or interface.
    pub(super) raw: String,
    pub(super) kind: Kind,
    pub(super) ty: Type,
    pub(super) is_clock: bool,
}

/// The values of an enum type, in order: `State$Idle`, `State$Run`.
pub(super) type EnumValues = Vec<String>;

/// A block with everything that it contains.
#[derive(Debug)]
pub(super) struct Node {
    /// Name of the field in the parent.
    pub(super) raw: String,
    /// Path from the top, joined by dots, for messages.
    pub(super) path: String,
    pub(super) signals: Vec<Signal>,
    pub(super) children: Vec<Node>,
    pub(super) code: Verilog,
    /// Connections that `kernel!` makes without a statement of the kernel.
    pub(super) connections: Vec<Connection>,
    /// Enum types of its own signals and those of its direct sub-blocks, by type name.
    pub(super) enums: BTreeMap<String, EnumValues>,
}

/// A connection of `kernel!`, by RustHDL's names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Connection {
    Output {
        port: String,
        source: String,
    },
    /// An input of a part.
    Input {
        port: String,
        source: String,
    },
    /// Clock and reset of a part, or of an array of them.
    Clocking {
        part: String,
    },
}

impl Node {
    /// Inputs and outputs, in the order of declaration.
    pub(super) fn ports(&self) -> impl Iterator<Item = &Signal> {
        self.signals
            .iter()
            .filter(|signal| matches!(signal.kind, Kind::Input | Kind::Output))
    }
}

/// Walks `block`, which becomes the node `name`.
pub(super) fn collect<B: Block + ?Sized>(block: &B, name: &str) -> Result<Node, EmitError> {
    let mut collector = Collector::default();
    block.accept(name, &mut collector);
    if let Some(error) = collector.error {
        return Err(error);
    }
    collector.root.ok_or_else(|| {
        let found = "a top that is an array of blocks".to_owned();
        EmitError::new(
            name,
            "",
            EmitCause::Unsupported {
                found,
                remedy: "emit the blocks one by one",
            },
        )
    })
}

/// Width and bit pattern of a literal of the syntax tree.
pub(super) fn literal_value(literal: &VerilogLiteral) -> Option<(u32, i128)> {
    let text = format!("{literal:x}");
    let (width, digits) = text.split_once("'h")?;
    Some((width.parse().ok()?, i128::from_str_radix(digits, 16).ok()?))
}

#[derive(Default)]
struct Collector {
    open: Vec<Node>,
    namespaces: Vec<String>,
    root: Option<Node>,
    /// The first error. RustHDL's walk cannot be stopped, so more may follow.
    error: Option<EmitError>,
}

impl Probe for Collector {
    fn visit_start_scope(&mut self, name: &str, block: &dyn Block) {
        let path = match self.open.last() {
            Some(parent) => format!("{}.{}", parent.path, name.replace('$', ".")),
            None => name.to_owned(),
        };
        self.open.push(Node {
            raw: name.to_owned(),
            path,
            signals: Vec::new(),
            children: Vec::new(),
            code: block.hdl(),
            connections: Vec::new(),
            enums: BTreeMap::new(),
        });
    }

    fn visit_start_namespace(&mut self, name: &str, _: &dyn Block) {
        self.namespaces.push(name.to_owned());
    }

    fn visit_end_namespace(&mut self, _: &str, _: &dyn Block) {
        self.namespaces.pop();
    }

    fn visit_atom(&mut self, name: &str, atom: &dyn Atom) {
        let Some(node) = self.open.last_mut() else { return };
        let raw = self
            .namespaces
            .iter()
            .map(String::as_str)
            .chain([name])
            .collect::<Vec<_>>()
            .join("$");
        match signal(raw.clone(), atom) {
            Ok(signal) => {
                if let TypeKind::Enum(labels) = atom.descriptor().kind {
                    node.enums.insert(
                        atom.descriptor().name,
                        labels.iter().map(|l| l.replace("::", "$")).collect(),
                    );
                }
                node.signals.push(signal);
            }
            Err(cause) => {
                self.error.get_or_insert(EmitError::new(&node.path, &raw, cause));
            }
        }
    }

    fn visit_end_scope(&mut self, _: &str, _: &dyn Block) {
        let Some(node) = self.open.pop() else { return };
        match self.open.last_mut() {
            Some(parent) => {
                if let Verilog::Custom(text) = &node.code
                    && let Some(lines) = text.strip_prefix(CONNECTIONS_TAG)
                {
                    parent.connections = lines.lines().filter_map(connection).collect();
                    return;
                }
                let of_ports = node.enums.iter().map(|(name, values)| (name.clone(), values.clone()));
                parent.enums.extend(of_ports);
                parent.children.push(node);
            }
            None => self.root = Some(node),
        }
    }
}

/// A line of the list of connections.
fn connection(line: &str) -> Option<Connection> {
    let line = line.replace('.', "$");
    let words: Vec<_> = line.split(' ').map(str::to_owned).collect();
    match <[String; 3]>::try_from(words) {
        Ok([kind, port, source]) if kind == "output" => Some(Connection::Output { port, source }),
        Ok([kind, port, source]) if kind == "input" => Some(Connection::Input { port, source }),
        Ok(_) => None,
        Err(words) => Some(Connection::Clocking {
            part: words.into_iter().nth(1)?,
        }),
    }
}

fn signal(raw: String, atom: &dyn Atom) -> Result<Signal, EmitCause> {
    let width = atom.bits();
    if !(1..=64).contains(&width) {
        return Err(EmitCause::Width(width));
    }
    let descriptor: TypeDescriptor = atom.descriptor();
    let signed = match descriptor.kind {
        TypeKind::Signed(_) => true,
        TypeKind::Bits(_) | TypeKind::Enum(_) => false,
        TypeKind::Composite(_) => {
            let found = format!("a signal of the struct type {}", descriptor.name);
            return Err(EmitCause::Unsupported {
                found,
                remedy: "use one signal per field",
            });
        }
    };
    let ty = Type {
        width: width as u32,
        signed,
    };
    let kind = match atom.kind() {
        AtomKind::InputParameter => Kind::Input,
        AtomKind::OutputParameter => Kind::Output,
        AtomKind::LocalSignal => Kind::Local,
        AtomKind::Constant => Kind::Constant(constant(&atom.verilog(), ty)?),
        other => {
            let found = format!("a signal of the kind {other:?}");
            return Err(EmitCause::Unsupported {
                found,
                remedy: "use In, Out, Local or Constant",
            });
        }
    };
    Ok(Signal {
        raw,
        kind,
        ty,
        is_clock: descriptor.name == "clock",
    })
}

/// The bit pattern of a constant; RustHDL prints signed constants as patterns too.
fn constant(literal: &VerilogLiteral, ty: Type) -> Result<u64, EmitCause> {
    let (_, value) = literal_value(literal).ok_or(EmitCause::WidthUnknown("a constant"))?;
    EmitCause::pattern(Type::bits(ty.width), value)
}
