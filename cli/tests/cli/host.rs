//! `posicast host`, on the model of the stage with its machine behind a pseudo-terminal.

use super::served::{Served, host};
use super::support::{assert_fits_schema, example, generate, json, posicast, scratch};
use posicast_blocks::linked_stage::address_limit;
use posicast_closed_loop::linked_bench::LinkedBench;
use posicast_closed_loop::stage_bench::StageBench;
use posicast_machine::hardware::Hardware;
use posicast_machine::machine_file;
use posicast_machine::plan::design_machine;
use posicast_machine::plant::axis::{AxisPlant, PlantOptions};
use serialport::{SerialPort, TTYPort};
use std::path::Path;

/// The example with a line, and for X a trace and room for a test signal.
fn machine() -> String {
    let text = std::fs::read_to_string(example("xy-stage.toml")).unwrap();
    let text = text.replacen("[axis.pwm]", "[axis.trace]\nsamples = 256\n[axis.pwm]", 1);
    let text = text.replacen("[axis.limits]", "[axis.limits]\nexcitation = 100e-6\n", 1);
    format!("{text}[link]\nbaud = 3_000_000\n")
}

/// A stage with its machine at a port; its end returns where the axes of the machine are, in counts.
fn served(text: &str) -> Served<[i64; 2]> {
    let text = text.to_owned();
    Served::new(move |far, until| {
        let machine = machine_file::parse("machine.toml", &text).unwrap();
        let design = design_machine(&machine).unwrap();
        let hardware = Hardware::of(&machine, &design).unwrap();
        let stage = hardware.stage().unwrap().unwrap();
        let plant = |axis| AxisPlant::new(axis, &machine.clock, &PlantOptions::default()).unwrap();
        let plants = machine.axes.iter().map(plant).collect();
        let bench = StageBench::new(&stage.of_machine.config, &stage.component, plants, None, 1).unwrap();
        let limit = address_limit(&stage.component);
        let mut linked = LinkedBench::new(bench, &machine.link.unwrap(), &machine.clock, limit);
        linked.serve(far, until).unwrap();
        [0, 1].map(|axis| linked.bench.plant(axis).count())
    })
}

#[test]
fn cli_host_shows_moves_records_and_loads() {
    let text = machine();
    let (folder, file) = scratch(&text);
    let served = served(&text);
    let run = |words: &[&str]| host(&served.port, &file, words);
    let (code, said, error) = run(&["status", "--json"]);
    assert_eq!(code, Some(0), "{error}");
    let document = json(said.as_bytes());
    assert_fits_schema("host-status", &document);
    let x = &document["axes"][0];
    assert_eq!(
        (x["state"].as_str(), x["causes"][0].as_str()),
        (Some("OFF"), Some("pwm-tripped"))
    );

    let (code, said, error) = run(&["move", "x=0.001,y=-0.0005"]);
    assert_eq!(code, Some(0), "{error}");
    assert!(said.contains("x     READY  none") && said.contains("0.001 m"), "{said}");
    let (code, _, error) = run(&["move", "x=0.2"]);
    assert_eq!(code, Some(2));
    assert!(
        error.contains("beyond its soft limits of -100000 and 100000"),
        "{error}"
    );

    let csv = folder.path().join("x.csv");
    let (code, said, error) = run(&["trace", "x", "--shake", "60", "-o", csv.to_str().unwrap()]);
    assert_eq!(code, Some(0), "{error}");
    assert!(said.contains("128 rows of command, captured_position"), "{said}");
    let log = std::fs::read_to_string(&csv).unwrap();
    // The second line says that posicast wrote the file.
    assert!(
        log.starts_with("time_s,drive_command,captured_position\n# written by posicast"),
        "{log}"
    );
    assert_eq!(log.lines().count(), 130);
    // 128 rows are too few for a mode, but enough for a reader.
    let identified = posicast().arg("identify").arg(&csv).output().unwrap();
    assert_ne!(
        identified.status.code(),
        Some(2),
        "{}",
        String::from_utf8_lossy(&identified.stderr)
    );
    let vcd = folder.path().join("x.vcd");
    let (code, _, error) = run(&["trace", "x", "--signals", "error", "-o", vcd.to_str().unwrap()]);
    assert_eq!(code, Some(0), "{error}");
    assert!(std::fs::read_to_string(&vcd).unwrap().contains("error"));

    let other = folder.path().join("zv.toml");
    std::fs::write(&other, text.replacen("kind = \"zvd\"", "kind = \"zv\"", 1)).unwrap();
    let (code, said, error) = run(&["load", "x", other.to_str().unwrap()]);
    assert_eq!(code, Some(0), "{error}");
    assert!(said.contains("read back and in use, in bank 1"), "{said}");

    // Only the comment differs: it is another file.
    std::fs::write(&other, format!("{text}# changed\n")).unwrap();
    let (code, said, error) = host(&served.port, &other, &["move", "x=0.001"]);
    assert_eq!((code, said.as_str()), (Some(2), ""));
    assert!(
        error.contains("was made from a machine file with the checksum") && error.contains("and this one has"),
        "{error}"
    );
    let [x, y] = served.end();
    assert!((x - 1000).abs() < 70 && (y + 500).abs() <= 2, "{x} {y}");
}

