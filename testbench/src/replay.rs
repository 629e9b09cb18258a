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

use posicast_model::rtl::{ClockedBlock, Direction, Port, StepError};

use crate::Error;
use crate::blocks::Block;
use crate::lockstep::report::LockstepReport;
use crate::lockstep::{self, Device, Instance};
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

    /// Replays this many clocks. The device and the recording are compared with the model, in rows of their own.
    ///
    /// # Errors
    /// Those of [`lockstep::run`], and of [`Player::next`] for a file that has changed since its [`Replay::extent`]
    /// was taken.
    pub fn run(
        &self,
        block: &dyn Block,
        device: &mut dyn Device,
        clocks: u64,
        seed: u64,
    ) -> Result<LockstepReport, Error> {
        let instances = block.instances(&self.ports);
        let of_device = self.against(block, device, &instances, clocks, seed)?;
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
            return Ok(of_device);
        }
        let mut shown = Shown {
            player: self.map.play()?,
            model: block.model(seed),
            row: vec![None; self.ports.len()],
            outputs: places(&self.ports, Direction::Output),
        };
        let of_recording = self.against(block, &mut shown, &recorded, clocks, seed)?;
        Ok(LockstepReport::joined(vec![of_device, of_recording]))
    }

    fn against(
        &self,
        block: &dyn Block,
        device: &mut dyn Device,
        instances: &[Instance],
        clocks: u64,
        seed: u64,
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
            &mut |_| {},
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
