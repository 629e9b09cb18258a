//! What `generate` writes for Platform Designer and Quartus, without either: its scripts run in `tclsh` with commands that
//! know what the versions know (`tests/sopc/`), and what they say is compared with the emitted Verilog.

#![cfg(test)] // lets clippy see that this is test code

use crate::support::{example, one_axis, posicast, scratch};
use predicates::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Name, direction (`Input` or `Output`) and width of each port.
type Ports = BTreeMap<String, (String, u32)>;

/// The package of a machine file.
fn package(machine: &str) -> (tempfile::TempDir, PathBuf) {
    let (folder, file) = scratch(machine);
    let output = folder.path().join("out");
    posicast()
        .arg("generate")
        .arg(&file)
        .arg("-o")
        .arg(&output)
        .assert()
        .success();
    (folder, output)
}

fn xy_stage() -> (tempfile::TempDir, PathBuf) {
    package(&fs::read_to_string(example("xy-stage.toml")).unwrap())
}

/// The records that a checking script prints, split into words; whether it is content.
fn check(script: &str, arguments: &[&str]) -> (Vec<Vec<String>>, bool) {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/sopc").join(script);
    let output = Command::new("tclsh").arg(script).args(arguments).output().unwrap();
    assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    let words = |line: &str| line.split_whitespace().map(str::to_owned).collect();
    (text.lines().map(words).collect(), output.status.success())
}

fn check_component(file: &Path) -> (Vec<Vec<String>>, bool) {
    check("platform_designer.tcl", &["component", file.to_str().unwrap()])
}

fn check_system(quartus: &str, file: &Path) -> (Vec<Vec<String>>, bool) {
    let components = file.parent().unwrap().to_str().unwrap();
    check(
        "platform_designer.tcl",
        &["system", quartus, file.to_str().unwrap(), components],
    )
}

/// The findings among records, each a line.
fn findings(records: &[Vec<String>]) -> Vec<String> {
    let found = records.iter().filter(|record| record[0] == "finding");
    found.map(|record| record[1..].join(" ")).collect()
}

/// The ports of a Verilog module, read from its text.
fn verilog_ports(file: &Path) -> Ports {
    let text = fs::read_to_string(file).unwrap();
    let start = text.find("\nmodule ").unwrap();
    let body = &text[start..start + text[start..].find(");").unwrap()];
    let declaration = |line: &str| {
        let line = line.trim().trim_end_matches(',');
        let direction = match line.split_whitespace().next()? {
            "input" => "Input",
            "output" => "Output",
            _ => return None,
        };
        let width = line.split_once('[').map_or(1, |(_, range)| {
            range.split_once(":0]").unwrap().0.parse::<u32>().unwrap() + 1
        });
        let name = line.split_whitespace().next_back()?;
        Some((name.to_owned(), (direction.to_owned(), width)))
    };
    body.lines().filter_map(declaration).collect()
}

/// The ports that a component binds, each to one interface.
fn bound_ports(records: &[Vec<String>]) -> Ports {
    let ports = records.iter().filter(|record| record[0] == "port");
    ports
        .map(|record| (record[2].clone(), (record[4].clone(), record[5].parse().unwrap())))
        .collect()
}

fn components(output: &Path) -> Vec<PathBuf> {
    let files = fs::read_dir(output.join("sopc"))
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let mut files: Vec<_> = files
        .filter(|path| path.to_str().unwrap().ends_with("_hw.tcl"))
        .collect();
    files.sort();
    files
}

/// The files of a file set, as paths.
fn file_set(records: &[Vec<String>], kind: &str, folder: &Path) -> Vec<PathBuf> {
    let files = records.iter().filter(|record| record[0] == "file" && record[1] == kind);
    files.map(|record| folder.join(&record[2])).collect()
}

fn lint(top: &str, files: &[PathBuf]) {
    let output = Command::new("verilator")
        .args(["--lint-only", "-Wall", "--language", "1364-2001", "--top-module", top])
        .args(files)
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{top}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
}

/// Is the component in this file good: known calls, and every port of its Verilog bound as it is?
fn component_holds(file: &Path) -> bool {
    let (records, content) = check_component(file);
    let top = file.file_name().unwrap().to_str().unwrap().trim_end_matches("_hw.tcl");
    let verilog = file.parent().unwrap().join(format!("../rtl/{top}.v"));
    content && bound_ports(&records) == verilog_ports(&verilog)
}

