//! What a bitstream is built of, and how its bits are compared with a model: the shapers of a machine behind the board's serial line, or a
//! whole stage with its own line.

use super::bare::Bare;
use super::document::LockStepDocument;
use crate::hardware::Built;
use posicast_bitstream::BitstreamError;
use posicast_bitstream::behaviour;
use posicast_bitstream::boards::{FpgaBoard, PinUse};
use posicast_bitstream::network::{NetIndex, NetlistSimulation, Network};
use posicast_bitstream::toolchain::BitsNetlist;
use posicast_bitstream::top::stage::{self, POWER_ON_CLOCKS, RUNNING};
use posicast_bitstream::top::{BoardTop, TopAxis, TopFiles};
use posicast_blocks::{Direction, Port, StepError};
use posicast_machine::machine_file::Machine;
use posicast_testbench::blocks::{self, Block};
use posicast_testbench::linked_stage::LinkedStageBlock;
use posicast_testbench::lockstep::Device;
use serde_json::Value;
use std::ops::RangeInclusive;

/// Clocks of the lock step of shapers, unless exercising every tap takes more.
const SHAPER_CLOCKS: u64 = 2_000_000;
/// Clocks of the lock step of a stage, unless exercising what its verdict covers takes more.
const STAGE_CLOCKS: u64 = 1_000_000;
/// Clocks that the moves on a board without wires take, about.
const BARE_CLOCKS: u64 = 5_000_000;
/// Factor by which the lock step of a stage may take longer, until its stimuli have exercised everything that the verdict covers.
const MOST_TIMES_LONGER: u64 = 4;
/// Most clocks of the lock step of a fault in shapers, unless exercising every tap takes more.
const SHAPER_FAULT_CLOCKS: u64 = 300_000;
/// Clocks of the lock step of a fault in a stage.
const STAGE_FAULT_CLOCKS: u64 = 100_000;
/// Clocks after the power-on reset in which it is watched.
const WATCHED_CLOCKS: u64 = 10_000;

/// What a bitstream is built of.
pub(super) enum Subject<'a> {
    /// The shapers of a machine.
    Shapers(BoardTop),
    /// A stage with its line.
    Stage {
        machine: String,
        board: FpgaBoard,
        block: &'a LinkedStageBlock,
        /// Stand-ins, for a board without wires.
        bare: Option<Bare<'a>>,
    },
}

impl<'a> Subject<'a> {
    /// The stage of a machine with a line, with stand-ins if there are any; of others the shapers.
    pub(super) fn new(
        machine: &Machine,
        board: &FpgaBoard,
        built: &'a Built<'_>,
        bare: Option<Bare<'a>>,
    ) -> Result<Self, BitstreamError> {
        if let Some(block) = &built.link {
            return Ok(Self::Stage {
                machine: machine.name.clone(),
                board: *board,
                block,
                bare,
            });
        }
        let axes = built.shapers.iter().map(|shaper| {
            let config = shaper.config.taps().cloned();
            Ok(TopAxis {
                name: shaper.axis.clone(),
                config: config.ok_or_else(|| BitstreamError::Cascade(shaper.axis.clone()))?,
            })
        });
        let clocks = machine.clock.clocks_per_sample();
        Ok(Self::Shapers(BoardTop::new(
            &machine.name,
            *board,
            clocks,
            axes.collect::<Result<_, BitstreamError>>()?,
        )?))
    }

    /// The top and its pins.
    pub(super) fn files(&self) -> Result<TopFiles, BitstreamError> {
        match self {
            Self::Shapers(top) => Ok(top.files()),
            Self::Stage {
                machine,
                board,
                block,
                bare,
            } => {
                let direction = |port: &Port| match port.direction {
                    Direction::Input => PinUse::Input,
                    Direction::Output => PinUse::Output,
                };
                let ports = ports(block);
                let clock = ("clk".to_owned(), PinUse::Input);
                let named = ports.iter().map(|port| (port.name.clone(), direction(port)));
                let named: Vec<_> = std::iter::once(clock).chain(named).collect();
                match bare {
                    None => stage::top(machine, *board, &block.top(), &named),
                    Some(bare) => stage::bare(machine, *board, &block.top(), &named, &bare.stand_ins),
                }
            }
        }
    }

