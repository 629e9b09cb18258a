//! A sentence per axis: what its shaper costs, and what it gains.

use super::Figures;
use crate::output::percent;
use crate::run::gain::{Gain, GainSource};
use crate::run::report::RunReport;
use maud::{Markup, html};
use posicast_model::machine_file::AxisSection;
use posicast_model::unit::show_seconds;

/// A time with the digits that a sentence needs.
fn time(seconds: f64) -> String {
    show_seconds(seconds.abs(), 2)
}

impl RunReport<'_> {
    pub(super) fn sentences(&self, figures: &Figures) -> Markup {
        html! {
            ul.gains {
                @for ((index, axis, tables), gain) in self.rows().zip(&self.gains) {
                    li {
                        strong { "Axis " (axis.name) ", " (tables.design.kind) }
                        ": " (cost(gain, index, figures)) (gained(axis, gain, index, figures)) "."
                    }
                }
            }
            p { (self.where_from()) }
        }
    }

    fn where_from(&self) -> &'static str {
        match self.gains.iter().any(|gain| gain.of == GainSource::ClosedLoop) {
            true => {
                "Times are those of the move in the closed loop: the stage with its controller on the simulated machine. A load is \
                 at rest when it stays within a count of where it ends."
            }
            false => {
                "Times are those of the move on the simulated machine, which follows its command exactly. A load is at rest when it \
                 stays within a count of its target."
            }
        }
    }

    /// The figures of each axis in a table.
    pub(super) fn axes_table(&self, figures: &Figures) -> Markup {
        html! {
            div.wide { table {
                thead { tr {
                    th { "axis" } th { "shaper" } th.number { "duration" } th.number { "residual of the integer taps" }
                    th.number { "ringing unshaped" } th.number { "shaped" } th.number { "at rest unshaped" } th.number { "shaped" }
                } }
                tbody {
                    @for (index, axis, tables) in self.rows() {
                        @let length = |figure: f64| axis.unit.show(figure, 3);
                        @let [unshaped, shaped] = self.ringing_paths(index);
                        tr {
                            td { (axis.name) }
                            td { (tables.design.kind) }
                            td.number { (figures.show(&format!("/design/axes/{index}/duration_s"), |s| show_seconds(s, 3))) }
                            td.number { (worst_residual(figures, index, axis.modes.len())) }
                            td.number { (figures.show(&unshaped, length)) }
                            td.number { (figures.show(&shaped, length)) }
                            td.number { (figures.show(&format!("/axes/{index}/gain/settled_unshaped_s"), |s| show_seconds(s, 3))) }
                            td.number { (figures.show(&format!("/axes/{index}/gain/settled_s"), |s| show_seconds(s, 3))) }
                        }
                    }
                }
            } }
        }
    }

    /// Where `report.json` has the ringing of an axis: in the closed loop if it has one.
    fn ringing_paths(&self, index: usize) -> [String; 2] {
        match self.closed_loop.and_then(|closed| closed.ringing(index)) {
            Some(_) => ["residual_unshaped", "residual"].map(|name| format!("/stage/axes/{index}/{name}")),
            None => {
                ["residual_displacement_unshaped", "residual_displacement"].map(|name| format!("/axes/{index}/{name}"))
            }
        }
    }
}

/// The largest residual of the integer taps at any mode.
fn worst_residual(figures: &Figures, axis: usize, modes: usize) -> Markup {
    let path = |mode: &usize| format!("/design/axes/{axis}/quantised/modes/{mode}/residual");
    let number = |mode: &usize| figures.number(&path(mode)).unwrap_or(0.0);
    let worst = (0..modes).max_by(|a, b| number(a).total_cmp(&number(b)));
    match worst {
        Some(mode) => figures.show(&path(&mode), |residual| format!("{} %", percent(residual))),
        None => html! { "–" },
    }
}

fn cost(gain: &Gain, index: usize, figures: &Figures) -> Markup {
    let path = format!("/axes/{index}/gain/later_s");
    match gain.later_s {
        None => html! { "the command does not move it" },
        Some(later) if later > 0.0 => html! {
            "its command arrives " strong { (figures.show(&path, |later| format!("{} later", time(later)))) }
        },
        Some(_) => html! { "its command arrives no later" },
    }
}

fn gained(axis: &AxisSection, gain: &Gain, index: usize, figures: &Figures) -> Markup {
    let show = |name: &str| figures.show(&format!("/axes/{index}/gain/{name}"), time);
    let band = figures.show(&format!("/axes/{index}/gain/band"), |band| axis.unit.show(band, 3));
    if gain.later_s.is_none() {
        return html! {};
    }
    match (gain.settled_unshaped_s, gain.settled_s, gain.sooner_s) {
        (Some(_), Some(_), Some(sooner)) => {
            let word = match sooner {
                sooner if sooner > 0.0 => "sooner",
                sooner if sooner < 0.0 => "later",
                _ => "sooner or later",
            };
            let sooner = figures.show(&format!("/axes/{index}/gain/sooner_s"), |sooner| {
                format!("{} {word}", time(sooner))
            });
            html! {
                ", and its load is at rest to ±1 count (" (band) ") " strong { (sooner) } ", "
                (show("settled_s")) " after the start of the move instead of " (show("settled_unshaped_s"))
                @if word == "later" { "; without the shaper it rings by less than a count" }
            }
        }
        (None, Some(settled), _) => html! {
            ", and its load is at rest to ±1 count (" (band) ") " strong { "at least " (time(gain.end_unshaped_s - settled)) " sooner" } ", "
            (show("settled_s")) " after the start of the move; without the shaper it still rings after " (show("end_unshaped_s"))
            ", where the simulation ends"
        },
        (Some(_), None, _) => html! {
            ", and its load is not at rest to ±1 count (" (band) ") after " (show("end_s"))
            ", where the simulation ends; without the shaper it is, after " (show("settled_unshaped_s"))
        },
        (None, None, _) => html! {
            ", and its load is at rest to ±1 count (" (band) ") neither with the shaper nor without it after " (show("end_s"))
            ", where the simulation ends"
        },
        _ => html! {},
    }
}
