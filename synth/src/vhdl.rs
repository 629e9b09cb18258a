//! The top modules for a design in VHDL: per module a package with its component declaration and its constants, and an instance
//! to copy.
//!
//! | file | what it is |
//! |---|---|
//! | `vhdl/TOP_pkg.vhd` | the package `TOP_pkg`: the component `TOP`, the word addresses of its registers, the taps of its shapers |
//! | `vhdl/TOP_instance.vhd` | an entity with the same ports that contains one instance: a template |
//!
//! Ports are `std_logic` and `std_logic_vector`; a comment says which words are signed. VHDL does not distinguish capitals, and has
//! reserved words that Verilog lacks: a module that cannot have its name in VHDL is an error.

use std::fmt::Write as _;

use posicast_blocks::registers::RegisterMap;
use posicast_blocks::{Direction, Port};
use posicast_taps::TapTable;

/// Folder of the files.
pub const FOLDER: &str = "vhdl";

/// A top module.
#[derive(Debug, Clone)]
pub struct VhdlTop<'a> {
    /// Name of the module.
    pub name: &'a str,
    /// Its ports without `clk`, in the order of the Verilog.
    pub ports: &'a [Port],
    /// Its registers, if they are on a bus.
    pub map: Option<&'a RegisterMap>,
    /// The tap table of each axis whose shaper is in it, with the axis's name.
    pub tables: Vec<(&'a str, &'a TapTable)>,
    /// Its parameters, whole numbers, with their defaults.
    pub parameters: Vec<(&'a str, u32)>,
}

/// A name that VHDL does not allow.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{name}` is no name in VHDL: {reason}; choose another name for the machine or the axis")]
pub struct VhdlName {
    /// The name.
    pub name: String,
    /// What is wrong with it.
    reason: &'static str,
}

/// Reserved words of VHDL-2008.
const RESERVED: &str = "abs access after alias all and architecture array assert assume assume_guarantee attribute begin block body \
    buffer bus case component configuration constant context cover default disconnect downto else elsif end entity exit fairness file \
    for force function generate generic group guarded if impure in inertial inout is label library linkage literal loop map mod nand \
    new next nor not null of on open or others out package parameter port postponed procedure process property protected pure range \
    record register reject release rem report restrict restrict_guarantee return rol ror select sequence severity shared signal sla \
    sll sra srl strong subtype then to transport type unaffected units until use variable vmode vprop vunit wait when while with xnor \
    xor";

/// Checks a name.
fn check(name: &str) -> Result<(), VhdlName> {
    let wrong = |reason| {
        Err(VhdlName {
            name: name.to_owned(),
            reason,
        })
    };
    if RESERVED.split_whitespace().any(|word| word == name) {
        return wrong("it is a reserved word");
    }
    if name.contains("__") || name.ends_with('_') || name.starts_with('_') {
        return wrong("an underscore stands beside another one, or at an end");
    }
    Ok(())
}

/// The two files of a module, as path and text.
///
/// # Errors
/// [`VhdlName`] if the module or one of its ports cannot have its name in VHDL.
pub fn files(top: &VhdlTop<'_>) -> Result<[(String, String); 2], VhdlName> {
    check(top.name)?;
    for port in top.ports {
        check(&port.name)?;
    }
    let path = |end: &str| format!("{FOLDER}/{}_{end}.vhd", top.name);
    Ok([(path("pkg"), package(top)), (path("instance"), instance(top))])
}

fn head(about: &str) -> String {
    format!(
        "-- {about}\n-- Written by posicast {}; do not edit.\n\nlibrary ieee;\nuse ieee.std_logic_1164.all;\n",
        env!("CARGO_PKG_VERSION")
    )
}

