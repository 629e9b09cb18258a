//! The inline shaper on the command line: from the example to Verilog that equals its model, a host at its line, and files that are refused.

use super::served::{Served, host};
use super::support::{assert_fits_schema, example, generate, json, posicast, scratch};
use posicast_blocks::linked_stage::address_limit;
use posicast_closed_loop::inline_bench::InlineBench;
use posicast_closed_loop::linked_bench::{LinkedBench, Registered};
use posicast_machine::hardware::Hardware;
use posicast_machine::machine_file;
use posicast_machine::plan::design_machine;
use predicates::prelude::*;

fn text() -> String {
    std::fs::read_to_string(example("inline.toml")).unwrap()
}

/// Generates the example with one text in place of another, and checks that it is refused at this line and with these words.
fn refused(from: &str, to: &str, words: &[&str]) {
    let text = text();
    assert!(text.contains(from), "the example has no `{from}`");
    let (folder, file) = scratch(&text.replacen(from, to, 1));
    let output = folder.path().join("out");
    let mut run = posicast();
    run.arg("generate").arg(&file).arg("-o").arg(&output);
    let mut assert = run.assert().code(2).stdout("");
    for word in words {
        assert = assert.stderr(predicate::str::contains(*word));
    }
    assert!(!output.exists());
}

#[test]
fn cli_inline_is_generated_with_its_modules_and_pages() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("router");
    generate(&example("inline.toml"), &output).success();
    let top = std::fs::read_to_string(output.join("rtl/router_inline.v")).unwrap();
    for pin in [
        "x_step_in",
        "z_direction",
        "drive_enable",
        "emergency_stop_n",
        "settled",
        "bypassed",
        "y_input_too_fast",
    ] {
        assert!(top.contains(pin), "{pin}");
    }
    for page in ["inline", "inline_axis", "step_generator", "pulse_counter", "shaper"] {
        assert!(output.join(format!("docs/{page}.md")).is_file(), "{page}");
    }
}

#[test]
fn long_cli_inline_verilog_equals_its_model() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("router");
    generate(&example("inline.toml"), &output).success();
    posicast()
        .arg("verify")
        .arg(&output)
        .args(["--block", "inline_shaper", "--block", "inline_group"])
        .assert()
        .success()
        .stdout(predicate::str::contains("inline_shaper"));
}

#[test]
fn cli_inline_is_run_between_a_controller_and_its_machine() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("router");
    let arguments = ["--cycles", "100000", "--move", "x=10,y=5,z=0.5", "-o"];
    posicast()
        .arg("run")
        .arg(example("inline.toml"))
        .args(arguments)
        .arg(&output)
        .assert()
        .success();
    let report = std::fs::read_to_string(output.join("report.json")).unwrap();
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    let inline = &report["inline"];
    assert_eq!(inline["side_by_side"]["mismatches"], 0, "{inline}");
    assert_eq!(inline["side_by_side"]["whole"], true, "{inline}");
    let steps = |axis: usize| {
        [
            &inline["axes"][axis]["sent_steps"],
            &inline["axes"][axis]["given_steps"],
        ]
        .map(|of| of.as_i64())
    };
    // 80 steps per mm, and 640 of z.
    assert_eq!(steps(0), [Some(800); 2]);
    assert_eq!(steps(1), [Some(400); 2]);
    assert_eq!(steps(2), [Some(320); 2]);
    assert!(output.join("plots/inline-vibration.svg").exists());
}

#[test]
fn cli_inline_pulses_that_the_filter_swallows_are_refused() {
    let words = [
        "machine.toml:30",
        "axis.input.pulse_s",
        "240.0 ns",
        "lower filter_clocks",
    ];
    refused("pulse_s = 5e-6  ", "pulse_s = 0.2e-6", &words);
}

#[test]
fn cli_inline_rates_beyond_the_lines_are_refused() {
    let words = ["axis.input.pulse_s of axis x", "at most", "lower the velocity"];
    refused("velocity = 500.0", "velocity = 1500.0", &words);
    let words = ["axis.steps.pulse_s of axis x", "limits.velocity"];
    refused("pulse_s = 2.5e-6", "pulse_s = 25e-6", &words);
    let words = ["axis.limits.velocity", "a step per tick more", "positive impulses"];
    refused("pulse_s = 2.5e-6", "pulse_s = 12.3e-6", &words);
    refused(
        "counts_per_unit = 80 ",
        "counts_per_unit = 8000 ",
        &["axis x", "2000000 steps/s"],
    );
}

#[test]
fn cli_inline_needs_steps_and_limits_on_every_axis() {
    refused("velocity = 500.0", "jerk = 500.0", &["axis.steps", "limits.velocity"]);
    let of_x = "[axis.input]\nkind = \"step_direction\"\nfilter_clocks = 10                    # 200 ns: what a cable picks up is shorter\n\
                pulse_s = 5e-6                        # as set in the controller\n";
    refused(
        of_x,
        "",
        &[
            "axis y with [axis.input] and axis x without",
            "add [axis.input] to axis x",
        ],
    );
}

