//! Reading of valid and invalid logs.

use posicast_identify::Between;
use posicast_identify::log::{self, Log, LogError, Remark};
use posicast_identify::sweep::Sweep;
use posicast_identify::synthetic::{Sensor, known, resonance_test};

fn rows(header: &str, row: impl Fn(usize) -> String) -> String {
    let rows: Vec<String> = (0..100).map(row).collect();
    format!("{header}\n{}\n", rows.join("\n"))
}

fn error(text: &str) -> String {
    log::read(text.as_bytes()).unwrap_err().to_string()
}

#[test]
fn a_written_log_is_read_back() {
    let sweep = Sweep {
        end_hz: 10.0,
        ..Sweep::default()
    };
    let written = resonance_test(&[known(7.0, 0.05, 1.0)], &sweep, &Sensor::default(), 1);
    let mut text = Vec::new();
    written.write_csv(&mut text).unwrap();
    let reading = log::read(&text).unwrap();
    assert_eq!(reading.remarks, []);
    let Log::Acceleration(read) = reading.log else { panic!() };
    assert!((read.sample_s - written.sample_s).abs() < 1e-9);
    for ((name, read), (written_name, written)) in read.directions.iter().zip(&written.directions) {
        assert_eq!(name, written_name);
        assert_eq!(read.len(), written.len());
        assert!(read.iter().zip(written).all(|(a, b)| (a - b).abs() < 1e-6));
    }
}

#[test]
fn units_separators_and_other_columns_are_understood() {
    let text = rows("# bench 7\ntime_ms;temperature;command_mm;Response_um", |n| {
        format!("{n};21;{};{}", n / 50, n * n % 17)
    });
    let reading = log::read(text.as_bytes()).unwrap();
    assert_eq!(reading.remarks, [Remark::Unknown("temperature".into())]);
    let Log::Position(log) = reading.log else { panic!() };
    assert!((log.sample_s - 1e-3).abs() < 1e-15);
    assert_eq!(log.command[50], 1e-3);
    assert!((log.response[5] - 8e-6).abs() < 1e-15);
}

#[test]
fn logs_saved_by_spreadsheets_are_read() {
    let one = |n: usize| (n as f64 * 0.001, n / 50, n * n % 17);
    let plain = rows("time,command_mm,response_mm", |n| {
        format!("{:.3},{},{}", one(n).0, one(n).1, one(n).2)
    });
    let commas = rows("Time; Command [mm]; Response (mm)", |n| {
        format!("{:.3};{};{}", one(n).0, one(n).1, one(n).2).replace('.', ",")
    });
    let ended = rows("time,command_mm,response_mm", |n| {
        format!("{:.3},{},{},", one(n).0, one(n).1, one(n).2)
    });
    let lines = rows("time,command_mm,response_mm", |n| {
        format!("{:.3},{},{}\r", one(n).0, one(n).1, one(n).2)
    });
    let expected = log::read(plain.as_bytes()).unwrap();
    for other in [commas, ended, lines] {
        assert_eq!(log::read(other.as_bytes()).unwrap(), expected, "{}", &other[..80]);
    }
}

#[test]
fn logs_of_oscilloscopes_and_other_programs_are_read() {
    let one = |n: usize| [n as f64 * 0.001, (n / 50) as f64, (n * n % 17) as f64];
    let with = |header: &str, separator: &str, factors: [f64; 3]| {
        rows(header, |n| {
            let fields = one(n)
                .into_iter()
                .zip(factors)
                .map(|(value, factor)| format!("{}", value * factor));
            fields.collect::<Vec<_>>().join(separator)
        })
    };
    let plain = with("time,command,response", ",", [1.0; 3]);
    let Log::Position(expected) = log::read(plain.as_bytes()).unwrap().log else {
        panic!()
    };
    for text in [
        // A line of units below the names, with an empty one; a preamble; a spreadsheet's first line; spaces; other names.
        with("Time,Setpoint,Actual position\n(ms),(mm),(um)\n", ",", [1e3, 1e3, 1e6]),
        with(
            "Model,TDS2024\n\"Record length\",100\n\nTIME,Reference,Feedback",
            ",",
            [1.0; 3],
        ),
        with(
            "sep=|\nTime [s]|Commanded position [m]|Encoder [mm]",
            "|",
            [1.0, 1.0, 1e3],
        ),
        with("time  command  response", "   ", [1.0; 3]),
        with("Timestamp/ms;Target/mm;Actual/µm", ";", [1e3, 1e3, 1e6]),
        with("seconds,time,ref,position", ",", [1.0; 3]).replace("seconds,", ""),
    ] {
        let reading = log::read(text.as_bytes()).unwrap_or_else(|error| panic!("{}: {error}", &text[..60]));
        assert_eq!(reading.remarks, [], "{}", &text[..60]);
        let Log::Position(log) = reading.log else { panic!() };
        let close = |a: &[f64], b: &[f64]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9);
        assert!(
            close(&log.command, &expected.command) && close(&log.response, &expected.response),
            "{}",
            &text[..60]
        );
    }
    let wide: Vec<u8> = format!("\u{feff}{}", plain.replace(',', "\t"))
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    assert_eq!(log::read(&wide).unwrap().log, Log::Position(expected));
    for header in [
        "Time (s),Acceleration X (g),Acceleration Y (g)",
        "t,ax_g,ay_g",
        "time,x_accel_g,acc_y_g",
    ] {
        let Log::Acceleration(log) = log::read(with(header, ",", [1.0; 3]).as_bytes()).unwrap().log else {
            panic!()
        };
        let names: Vec<&str> = log.directions.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["accel_x_g", "accel_y_g"], "{header}");
        assert!((log.directions[0].1[50] - 9.806_65).abs() < 1e-12);
    }
}

