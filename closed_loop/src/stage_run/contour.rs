//! A path of the first two axes as points, starting where they stand at reset.

use posicast_blocks::segments::Entry;
use posicast_machine::contour::{self, Contour, ContourError, ContourSample, FollowedContour, PlanePoint};
use posicast_machine::motion::plan_places;
use posicast_machine::plan::MachineDesign;

use super::host::{Host, Trouble};
use super::{StageRun, StageRunError, circle, moves};
use crate::stage_bench::AxisSample;

/// Largest number of clocks in which model and RTL are compared.
const COMPARED_CLOCKS: u64 = 24_000_000;

/// Result of a contour.
#[derive(Debug, Clone, PartialEq)]
pub struct Contoured {
    /// The followed contour; `None` if the stage never moved.
    pub followed: Option<FollowedContour>,
    /// Set if the stage did not do what it should.
    pub trouble: Option<Trouble>,
}

/// The command in each tick: from `(0, 0)`, where the machine stands at reset, to rest.
fn command(run: &StageRun<'_>, contour: &Contour) -> Result<Vec<ContourSample>, StageRunError> {
    let samples = contour.samples(run.machine.clock.sample_period_s(), 0.0);
    samples.map_err(|error| StageRunError::Contour(Box::new(error)))
}

/// Points of both axes, from where they stand.
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

/// Drives the contour in the model alone.
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
        trouble = host.rest(moves::settle_ticks_of(run))?;
    }
    let recorded = run.recorded(&mut host);
    let followed = match recorded.as_slice() {
        [x, y, ..] if trouble.is_none() => {
            let (at, load) = aligned(run, &samples, x, y);
            let followed = contour::judged(run.machine, design, contour, &at, &load);
            Some(followed.map_err(|error| StageRunError::Contour(Box::new(error)))?)
        }
        _ => None,
    };
    Ok(Contoured { followed, trouble })
}

/// Command and load in each tick from the first in which the command has moved; at rest the last command is repeated.
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
    // Both lists have the same commands except for rounding to words: the offset is that of the first command that
    // has left its position.
    let half_a_word = [0, 1].map(|axis: usize| 1.0 / units[axis] / 256.0);
    let moved =
        |at: PlanePoint, begin: PlanePoint| (0..2).any(|axis| (at[axis] - begin[axis]).abs() > half_a_word[axis]);
    let begin = samples.first().map_or([0.0, 0.0], place);
    let first_command = samples.iter().position(|sample| moved(sample.at, begin)).unwrap_or(0);
    let first_tick = (0..ticks).find(|tick| moved(of(*tick), of(0))).unwrap_or(0);
    let pairs = (first_tick..ticks).map(|tick| {
        let sample = (first_command + tick - first_tick).min(samples.len() - 1);
        (samples[sample], [x[tick].load, y[tick].load])
    });
    pairs.unzip()
}

/// Drives the contour with a device beside the model; returns whether it reached the end within the clocks that are
/// compared.
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
    // A partial path ends in motion, so the comparison ends there too, before the stage runs out of entries.
    for path in &mut paths {
        path.truncate(room);
    }
    let trouble = circle::stream_some(host, &paths, whole)?;
    Ok((trouble, whole))
}

impl StageRunError {
    /// The contour's error, if it is one.
    pub fn contour(&self) -> Option<&ContourError> {
        match self {
            Self::Contour(error) => Some(error),
            _ => None,
        }
    }
}
