//! The fault campaign injects every input and every trip at random clocks of a move of both axes.
//!
//! ```text
//!  case ─► switch on ─► move ─► fault at a random clock ─► observe ─► judge ─► take away, clear ─► a small move ─► judge
//! ```
//!
//! | part | what it is |
//! |---|---|
//! | `kind` | the table of faults: what is injected, and what is expected |
//! | `expectation` | what can be expected: cause, times, reaction of the others |
//! | `case` | a kind, an axis, a clock and a duration, from a seed |
//! | `injection` | injects a fault and removes it |
//! | `observation` | states and pins from the fault on, clock by clock |
//! | `judge` | compares observation and expectation |
//! | `positions` | compare and capture in every case: pulses and entries from the recorded pins |
//! | `run` | runs one case from reset to the small move |
//! | `report` | figures per kind |
//!
//! In every clock of every case it is checked, in addition to the expectation: the two gates of a leg are never on
//! together, no gate is on and no brake released while the drive is disabled, and the counter never deviates from the
//! plant by more than a count in progress.
//!
//! It runs on the event-driven model, or with the RTL beside it, compared in every clock. `docs/fault-campaign.md`
//! has the table with the figures.

mod absolute;
mod case;
mod expectation;
mod injection;
mod judge;
mod kind;
mod machine;
mod observation;
mod positions;
mod report;
mod run;
mod steps;

pub use case::Case;
pub use expectation::{Due, Expectation, Hit, Lasts, Others, Reaction, Seen};
pub use judge::Figures;
pub use kind::{FaultKind, FaultRow, TABLE};
pub use machine::{Bed, TICK_CLOCKS};
pub use report::{FaultReport, KindFigures};
pub use run::{FaultOutcome, run_case};

use std::ops::Range;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;

use posicast_testbench::Error;
use posicast_testbench::lockstep::Device;

/// Why a campaign could not be run. A fault that is not handled is a result, never an error.
#[derive(Debug, thiserror::Error)]
pub enum CampaignError {
    /// The machine cannot be made.
    #[error(
        "the machine of the fault campaign, made from examples/xy-stage.toml: {0}; adapt fault_campaign/machine.rs"
    )]
    Machine(String),
    /// The bench of a case failed.
    #[error("case {case}, {kind}: {error}")]
    Case {
        /// Number of the case.
        case: u64,
        /// Name of its kind.
        kind: &'static str,
        /// The error.
        error: Error,
    },
    /// A bench could not be built.
    #[error(transparent)]
    Bench(#[from] Error),
}

/// Runs the cases with these numbers on this many threads.
///
/// # Errors
/// [`CampaignError`] of the first case that could not be run.
pub fn run(bed: &Bed, cases: Range<u64>, seed: u64, threads: usize) -> Result<FaultReport, CampaignError> {
    let (next, report) = (
        AtomicU64::new(cases.start),
        Mutex::new(FaultReport::new(&bed.rows, seed)),
    );
    let work = || -> Result<(), CampaignError> {
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            if number >= cases.end {
                return Ok(());
            }
            let outcome = run_case(bed, &Case::new(&bed.rows, number, seed), None)?;
            report.lock().unwrap_or_else(PoisonError::into_inner).add(&outcome);
        }
    };
    thread::scope(|scope| {
        let workers: Vec<_> = (0..threads.clamp(1, 64)).map(|_| scope.spawn(work)).collect();
        let mut ended = workers.into_iter().map(|worker| worker.join());
        ended.try_for_each(|worker| worker.unwrap_or_else(|panic| resume_unwind(panic)))
    })?;
    Ok(report.into_inner().unwrap_or_else(PoisonError::into_inner))
}

/// Runs the cases with these numbers one after the other with the RTL of `device` beside the model.
///
/// # Errors
/// [`CampaignError`], also that of `device`.
pub fn run_with_rtl(
    bed: &Bed,
    cases: Range<u64>,
    seed: u64,
    mut device: impl FnMut() -> Result<Box<dyn Device>, Error>,
) -> Result<FaultReport, CampaignError> {
    let mut report = FaultReport::new(&bed.rows, seed);
    for number in cases {
        report.add(&run_case(bed, &Case::new(&bed.rows, number, seed), Some(device()?))?);
    }
    Ok(report)
}
