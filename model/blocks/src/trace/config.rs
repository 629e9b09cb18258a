//! Build parameters of a trace memory.

/// Sizes for which a trace memory can be built, in words.
pub const SAMPLES: [u32; 4] = [256, 512, 1024, 2048];
/// Number of signals from which to choose.
pub const SIGNALS: usize = 16;
/// Largest number of signals in a row.
pub const ROW_SIGNALS: usize = 4;
/// Number of signals in a row for a value of the port `signals`: 0 one, 1 two, 2 and 3 four.
pub const fn row_signals(code: u8) -> usize {
    match code & 3 {
        0 => 1,
        1 => 2,
        _ => ROW_SIGNALS,
    }
}

/// Smallest number of clocks from a strobe that gives a row to the next strobe, for a value of the port `signals`:
/// one each for the strobe, the trigger's signal and its comparison, and one per signal.
pub const fn row_clocks(code: u8) -> u32 {
    row_signals(code) as u32 + 3
}

/// Build parameter of a trace memory: its size.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TraceConfig {
    samples: u32,
}

/// Why a trace memory cannot be built.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum TraceConfigError {
    /// The size is not in [`SAMPLES`].
    #[error("a trace of {0} samples: the memory is built for 256, 512, 1024 or 2048; choose the next larger one")]
    Samples(u64),
}

impl TraceConfig {
    /// A memory of this many words of 32 bits.
    ///
    /// # Errors
    /// [`TraceConfigError`] for a size that is not in [`SAMPLES`].
    pub fn new(samples: u64) -> Result<Self, TraceConfigError> {
        match u32::try_from(samples) {
            Ok(samples) if SAMPLES.contains(&samples) => Ok(Self { samples }),
            _ => Err(TraceConfigError::Samples(samples)),
        }
    }

    /// Size of the memory in words.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Address bits A, 8 to 11: the memory has 2^A words.
    pub fn address_bits(&self) -> u32 {
        self.samples.ilog2()
    }

    /// Number of rows of a trace for a value of the port `signals`.
    pub fn rows(&self, code: u8) -> usize {
        self.samples as usize / row_signals(code)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_sizes_and_no_other() {
        for (samples, bits) in [(256, 8), (512, 9), (1024, 10), (2048, 11)] {
            assert_eq!(TraceConfig::new(samples).unwrap().address_bits(), bits);
        }
        for samples in [0, 1, 255, 257, 1000, 4096, (1 << 32) + 256, u64::MAX] {
            assert_eq!(TraceConfig::new(samples), Err(TraceConfigError::Samples(samples)));
        }
    }

    #[test]
    fn rows_share_the_memory() {
        let config = TraceConfig::new(1024).unwrap();
        assert_eq!([0, 1, 2, 3].map(|code| config.rows(code)), [1024, 512, 256, 256]);
        assert_eq!([0, 1, 2, 3].map(row_clocks), [4, 5, 7, 7]);
    }
}
