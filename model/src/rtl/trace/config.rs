//! What is fixed when a trace memory is built.

/// Words that a trace memory is built for.
pub const SAMPLES: [u32; 4] = [256, 512, 1024, 2048];
/// Signals that can be chosen from.
pub const SIGNALS: usize = 16;
/// Signals in a row, at most.
pub const ROW_SIGNALS: usize = 4;
/// Clocks from a strobe of which a row of `signals` signals is taken until the next strobe may come: the strobe, the
/// trigger's signal, its comparison, and a clock per signal.
pub const fn row_clocks(signals: usize) -> u32 {
    signals as u32 + 3
}

/// Signals in a row, by what the port `signals` says: 0 one, 1 two, 2 and 3 four.
pub const fn row_signals(code: u8) -> usize {
    match code & 3 {
        0 => 1,
        1 => 2,
        _ => ROW_SIGNALS,
    }
}

/// What is fixed when a trace memory is built: its size.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TraceConfig {
    samples: u32,
}

/// Why no trace memory can be built.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum TraceConfigError {
    /// A size that is not in [`SAMPLES`].
    #[error("a trace of {0} samples: the memory is built for 256, 512, 1024 or 2048; choose the next larger one")]
    Samples(u64),
}

impl TraceConfig {
    /// A memory of so many words of 32 bits.
    ///
    /// # Errors
    /// [`TraceConfigError`] for a size that is not in [`SAMPLES`].
    pub fn new(samples: u64) -> Result<Self, TraceConfigError> {
        match u32::try_from(samples) {
            Ok(samples) if SAMPLES.contains(&samples) => Ok(Self { samples }),
            _ => Err(TraceConfigError::Samples(samples)),
        }
    }

    /// Words of the memory.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// A: the memory has 2^A words, 8 to 11.
    pub fn address_bits(&self) -> u32 {
        self.samples.ilog2()
    }

    /// Rows that a trace has, by what the port `signals` says.
    pub fn rows(&self, code: u8) -> usize {
        self.samples as usize / row_signals(code)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_four_sizes_and_no_other() {
        for (samples, bits) in [(256, 8), (512, 9), (1024, 10), (2048, 11)] {
            assert_eq!(TraceConfig::new(samples).unwrap().address_bits(), bits);
        }
        for samples in [0, 1, 255, 257, 1000, 4096, (1 << 32) + 256, u64::MAX] {
            assert_eq!(TraceConfig::new(samples), Err(TraceConfigError::Samples(samples)));
        }
    }

    #[test]
    fn unit_rows_share_the_memory() {
        let config = TraceConfig::new(1024).unwrap();
        assert_eq!([0, 1, 2, 3].map(|code| config.rows(code)), [1024, 512, 256, 256]);
    }
}