    /// What is built, as a word.
    pub(super) fn what(&self) -> &'static str {
        match self {
            Self::Shapers(_) => "shapers",
            Self::Stage { bare: None, .. } => "stage",
            Self::Stage { .. } => "bare",
        }
    }

    /// The module whose instances are the blocks.
    pub(super) fn logic(&self) -> String {
        match self {
            Self::Shapers(top) => top.machine().to_owned(),
            Self::Stage { block, .. } => block.inside().to_owned(),
        }
    }

    /// Fewest and most clocks of the lock step.
    pub(super) fn clocks(&self, asked: Option<u64>) -> RangeInclusive<u64> {
        let (fewest, most) = match self {
            Self::Shapers(top) => (SHAPER_CLOCKS.max(behaviour::least_clocks(top)), 1),
            // The moves decide; the bar shows about how long they take.
            Self::Stage { bare: Some(_), .. } => (BARE_CLOCKS, MOST_TIMES_LONGER),
            Self::Stage { block, .. } => (STAGE_CLOCKS.max(block.least_clocks()), MOST_TIMES_LONGER),
        };
        match asked {
            Some(clocks) => clocks..=clocks,
            None => fewest..=most * fewest,
        }
    }

    /// Runs the netlist of the bits beside the model.
    pub(super) fn lock_step(
        &self,
        netlist: &dyn BitsNetlist,
        routed: &Value,
        (clocks, seed): (RangeInclusive<u64>, u64),
        progress: &mut dyn FnMut(u64),
    ) -> Result<LockStepDocument, BitstreamError> {
        match self {
            Self::Shapers(top) => {
                let clocks = (*clocks.end(), seed);
                behaviour::compare(&netlist.network(), top, clocks, progress).map(LockStepDocument::Shapers)
            }
            Self::Stage {
                block,
                board,
                bare: Some(bare),
                ..
            } => {
                let seed = blocks::row_seed(*block, seed);
                let limits = (*clocks.end(), seed);
                let report = bare.lock_step(&netlist.network(), (block, board), limits, progress)?;
                Ok(LockStepDocument::Bare(report))
            }
            Self::Stage { block, board, .. } => {
                let network = netlist.network();
                let running = netlist.net(routed, RUNNING)?;
                let power_on_clocks = power_on_clocks(&network, board, running)?;
                let mut device = StageBits::new(&network, running, &self.files()?, block)?;
                let seed = blocks::row_seed(*block, seed);
                let report = blocks::judge(*block, &mut device, clocks, seed, progress);
                Ok(LockStepDocument::Stage {
                    power_on_clocks,
                    rows: report.map_err(|error| BitstreamError::UnknownCell(error.to_string()))?,
                })
            }
        }
    }

    /// The clock of the first difference between a netlist with a fault and the model; `None` without one.
    pub(super) fn first_difference(
        &self,
        netlist: &dyn BitsNetlist,
        routed: &Value,
        seed: u64,
    ) -> Result<Option<u64>, BitstreamError> {
        let clocks = match self {
            Self::Shapers(top) => SHAPER_FAULT_CLOCKS.max(behaviour::least_clocks(top)),
            Self::Stage { .. } => STAGE_FAULT_CLOCKS,
        };
        let found = self.lock_step(netlist, routed, (clocks..=clocks, seed), &mut |_| {})?;
        Ok(match found {
            LockStepDocument::Shapers(report) => report.first.map(|first| first.clock),
            LockStepDocument::Bare(report) => report.first.map(|first| first.clock),
            LockStepDocument::Stage { power_on_clocks, rows } => {
                let first = rows
                    .blocks
                    .iter()
                    .filter_map(|row| Some(row.first.as_ref()?.time))
                    .min();
                match power_on_clocks {
                    POWER_ON_CLOCKS => first,
                    other => Some(other),
                }
            }
        })
    }
}

/// The ports of a stage with its line, but for its clock.
fn ports(block: &LinkedStageBlock) -> Vec<Port> {
    block.model(1).ports().to_vec()
}

/// The clocks after configuration in which the stage is in reset; 0 if it is in reset again later.
fn power_on_clocks(network: &Network, board: &FpgaBoard, running: NetIndex) -> Result<u64, BitstreamError> {
    let mut simulation = NetlistSimulation::new(network, board.clock.pin)?;
    let mut clocks = 0;
    for clock in 0..POWER_ON_CLOCKS + WATCHED_CLOCKS {
        simulation.settle();
        if !simulation.level(running) {
            if clocks != clock {
                return Ok(0);
            }
            clocks += 1;
        }
        simulation.clock();
    }
    Ok(clocks)
}

