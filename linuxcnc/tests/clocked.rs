//! The hardware's shaper, clock by clock, fed with the words of the component.

use posicast_blocks::shaper::{Inputs, Shaper, swap_how};
use posicast_blocks::shaper_tables::{AxisShaperTables, ShaperTablesError};

/// Clocks of a sample: more than the longest pass.
const SAMPLE_CLOCKS: usize = 1100;

/// The shaper with the tables of an axis in its banks: at most three.
pub(crate) struct Clocked {
    shaper: Shaper,
    bank: u32,
}

impl Clocked {
    /// Loads the tables through the ports, and starts at a word.
    pub(crate) fn new(tables: &AxisShaperTables, start: i64) -> Result<Self, ShaperTablesError> {
        let (config, all) = tables.shaper()?;
        assert!(all.len() <= 3, "the hardware has three banks");
        let mut shaper = Shaper::new(&config, 1);
        for (bank, table) in all.iter().enumerate().skip(1) {
            for (index, tap) in table.taps().iter().enumerate() {
                shaper.step(&Inputs {
                    tap_write: true,
                    tap_bank: bank as u8,
                    tap_index: index as u16,
                    tap_coefficient: tap.coefficient,
                    tap_delay: tap.delay_samples as u16,
                    ..Inputs::default()
                });
            }
        }
        shaper.step(&Inputs {
            start: true,
            x: start,
            ..Inputs::default()
        });
        for _ in 0..SAMPLE_CLOCKS {
            shaper.step(&Inputs::default());
        }
        Ok(Self { shaper, bank: 0 })
    }

    /// The next sample. A table that differs from the last one is requested before it, by a handover.
    pub(crate) fn sample(&mut self, word: i64, table: u32) -> i64 {
        if table != self.bank {
            self.bank = table;
            self.shaper.step(&Inputs {
                swap: true,
                swap_bank: table as u8,
                swap_how: swap_how::HANDOVER,
                ..Inputs::default()
            });
        }
        self.shaper.step(&Inputs {
            strobe: true,
            x: word,
            ..Inputs::default()
        });
        for _ in 0..SAMPLE_CLOCKS {
            self.shaper.step(&Inputs::default());
        }
        let outputs = self.shaper.outputs();
        assert!(!outputs.refused && !outputs.overrun && !outputs.busy, "{outputs:?}");
        outputs.y
    }
}
