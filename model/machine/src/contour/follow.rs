//! Simulates machines on a contour: tap tables, modes, and the distance of the load from the path.
//!
//! The path is driven block by block. A block holds the command in its samples, and in as many samples before them as
//! the longest table and the lag of the load need. Only the strokes of that time are in memory, so the memory does not
//! depend on the length of the path.

use super::ContourError;
use super::corners::CornerRules;
use super::envelope::Envelope;
use super::path::PathWindow;
use super::plan::{Contour, ContourLimits, ContourSample, Planner, Sampler, plane};
use super::stroke::{PlanePoint, Stroke};
use crate::machine_file::{AxisSection, Machine};
use crate::motion::settle_s;
use crate::plan::MachineDesign;
use crate::plant::axis::ErrorFigures;
use crate::plant::{Plant, free_motion};
use posicast_shaper::mode::Mode;
use posicast_taps::TapTable;

/// Longest time for which a machine is simulated after the end of its command, s.
const LONGEST_SETTLE_S: f64 = 2.0;
/// Longest time by which a load may lag its command, beside the delay of the shaper, s.
const LONGEST_LAG_S: f64 = 20.0;
/// Smallest factor of the frequencies for which the lag is measured.
const SLOWEST_FACTOR: f64 = 0.8;
/// Number of samples of a block.
const BLOCK: usize = 8192;
/// The distance is measured so many times per period of the fastest mode, which finds a peak to 0.2 %, and at least
/// so often per second; more seldom than in each sample where the sample rate is higher.
const LOOKS_PER_PERIOD: f64 = 50.0;
const LOOKS_HZ: f64 = 2000.0;
/// Largest number of samples that are simulated.
const SIMULATED_MAX: u64 = 2_000_000_000;

/// Result of a machine following a contour.
#[derive(Debug, Clone, PartialEq)]
pub struct FollowedContour {
    /// Distance of the load from the path, along its normal, on the feeds and while settling after them, in m; `None`
    /// where there are only rapids.
    pub error: Option<ErrorFigures>,
    /// Distance on the rapids.
    pub rapid: Option<ErrorFigures>,
    /// Distance while a feed is driven at its full speed, counted once the shapers and modes have settled to it.
    pub steady: Option<ErrorFigures>,
    /// Distance of the load from the path over time: positive to the left of the direction of travel. Kept of the
    /// nominal machine only.
    pub distance: Option<Envelope>,
}

/// Time that shapers and modes of the plane take to settle, in s.
pub(super) fn settling_s(machine: &Machine, design: &MachineDesign) -> f64 {
    let shaper_s = shaper_s(machine, design);
    settle_s(shaper_s, modes(machine)).min(shaper_s + LONGEST_SETTLE_S)
}

fn shaper_s(machine: &Machine, design: &MachineDesign) -> f64 {
    let tables = design.axes.iter().take(2);
    let longest = tables.map(|tables| tables.table.longest_delay_samples()).max();
    f64::from(longest.unwrap_or(0)) / machine.clock.sample_hz
}

fn modes(machine: &Machine) -> impl Iterator<Item = Mode> {
    let axes = machine.axes.iter().take(2);
    axes.flat_map(|axis| &axis.modes).map(|mode| mode.mode)
}

/// Limits of the load's lag, and settings of the measurement.
#[derive(Debug, Clone, Copy)]
struct Measure {
    /// Largest lag of the load in samples: the delay of the shaper and a period of the slowest mode.
    lag: usize,
    /// Additional lag along the path, m: the largest ringing of the slowest mode.
    ringing: f64,
    /// Samples after which shapers and modes have settled.
    settling: u64,
    /// Samples from one measurement to the next.
    stride: u64,
}

impl Measure {
    fn new(machine: &Machine, design: &MachineDesign) -> Result<Self, ContourError> {
        let sample_hz = machine.clock.sample_hz;
        let limits = ContourLimits::of_machine(machine)?;
        let slowest_hz = modes(machine).map(|mode| mode.frequency_hz).reduce(f64::min);
        let slowest_hz = slowest_hz.map(|slowest_hz| SLOWEST_FACTOR * slowest_hz);
        let fastest_hz = modes(machine).map(|mode| mode.frequency_hz).fold(0.0, f64::max);
        let lag_s = slowest_hz.map_or(0.0, f64::recip).min(LONGEST_LAG_S) + shaper_s(machine, design);
        let looks_hz = LOOKS_HZ.max(LOOKS_PER_PERIOD * fastest_hz / SLOWEST_FACTOR);
        Ok(Self {
            lag: (lag_s * sample_hz).ceil() as usize,
            ringing: slowest_hz.map_or(0.0, |slowest_hz| {
                2.0 * limits.acceleration / (std::f64::consts::TAU * slowest_hz).powi(2)
            }),
            settling: (settling_s(machine, design) * sample_hz).ceil() as u64,
            stride: ((sample_hz / looks_hz) as u64).max(1),
        })
    }
}

