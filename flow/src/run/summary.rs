//! The summary of a run for the terminal: a line per axis, the area, the number of checks, and the verdict.
//!
//! A failed check is always shown in full, with its likely cause. A check that compared nothing is also shown, except
//! with `--quiet`. `--verbose` prints all tables of [`RunReport::text`] instead.

use super::advice;
use super::checks::Check;
use super::closed_loop::ClosedLoop;
use super::report::RunReport;
use crate::bench::Simulator;
use crate::generate;
use crate::simulate::si_per_lsb;
use crate::style;
use crate::text::{Table, percent};
use posicast_machine::plan::ModeFigures;
use posicast_synth::yosys::Estimate;
use std::fmt::Write;
use std::path::{Path, PathBuf};

impl RunReport<'_> {
    /// The result in about ten lines, with the verdict last.
    pub(crate) fn summary(&self, root: &Path, files: &[PathBuf]) -> String {
        let mut text = format!("{}{}", self.heading(), self.axes_text());
        if let Some(estimate) = self.estimate {
            text += &area(estimate);
        }
        text += &self.closed_loop.map_or_else(String::new, ClosedLoop::error_tables_text);
        text += &self.checks_text(|check| !check.passed || check.is_open());
        let count = |verdict: fn(&Check) -> bool| self.checks.iter().filter(|check| verdict(check)).count();
        let (failed, open) = (count(|check| !check.passed), count(Check::is_open));
        let _ = write!(text, "checks: {} ok", self.checks.len() - failed - open);
        for (number, word) in [(open, "open"), (failed, "failed")] {
            if number > 0 {
                let _ = write!(text, ", {number} {word}");
            }
        }
        text.push('\n');
        text += &folder(root, files);
        text + &self.verdict()
    }

    /// The verdict alone, and failed checks.
    pub(crate) fn quiet(&self) -> String {
        self.checks_text(|check| !check.passed) + &self.verdict()
    }

    /// Name, clocks and simulator.
    pub(super) fn heading(&self) -> String {
        let clock = &self.machine.clock;
        format!(
            "{}: {} MHz clock, {} Hz samples, coefficients with {} fraction bits\nsimulator: {}; seed {}\n",
            self.machine.name,
            clock.frequency_hz / 1e6,
            clock.sample_hz,
            self.design.design.coefficient_fraction,
            self.tool(),
            self.seed,
        )
    }

    /// A line per axis: its shaper and the vibration with it, in the closed loop if there is one.
    fn axes_text(&self) -> String {
        let mut headings = vec!["axis", "shaper", ">residual, %", ">ringing unshaped", ">shaped"];
        if self.closed_loop.is_some() {
            headings.push(">tracking, peak");
        }
        let mut table = Table::new(&headings);
        for (index, axis, tables) in self.rows() {
            let residuals = tables.mode_figures(axis, self.sample_hz()).into_iter();
            let residual = residuals
                .map(|mode: ModeFigures| mode.residual_quantised)
                .reduce(f64::max);
            let per_lsb = si_per_lsb(self.machine, axis);
            let open = [self.axes[index].vibration_unshaped, self.axes[index].vibration].map(|lsb| lsb * per_lsb);
            let ringing = self.closed_loop.map_or(Some(open), |closed| closed.ringing(index));
            let show = |figures: Option<[f64; 2]>| match figures {
                Some(figures) => axis.unit.show_all(figures),
                None => ["-", "-"].map(str::to_owned),
            };
            let tracking = self.closed_loop.map(|closed| {
                let peak = closed.tracking_peak(index);
                peak.map_or_else(|| "-".to_owned(), |peak| axis.unit.show(peak, 3))
            });
            let residual = residual.map_or_else(|| "-".to_owned(), percent);
            let cells = [axis.name.clone(), tables.design.kind.clone(), residual];
            table.row(cells.into_iter().chain(show(ringing)).chain(tracking));
        }
        table.text("  ")
    }

    /// Lines for the checks to show; each failed one comes with its likely cause.
    pub(super) fn checks_text(&self, shown: impl Fn(&Check) -> bool) -> String {
        let mut text = String::new();
        for check in self.checks.iter().filter(|check| shown(check)) {
            let verdict = match (check.passed, check.is_open()) {
                (false, _) => style::bad(check.verdict()),
                (true, true) => style::doubtful(check.verdict()),
                (true, false) => style::good(check.verdict()),
            };
            let _ = writeln!(text, "{verdict}  {}: {}", check.name, check.detail);
            if !check.passed {
                text += &advice::text(check);
            }
        }
        text
    }

    /// The verdict that follows from the checks.
    pub(super) fn verdict(&self) -> String {
        let (pass, fail) = (style::passed("PASS"), style::bad("FAIL"));
        let failed: Vec<&Check> = self.checks.iter().filter(|check| !check.passed).collect();
        let mut text = match (failed.is_empty(), self.simulator) {
            (false, _) if failed.iter().all(|check| check.is_too_short()) => format!(
                "{}: nothing differed, but too few clocks were compared to use this Verilog in a machine.\n",
                style::bad("NO VERDICT")
            ),
            (false, _) => format!("{fail}: do not put this Verilog into a machine.\n"),
            (true, Simulator::Rusthdl) => format!(
                "{pass}, by the weaker check: the RustHDL description computes what was designed; its Verilog was not simulated.\n"
            ),
            (true, _) => format!("{pass}: the Verilog computes what was designed.\n"),
        };
        if self.checks.iter().any(Check::is_open) {
            text += "What is marked open was not exercised by this run: it is neither right nor wrong.\n";
        }
        text
    }
}

/// Area of the shapers compared with the device.
fn area(estimate: &Estimate) -> String {
    let (total, device) = (&estimate.total, &estimate.device);
    format!(
        "area of the shapers on {}, estimated: {} of {} cells, {} of {} registers, {} of {} memory bits, {} of {} multipliers\n",
        device.name,
        total.cells,
        device.cells,
        total.registers,
        device.registers,
        total.memory_bits,
        device.memory_bits,
        total.multipliers,
        device.multipliers
    )
}

/// Number of files and their folder.
pub(super) fn folder(root: &Path, files: &[PathBuf]) -> String {
    format!(
        "{} files written to {}: {}\n",
        files.len(),
        root.display(),
        generate::entries(root, files).join(", ")
    )
}
