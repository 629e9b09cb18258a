//! Runs the fault campaign with any number of cases; see `docs/fault-campaign.md`.
//!
//! ```text
//! cargo run --release --example fault_campaign -- --cases 10000 --seed 1 --rtl 58
//! ```
//!
//! `--machine steps` takes the machine with step inputs in place of that with loops, `--machine absolute` that with absolute encoders.
//! `--rtl N` runs N more cases with the Verilated stage beside the model, compared in every clock. `--first N` begins with this case, to repeat one that failed. Exit status 1 if a case did not meet its expectation.

use std::io::Write;
use std::process::ExitCode;
use std::{env, io, thread};

use posicast_closed_loop::fault_campaign::{Bed, CampaignError, FaultReport, run, run_with_rtl};
use posicast_testbench::Error;
use posicast_testbench::blocks::Sources;
use posicast_testbench::component::ComponentBlock;
use posicast_testbench::lockstep::Device;

const USAGE: &str =
    "fault_campaign [--machine loops|steps|absolute] [--cases N] [--first N] [--seed S] [--rtl N] [--threads N]";

struct Options {
    /// Makes the machine.
    bed: fn() -> Result<Bed, CampaignError>,
    cases: u64,
    first: u64,
    seed: u64,
    rtl: u64,
    threads: usize,
}

impl Options {
    fn parse(mut arguments: impl Iterator<Item = String>) -> Result<Self, String> {
        let mut options = Self {
            bed: Bed::new,
            cases: 10_000,
            first: 0,
            seed: 1,
            rtl: 0,
            threads: thread::available_parallelism().map_or(1, usize::from),
        };
        while let Some(name) = arguments.next() {
            let value = arguments.next();
            if name == "--machine" {
                options.bed = match value.as_deref() {
                    Some("loops") => Bed::new,
                    Some("steps") => Bed::with_steps,
                    Some("absolute") => Bed::with_absolute_encoders,
                    _ => return Err(format!("--machine needs `loops`, `steps` or `absolute`\n{USAGE}")),
                };
                continue;
            }
            let value = value.and_then(|value| value.parse::<u64>().ok());
            let value = value.ok_or_else(|| format!("{name} needs a whole number\n{USAGE}"))?;
            match name.as_str() {
                "--cases" => options.cases = value,
                "--first" => options.first = value,
                "--seed" => options.seed = value,
                "--rtl" => options.rtl = value,
                "--threads" => options.threads = value.min(64) as usize,
                _ => return Err(format!("{name} is not an option\n{USAGE}")),
            }
        }
        Ok(options)
    }
}

fn campaigns(options: &Options) -> Result<Vec<FaultReport>, Box<dyn std::error::Error>> {
    let bed = (options.bed)()?;
    let numbers = options.first..options.first.saturating_add(options.cases);
    let mut reports = vec![run(&bed, numbers, options.seed, options.threads)?];
    if options.rtl > 0 {
        let block = ComponentBlock::new(bed.component.clone(), "xy_stage", "xy");
        let sources = Sources::write(&block)?;
        let device = || -> Result<Box<dyn Device>, Error> { Ok(Box::new(sources.verilated(&block, options.seed)?)) };
        let numbers = options.first..options.first.saturating_add(options.rtl);
        reports.push(run_with_rtl(&bed, numbers, options.seed, device)?);
    }
    Ok(reports)
}

fn main() -> ExitCode {
    let told = |text: &str| io::stdout().lock().write_all(text.as_bytes());
    let reports = Options::parse(env::args().skip(1))
        .map_err(Into::into)
        .and_then(|options| campaigns(&options));
    let (text, good) = match reports {
        Ok(reports) => {
            let text: String = reports.iter().map(|report| format!("{report}\n")).collect();
            (text, reports.iter().all(|report| report.failures().is_empty()))
        }
        Err(error) => (format!("{error}\n"), false),
    };
    match (told(&text), good) {
        (Ok(()), true) => ExitCode::SUCCESS,
        _ => ExitCode::FAILURE,
    }
}
