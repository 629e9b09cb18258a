//! Unknown boards, clocks that a board does not have, machines without components, edited folders.

use super::{package, replace, xy_stage};
use crate::cli::support::{example, generate, one_axis, posicast, scratch};
use predicates::prelude::*;
use std::fs;

#[test]
fn cli_an_unknown_board_is_refused_with_those_that_are_known() {
    let machine = |target: &str| one_axis("kind = \"zvd\"", "frequency_hz = 100.0\ndamping = 0.1") + target;
    for (target, words) in [
        (
            "[target]\nfamily = \"cyclone2\"\nboard = \"de2\"\n",
            &["machine.toml:15: target.board", "\"de2\"", "allowed: de1, de1soc"][..],
        ),
        (
            "[target]\nfamily = \"cyclone5\"\nboard = \"de1\"\n",
            &[
                "machine.toml:15: target.board",
                "EP2C20F484C7",
                "help: write `family = \"cyclone2\"`, or leave out `board`",
            ],
        ),
    ] {
        let (folder, file) = scratch(&machine(target));
        for command in ["design", "generate"] {
            let mut run = posicast();
            let mut assert = run
                .arg(command)
                .arg(&file)
                .current_dir(folder.path())
                .assert()
                .code(2)
                .stdout("");
            for word in words {
                assert = assert.stderr(predicate::str::contains(*word));
            }
            assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "something was written");
        }
    }
}

#[test]
fn cli_another_clock_than_the_boards_gets_components_and_no_project() {
    let text = fs::read_to_string(example("xy-stage.toml")).unwrap();
    let (folder, file) = scratch(&text.replace("frequency_hz = 50_000_000", "frequency_hz = 40_000_000"));
    let output = folder.path().join("out");
    let generate = generate(&file, &output);
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
