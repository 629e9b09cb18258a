//! The outputs of cells that a netlist of bits depends on, with their nets, whatever the family.

use super::{NetIndex, Network};
use std::collections::{BTreeMap, HashMap};
use std::hash::Hash;

/// The outputs of cells that are in use, with their nets, and those whose cells are still to be decoded.
#[derive(Debug)]
pub(crate) struct OutputNets<O> {
    nets: HashMap<O, NetIndex>,
    waiting: Vec<O>,
}

impl<O: Copy + Eq + Hash + Ord> OutputNets<O> {
    pub(crate) fn new() -> Self {
        Self {
            nets: HashMap::new(),
            waiting: Vec::new(),
        }
    }

    /// The net of an output, whose cell is decoded later; a new net gets the name that `identifier` gives the output.
    pub(crate) fn net(&mut self, network: &mut Network, output: O, identifier: impl FnOnce(O) -> String) -> NetIndex {
        if let Some(net) = self.nets.get(&output) {
            return *net;
        }
        let net = network.new_net(identifier(output));
        self.nets.insert(output, net);
        self.waiting.push(output);
        net
    }

    /// An output whose cell is still to be decoded; `None` at the end.
    pub(crate) fn next(&mut self) -> Option<O> {
        self.waiting.pop()
    }

    /// An output in use that nothing in the network drives.
    pub(crate) fn undriven(&self, network: &Network) -> Option<O> {
        let driven = network.driven();
        let mut nets = self.nets.iter();
        nets.find(|(_, net)| !driven.contains(net)).map(|(output, _)| *output)
    }

    /// All outputs in use.
    pub(crate) fn into_sorted(self) -> BTreeMap<O, NetIndex> {
        self.nets.into_iter().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::{Gate, HIGH};

    #[test]
    fn each_output_has_one_net_and_waits_once() {
        let (mut network, mut outputs) = (Network::of_constants(), OutputNets::new());
        let name = |output: u8| format!("q{output}");
        let first = outputs.net(&mut network, 7, name);
        assert_eq!(outputs.net(&mut network, 7, name), first);
        let second = outputs.net(&mut network, 3, name);
        assert_eq!(network.names[2..], ["q7", "q3"]);
        assert_eq!(
            [outputs.next(), outputs.next(), outputs.next()],
            [Some(3), Some(7), None]
        );
        network.gates.push(Gate::wire(first, HIGH));
        assert_eq!(outputs.undriven(&network), Some(3));
        network.gates.push(Gate::wire(second, HIGH));
        assert_eq!(outputs.undriven(&network), None);
        assert_eq!(outputs.into_sorted(), BTreeMap::from([(3, second), (7, first)]));
    }
}