/// Sums of an error.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    peak: f64,
    squares: f64,
    count: u64,
}

impl Sums {
    fn add(&mut self, error: f64) {
        self.peak = self.peak.max(error.abs());
        self.squares += error * error;
        self.count += 1;
    }

    /// The figures of the errors; NaN if one was NaN.
    fn figures(&self) -> Option<ErrorFigures> {
        let rms = (self.squares / self.count as f64).sqrt();
        (self.count > 0).then_some(ErrorFigures {
            peak: if rms.is_nan() { rms } else { self.peak },
            rms,
        })
    }
}

/// Measures the distance of one load.
#[derive(Debug, Clone)]
struct Judge {
    feed: Sums,
    rapid: Sums,
    steady: Sums,
    nearest: usize,
    curve: Option<Envelope>,
}

impl Judge {
    fn new(curve: Option<Envelope>) -> Self {
        Self {
            feed: Sums::default(),
            rapid: Sums::default(),
            steady: Sums::default(),
            nearest: 0,
            curve,
        }
    }

    /// Measures a place of the load against the strokes `first` to `last`.
    fn look(&mut self, path: &PathWindow, load: PlanePoint, [first, last]: [usize; 2], is_steady: bool) {
        let nearest = path.nearest(load, first, last, self.nearest);
        self.nearest = nearest.stroke;
        let sums = if nearest.rapid { &mut self.rapid } else { &mut self.feed };
        sums.add(nearest.distance);
        if is_steady && !nearest.rapid {
            self.steady.add(nearest.distance);
        }
        if let Some(curve) = &mut self.curve {
            curve.push(nearest.distance);
        }
    }

    fn followed(self) -> FollowedContour {
        FollowedContour {
            error: self.feed.figures(),
            rapid: self.rapid.figures(),
            steady: self.steady.figures(),
            distance: self.curve,
        }
    }
}

/// A mode of machines whose frequencies differ, under one command.
#[derive(Debug, Clone)]
struct ModeOf<const N: usize> {
    share: f64,
    /// The matrices of a sample, row by row.
    motion: [[f64; N]; 4],
    deflection: [f64; N],
    velocity: [f64; N],
}

/// An axis of machines whose frequencies differ.
#[derive(Debug, Clone)]
struct AxisOf<const N: usize> {
    taps: Vec<(usize, f64)>,
    modes: Vec<ModeOf<N>>,
    reference: Option<f64>,
}

impl<const N: usize> AxisOf<N> {
    fn new(axis: &AxisSection, table: &TapTable, factors: &[f64; N], sample_s: f64) -> Result<Self, ContourError> {
        let plant = Plant::of_axis(axis).map_err(|error| ContourError::Axes(format!("axis {}: {error}", axis.name)))?;
        let one = f64::from(table.coefficient_fraction()).exp2();
        let taps = table
            .taps()
            .iter()
            .map(|tap| (tap.delay_samples as usize, f64::from(tap.coefficient) / one));
        let modes = plant.modes().iter().map(|mode| {
            let motions = factors.map(|factor| free_motion(&mode.mode.scaled(factor), sample_s));
            ModeOf {
                share: mode.share,
                motion: [(0, 0), (0, 1), (1, 0), (1, 1)].map(|place| motions.map(|motion| motion[place])),
                deflection: [0.0; N],
                velocity: [0.0; N],
            }
        });
        Ok(Self {
            taps: taps.collect(),
            modes: modes.collect(),
            reference: None,
        })
    }

    /// Passes a block of the command, with what came before it, through the table and the modes, and returns the
    /// load's positions at the samples from `first` on, every `stride`.
    fn run(&mut self, command: &[f64], before: usize, first: usize, stride: usize) -> Vec<[f64; N]> {
        let count = command.len() - before;
        let mut references = vec![0.0; count];
        for (delay, weight) in &self.taps {
            let delayed = &command[before - delay..];
            for (reference, command) in references.iter_mut().zip(delayed) {
                *reference += weight * command;
            }
        }
        let looks = references.iter().skip(first).step_by(stride);
        let mut load: Vec<[f64; N]> = looks.map(|reference| [*reference; N]).collect();
        let start = self.reference.or(references.first().copied()).unwrap_or(0.0);
        for mode in &mut self.modes {
            mode.run(start, &references, &mut load, first, stride);
        }
        self.reference = references.last().copied();
        load
    }
}

