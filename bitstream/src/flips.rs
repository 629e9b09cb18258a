//! Single faults in the bits: whether the comparisons find them.
//!
//! A fault is one bit of the bitstream. It is flipped, packed again with the right checksum, read back from the packed file, and compared
//! as the bitstream itself was. A flip that leaves the netlist of the bits unchanged, such as an entry of a table that its inputs cannot
//! select, can be found in the tiles alone.

use crate::BitstreamError;
use crate::error::at;
use crate::network::Network;
use crate::random::Random;
use crate::report::FlipKind;
use crate::toolchain::{BitsNetlist, Routed, TextBit, Toolchain};
use schemars::JsonSchema;
use serde::Serialize;
use std::fs;
use std::path::Path;
use std::thread;

/// Flips of each kind.
pub const PER_KIND: usize = 2;
/// Flips at a time: decoding one takes up to ten seconds.
const AT_ONCE: usize = 2;
/// Seed of the choice of the bits.
const SEED: u64 = 1;

/// Runs a netlist of the bits beside the model: the clock of the first difference.
pub type LockStep<'a> = dyn Fn(&dyn BitsNetlist) -> Result<Option<u64>, BitstreamError> + Sync + 'a;

/// What a bitstream is that faults are made in.
#[derive(Clone, Copy)]
pub struct FaultFree<'a> {
    /// The router's result.
    pub routed: &'a Routed,
    /// The packed file.
    pub packed: &'a [u8],
    /// Its text, read back from the packed file.
    pub text: &'a str,
    /// Its netlist.
    pub netlist: &'a dyn BitsNetlist,
    /// The same in the form that is simulated.
    pub network: &'a Network,
    /// Its lock step.
    pub lock_step: &'a LockStep<'a>,
}

/// A flip, and what found it.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct FlipReport {
    /// Kind of the bit.
    pub kind: FlipKind,
    /// Its place.
    pub place: String,
    /// Bytes of the packed file that differ, those of its checksum included.
    pub bytes: u64,
    /// Tiles that differ from the router's result.
    pub tiles: u64,
    /// Whether the netlist of the bits is another one.
    pub changes_netlist: bool,
    /// Differences between that netlist and the router's; 1 if it cannot be read.
    pub cells: u64,
    /// Clock at which the lock step ended with a difference.
    pub lock_step_clock: Option<u64>,
}

impl FlipReport {
    /// Whether the netlist changed, and neither cells nor lock step show it; or no tile differs.
    #[must_use]
    pub fn is_missed(&self) -> bool {
        let unseen = self.cells == 0 && self.lock_step_clock.is_none();
        self.tiles == 0 || (self.changes_netlist && unseen)
    }
}

/// Chooses [`PER_KIND`] flips of each kind that the bitstream has.
#[must_use]
pub fn choose(fault_free: &FaultFree<'_>) -> Vec<(FlipKind, TextBit)> {
    let mut random = Random::new(SEED);
    let mut chosen = Vec::new();
    for kind in FlipKind::ALL {
        let bits = fault_free.netlist.flips(fault_free.text, kind);
        if !bits.is_empty() {
            chosen.extend((0..PER_KIND).map(|_| (kind, bits[random.below(bits.len() as u64) as usize])));
        }
    }
    chosen
}

/// Makes these flips, some at a time, and compares each; `done` is called after each.
///
/// # Errors
/// The errors of the programs.
pub fn flips(
    fault_free: &FaultFree<'_>,
    (tools, folder): (&dyn Toolchain, &Path),
    chosen: &[(FlipKind, TextBit)],
    done: &(dyn Fn() + Sync),
) -> Result<Vec<FlipReport>, BitstreamError> {
    let worker = |chosen: &[(FlipKind, TextBit)], folder: &Path| {
        fs::create_dir(folder).map_err(at(folder))?;
        let flip = |(kind, bit): &(FlipKind, TextBit)| {
            let (text, place) = tools.flipped(fault_free.text, *bit);
            let report = flip(fault_free, (tools, folder), (*kind, place, &text))?;
            done();
            Ok(report)
        };
        chosen.iter().map(flip).collect::<Result<Vec<_>, BitstreamError>>()
    };
    let share = chosen.len().div_ceil(AT_ONCE).max(1);
    thread::scope(|scope| {
        let start = |(index, chosen): (usize, &'_ [(FlipKind, TextBit)])| {
            let (folder, chosen) = (folder.join(format!("flips_{index}")), chosen.to_vec());
            let worker = &worker;
            scope.spawn(move || worker(&chosen, &folder))
        };
        let running: Vec<_> = chosen.chunks(share).enumerate().map(start).collect();
        let mut reports = Vec::new();
        for worker in running {
            reports.extend(worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))?);
        }
        Ok(reports)
    })
}

fn flip(
    fault_free: &FaultFree<'_>,
    (tools, folder): (&dyn Toolchain, &Path),
    (kind, place, text): (FlipKind, String, &str),
) -> Result<FlipReport, BitstreamError> {
    let packed = tools.pack(text, folder)?;
    let text = tools.unpack(&packed, folder)?;
    let bytes = packed
        .iter()
        .zip(fault_free.packed)
        .filter(|(new, old)| new != old)
        .count();
    let mut report = FlipReport {
        kind,
        place,
        bytes: (bytes + packed.len().abs_diff(fault_free.packed.len())) as u64,
        tiles: tools.different_tiles(fault_free.text, &text).len() as u64,
        changes_netlist: true,
        cells: 0,
        lock_step_clock: None,
    };
    match tools.decode(&text, folder) {
        Ok(netlist) => {
            report.changes_netlist = netlist.network() != *fault_free.network;
            if !report.changes_netlist {
                return Ok(report);
            }
            report.cells = netlist.compare_cells(&fault_free.routed.netlist)?.differences;
            report.lock_step_clock = match (fault_free.lock_step)(netlist.as_ref()) {
                Ok(clock) => clock,
                // A netlist that cannot be simulated, such as one with a loop, is a difference from its first clock on.
                Err(BitstreamError::UnknownCell(_)) => Some(0),
                Err(other) => return Err(other),
            };
        }
        Err(BitstreamError::UnknownCell(_)) => report.cells = 1,
        Err(other) => return Err(other),
    }
    Ok(report)
}
