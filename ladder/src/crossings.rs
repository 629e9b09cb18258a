//! Clock-domain crossings of a block: every asynchronous pin, the synchroniser behind it, and what else reads it.
//!
//! ```text
//! pin ─► first flip-flop ─► second flip-flop ─► filters, decoders, …
//!    └─ nothing else   └─ nothing else
//! ```
//!
//! It is checked on the netlist that Yosys makes of the emitted Verilog (flattened, processes turned into flip-flops), pin by pin:
//! every reader of the pin is the data input of a flip-flop, and its output has exactly one reader, again the data input of a
//! flip-flop. Logic before the first or between the two is a finding, and so is a second reader. An inverter is allowed, since it cannot
//! glitch. A pin that several axes share may have a synchroniser in each.
//!
//! This shows the structure. It does not show that the two flip-flops are placed side by side, nor their settling time.

use std::collections::HashMap;
use std::fmt::Write as _;
use std::path::Path;

use posicast_hdl::emit::Module;
use serde_json::Value;

use crate::page::Marks;
use posicast_testbench::Error;
use posicast_testbench::yosys;

/// Marks of the table.
pub const CROSSINGS_MARKS: Marks = Marks {
    begin: "<!-- crossings: written by the example `crossings` -->",
    end: "<!-- end of crossings -->",
};

/// Cells that invert a bit.
const INVERTERS: [&str; 3] = ["$not", "$logic_not", "$_NOT_"];

/// The logic that reads an asynchronous pin.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Crossing {
    /// Name of the pin.
    pub pin: String,
    /// Names of the first flip-flops, without the last part of their path.
    pub synchronisers: Vec<String>,
    /// Number of cells that read the second flip-flops.
    pub readers: usize,
    /// Unexpected readers: logic before a flip-flop, or beside it.
    pub findings: Vec<String>,
}

/// A bit of a cell's input.
struct Reader<'a> {
    cell: &'a str,
    kind: &'a str,
    port: &'a str,
    at: usize,
}

impl Reader<'_> {
    fn is_data(&self) -> bool {
        self.kind.contains("dff") && self.port == "D"
    }

    /// Port, kind and place of the cell. Yosys's number at the end of its name is left out, because it depends on all that was read before.
    fn describe(&self) -> String {
        let name = self.cell.strip_prefix("$flatten").unwrap_or(self.cell);
        let name = name.rsplit_once('$').map_or(name, |(name, _)| name);
        let place = name
            .replace(".$", " ")
            .replace('$', " ")
            .replace('\\', "")
            .replace("u_", "");
        format!("port {} of `{place}`", self.port)
    }
}

/// The netlist: who reads each bit, and the flip-flops' outputs.
struct Netlist<'a> {
    readers: HashMap<u64, Vec<Reader<'a>>>,
    outputs: HashMap<&'a str, Vec<Option<u64>>>,
    /// The longest name of each bit: its place in the hierarchy.
    names: HashMap<u64, &'a str>,
}

fn bits(value: &Value) -> Vec<Option<u64>> {
    let bits = value.as_array().map_or(&[][..], Vec::as_slice);
    bits.iter().map(Value::as_u64).collect()
}

