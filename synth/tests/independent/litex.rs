//! The modules for LiteX: what Python reads of them, the Verilog of a SoC with them, and how a wrong use is refused.

use super::{output, pwm, python, stage, write};
use posicast_blocks::Direction;
use posicast_blocks::bus_component::{BridgedBus, ports};
use posicast_blocks::component::Component;
use posicast_synth::bus_top::BusTop;
use posicast_synth::litex::file;
use posicast_testbench::blocks::Block;
use posicast_testbench::bus_component::BusComponentBlock;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

const BUS: BridgedBus = BridgedBus::Wishbone { pipelined: false };
/// A word of Python, which may name a machine.
const MACHINE: &str = "lambda";
const CLOCK_HZ: f64 = 50e6;

/// Writes a package with a stage and a PWM; returns the path of the module, and the Verilog files.
fn package(folder: &Path, components: &[(Component, &str)]) -> (PathBuf, BTreeSet<PathBuf>) {
    let mut verilog = BTreeSet::new();
    let mut parts = Vec::new();
    for (component, top) in components {
        let block = BusComponentBlock::new(component.clone(), BUS, &[], [top, &format!("{top}_inside"), MACHINE]);
        let mut sources = Vec::new();
        for module in block.modules().unwrap() {
            let path = format!("rtl/{}.v", module.name);
            verilog.insert(write(folder, &path, &module.text));
            sources.push(path);
        }
        parts.push((ports(component, BUS), sources));
    }
    let tops: Vec<BusTop<'_>> = components
        .iter()
        .zip(&parts)
        .map(|((component, top), (ports, sources))| BusTop {
            top,
            ports,
            map: component.map(),
            sources: sources.clone(),
        })
        .collect();
    let (path, text) = file(MACHINE, CLOCK_HZ, &tops, "stage").unwrap();
    assert_eq!(
        file(MACHINE, CLOCK_HZ, &tops, "stage").unwrap(),
        (path.clone(), text.clone())
    );
    (write(folder, &path, &text), verilog)
}

#[test]
fn python_reads_the_ports_the_registers_and_the_files_of_each_module() {
    let folder = tempfile::tempdir().unwrap();
    let components = [(stage(), "lambda_stage_wishbone"), (pwm(), "lambda_x_pwm_wishbone")];
    let (module, verilog) = package(folder.path(), &components);
    let said = output(python("use_litex.py").arg("read").arg(module));
    let mut expected = vec!["clock 50000000".to_owned()];
    for (component, top) in &components {
        let map = component.map();
        expected.push(format!("class {top} {} True", 4 << map.address_bits()));
        for port in ports(component, BUS)
            .iter()
            .filter(|port| !["rst", "irq"].contains(&port.name.as_str()))
        {
            let direction = if port.direction == Direction::Input { "i" } else { "o" };
            expected.push(format!("port {} {direction} {}", port.name, port.width));
        }
        let registers = map.registers().iter();
        expected.extend(registers.map(|register| format!("register {} {}", register.name, 4 * register.offset)));
    }
    // The bus comes before the pins in the module, and inputs before outputs in the Verilog.
    let sorted = |lines: Vec<String>| lines.into_iter().collect::<BTreeSet<_>>();
    let (sources, said): (Vec<&str>, Vec<&str>) = said.lines().partition(|line| line.starts_with("source "));
    assert_eq!(sorted(said.into_iter().map(str::to_owned).collect()), sorted(expected));
    let sources: BTreeSet<PathBuf> = sources
        .iter()
        .map(|line| PathBuf::from(&line["source ".len()..]))
        .collect();
    assert_eq!(sources, verilog);
}

/// Verilator names a port that only the module or only its instance has.
#[test]
fn a_soc_has_every_port_of_each_module() {
    let folder = tempfile::tempdir().unwrap();
    let components = [(stage(), "lambda_stage_wishbone"), (pwm(), "lambda_x_pwm_wishbone")];
    let (module, _) = package(folder.path(), &components);
    let said = output(python("use_litex.py").arg("build").arg(&module).arg(folder.path()));
    let lines: Vec<&str> = said.lines().collect();
    let [bases @ .., files] = &lines[..] else {
        panic!("{said}");
    };
    assert_eq!(bases, ["STAGE_BASE 0x80000000", "PWM_BASE 0x90000000"]);
    let ports_that_differ = || {
        let mut verilator = Command::new("verilator");
        verilator.args(["--lint-only", "-Wno-fatal", "--top-module", "soc"]);
        let output = verilator.args(files.split(' ')).output().unwrap();
        let text = String::from_utf8(output.stderr).unwrap();
        let about = |line: &&str| ["-PIN", "%Error"].iter().any(|word| line.contains(word));
        text.lines().filter(about).map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(ports_that_differ(), [""; 0]);
    let soc = files.rsplit(' ').next().unwrap();
    let text = std::fs::read_to_string(soc).unwrap();
    let without: Vec<&str> = text.lines().filter(|line| !line.contains(".x_home ")).collect();
    assert_eq!(without.len() + 1, text.lines().count());
    std::fs::write(soc, without.join("\n")).unwrap();
    assert!(ports_that_differ()[0].contains("x_home"));
}

#[test]
fn wrong_uses_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let (module, _) = package(folder.path(), &[(pwm(), "lambda_x_pwm_wishbone")]);
    let said = output(python("use_litex.py").arg("refuse").arg(module));
    let lines: Vec<&str> = said.lines().collect();
    for (line, words) in lines.iter().zip([
        ["clock: ", "50000000 Hz", "25000000", "clock.frequency_hz"],
        ["missing: ", "lambda_x_pwm_wishbone", "no pad or signal", "feed, duty"],
        ["unknown: ", "lambda_x_pwm_wishbone", "no pin folt_n", "PINS"],
        [
            "twice: ",
            "lambda_x_pwm_wishbone",
            "feed is a pad and a signal",
            "leave one out",
        ],
        ["width: ", "lambda_x_pwm_wishbone", "feed has 1 bits", "signal 2"],
    ]) {
        assert!(words.iter().all(|word| line.contains(word)), "{line}: {words:?}");
    }
    assert_eq!(lines.len(), 5, "{said}");
}
