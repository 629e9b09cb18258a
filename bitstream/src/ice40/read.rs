//! Reads the Verilog of icebox_vlog.

use super::netlist::{CarryCell, CellOutput, CellPlace, Flop, IceboxNetlist, LutCell, MEMORY_WORDS, MemoryCell};
use crate::BitstreamError;
use crate::network::{HIGH, LOW, NetIndex};
use std::collections::HashMap;

impl IceboxNetlist {
    /// Reads the output of `icebox_vlog -s -S -l`.
    ///
    /// # Errors
    /// [`BitstreamError::UnknownCell`] with the first line that is not of the known form.
    pub fn read(text: &str) -> Result<Self, BitstreamError> {
        let mut reader = Reader::default();
        for constant in ["1'b0", "1'b1"] {
            reader.net(constant);
        }
        let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
        while let Some(line) = lines.next() {
            let known = match line.split_whitespace().next() {
                Some("wire" | "endmodule") => Some(()),
                // All registers are 0 at power-up.
                Some("reg") => line
                    .split(',')
                    .all(|one| one.trim_end_matches(';').ends_with("= 0"))
                    .then_some(()),
                Some("module") => reader.module(line),
                Some("assign") => reader.assign(line),
                Some("/*") => reader.cell(line),
                Some("SB_RAM40_4K") => reader.memory(&mut lines),
                _ => None,
            };
            known.ok_or_else(|| BitstreamError::UnknownCell(line.to_owned()))?;
        }
        Ok(reader.netlist)
    }
}

#[derive(Default)]
struct Reader {
    netlist: IceboxNetlist,
    nets: HashMap<String, NetIndex>,
}

impl Reader {
    fn net(&mut self, name: &str) -> NetIndex {
        let name = match name {
            "0" => "1'b0",
            "1" => "1'b1",
            name => name,
        };
        if let Some(net) = self.nets.get(name) {
            return *net;
        }
        let net = self.netlist.names.len() as NetIndex;
        self.netlist.names.push(name.to_owned());
        self.nets.insert(name.to_owned(), net);
        net
    }

    /// A net or a constant, and nothing else.
    fn operand(&mut self, word: &str) -> Option<NetIndex> {
        let word = word.trim();
        let is_name = word.starts_with(|c: char| c.is_ascii_alphabetic());
        let is_plain = word.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_');
        ((is_name && is_plain) || ["0", "1", "1'b0", "1'b1"].contains(&word)).then(|| self.net(word))
    }

    /// `module chip (input pin_35, output pin_9);`
    fn module(&mut self, line: &str) -> Option<()> {
        let ports = line.split_once('(')?.1.strip_suffix(");")?;
        for port in ports.split(',') {
            let (direction, name) = port.trim().split_once(' ')?;
            let pin = name.strip_prefix("pin_")?.to_owned();
            let net = self.operand(name)?;
            match direction {
                "input" => self.netlist.inputs.push((pin, net)),
                "output" => self.netlist.outputs.push((pin, net)),
                _ => return None,
            }
        }
        Some(())
    }

    /// `assign n1 = /* LUT x y z */ …;`, the same with CARRY, or `assign n1 = n2;`
    fn assign(&mut self, line: &str) -> Option<()> {
        let (left, right) = line.strip_prefix("assign ")?.strip_suffix(';')?.split_once(" = ")?;
        let output = self.operand(left)?;
        let Some((comment, value)) = commented(right) else {
            let value = self.operand(right)?;
            self.netlist.joins.push((output, value));
            return Some(());
        };
        match comment {
            ("LUT", place) => {
                let (inputs, table) = self.table(value)?;
                self.netlist.luts.push(LutCell {
                    place,
                    output,
                    inputs,
                    table,
                });
            }
            ("CARRY", place) => {
                // (a & b) | ((a | b) & c)
                let (first, rest) = value.strip_prefix('(')?.split_once(") | ((")?;
                let (a, b) = first.split_once(" & ")?;
                let (either, c) = rest.split_once(") & ")?;
                (either == format!("{a} | {b}")).then_some(())?;
                let inputs = [self.operand(a)?, self.operand(b)?, self.operand(c.strip_suffix(')')?)?];
                self.netlist.carries.push(CarryCell { place, output, inputs });
            }
            _ => return None,
        }
        Some(())
    }

