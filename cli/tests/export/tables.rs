//! Tables of numbers: each as its reader gives it back, to the last bit.

use super::readers::{matlab, table};
use super::{designed, export, mode, printer, refused, residual};
use crate::cli::support::{example, scratch};
use std::process::Command;

#[test]
fn cli_tables_have_the_numbers_of_the_design() {
    let machine = example("xy-stage.toml");
    let ours: Vec<(usize, [f64; 2])> = [0, 1]
        .into_iter()
        .flat_map(|axis| designed(&machine, axis).into_iter().map(move |pair| (axis, pair)))
        .collect();
    let csv = export(&machine, &["--to", "csv"]);
    assert!(csv.starts_with("axis,time_s,amplitude\n"), "{csv}");
    let expected: Vec<(String, [f64; 2])> = ours
        .iter()
        .map(|(axis, pair)| (["x", "y"][*axis].to_owned(), *pair))
        .collect();
    assert_eq!(table(&csv, ',', 1), expected);
    let expected: Vec<(String, [f64; 2])> = ours.iter().map(|(axis, pair)| (axis.to_string(), *pair)).collect();
    let numpy = export(&machine, &["--to", "numpy"]);
    assert_eq!(table(&numpy, ' ', 0), expected);
    let script = matlab(&export(&machine, &["--to", "matlab", "--axis", "y"]));
    let column = |of: usize| -> Vec<f64> { designed(&machine, 1).iter().map(|pair| pair[of]).collect() };
    assert_eq!(script.len(), 2);
    assert_eq!(script["xy_stage.y.time_s"], column(0));
    assert_eq!(script["xy_stage.y.amplitude"], column(1));
}

#[test]
fn cli_matlab_gets_no_keyword_as_a_name() {
    let (_folder, machine) =
        scratch(&printer(&[("try", "kind = \"zv\"", &mode(52.4, 0.06))]).replace("\"p\"", "\"switch\""));
    let script = matlab(&export(&machine, &["--to", "matlab"]));
    assert!(script.contains_key("switch_.try_.time_s"), "{script:?}");
}

/// NumPy itself, where it is installed.
#[test]
fn cli_numpy_loads_the_text() {
    let (folder, machine) = scratch(&printer(&[("x", "kind = \"mzv\"", &mode(52.4, 0.06))]));
    std::fs::write(folder.path().join("shaper.txt"), export(&machine, &["--to", "numpy"])).unwrap();
    let script = "import sys\ntry:\n    import numpy\nexcept ImportError:\n    sys.exit(77)\n\
                  a = numpy.loadtxt('shaper.txt')\nassert a.shape == (3, 3), a.shape\n\
                  print(repr(float(a[1, 1])), repr(float(a[1, 2])), a[:, 2].sum())\n";
    let Ok(output) = Command::new("python3")
        .args(["-c", script])
        .current_dir(folder.path())
        .output()
    else {
        return;
    };
    if output.status.code() == Some(77) {
        return;
    }
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let said = String::from_utf8(output.stdout).unwrap();
    let numbers: Vec<f64> = said.split_whitespace().map(|n| n.parse().unwrap()).collect();
    let [time, amplitude] = designed(&machine, 0)[1];
    assert_eq!(numbers[..2], [time, amplitude]);
    assert!((numbers[2] - 1.0).abs() < 1e-12, "{said}");
}

