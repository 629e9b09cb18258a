//! The registers on AXI4-Lite and Wishbone: from the machine file to Verilog that equals its model, and files that are refused.

use super::support::{example, generate, one_axis, posicast, scratch};
use predicates::prelude::*;

/// The XY stage with its registers on a bus.
fn xy_stage(bus: &str) -> String {
    let text = std::fs::read_to_string(example("xy-stage.toml")).unwrap();
    text.replacen("[target]", &format!("[target]\nbus = \"{bus}\""), 1)
}

#[test]
fn cli_buses_have_a_top_per_component_and_their_datasheet() {
    for (bus, suffix, block, port) in [
        ("axi4-lite", "axi", "axi_lite_bridge", "s_axi_awaddr"),
        ("wishbone", "wishbone", "wishbone_bridge", "wb_adr"),
    ] {
        let (folder, file) = scratch(&xy_stage(bus));
        let output = folder.path().join("xy_stage");
        let said = generate(&file, &output).success();
        said.stdout(predicate::str::contains(format!("xy_stage_stage_{suffix}")));
        for top in ["stage", "x_shaper", "y_pwm", "x_sliding_mode", "y_pulse_counter"] {
            let path = output.join(format!("rtl/xy_stage_{top}_{suffix}.v"));
            let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
            assert!(text.contains(port), "{}", path.display());
        }
        assert!(output.join(format!("docs/{block}.md")).is_file());
        // Cores for Vivado are on AXI4-Lite.
        let core = output.join(format!("amd/xy_stage_stage_{suffix}/component.xml"));
        assert_eq!(core.is_file(), bus == "axi4-lite");
        // The module for LiteX is on Wishbone; it names files of the package.
        let module = output.join("litex/posicast_xy_stage.py");
        assert_eq!(module.is_file(), bus == "wishbone");
        if bus == "wishbone" {
            let text = std::fs::read_to_string(module).unwrap();
            let sources: Vec<&str> = text.split('"').filter(|word| word.ends_with(".v")).collect();
            assert!(sources.contains(&"rtl/xy_stage_stage_wishbone.v"), "{sources:?}");
            assert!(
                sources.iter().all(|source| output.join(source).is_file()),
                "{sources:?}"
            );
        }
        let package = std::fs::read_to_string(output.join(format!("vhdl/xy_stage_stage_{suffix}_pkg.vhd"))).unwrap();
        assert_eq!(package.contains("PIPELINED : natural := 0"), bus == "wishbone");
        // The component itself stays what it is on its own bus.
        assert!(output.join("rtl/xy_stage_stage.v").is_file());
    }
}

#[test]
fn cli_buses_in_a_folder_equal_their_models_and_a_change_is_found() {
    let shaper = one_axis("kind = \"zv\"", "frequency_hz = 50.0\ndamping = 0.1");
    let (folder, file) = scratch(&format!(
        "{shaper}[axis.encoder]\nfilter_clocks = 4\n[target]\nbus = \"axi4-lite\"\n"
    ));
    let output = folder.path().join("one");
    generate(&file, &output).success();
    let verify = || {
        let mut verify = posicast();
        verify.arg("verify").arg(&output);
        verify.args(["--block", "axi_lite_bridge", "--block", "bus_component"]);
        verify
            .args(["--cycles", "5000", "--simulator", "icarus", "--edited"])
            .assert()
    };
    let said = verify().success();
    said.stdout(predicate::str::contains("pulse_counter, AXI4-Lite"));
    let top = output.join("rtl/one_x_pulse_counter_axi.v");
    let text = std::fs::read_to_string(&top).unwrap();
    let changed = text.replacen("assign avm_mapped = ", "assign avm_mapped = 1'b1 | ", 1);
    assert_ne!(changed, text);
    std::fs::write(&top, changed).unwrap();
    verify().code(1).stdout(predicate::str::contains("s_axi_"));
}

#[test]
fn cli_buses_that_do_not_fit_are_refused() {
    let shapers = std::fs::read_to_string(example("robot-joint.toml")).unwrap();
    for (text, words) in [
        (xy_stage("axi"), ["target.bus", "avalon, axi4-lite, wishbone"]),
        (
            format!("{shapers}\n[target]\nbus = \"wishbone\"\n"),
            ["target.bus", "nothing in this machine has registers"],
        ),
        (
            format!("{shapers}\n[target]\nboard = \"de1\"\n"),
            ["target.family", "cyclone2"],
        ),
    ] {
        let (folder, file) = scratch(&text);
        let output = folder.path().join("out");
        let mut run = posicast();
        let run = run.arg("generate").arg(&file).arg("-o").arg(&output).assert();
        let mut run = run.code(2).stdout("");
        for word in words {
            run = run.stderr(predicate::str::contains(word));
        }
        assert!(!output.exists());
    }
}