#[test]
fn cli_components_bind_every_port_of_their_verilog() {
    let (_folder, output) = xy_stage();
    let files = components(&output);
    let count = |part: &str| {
        files
            .iter()
            .filter(|file| file.to_str().unwrap().contains(part))
            .count()
    };
    assert_eq!(files.len(), 9);
    assert_eq!(count("xy_stage_stage_hw"), 1);
    for block in ["shaper", "pulse_counter", "pwm", "sliding_mode"] {
        assert_eq!(count(&format!("_{block}_avalon_hw")), 2, "{block}");
    }
    for file in &files {
        let (records, content) = check_component(file);
        assert!(content, "{}: {:#?}", file.display(), findings(&records));
        assert!(component_holds(file), "{}", file.display());
        let interfaces: BTreeSet<&str> = records
            .iter()
            .filter(|record| record[0] == "interface")
            .map(|record| record[2].as_str())
            .collect();
        assert_eq!(
            interfaces.into_iter().collect::<Vec<_>>(),
            ["avalon", "clock", "conduit", "interrupt", "reset"]
        );
        let [synthesis, simulation] =
            ["QUARTUS_SYNTH", "SIM_VERILOG"].map(|kind| file_set(&records, kind, &output.join("sopc")));
        assert_eq!(synthesis, simulation);
        // The set is whole: nothing else is needed to elaborate it.
        let top = records.iter().find(|record| record[0] == "top").unwrap()[2].clone();
        lint(&top, &synthesis);
    }
}

#[test]
fn cli_a_component_says_what_the_hardware_says() {
    let (_folder, output) = xy_stage();
    let (records, _) = check_component(&output.join("sopc/xy_stage_stage_hw.tcl"));
    let assignments: BTreeMap<&str, &str> = records
        .iter()
        .filter(|record| record[0] == "assignment")
        .map(|record| (record[1].as_str(), record[2].as_str()))
        .collect();
    // `STGE`, the first letter lowest; the rest from the machine file: two axes, 50 MHz / 10 kHz, 50 MHz / 20 kHz.
    for (name, value) in [
        ("embeddedsw.CMacro.MAGIC", "0x45475453"),
        ("embeddedsw.CMacro.AXES", "2"),
        ("embeddedsw.CMacro.TICK_CLOCKS", "5000"),
        ("embeddedsw.CMacro.X_PWM_PERIOD_CLOCKS", "2500"),
        ("embeddedsw.dts.compatible", "posicast,stage-1.0"),
    ] {
        assert_eq!(assignments.get(name), Some(&value), "{name}");
    }
    // The parameters that the header of the Verilog lists are all there.
    let verilog = fs::read_to_string(output.join("rtl/xy_stage_stage.v")).unwrap();
    let table = verilog
        .lines()
        .skip_while(|line| !line.starts_with("// parameter "))
        .skip(1);
    for line in table.take_while(|line| line.starts_with("// ")) {
        let mut words = line.split_whitespace().skip(1);
        let name = format!("embeddedsw.CMacro.{}", words.next().unwrap().to_uppercase());
        assert_eq!(assignments.get(name.as_str()), words.next().as_ref(), "{name}");
    }
}

/// Replaces in a file what must be there.
fn replace(file: &Path, from: &str, to: &str) {
    let text = fs::read_to_string(file).unwrap();
    assert!(text.contains(from), "{from}");
    fs::write(file, text.replacen(from, to, 1)).unwrap();
}

