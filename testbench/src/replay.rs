//! Replays a recording: its inputs go into model and device, and its outputs are compared with the model's.
//!
//! ```text
//!                       ┌─► model ─────┬─► lock step: device = model?
//!  recording ─► inputs ─┼─► device ────┘
//!      │                └─► model ─────┬─► lock step: recording = model?
//!      └──────► outputs ───────────────┘
//! ```
//!
//! - Values are those just before each edge of the recorded clock. All edges are replayed, also those in reset;
//!   recorded outputs are compared from the release of the reset on, or from the first edge if there is none.
//! - Model and device begin as at power-up. A recording that begins later, without a reset, does not match them.
//! - An input that is not in the file, and an input bit that is `x` or `z`, is 0.
//! - An output that is not in the file, and an output bit that is `x` or `z`, is not compared.
//! - The file is read three times and never kept in memory, so memory does not depend on its length.

use std::path::Path;

use posicast_blocks::{ClockedBlock, Direction, Port, StepError};

use crate::Error;
use crate::blocks::Block;
use crate::lockstep::report::LockstepReport;
use crate::lockstep::{self, Clock, Device, Instance};
use crate::stimuli::Stimuli;
use wavecmp::WaveError;
use wavecmp::diff::DiffOptions;
use wavecmp::sample::{Player, PortMap, Recorded, WantedSignal};

/// Suffix of the names of the recording's rows.
const RECORDED: &str = "recorded";

/// A recording that has signals in common with a block.
#[derive(Debug, Clone)]
pub struct Replay {
    map: PortMap,
    ports: Vec<Port>,
}

/// Inputs that carry only timing, by the ends of their names: a recording in which nothing else changes drives nothing.
pub const TIMING: [&str; 4] = ["rst", "strobe", "tick", "clear_flags"];

/// What a recording exercised of the block.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Exercised {
    /// Inputs in the file, without `rst`, that never changed after the release of its reset.
    pub unchanged_inputs: Vec<String>,
    /// Outputs that never changed in the model since then.
    pub unchanged_outputs: Vec<String>,
    /// What a verdict on the block would require beside ([`Block::exercise`]), in words: taps, banks, levels of flags.
    pub missing: Vec<String>,
}

/// Extent of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Extent {
    /// Number of edges of its clock.
    pub clocks: u64,
    /// Number of edges from the release of reset on.
    pub compared: u64,
    /// Number of clocks in which an input had bits that were `x` or `z`.
    pub unknown_inputs: u64,
    /// Number of clocks from the release on in which an output had such bits.
    pub unknown_outputs: u64,
}

impl Replay {
    /// Matches the file with the block's ports below the scope of its top; `None` where they have none in common.
    ///
    /// # Errors
    /// Those of [`PortMap::find`].
    pub fn new(block: &dyn Block, path: &Path, options: &DiffOptions) -> Result<Option<Self>, Error> {
        let ports = block.model(0).ports().to_vec();
        let wanted: Vec<WantedSignal> = ports.iter().map(wanted).collect();
        let map = PortMap::find(path, &block.top(), &wanted, options)?;
        Ok(map.map(|map| Self { map, ports }))
    }

    /// Number of ports that are in the file.
    pub fn found(&self) -> usize {
        self.map.found()
    }

    /// Notes on how clock and reset were found.
    pub fn notes(&self) -> &[String] {
        &self.map.notes
    }

    /// Inputs that are not in the file, and are held at 0.
    pub fn missing_inputs(&self) -> Vec<String> {
        missing(&self.map, &self.ports, Direction::Input)
    }

    /// Outputs that are not in the file, and are compared between model and device only.
    pub fn missing_outputs(&self) -> Vec<String> {
        missing(&self.map, &self.ports, Direction::Output)
    }

    /// Number of outputs of the block.
    pub fn outputs(&self) -> usize {
        places(&self.ports, Direction::Output).len()
    }

    /// Number of signals of the file that are not ports of the block.
    pub fn strangers(&self) -> usize {
        self.map.strangers
    }

    /// Reads the file once, up to this many clocks.
    ///
    /// # Errors
    /// Those of [`Player::next`].
    pub fn extent(&self, most_clocks: u64) -> Result<Extent, Error> {
        let mut player = self.map.play()?;
        let mut row = vec![None; self.ports.len()];
        let mut extent = Extent::default();
        while extent.clocks < most_clocks
            && let Some(released) = player.next(&mut row)?
        {
            let unknown = |direction| {
                let of = self
                    .ports
                    .iter()
                    .zip(&row)
                    .filter(|(port, _)| port.direction == direction);
                of.into_iter()
                    .any(|(_, value)| value.is_some_and(|value| value.unknown != 0))
            };
            extent.clocks += 1;
            extent.compared += u64::from(released);
            extent.unknown_inputs += u64::from(unknown(Direction::Input));
            extent.unknown_outputs += u64::from(released && unknown(Direction::Output));
        }
        Ok(extent)
    }