#[test]
fn drive_logs_and_position_logs_are_distinguished() {
    let text = |header: &str| {
        rows(header, |n| {
            format!("{},{},{},{}", n as f64 * 1e-3, n % 7, n * n % 13, n % 3)
        })
    };
    let drive = log::read(text("time,torque_Nm,position,noise").as_bytes()).unwrap();
    let Log::Drive(log) = drive.log else { panic!() };
    assert_eq!((log.drive[5], log.position[5], log.sample_s), (5.0, 12.0, 1e-3));
    assert_eq!(drive.remarks, [Remark::Unknown("noise".into())]);
    let both = log::read(text("time,current_a,position,command").as_bytes()).unwrap();
    assert!(matches!(both.log, Log::Position(_)));
    assert!(
        matches!(&both.remarks[..], [Remark::Beside { column, .. }] if column == "current_a"),
        "{:?}",
        both.remarks
    );
}

#[test]
fn a_trace_of_the_stage_is_read_as_motor_and_scale() {
    let text = rows("time_s,captured_position,deviation", |n| {
        format!("{},{},{}", n as f64 * 1e-4, n, n % 3)
    });
    let Log::Position(log) = log::read(text.as_bytes()).unwrap().log else {
        panic!()
    };
    assert_eq!(
        (log.command[5], log.response[5], log.between),
        (5.0, 3.0, Between::Straight)
    );
}

#[test]
fn errors_name_line_and_column() {
    let good = |n: usize| format!("{},{},{}", n as f64 * 0.01, n / 50, n % 7);
    let with = |line: usize, bad: &str| {
        rows("time,command,response", |n| {
            if n + 2 == line { bad.to_owned() } else { good(n) }
        })
    };
    for (text, expected) in [
        (String::new(), "the log is empty"),
        ("0,1,2\n0.1,2,3\n".into(), "line 1 is the first and has no column names"),
        (
            rows("clock,response", good),
            "no column `time`: the columns are clock, response",
        ),
        (rows("time,command", good), "no column `response`"),
        (
            rows("time,response,position", good),
            "`response` and `position` mean the same",
        ),
        (with(30, "0.28,0"), "line 30 has 2 fields, but the header has 3"),
        (with(30, "0.28,0,nan"), "line 30, column `response`: `nan`"),
        // Lines are counted as an editor does, whatever ends them, and empty ones too.
        (
            with(30, "0.28,0,nan").replace('\n', "\r\n"),
            "line 30, column `response`: `nan`",
        ),
        (
            with(30, "0.28,0,nan").replacen('\n', "\n\n\n", 1),
            "line 32, column `response`: `nan`",
        ),
        (with(30, "\n\n0.28,0,nan"), "line 32, column `response`: `nan`"),
        (
            with(30, "0.28,0,nan").replace("\n0.1,", "\n# a remark\n0.1,"),
            "line 31",
        ),
        (with(30, "0.28,,5"), "line 30, column `command`: ``"),
        (with(30, "0.27,0,5"), "line 30: the time 0.27 s is not after 0.27 s"),
        (
            rows("time,response", |n| format!("{n},3")),
            "column `response` has the value 3 in every row",
        ),
        ("time,response\n0,1\n1,2\n".into(), "2 rows: at least 32 are needed"),
    ] {
        assert!(error(&text).contains(expected), "{expected}: {}", error(&text));
    }
    assert_eq!(log::read(b"\xff\xfe\n"), Err(LogError::Empty));
    assert_eq!(log::read(b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR"), Err(LogError::Binary));
}

#[test]
fn defects_are_mended_with_a_remark() {
    let gap = rows("time,response", |n| {
        format!("{},{}", if n < 30 { n } else { n + 10 }, n % 7)
    });
    let reading = log::read(gap.as_bytes()).unwrap();
    assert_eq!(reading.rows, 100);
    assert!(
        matches!(
            reading.remarks[..],
            [Remark::Gaps {
                missing: 10,
                samples: 110,
                places: 1,
                line: 31,
                longest_line: 31,
                ..
            }]
        ),
        "{:?}",
        reading.remarks
    );
    let Log::Position(log) = reading.log else { panic!() };
    assert_eq!(log.missing.first(), Some(&(30..40)));
    assert_eq!((log.response[29], log.response[40], log.sample_s), (1.0, 2.0, 1.0));

    let irregular = rows("time,response", |n| {
        format!("{},{}", n as f64 + 0.3 * (n as f64).sin(), n)
    });
    let reading = log::read(irregular.as_bytes()).unwrap();
    assert!(matches!(reading.remarks[..], [Remark::Irregular { .. }]));
    let Log::Position(log) = reading.log else { panic!() };
    // A ramp over the row becomes, interpolated, a ramp over the time, except for a swing of 0.3 rows and an error of
    // 0.3 rows at the end.
    assert!(
        log.response
            .iter()
            .enumerate()
            .all(|(n, x)| (x - n as f64).abs() < 0.65)
    );

    let flat = rows("time,accel_x,accel_y", |n| {
        format!(
            "{},9.8,{}",
            1e-3 * n as f64,
            (20.0 * (0.2 * n as f64).sin()).clamp(-15.0, 15.0)
        )
    });
    let reading = log::read(flat.as_bytes()).unwrap();
    assert!(
        matches!(
            reading.remarks[..],
            [Remark::Saturated { .. }, Remark::DeadDirection { .. }]
        ),
        "{:?}",
        reading.remarks
    );
    let Log::Acceleration(log) = reading.log else { panic!() };
    assert_eq!(log.directions.len(), 1);
}