/// The example with a serial line.
fn linked() -> String {
    format!("{}[link]\nbaud = 3_000_000\n", text())
}

#[test]
fn cli_inline_lines_that_cannot_be_are_refused() {
    let text = linked().replacen("50_000_000", "20_000_000", 1);
    let (_folder, file) = scratch(&text);
    posicast().arg("design").arg(&file).assert().code(2).stderr(
        predicate::str::contains("link.baud")
            .and(predicate::str::contains("what a clock of 20000000 Hz makes within 2 %")),
    );
    refused(
        "[clock]",
        "[link]\nbaud = 9600\n[clock]",
        &["link.baud", "115200 to 3000000"],
    );
    refused(
        "[clock]",
        "[link]\nline = \"avalon\"\nbaud = 115200\n[clock]",
        &["link.line", "uart, spi"],
    );
    refused(
        "[clock]",
        "[link]\nline = \"spi\"\nsck_hz = 10_000_000\n[clock]",
        &["link.sck_hz", "an eighth of the clock", "6250000"],
    );
    refused(
        "[clock]",
        "[link]\nbaud = 115200\ntimeout_s = 5.0\n[clock]",
        &["link.timeout_s"],
    );
}

#[test]
fn cli_inline_with_a_line_is_generated_with_its_registers_and_without_one_nothing_changes() {
    let folder = tempfile::tempdir().unwrap();
    let without = folder.path().join("without");
    generate(&example("inline.toml"), &without).success();
    let (_scratch, file) = scratch(&linked());
    let output = folder.path().join("router");
    let said = generate(&file, &output).success();
    said.stdout(predicate::str::contains(
        "router_inline (the inline shaper), router_link (the inline shaper with its serial line)",
    ));
    let top = std::fs::read_to_string(output.join("rtl/router_link.v")).unwrap();
    for pin in ["uart_rx", "uart_tx", "irq", "x_step_in", "drive_enable", "settled"] {
        assert!(top.contains(pin), "{pin}");
    }
    for path in [
        "docs/router_inline.md",
        "docs/uart_bridge.md",
        "driver/inc/posicast_inline.h",
        "driver/inc/posicast_inline_regs.h",
        "driver/src/posicast_inline.c",
    ] {
        assert!(output.join(path).is_file(), "{path}");
        assert!(!without.join(path).exists(), "{path}");
    }
    // What both have, but the axes and the group, is the same file.
    let inline = std::fs::read_to_string(without.join("rtl/router_inline.v")).unwrap();
    assert!(
        !inline.contains("avs_") && !inline.contains("bypass_request"),
        "{inline}"
    );
    let mut same = 0;
    for entry in std::fs::read_dir(without.join("rtl")).unwrap() {
        let name = entry.unwrap().file_name();
        let there = output.join("rtl").join(&name);
        if there.is_file() && std::fs::read(&there).unwrap() == std::fs::read(without.join("rtl").join(&name)).unwrap()
        {
            same += 1;
        }
    }
    assert!(same > 10, "{same}");
}

#[test]
fn long_cli_inline_verilog_with_a_line_equals_its_model() {
    let (folder, file) = scratch(&linked());
    let output = folder.path().join("router");
    generate(&file, &output).success();
    posicast()
        .arg("verify")
        .arg(&output)
        .args(["--block", "linked_inline_shaper", "--block", "registers"])
        .assert()
        .success()
        .stdout(predicate::str::contains("linked_inline_shaper"));
}

/// An inline shaper at a port, whose controller gives the axis X so many steps.
fn served(text: &str, steps: i64) -> Served<()> {
    let text = text.to_owned();
    Served::new(move |far, until| {
        let machine = machine_file::parse("machine.toml", &text).unwrap();
        let design = design_machine(&machine).unwrap();
        let hardware = Hardware::of(&machine, &design).unwrap();
        let component = hardware.inline().unwrap().unwrap().component.clone().unwrap();
        let mut bench = InlineBench::new(&component, 1).unwrap();
        bench.clocks(3_000_000).unwrap();
        bench.steps("x", steps).unwrap();
        bench.clocks(4_000_000).unwrap();
        let limit = address_limit(&component);
        let mut linked = LinkedBench::new(bench, &machine.link.unwrap(), &machine.clock, limit);
        linked.serve(far, until).unwrap();
    })
}