impl<'a> Netlist<'a> {
    fn new(module: &'a Value) -> Self {
        let (mut readers, mut outputs): (HashMap<u64, Vec<Reader<'a>>>, _) = (HashMap::new(), HashMap::new());
        let cells = module["cells"].as_object();
        for (cell, of_cell) in cells.into_iter().flatten() {
            let kind = of_cell["type"].as_str().unwrap_or_default();
            for (port, nets) in of_cell["connections"].as_object().into_iter().flatten() {
                if of_cell["port_directions"][port] == "output" {
                    if matches!(port.as_str(), "Q" | "Y") {
                        outputs.insert(cell.as_str(), bits(nets));
                    }
                    continue;
                }
                for (at, net) in bits(nets).into_iter().enumerate() {
                    let reader = Reader { cell, kind, port, at };
                    readers.entry(net.unwrap_or(0)).or_default().push(reader);
                }
            }
        }
        let mut names: HashMap<u64, &'a str> = HashMap::new();
        for (name, net) in module["netnames"].as_object().into_iter().flatten() {
            let is_hidden = net["hide_name"] == 1;
            for bit in bits(&net["bits"]).into_iter().flatten().filter(|_| !is_hidden) {
                let known = names.entry(bit).or_insert(name);
                if known.matches('.').count() < name.matches('.').count() {
                    *known = name;
                }
            }
        }
        Self {
            readers,
            outputs,
            names,
        }
    }

    fn readers(&self, net: u64) -> &[Reader<'a>] {
        self.readers.get(&net).map_or(&[], Vec::as_slice)
    }

    /// The bit that a flip-flop shows of its data input.
    fn behind(&self, reader: &Reader<'a>) -> Option<u64> {
        self.outputs.get(reader.cell)?.get(reader.at).copied().flatten()
    }

    fn crossing(&self, pin: &str, net: u64) -> Crossing {
        let mut crossing = Crossing {
            pin: pin.to_owned(),
            synchronisers: Vec::new(),
            readers: 0,
            findings: Vec::new(),
        };
        for first in self.readers(net) {
            if INVERTERS.contains(&first.kind)
                && let Some(inverted) = self.behind(first)
            {
                let behind = self.crossing(pin, inverted);
                crossing.synchronisers.extend(behind.synchronisers);
                crossing.readers += behind.readers;
                crossing.findings.extend(behind.findings);
                continue;
            }
            if !first.is_data() {
                crossing
                    .findings
                    .push(format!("the pin is read by {}", first.describe()));
                continue;
            }
            let name = self
                .behind(first)
                .and_then(|net| self.names.get(&net))
                .copied()
                .unwrap_or(first.cell);
            let place = name.rsplit_once('.').map_or(name, |(place, _)| place);
            crossing.synchronisers.push(place.replace("u_", ""));
            let seconds = self.behind(first).map_or(&[][..], |net| self.readers(net));
            match seconds {
                [second] if second.is_data() => {
                    crossing.readers += self.behind(second).map_or(0, |net| self.readers(net).len());
                }
                others => {
                    let readers: Vec<String> = others.iter().map(Reader::describe).collect();
                    let what = format!(
                        "behind the first flip-flop of `{}`: {}",
                        place.replace("u_", ""),
                        readers.join(", ")
                    );
                    crossing.findings.push(what);
                }
            }
        }
        if crossing.synchronisers.is_empty() && crossing.findings.is_empty() {
            crossing.findings.push("nothing reads the pin".to_owned());
        }
        crossing
    }
}

/// Looks behind every input of one bit of the last of these modules that is neither clock nor reset nor of the bus. Files are in
/// `folder`.
///
/// # Errors
/// [`Error::ToolMissing`] without Yosys, [`Error::ToolFailed`] where it refuses the Verilog, [`Error::File`] for the files.
pub fn crossings(modules: &[Module], folder: &Path) -> Result<Vec<Crossing>, Error> {
    let Some(top) = modules.last() else {
        return Ok(Vec::new());
    };
    let write = |name: &str, text: &str| {
        let path = folder.join(name);
        std::fs::write(&path, text).map_err(Error::file(&path, "write"))
    };
    let mut script = String::new();
    for module in modules {
        let file = format!("{}.v", module.name);
        write(&file, &module.text)?;
        let _ = writeln!(script, "read_verilog {file}");
    }
    let _ = writeln!(
        script,
        "hierarchy -check -top {}\nproc\nflatten\nopt_clean\nopt_dff\nopt_clean\nwrite_json netlist.json",
        top.name
    );
    write("crossings.ys", &script)?;
    yosys::run_script(folder, "crossings.ys", "looking behind the pins")?;
    let path = folder.join("netlist.json");
    let text = std::fs::read_to_string(&path).map_err(Error::file(&path, "read"))?;
    let json: Value =
        serde_json::from_str(&text).map_err(|error| Error::Unlike(format!("Yosys's netlist: {error}")))?;
    let module = &json["modules"][&top.name];
    let netlist = Netlist::new(module);
    let pins = module["ports"].as_object().into_iter().flatten();
    let is_pin = |name: &str| !matches!(name, "clk" | "rst") && !name.starts_with("avs_");
    let pins = pins.filter(|(name, port)| port["direction"] == "input" && is_pin(name));
    let bit = |(name, port): (&String, &Value)| match bits(&port["bits"])[..] {
        [Some(net)] => Some(netlist.crossing(name, net)),
        _ => None,
    };
    Ok(pins.filter_map(bit).collect())
}

/// The table of `ladder/RESULTS.md`: pins of axes that have the same are one row.
pub fn crossings_table(crossings: &[Crossing]) -> String {
    let mut text =
        "| pin | synchroniser | reads the second flip-flop | other readers |\n|---|---|---|---|\n".to_owned();
    for crossing in crossings {
        let other = if crossing.findings.is_empty() {
            "none".to_owned()
        } else {
            crossing.findings.join("; ")
        };
        let synchronisers: Vec<String> = crossing.synchronisers.iter().map(|path| format!("`{path}`")).collect();
        // Writing to a `String` cannot fail.
        let _ = writeln!(
            text,
            "| `{}` | {} | {} cells | {other} |",
            crossing.pin,
            synchronisers.join(", "),
            crossing.readers
        );
    }
    text
}