#[test]
fn cli_a_component_that_is_wrong_or_too_new_is_found() {
    let (_folder, output) = xy_stage();
    let good = output.join("sopc/xy_stage_x_pwm_avalon_hw.tcl");
    let text = fs::read_to_string(&good).unwrap();
    assert!(component_holds(&good));
    let breaks = [
        ("duty duty Input 17", "duty duty Input 16"),
        ("add_interface_port pins b_low b_low Output 1\n", ""),
        ("b_low b_low Output 1", "b_low b_low Input 1"),
        ("b_low b_low Output 1", "b_low b_high Output 1"),
        (
            "add_interface_port pins b_low b_low",
            "add_interface_port pins b_high b_low",
        ),
        ("avs_byteenable byteenable Input 4", "avs_byteenable byteenable Input 2"),
        ("avs_read read", "avs_read reed"),
        ("set_interface_property avs associatedReset reset\n", ""),
        (
            "set_interface_property irq associatedClock clk",
            "set_interface_property irq associatedClock clock",
        ),
        ("readLatency 1", "readLatency 0"),
        ("package require -exact qsys 13.0", "package require -exact qsys 13.1"),
        (
            "set_module_property EDITABLE false",
            "set_module_property REPORT_HIERARCHY false",
        ),
        (
            "set_interface_property avs isMemoryDevice false",
            "set_interface_property avs CMSIS_SVD_FILE a.svd",
        ),
        (
            "add_fileset_file xy_stage_x_pwm_avalon.v VERILOG PATH ../rtl/xy_stage_x_pwm_avalon.v",
            "add_fileset_file xy_stage_x_pwm_avalon.v VERILOG PATH ../rtl/xy_stage_x_pwm_avalon.v TOP_LEVEL_FILE",
        ),
        ("../rtl/xy_stage_x_pwm_avalon.v", "../rtl/xy_stage_x_pwm.v"),
        (
            "set_module_property GROUP Posicast",
            "add_hdl_instance fifo altera_fifo",
        ),
        ("ENABLED false", "ENABLED true"),
    ];
    for (from, to) in breaks {
        fs::write(&good, &text).unwrap();
        replace(&good, from, to);
        assert!(!component_holds(&good), "{from} -> {to} was not found");
    }
}

/// The boards with their version of Quartus, clock pin and device.
const BOARDS: [(&str, &str, &str, &str); 2] = [
    ("de1", "13.0", "PIN_L1", "EP2C20F484C7"),
    ("de1soc", "25.1", "PIN_AF14", "5CSEMA5F31C6"),
];

#[test]
fn cli_a_system_is_complete_and_its_top_level_fits_it() {
    let (folder, output) = xy_stage();
    for (board, quartus, _, device) in BOARDS {
        let script = output.join(format!("sopc/xy_stage_{board}_system.tcl"));
        let (records, content) = check_system(quartus, &script);
        assert!(content, "{board}: {:#?}", findings(&records));
        assert!(records.iter().any(|record| record[..] == ["project", "DEVICE", device]));
        let stage = records
            .iter()
            .find(|record| record[0] == "agent" && record[1] == "stage.avs");
        assert_eq!(stage.unwrap()[2..], ["131072", "4096"]);
        // A box with the ports that Platform Designer would give the system; the top level must fit it.
        let exports: Vec<String> = records
            .iter()
            .filter(|record| record[0] == "export")
            .map(|record| {
                format!(
                    "{} wire [{}:0] {}",
                    record[2].to_lowercase(),
                    record[3].parse::<u32>().unwrap() - 1,
                    record[1]
                )
            })
            .collect();
        let name = format!("xy_stage_{board}_system");
        let unused = "/* verilator lint_off UNUSED */\n/* verilator lint_off UNDRIVEN */\n/* verilator lint_off DECLFILENAME */\n";
        let system = folder.path().join(format!("{name}.v"));
        let text = format!("{unused}module {name} ({});\nendmodule\n", exports.join(", "));
        fs::write(&system, text.replace("[0:0] ", "")).unwrap();
        let top = format!("xy_stage_{board}");
        lint(&top, &[output.join(format!("sopc/quartus/{board}/{top}.v")), system]);
    }
}

#[test]
fn cli_a_system_that_is_wrong_or_too_new_is_found() {
    let (_folder, output) = xy_stage();
    let script = output.join("sopc/xy_stage_de1_system.tcl");
    let text = fs::read_to_string(&script).unwrap();
    let breaks = [
        ("altera_nios2_qsys", "altera_nios2_gen2"),
        ("altera_nios2_qsys", "intel_niosv_m"),
        ("package require -exact qsys 13.0", "package require -exact qsys 16.1"),
        ("add_connection clock.clk stage.clk\n", ""),
        ("add_connection cpu.d_irq stage.irq\n", ""),
        ("/stage.irq irqNumber {0}", "/stage.irq irqNumber {1}"),
        (
            "/stage.avs baseAddress {0x00020000}",
            "/stage.avs baseAddress {0x00020100}",
        ),
        (
            "/stage.avs baseAddress {0x00020000}",
            "/stage.avs baseAddress {0x00000000}",
        ),
        ("set_interface_property axis_x EXPORT_OF stage.axis_x\n", ""),
        (
            "add_instance sysid altera_avalon_sysid_qsys",
            "add_instance sysid altera_avalon_sysid_qsys\nsync_sysinfo_parameters",
        ),
    ];
    for (from, to) in breaks {
        fs::write(&script, &text).unwrap();
        replace(&script, from, to);
        let (records, content) = check_system("13.0", &script);
        assert!(
            !content && !findings(&records).is_empty(),
            "{from} -> {to} was not found"
        );
    }
}

