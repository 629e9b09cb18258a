//! `[link]`: accepted and refused values, and the checksum of the machine file.

use super::files::{XY_STAGE, right, wrong};
use posicast_machine::hardware::Hardware;
use posicast_machine::machine_file::{LinkLine, parse_beside};
use posicast_machine::plan::design_machine;

fn refused(text: &str, expected: &str) {
    let problems = wrong(text).to_string();
    assert!(problems.contains(expected), "{problems}");
}

fn remedy(text: &str) -> String {
    wrong(text)
        .problems()
        .iter()
        .map(|problem| problem.remedy.clone())
        .collect()
}

#[test]
fn the_keys_and_their_defaults() {
    let link = right(&format!("{XY_STAGE}[link]\nbaud = 3_000_000\n")).link.unwrap();
    assert_eq!((link.line, link.timeout_s), (LinkLine::Uart { baud: 3_000_000 }, 0.01));
    let link = right(&format!("{XY_STAGE}[link]\nbaud = 115_200\ntimeout_s = 0.5\n"))
        .link
        .unwrap();
    assert_eq!((link.line, link.timeout_s), (LinkLine::Uart { baud: 115_200 }, 0.5));
    let link = right(&format!("{XY_STAGE}[link]\nline = \"spi\"\nsck_hz = 6_250_000\n"))
        .link
        .unwrap();
    assert_eq!((link.line, link.timeout_s), (LinkLine::Spi { sck_hz: 6_250_000 }, 0.01));
    assert_eq!(right(XY_STAGE).link, None);
}

/// The checksum is that of Python: `zlib.crc32(open("xy-stage.toml", "rb").read() + b"[link]\nbaud = 3_000_000\n")`.
#[test]
fn golden_the_checksum_is_that_of_the_file_and_is_a_register_of_the_stage() {
    let machine = right(&format!("{XY_STAGE}[link]\nbaud = 3_000_000\n"));
    assert_eq!(machine.link.unwrap().machine_crc, GOLDEN_CRC);
    let design = design_machine(&machine).unwrap();
    let hardware = Hardware::of(&machine, &design).unwrap();
    let stage = &hardware.stage().unwrap().unwrap().component;
    let register = stage.map().register("machine_crc").unwrap();
    assert_eq!((register.offset, register.reset()), (6, GOLDEN_CRC));
    let plain = right(XY_STAGE);
    let design = design_machine(&plain).unwrap();
    let hardware = Hardware::of(&plain, &design).unwrap();
    let stage = &hardware.stage().unwrap().unwrap().component;
    assert!(stage.map().register("machine_crc").is_none());
}

const GOLDEN_CRC: u32 = 0x2d89_ae6a;

#[test]
fn the_checksum_includes_the_files_beside_the_machine_file() {
    let table = "[axis.error_table]\nfile = \"x.csv\"\n\n";
    let text =
        format!("{XY_STAGE}[link]\nbaud = 3_000_000\n").replacen("[axis.limits]", &format!("{table}[axis.limits]"), 1);
    let crc = |csv: &str| {
        let machine = parse_beside("xy.toml", &text, &|_| Ok(csv.to_owned())).unwrap();
        machine.link.unwrap().machine_crc
    };
    let csv = "position,error\n-0.1,0\n0.1,0.00001\n";
    assert_eq!(crc(csv), crc(csv));
    assert_ne!(crc(csv), crc("position,error\n-0.1,0\n0.1,0.00002\n"));
}

#[test]
fn a_baud_rate_that_the_clock_does_not_make_is_refused_with_the_nearest() {
    let slow = XY_STAGE.replace("frequency_hz = 50_000_000", "frequency_hz = 20_000_000");
    let text = format!("{slow}[link]\nbaud = 3_000_000\n");
    refused(
        &text,
        "link.baud: found 3_000_000; allowed: what a clock of 20000000 Hz makes within 2 %: at most 2550981 baud",
    );
    assert_eq!(
        remedy(&text),
        "write `baud = 2_000_000`, the nearest of the usual rates, or 2_550_981, the nearest of all; or raise clock.frequency_hz to \
         at least 23520359 Hz"
    );
    right(&format!("{slow}[link]\nbaud = 2_000_000\n"));
    right(&format!("{slow}[link]\nbaud = 2_550_981\n"));
}

