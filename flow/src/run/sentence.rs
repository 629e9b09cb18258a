//! The verdict of a run as a sentence.

use super::checks::Check;
use crate::bench::Simulator;

/// The verdict that follows from the checks of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RunSentence {
    /// `PASS`, `FAIL` or `NO VERDICT`.
    pub word: &'static str,
    /// The rest of the sentence, which begins with a comma or a colon.
    pub rest: &'static str,
    /// A second sentence.
    pub remark: Option<&'static str>,
}

impl RunSentence {
    pub(super) fn of(checks: &[Check], simulator: Simulator) -> Self {
        let mut failed = checks.iter().filter(|check| !check.passed).peekable();
        let (word, rest) = match (failed.peek().is_none(), simulator) {
            (false, _) if failed.all(Check::is_too_short) => (
                "NO VERDICT",
                ": nothing differed, but too few clocks were compared to use this Verilog in a machine.",
            ),
            (false, _) => ("FAIL", ": do not put this Verilog into a machine."),
            (true, Simulator::Rusthdl) => (
                "PASS",
                ", by the weaker check: the RustHDL description computes what was designed; its Verilog was not simulated.",
            ),
            (true, _) => ("PASS", ": the Verilog computes what was designed."),
        };
        let is_open = checks.iter().any(Check::is_open);
        let remark = "What is marked open was not exercised by this run: it is neither right nor wrong.";
        Self {
            word,
            rest,
            remark: is_open.then_some(remark),
        }
    }
}
