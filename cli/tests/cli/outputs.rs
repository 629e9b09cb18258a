//! Files under a name that the user gave: inputs and other people's files are not replaced; pipes and devices are
//! written to.

#![cfg(test)] // lets clippy see that this is test code

use crate::cli::support::{one_axis, posicast, scratch};
use std::path::{Path, PathBuf};

struct Bench {
    folder: tempfile::TempDir,
    machine: String,
}

/// A folder with a machine file, a command, and two waveforms that differ.
fn bench() -> Bench {
    let machine = one_axis("kind = \"zv\"", "frequency_hz = 50.0\ndamping = 0.1");
    let (folder, _) = scratch(&machine);
    let bench = Bench { folder, machine };
    for (name, target) in [("a", 0.001), ("b", 0.002)] {
        let command = format!("time_s,position\n0,0\n0.001,{target}\n");
        std::fs::write(bench.path(&format!("{name}.csv")), command).unwrap();
        let wave = format!("{name}.vcd");
        bench.status(
            0,
            &[
                "simulate",
                "machine.toml",
                "--command",
                &format!("{name}.csv"),
                "-o",
                &wave,
            ],
        );
    }
    bench
}

impl Bench {
    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap()
    }

    /// Checks the exit status and returns what the command prints on standard error.
    fn status(&self, status: i32, words: &[&str]) -> String {
        let output = posicast().current_dir(self.folder.path()).args(words).output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(status), "{words:?}: {said}");
        if status == 2 {
            assert!(output.stdout.is_empty(), "{words:?}");
        }
        said
    }

    fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.folder.path()).unwrap();
        let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
}

/// Every command that writes a file under a given name, with `OUT` in its place; its exit status; and the file that
/// it writes.
const WRITERS: [(&[&str], i32, &str); 5] = [
    (
        &["simulate", "machine.toml", "--command", "a.csv", "-o", "OUT"],
        0,
        "--output",
    ),
    (
        &["simulate", "machine.toml", "--command", "a.csv", "--json", "-o", "OUT"],
        0,
        "--output",
    ),
    (&["design", "machine.toml", "--plot", "OUT"], 0, "--plot"),
    (&["diff", "a.vcd", "b.vcd", "--junit", "OUT"], 1, "--junit"),
    (&["diff", "a.vcd", "b.vcd", "--show", "OUT"], 1, "--show"),
];

fn with<'a>(words: &[&'a str], out: &'a str, force: bool) -> Vec<&'a str> {
    let words = words.iter().map(|word| if *word == "OUT" { out } else { *word });
    words.chain(force.then_some("--force")).collect()
}

#[test]
fn cli_no_command_replaces_what_it_reads() {
    let bench = bench();
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("machine.toml", bench.path("link.toml")).unwrap();
        std::fs::hard_link(bench.path("machine.toml"), bench.path("hard.toml")).unwrap();
        std::fs::hard_link(bench.path("a.vcd"), bench.path("hard.vcd")).unwrap();
    }
    let (a, b, names) = (bench.read("a.vcd"), bench.read("b.vcd"), bench.names());
    for force in [false, true] {
        for input in ["machine.toml", "./machine.toml", "link.toml", "hard.toml"] {
            for (words, _, option) in &WRITERS[..3] {
                let said = bench.status(2, &with(words, input, force));
                assert!(
                    said.contains(option) && said.contains(input) && said.contains("machine file"),
                    "{said}"
                );
            }
        }
        for input in ["a.vcd", "b.vcd", "hard.vcd"] {
            for (words, _, option) in &WRITERS[3..] {
                let said = bench.status(2, &with(words, input, force));
                assert!(said.contains(option) && said.contains("name another file"), "{said}");
            }
        }
        let said = bench.status(2, &with(WRITERS[0].0, "a.csv", force));
        assert!(said.contains("the command"), "{said}");
    }
    assert_eq!(
        (bench.read("machine.toml"), bench.read("a.vcd"), bench.read("b.vcd")),
        (bench.machine.clone(), a, b)
    );
    assert_eq!(bench.names(), names, "nothing else was left");
}

