//! A register prepared for the interpreter: indices of inputs instead of names.

use crate::Direction;
use crate::registers::{Access, Field, FlagSource, Register, RegisterMap};

/// Where a field's bits are among the inputs.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wire {
    input: usize,
    low: u32,
    ones: u32,
}

impl Wire {
    pub(super) fn is_on(self, input: usize) -> bool {
        self.input == input
    }

    pub(super) fn bits(self, inputs: &[u64]) -> u32 {
        (inputs[self.input] as u32 & self.ones) << self.low
    }
}

/// A flag that the bank sets itself.
#[derive(Debug, Clone, Copy)]
pub(super) struct OwnFlag {
    pub(super) source: FlagSource,
    pub(super) bit: u32,
}

/// A register prepared for the interpreter.
#[derive(Debug, Clone)]
pub(super) struct Plan {
    pub(super) access: Access,
    /// Mask of the bits that a write reaches.
    pub(super) mask: u32,
    pub(super) reset: u32,
    /// Inputs that are live, or that set flags.
    pub(super) wires: Vec<Wire>,
    pub(super) own_flags: Vec<OwnFlag>,
    /// Mask and smallest value, in place, of the fields that have a minimum.
    pub(super) minima: Vec<(u32, u32)>,
    /// Index of the input that guards the register, or that applies a commit.
    pub(super) gate: usize,
    /// For a shadow the live register; for an interrupt test the state.
    pub(super) refers_to: usize,
}

/// Prepares the register with this index in the map.
pub(super) fn plan(map: &RegisterMap, at: usize) -> Plan {
    let register = &map.registers()[at];
    let inputs: Vec<&str> = {
        let ports = map.ports().iter().filter(|port| port.direction == Direction::Input);
        ports.map(|port| port.name.as_str()).collect()
    };
    // A checked map has all the ports that its registers name.
    let input = |name: &str| inputs.iter().position(|port| *port == name).unwrap_or_default();
    let wire = |field: &Field| Wire {
        input: input(&field.name),
        low: field.low,
        ones: field.ones(),
    };
    let access = &register.access;
    let wired = access.is_sticky() || *access == Access::Live;
    let from_input = register.fields.iter().filter(|field| field.source == FlagSource::Input);
    let own = register.fields.iter().filter(|field| field.source != FlagSource::Input);
    let minima = register.fields.iter().filter(|field| field.minimum > 0);
    Plan {
        mask: register.mask(),
        reset: register.reset(),
        wires: from_input.filter(|_| wired).map(wire).collect(),
        own_flags: own
            .filter(|_| wired)
            .map(|field| OwnFlag {
                source: field.source,
                bit: field.mask(),
            })
            .collect(),
        minima: minima.map(|field| (field.mask(), field.minimum << field.low)).collect(),
        gate: match access {
            Access::Guarded { while_low } => input(while_low),
            Access::Commit { tick } => input(tick),
            _ => 0,
        },
        refers_to: match access {
            Access::Shadow { of } => map.index_of(of).unwrap_or_default(),
            Access::InterruptTest => {
                let state = |r: &Register| r.access == Access::InterruptState;
                map.registers().iter().position(state).unwrap_or_default()
            }
            _ => 0,
        },
        access: access.clone(),
    }
}
