//! Writes the Verilog that a user copies, or tries first.

use std::fmt::Write;

use super::{Kit, KitShaper, is_input, range};
use posicast_blocks::Port;
use posicast_blocks::axis_shaper::AxisShaperConfig;
use posicast_blocks::cascade;
use posicast_blocks::in_ascii;
use posicast_blocks::shaper::{moving, plain};

/// Connection of a port of the shaper: none, a constant, or the user's signal.
enum Connection {
    Yours,
    Idle,
    Open,
}

fn connection(port: &Port) -> Connection {
    let is_word = |letter: char| port.name == letter.to_string() || port.name.starts_with(&format!("{letter}_"));
    match is_input(port) {
        _ if is_word('x') || is_word('y') => Connection::Yours,
        true => Connection::Idle,
        false => Connection::Open,
    }
}

/// Meaning of a port, from the list of ports.
fn meaning(shaper: &KitShaper<'_>, port: &Port) -> String {
    let list = match shaper.config {
        AxisShaperConfig::Taps(config) if config.motion().is_some() => moving::PORTS,
        AxisShaperConfig::Taps(_) => plain::PORTS,
        AxisShaperConfig::Cascade(_) => cascade::PORTS,
    };
    let of_array = |name: &str| port.name.strip_prefix(name).is_some_and(|index| index.starts_with('_'));
    let row = list
        .iter()
        .find(|row| row.name == port.name || (row.count.is_some() && of_array(row.name)));
    let lines = row.map_or(&[][..], |row| row.meaning);
    let words = lines
        .iter()
        .map(|line| line.trim())
        .collect::<Vec<_>>()
        .join(" ")
        .replace('`', "");
    in_ascii(&words)
}

/// The user's signal at a port: that of the example if it has one.
fn yours(shaper: &KitShaper<'_>, port: &Port) -> String {
    connected(shaper, port).unwrap_or_else(|| format!("{}_{}", shaper.axis, port.name))
}

/// Description of a port with the axis's position; `None` for other ports.
fn position_meaning(kit: &Kit<'_>, shaper: &KitShaper<'_>, port: &Port) -> Option<String> {
    let axis = shaper.axis;
    if port.name == shaper.config.position("x") {
        let fraction = kit.command_fraction;
        return Some(format!(
            "Command of axis {axis}: its position in counts, with {fraction} fraction bits; read at strobe."
        ));
    }
    let holds = port.name == shaper.config.position("y");
    holds.then(|| {
        format!("Shaped command of axis {axis}, in the same format; new when {axis}_valid is high, and holds.")
    })
}

pub(super) fn header(text: &mut String, kit: &Kit<'_>, about: &str) {
    let _ = write!(
        text,
        "// {about}\n//\n// Written by posicast {} for the machine {}.\n\n",
        env!("CARGO_PKG_VERSION"),
        kit.machine,
    );
}

/// Writes an instance of the top, with a line for each port. The wires have the names of the example's ports.
pub(super) fn template(kit: &Kit<'_>) -> String {
    let mut text = String::new();
    header(
        &mut text,
        kit,
        "An instance to copy into a design: connect the ports marked CONNECT and leave the rest unchanged.",
    );
    let _ = writeln!(text, "{} u_{} (", kit.machine, kit.machine);
    let mut lines = vec![
        (
            "clk".to_owned(),
            "clk".to_owned(),
            format!("CONNECT: {} MHz", kit.clock_hz / 1e6),
        ),
        (
            "rst".to_owned(),
            "rst".to_owned(),
            "CONNECT: synchronous reset, active high".to_owned(),
        ),
        (
            "strobe".to_owned(),
            "strobe".to_owned(),
            format!("CONNECT: high for one clock every {} clocks", kit.sample_clocks),
        ),
    ];
    for shaper in kit.shapers {
        for port in shaper.ports() {
            let name = format!("{}_{}", shaper.axis, port.name);
            let (wire, mark, meaning) = match connection(&port) {
                Connection::Yours => (yours(shaper, &port), "CONNECT: ", position_meaning(kit, shaper, &port)),
                Connection::Idle => (format!("{}'d0", port.width), "", None),
                Connection::Open => (String::new(), "", None),
            };
            let meaning = meaning.unwrap_or_else(|| self::meaning(shaper, &port));
            let sign = if port.signed { "signed, " } else { "" };
            let bits = if port.width == 1 { "bit" } else { "bits" };
            let about = format!("{mark}{sign}{} {bits}. {meaning}", port.width);
            lines.push((name, wire, about));
        }
    }
    let name_width = lines.iter().map(|line| line.0.len()).max().unwrap_or(0);
    let wire_width = lines.iter().map(|line| line.1.len()).max().unwrap_or(0);
    let last = lines.len() - 1;
    for (index, (name, wire, about)) in lines.iter().enumerate() {
        let comma = if index == last { ' ' } else { ',' };
        let _ = writeln!(text, "    .{name:<name_width$} ({wire:<wire_width$}){comma} // {about}");
    }
    text.push_str(");\n");
    text
}

