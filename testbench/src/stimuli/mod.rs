//! What the stimuli of the blocks share: each block's own are in its folder.

pub(crate) mod link_host;
pub(crate) mod table;

/// Makes the inputs of the next clock.
pub trait Stimuli {
    /// Fills `inputs`, in the order of the input ports. `seen` holds the outputs of the previous clock (zeros in the
    /// first). Bits above a port's width are ignored.
    fn fill(&mut self, seen: &[u64], inputs: &mut [u64]);
}

/// Any function is a stimulus.
impl<F: FnMut(&[u64], &mut [u64])> Stimuli for F {
    fn fill(&mut self, seen: &[u64], inputs: &mut [u64]) {
        self(seen, inputs);
    }
}
