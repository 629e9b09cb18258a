//! The result of a bitstream: the checks, each with what it covers, and what none of them covers.

use super::bare::BareReport;
use super::checks::{cells_check, clock_check, flips_check, lock_step_check, not_covered, tiles_check};
use posicast_bitstream::behaviour::BehaviourReport;
use posicast_bitstream::flips::FlipReport;
use posicast_bitstream::report::{CellsReport, TilesReport};
use posicast_bitstream::top::TopFiles;
use posicast_machine::machine_file::Machine;
use posicast_testbench::lockstep::report::LockstepReport;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// What was built and found.
pub(super) struct Evidence {
    pub(super) versions: [String; 2],
    pub(super) highest_mhz: f64,
    pub(super) tiles: TilesReport,
    pub(super) cells: CellsReport,
    pub(super) lock_step: LockStepDocument,
    pub(super) flips: Vec<FlipReport>,
    /// The bitstream itself.
    pub(super) packed: Vec<u8>,
    /// Files with the Verilog of the netlist of its bits.
    pub(super) verilog: Vec<(String, String)>,
    pub(super) seed: u64,
}

/// A bitstream, and the checks of its bits.
#[derive(Serialize, JsonSchema)]
pub struct Document {
    /// Name of the machine.
    pub name: String,
    /// Name of the board.
    pub board: &'static str,
    /// The device.
    pub device: &'static str,
    /// Its package.
    pub package: &'static str,
    /// Frequency of the board's oscillator.
    pub oscillator_hz: u32,
    /// Sample rate.
    pub sample_hz: f64,
    /// The pins.
    pub pins: Vec<PinDocument>,
    /// Versions of the programs.
    pub tools: [String; 2],
    /// Seed of the random commands.
    pub seed: u64,
    /// The checks; the bitstream is written only if all hold.
    pub checks: Vec<CheckDocument>,
    /// Highest frequency of the clock, by nextpnr's timing model.
    pub highest_mhz: f64,
    /// The bits, tile by tile, with those that the router wrote.
    pub tiles: TilesReport,
    /// The netlist of the bits with the router's.
    pub cells: CellsReport,
    /// The netlist of the bits with the model.
    pub lock_step: LockStepDocument,
    /// Single faults, and what found them.
    pub flips: Vec<FlipReport>,
    /// What none of the checks covers.
    pub not_covered: Vec<String>,
    /// Output folder; `None` if a check failed.
    pub folder: Option<String>,
    /// Files in the folder.
    pub files: Vec<String>,
    /// The board's name in prose.
    #[serde(skip)]
    pub title: String,
    /// Path of the bitstream; its name alone if it was not written.
    #[serde(skip)]
    pub bitstream: String,
    /// Whether an earlier file was checked, so that nothing is written.
    pub checked_only: bool,
}

/// The netlist of the bits in lock step with the model.
#[derive(Clone, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum LockStepDocument {
    /// Of shapers behind the board's serial line.
    Shapers(BehaviourReport),
    /// Of a stage on a board without wires.
    Bare(BareReport),
    /// Of a stage with its line.
    Stage {
        /// Clocks after configuration in which the stage is in reset; 0 if it is in reset again later.
        power_on_clocks: u64,
        /// The comparison with the model under the stimuli of the stage's own row.
        rows: LockstepReport,
    },
}

/// A pin of the device.
#[derive(Serialize, JsonSchema)]
pub struct PinDocument {
    /// Port of the top.
    pub port: String,
    /// Pin of the package.
    pub pin: &'static str,
    /// Its name on a header of the board; empty for a pin that has its own use there.
    pub header: &'static str,
}

/// A check.
#[derive(Serialize, JsonSchema)]
pub struct CheckDocument {
    /// Its name.
    pub name: &'static str,
    /// Whether it holds.
    pub ok: bool,
    /// What was compared, and how much of it; or what is wrong.
    pub what: String,
}

impl Document {
    pub(super) fn new(top: &TopFiles, machine: &Machine, evidence: &Evidence) -> Self {
        let board = &top.board;
        let needed_mhz = f64::from(board.oscillator_hz) / 1e6;
        let flips = &evidence.flips;
        Self {
            name: machine.name.clone(),
            board: board.name,
            device: board.device.name(),
            package: board.package,
            oscillator_hz: board.oscillator_hz,
            sample_hz: machine.clock.sample_hz,
            pins: pins(top),
            tools: evidence.versions.clone(),
            seed: evidence.seed,
            checks: vec![
                clock_check(evidence.highest_mhz, needed_mhz),
                tiles_check(&evidence.tiles, board.device.family()),
                cells_check(&evidence.cells),
                lock_step_check(&evidence.lock_step),
                flips_check(flips),
            ],
            highest_mhz: evidence.highest_mhz,
            tiles: evidence.tiles.clone(),
            cells: evidence.cells.clone(),
            lock_step: evidence.lock_step.clone(),
            flips: flips.clone(),
            not_covered: not_covered(&evidence.lock_step, flips, board.device.family()),
            folder: None,
            files: Vec::new(),
            title: board.title.to_owned(),
            bitstream: top.bitstream(),
            checked_only: false,
        }
    }

    /// The bits are those of this file.
    pub(super) fn checked(&mut self, packed: &Path) {
        self.bitstream = packed.display().to_string();
        self.checked_only = true;
    }

    /// Why the command fails; `None` if every check holds.
    pub(super) fn failed(&self) -> Option<String> {
        let failed: Vec<&str> = self
            .checks
            .iter()
            .filter(|check| !check.ok)
            .map(|check| check.name)
            .collect();
        let written = if self.checked_only {
            ""
        } else {
            "; no bitstream was written"
        };
        (!failed.is_empty()).then(|| format!("failed: {}{written}", failed.join(", ")))
    }

    /// The files were written.
    pub(super) fn written(&mut self, root: &Path, folder: &str, files: &[PathBuf]) {
        self.bitstream = root.join(folder).join(&self.bitstream).display().to_string();
        self.folder = Some(root.display().to_string());
        self.files = files
            .iter()
            .map(|file| file.strip_prefix(root).unwrap_or(file).display().to_string())
            .collect();
    }
}

fn pins(top: &TopFiles) -> Vec<PinDocument> {
    let pins = top.pins.iter().map(|pin| PinDocument {
        port: pin.port.clone(),
        pin: pin.pin,
        header: pin.header,
    });
    pins.collect()
}
