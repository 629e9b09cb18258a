//! Tables of the page: blocks in lock step, area, kinds of shaper.

use super::Figures;
use crate::run::report::RunReport;
use crate::text::percent;
use maud::{Markup, html};
use posicast_machine::compare::KindComparison;
use posicast_shaper::unit::show_seconds;

fn whole(number: f64) -> String {
    format!("{number:.0}")
}

impl RunReport<'_> {
    /// The blocks that ran beside their model.
    pub(super) fn blocks_table(&self, figures: &Figures) -> Markup {
        html! {
            div.wide { table {
                thead { tr { th { "block" } th { "instance" } th.number { "clocks" } th.number { "mismatches" } th { "not exercised" } } }
                tbody {
                    @for (index, block) in self.lockstep.blocks.iter().enumerate() {
                        @let path = |name: &str| format!("/verify/blocks/{index}/{name}");
                        tr {
                            td { (block.name) }
                            td { (block.instance) }
                            td.number { (figures.show(&path("cycles"), whole)) }
                            td.number { (figures.show(&path("mismatches"), whole)) }
                            td { @if block.not_exercised.is_empty() { "nothing" } @else { (block.not_exercised.join(", ")) } }
                        }
                    }
                    @if figures.number("/stage/side_by_side/clocks").is_some() {
                        tr {
                            td { "stage" }
                            td { "the whole machine, in its move" }
                            td.number { (figures.show("/stage/side_by_side/clocks", whole)) }
                            td.number { (figures.show("/stage/side_by_side/mismatches", whole)) }
                            td { "what the move does not reach" }
                        }
                    }
                }
            } }
        }
    }

    /// Resources of each block and of the device.
    pub(super) fn area_table(&self, figures: &Figures) -> Markup {
        let Some(estimate) = self.estimate else {
            return html! { p { "There is no estimate: Yosys is not installed." } };
        };
        const RESOURCES: [(&str, &str); 4] = [
            ("cells", "cells"),
            ("registers", "registers"),
            ("memory_bits", "memory bits"),
            ("multipliers", "multipliers"),
        ];
        html! {
            div.wide { table {
                thead { tr { th { "block" } @for (_, title) in RESOURCES { th.number { (title) } } } }
                tbody {
                    @for (index, block) in estimate.blocks.iter().enumerate() {
                        tr {
                            td { (block.name) }
                            @for (name, _) in RESOURCES { td.number { (figures.show(&format!("/synth/blocks/{index}/{name}"), whole)) } }
                        }
                    }
                    tr {
                        td { "all" }
                        @for (name, _) in RESOURCES { td.number { (figures.show(&format!("/synth/total/{name}"), whole)) } }
                    }
                    tr {
                        td { (estimate.device.name) }
                        @for (name, _) in RESOURCES { td.number { (figures.show(&format!("/synth/device/{name}"), whole)) } }
                    }
                    tr {
                        td { "taken" }
                        @for (name, _) in RESOURCES {
                            @let of = |what: &str| figures.number(&format!("/synth/{what}/{name}")).unwrap_or(0.0);
                            td.number { (share(of("total"), of("device"))) }
                        }
                    }
                }
            } }
            p { (estimate.method.tool) ": " (estimate.method.note) "." }
        }
    }

    /// All kinds of shaper on an axis.
    pub(super) fn kinds_table(&self, index: usize, kinds: &KindComparison, figures: &Figures) -> Markup {
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
                                td.number { (figures.show(&path("duration_s"), |s| show_seconds(s, 3))) }
                                td.number { (figures.show(&path("worst_residual"), |part| format!("{} %", percent(part)))) }
                                td.number { (figures.show(&path("taps"), whole)) }
                                td.number { (figures.show(&path("delay_s"), |s| show_seconds(s, 3))) }
                            }
                        }
                    }
                } }
                @for missing in &kinds.missing { p { "No " (missing.kind) ": " (missing.reason) "." } }
            }
        }
    }
}

fn share(part: f64, whole: f64) -> Markup {
    let percent = match whole > 0.0 {
        true => 100.0 * part / whole,
        false => 0.0,
    };
    html! { span.bar style=(format!("--part:{:.1}%", percent.min(100.0))) { (format!("{percent:.1} %")) } }
}