#[test]
fn cli_inline_host_shows_counts_switches_the_shaping_and_loads() {
    let text = linked();
    let (folder, file) = scratch(&text);
    let served = served(&text, -120);
    let run = |words: &[&str]| host(&served.port, &file, words);
    let (code, said, error) = run(&["status", "--json"]);
    assert_eq!(code, Some(0), "{error}");
    let document = json(said.as_bytes());
    assert_fits_schema("host-inline-status", &document);
    let x = &document["axes"][0];
    let counts = ["input_steps", "given_steps", "owed_steps"].map(|name| x[name].as_i64().unwrap());
    assert_eq!(counts, [-120, -120, 0], "{said}");
    assert_eq!(
        (&document["settled"], &document["fault"]),
        (&true.into(), &false.into()),
        "{said}"
    );

    let (code, said, error) = run(&["bypass", "on"]);
    assert_eq!(code, Some(0), "{error}");
    assert!(said.contains("no axis is shaped"), "{said}");
    let (_, said, _) = run(&["status"]);
    assert!(said.contains("router: enabled; no axis is shaped; settled"), "{said}");
    let (code, said, _) = run(&["bypass", "off"]);
    assert!(code == Some(0) && said.contains("all axes are shaped"), "{said}");

    let other = folder.path().join("zv.toml");
    std::fs::write(&other, text.replacen("kind = \"mzv\"", "kind = \"zv\"", 1)).unwrap();
    let (code, said, error) = run(&["load", "x", other.to_str().unwrap()]);
    assert_eq!(code, Some(0), "{error}");
    assert!(said.contains("read back and in use, in bank 1"), "{said}");
    let (code, said, _) = run(&["table", "x"]);
    assert!(code == Some(0) && said.contains("bank 1, loaded, in use"), "{said}");
    let (_, said, _) = run(&["table", "x", "--bank", "0"]);
    assert!(said.contains("bank 0, the machine's, not in use"), "{said}");

    for (words, expected) in [
        (
            vec!["move", "x=1"],
            "an inline shaper has no `move`: its controller moves the axes",
        ),
        (vec!["trace", "x", "-o", "x.csv"], "axis x has no trace memory"),
        (vec!["table", "w"], "no axis `w`"),
    ] {
        let (code, said, error) = run(&words);
        assert_eq!((code, said.as_str()), (Some(2), ""), "{words:?}");
        assert!(error.contains(expected), "{error}");
    }
    // Only the comment differs: it is another file.
    std::fs::write(&other, format!("{text}# changed\n")).unwrap();
    let (code, _, error) = host(&served.port, &other, &["bypass", "on"]);
    assert_eq!(code, Some(2));
    assert!(
        error.contains("was made from a machine file with the checksum"),
        "{error}"
    );
}

#[test]
fn cli_inline_host_records_positions() {
    let trace = "[axis.trace]\nsamples = 256\n\n[[axis]]\nname = \"y\"";
    let text = linked().replacen("[[axis]]\nname = \"y\"", trace, 1);
    assert!(text.contains("[axis.trace]"));
    let (folder, file) = scratch(&text);
    let served = served(&text, 120);
    let csv = folder.path().join("x.csv");
    let run = |words: &[&str]| {
        host(
            &served.port,
            &file,
            &[&["trace", "x", "-o", csv.to_str().unwrap()], words].concat(),
        )
    };
    let (code, _, error) = run(&["--shake", "3"]);
    assert!(code == Some(2) && error.contains("makes no test signal"), "{error}");
    assert!(!csv.exists());
    let (code, said, error) = run(&["--every", "3"]);
    assert_eq!(code, Some(0), "{error}");
    assert!(
        said.contains("128 rows of input_position, output_position, 0.0003 s apart"),
        "{said}"
    );
    let rows = std::fs::read_to_string(csv).unwrap();
    assert!(
        rows.starts_with("time_s,input_position,output_position\n") && rows.contains("\n0.000000000,120,120\n"),
        "{rows}"
    );

    // Without a line nobody could read it.
    refused(
        "[[axis]]\nname = \"y\"",
        trace,
        &[
            "axis x with [axis.input] and [axis.trace], without [link]",
            "add [link]",
        ],
    );
}

#[test]
fn cli_inline_host_refuses_a_stage_a_bypass_and_an_inline_shaper_without_a_line() {
    let (_folder, file) = scratch(&text());
    let (code, _, error) = host("/dev/null", &file, &["status"]);
    assert_eq!(code, Some(2));
    assert!(error.contains("the machine has no [link]"), "{error}");
    let stage = std::fs::read_to_string(example("xy-stage.toml")).unwrap();
    let (_folder, file) = scratch(&format!("{stage}[link]\nbaud = 3_000_000\n"));
    let (code, _, error) = host("/dev/null", &file, &["bypass", "on"]);
    assert_eq!(code, Some(2));
    assert!(error.contains("a stage has no `bypass`"), "{error}");
}

#[test]
fn cli_inline_words_and_lines_of_another_kind_are_refused() {
    refused(
        "kind = \"step_direction\"",
        "kind = \"step-direction\"",
        &["axis.input.kind", "step_direction, up_down, quadrature"],
    );
    refused(
        "pulse_s = 5e-6  ",
        "active_low = [\"step_up\"]\npulse_s = 5e-6",
        &["step_up", "`step` and `direction`"],
    );
    refused(
        "velocity = 500.0",
        "velocity = 500.0\nwatchdog_s = 0.5",
        &["watchdog_s with [axis.input]", "remove"],
    );
    refused(
        "filter_clocks = 10  ",
        "filter_clocks = 64",
        &["axis.input.filter_clocks", "0 to 63"],
    );
}