    /// `/* FF x y z */ assign q = d;` or `/* FF x y z */ always @(posedge clk) if (en) q <= sr ? 1'b0 : d;`
    fn cell(&mut self, line: &str) -> Option<()> {
        let (("FF", place), statement) = commented(line)? else {
            return None;
        };
        let statement = statement.strip_suffix(';')?;
        if let Some(assign) = statement.strip_prefix("assign ") {
            let (output, data) = assign.split_once(" = ")?;
            let (output, data) = (self.operand(output)?, self.operand(data)?);
            self.netlist.cells.push(CellOutput {
                place,
                output,
                data,
                flop: None,
            });
            return Some(());
        }
        let (clock, rest) = statement.strip_prefix("always @(posedge ")?.split_once(") if (")?;
        let (enable, rest) = rest.split_once(") ")?;
        let (output, rest) = rest.split_once(" <= ")?;
        let (reset, rest) = rest.split_once(" ? ")?;
        let (reset_to, data) = rest.split_once(" : ")?;
        let reset_to = match reset_to {
            "1'b0" => false,
            "1'b1" => true,
            _ => return None,
        };
        let flop = Flop {
            clock: self.operand(clock)?,
            enable: self.operand(enable)?,
            reset: self.operand(reset)?,
            reset_to,
        };
        let (output, data) = (self.operand(output)?, self.operand(data)?);
        self.netlist.cells.push(CellOutput {
            place,
            output,
            data,
            flop: Some(flop),
        });
        Some(())
    }

    /// The lines after `SB_RAM40_4K #(`, up to `);`.
    fn memory<'a>(&mut self, lines: &mut impl Iterator<Item = &'a str>) -> Option<()> {
        let mut memory = MemoryCell {
            place: CellPlace { x: 0, y: 0, cell: 0 },
            write_mode: 0,
            read_mode: 0,
            contents: vec![0; MEMORY_WORDS],
            ports: HashMap::new(),
        };
        loop {
            let line = lines.next()?;
            if line == ");" {
                break;
            }
            if let Some(place) = line.strip_prefix(") ram40_") {
                let (x, y) = place.strip_suffix(" (")?.split_once('_')?;
                memory.place = CellPlace {
                    x: x.parse().ok()?,
                    y: y.parse().ok()?,
                    cell: 0,
                };
                continue;
            }
            let (name, value) = line
                .strip_prefix('.')?
                .trim_end_matches(',')
                .strip_suffix(')')?
                .split_once('(')?;
            match name {
                "READ_MODE" => memory.read_mode = value.parse().ok()?,
                "WRITE_MODE" => memory.write_mode = value.parse().ok()?,
                _ if name.starts_with("INIT_") => {
                    let row = usize::from_str_radix(&name[5..], 16).ok()?;
                    let digits = value.strip_prefix("256'h")?;
                    for (word, at) in (0..16).zip((0..digits.len()).step_by(4).rev()) {
                        *memory.contents.get_mut(16 * row + word)? =
                            u16::from_str_radix(digits.get(at..at + 4)?, 16).ok()?;
                    }
                }
                _ => {
                    let list = value
                        .strip_prefix('{')
                        .and_then(|list| list.strip_suffix('}'))
                        .unwrap_or(value);
                    let nets: Option<Vec<NetIndex>> = list.split(',').rev().map(|word| self.operand(word)).collect();
                    memory.ports.insert(name.to_owned(), nets?);
                }
            }
        }
        let widths = [("WADDR", 11), ("RADDR", 11), ("MASK", 16), ("WDATA", 16), ("RDATA", 16)];
        let single = ["WE", "WCLKE", "WCLK", "RE", "RCLKE", "RCLK"].map(|name| (name, 1));
        let complete = widths
            .iter()
            .chain(&single)
            .all(|(name, width)| memory.port(name).len() == *width);
        let is_known = complete && memory.ports.len() == widths.len() + single.len() && memory.read_mode < 4;
        (is_known && memory.write_mode < 4).then(|| self.netlist.memories.push(memory))
    }

    /// The nets of an expression, and its values for all their levels.
    fn table(&mut self, text: &str) -> Option<(Vec<NetIndex>, u16)> {
        let mut nets = Vec::new();
        let (tree, rest) = self.expression(text, &mut nets)?;
        if !rest.is_empty() || nets.len() > 4 {
            return None;
        }
        let value = |levels: u16| tree.value(&|index| levels >> index & 1 == 1);
        let table = (0..1 << nets.len())
            .filter(|levels| value(*levels))
            .fold(0, |table, levels| table | 1 << levels);
        Some((nets, table))
    }

    /// `(n1 ? A : B)`, `!n1`, `n1`, or a constant; returns what follows it.
    fn expression<'a>(&mut self, text: &'a str, nets: &mut Vec<NetIndex>) -> Option<(Expression, &'a str)> {
        if let Some(choice) = text.strip_prefix('(') {
            let (condition, rest) = choice.split_once(" ? ")?;
            let condition = self.operand(condition)?;
            let index = index_of(condition, nets);
            let (high, rest) = self.expression(rest, nets)?;
            let (low, rest) = self.expression(rest.strip_prefix(" : ")?, nets)?;
            let choice = Expression::Choice(index, Box::new([low, high]));
            return Some((choice, rest.strip_prefix(')')?));
        }
        let (inverted, text) = text.strip_prefix('!').map_or((false, text), |rest| (true, rest));
        let end = text.find([' ', ')']).unwrap_or(text.len());
        let (word, rest) = text.split_at(end);
        let net = self.operand(word)?;
        let leaf = match net {
            LOW | HIGH if inverted => return None,
            LOW => Expression::Constant(false),
            HIGH => Expression::Constant(true),
            net => Expression::Net(index_of(net, nets), inverted),
        };
        Some((leaf, rest))
    }
}