#[test]
fn values_out_of_range_and_missing_ones_are_refused() {
    refused(
        &format!("{XY_STAGE}[link]\nbaud = 9_600\n"),
        "link.baud: found 9_600; allowed: a whole number, 115200 to 3000000",
    );
    refused(&format!("{XY_STAGE}[link]\n"), "link.baud: found no such key");
    refused(
        &format!("{XY_STAGE}[link]\nbaud = 3_000_000\ntimeout_s = 0.1\n"),
        "link.timeout_s: found 0.1; allowed: 6.7e-6 s to 0.044 s at 3000000 baud",
    );
    refused(&format!("{XY_STAGE}[link]\nbaud = 3_000_000\nparity = 1\n"), "parity");
}

#[test]
fn a_host_whose_spi_clock_is_too_fast_is_refused_with_the_fastest() {
    let text = format!("{XY_STAGE}[link]\nline = \"spi\"\nsck_hz = 10_000_000\n");
    refused(
        &text,
        "link.sck_hz: found 10_000_000; allowed: at most an eighth of the clock of 50000000 Hz: 6250000",
    );
    assert_eq!(
        remedy(&text),
        "write `sck_hz = 6_250_000`, or raise clock.frequency_hz to at least 80000000 Hz"
    );
}

#[test]
fn keys_and_time_outs_that_do_not_suit_the_line_are_refused() {
    for (text, expected) in [
        ("line = \"spi\"\nbaud = 3_000_000", "baud, and line = \"spi\""),
        ("baud = 3_000_000\nsck_hz = 1_000_000", "sck_hz, and line = \"uart\""),
        ("line = \"spi\"", "link.sck_hz: found no such key"),
        ("line = \"i2c\"\nbaud = 3_000_000", "i2c"),
        (
            "line = \"spi\"\nsck_hz = 1_000_000\ntimeout_s = 0.00001",
            "link.timeout_s: found 0.00001; allowed: at least two bytes, 1.6e-5 s at sck_hz = 1000000",
        ),
        (
            "line = \"spi\"\nsck_hz = 1_000_000\ntimeout_s = 0.00002",
            "link.timeout_s: found 0.00002; allowed: 5.2e-5 s to 1.200 s at a clock of 50000000 Hz",
        ),
    ] {
        refused(&format!("{XY_STAGE}[link]\n{text}\n"), expected);
    }
    right(&format!(
        "{XY_STAGE}[link]\nline = \"spi\"\nsck_hz = 1_000_000\ntimeout_s = 5.2e-5\n"
    ));
}

/// Each remedy leads to a file that is accepted.
#[test]
fn remedies_for_keys_of_the_other_line() {
    for (text, expected) in [
        (
            "line = \"spi\"",
            "add the clock of the host, such as `sck_hz = 6_250_000`",
        ),
        (
            "line = \"spi\"\nbaud = 3_000_000",
            "replace baud by sck_hz; or write `line = \"uart\"`",
        ),
        (
            "line = \"spi\"\nbaud = 3_000_000\nsck_hz = 1_000_000",
            "remove baud; or write `line = \"uart\"` and remove sck_hz",
        ),
        (
            "sck_hz = 1_000_000",
            "write `line = \"spi\"`; or replace sck_hz by baud",
        ),
        (
            "baud = 3_000_000\nsck_hz = 1_000_000",
            "remove sck_hz; or write `line = \"spi\"` and remove baud",
        ),
    ] {
        assert_eq!(remedy(&format!("{XY_STAGE}[link]\n{text}\n")), expected);
    }
}

#[test]
fn a_machine_without_a_stage_has_no_line() {
    let shapers = XY_STAGE.split("[axis.encoder]").next().unwrap();
    refused(
        &format!("{shapers}[link]\nbaud = 3_000_000\n"),
        "[link] beside axis x, which lacks a part of its loop",
    );
}