/// The records of a project's file, and whether it is content; `ports` are those of the top level.
fn check_project(quartus: &str, file: &Path, ports: &Ports) -> (Vec<Vec<String>>, bool) {
    let ports: Vec<String> = ports
        .iter()
        .map(|(name, (direction, _))| format!("{name}={direction}"))
        .collect();
    let arguments = [quartus, file.to_str().unwrap()]
        .into_iter()
        .chain(ports.iter().map(String::as_str));
    check("project.tcl", &arguments.collect::<Vec<_>>())
}

#[test]
fn cli_a_project_places_and_constrains_every_port() {
    let (_folder, output) = xy_stage();
    for (board, quartus, clock_pin, device) in BOARDS {
        let name = format!("xy_stage_{board}");
        let project = output.join("sopc/quartus").join(board);
        let ports = verilog_ports(&project.join(format!("{name}.v")));
        let (settings, content) = check_project(quartus, &project.join(format!("{name}.qsf")), &ports);
        assert!(content, "{:#?}", findings(&settings));
        let pins: BTreeMap<&str, &str> = settings
            .iter()
            .filter(|record| record[0] == "pin")
            .map(|record| (record[1].as_str(), record[2].as_str()))
            .collect();
        assert_eq!(
            pins.keys().copied().collect::<Vec<_>>(),
            ports.keys().map(String::as_str).collect::<Vec<_>>()
        );
        assert_eq!(pins["clock_50"], clock_pin);
        let global = |name: &str| {
            settings
                .iter()
                .find(|record| record[0] == "global" && record[1] == name)
                .unwrap()[2..]
                .join(" ")
        };
        assert_eq!(global("DEVICE"), device);
        assert_eq!(global("TOP_LEVEL_ENTITY"), name);
        assert_eq!(
            global("RESERVE_ALL_UNUSED_PINS_WEAK_PULLUP"),
            "AS INPUT TRI-STATED WITH WEAK PULL-UP"
        );
        // A broken wire must not read as healthy.
        for line in ["emergency_stop_n", "x_fault_n", "x_limit_plus_n", "y_drive_ready"] {
            let off = ["assignment", line, "WEAK_PULL_UP_RESISTOR", "OFF"];
            assert!(settings.iter().any(|record| record[..] == off), "{line}");
        }

        let (timing, content) = check_project(quartus, &project.join(format!("{name}.sdc")), &ports);
        assert!(content, "{:#?}", findings(&timing));
        assert!(
            timing
                .iter()
                .any(|record| record[..] == ["clock", "clock_50", "20.000"])
        );
        for port in ports.keys().filter(|port| *port != "clock_50") {
            let delays = timing
                .iter()
                .filter(|record| record[0] == "delay" && record[1] == *port);
            assert_eq!(delays.count(), 2, "{port}");
        }
        // False paths go to first flip-flops and fault latches, and to nothing else; registers of these names are in the RTL.
        let ends: BTreeSet<String> = timing
            .iter()
            .filter(|record| record[0] == "false_path")
            .map(|record| record[2..].join(" "))
            .collect();
        let expected = ["*altera_std_synchronizer:*|din_s1", "*synchroniser_first", "*|armed"];
        assert_eq!(ends.iter().map(String::as_str).collect::<Vec<_>>(), expected);
        let rtl = |module: &str| fs::read_to_string(output.join(format!("rtl/{module}.v"))).unwrap();
        assert!(rtl("xy_stage_stage_synchroniser").contains("reg synchroniser_first;"));
        assert!(rtl("xy_stage_stage_x_fault_latch").contains("output reg  armed"));
    }
}

