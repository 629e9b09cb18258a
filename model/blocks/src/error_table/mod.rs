//! Compensates a measured error of screw or scale: the error over position, interpolated linearly, is taken from the position reference.
//!
//! The datasheet is `docs/error_table.md`; this is the reference that the hardware is compared with.
//!
//! ```text
//! place       = position − origin − first            position: position_reference, or measured with `on_measured`
//! error       = E_n + (E_n+1 − E_n) · fraction        n, fraction: place / 2^spacing_bits counts; E_0, E_last outside
//! table_error = error · weight / 1024                 each rounded once, half up
//! compensated = position_reference − table_error              cut at the ends of its word
//! ```
//!
//! - An entry is the true less the counted position, in 256ths of a count, or sixteenths with `coarse`.
//! - The weight goes up or down by 1 per `valid`: up while `error_enable`, `homed` and the wanted bank allow, else down; `drive_enable`
//!   low makes it 0. Bank and origin are taken while it is 0, so that another bank, or another origin, never makes a jump.
//! - Bank 0 is a ROM with the machine's table. Bank 1 is loaded from entry 0 on, in turn, while it is not in use; it is used once all
//!   entries are there. An entry that differs from the one before by more than a sixteenth of their distance is refused.
//! - One adder averages, a bit of the fraction per clock, lowest first: `y := (y + E_n or E_n+1) / 2` from `y = E_n`. It needs no multiplier.
//!
//! | bits | what |
//! |---|---|
//! | `lookup` | the arithmetic |
//! | `banks` | loading, reading back |
//!
//! ```text
//! clock              0    1 .. 40     41 ..       k      k+1
//! valid             ‾‾‾\____________________________________     k + 1 = ErrorTableConfig::latency_clocks
//! compensated_valid ______________________________/‾‾‾‾‾‾‾‾\_
//!                        place         average, weight
//! ```
//!
//! ```
//! use posicast_blocks::error_table::{EntryUnit, ErrorTable, ErrorTableConfig, ErrorTableFormat, FULL_WEIGHT, Inputs};
//!
//! // Entries 1024 counts apart: the screw is 0, 8 and 4 counts long.
//! let format = ErrorTableFormat { first_counts: 0, spacing_bits: 10, unit: EntryUnit::Fine };
//! let config = ErrorTableConfig::new(format, vec![0, 8 << 8, 4 << 8])?;
//! let mut table = ErrorTable::new(&config);
//! let on = Inputs { drive_enable: true, homed: true, error_enable: true, position_reference: 512 << 8, ..Inputs::default() };
//! for _ in 0..FULL_WEIGHT {
//!     table.step(&Inputs { valid: true, ..on });
//!     (0..config.latency_clocks()).for_each(|_| { table.step(&on); });
//! }
//! assert_eq!(table.outputs().table_error, 4 << 8);
//! assert_eq!(table.outputs().compensated, 508 << 8);
//! # Ok::<(), posicast_blocks::error_table::ErrorTableConfigError>(())
//! ```

mod banks;
mod config;
mod lookup;
mod ports;

pub use config::{
    ENTRY_BITS, EntryUnit, ErrorTableConfig, ErrorTableConfigError, ErrorTableFormat, LARGEST_ENTRY,
    LEAST_SPACING_BITS, MOST_ENTRIES, MOST_SPACING_BITS, STEEPEST, STEEPEST_BITS,
};
pub use lookup::FULL_WEIGHT;
pub use ports::{INPUT_PORTS, Inputs, OUTPUT_PORTS, Outputs, PORTS, ports};

use self::banks::Banks;
use self::lookup::{interpolated, weighted};
use super::{FOREVER, Moore, clocked_block, show_each};

/// Clocks of a pass, but for those of the fraction.
const PASS_CLOCKS: u32 = 58;

/// A pass: the clocks since `valid`, and the error that it will find.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Pass {
    clocks: u32,
    error: i32,
}

/// The block, cycle accurate at its ports. The two tied inputs stay as they are.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ErrorTable {
    format: ErrorTableFormat,
    latency_clocks: u32,
    banks: Banks,
    weight: u16,
    /// The bank in use.
    loaded: bool,
    /// Count of the first entry.
    base: i32,
    pass: Option<Pass>,
    error: i32,
    compensated: i32,
    compensated_valid: bool,
    coarse: bool,
}

impl ErrorTable {
    /// After reset, with the machine's table in bank 0.
    pub fn new(config: &ErrorTableConfig) -> Self {
        Self {
            format: config.format(),
            latency_clocks: config.latency_clocks(),
            banks: Banks::new(config),
            weight: 0,
            loaded: false,
            base: 0,
            pass: None,
            error: 0,
            compensated: 0,
            compensated_valid: false,
            coarse: false,
        }
    }

