//! A mapped netlist in the format of Yosys's `write_json`.

use std::collections::{BTreeMap, HashMap};

use serde::Deserialize;

#[derive(Debug, Deserialize)]
pub(super) struct Netlist {
    pub(super) modules: HashMap<String, Module>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Module {
    #[serde(default)]
    attributes: HashMap<String, serde_json::Value>,
    #[serde(default)]
    pub(super) ports: BTreeMap<String, Port>,
    pub(super) cells: BTreeMap<String, NetlistCell>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Port {
    pub(super) bits: Vec<Bit>,
}

#[derive(Debug, Deserialize)]
pub(super) struct NetlistCell {
    #[serde(rename = "type")]
    pub(super) kind: String,
    #[serde(default)]
    pub(super) parameters: HashMap<String, serde_json::Value>,
    #[serde(default)]
    pub(super) connections: HashMap<String, Vec<Bit>>,
}

/// Number of a wire, or a constant `0`, `1`, `x`, `z`.
#[derive(Debug, PartialEq, Eq, Hash, Deserialize)]
#[serde(untagged)]
pub(super) enum Bit {
    Wire(u64),
    Constant(String),
}

impl Netlist {
    /// The module with this name, if it belongs to the design and is not a cell of the family.
    pub(super) fn design_module(&self, name: &str) -> Option<&Module> {
        let module = self.modules.get(name)?;
        let is_primitive = ["blackbox", "whitebox"]
            .iter()
            .any(|a| module.attributes.contains_key(*a));
        (!is_primitive).then_some(module)
    }
}