impl<const N: usize> ModeOf<N> {
    fn run(&mut self, start: f64, references: &[f64], load: &mut [[f64; N]], first: usize, stride: usize) {
        let (mut deflection, mut velocity) = (self.deflection, self.velocity);
        let [xx, xv, vx, vv] = self.motion;
        let mut before = start;
        let mut step = |references: &[f64]| {
            for reference in references {
                let jump = before - reference;
                before = *reference;
                for k in 0..N {
                    let bent = deflection[k] + jump;
                    deflection[k] = xx[k] * bent + xv[k] * velocity[k];
                    velocity[k] = vx[k] * bent + vv[k] * velocity[k];
                }
            }
            deflection
        };
        let mut from = 0;
        for (look, load) in load.iter_mut().enumerate() {
            let until = first + look * stride + 1;
            let deflection = step(&references[from..until]);
            from = until;
            for k in 0..N {
                load[k] += self.share * deflection[k];
            }
        }
        step(&references[from..]);
        (self.deflection, self.velocity) = (deflection, velocity);
    }
}

/// Machines of one design whose modes are at different multiples of their frequencies.
#[derive(Debug, Clone)]
pub(super) struct Followers<const N: usize> {
    axes: [AxisOf<N>; 2],
    judges: [Judge; N],
    measure: Measure,
}

impl<const N: usize> Followers<N> {
    /// Machines of this design; the curve of the distance is kept of the one with the factor 1.
    pub(super) fn new(machine: &Machine, design: &MachineDesign, factors: &[f64; N]) -> Result<Self, ContourError> {
        let sample_s = machine.clock.sample_period_s();
        let [x, y] = plane(machine)?;
        let axis = |axis, index: usize| AxisOf::new(axis, &design.axes[index].table, factors, sample_s);
        let measure = Measure::new(machine, design)?;
        Ok(Self {
            axes: [axis(x, 0)?, axis(y, 1)?],
            judges: factors.map(|factor| Judge::new((factor == 1.0).then(|| Envelope::new(measure.stride)))),
            measure,
        })
    }

    /// Number of samples before a block that its computation needs.
    fn before(&self) -> usize {
        let taps = self.axes.iter().flat_map(|axis| &axis.taps);
        taps.map(|(delay, _)| *delay).fold(self.measure.lag, usize::max)
    }

    fn run(&mut self, block: &Block) {
        let Measure {
            lag,
            ringing,
            settling,
            stride,
        } = self.measure;
        let before = block.before;
        let first = (stride - block.begun % stride) % stride;
        let (first, stride) = (first as usize, stride as usize);
        let [x, y] = &mut self.axes;
        let loads = x
            .run(&block.x, before, first, stride)
            .into_iter()
            .zip(y.run(&block.y, before, first, stride));
        let mut stroke = block.first;
        for (look, (x, y)) in loads.enumerate() {
            let sample = first + look * stride;
            let along = block.along[before + sample];
            let back = block.along[before + sample - lag].min(along - ringing);
            stroke = block.path.first_at(back, stroke);
            let range = [stroke, block.strokes[sample]];
            let is_steady = block.full_for[sample] > settling;
            for (judge, load) in self.judges.iter_mut().zip(x.into_iter().zip(y)) {
                judge.look(&block.path, [load.0, load.1], range, is_steady);
            }
        }
    }

    pub(super) fn followed(self) -> [FollowedContour; N] {
        self.judges.map(Judge::followed)
    }
}

/// A block of the command.
#[derive(Debug, Clone)]
struct Block {
    /// Number of samples before the block in `x`, `y` and `along`.
    before: usize,
    x: Vec<f64>,
    y: Vec<f64>,
    along: Vec<f64>,
    /// Index of the stroke in each sample.
    strokes: Vec<usize>,
    /// For how many samples full speed has been driven.
    full_for: Vec<u64>,
    lasted: u64,
    /// Number of samples before this block.
    begun: u64,
    path: PathWindow,
    /// Index of the first stroke that any sample may refer to.
    first: usize,
}

impl Block {
    fn new(before: usize) -> Self {
        Self {
            before,
            x: Vec::new(),
            y: Vec::new(),
            along: Vec::new(),
            strokes: Vec::with_capacity(BLOCK),
            full_for: Vec::with_capacity(BLOCK),
            lasted: 0,
            begun: 0,
            path: PathWindow::default(),
            first: 0,
        }
    }

    fn push(&mut self, sample: &ContourSample) {
        // Before the start the command had its first value.
        if self.x.is_empty() {
            let [x, y] = sample.at;
            self.x.resize(self.before, x);
            self.y.resize(self.before, y);
            self.along.resize(self.before, sample.along);
        }
        self.lasted = if sample.is_full { self.lasted + 1 } else { 0 };
        self.x.push(sample.at[0]);
        self.y.push(sample.at[1]);
        self.along.push(sample.along);
        self.strokes.push(sample.stroke);
        self.full_for.push(self.lasted);
    }

