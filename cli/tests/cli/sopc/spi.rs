//! The package of a stage whose line to the host is SPI.

use super::projects::{places_and_constrains, reached};
use super::{BOARDS, bound_ports, check_component, check_project, file_set, lint, package, replace, verilog_ports};
use crate::cli::support::{example, posicast};
use std::fs;
use std::path::PathBuf;

/// The inputs of the line.
const INPUTS: [&str; 3] = ["spi_sck", "spi_cs_n", "spi_mosi"];

fn machine() -> String {
    fs::read_to_string(example("xy-stage.toml")).unwrap() + "[link]\nline = \"spi\"\nsck_hz = 5_000_000\n"
}

/// Top module, component, projects and pages are those of SPI, and clean for Verilator.
#[test]
fn cli_a_stage_with_spi_is_complete() {
    let (_folder, output) = package(&machine());
    let read = |name: &str| fs::read_to_string(output.join(name)).unwrap();
    for (file, line) in [
        ("filelist.f", "rtl/xy_stage_link.v"),
        ("filelist.f", "rtl/posicast_spi_bridge.v"),
        ("README.md", "the stage and its SPI lines, up to 6250000 Hz"),
        ("README.md", "`posicast host spi:///dev/spidev0.0 status"),
        ("docs/spi_bridge.md", "# spi_bridge"),
        // The frames are in its page.
        ("docs/uart_bridge.md", "# uart_bridge"),
        // 10 ms at 50 MHz in units of 64 clocks, and the windows of the stage and its two axes.
        ("rtl/xy_stage_link.v", "(20'd7813)"),
        ("rtl/xy_stage_link.v", "(16'd768)"),
    ] {
        assert!(read(file).contains(line), "{file}: {line}");
    }
    assert!(!output.join("rtl/posicast_uart_bridge.v").exists());

    let verilog = verilog_ports(&output.join("rtl/posicast_spi_bridge.v"));
    let (records, content) = check_component(&output.join("sopc/xy_stage_spi_bridge_hw.tcl"));
    assert!(content && bound_ports(&records) == verilog, "{records:#?}");
    let terminated = records.iter().filter(|record| record[0] == "terminated");
    let terminated: Vec<String> = terminated.map(|record| record[1..].join(" ")).collect();
    assert_eq!(terminated, ["address_limit 768", "silence_limit 7813"]);
    lint(
        "posicast_spi_bridge",
        &file_set(&records, "QUARTUS_SYNTH", &output.join("sopc")),
    );

    let list = read("xy_stage.qip");
    let rtl = list.lines().filter_map(|line| line.split('"').nth(1));
    let rtl: Vec<PathBuf> = rtl.map(|name| output.join(name)).collect();
    for (board, quartus, clock_pin, device) in BOARDS {
        let (folder, name) = (format!("{board}_link"), format!("xy_stage_link_{board}"));
        let ends = ["*synchroniser_first *|pin_register_q", "*|armed"];
        places_and_constrains(&output, (&folder, &name), (quartus, clock_pin, device), &ends);
        let project = output.join("sopc/quartus").join(folder);
        let top = project.join(format!("{name}.v"));
        let (timing, _) = check_project(quartus, &project.join(format!("{name}.sdc")), &verilog_ports(&top));
        for line in INPUTS {
            let excluded = |record: &Vec<String>| record[0] == "false_path" && record[1] == line;
            assert!(timing.iter().any(excluded), "{line}");
        }
        lint(&name, &rtl.iter().cloned().chain([top]).collect::<Vec<_>>());
        let readme = read("README.md");
        let pins = &readme[readme.find(&format!("the copied `{name}.qsf`")).unwrap()..];
        for (place, line) in INPUTS.iter().enumerate() {
            let row = format!("| `{line}` | in | GPIO_0[{place}] |");
            assert!(pins.contains(&row), "{row}: {pins}");
        }
        assert!(pins.contains("| `spi_miso` | out | GPIO_0[3] |"), "{pins}");
    }
    // The timing excludes the first flip-flops of synchronisers, and the lines end in no others.
    let inputs = INPUTS.map(str::to_owned);
    for (line, register) in reached(&output, "posicast_spi_bridge", &inputs.each_ref()) {
        assert!(register.ends_with("synchroniser_first"), "{line} reaches {register}");
    }
}

#[test]
fn long_cli_verify_of_a_stage_with_spi_matches_and_finds_a_read_that_does_not_wait() {
    let (_folder, output) = package(&machine());
    let verify = |expected: i32| {
        let mut command = posicast();
        command
            .arg("verify")
            .arg(&output)
            .args(["--block", "linked_stage", "--edited"]);
        let run = command.output().unwrap();
        let text = String::from_utf8_lossy(&run.stdout).into_owned();
        assert_eq!(run.status.code(), Some(expected), "{text}");
        assert!(text.contains("x, y, SPI lines"), "{text}");
    };
    verify(0);
    replace(
        &output.join("rtl/xy_stage_link.v"),
        "(avm_read & ~read_before)",
        "(1'b0)",
    );
    verify(1);
}
