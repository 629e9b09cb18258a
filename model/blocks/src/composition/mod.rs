//! Compositions: blocks joined by nets, as checked plain data, and the model that steps them.
//!
//! A port is on the net of its own name, unless its part names another one; so blocks that use the same name for a
//! signal are connected. A net has one driver: an output of a part, or an input of the whole.
//! `posicast_hdl::emit::connect` writes the Verilog of the same composition.
//!
//! ```
//! use posicast_blocks::composition::{Composed, Composition, Part};
//! use posicast_blocks::divider::{DIVISION_CLOCKS, Divider, DividerConfig};
//! use posicast_blocks::ClockedBlock;
//!
//! // Two dividers; the second divides when the first is done.
//! let config = DividerConfig::new(5000)?;
//! let (first, second) = (Divider::new(&config), Divider::new(&config));
//! let parts = vec![
//!     Part::new("first", first.ports()).on("quotient", "velocity").on("busy", "first_busy")
//!         .on("saturated", "first_saturated").on("overrun", "first_overrun").on("done", "next"),
//!     Part::new("second", second.ports()).on("start", "next").tied("steps", 1).tied("clear_flags", 1),
//! ];
//! let inputs = ["rst", "start", "steps", "elapsed", "clear_flags"];
//! let composition = Composition::new(parts, &inputs, &["velocity", "quotient"])?;
//! let mut joined = Composed::new(composition, vec![Box::new(first), Box::new(second)]);
//! let mut outputs = [0; 2];
//! joined.step(&[0, 1, 3, 7500, 0], &mut outputs)?;
//! for _ in 0..2 * DIVISION_CLOCKS {
//!     joined.step(&[0, 0, 0, 10_000, 0], &mut outputs)?;
//! }
//! assert_eq!(outputs, [2 << 16, 1 << 15]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod composed;
mod flat;
mod member;
mod wire;

pub use composed::Composed;

use super::{Direction, Port};

/// A block in a composition.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Part {
    name: String,
    ports: Vec<Port>,
    wiring: Vec<(String, Wiring)>,
}

/// Connection of a port.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Wiring {
    Net(String),
    Tied(u64),
}

impl Part {
    /// A part with every port on the net of its own name.
    pub fn new(name: &str, ports: &[Port]) -> Self {
        Self {
            name: name.to_owned(),
            ports: ports.to_vec(),
            wiring: Vec::new(),
        }
    }

    /// Puts `port` on `net`.
    #[must_use]
    pub fn on(mut self, port: &str, net: &str) -> Self {
        self.wiring.push((port.to_owned(), Wiring::Net(net.to_owned())));
        self
    }

    /// Ties the input `port` to the constant `value`.
    #[must_use]
    pub fn tied(mut self, port: &str, value: u64) -> Self {
        self.wiring.push((port.to_owned(), Wiring::Tied(value)));
        self
    }

    /// Name of the part.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its ports, without `clk`.
    pub fn ports(&self) -> &[Port] {
        &self.ports
    }

    fn wiring_of(&self, port: &Port) -> Wiring {
        let own = self.wiring.iter().find(|(name, _)| *name == port.name);
        own.map_or_else(|| Wiring::Net(port.name.clone()), |(_, wiring)| wiring.clone())
    }
}

/// Connection of a port of a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Connection {
    /// The net with this index in [`Composition::nets`].
    Net(usize),
    /// A constant.
    Tied(u64),
}

/// A net: its driver's name, width and sign, and its users.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Net {
    /// Port of the driver, which is an input of the whole or an output of a part, with the name of the net.
    pub port: Port,
    /// Part and index of the output that drives it; `None` for an input of the whole.
    pub driver: Option<(usize, usize)>,
    /// Whether a part reads it.
    pub is_read: bool,
    /// Whether it is an output of the whole.
    pub is_output: bool,
}

/// Why parts cannot be joined. Each is an error of a composition in this project, never of its user.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CompositionError {
    /// The wiring names a port that the part does not have, or names a port twice.
    #[error("the part `{part}` has no unconnected port `{port}`: correct the name, or connect it only once")]
    NoSuchPort {
        /// Name of the part.
        part: String,
        /// Name of the port.
        port: String,
    },
    /// Two parts have the same name.
    #[error("two parts are called `{0}`: rename one")]
    PartTwice(String),
    /// An output is tied to a constant, or the constant does not fit the port.
    #[error("`{part}.{port}` cannot be tied to {value}: only an input can, to a value of its width")]
    Tied {
        /// Name of the part.
        part: String,
        /// Name of the port.
        port: String,
        /// The constant.
        value: u64,
    },
    /// A net has two drivers.
    #[error("the net `{net}` is driven by `{part}.{port}` and by something else: put one of them on another net")]
    TwoDrivers {
        /// Name of the net.
        net: String,
        /// Part of the second driver.
        part: String,
        /// Port of the second driver.
        port: String,
    },
    /// An input is on a net that nothing drives.
    #[error(
        "nothing drives the net `{net}` that `{part}.{port}` reads: list it as an input, or name a net that is driven"
    )]
    Undriven {
        /// Name of the net.
        net: String,
        /// Name of the part that reads it.
        part: String,
        /// Name of the port that reads it.
        port: String,
    },
    /// An input differs from its net in width or sign.
    #[error("`{part}.{port}` has other bits than the net `{net}` (width or sign): they must be equal")]
    Type {
        /// Name of the net.
        net: String,
        /// Name of the part.
        part: String,
        /// Name of the port.
        port: String,
    },
    /// No part reads an input of the whole, or no part drives an output.
    #[error("`{0}` cannot be a port of the whole: an input must be read, an output driven by a part; remove it")]
    NoSuchNet(String),
}