    /// Returns the outputs in this clock.
    pub fn outputs(&self) -> Outputs {
        Outputs {
            compensated: self.compensated,
            compensated_valid: self.compensated_valid,
            table_error: self.table_error(),
            error_weight: self.weight,
            error_bank_used: self.loaded,
            error_complete: self.banks.complete(),
            error_refused: self.banks.refused(),
            error_loaded: self.banks.found(),
            error_read_waits: self.banks.read_waits(),
        }
    }

    /// One clock: what the outputs show before the rising edge, then the edge.
    pub fn step(&mut self, inputs: &Inputs) -> Outputs {
        self.coarse = inputs.coarse;
        let shown = self.outputs();
        if inputs.rst {
            self.banks.reset();
            (self.weight, self.loaded, self.base, self.pass) = Default::default();
            (self.error, self.compensated, self.compensated_valid) = Default::default();
            return shown;
        }
        let complete = self.banks.complete();
        let in_use = self.loaded && self.weight != 0;
        self.banks.step(inputs, in_use, self.pass.is_some());
        self.go_on(inputs);
        if inputs.valid {
            self.weigh(inputs, complete);
            self.pass = Some(Pass { clocks: 1, error: 0 });
        }
        shown
    }

    /// A clock of the pass, if there is one.
    fn go_on(&mut self, inputs: &Inputs) {
        self.compensated_valid = false;
        let Some(mut pass) = self.pass else {
            return;
        };
        if pass.clocks == 1 && self.weight != 0 {
            let entries = self.banks.entries(self.loaded);
            pass.error = interpolated(entries, self.place(inputs), self.format.fraction_bits());
        }
        if pass.clocks == self.latency_clocks - 2 {
            self.error = weighted(pass.error, self.weight);
        }
        let ends = pass.clocks == self.latency_clocks - 1;
        if ends {
            self.compensated = inputs.position_reference.saturating_sub(self.table_error());
            self.compensated_valid = true;
        }
        pass.clocks += 1;
        self.pass = (!ends).then_some(pass);
    }

    /// Distance of the position from the first entry, in 256ths of a count.
    fn place(&self, inputs: &Inputs) -> i64 {
        let (counts, fraction) = if inputs.on_measured {
            (inputs.measured, 0)
        } else {
            (inputs.position_reference >> 8, inputs.position_reference & 0xff)
        };
        i64::from(counts.wrapping_sub(self.base)) << 8 | i64::from(fraction)
    }

    /// The next weight, and while it is 0 bank and origin.
    fn weigh(&mut self, inputs: &Inputs, complete: bool) {
        let wanted = inputs.error_enable && inputs.homed && (!inputs.error_select || complete);
        let is_off = self.weight == 0;
        self.weight = match is_off {
            _ if !inputs.drive_enable => 0,
            // A write of this clock may begin bank 1 anew.
            true => (wanted && !inputs.error_write).into(),
            false if wanted && inputs.error_select == self.loaded => (self.weight + 1).min(FULL_WEIGHT),
            false => self.weight - 1,
        };
        if is_off {
            self.loaded = inputs.error_select;
            self.base = inputs.origin.wrapping_add(self.format.first_counts);
        }
    }

    fn table_error(&self) -> i32 {
        self.error << if self.coarse { 4 } else { 0 }
    }
}

clocked_block!(ErrorTable, "the error table");

impl Moore for ErrorTable {
    fn show(&self, outputs: &mut [u64]) {
        show_each(outputs, self.outputs().to_raw());
    }

    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        let Ok(inputs) = <&[u64; INPUT_PORTS]>::try_from(inputs).map(Inputs::from_raw) else {
            return 0;
        };
        let acts = inputs.rst || inputs.valid || inputs.error_write || inputs.coarse != self.coarse;
        let ends = self.banks.refused() || self.compensated_valid;
        if acts || ends || self.banks.reads(inputs.error_read, self.pass.is_some()) {
            return 0;
        }
        match self.pass {
            None => FOREVER,
            Some(Pass { clocks: 1, .. }) => 0,
            Some(pass) => u64::from((self.latency_clocks - 2).saturating_sub(pass.clocks)),
        }
    }

    fn pass(&mut self, _inputs: &[u64], clocks: u64) {
        if let Some(pass) = &mut self.pass {
            pass.clocks += clocks as u32;
        }
    }

    fn ignores(&self, input: &str) -> bool {
        !matches!(
            input,
            "rst" | "valid" | "error_write" | "error_read" | "coarse" | "on_measured"
        )
    }
}
