//! A checked description, and the ports of its bank.

use super::description::{Access, Description, Field, FlagSource, Register, WINDOW_WORDS};
use super::error::MapError;
use crate::{Direction, Port};

/// A checked [`Description`], from which bank, model and documents are made.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RegisterMap {
    description: Description,
    ports: Vec<Port>,
}

impl RegisterMap {
    /// Checks a description.
    ///
    /// # Errors
    /// [`MapError`] for the first inconsistency: names, offsets, reset values, references.
    pub fn new(mut description: Description) -> Result<Self, MapError> {
        description.registers.sort_by_key(|register| register.offset);
        super::check::check(&description)?;
        let ports = ports(&description)?;
        Ok(Self { description, ports })
    }

    /// Name of the component.
    pub fn name(&self) -> &str {
        &self.description.name
    }

    /// Description of the component.
    pub fn about(&self) -> &str {
        &self.description.about
    }

    /// Number of words on the bus, of all windows.
    pub fn words(&self) -> u32 {
        self.description.windows * WINDOW_WORDS
    }

    /// Number of bits of an address.
    pub fn address_bits(&self) -> u32 {
        address_bits(&self.description)
    }

    /// The registers, by offset.
    pub fn registers(&self) -> &[Register] {
        &self.description.registers
    }

    /// Index of the register with this name.
    pub fn index_of(&self, name: &str) -> Option<usize> {
        self.registers().iter().position(|register| register.name == name)
    }

    /// The register with this name.
    pub fn register(&self, name: &str) -> Option<&Register> {
        self.registers().iter().find(|register| register.name == name)
    }

    /// The first register whose access satisfies `holds`.
    pub fn find(&self, holds: impl Fn(&Access) -> bool) -> Option<&Register> {
        self.registers().iter().find(|register| holds(&register.access))
    }

    /// A register's fields: a shadow has those of the register that it freezes.
    pub fn fields<'a>(&'a self, register: &'a Register) -> &'a [Field] {
        match &register.access {
            Access::Shadow { of } => self.register(of).map_or(&[], |live| &live.fields),
            _ => &register.fields,
        }
    }

    /// The bank's ports without `clk`: reset, the Avalon agent, `irq` if there are interrupts, then those of the registers
    /// in their order.
    pub fn ports(&self) -> &[Port] {
        &self.ports
    }
}

/// Number of address bits such that every window has its addresses.
fn address_bits(description: &Description) -> u32 {
    (description.windows * WINDOW_WORDS)
        .next_power_of_two()
        .trailing_zeros()
}

/// The ports of every bank, which come before those of its registers.
fn bus(address_bits: u32) -> Vec<Port> {
    use Direction::{Input, Output};
    [
        ("rst", Input, 1),
        ("avs_address", Input, address_bits),
        ("avs_read", Input, 1),
        ("avs_write", Input, 1),
        ("avs_byteenable", Input, 4),
        ("avs_writedata", Input, 32),
        ("avs_readdata", Output, 32),
    ]
    .map(|(name, direction, width)| port(name, direction, width, false))
    .to_vec()
}

fn port(name: &str, direction: Direction, width: u32, signed: bool) -> Port {
    Port {
        name: name.to_owned(),
        direction,
        width,
        signed,
    }
}

fn ports(description: &Description) -> Result<Vec<Port>, MapError> {
    use Direction::{Input, Output};
    let mut ports = bus(address_bits(description));
    let registers = &description.registers;
    if registers
        .iter()
        .any(|register| register.access == Access::InterruptState)
    {
        ports.push(port("irq", Output, 1, false));
    }
    for register in registers {
        let field_port = |field: &Field, direction| port(&field.name, direction, field.width, field.is_signed());
        let fields = register.fields.iter();
        match &register.access {
            Access::Live => add(&mut ports, register, fields.map(|field| field_port(field, Input)))?,
            Access::Sticky | Access::InterruptState => {
                let from_input = fields.filter(|field| field.source == FlagSource::Input);
                add(&mut ports, register, from_input.map(|field| field_port(field, Input)))?;
            }
            Access::Guarded { while_low } => {
                add(&mut ports, register, [port(while_low, Input, 1, false)])?;
                add(&mut ports, register, fields.map(|field| field_port(field, Output)))?;
            }
            Access::Commit { tick } => add(&mut ports, register, [port(tick, Input, 1, false)])?,
            Access::Command { strobe } => {
                add(&mut ports, register, [port(strobe, Output, 1, false)])?;
                add(&mut ports, register, fields.map(|field| field_port(field, Output)))?;
            }
            Access::Words { strobe, word, words } => {
                let place = port(word, Output, words.trailing_zeros(), false);
                add(&mut ports, register, [port(strobe, Output, 1, false), place])?;
                add(&mut ports, register, fields.map(|field| field_port(field, Output)))?;
            }
            Access::Configuration | Access::Staged => {
                add(&mut ports, register, fields.map(|field| field_port(field, Output)))?;
            }
            Access::Constant
            | Access::Shadow { .. }
            | Access::Snapshot
            | Access::InterruptEnable
            | Access::InterruptTest => {}
        }
    }
    Ok(ports)
}

/// Adds ports. An input may feed several registers; it is then listed where it was named first.
fn add(ports: &mut Vec<Port>, register: &Register, more: impl IntoIterator<Item = Port>) -> Result<(), MapError> {
    for port in more {
        match ports.iter().find(|other| other.name == port.name) {
            None => ports.push(port),
            Some(other) if *other == port && port.direction == Direction::Input => {}
            Some(_) => {
                return Err(MapError::Port {
                    register: register.name.clone(),
                    port: port.name,
                });
            }
        }
    }
    Ok(())
}