#[test]
fn cli_lines_end_in_registers_that_the_timing_excludes_and_in_no_others() {
    let text = fs::read_to_string(example("xy-stage.toml")).unwrap();
    // With a trace there is an encoder generator between the pins and the pulse counter.
    let with_trace = text.replacen("[axis.limits]", "[axis.trace]\nsamples = 256\n\n[axis.limits]", 1);
    assert_ne!(with_trace, text);
    for machine in [text, with_trace] {
        check_lines(&machine);
    }
}

fn check_lines(machine: &str) {
    let (folder, output) = package(machine);
    let project = output.join("sopc/quartus/de1");
    let ports = verilog_ports(&project.join("xy_stage_de1.v"));
    let (timing, _) = check_project("13.0", &project.join("xy_stage_de1.sdc"), &ports);
    let excluded = |line: &str, register: &str| {
        timing.iter().any(|record| {
            let ends = record[2..]
                .iter()
                .any(|end| register.ends_with(end.trim_start_matches(['*', '|'])));
            record[0] == "false_path" && record[1] == line && ends
        })
    };
    let inside = ["clk", "rst", "pll_locked"];
    let stage = verilog_ports(&output.join("rtl/xy_stage_stage.v"));
    let is_line =
        |name: &str, direction: &str| direction == "Input" && !inside.contains(&name) && !name.starts_with("avs_");
    let lines: Vec<&String> = stage
        .iter()
        .filter(|(name, (direction, _))| is_line(name, direction))
        .map(|(name, _)| name)
        .collect();
    assert_eq!(lines.len(), 1 + 2 * 9);
    // What a line reaches through the netlist, up to flip-flops and not through them.
    let kinds = ["dff", "sdff", "adff", "dffe", "sdffe", "adffe", "sdffce"];
    let stop: String = kinds.map(|kind| format!(":-${kind}[Q]")).concat();
    let mut script = String::from("hierarchy -top xy_stage_stage; proc; flatten; opt_clean; ");
    for line in &lines {
        let list = folder.path().join(line);
        script += &format!(
            "tee -q -o {} select -list i:{line} %co*{stop} t:$*dff* %i; ",
            list.display()
        );
    }
    let mut yosys = Command::new("yosys");
    let (records, _) = check_component(&output.join("sopc/xy_stage_stage_hw.tcl"));
    yosys
        .args(["-q", "-p", &script])
        .args(file_set(&records, "QUARTUS_SYNTH", &output.join("sopc")));
    let run = yosys.output().unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    for line in lines {
        let reached = fs::read_to_string(folder.path().join(line)).unwrap();
        assert!(!reached.is_empty(), "{line} reaches nothing");
        for register in reached.lines() {
            assert!(
                excluded(line, register),
                "{line} reaches {register}, which the .sdc does not exclude"
            );
        }
    }
}

#[test]
fn cli_a_project_that_is_wrong_is_found() {
    let (_folder, output) = xy_stage();
    let project = output.join("sopc/quartus/de1");
    let ports = verilog_ports(&project.join("xy_stage_de1.v"));
    let breaks = [
        ("qsf", "PIN_L1 -to clock_50", "PIN_A13 -to clock_50"),
        ("qsf", "-to x_home", "-to x_hom"),
        ("qsf", "-name SDC_FILE", "-name SDC_ENTITY_FILE"),
        (
            "sdc",
            "create_clock -name clock_50 -period",
            "create_clock -name clock_50 -perod",
        ),
        (
            "sdc",
            "set_output_delay -clock clock_50 -max",
            "set_output_delay -clock clock -max",
        ),
        ("sdc", "[get_ports {uart_txd ", "[get_ports {uart_rxd "),
        ("sdc", "# Delays of drivers", "derive_clock_uncertainty\n#"),
    ];
    for (extension, from, to) in breaks {
        let file = project.join(format!("xy_stage_de1.{extension}"));
        let text = fs::read_to_string(&file).unwrap();
        replace(&file, from, to);
        let (_, content) = check_project("13.0", &file, &ports);
        assert!(!content, "{from} -> {to} was not found");
        fs::write(&file, text).unwrap();
    }
}

