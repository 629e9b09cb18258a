//! Columns and units as the firmware and the tools of the field write them.

use posicast_identify::AccelerationLog;
use posicast_identify::log::{self, Log, LogError, ReadOptions, Remark};
use posicast_identify::ring_down;
use posicast_identify::synthetic::Noise;

const RATE_HZ: f64 = 1344.0;
const GRAVITY: f64 = 9.806_65;

/// What a sensor on a machine sees after its x axis has stopped, in g: x rings at 18.1 Hz (damping ratio 0.05), y a little at 51.6 Hz.
fn stop() -> Vec<[f64; 3]> {
    let mut noise = Noise::new(5);
    let ring = |hz: f64, damping: f64, t: f64| {
        let omega = std::f64::consts::TAU * hz;
        (-damping * omega * t).exp() * (omega * (1.0 - damping * damping).sqrt() * t).cos()
    };
    (0..806)
        .map(|n| {
            let t = f64::from(n) / RATE_HZ;
            [
                0.72 * ring(18.1, 0.05, t) + 0.003 * noise.draw(),
                0.06 * ring(51.6, 0.04, t) + 0.003 * noise.draw(),
                1.0 + 0.003 * noise.draw(),
            ]
        })
        .collect()
}

/// A file: its lines before the rows, each row, and its lines behind them.
fn file(header: &str, row: impl Fn(usize, &[f64; 3]) -> String, trailer: &str) -> String {
    let rows: Vec<String> = stop().iter().enumerate().map(|(n, g)| row(n, g)).collect();
    format!("{header}\n{}\n{trailer}", rows.join("\n"))
}

/// A row of a time in this unit and accelerations in this unit, with a separator.
fn row(time: f64, unit: f64, separator: &'static str) -> impl Fn(usize, &[f64; 3]) -> String {
    move |n, g| {
        let fields = [n as f64 / RATE_HZ / time, g[0] * unit, g[1] * unit, g[2] * unit];
        fields.map(|value| format!("{value:.6}")).join(separator)
    }
}

fn reading(text: &str, options: &ReadOptions) -> (AccelerationLog, Vec<Remark>) {
    let reading = log::read_with(text.as_bytes(), options).unwrap_or_else(|error| panic!("{}\n{error}", head(text)));
    let Log::Acceleration(log) = reading.log else {
        panic!("{}", head(text))
    };
    (log, reading.remarks)
}

fn head(text: &str) -> &str {
    let end = text.char_indices().nth(160).map_or(text.len(), |(at, _)| at);
    &text[..end]
}

/// Requires that a file is the log of the stop, in m/s², and that its mode is found along x.
fn is_the_stop(text: &str, options: &ReadOptions) -> Vec<Remark> {
    let (log, remarks) = reading(text, options);
    assert!(
        (log.sample_s * RATE_HZ - 1.0).abs() < 1e-3,
        "{}: {}",
        head(text),
        log.sample_s
    );
    let along = &log.directions.iter().find(|(name, _)| name.contains('x')).unwrap().1;
    for (read, truth) in along.iter().zip(stop()) {
        assert!(
            (read - truth[0] * GRAVITY).abs() < 0.02,
            "{}: {read} {truth:?}",
            head(text)
        );
    }
    let found = ring_down::identify(&log).unwrap();
    assert!(found.direction.contains('x'), "{}: {}", head(text), found.direction);
    let mode = found.modes[0].mode;
    assert!(
        (mode.frequency_hz / 18.1 - 1.0).abs() < 0.005,
        "{}: {mode:?}",
        head(text)
    );
    assert!((mode.damping / 0.05 - 1.0).abs() < 0.1, "{}: {mode:?}", head(text));
    remarks
}

