//! Tests the two simulators on hand-written Verilog: values, ports, errors, cache.

use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

use crate::bench::common::{COUNTER, Counter, Files, MEMORY, counter_ports, memory_ports, port};
use posicast_blocks::{ClockedBlock, Direction};
use posicast_testbench::Error;
use posicast_testbench::icarus::Icarus;
use posicast_testbench::verilator::{self, Verilated, VerilogSource};
use rand::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

fn same_as_model(device: &mut dyn ClockedBlock, clocks: usize) {
    let mut model = Counter::new();
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(1);
    let (mut expected, mut actual) = ([0; 2], [0; 2]);
    for clock in 0..clocks {
        let reset = u64::from(clock == 0 || rng.next_u64() % 50 == 0);
        let inputs = [reset, rng.next_u64() & 1, rng.next_u64() & 0x1ff];
        model.step(&inputs, &mut expected).unwrap();
        device.step(&inputs, &mut actual).unwrap();
        assert_eq!(actual, expected, "clock {clock}");
    }
}

#[test]
fn crosssim_both_simulators_count_as_the_model_does() {
    let files = Files::new(COUNTER);
    let ports = counter_ports();
    let source = VerilogSource {
        files: &files.files,
        top: "counter",
        ports: &ports,
    };
    same_as_model(&mut Verilated::build(&source, 1).unwrap(), 10_000);
    same_as_model(&mut Icarus::build(&source).unwrap(), 2_000);
    assert_eq!(verilator::lint(&files.files, "counter").unwrap(), Vec::<String>::new());
}

#[test]
fn memory_starts_at_random_by_seed_and_keeps_64_bits() {
    let files = Files::new(MEMORY);
    let ports = memory_ports();
    let source = VerilogSource {
        files: &files.files,
        top: "memory",
        ports: &ports,
    };
    let first_words = |seed| {
        let mut memory = Verilated::build(&source, seed).unwrap();
        let rows: Vec<u64> = (0..16).flat_map(|address| [0, address, 0]).collect();
        let mut words = [0; 16];
        memory.run(&rows, &mut words).unwrap();
        words
    };
    assert_eq!(first_words(5), first_words(5));
    assert_ne!(first_words(5), first_words(6));
    assert_ne!(first_words(5), [0; 16]);

    let mut memory = Verilated::build(&source, 1).unwrap();
    let mut seen = [0; 2];
    memory.run(&[1, 3, u64::MAX - 1, 0, 3, 0], &mut seen).unwrap();
    assert_eq!(seen[1], u64::MAX - 1);
    assert!(memory.run(&[1, 3], &mut seen).is_err(), "half a row");

    let mut icarus = Icarus::build(&source).unwrap();
    let unknown = icarus.step(&[0, 0, 0], &mut [0]).unwrap_err();
    assert!(unknown.to_string().contains("`q` is x or z"), "{unknown}");
}

#[test]
fn other_ports_are_named() {
    let files = Files::new(COUNTER);
    let mut ports = counter_ports();
    ports[2].width = 10;
    ports[3].direction = Direction::Input;
    ports[4].name = "absent".to_owned();
    let source = VerilogSource {
        files: &files.files,
        top: "counter",
        ports: &ports,
    };
    let error = Verilated::build(&source, 1).unwrap_err();
    let Error::Ports { problems, .. } = &error else {
        panic!("{error}")
    };
    assert_eq!(
        problems.join(";"),
        "  `a__step` has 9 bits, not 10;  `count` is not an input;  `absent` is missing;  `moving` is not expected"
    );
    assert!(matches!(Icarus::build(&source), Err(Error::ToolFailed { .. })));

    let mut ports = counter_ports();
    ports[2].width = 10;
    let source = VerilogSource {
        ports: &ports,
        ..source
    };
    assert!(matches!(Icarus::build(&source), Err(Error::Ports { .. })));

    let ports = [port("wide", Direction::Input, 65, false)];
    let source = VerilogSource {
        ports: &ports,
        ..source
    };
    assert!(matches!(Verilated::build(&source, 1), Err(Error::Unlike(_))));
}

#[test]
fn broken_and_missing_verilog_is_an_error_with_the_reason() {
    let files = Files::new("module counter(input wire clk);\n  nonsense here\nendmodule\n");
    let source = VerilogSource {
        files: &files.files,
        top: "counter",
        ports: &[],
    };
    for error in [
        Verilated::build_in(&files.cache(), &source, 1).unwrap_err(),
        Icarus::build(&source).unwrap_err(),
    ] {
        assert!(matches!(error, Error::ToolFailed { .. }), "{error}");
        assert!(error.to_string().contains("counter.v"), "{error}");
    }
    let left: Vec<_> = std::fs::read_dir(files.cache()).unwrap().collect();
    assert!(left.is_empty(), "a failed build leaves {left:?}");

    let nowhere = [files.folder.path().join("absent.v")];
    let source = VerilogSource {
        files: &nowhere,
        ..source
    };
    let error = Verilated::build_in(&files.cache(), &source, 1).unwrap_err();
    assert!(matches!(error, Error::File { .. }), "{error}");
}

