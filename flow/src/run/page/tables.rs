//! Tables of the page: blocks in lock step, area, kinds of shaper.

use super::figure_at;
use crate::run::closed_loop::ClosedLoop;
use crate::run::report::RunReport;
use crate::text::percent;
use maud::{Markup, html};
use posicast_machine::compare::KindComparison;
use posicast_shaper::unit::show_seconds;
use posicast_synth::yosys::Resources;

/// A resource with its names in `report.json` and on the page.
type NamedResource = (&'static str, &'static str, fn(&Resources) -> u64);

const RESOURCES: [NamedResource; 4] = [
    ("cells", "cells", |of| of.cells),
    ("registers", "registers", |of| of.registers),
    ("memory_bits", "memory bits", |of| of.memory_bits),
    ("multipliers", "multipliers", |of| of.multipliers),
];

fn whole(number: f64) -> String {
    format!("{number:.0}")
}

impl RunReport<'_> {
    /// The blocks that ran beside their model.
    pub(super) fn blocks_table(&self) -> Markup {
        html! {
            div.wide { table {
                thead { tr { th { "block" } th { "instance" } th.number { "clocks" } th.number { "mismatches" } th { "not exercised" } } }
                tbody {
                    @for (index, block) in self.lockstep.blocks.iter().enumerate() {
                        @let path = |name: &str| format!("/verify/blocks/{index}/{name}");
                        tr {
                            td { (block.name) }
                            td { (block.instance) }
                            td.number { (figure_at(&path("cycles"), block.cycles as f64, whole)) }
                            td.number { (figure_at(&path("mismatches"), block.mismatches as f64, whole)) }
                            td { @if block.not_exercised.is_empty() { "nothing" } @else { (block.not_exercised.join(", ")) } }
                        }
                    }
                    @if let Some([clocks, mismatches]) = self.closed_loop.and_then(ClosedLoop::side_by_side) {
                        tr {
                            td { "stage" }
                            td { "the whole machine, in its move" }
                            td.number { (figure_at("/stage/side_by_side/clocks", clocks as f64, whole)) }
                            td.number { (figure_at("/stage/side_by_side/mismatches", mismatches as f64, whole)) }
                            td { "what the move does not reach" }
                        }
                    }
                }
            } }
        }
    }

    /// Resources of each block and of the device.
    pub(super) fn area_table(&self) -> Markup {
        let Some(estimate) = self.estimate else {
            return html! { p { "There is no estimate: Yosys is not installed." } };
        };
        let device = Resources {
            cells: estimate.device.cells,
            registers: estimate.device.registers,
            memory_bits: estimate.device.memory_bits,
            multipliers: estimate.device.multipliers,
            ..Resources::default()
        };
        let row = |place: &str, of: &Resources| {
            html! {
                @for (name, _, get) in RESOURCES { td.number { (figure_at(&format!("/synth/{place}/{name}"), get(of) as f64, whole)) } }
            }
        };
        html! {
            div.wide { table {
                thead { tr { th { "block" } @for (_, title, _) in RESOURCES { th.number { (title) } } } }
                tbody {
                    @for (index, block) in estimate.blocks.iter().enumerate() {
                        tr {
                            td { (block.name) }
                            (row(&format!("blocks/{index}"), &block.resources))
                        }
                    }
                    tr {
                        td { "all" }
                        (row("total", &estimate.total))
                    }
                    tr {
                        td { (estimate.device.name) }
                        (row("device", &device))
                    }
                    tr {
                        td { "taken" }
                        @for (_, _, get) in RESOURCES { td.number { (share(get(&estimate.total) as f64, get(&device) as f64)) } }
                    }
                }
            } }
            p { (estimate.method.tool) ": " (estimate.method.note) "." }
        }
    }
}

/// All kinds of shaper on an axis.
pub(super) fn kinds_table(index: usize, kinds: &KindComparison) -> Markup {
    html! {
        details {
            summary { "Axis " (kinds.axis) ": " (kinds.candidates.len()) " kinds" }
            div.wide { table {
                thead { tr {
                    th { "" } th { "kind" } th.number { "duration" } th.number { "worst residual" } th.number { "taps" } th.number { "delay" }
                } }
                tbody {
                    @for (place, kind) in kinds.candidates.iter().enumerate() {
                        @let path = |name: &str| format!("/kinds/axes/{index}/kinds/{place}/{name}");
                        tr {
                            td { @if kind.pareto { "*" } }
                            td { (kind.kind) @if kind.in_file { " (this machine)" } @if kind.shortest { " (the shortest that keeps the tolerance)" } }
                            td.number { (figure_at(&path("duration_s"), kind.duration_s, |s| show_seconds(s, 3))) }
                            td.number { (figure_at(&path("worst_residual"), kind.worst_residual, |part| format!("{} %", percent(part)))) }
                            td.number { (figure_at(&path("taps"), kind.taps as f64, whole)) }
                            td.number { (figure_at(&path("delay_s"), kind.delay_s, |s| show_seconds(s, 3))) }
                        }
                    }
                }
            } }
            @for missing in &kinds.missing { p { "No " (missing.kind) ": " (missing.reason) "." } }
        }
    }
}

fn share(part: f64, whole: f64) -> Markup {
    let percent = if whole > 0.0 { 100.0 * part / whole } else { 0.0 };
    html! { span.bar style=(format!("--part:{:.1}%", percent.min(100.0))) { (format!("{percent:.1} %")) } }
}
