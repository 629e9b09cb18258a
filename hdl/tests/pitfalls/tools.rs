//! Runs Icarus, Verilator and Yosys on emitted modules. A missing tool fails the test with a message.

use crate::pitfalls::support::Row;
use posicast_blocks::Direction;
use posicast_hdl::emit::{Header, Module, ModuleInstance, compose};
use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

/// Runs a tool in `folder` and returns its output; it must succeed.
pub(crate) fn run(folder: &Path, program: &str, arguments: &[&str]) -> String {
    let output = Command::new(program).args(arguments).current_dir(folder).output();
    let output = output.unwrap_or_else(|error| panic!("{program} is needed for this test and cannot be run: {error}"));
    let said = format!(
        "{}{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
    assert!(output.status.success(), "{program} {arguments:?} failed:\n{said}");
    said
}

/// Writes one file per module, as a user gets them.
pub(crate) fn write(folder: &Path, modules: &[Module]) {
    for module in modules {
        std::fs::write(folder.join(format!("{}.v", module.name)), &module.text).unwrap();
    }
}

/// Lints the design under `top`; every warning counts.
pub(crate) fn lint(folder: &Path, top: &str) {
    let said = run(
        folder,
        "verilator",
        &["--lint-only", "-Wall", "-y", ".", &format!("{top}.v")],
    );
    assert_eq!(said, "", "verilator -Wall on {top}");
    let said = run(
        folder,
        "iverilog",
        &[
            "-g2001",
            "-Wall",
            "-t",
            "null",
            "-y",
            ".",
            "-s",
            top,
            &format!("{top}.v"),
        ],
    );
    let said: Vec<_> = said.lines().filter(|line| !line.contains("has no timescale")).collect();
    assert!(said.is_empty(), "iverilog -Wall on {top}: {said:#?}");
    yosys(folder, top, "check -assert");
}

/// Reads the design into Yosys, checks the hierarchy, and continues with `script`.
pub(crate) fn yosys(folder: &Path, top: &str, script: &str) -> String {
    let files: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name())
        .collect();
    let mut files: Vec<_> = files
        .iter()
        .filter_map(|name| name.to_str())
        .filter(|name| name.ends_with(".v"))
        .collect();
    files.sort_unstable();
    let script = format!(
        "read_verilog {}; hierarchy -check -top {top}; proc; {script}",
        files.join(" ")
    );
    let said = run(folder, "yosys", &["-q", "-p", &script]);
    assert!(!said.contains("Warning"), "yosys on {top}: {said}");
    said
}

/// Plays every row's vectors in one testbench, in Icarus, in Verilator, and in Icarus on the netlist from Yosys.
/// Returns the differences.
pub(crate) fn replay(rows: &[Row]) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    let rtl = folder.path().join("rtl");
    std::fs::create_dir(&rtl).unwrap();
    let mut instances = Vec::new();
    for row in rows {
        let modules = row
            .modules
            .as_ref()
            .unwrap_or_else(|error| panic!("{}: {error}", row.name));
        write(&rtl, modules);
        instances.push(ModuleInstance {
            name: &row.name,
            module: modules.last().unwrap(),
        });
    }
    let header = Header {
        ports: Vec::new(),
        about: "Every kernel of the emitter's tests.".to_owned(),
        parameters: Vec::new(),
    };
    let top = compose("pitfalls", &header, &[], &instances).unwrap();
    write(&rtl, std::slice::from_ref(&top));
    lint(&rtl, "pitfalls");
    yosys(&rtl, "pitfalls", "flatten; opt; write_verilog -noattr ../netlist.v");
    std::fs::write(folder.path().join("bench.v"), bench(rows, &instances, &top)).unwrap();
    for row in rows {
        std::fs::write(folder.path().join(format!("{}.bits", row.name)), bits(row, &instances)).unwrap();
    }

    let folder = folder.path();
    run(
        folder,
        "iverilog",
        &["-g2001", "-y", "rtl", "-s", "bench", "-o", "rtl.vvp", "bench.v"],
    );
    run(
        folder,
        "iverilog",
        &["-g2001", "-s", "bench", "-o", "netlist.vvp", "bench.v", "netlist.v"],
    );
    let build = [
        "--binary", "--timing", "-O0", "-CFLAGS", "-O0", "-y", "rtl", "--top", "bench", "--Mdir", "build",
    ];
    let build = [&build[..], &["-Wno-fatal", "-Wno-WIDTH", "bench.v"]].concat();
    run(folder, "verilator", &build);
    let mut differences = Vec::new();
    for (tool, said) in [
        ("icarus", run(folder, "vvp", &["-n", "rtl.vvp"])),
        ("netlist", run(folder, "vvp", &["-n", "netlist.vvp"])),
        ("verilator", run(folder, "./build/Vbench", &[])),
    ] {
        assert!(said.contains("all rows done"), "{tool}: {said}");
        differences.extend(
            said.lines()
                .filter(|l| l.starts_with("differs"))
                .map(|line| format!("{tool} {line}")),
        );
    }
    differences
}