    /// Replays the clocks of `extent`. The device and the recording are compared with the model, in rows of their own. A row
    /// without data is [not exercised](crate::lockstep::report::BlockReport::not_exercised), and so there is no match.
    ///
    /// # Errors
    /// Those of [`lockstep::run`], and of [`Player::next`] for a file that has changed since its [`Replay::extent`]
    /// was taken.
    pub fn run(
        &self,
        block: &dyn Block,
        device: &mut dyn Device,
        extent: &Extent,
        seed: u64,
    ) -> Result<(LockstepReport, Exercised), Error> {
        let instances = block.instances(&self.ports);
        let mut activity = Activity::new(&self.ports, extent.clocks - extent.compared);
        let mut exercise = block.exercise();
        let mut watch = |clock: &Clock<'_>| {
            activity.observe(clock);
            if let Some(exercise) = &mut exercise {
                exercise.observe(clock);
            }
        };
        let of_device = self.against(block, device, &instances, (extent.clocks, seed), &mut watch)?;
        let without_data: Vec<(String, String)> = instances
            .iter()
            .filter_map(|instance| Some((instance.name.clone(), activity.lacks(instance, instances.len() > 1)?)))
            .collect();
        // A reset is released once.
        let is_there = |name: &String| name != "rst" && !self.missing_inputs().contains(name);
        let exercised = Exercised {
            unchanged_inputs: activity.unchanged(Direction::Input).filter(is_there).collect(),
            unchanged_outputs: activity.unchanged(Direction::Output).collect(),
            missing: exercise
                .map_or_else(Vec::new, |exercise| exercise.missing())
                .into_iter()
                .map(|(instance, what)| format!("{} {instance}: {what}", block.name()))
                .collect(),
        };
        let of_device = of_device.without(without_data.clone());
        let without_data = without_data
            .into_iter()
            .map(|(name, what)| (format!("{name}, {RECORDED}"), what))
            .collect();
        let outputs = missing(&self.map, &self.ports, Direction::Output);
        let recorded = instances.into_iter().map(|instance| Instance {
            name: format!("{}, {RECORDED}", instance.name),
            outputs: instance
                .outputs
                .into_iter()
                .filter(|name| !outputs.contains(name))
                .collect(),
            ..instance
        });
        let recorded: Vec<Instance> = recorded.filter(|instance| !instance.outputs.is_empty()).collect();
        if recorded.is_empty() {
            return Ok((of_device, exercised));
        }
        let mut shown = Shown {
            player: self.map.play()?,
            model: block.model(seed),
            row: vec![None; self.ports.len()],
            outputs: places(&self.ports, Direction::Output),
        };
        let of_recording = self.against(block, &mut shown, &recorded, (extent.clocks, seed), &mut |_| {})?;
        let of_recording = of_recording.without(without_data);
        Ok((LockstepReport::joined(vec![of_device, of_recording]), exercised))
    }

    fn against(
        &self,
        block: &dyn Block,
        device: &mut dyn Device,
        instances: &[Instance],
        (clocks, seed): (u64, u64),
        watch: &mut dyn FnMut(&Clock<'_>),
    ) -> Result<LockstepReport, Error> {
        let mut inputs = Inputs {
            player: self.map.play()?,
            row: vec![None; self.ports.len()],
            places: places(&self.ports, Direction::Input),
            failed: None,
        };
        let mut model = block.model(seed);
        let options = lockstep::LockstepOptions::cycles(clocks);
        let report = lockstep::run(
            model.as_mut(),
            device,
            &mut inputs,
            instances,
            &options,
            watch,
            &mut |_| {},
        );
        match inputs.failed {
            Some(error) => Err(error.into()),
            None => report,
        }
    }
}

fn wanted(port: &Port) -> WantedSignal {
    WantedSignal {
        name: port.name.clone(),
        width: port.width,
    }
}

/// The ports of one direction that a file lacks.
fn missing(map: &PortMap, ports: &[Port], direction: Direction) -> Vec<String> {
    let of = ports.iter().enumerate().filter(|(_, port)| port.direction == direction);
    of.filter(|(at, _)| !map.has(*at))
        .map(|(_, port)| port.name.clone())
        .collect()
}

/// Indices of the ports with one direction.
fn places(ports: &[Port], direction: Direction) -> Vec<usize> {
    let of = ports.iter().enumerate().filter(|(_, port)| port.direction == direction);
    of.map(|(at, _)| at).collect()
}