#[test]
fn logs_of_firmware_and_tools_are_read_as_they_are() {
    let default = ReadOptions::default();
    let mm = 1e3 * GRAVITY;
    // The file as it is written by: Klipper; Klipper with a line of statistics; a port with a line end of another system in the header;
    // phyphox; Physics Toolbox; a sketch on a microcontroller; a logger of WitMotion; Gulf Coast Data Concepts (counts); spreadsheets.
    for text in [
        file("#time,accel_x,accel_y,accel_z", row(1.0, mm, ","), ""),
        file("##samples 806\n#time,accel_x,accel_y,accel_z", row(1.0, mm, ","), ""),
        file("#time,accel_x,accel_y,accel_z\r", row(1.0, mm, ","), ""),
        file(
            "\"Time (s)\",\"Acceleration x (m/s^2)\",\"Acceleration y (m/s^2)\",\"Acceleration z (m/s^2)\"",
            row(1.0, GRAVITY, ","),
            "",
        ),
        file(
            "Time (s)\tLinear Acceleration x (m/s²)\tLinear Acceleration y (m/s²)",
            row(1.0, GRAVITY, "\t"),
            "",
        )
        .lines()
        .map(|line| line.split('\t').take(3).collect::<Vec<_>>().join("\t") + "\n")
        .collect(),
        file("time_ms,accel_x_mg,accel_y_mg,accel_z_mg", row(1e-3, 1e3, ","), ""),
        file("t_us;ax_ms2;ay_ms2;az_ms2", row(1e-6, GRAVITY, ";"), ""),
        file("micros,AccX [g],AccY [g],AccZ [g]", row(1e-6, 1.0, ","), ""),
        file("Time(s)  ax(g)  ay(g)  az(g)", row(1.0, 1.0, "   "), ""),
        file("sep=;\nZeit (s);x [g];y [g];z [g]", row(1.0, 1.0, ";"), "").replace('.', ","),
        file("\u{feff}Time,AI 1/X,AI 2/Y,AI 3/Z\ns,g,g,g", row(1.0, 1.0, ","), "")
            .replace('\n', "\r\n")
            .replace("AI 1/X", "x"),
        file(
            "; a logger\n;SampleRate, 1344,Hz\n;Headers, time,Ax_g,Ay_g,Az_g",
            row(1.0, 1.0, ","),
            ";stopped: button\n",
        ),
        file(
            "time , accel_x (g), accel_y (g), accel_z (g),",
            |n, g| row(1.0, 1.0, ", ")(n, g) + ",",
            ",,,,\n",
        ),
    ] {
        let remarks = is_the_stop(&text, &default);
        assert_eq!(remarks, [], "{}", head(&text));
    }
}

#[test]
fn gravity_decides_the_unit_that_a_header_does_not_state() {
    for (header, unit, factor) in [
        ("time,x,y,z", "g", 1.0),
        ("Time,X,Y,Z", "m/s²", GRAVITY),
        ("timestamp,x-axis,y-axis,z-axis", "mm/s²", 1e3 * GRAVITY),
        ("time,gFx,gFy,gFz", "g", 1.0),
        ("time,accel_x,accel_y,accel_z", "m/s²", GRAVITY),
        ("time,x-acceleration,y-acceleration,z-acceleration", "g", 1.0),
    ] {
        let remarks = is_the_stop(&file(header, row(1.0, factor, ","), ""), &ReadOptions::default());
        assert!(
            matches!(&remarks[..], [Remark::Gravity { unit: decided, .. }] if *decided == unit),
            "{header}: {remarks:?}"
        );
    }
}