    /// Begins the next block, which takes the end of this one.
    fn next(&mut self, ringing: f64) {
        let count = self.strokes.len();
        for list in [&mut self.x, &mut self.y, &mut self.along] {
            list.drain(..count.min(list.len()));
        }
        self.strokes.clear();
        self.full_for.clear();
        self.begun += count as u64;
        let back = self.along.first().map_or(0.0, |along| along - ringing);
        self.path.drop_before(back);
        self.first = self.path.first_at(back, self.first);
    }
}

/// Drives a path with all of these machines and lets them settle. `progress` gets the number of samples that are done,
/// block by block.
///
/// # Errors
/// Those of the strokes, and [`ContourError::TooLong`] for a path that would take days.
pub(super) fn drive<const N: usize>(
    machine: &Machine,
    strokes: &mut dyn Iterator<Item = Result<Stroke, ContourError>>,
    rules: &CornerRules,
    followers: &mut [Followers<N>],
    progress: &mut dyn FnMut(u64),
) -> Result<(), ContourError> {
    let sample_s = machine.clock.sample_period_s();
    let limits = ContourLimits::of_machine(machine)?;
    let most = |of: fn(&Followers<N>) -> u64| followers.iter().map(of).max().unwrap_or(0);
    let settling = most(|followers| followers.measure.settling);
    let before = most(|followers| followers.before() as u64) as usize;
    let ringing = followers.iter().map(|one| one.measure.ringing).fold(0.0, f64::max);
    let mut block = Block::new(before);
    let mut sampler = Sampler::new(sample_s);
    let mut flush = |block: &mut Block| {
        all(followers, block);
        block.next(ringing);
        progress(block.begun);
    };
    for run in Planner::new(strokes, limits, *rules) {
        let run = run?;
        block.path.extend(&run.strokes);
        let seconds = block.begun as f64 * sample_s + run.duration_s();
        if seconds > SIMULATED_MAX as f64 * sample_s {
            return Err(ContourError::TooLong {
                seconds,
                most: SIMULATED_MAX,
            });
        }
        sampler.run(&run, |sample| {
            block.push(&sample);
            if block.strokes.len() == BLOCK {
                flush(&mut block);
            }
        });
    }
    if let Some(last) = sampler.at_end() {
        for _ in 0..=settling {
            block.push(&last);
            if block.strokes.len() == BLOCK {
                flush(&mut block);
            }
        }
    }
    flush(&mut block);
    Ok(())
}

/// Passes a block through all machines, on all processors.
fn all<const N: usize>(followers: &mut [Followers<N>], block: &Block) {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let each = followers.len().div_ceil(threads).max(1);
    if followers.len() <= each || block.strokes.len() < BLOCK {
        return followers.iter_mut().for_each(|followers| followers.run(block));
    }
    std::thread::scope(|scope| {
        for some in followers.chunks_mut(each) {
            scope.spawn(move || some.iter_mut().for_each(|followers| followers.run(block)));
        }
    });
}

/// Simulates the first two axes of a machine whose modes are at `frequency_factor` times their frequencies. Each
/// passes the command, which settles at its end, through its table.
///
/// # Errors
/// Those of the strokes; [`ContourError::Axes`] where the machine has no such plane or its modes have no
/// participation.
pub fn follow(
    machine: &Machine,
    design: &MachineDesign,
    strokes: &[Stroke],
    rules: &CornerRules,
    frequency_factor: f64,
) -> Result<FollowedContour, ContourError> {
    let mut followers = [Followers::new(machine, design, &[frequency_factor])?];
    let mut strokes = strokes.iter().copied().map(Ok);
    drive(machine, &mut strokes, rules, &mut followers, &mut |_| ())?;
    let [followers] = followers;
    let [followed] = followers.followed();
    Ok(followed)
}

/// Distance of a load from the path of a contour; `samples` has the command and `load` the load's position in each
/// sample.
///
/// # Errors
/// [`ContourError::Axes`] where the machine has no plane of two axes.
pub fn judged(
    machine: &Machine,
    design: &MachineDesign,
    contour: &Contour,
    samples: &[ContourSample],
    load: &[PlanePoint],
) -> Result<FollowedContour, ContourError> {
    let measure = Measure::new(machine, design)?;
    let mut path = PathWindow::default();
    path.extend(contour.placed());
    let mut judge = Judge::new(Some(Envelope::new(1)));
    let (mut lasted, mut first) = (0, 0);
    for (index, (sample, load)) in samples.iter().zip(load).enumerate() {
        lasted = if sample.is_full { lasted + 1 } else { 0 };
        let back = samples[index.saturating_sub(measure.lag)].along;
        first = path.first_at(back.min(sample.along - measure.ringing), first);
        judge.look(&path, *load, [first, sample.stroke], lasted > measure.settling);
    }
    Ok(judge.followed())
}
