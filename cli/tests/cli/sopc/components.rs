//! Components: their bindings agree with the Verilog, and they use nothing newer than version 13.0.

use super::{bound_ports, check_component, file_set, findings, lint, package, replace, verilog_ports, xy_stage};
use crate::cli::support::example;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Returns the files of the components, sorted.
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

/// Returns whether the component in this file is valid: known calls, and every port of its Verilog bound correctly.
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
        // The set is complete: nothing else is needed to elaborate it.
        let top = records.iter().find(|record| record[0] == "top").unwrap()[2].clone();
        lint(&top, &synthesis);
    }
}

#[test]
fn cli_a_component_matches_the_hardware() {
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
        ("embeddedsw.dts.compatible", "posicast,stage-2.2"),
    ] {
        assert_eq!(assignments.get(name), Some(&value), "{name}");
    }
    // All parameters that the header of the Verilog lists are present.
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

/// The bridge of the serial line: every port of its Verilog, the constants of the machine file terminated, and faults that are found.
#[test]
fn cli_the_bridge_is_a_host_with_the_constants_of_the_machine_file() {
    let (_folder, output) =
        package(&(fs::read_to_string(example("xy-stage.toml")).unwrap() + "[link]\nbaud = 3_000_000\n"));
    let file = output.join("sopc/xy_stage_uart_bridge_hw.tcl");
    let verilog = verilog_ports(&output.join("rtl/posicast_uart_bridge.v"));
    let text = fs::read_to_string(&file).unwrap();
    let holds = || {
        let (records, content) = check_component(&file);
        let terminated = records.iter().filter(|record| record[0] == "terminated");
        let terminated: Vec<String> = terminated.map(|record| record[1..].join(" ")).collect();
        // 3 Mbaud at 50 MHz (docs/uart_bridge.md), 10 ms of them in eighths of a bit, and windows of 256 words.
        let expected = ["address_limit 768", "baud_step 31457", "silence_limit 240000"];
        (
            content && bound_ports(&records) == verilog && terminated == expected,
            records,
        )
    };
    let (all_well, records) = holds();
    assert!(all_well, "{records:#?}");
    lint(
        "posicast_uart_bridge",
        &file_set(&records, "QUARTUS_SYNTH", &output.join("sopc")),
    );
    for (from, to) in [
        ("avalon start", "avalon end"),
        ("addressUnits WORDS", "addressUnits SYMBOLS"),
        ("avm_address address Output 16", "avm_address address Output 15"),
        ("add_interface_port line busy busy Output 1\n", ""),
        ("baud_step TERMINATION true", "baud_step TERMINATE true"),
        (
            "baud_step TERMINATION_VALUE 31457",
            "baud_step TERMINATION_VALUE 131457",
        ),
        ("set_port_property silence_limit", "set_port_property silence"),
    ] {
        replace(&file, from, to);
        assert!(!holds().0, "{from} -> {to} was not found");
        fs::write(&file, &text).unwrap();
    }
}
