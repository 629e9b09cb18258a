//! A proof task: block, size, property file, engine.

use std::fmt::Write as _;

use posicast_blocks::Port;
use posicast_hdl::emit::Module;

use super::names::as_inputs;
use crate::Error;

/// Method of proof. Both are unbounded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Engine {
    /// Property-directed reachability, by ABC, which finds its invariants itself.
    Pdr,
    /// Induction over at most this many clocks, by Yosys; invariants are among the properties.
    Induction {
        /// Number of consecutive clocks in which everything is assumed to hold.
        clocks: u32,
    },
}

/// What proofs by induction take: invariants stated so that one clock leads to the next.
pub(crate) const INDUCTION: Engine = Engine::Induction { clocks: 1 };

impl Engine {
    /// Name in a table.
    pub fn name(self) -> &'static str {
        match self {
            Self::Pdr => "PDR (ABC)",
            Self::Induction { .. } => "induction (Yosys)",
        }
    }
}

/// Properties of a block at one size.
#[derive(Debug, Clone)]
pub struct Task {
    /// Name of the block and of its property file.
    pub name: &'static str,
    /// Description of the size.
    pub size: String,
    /// Method of proof.
    pub engine: Engine,
    /// The block's Verilog, the top last. Tests modify it.
    pub modules: Vec<Module>,
    pub(crate) top: String,
    pub(crate) ports: Vec<Port>,
    pub(crate) properties: String,
    /// Whether multipliers are left out: what they give is anything, in every clock.
    pub(crate) leaves_products_open: bool,
    /// Whether memories are in the proof, each word a register; else what is read from one is anything, in every clock.
    pub(crate) keeps_memories: bool,
    /// Registers that begin with another value than 0, with that value. For counters that nothing loads: what comes after
    /// more clocks than can be searched.
    pub(crate) begins: Vec<(&'static str, &'static str)>,
}

impl Task {
    pub(crate) fn new(
        name: &'static str,
        size: &str,
        engine: Engine,
        (modules, ports): (Vec<Module>, Vec<Port>),
    ) -> Self {
        Self {
            name,
            size: size.to_owned(),
            engine,
            top: modules.last().map_or_else(String::new, |top| top.name.clone()),
            modules,
            ports,
            properties: String::new(),
            leaves_products_open: false,
            keeps_memories: false,
            begins: Vec::new(),
        }
    }

    /// With more macros.
    pub(crate) fn macros(mut self, macros: &[(String, String)]) -> Self {
        for (name, value) in macros {
            let _ = writeln!(self.properties, "`define {name} {value}");
        }
        self
    }

    /// With a property file, after macros for this size and `PORTS`, all ports of the block as inputs.
    pub(crate) fn properties(mut self, macros: &[(&str, String)], text: &str) -> Self {
        for (name, value) in macros {
            let _ = writeln!(self.properties, "`define {name} {value}");
        }
        let _ = writeln!(
            self.properties,
            "`define PORTS input wire clk{}",
            as_inputs(&self.ports)
        );
        self.properties.push_str(text);
        self
    }
}

pub(crate) fn refused(error: impl std::fmt::Display) -> Error {
    Error::Option(error.to_string())
}

/// A module of a block as a block of its own.
pub(crate) fn part(mut modules: Vec<Module>, name: &str) -> Result<(Vec<Module>, Vec<Port>), Error> {
    let at = modules.iter().position(|module| module.is(name));
    let part = modules.remove(at.ok_or_else(|| refused(format!("the block has no `{name}`")))?);
    let ports = part.ports.clone();
    modules.push(part);
    Ok((modules, ports))
}