/// Whether a port carries only timing.
pub fn is_timing(port: &Port) -> bool {
    let ends_so = |end: &str| {
        let before = port.name.strip_suffix(end);
        before.is_some_and(|before| before.is_empty() || before.ends_with('_'))
    };
    port.width == 1 && TIMING.into_iter().any(ends_so)
}

/// Which ports have changed since the first clock that counts.
struct Activity {
    /// Inputs, then outputs, each in the order of the model.
    ports: Vec<Port>,
    inputs: usize,
    first_clock: u64,
    first: Vec<u64>,
    changed: Vec<bool>,
}

impl Activity {
    fn new(ports: &[Port], first_clock: u64) -> Self {
        let of = |direction| ports.iter().filter(move |port| port.direction == direction).cloned();
        let inputs: Vec<Port> = of(Direction::Input).collect();
        let count = inputs.len();
        let ports: Vec<Port> = inputs.into_iter().chain(of(Direction::Output)).collect();
        Self {
            inputs: count,
            first_clock,
            first: Vec::new(),
            changed: vec![false; ports.len()],
            ports,
        }
    }

    fn observe(&mut self, clock: &Clock<'_>) {
        if clock.time < self.first_clock {
            return;
        }
        let values = || clock.inputs.iter().chain(clock.expected).copied();
        if self.first.is_empty() {
            self.first = values().collect();
        }
        for ((changed, first), value) in self.changed.iter_mut().zip(&self.first).zip(values()) {
            *changed |= *first != value;
        }
    }

    fn with_changes(&self) -> impl Iterator<Item = (&Port, bool)> {
        self.ports.iter().zip(self.changed.iter().copied())
    }

    fn unchanged(&self, direction: Direction) -> impl Iterator<Item = String> {
        let still = self
            .with_changes()
            .filter(move |(port, changed)| port.direction == direction && !changed);
        still.map(|(port, _)| port.name.clone())
    }

    /// What an instance lacks to have been compared at all, in words. Where one top has several instances, the name of one
    /// begins the names of its ports.
    fn lacks(&self, instance: &Instance, is_one_of_several: bool) -> Option<String> {
        let is_own = |port: &Port| {
            let rest = port.name.strip_prefix(&instance.name);
            !is_one_of_several || rest.is_some_and(|rest| rest.starts_with('_'))
        };
        let mut inputs = self.with_changes().take(self.inputs);
        if !inputs.any(|(port, changed)| changed && is_own(port) && !is_timing(port)) {
            return Some("no data: none of its data inputs ever changes in the recording".to_owned());
        }
        let outputs = || {
            let all = self.with_changes().skip(self.inputs);
            all.filter(|(port, _)| instance.outputs.contains(&port.name))
        };
        let has_words = outputs().any(|(port, _)| port.width > 1);
        let mut results = outputs().filter(|(port, _)| port.width > 1 || !has_words);
        (!results.any(|(_, changed)| changed)).then(|| {
            let which = if has_words { "word at its outputs" } else { "output" };
            format!("no data: no {which} ever changes")
        })
    }
}

/// The recorded inputs as stimuli.
struct Inputs {
    player: Player,
    row: Vec<Option<Recorded>>,
    places: Vec<usize>,
    failed: Option<WaveError>,
}

impl Stimuli for Inputs {
    fn fill(&mut self, _seen: &[u64], inputs: &mut [u64]) {
        if self.failed.is_none() {
            self.failed = self.player.next(&mut self.row).err();
        }
        for (input, place) in inputs.iter_mut().zip(&self.places) {
            *input = self.row[*place].map_or(0, |value| value.bits);
        }
    }
}

/// The recorded outputs as a device. What the recording does not contain is taken from a model, so that it is no
/// mismatch.
struct Shown {
    player: Player,
    model: Box<dyn ClockedBlock>,
    row: Vec<Option<Recorded>>,
    outputs: Vec<usize>,
}

impl Device for Shown {
    fn ports(&self) -> &[Port] {
        self.model.ports()
    }

    fn step(&mut self, inputs: &[u64], outputs: &mut [u64], unknown: &mut [u64]) -> Result<(), StepError> {
        unknown.fill(0);
        self.model.step(inputs, outputs)?;
        let released = self
            .player
            .next(&mut self.row)
            .map_err(|error| StepError(error.to_string()))?;
        if released != Some(true) {
            return Ok(());
        }
        for (output, place) in outputs.iter_mut().zip(&self.outputs) {
            if let Some(value) = self.row[*place] {
                *output = *output & value.unknown | value.bits;
            }
        }
        Ok(())
    }
}
