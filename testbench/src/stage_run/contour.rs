//! A path of the first two axes, from where they stand at reset, point by point.

use posicast_model::contour::{self, Contour, ContourError, ContourSample, FollowedContour, PlanePoint};
use posicast_model::design::MachineDesign;
use posicast_model::motion::plan_places;
use posicast_model::rtl::segments::Entry;

use super::host::{Host, Trouble};
use super::{StageRun, StageRunError, circle, moves};
use crate::stage_bench::AxisSample;

/// Most clocks that model and RTL are compared in.
const COMPARED_CLOCKS: u64 = 24_000_000;

/// A contour and what came of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Contoured {
    /// How far the load went from the path; nothing where it never moved.
    pub followed: Option<FollowedContour>,
    /// What the stage did not do.
    pub trouble: Option<Trouble>,
}

/// The command in each tick: from where the machine stands at reset, `(0, 0)`, to rest.
fn command(run: &StageRun<'_>, contour: &Contour) -> Result<Vec<ContourSample>, StageRunError> {
    let samples = contour.samples(run.machine.clock.sample_period_s(), 0.0);
    samples.map_err(|error| StageRunError::Contour(Box::new(error)))
}

/// The points of both axes, from where they stand.
fn plan(run: &StageRun<'_>, host: &mut Host<'_>, samples: &[ContourSample]) -> Result<[Vec<Entry>; 2], StageRunError> {
    let units = [0, 1].map(|axis: usize| run.machine.axes[axis].loop_counts_per_unit());
    let places = samples
        .iter()
        .map(|sample| [sample.at[0] * units[0], sample.at[1] * units[1]]);
    let start = [host.command(0)?, host.command(1)?];
    plan_places(start, &places.collect::<Vec<_>>()).map_err(|source| StageRunError::Plan {
        axis: run.machine.axes[0].name.clone(),
        source,
    })
}

/// The contour in the model alone.
pub(super) fn measure(
    run: &StageRun<'_>,
    mut host: Host<'_>,
    contour: &Contour,
    design: &MachineDesign,
) -> Result<Contoured, StageRunError> {
    let samples = command(run, contour)?;
    let mut trouble = host.switch_on()?;
    if trouble.is_none() {
        let paths = plan(run, &mut host, &samples)?;
        trouble = circle::stream(&mut host, &paths)?;
    }
    if trouble.is_none() {
        trouble = host.rest(moves::settle_ticks(run))?;
    }
    let recorded = host.bench.recorded();
    let followed = match recorded.as_slice() {
        [x, y, ..] if trouble.is_none() => {
            let (at, load) = aligned(run, &samples, x, y);
            Some(contour::judged(run.machine, design, contour, &at, load))
        }
        _ => None,
    };
    Ok(Contoured { followed, trouble })
}

/// The command and the load in each tick from the first in which the command has moved; at rest the last command stays.
fn aligned(
    run: &StageRun<'_>,
    samples: &[ContourSample],
    x: &[AxisSample],
    y: &[AxisSample],
) -> (Vec<ContourSample>, Vec<PlanePoint>) {
    let units = [0, 1].map(|axis: usize| run.machine.axes[axis].loop_counts_per_unit());
    let of = |tick: usize| [x[tick].command / units[0], y[tick].command / units[1]];
    let ticks = x.len().min(y.len());
    let place = |sample: &ContourSample| sample.at;
    // The commands of both lists are the same but for their rounding to words: the offset is that of the first that has left its place.
    let half_a_word = [0, 1].map(|axis: usize| 1.0 / units[axis] / 256.0);
    let moved =
        |at: PlanePoint, begin: PlanePoint| (0..2).any(|axis| (at[axis] - begin[axis]).abs() > half_a_word[axis]);
    let begin = samples.first().map_or([0.0, 0.0], place);
    let first_command = samples.iter().position(|sample| moved(sample.at, begin)).unwrap_or(0);
    let first_tick = (0..ticks).find(|tick| moved(of(*tick), of(0))).unwrap_or(0);
    let pairs = (first_tick..ticks).map(|tick| {
        let sample = (first_command + tick - first_tick).min(samples.len() - 1);
        let command = ContourSample {
            speed: if sample + 1 == samples.len() {
                0.0
            } else {
                samples[sample].speed
            },
            ..samples[sample]
        };
        (command, [x[tick].load, y[tick].load])
    });
    pairs.unzip()
}

/// The contour with a device beside the model; whether it came to its end within the clocks that are compared.
pub(super) fn compare(
    run: &StageRun<'_>,
    host: &mut Host<'_>,
    contour: &Contour,
) -> Result<(Option<Trouble>, bool), StageRunError> {
    let samples = command(run, contour)?;
    if let Some(trouble) = host.switch_on()? {
        return Ok((Some(trouble), false));
    }
    let room = (COMPARED_CLOCKS / host.tick_clocks()) as usize;
    let whole = samples.len() <= room;
    let mut paths = plan(run, host, &samples)?;
    // A part of a path ends where it does not: there the comparison ends too, before the stage has run dry.
    for path in &mut paths {
        path.truncate(room);
    }
    let trouble = circle::stream_some(host, &paths, whole)?;
    Ok((trouble, whole))
}

impl StageRunError {
    /// The contour's error, where it is one.
    pub fn contour(&self) -> Option<&ContourError> {
        match self {
            Self::Contour(error) => Some(error),
            _ => None,
        }
    }
}