/// The generics and ports, indented by so many spaces.
fn interface(top: &VhdlTop<'_>, indent: usize) -> String {
    let space = " ".repeat(indent);
    let mut text = String::new();
    if !top.parameters.is_empty() {
        let lines = top
            .parameters
            .iter()
            .map(|(name, default)| format!("{space}    {name} : natural := {default}"));
        let _ = write!(
            text,
            "{space}generic (\n{}\n{space});\n",
            lines.collect::<Vec<_>>().join(";\n")
        );
    }
    let clock = ("clk", Direction::Input, 1, false);
    let ports = top
        .ports
        .iter()
        .map(|port| (port.name.as_str(), port.direction, port.width, port.signed));
    let ports: Vec<_> = std::iter::once(clock).chain(ports).collect();
    let longest = ports.iter().map(|(name, ..)| name.len()).max().unwrap_or(0);
    let _ = writeln!(text, "{space}port (");
    for (place, (name, direction, width, signed)) in ports.iter().enumerate() {
        let mode = match direction {
            Direction::Input => "in ",
            Direction::Output => "out",
        };
        let of = match width {
            1 => "std_logic".to_owned(),
            width => format!("std_logic_vector({} downto 0)", width - 1),
        };
        let end = if place + 1 < ports.len() { ";" } else { "" };
        let note = if *signed { "  -- signed" } else { "" };
        let _ = writeln!(text, "{space}    {name:longest$} : {mode} {of}{end}{note}");
    }
    let _ = writeln!(text, "{space});");
    text
}

fn package(top: &VhdlTop<'_>) -> String {
    let name = top.name;
    let mut text = head(&format!(
        "{name}: component declaration and constants for a design in VHDL"
    ));
    let _ = writeln!(text, "\npackage {name}_pkg is\n");
    let _ = writeln!(text, "    component {name} is");
    text.push_str(&interface(top, 8));
    let _ = writeln!(text, "    end component;\n");
    if !top.tables.is_empty() {
        text.push_str(
            "    -- Delay in samples and coefficient of each tap.\n    type tap_t is array (0 to 1) of integer;\n    \
             type taps_t is array (natural range <>) of tap_t;\n",
        );
        for (axis, table) in &top.tables {
            let taps = table.taps().iter().enumerate();
            let taps: Vec<String> = taps
                .map(|(place, tap)| format!("        {place} => ({}, {})", tap.delay_samples, tap.coefficient))
                .collect();
            let one = 1_u64 << table.coefficient_fraction();
            let _ = writeln!(
                text,
                "    -- They sum to {one}.\n    constant {axis}_taps : taps_t := (\n{}\n    );",
                taps.join(",\n")
            );
        }
        text.push('\n');
    }
    if let Some(map) = top.map {
        text.push_str("    -- Word addresses of the registers.\n");
        let longest = map
            .registers()
            .iter()
            .map(|register| register.name.len())
            .max()
            .unwrap_or(0);
        for register in map.registers() {
            let (name, offset) = (format!("{}_word", register.name), register.offset);
            let width = longest + "_word".len();
            let _ = writeln!(text, "    constant {name:width$} : natural := 16#{offset:x}#;");
        }
        text.push('\n');
    }
    let _ = writeln!(text, "end package;");
    text
}

fn instance(top: &VhdlTop<'_>) -> String {
    let name = top.name;
    let mut text = head(&format!("An instance of {name}, to copy into a design"));
    let _ = writeln!(text, "use work.{name}_pkg.all;\n\nentity {name}_instance is");
    text.push_str(&interface(top, 4));
    let _ = writeln!(
        text,
        "end entity;\n\narchitecture template of {name}_instance is\nbegin\n    u_{name} : {name}"
    );
    let longest = top.ports.iter().map(|port| port.name.len()).max().unwrap_or(3);
    let joined = |names: Vec<&str>| {
        let lines = names
            .iter()
            .map(|name| format!("            {name:longest$} => {name}"));
        lines.collect::<Vec<_>>().join(",\n")
    };
    if !top.parameters.is_empty() {
        let names = top.parameters.iter().map(|(name, _)| *name).collect();
        let _ = writeln!(text, "        generic map (\n{}\n        )", joined(names));
    }
    let names = std::iter::once("clk").chain(top.ports.iter().map(|port| port.name.as_str()));
    let _ = writeln!(
        text,
        "        port map (\n{}\n        );\nend architecture;",
        joined(names.collect())
    );
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_vhdl_lacks_are_refused() {
        for name in ["block", "x__y", "x_", "signal"] {
            assert!(check(name).is_err(), "{name}");
        }
        for name in ["blocks", "x_signal", "xy_stage"] {
            assert!(check(name).is_ok(), "{name}");
        }
    }
}