/// The netlist of a stage's bits, whose power-on reset is replaced by the reset of the stage, as a device on the test bench.
struct StageBits {
    ports: Vec<Port>,
    simulation: NetlistSimulation,
    /// The net of each input, and whether it takes the inverse of the port.
    inputs: Vec<(NetIndex, bool)>,
    outputs: Vec<NetIndex>,
}

impl StageBits {
    fn new(
        network: &Network,
        running: NetIndex,
        top: &TopFiles,
        block: &LinkedStageBlock,
    ) -> Result<Self, BitstreamError> {
        let mut network = network.clone();
        network.states.retain(|state| state.output != running);
        network.inputs.push((RUNNING.to_owned(), running));
        let simulation = NetlistSimulation::new(&network, top.board.clock.pin)?;
        let ports = ports(block);
        let pin = |port: &Port| {
            let pin = top.pins.iter().find(|pin| pin.port == port.name);
            pin.map(|pin| pin.pin)
                .ok_or_else(|| BitstreamError::UnknownCell(format!("no pin of the port {}", port.name)))
        };
        let of = |direction| ports.iter().filter(move |port| port.direction == direction);
        let inputs = of(Direction::Input).map(|port| match port.name.as_str() {
            "rst" => Ok((running, true)),
            _ => Ok((simulation.input(pin(port)?)?, false)),
        });
        let inputs = inputs.collect::<Result<Vec<_>, BitstreamError>>()?;
        let outputs = of(Direction::Output).map(|port| simulation.output(pin(port)?));
        let outputs = outputs.collect::<Result<Vec<_>, BitstreamError>>()?;
        Ok(Self {
            simulation,
            inputs,
            outputs,
            ports,
        })
    }
}

impl Device for StageBits {
    fn ports(&self) -> &[Port] {
        &self.ports
    }

    fn step(&mut self, inputs: &[u64], outputs: &mut [u64], unknown: &mut [u64]) -> Result<(), StepError> {
        unknown.fill(0);
        for ((net, is_inverse), level) in self.inputs.iter().zip(inputs) {
            self.simulation.set(*net, (*level != 0) != *is_inverse);
        }
        self.simulation.settle();
        for (output, net) in outputs.iter_mut().zip(&self.outputs) {
            *output = u64::from(self.simulation.level(*net));
        }
        self.simulation.clock();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::DesignReport;
    use crate::observer::Silent;
    use posicast_bitstream::boards::board;
    use std::path::{Path, PathBuf};

    fn root() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
    }

    /// The files of the example of the first light.
    fn first_light() -> TopFiles {
        let path = root().join("examples/colorlight-i5.toml");
        let file = super::super::machine::on_board(&path, &board("colorlight-i5").unwrap()).unwrap();
        let report = DesignReport::new(&file.machine, &path).unwrap();
        let built = Built::new(&report, &path, &Silent).unwrap();
        let subject = Subject::new(&file.machine, &board("colorlight-i5").unwrap(), &built, None).unwrap();
        subject.files().unwrap()
    }

    #[test]
    fn an_open_wire_stops_the_axis() {
        let constraints = first_light().constraints();
        for port in ["emergency_stop_n", "x_limit_plus_n", "x_fault_n", "x_drive_ready"] {
            let line = format!("\"{port}\" IO_TYPE=LVCMOS33 PULLMODE=DOWN;");
            assert!(constraints.contains(&line), "{port}");
        }
    }

    /// A reader of the page connects wires as it says.
    #[test]
    fn the_page_of_the_first_light_names_the_pins_of_its_example() {
        let page = std::fs::read_to_string(root().join("docs/first-light.md")).unwrap();
        let pins = first_light().pins;
        let wired: Vec<_> = pins.iter().filter(|pin| !pin.header.is_empty()).collect();
        assert!(wired.len() > 15);
        for pin in &wired {
            let row = format!("| `{}` | {} |", pin.port, pin.header);
            assert!(page.contains(&row), "{row}");
        }
        let rows = page.lines().filter(|line| line.starts_with("| `"));
        assert_eq!(rows.count(), wired.len());
    }
}
