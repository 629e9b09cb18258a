//! A sentence per axis about the cost and the gain of its shaper.

use super::figure_at;
use crate::run::gain::{Gain, GainSource};
use crate::run::report::RunReport;
use crate::simulate::si_per_lsb;
use crate::text::percent;
use maud::{Markup, html};
use posicast_machine::machine_file::AxisSection;
use posicast_machine::plan::ModeFigures;
use posicast_shaper::unit::show_seconds;

/// A time with the digits that a sentence needs.
fn time(seconds: f64) -> String {
    show_seconds(seconds.abs(), 2)
}

impl RunReport<'_> {
    pub(super) fn sentences(&self) -> Markup {
        html! {
            ul.gains {
                @for ((index, axis, tables), gain) in self.rows().zip(&self.gains) {
                    li {
                        strong { "Axis " (axis.name) ", " (tables.design.kind) }
                        ": " (cost(gain, index)) (gained(axis, gain, index)) "."
                    }
                }
            }
            p { (self.where_from()) }
        }
    }

    fn where_from(&self) -> &'static str {
        if self.gains.iter().any(|gain| gain.of == GainSource::ClosedLoop) {
            "Times are those of the move in the closed loop: the stage with its controller on the simulated machine. A load is \
                 at rest when it stays within a count of where it ends."
        } else {
            "Times are those of the move on the simulated machine, which follows its command exactly. A load is at rest when it \
                 stays within a count of its target."
        }
    }

    /// The figures of each axis in a table.
    pub(super) fn axes_table(&self) -> Markup {
        html! {
            div.wide { table {
                thead {
                    tr {
                        th rowspan="2" { "axis" } th rowspan="2" { "shaper" }
                        th.number rowspan="2" { "duration of the shaper" } th.number rowspan="2" { "residual of the integer taps" }
                        th.group colspan="2" scope="colgroup" { "ringing after the move" }
                        th.group colspan="2" scope="colgroup" { "at rest, from the start of the move" }
                    }
                    tr { @for _ in 0..2 { th.number { "unshaped" } th.number { "shaped" } } }
                }
                tbody {
                    @for ((index, axis, tables), gain) in self.rows().zip(&self.gains) {
                        @let length = |figure: f64| axis.unit.show(figure, 3);
                        @let [unshaped, shaped] = self.ringing(index, axis);
                        @let settled = |name: &str, time_s: Option<f64>| {
                            figure_at(&format!("/axes/{index}/gain/{name}"), time_s, |s| show_seconds(s, 3))
                        };
                        tr {
                            td { (axis.name) }
                            td { (tables.design.kind) }
                            td.number { (figure_at(&format!("/design/axes/{index}/duration_s"), tables.design.impulses.duration_s(), |s| show_seconds(s, 3))) }
                            td.number { (worst_residual(index, &tables.mode_figures(axis, self.sample_hz()))) }
                            td.number { (figure_at(&unshaped.0, unshaped.1, length)) }
                            td.number { (figure_at(&shaped.0, shaped.1, length)) }
                            td.number { (settled("settled_unshaped_s", gain.settled_unshaped_s)) }
                            td.number { (settled("settled_s", gain.settled_s)) }
                        }
                    }
                }
            } }
        }
    }

    /// The ringing of an axis without and with its shaper, in the closed loop if it has one, with its place in `report.json`.
    fn ringing(&self, index: usize, axis: &AxisSection) -> [(String, f64); 2] {
        match self.closed_loop.and_then(|closed| closed.ringing(index)) {
            Some([unshaped, shaped]) => [("residual_unshaped", unshaped), ("residual", shaped)]
                .map(|(name, figure)| (format!("/stage/axes/{index}/{name}"), figure)),
            None => {
                let (run, per_lsb) = (&self.axes[index], si_per_lsb(self.machine, axis));
                [
                    ("residual_displacement_unshaped", run.vibration_unshaped),
                    ("residual_displacement", run.vibration),
                ]
                .map(|(name, figure)| (format!("/axes/{index}/{name}"), figure * per_lsb))
            }
        }
    }
}

/// The largest residual of the integer taps at any mode.
fn worst_residual(axis: usize, modes: &[ModeFigures]) -> Markup {
    let residuals = modes.iter().map(|mode| mode.residual_quantised).enumerate();
    let worst = residuals.max_by(|(_, a), (_, b)| a.total_cmp(b));
    let (mode, residual) = worst.unzip();
    let path = format!("/design/axes/{axis}/quantised/modes/{}/residual", mode.unwrap_or(0));
    figure_at(&path, residual, |residual| format!("{} %", percent(residual)))
}

