//! SIGINT and SIGTERM at various moments: nothing is left behind, and no program survives. What SIGKILL leaves does
//! no harm.

#![cfg(test)] // lets clippy see that this is test code

use crate::cli::support::{example, one_axis, scratch};
use rustix::process::{Pid, Signal, kill_process};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

const PATIENCE: Duration = Duration::from_secs(100);

/// A run in folders of its own.
struct Bench {
    folder: tempfile::TempDir,
}

impl Bench {
    fn new() -> Self {
        let machine = one_axis("kind = \"zv\"", "frequency_hz = 50.0\ndamping = 0.1");
        let (folder, _) = scratch(&(machine + "[axis.encoder]\nfilter_clocks = 8\n"));
        for name in ["temporary", "cache", "output"] {
            std::fs::create_dir(folder.path().join(name)).unwrap();
        }
        std::fs::copy(example("xy-stage.toml"), folder.path().join("xy-stage.toml")).unwrap();
        Self { folder }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn command(&self, words: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_posicast"));
        command
            .args(words)
            .current_dir(self.path("output"))
            .env("TMPDIR", self.path("temporary"))
            .env("POSICAST_CACHE", self.path("cache"))
            .env("POSICAST_TEST_BENCH", self.folder.path())
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        command
    }

    /// Returns the commands of the programs that this bench started, directly or not, and that still run.
    fn programs(&self) -> Vec<String> {
        let mark = format!("POSICAST_TEST_BENCH={}", self.folder.path().display());
        let processes = std::fs::read_dir("/proc").unwrap().flatten().map(|entry| entry.path());
        let ours = processes.filter(|process| {
            let environment = std::fs::read(process.join("environ")).unwrap_or_default();
            environment
                .split(|byte| *byte == 0)
                .any(|variable| variable == mark.as_bytes())
        });
        let name = |process: PathBuf| std::fs::read_to_string(process.join("comm")).ok();
        ours.filter_map(name).map(|name| name.trim().to_owned()).collect()
    }

    /// Waits until `moment`, sends the signal, and returns how the command ended. It may end before the signal.
    fn interrupted(&self, words: &[&str], moment: &dyn Fn(&Self) -> bool, signal: Signal) -> ExitStatus {
        let mut child = self.command(words).spawn().unwrap();
        let start = Instant::now();
        while !moment(self) && child.try_wait().unwrap().is_none() {
            assert!(start.elapsed() < PATIENCE, "{words:?}: the moment does not come");
            std::thread::sleep(Duration::from_millis(1));
        }
        // The number of a process that has ended and was waited for is no longer valid.
        if child.try_wait().unwrap().is_none() {
            kill_process(Pid::from_child(&child), signal).unwrap();
        }
        ended(&mut child)
    }

    /// Checks that nothing is left: no file except the machine files and what is built in the cache, and no program.
    fn nothing_is_left(&self, what: &str) {
        let start = Instant::now();
        while !self.programs().is_empty() {
            assert!(
                start.elapsed() < Duration::from_secs(5),
                "{what}: {:?} live on",
                self.programs()
            );
            std::thread::sleep(Duration::from_millis(10));
        }
        assert_eq!(entries(&self.path("temporary")), Vec::<String>::new(), "{what}");
        let unfinished = |name: &String| !(name.starts_with("verilator-") && name.ends_with(".so"));
        let cache = entries(&self.path("cache"));
        assert_eq!(
            cache.iter().filter(|name| unfinished(name)).count(),
            0,
            "{what}: {cache:?}"
        );
    }
}

fn ended(child: &mut Child) -> ExitStatus {
    let start = Instant::now();
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            return status;
        }
        if start.elapsed() > PATIENCE {
            child.kill().unwrap();
            panic!("the command does not end");
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn entries(folder: &Path) -> Vec<String> {
    let names = std::fs::read_dir(folder).unwrap().flatten();
    names
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect()
}

/// Names and contents of all files below a folder; only the names are shown.
fn contents(folder: &Path) -> Contents {
    let mut files = Vec::new();
    let mut paths = vec![folder.to_owned()];
    while let Some(path) = paths.pop() {
        if path.is_dir() {
            paths.extend(std::fs::read_dir(&path).unwrap().map(|entry| entry.unwrap().path()));
        } else {
            files.push((path.clone(), std::fs::read(&path).unwrap()));
        }
    }
    files.sort();
    Contents(files)
}

#[derive(PartialEq)]
struct Contents(Vec<(PathBuf, Vec<u8>)>);

impl std::fmt::Debug for Contents {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_list().entries(self.0.iter().map(|(path, _)| path)).finish()
    }
}

type Moment = fn(&Bench) -> bool;

fn sources_are_written(bench: &Bench) -> bool {
    entries(&bench.path("temporary")).len() > 1
}

fn verilator_is_at_work(bench: &Bench) -> bool {
    bench.programs().iter().any(|name| name.starts_with("verilator"))
}

fn the_compiler_is_at_work(bench: &Bench) -> bool {
    bench.programs().iter().any(|name| name == "cc1plus")
}

fn icarus_is_at_work(bench: &Bench) -> bool {
    bench.programs().iter().any(|name| name == "vvp")
}

fn yosys_is_at_work(bench: &Bench) -> bool {
    bench.programs().iter().any(|name| name.contains("yosys"))
}

fn rtl_is_staged(bench: &Bench) -> bool {
    ["one", "xy_stage"]
        .iter()
        .any(|name| bench.path("output").join(name).join(".posicast-staging/rtl").exists())
}

const SIGNALS: [(Signal, i32); 2] = [(Signal::INT, 130), (Signal::TERM, 143)];

#[test]
fn cli_a_signal_leaves_nothing_of_verify() {
    let icarus = [
        "verify",
        "../machine.toml",
        "--simulator",
        "icarus",
        "--cycles",
        "1000000000",
    ];
    let rusthdl = [
        "verify",
        "../machine.toml",
        "--simulator",
        "rusthdl",
        "--cycles",
        "1000000000",
    ];
    let verilator = ["verify", "../machine.toml", "--block", "shaper"];
    let moments: [(&[&str], Moment); 5] = [
        (&verilator, sources_are_written),
        (&verilator, verilator_is_at_work),
        (&verilator, the_compiler_is_at_work),
        (&icarus, icarus_is_at_work),
        (&rusthdl, sources_are_written),
    ];
    for (at, (words, moment)) in moments.into_iter().enumerate() {
        let bench = Bench::new();
        let (signal, status) = SIGNALS[at % 2];
        assert_eq!(
            bench.interrupted(words, &moment, signal).code(),
            Some(status),
            "{at} {words:?}"
        );
        bench.nothing_is_left(&format!("{at} {words:?}"));
        assert_eq!(entries(&bench.path("output")), Vec::<String>::new());
    }
}

#[test]
fn cli_a_signal_leaves_an_output_folder_as_it_was() {
    let icarus = ["--simulator", "icarus", "--cycles", "1000000000"];
    let moments: [(Moment, &[&str]); 3] = [
        (rtl_is_staged, &icarus),
        (icarus_is_at_work, &icarus),
        (
            yosys_is_at_work,
            &["--simulator", "icarus", "--cycles", "100", "--command", "../step.csv"],
        ),
    ];
    for (at, (moment, more)) in moments.into_iter().enumerate() {
        let bench = Bench::new();
        std::fs::write(bench.path("step.csv"), "time_s,position\n0,0\n0.001,0.001\n").unwrap();
        let words = [&["run", "../machine.toml"], more].concat();
        let (signal, status) = SIGNALS[at % 2];
        // A new folder is removed; an existing one stays.
        for existing in [false, true] {
            if existing {
                assert!(
                    bench
                        .command(&["generate", "../machine.toml"])
                        .status()
                        .unwrap()
                        .success()
                );
            }
            let before = contents(&bench.path("output"));
            assert_eq!(
                bench.interrupted(&words, &moment, signal).code(),
                Some(status),
                "{at} {words:?}"
            );
            bench.nothing_is_left(&format!("{at} {words:?}"));
            assert_eq!(contents(&bench.path("output")), before);
            assert_eq!(entries(&bench.path("output")).len(), usize::from(existing));
        }
    }
}

#[test]
fn cli_a_signal_finds_generate_undone_or_done() {
    for wait in 0..8 {
        let bench = Bench::new();
        let (signal, status) = SIGNALS[wait % 2];
        let start = std::cell::Cell::new(None);
        let moment = |bench: &Bench| {
            if start.get().is_none() && rtl_is_staged(bench) {
                start.set(Some(Instant::now()));
            }
            start
                .get()
                .is_some_and(|start| start.elapsed() >= Duration::from_millis(10 * wait as u64))
        };
        let ended = bench.interrupted(&["generate", "../xy-stage.toml"], &moment, signal);
        bench.nothing_is_left("generate");
        let there = entries(&bench.path("output"));
        assert!(!bench.path("output/xy_stage/.posicast-staging").exists());
        if there.is_empty() {
            assert_eq!(ended.code(), Some(status));
        } else {
            // The command is done, whether or not the signal came before the list was printed.
            assert!([Some(0), Some(status)].contains(&ended.code()), "{ended}");
            let mut again = bench.command(&["generate", "../xy-stage.toml"]);
            let before = contents(&bench.path("output"));
            assert!(again.status().unwrap().success());
            assert_eq!(contents(&bench.path("output")), before);
        }
    }
}

#[test]
fn cli_the_next_run_clears_the_rest_of_a_killed_one() {
    let bench = Bench::new();
    let run = [
        "run",
        "../machine.toml",
        "--simulator",
        "icarus",
        "--cycles",
        "1000000000",
    ];
    let killed = bench.interrupted(&run, &icarus_is_at_work, Signal::KILL);
    assert_eq!(killed.code(), None);
    assert!(bench.path("output/one/.posicast-staging").exists());
    assert!(
        bench
            .command(&["generate", "../machine.toml"])
            .status()
            .unwrap()
            .success()
    );
    assert!(!bench.path("output/one/.posicast-staging").exists());
    let start = Instant::now();
    while !bench.programs().is_empty() {
        assert!(
            start.elapsed() < PATIENCE,
            "vvp without a reader ends by itself: {:?}",
            bench.programs()
        );
        std::thread::sleep(Duration::from_millis(10));
    }
}

#[test]
fn cli_a_second_signal_ends_a_command_that_is_stuck_in_cleaning_up() {
    use std::io::Write;
    let bench = Bench::new();
    // Nobody reads its standard error, and the pipe is full: the last message after cleaning up is never printed.
    let (_reader, mut writer) = std::io::pipe().unwrap();
    writer.write_all(&[b' '; 1 << 16]).unwrap();
    let mut command = bench.command(&[
        "verify",
        "../machine.toml",
        "--simulator",
        "icarus",
        "--cycles",
        "1000000000",
    ]);
    let mut child = command.stderr(writer).spawn().unwrap();
    let wait_until = |moment: &dyn Fn() -> bool| {
        let start = Instant::now();
        while !moment() {
            assert!(start.elapsed() < PATIENCE, "the moment does not come");
            std::thread::sleep(Duration::from_millis(1));
        }
    };
    wait_until(&|| icarus_is_at_work(&bench));
    kill_process(Pid::from_child(&child), Signal::INT).unwrap();
    wait_until(&|| entries(&bench.path("temporary")).is_empty());
    std::thread::sleep(Duration::from_millis(200));
    assert_eq!(child.try_wait().unwrap(), None);
    kill_process(Pid::from_child(&child), Signal::INT).unwrap();
    assert_eq!(ended(&mut child).code(), Some(130));
    bench.nothing_is_left("after the second signal");
}

#[test]
fn cli_a_signal_ends_a_program_with_all_that_it_started() {
    use std::os::unix::fs::PermissionsExt;
    for (signal, status) in SIGNALS {
        let bench = Bench::new();
        // This Verilator never ends, nor does what it starts, whatever happens to its folder.
        let tool = bench.path("verilator");
        let text = "#!/bin/sh\n[ \"$1\" = --version ] && { echo Verilator 5.006; exit; }\nsleep 1000 &\nwait\n";
        std::fs::write(&tool, text).unwrap();
        std::fs::set_permissions(&tool, std::fs::Permissions::from_mode(0o755)).unwrap();
        let mut command = bench.command(&["verify", "../machine.toml", "--block", "shaper"]);
        let mut child = command.env("VERILATOR", tool).spawn().unwrap();
        let start = Instant::now();
        while !bench.programs().iter().any(|name| name == "sleep") {
            assert!(start.elapsed() < PATIENCE, "the tool does not start");
            std::thread::sleep(Duration::from_millis(1));
        }
        kill_process(Pid::from_child(&child), signal).unwrap();
        assert_eq!(ended(&mut child).code(), Some(status));
        bench.nothing_is_left("a tool that never ends");
    }
}