#[test]
fn cli_four_axes_with_scales_find_their_pins() {
    let text = fs::read_to_string(example("xy-stage.toml")).unwrap();
    let (head, axes) = text.split_at(text.find("[[axis]]").unwrap());
    let axis = &axes[..axes[1..].find("[[axis]]").unwrap()];
    let with_scale = axis.replace(
        "[axis.pwm]",
        "[axis.scale]\ncounts_per_unit = 10_000_000\nuse = \"monitor\"\n\n[axis.pwm]",
    );
    let named = ["x", "y", "z", "w"].map(|name| with_scale.replacen("name = \"x\"", &format!("name = \"{name}\""), 1));
    let (_folder, output) = package(&format!("{head}{}", named.join("\n")));
    for (board, quartus, ..) in BOARDS {
        let project = output.join("sopc/quartus").join(board);
        let ports = verilog_ports(&project.join(format!("xy_stage_{board}.v")));
        // Clock, button, serial line, emergency stop; of each axis 11 lines in and 6 out.
        assert_eq!(ports.len(), 5 + 4 * 17);
        let (records, content) = check_project(quartus, &project.join(format!("xy_stage_{board}.qsf")), &ports);
        assert!(content, "{:#?}", findings(&records));
        let (records, content) = check_system(quartus, &output.join(format!("sopc/xy_stage_{board}_system.tcl")));
        assert!(content, "{:#?}", findings(&records));
    }
}

#[test]
fn cli_an_unknown_board_is_refused_with_those_that_are_known() {
    let machine = |target: &str| one_axis("kind = \"zvd\"", "frequency_hz = 100.0\ndamping = 0.1") + target;
    for (target, words) in [
        (
            "[target]\nfamily = \"cyclone2\"\nboard = \"de2\"\n",
            [
                "machine.toml:15: target.board",
                "\"de2\"",
                "de1 (cyclone2), de1soc (cyclone5)",
            ],
        ),
        (
            "[target]\nfamily = \"cyclone5\"\nboard = \"de1\"\n",
            ["machine.toml:15: target.board", "EP2C20F484C7", "cyclone2"],
        ),
    ] {
        let (folder, file) = scratch(&machine(target));
        let mut generate = posicast();
        let mut assert = generate
            .arg("generate")
            .arg(&file)
            .current_dir(folder.path())
            .assert()
            .code(2)
            .stdout("");
        for word in words {
            assert = assert.stderr(predicate::str::contains(word));
        }
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "something was written");
    }
}

#[test]
fn cli_another_clock_than_the_boards_gets_components_and_no_project() {
    let text = fs::read_to_string(example("xy-stage.toml")).unwrap();
    let (folder, file) = scratch(&text.replace("frequency_hz = 50_000_000", "frequency_hz = 40_000_000"));
    let output = folder.path().join("out");
    let generate = posicast()
        .arg("generate")
        .arg(&file)
        .arg("-o")
        .arg(&output)
        .assert()
        .success();
    generate.stderr(predicate::str::contains("no project for de1"));
    assert!(output.join("sopc/xy_stage_stage_hw.tcl").is_file());
    assert!(!output.join("sopc/quartus").exists());
    let readme = fs::read_to_string(output.join("README.md")).unwrap();
    assert!(
        readme.contains("its oscillator has 50 MHz, the machine's clock 40 MHz"),
        "{readme}"
    );
}

#[test]
fn cli_a_machine_of_shapers_alone_says_that_there_is_nothing_for_platform_designer() {
    let (_folder, output) = package(&one_axis("kind = \"zvd\"", "frequency_hz = 100.0\ndamping = 0.1"));
    assert!(!output.join("sopc").exists());
    let readme = fs::read_to_string(output.join("README.md")).unwrap();
    assert!(readme.contains("nothing for Platform Designer"), "{readme}");
}

#[test]
fn cli_a_package_is_the_same_every_time_and_refused_once_a_project_was_edited() {
    let (folder, output) = xy_stage();
    let manifest = fs::read_to_string(output.join("posicast.json")).unwrap();
    let mut again = posicast();
    again
        .arg("generate")
        .arg(folder.path().join("machine.toml"))
        .arg("-o")
        .arg(&output);
    again.assert().success();
    assert_eq!(fs::read_to_string(output.join("posicast.json")).unwrap(), manifest);
    replace(&output.join("sopc/quartus/de1/xy_stage_de1.qsf"), "PIN_A13", "PIN_A14");
    again
        .assert()
        .code(2)
        .stderr(predicate::str::contains("sopc/quartus/de1/xy_stage_de1.qsf"));
}