fn cost(gain: &Gain, index: usize) -> Markup {
    let path = format!("/axes/{index}/gain/later_s");
    match gain.later_s {
        None => html! { "the command does not move it" },
        Some(later) if later > 0.0 => html! {
            "its command arrives " strong { (figure_at(&path, later, |later| format!("{} later", time(later)))) }
        },
        Some(_) => html! { "its command arrives no later" },
    }
}

/// Why a load is at rest later with its shaper than without it.
fn why_later(gain: &Gain) -> &'static str {
    match (gain.settled_unshaped_s, gain.arrival_unshaped_s) {
        (Some(settled), Some(arrival)) if settled <= arrival => "without the shaper it rings by less than a count",
        _ => "without the shaper its vibration is over before the shaper's last impulse",
    }
}

fn gained(axis: &AxisSection, gain: &Gain, index: usize) -> Markup {
    let path = |name: &str| format!("/axes/{index}/gain/{name}");
    let settled = figure_at(&path("settled_s"), gain.settled_s, time);
    let settled_unshaped = figure_at(&path("settled_unshaped_s"), gain.settled_unshaped_s, time);
    let end = figure_at(&path("end_s"), gain.end_s, time);
    let band = figure_at(&path("band"), gain.band, |band| axis.unit.show(band, 3));
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
            let sooner = figure_at(&path("sooner_s"), sooner, |sooner| format!("{} {word}", time(sooner)));
            html! {
                ", and its load is at rest to ±1 count (" (band) ") " strong { (sooner) } ", "
                (settled) " after the start of the move instead of " (settled_unshaped)
                @if word == "later" { "; " (why_later(gain)) }
            }
        }
        (None, Some(settled_s), _) => html! {
            ", and its load is at rest to ±1 count (" (band) ") " strong { "at least " (time(gain.end_unshaped_s - settled_s)) " sooner" } ", "
            (settled) " after the start of the move; without the shaper it still rings after " (figure_at(&path("end_unshaped_s"), gain.end_unshaped_s, time))
            ", where the simulation ends"
        },
        (Some(_), None, _) => html! {
            ", and its load is not at rest to ±1 count (" (band) ") after " (end)
            ", where the simulation ends; without the shaper it is, after " (settled_unshaped)
        },
        (None, None, _) => html! {
            ", and its load is at rest to ±1 count (" (band) ") neither with the shaper nor without it after " (end)
            ", where the simulation ends"
        },
        _ => html! {},
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::gain::Gain;
    use posicast_machine::machine_file;

    /// The sentence of a load that is at rest at these times, with a command that arrives at 10 ms and at 14 ms.
    fn sentence(unshaped: Option<f64>, shaped: Option<f64>) -> String {
        let machine = machine_file::parse("m.toml", include_str!("../../../../examples/custom-shaper.toml")).unwrap();
        let sooner = unshaped.zip(shaped).map(|(unshaped, shaped)| unshaped - shaped);
        let gain = Gain {
            of: GainSource::OpenLoop,
            band: 1e-6,
            arrival_unshaped_s: Some(0.010),
            arrival_s: Some(0.014),
            later_s: Some(0.004),
            settled_unshaped_s: unshaped,
            settled_s: shaped,
            sooner_s: sooner,
            end_unshaped_s: 0.5,
            end_s: 0.5,
        };
        let text = (cost(&gain, 0).into_string() + &gained(&machine.axes[0], &gain, 0).into_string())
            .split('<')
            .map(|part| part.split_once('>').map_or(part, |(_, text)| text))
            .collect::<String>();
        assert!(
            text.starts_with("its command arrives 4.0 ms later, and its load is"),
            "{text}"
        );
        text
    }

    #[test]
    fn every_outcome_has_its_sentence() {
        for (unshaped, shaped, said) in [
            (
                Some(0.055),
                Some(0.015),
                "40 ms sooner, 15 ms after the start of the move instead of 55 ms",
            ),
            (
                Some(0.009),
                Some(0.015),
                "6.0 ms later, 15 ms after the start of the move instead of 9.0 ms; without the shaper it rings by less than a count",
            ),
            (
                Some(0.012),
                Some(0.015),
                "its vibration is over before the shaper's last impulse",
            ),
            (None, Some(0.1), "at least 400 ms sooner"),
            (
                Some(0.1),
                None,
                "not at rest to ±1 count (1.00 µm) after 500 ms, where the simulation ends; without the shaper it is, after 100 ms",
            ),
            (
                None,
                None,
                "at rest to ±1 count (1.00 µm) neither with the shaper nor without it after 500 ms",
            ),
        ] {
            let sentence = sentence(unshaped, shaped);
            assert!(sentence.contains(said), "{sentence}");
        }
    }
}