#[test]
fn verilog_that_stops_or_never_settles_is_a_step_error() {
    let stops = "module stops(input wire clk, input wire stop, output wire q);
        assign q = 1'b0;
        always @(posedge clk) if (stop) begin $display(\"bye\"); $finish; end
        endmodule";
    let files = Files::new(stops);
    let ports = [
        port("stop", Direction::Input, 1, false),
        port("q", Direction::Output, 1, false),
    ];
    let source = VerilogSource {
        files: &files.files,
        top: "stops",
        ports: &ports,
    };
    let mut device = Verilated::build(&source, 1).unwrap();
    device.step(&[0], &mut [0]).unwrap();
    let error = device.step(&[1], &mut [0]).unwrap_err();
    assert!(error.to_string().contains("$finish"), "{error}");
    let mut device = Icarus::build(&source).unwrap();
    device.step(&[0], &mut [0]).unwrap();
    let stopped = device.step(&[1], &mut [0]).and_then(|()| device.step(&[0], &mut [0]));
    assert!(stopped.is_err());

    let loops = "module loops(input wire clk, input wire stop, output wire q);
        wire a; assign a = ~q & stop; assign q = a; endmodule";
    let files = Files::new(loops);
    let source = VerilogSource {
        files: &files.files,
        top: "loops",
        ports: &ports,
    };
    let mut device = Verilated::build(&source, 1).unwrap();
    let error = device.step(&[1], &mut [0]).unwrap_err();
    assert!(error.to_string().contains("converge"), "{error}");
}

#[test]
fn a_built_simulation_is_reused_and_parallel_builds_meet() {
    let files = Files::new(COUNTER);
    let ports = counter_ports();
    let source = VerilogSource {
        files: &files.files,
        top: "counter",
        ports: &ports,
    };
    std::thread::scope(|scope| {
        for seed in 1..=2 {
            let (files, source) = (&files, &source);
            scope.spawn(move || same_as_model(&mut Verilated::build_in(&files.cache(), source, seed).unwrap(), 100));
        }
    });
    // A rebuilt file would be a new file with the same name.
    let kept = |extension: &str| -> Vec<(PathBuf, u64)> {
        let entries = std::fs::read_dir(files.cache()).unwrap().map(Result::unwrap);
        let entries = entries.map(|entry| (entry.path(), entry.metadata().unwrap().ino()));
        let mut kept: Vec<_> = entries
            .filter(|(path, _)| path.extension().is_some_and(|e| e == extension))
            .collect();
        kept.sort();
        kept
    };
    let simulations = kept("so");
    assert_eq!(simulations.len(), 1);
    Verilated::build_in(&files.cache(), &source, 3).unwrap();
    assert_eq!(kept("so"), simulations);
    let build_another = |reset: &str| {
        std::fs::write(&files.files[0], COUNTER.replace("32'd0", reset)).unwrap();
        Verilated::build_in(&files.cache(), &source, 3)
    };
    build_another("32'd1").unwrap();
    assert_eq!(kept("so").len(), 2);
    // Its headers and Verilator's own C++ are compiled once, and reused.
    let (headers, runtime) = (kept("gch"), kept("o"));
    assert!(headers.len() == 1 && !runtime.is_empty());
    same_as_model(&mut build_another("32'h0").unwrap(), 100);
    assert_eq!((kept("gch"), kept("o")), (headers, runtime));
}

/// Half a shared object would end the process with SIGBUS.
#[test]
fn long_a_kept_file_that_was_damaged_is_made_anew() {
    let files = Files::new(COUNTER);
    let ports = counter_ports();
    let source = VerilogSource {
        files: &files.files,
        top: "counter",
        ports: &ports,
    };
    let build = || Verilated::build_in(&files.cache(), &source, 1);
    drop(build().unwrap());
    let kept: Vec<PathBuf> = std::fs::read_dir(files.cache())
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    // A new file with the name: the one before may still be mapped into this process.
    let replace = |path: &Path, bytes: &[u8]| {
        std::fs::remove_file(path).unwrap();
        std::fs::write(path, bytes).unwrap();
    };
    let of = |ending: &'static str| {
        kept.iter()
            .filter(move |path| path.extension().is_some_and(|e| e == ending))
    };
    let object = of("so").next().unwrap();
    let whole = std::fs::read(object).unwrap();
    assert_eq!(
        of("sha256").count(),
        of("so").count() + of("o").count() + of("gch").count()
    );

    // What is damaged alone is built from the kept objects, and those are made anew if they are damaged too.
    replace(object, &whole[..whole.len() / 2]);
    same_as_model(&mut build().unwrap(), 100);
    let again = std::fs::read(object).unwrap();
    assert_eq!(again.len(), whole.len());
    for path in of("so").chain(of("o")).chain(of("gch")) {
        let bytes = std::fs::read(path).unwrap();
        replace(path, &bytes[..bytes.len() / 2]);
    }
    same_as_model(&mut build().unwrap(), 100);
    for path in of("o").chain(of("gch")) {
        let sum = std::fs::read_to_string(format!("{}.sha256", path.display())).unwrap();
        let found = std::process::Command::new("sha256sum")
            .arg(path)
            .output()
            .unwrap()
            .stdout;
        assert_eq!(
            String::from_utf8_lossy(&found).split(' ').next().unwrap(),
            sum.trim(),
            "{}",
            path.display()
        );
    }
    // A file that fits its checksum and is no object of this system is made anew as well.
    replace(object, b"not an object");
    let sum = std::process::Command::new("sha256sum")
        .arg(object)
        .output()
        .unwrap()
        .stdout;
    let sum = String::from_utf8_lossy(&sum).split(' ').next().unwrap().to_owned();
    std::fs::write(format!("{}.sha256", object.display()), sum).unwrap();
    same_as_model(&mut build().unwrap(), 100);
}