fn index_of(net: NetIndex, nets: &mut Vec<NetIndex>) -> usize {
    nets.iter().position(|other| *other == net).unwrap_or_else(|| {
        nets.push(net);
        nets.len() - 1
    })
}

/// `/* WORD x y z */` at the beginning, and what follows it.
fn commented(text: &str) -> Option<((&str, CellPlace), &str)> {
    let (comment, rest) = text.strip_prefix("/*")?.split_once("*/")?;
    let words: Vec<&str> = comment.split_whitespace().collect();
    let [what, x, y, cell] = words[..] else {
        return None;
    };
    let place = CellPlace {
        x: x.parse().ok()?,
        y: y.parse().ok()?,
        cell: cell.parse().ok()?,
    };
    Some(((what, place), rest.trim_start()))
}

enum Expression {
    Constant(bool),
    /// A net, by its index, and whether it is inverted.
    Net(usize, bool),
    /// By a net: the values for low and high.
    Choice(usize, Box<[Expression; 2]>),
}

impl Expression {
    fn value(&self, level: &dyn Fn(usize) -> bool) -> bool {
        match self {
            Self::Constant(value) => *value,
            Self::Net(index, inverted) => level(*index) != *inverted,
            Self::Choice(index, values) => values[usize::from(level(*index))].value(level),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SMALL: &str = "\
module chip (input pin_35, input pin_6, output pin_9);
wire n1, n2;
reg n3 = 0, n4 = 0;
assign n1 = 1;
assign n2 = /* LUT    1  2  3 */ (n3 ? (pin_6 ? 1'b1 : !n4) : 1'b0);
assign n5 = /* CARRY  1  2  3 */ (n3 & 1'b0) | ((n3 | 1'b0) & n1);
/* FF  1  2  3 */ always @(posedge pin_35) if (n5) n4 <= n3 ? 1'b1 : n2;
/* FF  1  2  4 */ assign pin_9 = n6;
endmodule
";

    #[test]
    fn cells_are_read_with_their_places() {
        let netlist = IceboxNetlist::read(SMALL).unwrap();
        let lut = &netlist.luts[0];
        assert_eq!(lut.place, CellPlace { x: 1, y: 2, cell: 3 });
        let names: Vec<&str> = lut
            .inputs
            .iter()
            .map(|net| netlist.names[*net as usize].as_str())
            .collect();
        // n3 and (pin_6 or not n4), with n3 as bit 0.
        assert_eq!((names, lut.table), (vec!["n3", "pin_6", "n4"], 0b1000_1010));
        assert_eq!(netlist.carries[0].inputs[1], LOW);
        assert!(netlist.cells[0].flop.unwrap().reset_to && netlist.cells[1].flop.is_none());
    }

    #[test]
    fn what_is_not_known_is_refused_by_its_line() {
        for (from, to) in [
            ("@(posedge pin_35)", "@(negedge pin_35)"),
            ("@(posedge pin_35)", "@(posedge pin_35, posedge n3)"),
            ("reg n3 = 0", "reg n3 = 1"),
            ("endmodule", "// IO Cell (1, 0, 0)\nendmodule"),
            ("endmodule", "SB_PLL40_CORE #(\nendmodule"),
            ("(n3 & 1'b0)", "(n3 ^ 1'b0)"),
            ("output pin_9", "inout pin_9"),
        ] {
            let text = SMALL.replace(from, to);
            assert_ne!(text, SMALL);
            let error = IceboxNetlist::read(&text).unwrap_err();
            assert!(matches!(error, BitstreamError::UnknownCell(_)), "{to}: {error}");
        }
    }
}