/// Parts with their connections.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Composition {
    parts: Vec<Part>,
    nets: Vec<Net>,
    connections: Vec<Vec<Connection>>,
    ports: Vec<Port>,
}

impl Composition {
    /// Joins the parts. `inputs` and `outputs` name the nets that are ports of the whole, in order; an input has the
    /// width and sign of the first port that reads it.
    ///
    /// # Errors
    /// [`CompositionError`] for nets with no driver or two, ports of different types, and names that do not exist.
    pub fn new(parts: Vec<Part>, inputs: &[&str], outputs: &[&str]) -> Result<Self, CompositionError> {
        check_wiring(&parts)?;
        let mut nets = Vec::new();
        for name in inputs {
            nets.push(input_net(&parts, name)?);
        }
        for (at, part) in parts.iter().enumerate() {
            let driven = part.ports.iter().filter(|port| port.direction == Direction::Output);
            for (output, port) in driven.enumerate() {
                let Wiring::Net(name) = part.wiring_of(port) else {
                    continue;
                };
                if nets.iter().any(|net: &Net| net.port.name == name) {
                    return Err(CompositionError::TwoDrivers {
                        net: name,
                        part: part.name.clone(),
                        port: port.name.clone(),
                    });
                }
                nets.push(Net {
                    is_output: outputs.contains(&name.as_str()),
                    port: Port { name, ..port.clone() },
                    driver: Some((at, output)),
                    is_read: false,
                });
            }
        }
        let mut connections = Vec::new();
        for part in &parts {
            let of_part = part.ports.iter().map(|port| connect(part, port, &mut nets));
            connections.push(of_part.collect::<Result<Vec<_>, _>>()?);
        }
        let mut ports: Vec<Port> = nets.iter().take(inputs.len()).map(|net| net.port.clone()).collect();
        for name in outputs {
            let net = nets.iter().find(|net| net.port.name == *name && net.driver.is_some());
            let Some(net) = net.filter(|_| ports.iter().all(|port| port.name != *name)) else {
                return Err(CompositionError::NoSuchNet((*name).to_owned()));
            };
            ports.push(net.port.clone());
        }
        Ok(Self {
            parts,
            nets,
            connections,
            ports,
        })
    }

    /// The parts.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// The nets; the inputs of the whole come first.
    pub fn nets(&self) -> &[Net] {
        &self.nets
    }

    /// The connection of each port of each part, in the order of the parts and of their ports.
    pub fn connections(&self) -> &[Vec<Connection>] {
        &self.connections
    }

    /// The ports of the whole, without `clk`: inputs, then outputs, as they were named.
    pub fn ports(&self) -> &[Port] {
        &self.ports
    }
}

fn check_wiring(parts: &[Part]) -> Result<(), CompositionError> {
    for (at, part) in parts.iter().enumerate() {
        if parts[..at].iter().any(|other| other.name == part.name) {
            return Err(CompositionError::PartTwice(part.name.clone()));
        }
        for (place, (name, wiring)) in part.wiring.iter().enumerate() {
            let port = part.ports.iter().find(|port| port.name == *name);
            let twice = part.wiring[..place].iter().any(|(other, _)| other == name);
            let Some(port) = port.filter(|_| !twice) else {
                return Err(CompositionError::NoSuchPort {
                    part: part.name.clone(),
                    port: name.clone(),
                });
            };
            if let Wiring::Tied(value) = wiring {
                let fits = *value <= u64::MAX >> (64 - port.width.clamp(1, 64));
                if port.direction == Direction::Output || !fits {
                    return Err(CompositionError::Tied {
                        part: part.name.clone(),
                        port: name.clone(),
                        value: *value,
                    });
                }
            }
        }
    }
    Ok(())
}

/// The input `name` of the whole, with the type of the first port that reads it.
fn input_net(parts: &[Part], name: &str) -> Result<Net, CompositionError> {
    let reads = |part: &&Part, port: &&Port| {
        port.direction == Direction::Input && part.wiring_of(port) == Wiring::Net(name.to_owned())
    };
    let mut ports = parts
        .iter()
        .flat_map(|part| part.ports.iter().filter(move |port| reads(&part, port)));
    let first = ports
        .next()
        .ok_or_else(|| CompositionError::NoSuchNet(name.to_owned()))?;
    Ok(Net {
        port: Port {
            name: name.to_owned(),
            ..first.clone()
        },
        driver: None,
        is_read: true,
        is_output: false,
    })
}

fn connect(part: &Part, port: &Port, nets: &mut [Net]) -> Result<Connection, CompositionError> {
    let name = match part.wiring_of(port) {
        Wiring::Tied(value) => return Ok(Connection::Tied(value)),
        Wiring::Net(name) => name,
    };
    let Some(at) = nets.iter().position(|net| net.port.name == name) else {
        return Err(CompositionError::Undriven {
            net: name,
            part: part.name.clone(),
            port: port.name.clone(),
        });
    };
    if (nets[at].port.width, nets[at].port.signed) != (port.width, port.signed) {
        return Err(CompositionError::Type {
            net: name,
            part: part.name.clone(),
            port: port.name.clone(),
        });
    }
    nets[at].is_read |= port.direction == Direction::Input;
    Ok(Connection::Net(at))
}
