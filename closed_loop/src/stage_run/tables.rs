//! The tap tables of an axis whose modes move with its own position: they are loaded and handed over by the position
//! of the command, as the driver's `posicast_select_table` does.

use posicast_blocks::shaper::swap_how;
use posicast_machine::machine_file::AxisSection;
use posicast_machine::plan::TableFamily;
use posicast_taps::COEFFICIENT_BITS;

use crate::stage_bench::StageBench;
use posicast_testbench::Error;

/// Position of the bank in `TAP_ADDRESS`.
const BANK_SHIFT: u32 = 8;
/// Position of the way of a swap in `SWAP`.
const HOW_SHIFT: u32 = 4;
/// Words of a command per count, which has 8 fraction bits.
const WORDS_PER_COUNT: f64 = 256.0;

/// The tables of an axis, with the one in use.
#[derive(Debug, Clone)]
pub(super) struct AxisTables {
    axis: String,
    family: TableFamily,
    /// Words of the command position per m or rad.
    words_per_unit: f64,
    now: usize,
    bank: u32,
}

impl AxisTables {
    /// The state after a reset; `None` if the modes do not move with the position.
    pub(super) fn new(axis: &AxisSection, family: &TableFamily) -> Option<Self> {
        let of_file = axis.family.as_ref()?;
        of_file.is_position().then(|| Self {
            axis: axis.name.clone(),
            family: family.clone(),
            words_per_unit: axis.loop_counts_per_unit() * WORDS_PER_COUNT,
            now: family.nominal,
            bank: 0,
        })
    }

    /// Hands over to the table for the command's position, unless an earlier handover is still active. Returns
    /// whether it did.
    pub(super) fn follow(&mut self, bench: &mut StageBench) -> Result<bool, Error> {
        let position = bench.read(&format!("{}_command_position", self.axis))? as i32;
        let chosen = self.family.choose(self.now, f64::from(position) / self.words_per_unit);
        if chosen == self.now || bench.field(&self.axis, "status", "swap_pending")? != 0 {
            return Ok(false);
        }
        let bank = match (chosen == self.family.nominal, self.bank) {
            (true, _) => 0,
            (false, 1) => 2,
            (false, _) => 1,
        };
        if bank > 0 {
            let taps = self.family.members[chosen].tables.table.taps();
            for (index, tap) in (0u32..).zip(taps) {
                let coefficient = tap.coefficient as u32 & ((1 << COEFFICIENT_BITS) - 1);
                bench.write(&format!("{}_tap_address", self.axis), index | bank << BANK_SHIFT)?;
                let word = coefficient | tap.delay_samples << COEFFICIENT_BITS;
                bench.write(&format!("{}_tap", self.axis), word)?;
            }
        }
        let how = u32::from(swap_how::HANDOVER);
        bench.write(&format!("{}_swap", self.axis), bank | how << HOW_SHIFT)?;
        (self.now, self.bank) = (chosen, bank);
        Ok(true)
    }
}
