//! The cores for Vivado: their IP-XACT as ipyxact reads it, and the commands of their scripts as Tcl reads them.

use super::{fields, output, python, stage, write};
use posicast_blocks::bus_component::{BridgedBus, ports};
use posicast_blocks::{Direction, Port};
use posicast_synth::amd::files;
use posicast_synth::bus_top::BusTop;
use std::process::Command;

/// Stands in for Vivado: every command is known by its name, and its arguments are printed.
const VIVADO: &str = r#"
namespace eval ipx {}
proc unknown {name args} { puts "$name $args"; return "" }
foreach name {get_bd_cells get_bd_pins get_bd_ports get_bd_nets get_bd_intf_pins get_files current_project current_fileset
    ipx::current_core get_pins get_cells} {
    proc $name args [list return "<$name>"]
}
set argc 0
"#;

#[test]
fn ipyxact_reads_interfaces_ports_files_and_the_registers_of_the_map() {
    let stage = stage();
    let of_stage = ports(&stage, BridgedBus::AxiLite);
    let core = BusTop {
        top: "xy_stage_stage_axi",
        ports: &of_stage,
        map: stage.map(),
        sources: ["posicast_synchroniser", "posicast_fault_latch", "xy_stage_stage_axi"]
            .map(|name| format!("rtl/{name}.v"))
            .to_vec(),
    };
    let all = files("xy_stage", 50e6, &[core]);
    let folder = tempfile::tempdir().unwrap();
    let paths: Vec<_> = all
        .iter()
        .map(|(path, text)| write(folder.path(), path, text))
        .collect();
    let said = output(python("read_ipxact.py").arg(&paths[0]));
    let lines = |kind: &str| -> Vec<String> {
        let lines = said.lines().filter_map(|line| line.strip_prefix(&format!("{kind} ")));
        lines.map(str::to_owned).collect()
    };
    assert_eq!(lines("component"), ["posicast machines xy_stage_stage_axi 1.0"]);
    let interfaces = lines("interface");
    assert_eq!(interfaces.len(), 4, "{interfaces:?}");
    assert!(
        interfaces[0].starts_with("s_axi aximm aximm_rtl AWADDR=s_axi_awaddr "),
        "{}",
        interfaces[0]
    );
    // Every port of the bus is in its interface.
    let of_bus = of_stage.iter().filter(|port| port.name.starts_with("s_axi_"));
    assert!(
        of_bus
            .clone()
            .all(|port| interfaces[0].contains(&format!("={}", port.name)))
    );
    assert_eq!(of_bus.count() + 3, interfaces[0].split(' ').count());
    assert_eq!(interfaces[3], "irq interrupt interrupt_rtl INTERRUPT=irq");
    let port = |port: &Port| {
        let direction = if port.direction == Direction::Input {
            "in"
        } else {
            "out"
        };
        format!("{} {direction} {}", port.name, port.width)
    };
    let expected: Vec<String> = std::iter::once("clk in 1".to_owned())
        .chain(of_stage.iter().map(port))
        .collect();
    assert_eq!(lines("port"), expected);
    // The name of an array and the access are those of the SVD; a reset value is not in it.
    let expected = fields(stage.map(), |name, word| format!("{name}_{word}"));
    let expected: Vec<&str> = expected.iter().map(|line| line.rsplit_once(' ').unwrap().0).collect();
    assert_eq!(lines("field"), expected);
    assert_eq!(lines("block"), [format!("0 {} 32", 4 << stage.map().address_bits())]);
    let sets = lines("files");
    assert!(
        sets[0].ends_with("../../rtl/xy_stage_stage_axi.v xy_stage_stage_axi.xdc"),
        "{}",
        sets[0]
    );
}

#[test]
fn the_scripts_for_vivado_are_tcl_and_reach_every_pin() {
    let stage = stage();
    let of_stage = ports(&stage, BridgedBus::AxiLite);
    let core = BusTop {
        top: "xy_stage_stage_axi",
        ports: &of_stage,
        map: stage.map(),
        sources: vec![
            "rtl/posicast_synchroniser.v".to_owned(),
            "rtl/posicast_fault_latch.v".to_owned(),
        ],
    };
    let folder = tempfile::tempdir().unwrap();
    for (path, text) in files("xy_stage", 50e6, &[core]) {
        if path.ends_with(".xml") {
            continue;
        }
        let script = write(folder.path(), "run.tcl", &format!("{VIVADO}\n{text}"));
        let said = output(Command::new("tclsh").arg(script));
        if path.ends_with("zynq7.tcl") || path.ends_with("microblaze.tcl") {
            for pin in of_stage.iter().filter(|port| !port.name.starts_with("s_axi_")) {
                let named = said.contains(&format!("make_bd_pins_external -name {} ", pin.name));
                assert_eq!(
                    named,
                    !["rst", "irq"].contains(&pin.name.as_str()),
                    "{path}: {}",
                    pin.name
                );
            }
            assert!(
                said.contains("create_bd_cell -type ip -vlnv posicast:machines:xy_stage_stage_axi:1.0 core"),
                "{said}"
            );
        }
        if path.ends_with(".xdc") {
            assert_eq!(said.matches("set_false_path").count(), 2, "{said}");
        }
        if path.ends_with("package_ip.tcl") {
            assert!(said.contains("ipx::check_integrity"), "{said}");
        }
    }
}
