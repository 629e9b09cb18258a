//! Every net of one module: its RustHDL name, its Verilog name, its type, and its possible drivers and readers.

use super::collect::{Kind, Node};
use super::error::{EmitCause, EmitError};
use super::leaf::{self, RegisterTag};
use super::names::{self, Taken};
use super::types::{BIT, Type};
use std::collections::BTreeMap;

/// Index of a net in its [`Scope`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct NetId(pub(super) usize);

/// Role of a net in its module. Numbers are indices into the node's children.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    Input,
    Output,
    Local,
    /// A constant or a value of an enum, with its bit pattern.
    Constant(u64),
    /// Output `q` of a register: its present value.
    Register,
    /// Input `d` of a register: its value after the next clock.
    Next,
    /// Input `clock` of a register.
    RegisterClock,
    /// Input `rst` of a register.
    RegisterReset,
    /// Input of a sub-block, driven by this module.
    PinIn,
    /// Clock input of a sub-block, driven by this module.
    ClockPin,
    /// Output of a sub-block, read by this module.
    PinOut,
}

impl Role {
    /// Whether the kernel assigns it.
    pub(super) fn is_driven(self) -> bool {
        self.is_input_below() || matches!(self, Self::Output | Self::Local)
    }

    /// Whether it is an input of a register or sub-block that the kernel assigns.
    pub(super) fn is_input_below(self) -> bool {
        matches!(self, Self::Next | Self::PinIn | Self::ClockPin)
    }

    /// Description in words of a net that the kernel must not assign.
    pub(super) fn describe(self) -> &'static str {
        match self {
            Self::Input => "an input",
            Self::Constant(_) => "a constant",
            Self::Register => "the output of a register",
            Self::PinOut => "the output of a submodule",
            _ => "wired by `dff_setup!`",
        }
    }
}

/// One net.
#[derive(Debug, Clone)]
pub(super) struct Net {
    pub(super) raw: String,
    /// Name in the Verilog.
    pub(super) name: String,
    pub(super) ty: Type,
    pub(super) role: Role,
}

impl Net {
    /// The net, or `width` bits of it from `low` on, regardless of sign.
    pub(super) fn select(&self, low: u32, width: u32) -> String {
        match width {
            _ if width == self.ty.width => self.name.clone(),
            1 => format!("{}[{low}]", self.name),
            _ => format!("{}[{}:{low}]", self.name, low + width - 1),
        }
    }
}

/// A register that the module contains.
#[derive(Debug)]
pub(super) struct Register {
    pub(super) now: NetId,
    pub(super) next: NetId,
    pub(super) clock: NetId,
    /// Reset and power-up value, and the wiring.
    pub(super) tag: RegisterTag,
}

/// A sub-block that stays a module: its index among the children, and a net per port in port order.
#[derive(Debug)]
pub(super) struct Pins {
    pub(super) child: usize,
    pub(super) nets: Vec<NetId>,
}

/// All nets of a module.
#[derive(Debug, Default)]
pub(super) struct Scope {
    pub(super) nets: Vec<Net>,
    pub(super) registers: Vec<Register>,
    pub(super) pins: Vec<Pins>,
    by_raw: BTreeMap<String, NetId>,
    taken: Taken,
    /// Number of values per enum type, with the first part of a value's name as key.
    pub(super) enum_sizes: BTreeMap<String, usize>,
}

/// Name of the wire that reads otherwise unused bits; lint tools recognise it.
pub(super) const UNUSED: &str = "unused";