#[test]
fn samples_without_times_get_them_from_the_rate() {
    let numbered = |n: usize, g: &[f64; 3]| format!("{n},{:.3},{:.3},{:.3}", g[0], g[1], g[2]);
    let default = ReadOptions::default();
    // RepRapFirmware's rate stands in the last line, and its overflows are counted.
    let text = file("Sample,X,Y,Z", numbered, "Rate 1344, overflows 0\n");
    assert_eq!(is_the_stop(&text, &default), []);
    let overflowed = file("Sample,X,Y,Z", numbered, "Rate 1344, overflows 3\n");
    assert_eq!(is_the_stop(&overflowed, &default), [Remark::Overflows(3)]);
    // One axis alone is in g too.
    let one = file(
        "Sample,X",
        |n, g| format!("{n},{:.3}", g[0]),
        "Rate 1344, overflows 0\n",
    );
    assert_eq!(is_the_stop(&one, &default), []);
    // A sensor with a network port writes rate and overflows into columns.
    let columns = file(
        "Sample,X,Y,Z,Overflows,DataRate",
        |n, g| format!("{},0,1344", numbered(n, g)),
        "",
    );
    assert_eq!(is_the_stop(&columns, &default), []);
    // PicoQuake writes the rate above the header.
    let above = file(
        "# Config: data_rate = 1344.0 Hz, filter = 488 Hz\ncount,a_x,a_y,a_z",
        numbered,
        "",
    );
    assert!(matches!(
        is_the_stop(&above, &default)[..],
        [Remark::Gravity { unit: "g", .. }]
    ));
    // Without a rate it is asked for; a recording that the firmware broke off is refused with its words.
    let no_rate = file("Sample,X,Y,Z", numbered, "");
    assert_eq!(log::read(no_rate.as_bytes()), Err(LogError::NoRate));
    let rate = ReadOptions {
        rate_hz: Some(RATE_HZ),
        ..ReadOptions::default()
    };
    assert_eq!(is_the_stop(&no_rate, &rate), []);
    for words in ["Failed to collect data from accelerometer", "Received mismatched data"] {
        let broken = file("Sample,X,Y,Z", numbered, words);
        assert_eq!(
            log::read(broken.as_bytes()),
            Err(LogError::Recorder {
                line: 808,
                text: words.into()
            })
        );
    }
    // Times of day, over midnight, and no header at all.
    let clock = file(
        "DateTime;X;Y;Z",
        |n, g| {
            let s = 86_399.8 + n as f64 / RATE_HZ;
            let (day, s) = (1 + (s / 86_400.0) as u32, s % 86_400.0);
            format!(
                "2026-01-{day:02} {:02}:{:02}:{:09.6};{:.4};{:.4};{:.4}",
                (s / 3600.0) as u32,
                (s % 3600.0 / 60.0) as u32,
                s % 60.0,
                g[0],
                g[1],
                g[2]
            )
        },
        "",
    );
    assert!(matches!(is_the_stop(&clock, &default)[..], [Remark::Gravity { .. }]));
    let bare = file("0,0,0", |_, g| format!("{:.4},{:.4},{:.4}", g[0], g[1], g[2]), "");
    let bare = bare.trim_start_matches("0,0,0\n");
    let named = ReadOptions {
        columns: Some(["accel_x_g", "accel_y_g", "-"].map(String::from).to_vec()),
        rate_hz: Some(RATE_HZ),
    };
    assert_eq!(is_the_stop(bare, &named), []);
}

