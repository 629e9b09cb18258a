//! The two netlists: cells by place, and what drives their nets.

use crate::BitstreamError;
use crate::boards::FpgaBoard;
use crate::ice40::{CarryCell, CellOutput, CellPlace, IceboxNetlist, LutCell, MemoryCell};
use crate::network::{HIGH, LOW, NetIndex};
use crate::report::CellsReport;
use serde_json::Value;
use std::collections::{HashMap, HashSet};
use std::fmt;

/// What drives a net.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Driver {
    Constant(bool),
    /// Output of a logic cell.
    Cell(CellPlace),
    /// Carry of a logic cell.
    Carry(CellPlace),
    /// A bit of a memory's read port.
    Memory(CellPlace, u8),
    /// An input pin.
    Pin(&'static str),
}

impl fmt::Display for Driver {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Constant(level) => write!(f, "{}", u8::from(*level)),
            Self::Cell(place) => write!(f, "{place}"),
            Self::Carry(place) => write!(f, "the carry of {place}"),
            Self::Memory(place, bit) => write!(f, "bit {bit} of the memory {place}"),
            Self::Pin(pin) => write!(f, "pin {pin}"),
        }
    }
}

/// The router's netlist: cells by place, and what drives its nets.
pub(super) struct RoutedNetlist<'a> {
    pub(super) logic: Vec<(CellPlace, &'a Value)>,
    pub(super) memories: Vec<(CellPlace, &'a Value)>,
    pub(super) outputs: Vec<(&'static str, &'a Value)>,
    drivers: HashMap<u64, Driver>,
}

impl<'a> RoutedNetlist<'a> {
    pub(super) fn read(module: &'a Value, board: &FpgaBoard) -> Result<Self, BitstreamError> {
        let unreadable = |reason: &str| BitstreamError::Unreadable {
            tool: "nextpnr-ice40",
            reason: reason.to_owned(),
        };
        let mut netlist = Self {
            logic: Vec::new(),
            memories: Vec::new(),
            outputs: Vec::new(),
            drivers: HashMap::new(),
        };
        let port_pins = board
            .pins()
            .map(|(port, pin)| (module["ports"][port]["bits"][0].as_u64(), pin.pin));
        let cells = module["cells"].as_object().ok_or_else(|| unreadable("no cells"))?;
        let mut buffers = Vec::new();
        for (name, cell) in cells {
            let connections = &cell["connections"];
            let mut drive = |port: &str, driver| {
                if let Some(net) = connections[port][0].as_u64() {
                    netlist.drivers.insert(net, driver);
                }
            };
            let place =
                || place(&cell["attributes"]["NEXTPNR_BEL"]).ok_or_else(|| unreadable(&format!("no place of {name}")));
            match cell["type"].as_str() {
                Some("ICESTORM_LC") => {
                    let place = place()?;
                    drive("O", Driver::Cell(place));
                    drive("COUT", Driver::Carry(place));
                    netlist.logic.push((place, cell));
                }
                Some("ICESTORM_RAM") => {
                    let place = place()?;
                    for bit in 0..16 {
                        drive(&format!("RDATA_{bit}"), Driver::Memory(place, bit));
                    }
                    netlist.memories.push((place, cell));
                }
                Some("SB_IO") => {
                    let net = connections["PACKAGE_PIN"][0].as_u64();
                    let pin = port_pins.iter().find(|(of, _)| *of == net && net.is_some());
                    let (_, pin) = pin.ok_or_else(|| unreadable(&format!("{name} is at no pin of the constraints")))?;
                    drive("D_IN_0", Driver::Pin(pin));
                    if connections["D_OUT_0"][0].is_u64() {
                        netlist.outputs.push((pin, &connections["D_OUT_0"]));
                    }
                }
                Some("SB_GB") => buffers.push(connections),
                other => {
                    return Err(BitstreamError::UnknownCell(format!(
                        "{name} of type {other:?} in the router's netlist"
                    )));
                }
            }
        }
        for connections in buffers {
            let nets =
                ["USER_SIGNAL_TO_GLOBAL_BUFFER", "GLOBAL_BUFFER_OUTPUT"].map(|port| connections[port][0].as_u64());
            if let [Some(from), Some(to)] = nets
                && let Some(driver) = netlist.drivers.get(&from).copied()
            {
                netlist.drivers.insert(to, driver);
            }
        }
        Ok(netlist)
    }

    /// What drives the net of a port; `None` if the port is not connected, or nothing is known.
    pub(super) fn driver(&self, connection: &Value) -> Option<Driver> {
        match &connection[0] {
            Value::String(constant) if constant == "0" => Some(Driver::Constant(false)),
            Value::String(constant) if constant == "1" => Some(Driver::Constant(true)),
            net => self.drivers.get(&net.as_u64()?).copied(),
        }
    }

    /// The same, with the level of a port that is not connected. The router connects no port whose net is open or has no driver; if the bits
    /// drive it, that is a difference.
    pub(super) fn driver_or(&self, cell: &Value, port: &str, level: bool) -> Option<Driver> {
        self.driver(&cell["connections"][port])
            .or(Some(Driver::Constant(level)))
    }
}

/// The netlist of the bits: cells by place, and what drives its nets.
pub(super) struct ReadBack<'a> {
    drivers: HashMap<NetIndex, Driver>,
    pub(super) luts: HashMap<CellPlace, &'a LutCell>,
    pub(super) cells: HashMap<CellPlace, &'a CellOutput>,
    pub(super) carries: HashMap<CellPlace, &'a CarryCell>,
    pub(super) memories: HashMap<CellPlace, &'a MemoryCell>,
}