impl Scope {
    /// Declares everything in `node` and checks the names.
    pub(super) fn new(node: &Node) -> Result<Self, EmitError> {
        let mut scope = Self::default();
        let at = |signal: &str| {
            let (path, signal) = (&node.path, signal.to_owned());
            move |cause| EmitError::new(path, &signal, cause)
        };
        scope
            .taken
            .take(UNUSED, "the wire for unread bits")
            .map_err(at(UNUSED))?;
        for signal in &node.signals {
            let (role, name) = match signal.kind {
                Kind::Input => (Role::Input, names::flatten(&signal.raw)),
                Kind::Output => (Role::Output, names::flatten(&signal.raw)),
                Kind::Local => (Role::Local, names::flatten(&signal.raw)),
                Kind::Constant(bits) => (Role::Constant(bits), names::constant_name(&signal.raw)),
            };
            names::check_name(&names::flatten(&signal.raw)).map_err(at(&signal.raw))?;
            if signal.kind == Kind::Input && signal.is_clock && name != "clk" {
                return Err(at(&signal.raw)(EmitCause::ClockName));
            }
            scope
                .add(signal.raw.clone(), name, signal.ty, role)
                .map_err(at(&signal.raw))?;
        }
        for (index, child) in node.children.iter().enumerate() {
            names::check_name(&names::flatten(&child.raw)).map_err(at(&child.raw))?;
            match leaf::register(child).map_err(|cause| EmitError::new(&child.path, "", cause))? {
                Some(tag) => scope.add_register(child, tag).map_err(at(&child.raw))?,
                None => scope.add_pins(child, index).map_err(at(&child.raw))?,
            }
        }
        scope.add_enums(node).map_err(at(""))?;
        Ok(scope)
    }

    /// The net with this id.
    pub(super) fn net(&self, id: NetId) -> &Net {
        &self.nets[id.0]
    }

    /// The net with RustHDL's name `raw`.
    pub(super) fn find(&self, raw: &str) -> Option<NetId> {
        self.by_raw.get(raw).copied()
    }

    /// All nets with their ids.
    pub(super) fn iter(&self) -> impl Iterator<Item = (NetId, &Net)> {
        self.nets.iter().enumerate().map(|(index, net)| (NetId(index), net))
    }

    fn add(&mut self, raw: String, name: String, ty: Type, role: Role) -> Result<NetId, EmitCause> {
        self.taken.take(&name, &raw)?;
        Ok(self.add_unnamed(raw, name, ty, role))
    }

    fn add_unnamed(&mut self, raw: String, name: String, ty: Type, role: Role) -> NetId {
        let id = NetId(self.nets.len());
        self.by_raw.insert(raw.clone(), id);
        self.nets.push(Net { raw, name, ty, role });
        id
    }

    fn add_register(&mut self, child: &Node, tag: RegisterTag) -> Result<(), EmitCause> {
        let name = names::flatten(&child.raw);
        let ty = child.ports().find(|port| port.raw == "q").map_or(BIT, |port| port.ty);
        let raw = |port: &str| format!("{}${port}", child.raw);
        let now = self.add(raw("q"), name.clone(), ty, Role::Register)?;
        let next = self.add(raw("d"), format!("{name}_next"), ty, Role::Next)?;
        let clock = self.add_unnamed(raw("clock"), String::new(), BIT, Role::RegisterClock);
        self.add_unnamed(raw("rst"), String::new(), BIT, Role::RegisterReset);
        self.registers.push(Register { now, next, clock, tag });
        Ok(())
    }

    fn add_pins(&mut self, child: &Node, index: usize) -> Result<(), EmitCause> {
        let name = names::flatten(&child.raw);
        self.taken.take(&format!("u_{name}"), &child.raw)?;
        let mut nets = Vec::new();
        for port in child.ports() {
            let role = match port.kind {
                Kind::Input if port.is_clock => Role::ClockPin,
                Kind::Input => Role::PinIn,
                _ => Role::PinOut,
            };
            let raw = format!("{}${}", child.raw, port.raw);
            nets.push(self.add(raw, format!("{name}_{}", names::flatten(&port.raw)), port.ty, role)?);
        }
        self.pins.push(Pins { child: index, nets });
        Ok(())
    }

    fn add_enums(&mut self, node: &Node) -> Result<(), EmitCause> {
        for (type_name, values) in &node.enums {
            // This is RustHDL's clog2, which determines the width of the type's signals.
            let width = values.len().max(2).next_power_of_two().trailing_zeros();
            self.enum_sizes.insert(type_name.clone(), values.len());
            for (number, raw) in values.iter().enumerate() {
                let role = Role::Constant(number as u64);
                self.add(raw.clone(), names::constant_name(raw), Type::bits(width), role)?;
            }
        }
        Ok(())
    }
}