/// Writes the module that makes one strobe per sample.
pub(super) fn strobe(kit: &Kit<'_>) -> String {
    let mut text = String::new();
    header(
        &mut text,
        kit,
        "One strobe per sample: high for one clock, every CLOCKS clocks.",
    );
    let _ = write!(
        text,
        "\
`default_nettype none

module {machine}_strobe #(
    parameter [31:0] CLOCKS = 32'd{clocks}
) (
    input  wire clk,
    input  wire rst,
    output reg  strobe
);
    reg [31:0] count;

    always @(posedge clk) begin
        if (rst) begin
            count  <= 32'd0;
            strobe <= 1'b0;
        end else begin
            count  <= (count == CLOCKS - 32'd1) ? 32'd0 : count + 32'd1;
            strobe <= (count == CLOCKS - 32'd1);
        end
    end
endmodule

`default_nettype wire
",
        machine = kit.machine,
        clocks = kit.sample_clocks,
    );
    text
}

fn word(shaper: &KitShaper<'_>) -> String {
    format!("signed [{}:0]", shaper.config.word_bits() - 1)
}

/// Signals of an axis at the example's ports; a cascade has no saturation.
pub(super) fn signals(shaper: &KitShaper<'_>) -> Vec<&'static str> {
    let mut signals = vec!["command", "shaped", "valid", "saturated", "overrun"];
    signals.retain(|signal| shaper.has_taps() || *signal != "saturated");
    signals
}

/// The ports of the axes, a line each.
pub(super) fn ports(kit: &Kit<'_>) -> String {
    let mut text = String::new();
    for shaper in kit.shapers {
        let (axis, word) = (shaper.axis, word(shaper));
        for (index, signal) in signals(shaper).into_iter().enumerate() {
            let _ = match index {
                0 => writeln!(text, "    input  wire {word} {axis}_{signal},"),
                1 => writeln!(text, "    output wire {word} {axis}_{signal},"),
                _ => writeln!(text, "    output wire {axis}_{signal},"),
            };
        }
    }
    text
}

/// Writes the module that joins strobe and shapers.
pub(super) fn example(kit: &Kit<'_>) -> String {
    let machine = kit.machine;
    let mut text = String::new();
    header(
        &mut text,
        kit,
        "Strobe and shapers joined: commands in, shaped commands out, the machine's own tap tables.",
    );
    let _ = write!(
        text,
        "\
`default_nettype none

module {machine}_example #(
    parameter [31:0] SAMPLE_CLOCKS = 32'd{clocks}
) (
    input  wire clk,
    input  wire rst,
",
        clocks = kit.sample_clocks
    );
    text.push_str(&ports(kit));
    let _ = write!(
        text,
        "    output wire strobe
);
    {machine}_strobe #(.CLOCKS(SAMPLE_CLOCKS)) u_strobe (.clk(clk), .rst(rst), .strobe(strobe));
"
    );
    for shaper in kit.shapers {
        let outputs = shaper.ports().into_iter().filter(|port| !is_input(port));
        for port in outputs.filter(|port| connected(shaper, port).is_none()) {
            let _ = writeln!(text, "    wire {}unused_{}_{};", range(&port), shaper.axis, port.name);
        }
    }
    let _ = write!(
        text,
        "\n    {machine} u_shapers (\n        .clk(clk),\n        .rst(rst),\n        .strobe(strobe)"
    );
    for shaper in kit.shapers {
        for port in shaper.ports() {
            let wire = connected(shaper, &port).unwrap_or_else(|| {
                if is_input(&port) {
                    format!("{}'d0", port.width)
                } else {
                    format!("unused_{}_{}", shaper.axis, port.name)
                }
            });
            let _ = write!(text, ",\n        .{}_{}({wire})", shaper.axis, port.name);
        }
    }
    text.push_str("\n    );\nendmodule\n\n`default_nettype wire\n");
    text
}

/// The port of the example to which a port of the shaper is connected.
fn connected(shaper: &KitShaper<'_>, port: &Port) -> Option<String> {
    let axis = shaper.axis;
    match port.name.as_str() {
        name if name == shaper.config.position("x") => Some(format!("{axis}_command")),
        name if name == shaper.config.position("y") => Some(format!("{axis}_shaped")),
        name @ ("valid" | "saturated" | "overrun") => Some(format!("{axis}_{name}")),
        _ => None,
    }
}
