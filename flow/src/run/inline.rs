//! The inline shaper of a run: a controller's steps through it into the machine, its Verilog beside the model.

use super::Plan;
use super::Rtl;
use super::checks::Check;
use super::closed_loop::verdicts::{Ringing, calmer, named_equals_model};
use crate::bench::{self, Simulator};
use crate::design::DesignReport;
use crate::failure::Failure;
use crate::machine::of_hardware;
use crate::observer::Observer;
use crate::plot::{Curve, Panel, label, time_axis};
use crate::text::UnitDocument;
use posicast_closed_loop::inline_run::{InlineAxisMoved, InlineMoved, InlineRun};
use posicast_closed_loop::stage_run::{Compared, Expected, Shaping, StageRunError};
use posicast_machine::machine_file::{AxisSection, Machine};
use posicast_testbench::wording::counted;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::Path;

const EQUALS: &str = "the inline shaper's RTL equals the bit-exact model in every clock of the move";

/// What the inline shaper did.
pub(crate) struct InlineLoop<'a> {
    machine: &'a Machine,
    /// The Verilog beside the model; `None` without Verilator.
    compared: Option<Compared>,
    moved: InlineMoved,
    /// Figures with the shapers, and without, by axis.
    expected: [Vec<Expected>; 2],
}

/// `inline` in `run --json` and `report.json`: the move through the inline shaper.
#[derive(Serialize, JsonSchema)]
pub struct InlineRunFigures {
    /// Comparison of Verilog and model in the move; null without Verilator.
    pub side_by_side: Option<Compared>,
    /// Whether all axes were settled at the end, without a fault.
    pub settled: bool,
    /// The axes, in the order of the file.
    pub axes: Vec<InlineRunAxis>,
}

/// The move of an axis.
#[derive(Serialize, JsonSchema)]
pub struct InlineRunAxis {
    /// Name of the axis.
    pub name: String,
    /// Its unit.
    #[serde(flatten)]
    pub unit: UnitDocument,
    /// Steps of the controller, up less down.
    pub sent_steps: i64,
    /// Steps that the drive got.
    pub given_steps: i64,
    /// Steps that the motor lost; 0 without `[axis.stepper]`.
    pub lost_steps: i64,
    /// Vibration of the load after the move with the controller's own steps, in `si_unit`.
    pub ringing_unshaped: f64,
    /// Vibration of the load after the move with the shaped steps, in `si_unit`.
    pub ringing: f64,
    /// The same as expected from the design.
    pub ringing_expected: f64,
}

/// Runs the inline shaper, if the machine has one.
pub(super) fn run<'a>(
    (design, path): (&'a DesignReport<'a>, &Path),
    plan: &Plan,
    rtl: &Rtl<'_>,
    seed: u64,
    observer: &dyn Observer,
) -> Result<Option<InlineLoop<'a>>, Failure> {
    let hardware = design.hardware.inline();
    let Some(hardware) = hardware.map_err(|error| of_hardware(&error, path))? else {
        return Ok(None);
    };
    let machine = design.machine;
    let refused = |error| match error {
        StageRunError::Bench(error) => bench::failure(error),
        other => Failure::because(other).in_file(path),
    };
    let run = InlineRun::new(machine, &design.design, hardware, &plan.moves, seed).map_err(refused)?;
    let of_block = rtl.inline().filter(|_| plan.simulator == Simulator::Verilator);
    let compared = of_block.map(|block| {
        let sources = rtl.sources.reached_by(block).map_err(bench::failure)?;
        let mut device = plan.simulator.device(block, &sources, seed).map_err(bench::failure)?;
        let bar = observer.begin("inline shaper", Some(run.compared_clocks()));
        let mut done = 0;
        let mut progress = |clock| {
            bar.advance(clock - done);
            done = clock;
        };
        run.side_by_side(block, device.as_mut(), &mut progress).map_err(refused)
    });
    Ok(Some(InlineLoop {
        machine,
        compared: compared.transpose()?,
        moved: run.moved().map_err(refused)?,
        expected: [
            run.expected(Shaping::Shaped).map_err(refused)?,
            run.expected(Shaping::Unshaped).map_err(refused)?,
        ],
    }))
}

