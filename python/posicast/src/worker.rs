//! The steps that call other programs, in a process of their own: `posicast/_worker.py` starts it, and ends it on Ctrl-C.
//!
//! It reads one request and writes lines of JSON to standard output: `say`, `begin`, `reach` and `end` while it works, then one `result`
//! or `error`.

use crate::error::Parts;
use posicast_flow::choice::WordChoice;
use posicast_flow::generate::{self, generate};
use posicast_flow::moves::{Motion, PerAxis};
use posicast_flow::replay::Recording;
use posicast_flow::run::{self, run};
use posicast_flow::verify::{self, DEFAULT_SEED, verify};
use posicast_flow::{Failure, Observer, Outcome, Simulator, WorkProgress};
use posicast_system::interrupt;
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// A step and its options.
#[derive(Deserialize)]
#[serde(tag = "step", rename_all = "kebab-case")]
enum Request {
    Generate {
        machine: PathBuf,
        output: Option<PathBuf>,
        servo_hz: Option<f64>,
    },
    Verify {
        source: PathBuf,
        simulator: Option<String>,
        blocks: Vec<String>,
        cycles: Option<u64>,
        seed: Option<u64>,
        edited: bool,
    },
    Run {
        machine: PathBuf,
        output: Option<PathBuf>,
        command: Option<PathBuf>,
        distance: Option<String>,
        speed: Option<String>,
        contour: Option<String>,
        radius: Option<f64>,
        simulator: Option<String>,
        cycles: Option<u64>,
        seed: Option<u64>,
    },
}

/// Runs the step that a request in JSON names; returns the exit status of the process: 0 unless the request is wrong.
#[pyfunction]
pub(crate) fn worker(py: Python<'_>, request: &str) -> u8 {
    py.detach(|| {
        if let Err(error) = interrupt::listen() {
            line(&json!({"say": format!("warning: temporary files will remain if the work is interrupted: {error}")}));
        }
        let request: Request = match serde_json::from_str(request) {
            Ok(request) => request,
            Err(error) => {
                line(&answer_of(
                    &Failure::input(format!("the options are wrong: {error}")),
                    None,
                ));
                return 2;
            }
        };
        line(&answer(request));
        interrupt::done();
        0
    })
}

/// The last line of a step.
fn answer(request: Request) -> Value {
    match request {
        Request::Generate {
            machine,
            output,
            servo_hz,
        } => {
            let options = generate::Options {
                machine,
                output,
                servo_hz,
            };
            result(generate(&options, &Lines), &options.machine)
        }
        Request::Verify {
            source,
            simulator,
            blocks,
            cycles,
            seed,
            edited,
        } => {
            let done = simulator_of(simulator).and_then(|simulator| {
                let options = verify::Options {
                    source: source.clone(),
                    simulator,
                    blocks,
                    cycles,
                    seed: seed.unwrap_or(DEFAULT_SEED),
                    edited,
                    recording: Recording::default(),
                };
                verify(&options, &Lines)
            });
            result(done, &source)
        }
        Request::Run {
            machine,
            output,
            command,
            distance,
            speed,
            contour,
            radius,
            simulator,
            cycles,
            seed,
        } => {
            let done = simulator_of(simulator).and_then(|simulator| {
                let options = run::Options {
                    machine: machine.clone(),
                    output,
                    motion: Motion {
                        command,
                        distance: per_axis("distance", distance)?,
                        speed: per_axis("speed", speed)?,
                    },
                    radius,
                    contour,
                    corners: posicast_flow::contour::Corners::default(),
                    simulator,
                    cycles,
                    seed: seed.unwrap_or(DEFAULT_SEED),
                };
                run(&options, &Lines)
            });
            result(done, &machine)
        }
    }
}

fn simulator_of(word: Option<String>) -> Result<Option<Simulator>, Failure> {
    let Some(word) = word else { return Ok(None) };
    let words: Vec<&str> = Simulator::ALL.iter().map(|simulator| simulator.word()).collect();
    let found = Simulator::of_word(&word).ok_or_else(|| {
        Failure::input(format!("simulator: found `{word}`; allowed: {}", words.join(", ")))
            .with_help("leave it out for the best that is installed")
    });
    found.map(Some)
}

fn per_axis(option: &str, text: Option<String>) -> Result<Option<PerAxis>, Failure> {
    let parsed = text.map(|text| text.parse::<PerAxis>());
    parsed
        .transpose()
        .map_err(|error| Failure::input(format!("{option}: {error}")))
}

fn result<D: Serialize>(done: Result<Outcome<D>, Failure>, file: &Path) -> Value {
    let file = file.display().to_string();
    match done {
        Ok(outcome) => json!({"result": outcome.document, "failed": outcome.failed}),
        Err(failure) => answer_of(&failure, Some(&file)),
    }
}

fn answer_of(failure: &Failure, file: Option<&str>) -> Value {
    let parts = Parts::of(failure, file);
    json!({"error": {
        "class": parts.class,
        "message": parts.message,
        "file": parts.file,
        "line": parts.line,
        "key": parts.key,
        "remedy": parts.remedy,
    }})
}

/// Writes a line to the process that waits; if that has ended, nobody reads it.
fn line(value: &Value) {
    let mut out = std::io::stdout().lock();
    let _ = writeln!(out, "{value}").and_then(|()| out.flush());
}

/// Reports messages and progress as lines.
struct Lines;

impl Observer for Lines {
    fn say(&self, message: &str) {
        line(&json!({"say": message}));
    }

    fn begin(&self, what: &str, steps: Option<u64>) -> Box<dyn WorkProgress> {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        let id = NEXT.fetch_add(1, Ordering::Relaxed);
        line(&json!({"begin": id, "what": what, "steps": steps}));
        Box::new(Part {
            id,
            done: Mutex::new((0, Instant::now())),
        })
    }
}

/// A part of the work; at most ten lines a second report it.
struct Part {
    id: u64,
    done: Mutex<(u64, Instant)>,
}

impl Part {
    fn set(&self, steps: impl FnOnce(u64) -> u64) {
        const PAUSE: Duration = Duration::from_millis(100);
        if let Ok(mut done) = self.done.lock() {
            done.0 = steps(done.0);
            if done.1.elapsed() >= PAUSE {
                done.1 = Instant::now();
                line(&json!({"reach": self.id, "done": done.0}));
            }
        }
    }
}

impl WorkProgress for Part {
    fn advance(&self, steps: u64) {
        self.set(|done| done + steps);
    }

    fn reach(&self, done: u64) {
        self.set(|_| done);
    }

    fn rename(&self, what: &str) {
        line(&json!({"rename": self.id, "what": what}));
    }
}

impl Drop for Part {
    fn drop(&mut self) {
        line(&json!({"end": self.id}));
    }
}