#[test]
fn cli_a_file_that_posicast_did_not_write_is_replaced_with_force_only() {
    let bench = bench();
    for (words, status, option) in WRITERS {
        // `--show` chooses its own extensions; the others take the name as it is.
        let out = if option == "--show" { "mine.vcd" } else { "mine.txt" };
        for text in [
            "years of work",
            "",
            "$version posicast 0.1.0 $end",
            "<!-- written by posicast 0.1.0 -->",
        ] {
            std::fs::write(bench.path(out), text).unwrap();
            let said = bench.status(2, &with(words, out, false));
            assert!(
                said.contains(option) && said.contains(out) && said.contains("--force"),
                "{said}"
            );
            assert_eq!(bench.read(out), text);
        }
        bench.status(status, &with(words, out, true));
        let written = bench.read(out);
        assert_ne!(written, "years of work");
        bench.status(status, &with(words, out, false));
        assert_eq!(bench.read(out), written, "its own it replaces without a word");
        std::fs::write(bench.path(out), written + " ").unwrap();
        bench.status(2, &with(words, out, false));
        std::fs::remove_file(bench.path(out)).unwrap();
    }
    // This name was chosen by the command, not by the user.
    std::fs::write(bench.path("one.vcd"), "mine").unwrap();
    let said = bench.status(2, &["simulate", "machine.toml", "--command", "a.csv"]);
    assert!(said.contains("one.vcd"), "{said}");
    assert_eq!(bench.read("one.vcd"), "mine");
    std::fs::create_dir(bench.path("figures")).unwrap();
    std::fs::write(bench.path("figures/vibrationless.svg"), "mine").unwrap();
    let said = bench.status(2, &["reproduce", "vibrationless", "--plot", "figures"]);
    assert!(said.contains("vibrationless.svg"), "{said}");
    assert_eq!(bench.read("figures/vibrationless.svg"), "mine");
}

#[test]
fn cli_all_files_of_show_are_claimed_before_one_is_written() {
    let bench = bench();
    for extension in ["vcd", "gtkw", "sucl", "svg"] {
        let file = format!("first.{extension}");
        std::fs::write(bench.path(&file), "mine").unwrap();
        let names = bench.names();
        let said = bench.status(2, &["diff", "a.vcd", "b.vcd", "--show", "first"]);
        assert!(said.contains(&file), "{said}");
        assert_eq!((bench.names(), bench.read(&file)), (names, "mine".to_owned()));
        std::fs::remove_file(bench.path(&file)).unwrap();
    }
    let said = bench.status(
        2,
        &["diff", "a.vcd", "b.vcd", "--show", "first", "--junit", "first.svg"],
    );
    assert!(said.contains("--junit of the same command"), "{said}");
    bench.status(1, &["diff", "a.vcd", "b.vcd", "--show", "first"]);
    bench.status(1, &["diff", "a.vcd", "b.vcd", "--show", "first"]);
    // A session that GTKWave saved over ours belongs to the user.
    std::fs::write(bench.path("first.gtkw"), "[*]\n[*] GTKWave Analyzer v3.3.104\n").unwrap();
    assert!(
        bench
            .status(2, &["diff", "a.vcd", "b.vcd", "--show", "first"])
            .contains("first.gtkw")
    );
}

#[test]
fn cli_an_unwritable_file_name_is_refused_before_the_work() {
    let bench = bench();
    std::fs::create_dir(bench.path("folder")).unwrap();
    for (words, _, option) in &WRITERS[..4] {
        for (out, what) in [("folder", "is a folder"), ("no/file", "does not exist")] {
            let said = bench.status(2, &with(words, out, true));
            assert!(said.contains(option) && said.contains(what), "{said}");
        }
    }
}

#[cfg(unix)]
#[test]
fn cli_pipes_devices_and_the_standard_output_are_written_to() {
    let bench = bench();
    let expected = bench.read("a.vcd");
    for (words, status, _) in &WRITERS[..4] {
        bench.status(*status, &with(words, "/dev/null", false));
    }
    assert!(!Path::new("/dev/null").metadata().unwrap().is_file());

    let simulate = |out: &str| {
        with(WRITERS[0].0, "OUT", false)
            .iter()
            .map(|w| w.replace("OUT", out))
            .collect::<Vec<_>>()
    };
    for out in ["-", "/dev/stdout"] {
        let output = posicast()
            .current_dir(bench.folder.path())
            .args(simulate(out))
            .output()
            .unwrap();
        assert!(output.status.success());
        assert_eq!(
            String::from_utf8(output.stdout).unwrap(),
            expected,
            "{out}: the waveform and nothing else"
        );
        assert!(
            String::from_utf8_lossy(&output.stderr).contains("samples"),
            "the result is beside it"
        );
        let said = bench.status(2, &with(WRITERS[1].0, out, false));
        assert!(said.contains("--json"), "{said}");
    }
    // This is a shell's `> file`.
    let file = std::fs::File::create(bench.path("redirected.vcd")).unwrap();
    let mut redirected = std::process::Command::new(env!("CARGO_BIN_EXE_posicast"));
    redirected
        .current_dir(bench.folder.path())
        .args(simulate("/dev/stdout"))
        .stdout(file);
    assert!(
        redirected
            .stderr(std::process::Stdio::null())
            .status()
            .unwrap()
            .success()
    );
    assert_eq!(bench.read("redirected.vcd"), expected);

    let pipe = bench.path("pipe");
    assert!(
        std::process::Command::new("mkfifo")
            .arg(&pipe)
            .status()
            .unwrap()
            .success()
    );
    let reader = std::thread::spawn({
        let pipe = pipe.clone();
        move || std::fs::read_to_string(pipe).unwrap()
    });
    bench.status(0, &with(WRITERS[0].0, "pipe", false));
    assert_eq!(reader.join().unwrap(), expected);
}