impl InlineLoop<'_> {
    /// All checks.
    pub(super) fn checks(&self) -> Vec<Check> {
        let mut checks = vec![match &self.compared {
            Some(compared) => named_equals_model(EQUALS, compared, ("from reset", "standstill after the move")),
            None => Check::not_exercised(
                EQUALS,
                true,
                "only Verilator simulates it; choose `--simulator verilator`",
            ),
        }];
        checks.push(self.steps_come_out());
        let rung: Vec<_> = self.axes().filter(|(axis, ..)| !axis.modes.is_empty()).collect();
        let rung: Vec<_> = rung
            .iter()
            .map(|(axis, moved, [expected, bare])| (*axis, Some(ringing(axis, moved, expected, bare))))
            .collect();
        checks.extend(calmer(&rung, true));
        checks
    }

    fn axes(&self) -> impl Iterator<Item = (&AxisSection, &InlineAxisMoved, [&Expected; 2])> {
        let [shaped, unshaped] = &self.expected;
        let expected = shaped.iter().zip(unshaped).map(|(shaped, unshaped)| [shaped, unshaped]);
        let axes = self.machine.axes.iter().zip(&self.moved.axes).zip(expected);
        axes.map(|((axis, moved), expected)| (axis, moved, expected))
    }

    /// As many steps must come out as went in, and no motor may lose one.
    fn steps_come_out(&self) -> Check {
        let name = "the inline shaper gives every step that it gets";
        let wrong = self
            .axes()
            .find(|(_, moved, _)| moved.sent_steps != moved.given_steps || moved.lost_steps != 0);
        let all: Vec<String> = self
            .axes()
            .map(|(axis, moved, _)| format!("axis {}: {}", axis.name, moved.given_steps))
            .collect();
        let nothing = self.moved.axes.iter().all(|moved| moved.sent_steps == 0);
        match wrong {
            Some((axis, moved, _)) => Check::new(
                name,
                false,
                format!(
                    "axis {}: {} went in, {} came out, and the motor lost {}",
                    axis.name,
                    counted(moved.sent_steps.unsigned_abs(), "step"),
                    moved.given_steps.unsigned_abs(),
                    moved.lost_steps.unsigned_abs()
                ),
            ),
            None if self.moved.fault => Check::new(name, false, "the axes stopped with a fault".to_owned()),
            None if !self.moved.settled => Check::new(name, false, "the axes were not settled at the end".to_owned()),
            None if nothing => Check::not_exercised(name, true, "no axis moved by a step"),
            None => Check::new(
                name,
                true,
                format!("steps of the move in the model, {}", all.join(", ")),
            ),
        }
    }

    /// `inline` of the document.
    pub(super) fn json(&self) -> InlineRunFigures {
        InlineRunFigures {
            side_by_side: self.compared.clone(),
            settled: self.moved.settled && !self.moved.fault,
            axes: self
                .axes()
                .map(|(axis, moved, [expected, _])| {
                    let [ringing, ringing_unshaped] = figures(axis, moved);
                    InlineRunAxis {
                        name: axis.name.clone(),
                        unit: UnitDocument::new(axis.unit),
                        sent_steps: moved.sent_steps,
                        given_steps: moved.given_steps,
                        lost_steps: moved.lost_steps,
                        ringing_unshaped,
                        ringing,
                        ringing_expected: expected.figures.residual.peak,
                    }
                })
                .collect(),
        }
    }

    /// The load of each axis with modes after its move.
    pub(super) fn picture(&self) -> (&'static str, Vec<Panel>) {
        let axes = self.axes().filter(|(axis, ..)| !axis.modes.is_empty());
        let panels = axes.map(|(axis, moved, _)| {
            let curves = [("unshaped", Shaping::Unshaped), ("shaped", Shaping::Shaped)]
                .map(|(name, shaping)| (name, moved.ringing(shaping)));
            let shown = curves.iter().map(|(_, load)| load.len()).min().unwrap_or(0);
            let seconds = |tick: usize| tick as f64 / self.machine.clock.sample_hz;
            let time = time_axis(seconds(shown));
            let unit = axis
                .unit
                .for_largest(curves.iter().flat_map(|(_, load)| load.iter().take(shown).copied()));
            let curves = curves.into_iter().map(|(name, load)| {
                let points = load.into_iter().take(shown).enumerate();
                let points = points
                    .map(|(tick, position)| (time.of(seconds(tick)), unit.of(position)))
                    .collect();
                match name {
                    "unshaped" => Curve::reference(name, points),
                    _ => Curve::new(name, points),
                }
            });
            Panel {
                title: format!("{}, axis {}: the load after its move", self.machine.name, axis.name),
                x_label: label("time since the last step", time),
                y_label: label("from its place of rest", unit),
                curves: curves.collect(),
                ..Panel::default()
            }
        });
        ("plots/inline-vibration.svg", panels.collect())
    }
}

/// Vibration with the shaper and without, in m or rad.
fn figures(axis: &AxisSection, moved: &InlineAxisMoved) -> [f64; 2] {
    [Shaping::Shaped, Shaping::Unshaped].map(|shaping| moved.figures(shaping, axis.counts_per_unit).residual.peak)
}

fn ringing<'a>(axis: &AxisSection, moved: &InlineAxisMoved, expected: &'a Expected, bare: &'a Expected) -> Ringing<'a> {
    let [found, without] = figures(axis, moved);
    Ringing {
        found,
        without,
        expected,
        bare,
        handovers: 0,
        harsh: false,
    }
}