#[test]
fn ambiguous_columns_are_refused_with_the_option_that_decides() {
    let flat = |n: usize, g: &[f64; 3]| format!("{:.6},{:.4},{:.4},{:.4}", n as f64 / RATE_HZ, g[0], g[1], g[2] - 1.0);
    // Without gravity, three axes may be positions; so may one or two, and two sensors are two.
    for (text, accelerations, position) in [
        (
            file("time,x,y,z", flat, ""),
            "time,accel_x_g,accel_y_g,accel_z_g",
            "time,response,-,-",
        ),
        (
            file("time,x,y", |n, g| format!("{n},{},{}", g[0], g[1]), ""),
            "time,accel_x_g,accel_y_g",
            "time,response,-",
        ),
        (
            file("t_ms,y", |n, g| format!("{n},{}", g[1]), ""),
            "t_ms,accel_y_g",
            "t_ms,response",
        ),
        (
            file("time,x0,y0,x1,y1", |n, g| format!("{n},{},{},1,2", g[0], g[1]), ""),
            "time,accel_x_g,accel_y_g,-,-",
            "time,response,-,-,-",
        ),
        (
            file("time,x (mm),y (mm)", |n, g| format!("{n},{},{}", g[0], g[1]), ""),
            "time,accel_x_g,accel_y_g",
            "time,response,-",
        ),
    ] {
        let error = log::read(text.as_bytes()).unwrap_err();
        let LogError::Ambiguous {
            accelerations: one,
            position: other,
            ..
        } = &error
        else {
            panic!("{}: {error}", head(&text))
        };
        assert_eq!((one.as_str(), other.as_str()), (accelerations, position));
        assert!(
            error.to_string().contains(&format!("`--columns {accelerations}`")),
            "{error}"
        );
        // What it proposes decides it.
        for names in [one, other] {
            let options = ReadOptions {
                columns: Some(names.split(',').map(String::from).collect()),
                ..ReadOptions::default()
            };
            let read = log::read_with(text.as_bytes(), &options);
            let open = matches!(read, Err(LogError::TimeUnit { .. }));
            assert!(open || read.is_ok(), "{names}: {read:?}");
        }
    }
    // Beside a command, one column is its response.
    let driven = file("t_ms,u,y", |n, g| format!("{n},{},{}", n / 400, g[0]), "");
    assert!(matches!(log::read(driven.as_bytes()).unwrap().log, Log::Position(_)));
    for (header, expected) in [
        ("time,accel_x,acc_x", "`--columns NAME,NAME,…`"),
        ("time,position,actual", "`--columns NAME,NAME,…`"),
        ("time,timestamp,accel_x", "`time` and `timestamp` mean the same"),
        ("time,temperature,light", "`--columns NAME,NAME,…`"),
    ] {
        let text = file(header, |n, g| format!("{n},{},{}", g[0], g[1]), "");
        let error = log::read(text.as_bytes()).unwrap_err().to_string();
        assert!(error.contains(expected), "{header}: {error}");
    }
    let text = file("time,accel_x,accel_y,accel_z", row(1e-3, 1e3 * GRAVITY, ","), "");
    let error = log::read(text.as_bytes()).unwrap_err();
    assert!(matches!(error, LogError::TimeUnit { .. }), "{error}");
    assert!(error.to_string().contains("`--columns time_ms,…`"), "{error}");
    // Of two times, the one that states its unit is taken, and that is said.
    let text = file(
        "time,seconds_elapsed,z,y,x",
        |n, g| format!("{},{:.6},{},{},{}", 17e17, n as f64 / RATE_HZ, g[2], g[1], g[0]),
        "",
    );
    let remarks = is_the_stop(&text, &ReadOptions::default());
    assert!(
        remarks.contains(&Remark::OtherTime("time".into(), "seconds_elapsed".into())),
        "{remarks:?}"
    );
    for (names, expected) in [
        (vec!["time", "speed"], LogError::GivenName("speed".into())),
        (
            vec!["time", "accel_x", "-", "-", "-"],
            LogError::GivenCount { given: 5, fields: 4 },
        ),
    ] {
        let options = ReadOptions {
            columns: Some(names.into_iter().map(String::from).collect()),
            ..ReadOptions::default()
        };
        let text = file("time,x,y,z", flat, "");
        assert_eq!(log::read_with(text.as_bytes(), &options), Err(expected));
    }
}

#[test]
fn spectra_and_packed_files_are_refused_with_a_remedy() {
    let rows = |header: &str| {
        let rows: Vec<String> = (0..100)
            .map(|n| format!("{n}.5,1.6e+03,8.5e+03,2.9e+03,1.3e+04"))
            .collect();
        format!("{header}\n{}\n", rows.join("\n"))
    };
    for header in [
        "freq,psd_x,psd_y,psd_z,psd_xyz",
        "#freq,psd_x,psd_y,psd_z,psd_xyz",
        "freq,psd_x,psd_y,psd_z,psd_xyz,shapers:,zv(59.0),mzv(52.8)",
        "freq,belt_a,belt_b,c,d",
        "Frequency (Hz),X,Y,Z,all",
        "Frequency;PSD x;PSD y;PSD z;sum",
    ] {
        let separator = if header.contains(';') { ";" } else { "," };
        let error = log::read(rows(header).replace(',', separator).as_bytes()).unwrap_err();
        assert!(matches!(error, LogError::Spectrum(_)), "{header}: {error}");
        assert!(
            error.to_string().contains("`TEST_RESONANCES AXIS=X OUTPUT=raw_data`"),
            "{error}"
        );
    }
    for (bytes, expected) in [
        (&b"\x28\xb5\x2f\xfd\x04\x00"[..], "Shake&Tune"),
        (b"\x1f\x8b\x08\x00", "gunzip"),
        (b"PK\x03\x04\x14\x00", "save it as CSV"),
    ] {
        let error = log::read(bytes).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}