fn widths(instance: &ModuleInstance<'_>, direction: Direction) -> u32 {
    instance
        .module
        .ports
        .iter()
        .filter(|port| port.direction == direction)
        .map(|port| port.width)
        .sum()
}

/// Returns one word per vector: inputs, then outputs, most significant first.
fn bits(row: &Row, instances: &[ModuleInstance<'_>]) -> String {
    let instance = instances.iter().find(|instance| instance.name == row.name).unwrap();
    let mut text = String::new();
    for vector in &row.vectors {
        for (port, value) in instance.module.ports.iter().zip(vector) {
            assert!(
                port.width == 64 || *value >> port.width == 0,
                "{}.{}",
                row.name,
                port.name
            );
            write!(text, "{value:0width$b}", width = port.width as usize).unwrap();
        }
        text.push('\n');
    }
    text
}

fn bench(rows: &[Row], instances: &[ModuleInstance<'_>], top: &Module) -> String {
    let mut text = "`timescale 1ns/1ns\nmodule bench;\nreg clk = 0; integer n, bad;\n".to_owned();
    for port in &top.ports {
        let kind = if port.direction == Direction::Input {
            "reg"
        } else {
            "wire"
        };
        writeln!(text, "{kind} [{}:0] {};", port.width - 1, port.name).unwrap();
    }
    for (row, instance) in rows.iter().zip(instances) {
        let width = widths(instance, Direction::Input) + widths(instance, Direction::Output);
        writeln!(
            text,
            "reg [{}:0] {}_vectors [0:{}];",
            width - 1,
            row.name,
            row.vectors.len() - 1
        )
        .unwrap();
    }
    let connections = top.ports.iter().map(|port| format!(".{0}({0})", port.name));
    let clock = top.clocked.then(|| ".clk(clk)".to_owned());
    writeln!(
        text,
        "pitfalls dut({});",
        clock.into_iter().chain(connections).collect::<Vec<_>>().join(", ")
    )
    .unwrap();
    for (row, instance) in rows.iter().zip(instances) {
        writeln!(text, "{}", task(row, instance)).unwrap();
    }
    text.push_str("initial begin\n");
    // All instances share the clock; an instance that is not being tested stays in reset, its state after power-up.
    for port in top.ports.iter().filter(|port| port.direction == Direction::Input) {
        writeln!(text, "{} = {};", port.name, u32::from(port.name.ends_with("_rst"))).unwrap();
    }
    for row in rows {
        writeln!(text, "play_{};", row.name).unwrap();
    }
    text.push_str("$display(\"all rows done\"); $finish;\nend\nendmodule\n");
    text
}

/// Returns a task that plays one row.
fn task(row: &Row, instance: &ModuleInstance<'_>) -> String {
    let name = &row.name;
    let list = |direction: Direction| {
        let ports = instance.module.ports.iter().filter(|port| port.direction == direction);
        ports
            .map(|port| format!("{name}_{}", port.name))
            .collect::<Vec<_>>()
            .join(", ")
    };
    let (inputs, outputs) = (list(Direction::Input), list(Direction::Output));
    let output_width = widths(instance, Direction::Output);
    let width = output_width + widths(instance, Direction::Input);
    let clock = if instance.module.clocked {
        "clk = 1; #1 clk = 0; #1 ;"
    } else {
        ""
    };
    format!(
        "task play_{name}; begin
  $readmemb(\"{name}.bits\", {name}_vectors); bad = 0;
  for (n = 0; n < {count}; n = n + 1) begin
    {{{inputs}}} = {name}_vectors[n][{high}:{output_width}]; #1 ;
    if ({{{outputs}}} !== {name}_vectors[n][{output_high}:0]) begin
      bad = bad + 1;
      if (bad == 1) $display(\"differs {name}: vector %0d, inputs %h, got %h, simulation %h\", n, {{{inputs}}}, {{{outputs}}}, {name}_vectors[n][{output_high}:0]);
    end
    {clock}
  end
end endtask",
        count = row.vectors.len(),
        high = width - 1,
        output_high = output_width - 1,
    )
}
