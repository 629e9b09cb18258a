//! The declarations for VHDL, analysed and elaborated by GHDL beside entities that the test makes from the ports.

use super::{output, stage, write};
use posicast_blocks::bus_component::{BridgedBus, ports};
use posicast_blocks::registers::RegisterMap;
use posicast_blocks::{Direction, Port};
use posicast_synth::vhdl::{VhdlTop, files};
use posicast_taps::{Tap, TapTable};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

/// An entity with these ports and without a function.
fn stub(top: &VhdlTop<'_>) -> String {
    let mut text = "library ieee;\nuse ieee.std_logic_1164.all;\n".to_owned();
    let _ = writeln!(text, "entity {} is", top.name);
    for (name, _) in &top.parameters {
        let _ = writeln!(text, "generic ({name} : natural);");
    }
    text.push_str("port (clk : in std_logic");
    for port in top.ports {
        let mode = if port.direction == Direction::Input {
            "in"
        } else {
            "out"
        };
        let of = match port.width {
            1 => "std_logic".to_owned(),
            width => format!("std_logic_vector({} downto 0)", width - 1),
        };
        let _ = write!(text, ";\n{} : {mode} {of}", port.name);
    }
    let _ = writeln!(
        text,
        ");\nend entity;\narchitecture stub of {} is begin end architecture;",
        top.name
    );
    text
}

fn ghdl(folder: &Path, arguments: &[&str]) -> Command {
    let mut ghdl = Command::new("ghdl");
    ghdl.current_dir(folder)
        .arg(arguments[0])
        .arg("--std=93c")
        .args(&arguments[1..]);
    ghdl
}

/// Analyses the files of a module beside its stub, and elaborates the instance; returns the folder and the package.
fn elaborated(top: &VhdlTop<'_>) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let [package, instance] = files(top)
        .unwrap()
        .map(|(path, text)| write(folder.path(), &path, &text));
    let stub = write(folder.path(), "stub.vhd", &stub(top));
    let all = [&stub, &package, &instance].map(|path| path.to_str().unwrap());
    output(&mut ghdl(folder.path(), &["-a", all[0], all[1], all[2]]));
    output(&mut ghdl(folder.path(), &["-e", &format!("{}_instance", top.name)]));
    (folder, package)
}

/// Runs assertions about the constants of a package; all of them hold if it ends well.
fn holds(folder: &Path, top: &str, assertions: &str) -> bool {
    let text = format!(
        "use work.{top}_pkg.all;\nentity check is end entity;\narchitecture all_of_them of check is begin\nprocess\n\
         variable sum : integer := 0;\nbegin\n{assertions}\nwait;\nend process;\nend architecture;\n"
    );
    let path = write(folder, "check.vhd", &text);
    output(&mut ghdl(folder, &["-a", path.to_str().unwrap()]));
    output(&mut ghdl(folder, &["-e", "check"]));
    ghdl(folder, &["-r", "check"]).output().unwrap().status.success()
}

fn on_bus<'a>(name: &'a str, ports: &'a [Port], map: &'a RegisterMap) -> VhdlTop<'a> {
    VhdlTop {
        name,
        ports,
        map: Some(map),
        tables: Vec::new(),
        parameters: Vec::new(),
    }
}

#[test]
fn ghdl_elaborates_the_stage_on_every_bus_and_knows_its_addresses() {
    let stage = stage();
    let [axi, wishbone] =
        [BridgedBus::AxiLite, BridgedBus::Wishbone { pipelined: false }].map(|bus| ports(&stage, bus));
    let map = stage.map();
    let (folder, _) = elaborated(&on_bus("xy_stage_stage", stage.composition().ports(), map));
    let of = |name: &str| map.register(name).unwrap().offset;
    let asserted = |x_status: u32| {
        format!(
            "assert start_word = {} and x_status_word = {x_status} and y_origin_word = {} severity failure;",
            of("start"),
            of("y_origin")
        )
    };
    assert!(holds(folder.path(), "xy_stage_stage", &asserted(of("x_status"))));
    assert!(!holds(folder.path(), "xy_stage_stage", &asserted(of("x_status") + 1)));
    elaborated(&on_bus("xy_stage_stage_axi", &axi, map));
    elaborated(&VhdlTop {
        parameters: vec![("PIPELINED", 0)],
        ..on_bus("xy_stage_stage_wishbone", &wishbone, map)
    });
}

#[test]
fn ghdl_sums_the_taps_of_a_shaper() {
    let port = |name: &str, direction, width| Port {
        name: name.to_owned(),
        direction,
        width,
        signed: width > 1,
    };
    let ports = [
        port("rst", Direction::Input, 1),
        port("x_in", Direction::Input, 24),
        port("x_out", Direction::Output, 24),
    ];
    let tap = |delay_samples, coefficient| Tap {
        delay_samples,
        coefficient,
    };
    let table = TapTable::new(16, vec![tap(0, 40_000), tap(3, -7232), tap(19, 32_768)]).unwrap();
    let single = TapTable::new(2, vec![tap(0, 4)]).unwrap();
    let (folder, _) = elaborated(&VhdlTop {
        map: None,
        tables: vec![("x", &table), ("y", &single)],
        ..on_bus("joint", &ports, stage().map())
    });
    let sum = "for k in x_taps'range loop sum := sum + x_taps(k)(1); end loop;\n";
    let of =
        |sum_is: i32| format!("{sum}assert sum = {sum_is} and x_taps(1)(0) = 3 and y_taps(0)(1) = 4 severity failure;");
    assert!(holds(folder.path(), "joint", &of(1 << 16)));
    assert!(!holds(folder.path(), "joint", &of(1 << 15)));
}

#[test]
fn ghdl_finds_a_port_that_the_module_lacks() {
    let stage = stage();
    let top = on_bus("xy_stage_stage", stage.composition().ports(), stage.map());
    let (folder, package) = elaborated(&top);
    let text = std::fs::read_to_string(&package).unwrap();
    std::fs::write(&package, text.replacen("avs_readdata ", "avs_readdatum", 1)).unwrap();
    let analysed = ghdl(folder.path(), &["-a", package.to_str().unwrap()])
        .output()
        .unwrap();
    assert!(analysed.status.success());
    let instance = folder.path().join("vhdl/xy_stage_stage_instance.vhd");
    let analysed = ghdl(folder.path(), &["-a", instance.to_str().unwrap()])
        .output()
        .unwrap();
    assert!(!analysed.status.success());
}
