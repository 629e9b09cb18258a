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

/// Induction over one clock, for properties that include the invariants it needs.
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
    /// Whether multipliers are cut out: their outputs are then free in every clock.
    pub(crate) leaves_products_open: bool,
    /// Whether memories are part of the proof, with a register for each word; otherwise their outputs are free in every clock.
    pub(crate) keeps_memories: bool,
    /// Registers with an initial value other than 0, and that value. It lets a proof reach the end of a counter that cannot
    /// be loaded and would take more clocks than the search has.
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

    /// What can have any value in every clock: products where multipliers are cut out, and words read from memories unless the
    /// proof keeps them.
    pub fn left_open(&self) -> Vec<&'static str> {
        let has_memory = self.modules.iter().any(Module::has_memory);
        let products = self.leaves_products_open.then_some("products");
        let memories = (has_memory && !self.keeps_memories).then_some("memories");
        products.into_iter().chain(memories).collect()
    }

    /// Adds macros.
    pub(crate) fn macros(mut self, macros: &[(String, String)]) -> Self {
        for (name, value) in macros {
            let _ = writeln!(self.properties, "`define {name} {value}");
        }
        self
    }

    /// Adds a property file. It is preceded by these macros and by `PORTS`, which declares all ports of the block as inputs.
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

/// Returns a module of a block as a block of its own.
pub(crate) fn part(mut modules: Vec<Module>, name: &str) -> Result<(Vec<Module>, Vec<Port>), Error> {
    let at = modules.iter().position(|module| module.is(name));
    let part = modules.remove(at.ok_or_else(|| refused(format!("the block has no `{name}`")))?);
    let ports = part.ports.clone();
    modules.push(part);
    Ok((modules, ports))
}