impl<'a> ReadBack<'a> {
    pub(super) fn new(
        bits: &'a IceboxNetlist,
        routed: &RoutedNetlist<'_>,
        board: &FpgaBoard,
        report: &mut CellsReport,
    ) -> Self {
        let mut drivers = HashMap::from([(LOW, Driver::Constant(false)), (HIGH, Driver::Constant(true))]);
        drivers.extend(bits.cells.iter().map(|cell| (cell.output, Driver::Cell(cell.place))));
        drivers.extend(
            bits.carries
                .iter()
                .map(|carry| (carry.output, Driver::Carry(carry.place))),
        );
        for memory in &bits.memories {
            let nets = memory.port("RDATA").iter().zip(0..);
            drivers.extend(nets.map(|(net, bit)| (*net, Driver::Memory(memory.place, bit))));
        }
        for (_, pin) in board.pins() {
            let nets = bits.inputs.iter().filter(|(name, _)| name == pin.pin);
            drivers.extend(nets.map(|(_, net)| (*net, Driver::Pin(pin.pin))));
        }
        let known: HashSet<CellPlace> = routed.logic.iter().map(|(place, _)| *place).collect();
        let cells: HashMap<CellPlace, &CellOutput> = bits.cells.iter().map(|cell| (cell.place, cell)).collect();
        // The router passes nets through cells that its netlist does not have; nothing else may be there.
        let mut aliases = bits.joins.clone();
        for lut in bits.luts.iter().filter(|lut| !known.contains(&lut.place)) {
            let cell = cells.get(&lut.place).filter(|cell| cell.flop.is_none());
            match (cell, lut.inputs.as_slice(), lut.table) {
                (Some(cell), [input], 0b10) => {
                    report.passed_through += 1;
                    aliases.push((cell.output, *input));
                }
                (Some(_), [], 0) => {}
                _ => report.differs(format!("{}: a logic cell only in the bits", lut.place)),
            }
        }
        for cell in bits
            .cells
            .iter()
            .filter(|cell| cell.flop.is_some() && !known.contains(&cell.place))
        {
            report.differs(format!("{}: a flip-flop only in the bits", cell.place));
        }
        let has_carry = |place| {
            routed
                .logic
                .iter()
                .any(|(at, cell)| *at == place && is_set(cell, "CARRY_ENABLE"))
        };
        for carry in bits.carries.iter().filter(|carry| !has_carry(carry.place)) {
            report.differs(format!("{}: a carry only in the bits", carry.place));
        }
        for memory in bits
            .memories
            .iter()
            .filter(|memory| routed.memories.iter().all(|(at, _)| *at != memory.place))
        {
            report.differs(format!("{}: a memory only in the bits", memory.place));
        }
        // A chain of aliases is at most as long as their number.
        for _ in 0..aliases.len() {
            let known = drivers.len();
            let mut changed = false;
            for (output, input) in &aliases {
                if let Some(driver) = drivers.get(input).copied() {
                    changed |= drivers.insert(*output, driver) != Some(driver);
                }
            }
            if !changed && drivers.len() == known {
                break;
            }
        }
        Self {
            drivers,
            luts: bits.luts.iter().map(|lut| (lut.place, lut)).collect(),
            cells,
            carries: bits.carries.iter().map(|carry| (carry.place, carry)).collect(),
            memories: bits.memories.iter().map(|memory| (memory.place, memory)).collect(),
        }
    }

    pub(super) fn driver(&self, net: NetIndex) -> Option<Driver> {
        self.drivers.get(&net).copied()
    }
}

/// `X12/Y3/lc5`, or `X6/Y3/ram`.
fn place(bel: &Value) -> Option<CellPlace> {
    let mut parts = bel.as_str()?.split('/');
    let mut number = |letter: char| parts.next()?.strip_prefix(letter)?.parse().ok();
    let (x, y) = (number('X')?, number('Y')?);
    let cell = match parts.next()? {
        "ram" => 0,
        cell => cell.strip_prefix("lc")?.parse().ok()?,
    };
    Some(CellPlace { x, y, cell })
}

/// The bits of a parameter, lowest first; those that are open are 0.
pub(super) fn parameter(cell: &Value, name: &str) -> Vec<bool> {
    match &cell["parameters"][name] {
        Value::String(bits) => bits.trim().bytes().rev().map(|bit| bit == b'1').collect(),
        Value::Number(number) => (0..64)
            .map(|bit| number.as_u64().unwrap_or(0) >> bit & 1 == 1)
            .collect(),
        _ => Vec::new(),
    }
}

pub(super) fn is_set(cell: &Value, name: &str) -> bool {
    parameter(cell, name).contains(&true)
}
