//! What the stimuli of the blocks share: each block's own are in its folder.

pub(crate) mod link_host;
pub(crate) mod table;

/// Makes the inputs of the next clock.
pub trait Stimuli {
    /// Fills `inputs`, in the order of the input ports. `seen` holds the outputs of the previous clock (zeros in the
    /// first). Bits above a port's width are ignored.
    fn fill(&mut self, seen: &[u64], inputs: &mut [u64]);
}

/// The first N of these values, with 0 for those that are missing: a row of ports as `from_raw` takes it.
pub(crate) fn row<const N: usize>(values: &[u64]) -> [u64; N] {
    std::array::from_fn(|place| values.get(place).copied().unwrap_or(0))
}

/// Any function is a stimulus.
impl<F: FnMut(&[u64], &mut [u64])> Stimuli for F {
    fn fill(&mut self, seen: &[u64], inputs: &mut [u64]) {
        self(seen, inputs);
    }
}