#[test]
fn cli_host_names_what_is_missing() {
    let text = machine();
    let (folder, file) = scratch(&text);
    let fails = |port: &str, machine: &Path, words: &[&str], code: i32, expected: &str| {
        let mut command = posicast();
        let command = command.args(["host", port]).args(words).arg("--machine").arg(machine);
        let output = command.args(["--timeout", "5"]).output().unwrap();
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "{words:?}: {error}");
        assert!(error.contains(expected), "{words:?}: {error}");
        assert!(output.stdout.is_empty());
    };
    fails("/dev/no-such-port", &file, &["status"], 3, "/dev/no-such-port: ");
    // A port at which nobody answers: another baud rate looks like this.
    let (_far, near) = TTYPort::pair().unwrap();
    let port = near.name().unwrap();
    drop(near);
    fails(
        &port,
        &file,
        &["status"],
        3,
        "3000000 baud: no reply in 5 attempts of 5 ms, 0 damaged frames: is the hardware powered, are the wires",
    );
    fails(
        &port,
        &file,
        &["status", "--baud", "115200"],
        3,
        "115200 baud: no reply",
    );
    let plain = folder.path().join("plain.toml");
    std::fs::write(&plain, std::fs::read_to_string(example("xy-stage.toml")).unwrap()).unwrap();
    fails(&port, &plain, &["status"], 2, "the machine has no [link]");
    fails(
        "spi:///dev/spidev0.0",
        &file,
        &["status"],
        2,
        "has a serial line, not SPI",
    );
    fails(&port, &file, &["move", "z=1"], 2, "no axis `z`");
    fails(&port, &file, &["move", "x=0"], 2, "0 for axis x is not a distance");
    fails(
        &port,
        &file,
        &["trace", "y", "-o", "y.csv"],
        2,
        "axis y has no trace memory",
    );
    fails(
        &port,
        &file,
        &["trace", "x", "-o", "x.txt"],
        2,
        "a trace is written as CSV or VCD",
    );
    let csv = folder.path().join("x.csv");
    fails(
        &port,
        &file,
        &["trace", "x", "--shake", "200", "-o", csv.to_str().unwrap()],
        2,
        "at most 100.00 counts",
    );
    assert!(!csv.exists());
}

#[test]
fn cli_host_reports_errors_of_an_spi_device() {
    let text = std::fs::read_to_string(example("xy-stage.toml")).unwrap();
    let (_folder, file) = scratch(&(text + "[link]\nline = \"spi\"\nsck_hz = 5_000_000\ntimeout_s = 100e-6\n"));
    let hz = "hz must be a whole number from 160000 (";
    for (port, baud, code, expected) in [
        (
            "spi:///dev/no-such-device",
            false,
            3,
            "/dev/no-such-device: No such file",
        ),
        ("spi:///dev/no-such-device?hz=1_000_000", false, 3, "is SPI switched on"),
        ("spi:///dev/null", false, 3, "is it an SPI device?"),
        ("spi:///dev/null?hz=7000000", false, 2, hz),
        ("spi:///dev/null?hz=159999", false, 2, hz),
        ("spi:///dev/null?hz=fast", false, 2, hz),
        ("spi:///dev/null?clock=1", false, 2, "write spi:///dev/spidev0.0"),
        ("spi://spidev0.0", false, 2, "write spi:///dev/spidev0.0"),
        (
            "SPI:///dev/null",
            false,
            2,
            "write spi:///dev/spidev0.0, udp://HOST:PORT",
        ),
        ("", false, 2, "write spi:///dev/spidev0.0, udp://HOST:PORT"),
        ("udp://127.0.0.1", false, 2, "write udp://HOST:PORT"),
        ("udp://:4210", false, 2, "write udp://HOST:PORT"),
        ("udp://127.0.0.1:99999", false, 2, "write udp://HOST:PORT"),
        ("/dev/ttyUSB0", false, 2, "has SPI, not a serial line"),
        ("spi:///dev/null", true, 2, "is not a serial line"),
    ] {
        let mut command = posicast();
        command.args(["host", port, "status", "--machine"]).arg(&file);
        command.args(["--baud", "115200"].iter().filter(|_| baud));
        let output = command.output().unwrap();
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "{port}: {error}");
        assert!(error.contains(expected), "{port}: {error}");
    }
}

#[test]
fn cli_generate_writes_the_stage_with_its_line() {
    let (folder, file) = scratch(&machine());
    let output = folder.path().join("out");
    generate(&file, &output);
    let read = |name: &str| std::fs::read_to_string(output.join(name)).unwrap();
    for (list, line) in [
        ("filelist.f", "rtl/xy_stage_link.v"),
        ("filelist.f", "rtl/posicast_uart_bridge.v"),
        ("xy_stage.qip", "rtl/xy_stage_link.v"),
        ("xy_stage.core", "rtl/xy_stage_link.v"),
        ("README.md", "the stage and its serial line of 3000000 baud"),
        ("docs/uart_bridge.md", "# uart_bridge"),
    ] {
        assert!(read(list).contains(line), "{list}: {line}");
    }
    let top = read("rtl/xy_stage_link.v");
    // 8 · 3,000,000 / 50,000,000 in 65,536ths; 10 ms in eighths of a bit; the windows of the stage and its two axes.
    for constant in ["(16'd31457)", "(20'd240000)", "(16'd768)"] {
        assert!(top.contains(constant), "{constant}: {top}");
    }
    // The checksum of the file is in the stage, and the machine file in the folder is the same file.
    assert_eq!(read("machine.toml"), machine());
}
