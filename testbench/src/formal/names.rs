//! Reads the peeks of a property file, and writes the top that joins it to its block.

use std::fmt::Write as _;

use posicast_blocks::{Direction, Port};

/// A register inside the block that the properties read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Peek {
    /// Name of the property module's input.
    pub(super) name: String,
    /// Declaration: `signed `, `[9:0] `, or empty.
    kind: String,
    /// Path of the signal inside the block, with points between the instances.
    pub(super) path: String,
}

const MARK: &str = "(* peek = \"";

/// Returns the peeks of a property file, in order. Other lines are ignored.
pub(super) fn peeks(text: &str) -> Vec<Peek> {
    let line = |line: &str| {
        let (path, rest) = line.trim().strip_prefix(MARK)?.split_once("\" *)")?;
        let declared = rest.trim().strip_prefix("input wire ")?;
        let declared = declared.trim().trim_end_matches([',', ';']);
        let (kind, name) = declared.rsplit_once(' ').unwrap_or(("", declared));
        Some(Peek {
            name: name.to_owned(),
            kind: kind.to_owned(),
            path: path.to_owned(),
        })
    };
    text.lines().filter_map(line).collect()
}

/// The ports of a block as inputs behind another one: `, input wire [9:0] steps, …`.
pub(super) fn as_inputs(ports: &[Port]) -> String {
    ports
        .iter()
        .map(|port| format!(", input wire {}", declared(port)))
        .collect()
}

/// A port with its sign and width: `signed [9:0] steps`.
fn declared(port: &Port) -> String {
    let signed = if port.signed { "signed " } else { "" };
    let range = match port.width {
        1 => String::new(),
        width => format!("[{}:0] ", width - 1),
    };
    format!("{signed}{range}{}", port.name)
}

/// Writes `formal_top`: the block and its properties, with every input of the block free.
pub(super) fn formal_top(top: &str, properties: &str, ports: &[Port], peeks: &[Peek]) -> String {
    let of = |direction| ports.iter().filter(move |port| port.direction == direction);
    let mut text = String::from("module formal_top (\n    input wire clk");
    for port in of(Direction::Input) {
        let _ = write!(text, ",\n    input wire {}", declared(port));
    }
    text.push_str("\n);\n");
    for port in of(Direction::Output) {
        let _ = writeln!(text, "    wire {};", declared(port));
    }
    for peek in peeks {
        let _ = writeln!(text, "    (* keep *) wire {} {};", peek.kind, peek.name);
    }
    let _ = writeln!(
        text,
        "    {top} dut (.*);\n    {properties} properties (.*);\nendmodule"
    );
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peeks_are_found_with_their_widths() {
        let text = "    (* peek = \"u_leg.timer\" *)  input wire [9:0] leg_timer,\n    input wire clk,\n\
                    (* peek = \"wanted\" *) input wire       wanted\n";
        let found = peeks(text);
        assert_eq!(found.len(), 2);
        assert_eq!(
            (found[0].path.as_str(), found[0].name.as_str()),
            ("u_leg.timer", "leg_timer")
        );
        assert_eq!((found[1].kind.as_str(), found[1].name.as_str()), ("", "wanted"));
        let top = formal_top("leg", "leg_properties", &[], &found);
        assert!(top.contains("wire [9:0] leg_timer;"), "{top}");
    }
}
