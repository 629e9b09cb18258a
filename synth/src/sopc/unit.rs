//! A component as Platform Designer sees it: assigns its ports to interfaces.
//!
//! | interface | kind | ports |
//! |---|---|---|
//! | `clk` | clock | `clk` |
//! | `reset` | reset, synchronous | `rst` |
//! | `avs` | Avalon-MM agent | `avs_ROLE` |
//! | `irq` | interrupt | `irq`, where the map has interrupts |
//! | `pins` | conduit | ports that belong to no axis: all pins of a block that stands alone |
//! | `axis_NAME` | conduit | of a stage: `NAME_ROLE`, for each axis |
//!
//! Every port is in exactly one interface. The rule uses the ports of the model's composition, which are those of the
//! Verilog.

use posicast_blocks::component::Component;
use posicast_blocks::registers::{Access, Field, Format};
use posicast_blocks::{Direction, Port};

/// A component of the package.
#[derive(Debug, Clone)]
pub struct Unit<'a> {
    /// Name of its top module.
    pub top: &'a str,
    /// The component.
    pub component: &'a Component,
    /// Names of its Verilog modules, each a file `rtl/NAME.v` of the package, the top last.
    pub modules: Vec<String>,
    /// The axes with whose names ports begin: those of a stage; none for a block that stands alone.
    pub axes: Vec<&'a str>,
}

/// Kind of an interface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Clock,
    Reset,
    Agent,
    Host,
    Interrupt,
    Conduit,
}

/// An interface with its ports.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Interface {
    pub(super) name: String,
    pub(super) kind: Kind,
    pub(super) signals: Vec<Signal>,
}

/// A port in its interface.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Signal {
    pub(super) port: String,
    /// Role in the interface; in a conduit a name of its own.
    pub(super) role: String,
    pub(super) is_input: bool,
    /// Width in bits.
    pub(super) width: u32,
}

/// Name of the conduit for ports that belong to no axis.
pub(super) const PINS: &str = "pins";
/// Prefix of an axis's conduit, before the axis's name.
const AXIS_PREFIX: &str = "axis_";

impl Unit<'_> {
    /// Its interfaces, each with at least one port; together they contain every port of the top module once.
    pub(super) fn interfaces(&self) -> Vec<Interface> {
        let clk = Signal {
            port: "clk".to_owned(),
            role: "clk".to_owned(),
            is_input: true,
            width: 1,
        };
        let mut interfaces = vec![Interface {
            name: "clk".to_owned(),
            kind: Kind::Clock,
            signals: vec![clk],
        }];
        for port in self.component.composition().ports() {
            let (name, kind, role) = self.place(&port.name);
            let signal = signal(port, role);
            match interfaces.iter_mut().find(|interface| interface.name == name) {
                Some(interface) => interface.signals.push(signal),
                None => interfaces.push(Interface {
                    name,
                    kind,
                    signals: vec![signal],
                }),
            }
        }
        interfaces
    }

    /// Its conduits.
    pub(super) fn conduits(&self) -> Vec<Interface> {
        let mut interfaces = self.interfaces();
        interfaces.retain(|interface| interface.kind == Kind::Conduit);
        interfaces
    }

    /// Interface, kind and role of a port.
    fn place<'p>(&self, port: &'p str) -> (String, Kind, &'p str) {
        if let Some(role) = port.strip_prefix("avs_") {
            return ("avs".to_owned(), Kind::Agent, role);
        }
        match port {
            "rst" => ("reset".to_owned(), Kind::Reset, "reset"),
            "irq" => ("irq".to_owned(), Kind::Interrupt, "irq"),
            _ => match self.axis_of(port) {
                Some((axis, role)) => (format!("{AXIS_PREFIX}{axis}"), Kind::Conduit, role),
                None => (PINS.to_owned(), Kind::Conduit, port),
            },
        }
    }

    /// The axis to which a port belongs, and the rest of its name. With the axes `x` and `x_2`, `x_2_home` belongs to
    /// the second.
    pub(super) fn axis_of<'p>(&self, port: &'p str) -> Option<(&str, &'p str)> {
        let of_axis = |axis: &&str| {
            port.strip_prefix(*axis)?
                .strip_prefix('_')
                .filter(|role| !role.is_empty())
        };
        let axes = self.axes.iter().filter(|axis| of_axis(axis).is_some());
        let axis = axes.max_by_key(|axis| axis.len())?;
        Some((axis, of_axis(axis)?))
    }

    /// Parameters of its build: the constants of its register map after magic and version.
    pub(super) fn parameters(&self) -> impl Iterator<Item = &Field> {
        let registers = self.component.map().registers().iter();
        let constants = registers.filter(|register| register.access == Access::Constant && register.offset > 1);
        constants.flat_map(|register| &register.fields)
    }

    /// Reset value of a field of the constants `magic` and `version`; 0 if the map has no field with this name.
    pub(super) fn constant(&self, register: &str, field: &str) -> u32 {
        let register = self.component.map().register(register);
        let field = register.and_then(|register| register.fields.iter().find(|other| other.name == field));
        field.map_or(0, |field| field.reset)
    }

    /// Common name of the law that a controller has after reset: its module is called `sliding_mode`, whatever the
    /// law.
    pub(super) fn law(&self) -> Option<String> {
        if self.component.name() != "sliding_mode" {
            return None;
        }
        let fields = &self.component.map().register("law")?.fields;
        let law = fields.iter().find(|field| field.name == "law")?;
        let Format::Enumeration(laws) = &law.format else {
            return None;
        };
        let name = &laws.iter().find(|choice| choice.value == law.reset)?.name;
        Some(match name.as_str() {
            "sliding_mode" => "sliding mode".to_owned(),
            short => short.to_uppercase(),
        })
    }

    /// Name shown where people choose a component: its block, or a controller's law.
    pub(super) fn title(&self) -> String {
        match self.law() {
            Some(law) => format!("controller ({law})"),
            None => self.component.name().to_owned(),
        }
    }

    /// Version of the register map, `MAJOR.MINOR`.
    pub(super) fn version(&self) -> String {
        format!(
            "{}.{}",
            self.constant("version", "major"),
            self.constant("version", "minor")
        )
    }

    /// Bytes of its span on the bus.
    pub(super) fn span_bytes(&self) -> u32 {
        4 << self.component.map().address_bits()
    }
}

pub(super) fn signal(port: &Port, role: &str) -> Signal {
    Signal {
        port: port.name.clone(),
        role: role.to_owned(),
        is_input: port.direction == Direction::Input,
        width: port.width,
    }
}
