//! Systems: everything is connected, and the top level fits around them.

use super::{BOARDS, check_system, findings, lint, replace, xy_stage};
use std::fs;

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
        // A box replaces the system, with the ports that Platform Designer would give it; the top level must fit it.
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
