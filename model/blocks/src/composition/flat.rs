//! Flattens a composition whose parts are compositions.

use super::{Composition, Connection, Net, Part, Port};
use crate::Direction;

impl Composition {
    /// Replaces parts by their own parts: `inner` has the composition of every part, or `None` for a block. Parts and
    /// nets of the whole keep their names; those inside are prefixed with the part's name. The nets of the whole keep
    /// their indices.
    ///
    /// An inner composition has the ports of its part, in the same order.
    #[must_use]
    pub fn flattened(&self, inner: &[Option<Composition>]) -> Self {
        let mut flat = Self {
            parts: Vec::new(),
            nets: self.nets.clone(),
            connections: Vec::new(),
            ports: self.ports.clone(),
        };
        for ((part, connections), inner) in self.parts.iter().zip(&self.connections).zip(inner) {
            match inner {
                None => flat.add_part(part.clone(), connections.clone()),
                Some(inner) => flat.add_composition(part, connections, inner),
            }
        }
        flat
    }

    fn add_composition(&mut self, part: &Part, connections: &[Connection], inner: &Composition) {
        let place = |net: &Net| inner.ports.iter().position(|port| port.name == net.port.name);
        let outside: Vec<Connection> = inner
            .nets
            .iter()
            .map(|net| place(net).map_or_else(|| self.add_net(part, net), |port| connections[port]))
            .collect();
        for (inside, connections) in inner.parts.iter().zip(&inner.connections) {
            let connections = connections.iter().map(|connection| match connection {
                Connection::Net(net) => outside[*net],
                Connection::Tied(_) => *connection,
            });
            let name = format!("{}_{}", part.name, inside.name);
            self.add_part(Part { name, ..inside.clone() }, connections.collect());
        }
    }

    /// Adds a net from inside a part.
    fn add_net(&mut self, part: &Part, net: &Net) -> Connection {
        let name = format!("{}_{}", part.name, net.port.name);
        self.nets.push(Net {
            port: Port {
                name,
                ..net.port.clone()
            },
            is_output: false,
            ..net.clone()
        });
        Connection::Net(self.nets.len() - 1)
    }

    /// Adds a part, which drives the nets at its outputs.
    fn add_part(&mut self, part: Part, connections: Vec<Connection>) {
        let at = self.parts.len();
        let ports = part.ports.iter().zip(&connections);
        let outputs = ports.filter(|(port, _)| port.direction == Direction::Output);
        for (output, (_, connection)) in outputs.enumerate() {
            if let Connection::Net(net) = connection {
                self.nets[*net].driver = Some((at, output));
            }
        }
        self.parts.push(part);
        self.connections.push(connections);
    }
}
