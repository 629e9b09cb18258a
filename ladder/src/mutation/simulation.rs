//! Runs all mutants of a block in lock step with its model, until the first wrong output of each.

use std::path::{Path, PathBuf};

use posicast_blocks::{ClockedBlock, Direction, Port};

use super::MutationOptions;
use super::netlist::{SELECT, SELECT_BITS};
use posicast_testbench::Error;
use posicast_testbench::blocks::Block;
use posicast_testbench::stimuli::Stimuli;
use posicast_testbench::verilator::{Verilated, VerilogSource};

/// Number of clocks of the first piece, in which most mutants are detected.
const FIRST_PIECE: u64 = 64;
/// Number of clocks of the longest piece, which limits the memory.
const LONGEST_PIECE: u64 = 4096;

/// First wrong output of a mutant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Kill {
    /// Seed of the run.
    pub seed: u64,
    /// Number of clocks since the start of the run.
    pub clock: u64,
}

/// A function that makes the stimuli of a run from its number of clocks and its seed.
pub type StimuliOf<'a, 'f> = &'f mut dyn FnMut(u64, u64) -> Box<dyn Stimuli + 'a>;

/// The block's model with its stimuli, a piece at a time.
struct Reference<'a> {
    model: Box<dyn ClockedBlock>,
    stimuli: Box<dyn Stimuli + 'a>,
    masks: Vec<u64>,
    outputs: usize,
    /// A row per clock: the model's inputs, then a column for the selection of a mutant.
    inputs: Vec<u64>,
    expected: Vec<u64>,
    seen: Vec<u64>,
    clock: u64,
}

impl<'a> Reference<'a> {
    fn new(model: Box<dyn ClockedBlock>, stimuli: Box<dyn Stimuli + 'a>) -> Self {
        let of = |direction| model.ports().iter().filter(move |port| port.direction == direction);
        let mask = |port: &Port| u64::MAX >> (64 - port.width.clamp(1, 64));
        let masks: Vec<u64> = of(Direction::Input).map(mask).collect();
        let outputs = of(Direction::Output).count();
        Self {
            model,
            stimuli,
            masks,
            outputs,
            inputs: Vec::new(),
            expected: Vec::new(),
            seen: vec![0; outputs],
            clock: 0,
        }
    }

    /// Computes the next piece of this many clocks.
    fn piece(&mut self, clocks: u64) -> Result<(), Error> {
        let width = self.masks.len() + 1;
        let clocks = usize::try_from(clocks).unwrap_or(usize::MAX);
        self.inputs.resize(clocks * width, 0);
        self.expected.resize(clocks * self.outputs, 0);
        let rows = self.inputs.chunks_exact_mut(width);
        for (row, expected) in rows.zip(self.expected.chunks_exact_mut(self.outputs.max(1))) {
            let (_, row) = row.split_last_mut().unwrap_or((&mut 0, &mut []));
            self.stimuli.fill(&self.seen, row);
            for (input, mask) in row.iter_mut().zip(&self.masks) {
                *input &= mask;
            }
            let step = self.model.step(row, expected);
            step.map_err(|source| Error::Step {
                clock: self.clock,
                source,
            })?;
            self.seen.copy_from_slice(expected);
            self.clock += 1;
        }
        Ok(())
    }

    /// The first clock of the piece in which the mutant's outputs are wrong; a mutant that stops the simulator is
    /// wrong from the first clock on.
    fn first_wrong(&mut self, device: &mut Verilated, number: u64, actual: &mut Vec<u64>) -> Option<usize> {
        for row in self.inputs.chunks_exact_mut(self.masks.len() + 1) {
            if let Some(select) = row.last_mut() {
                *select = number;
            }
        }
        actual.resize(self.expected.len(), 0);
        if device.run(&self.inputs, actual).is_err() {
            return Some(0);
        }
        let wrong = self.expected.iter().zip(actual.iter()).position(|(a, b)| a != b);
        wrong.map(|at| at / self.outputs.max(1))
    }
}

/// The first wrong output of each of the mutants 1 to `mutants` of a block, if there is one.
pub(super) fn run<'a>(
    block: &'a dyn Block,
    verilog: &Path,
    mutants: usize,
    options: &MutationOptions,
    stimuli: StimuliOf<'a, '_>,
) -> Result<Vec<Option<Kill>>, Error> {
    let mut kills = vec![None; mutants];
    for seed in 1..=options.runs {
        let reference = Reference::new(block.model(seed), stimuli(options.clocks, seed));
        chase(block, verilog, &mut kills, (options.clocks, seed), reference)?;
    }
    Ok(kills)
}

/// Makes one run: compares all undetected mutants with the reference.
fn chase(
    block: &dyn Block,
    verilog: &Path,
    kills: &mut [Option<Kill>],
    (clocks, seed): (u64, u64),
    mut reference: Reference<'_>,
) -> Result<(), Error> {
    let files = [verilog.to_owned()];
    let start = |number: usize| Ok((number, device(block, &files, seed)?));
    let mut itself = device(block, &files, seed)?;
    let alive = (1..=kills.len()).filter(|number| kills[number - 1].is_none());
    let mut living: Vec<(usize, Verilated)> = alive.map(start).collect::<Result<_, Error>>()?;
    let mut actual = Vec::new();
    let mut piece = FIRST_PIECE;
    while reference.clock < clocks && !living.is_empty() {
        let from = reference.clock;
        reference.piece(piece.min(clocks - from))?;
        if let Some(row) = reference.first_wrong(&mut itself, 0, &mut actual) {
            return Err(Error::Unlike(format!(
                "`{}` without a mutant differs from its model in clock {} of seed {seed}: run its lock-step test first",
                block.top(),
                from + row as u64
            )));
        }
        living.retain_mut(|(number, device)| {
            let Some(row) = reference.first_wrong(device, *number as u64, &mut actual) else {
                return true;
            };
            let clock = from + row as u64;
            kills[*number - 1] = Some(Kill { seed, clock });
            false
        });
        piece = (piece * 2).min(LONGEST_PIECE);
    }
    Ok(())
}

/// The netlist with all mutants, from its start.
fn device(block: &dyn Block, files: &[PathBuf], seed: u64) -> Result<Verilated, Error> {
    let mut ports = block.model(0).ports().to_vec();
    ports.push(Port {
        name: SELECT.to_owned(),
        direction: Direction::Input,
        width: SELECT_BITS,
        signed: false,
    });
    Verilated::build(
        &VerilogSource {
            files,
            top: &block.top(),
            ports: &ports,
        },
        seed,
    )
}
