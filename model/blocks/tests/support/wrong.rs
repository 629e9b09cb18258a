//! Blocks that report their quiet clocks wrongly, for tests that must detect it.

use posicast_blocks::{ClockedBlock, Moore, OutputKind, Port, StepError};

/// A block that reports something wrong.
pub(crate) struct Wrong {
    pub(crate) block: Box<dyn Moore>,
    /// `one more` clock, `no pass`, `ignores` all inputs, or another `kind` of output.
    pub(crate) what: &'static str,
}

impl ClockedBlock for Wrong {
    fn ports(&self) -> &[Port] {
        self.block.ports()
    }

    fn step(&mut self, inputs: &[u64], outputs: &mut [u64]) -> Result<(), StepError> {
        self.block.step(inputs, outputs)
    }
}

impl Moore for Wrong {
    fn show(&self, outputs: &mut [u64]) {
        self.block.show(outputs);
    }

    fn output_kind(&self, output: &str) -> OutputKind {
        match self.block.output_kind(output) {
            OutputKind::Counter if self.what == "kind" => OutputKind::Register,
            kind => kind,
        }
    }

    fn show_with(&mut self, inputs: &[u64], outputs: &mut [u64]) {
        self.block.show_with(inputs, outputs);
    }

    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        let clocks = self.block.quiet_clocks(inputs);
        if self.what == "one more" && clocks > 0 {
            clocks.saturating_add(1)
        } else {
            clocks
        }
    }

    fn pass(&mut self, inputs: &[u64], clocks: u64) {
        let clocks = clocks.min(self.block.quiet_clocks(inputs));
        if self.what != "no pass" {
            self.block.pass(inputs, clocks);
        }
    }

    fn ignores(&self, input: &str) -> bool {
        self.block.ignores(input) || (self.what == "ignores" && input != "rst")
    }
}