/// A C compiler reads the header, and a shaper in C computes what its numbers leave.
#[test]
fn cli_the_header_compiles_and_its_numbers_are_the_design() {
    let folder = tempfile::tempdir().unwrap();
    let machine = example("xy-stage.toml");
    std::fs::write(folder.path().join("shapers.h"), export(&machine, &["--to", "c"])).unwrap();
    // Included twice: the guard holds. Every array is printed.
    let mut main =
        "#include \"shapers.h\"\n#include \"shapers.h\"\n#include <stdio.h>\nint main(void) {\nint i;\n".to_owned();
    for axis in ["x", "y"] {
        let upper = axis.to_uppercase();
        main += &format!(
            "for (i = 0; i < XY_STAGE_{upper}_IMPULSES; i++) printf(\"{axis} %.17g %.17g\\n\", xy_stage_{axis}_time_s[i], xy_stage_{axis}_amplitude[i]);\n\
             for (i = 0; i < XY_STAGE_{upper}_TAPS; i++) printf(\"{axis}t %.17g %.17g\\n\", xy_stage_{axis}_delay_samples[i] / XY_STAGE_SAMPLE_HZ,\n\
             xy_stage_{axis}_coefficient[i] / (double) (1L << XY_STAGE_COEFFICIENT_FRACTION));\n"
        );
    }
    std::fs::write(folder.path().join("main.c"), main + "return 0; }\n").unwrap();
    let compiled = Command::new("gcc")
        .args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-o", "main", "main.c"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert!(
        compiled.status.success(),
        "{}",
        String::from_utf8_lossy(&compiled.stderr)
    );
    let said = Command::new(folder.path().join("main")).output().unwrap().stdout;
    let said = String::from_utf8(said).unwrap();
    let rows = table(&said, ' ', 0);
    let of = |name: &str| -> Vec<[f64; 2]> {
        rows.iter()
            .filter(|(row, _)| row == name)
            .map(|(_, pair)| *pair)
            .collect()
    };
    let modes = [(131.117015808451, 0.157799065776), (93.2897800884888, 0.153542487341)];
    for (index, (axis, (frequency_hz, damping))) in ["x", "y"].into_iter().zip(modes).enumerate() {
        assert_eq!(of(axis), designed(&machine, index));
        let taps = of(&format!("{axis}t"));
        let sum: f64 = taps.iter().map(|tap| tap[1]).sum();
        assert_eq!(sum, 1.0, "{axis}");
        // The integer taps leave next to nothing of the mode, as the impulses do.
        assert!(
            residual(&taps, frequency_hz, damping) < 1e-3,
            "{axis}: {}",
            residual(&taps, frequency_hz, damping)
        );
    }
}

#[test]
fn cli_designs_that_a_firmware_cannot_express_are_refused_with_a_remedy() {
    let two = format!("{}\n{}", mode(40.0, 0.1), mode(90.0, 0.05));
    let one = mode(40.0, 0.1);
    let cases = [
        (
            "klipper",
            "x",
            "kind = \"zvdd\"",
            &one,
            "does not have the kind `zvdd`",
            "mzv",
        ),
        (
            "klipper",
            "x",
            "kind = \"zvd\"",
            &two,
            "one mode per axis",
            "reprapfirmware",
        ),
        (
            "klipper",
            "x",
            "kind = \"two-hump-ei\"\ntolerance = 0.1",
            &one,
            "tolerance of 0.05",
            "set it to 0.05",
        ),
        ("klipper", "a", "kind = \"zvd\"", &one, "the axes x, y and z", "--axis"),
        ("kalico", "z", "kind = \"zvd\"", &one, "the axes x and y", "--axis"),
        ("kalico", "x", "kind = \"zvd\"", &two, "up to 5 impulses", "taps = 5"),
        ("marlin", "x", "kind = \"zvd\"", &one, "only ZV", "--to klipper"),
        (
            "marlin-ft",
            "x",
            "kind = \"ps-zv\"",
            &one,
            "does not have the kind `ps-zv`",
            "mzv",
        ),
        (
            "reprapfirmware",
            "x",
            "kind = \"zvd\"",
            &two,
            "2 to 5 impulses",
            "fewer impulses",
        ),
        ("reprapfirmware", "x", "kind = \"ps-zv\"", &one, "negative", "positive"),
    ];
    for (format, axis, shaper, modes, why, remedy) in cases {
        let (_folder, file) = scratch(&printer(&[(axis, shaper, modes)]));
        let said = refused(&file, &["--to", format]);
        assert!(
            said.contains(why) && said.contains(remedy) && said.contains("machine.toml"),
            "{said}"
        );
    }
    let custom = "kind = \"custom\"\nimpulses = [[0.0, 0.5], [0.02, 0.5]]";
    let (_folder, file) = scratch(&printer(&[("x", custom, "")]));
    let said = refused(&file, &["--to", "marlin"]);
    assert!(said.contains("`custom`") && said.contains("reprapfirmware"), "{said}");
    assert!(export(&file, &["--to", "kalico"]).contains("shaper_t_x: 0.0, 0.02\n"));
    let missing = refused(&example("xy-stage.toml"), &["--to", "csv", "--axis", "q"]);
    assert!(missing.contains("x, y"), "{missing}");
}
