//! The parts of the page that show pictures, in their order.

use super::drawings;
use super::tables::kinds_table;
use super::{Extra, Part, drawn, figure};
use crate::failure::Failure;
use crate::plot::{Panel, inline_map};
use crate::run::excerpt;
use crate::run::report::RunReport;
use maud::{Markup, html};
use posicast_machine::compare::DEFAULT_BAND;

impl RunReport<'_> {
    pub(super) fn parts(&self, extra: &Extra) -> Result<Vec<Part>, Failure> {
        let mut parts = vec![self.commands_part()?];
        if !extra.sensitivity.is_empty() {
            parts.push(Part {
                title: "Sensitivity",
                about: "How much of a mode's vibration is left if its frequency is not the one in the machine file: of the impulses \
                        before rounding, of the integer taps, and the tolerance."
                    .to_owned(),
                command: "posicast design machine.toml --plot sensitivity.svg".to_owned(),
                pictures: drawn(&extra.sensitivity)?,
                more: html! {},
            });
            parts.push(self.maps_part()?);
        }
        if !extra.response.is_empty() {
            parts.push(Part {
                title: "Response",
                about: "The simulated machine, which follows its command exactly: a step, and the end of the move, without the \
                        shaper, with the model's and with the simulated hardware's samples."
                    .to_owned(),
                command: self.command.clone(),
                pictures: drawn(&extra.response)?,
                more: html! {},
            });
        }
        parts.extend(self.closed_loop_parts(extra)?);
        parts.extend(self.waves_part());
        parts.push(Part {
            title: "Kinds of shaper",
            about: format!(
                "What other kinds would do for the same modes: their duration, and the largest residual if a mode's frequency is off by \
                 up to ±{} %. A star marks a kind if no other kind is better in one of duration, residual and taps, and at least as good \
                 in the others.",
                100.0 * DEFAULT_BAND
            ),
            command: "posicast design machine.toml --compare".to_owned(),
            pictures: drawn(&self.kinds_panels())?,
            more: html! {
                @for (index, kinds) in self.kinds.iter().enumerate() { (kinds_table(index, kinds)) }
            },
        });
        parts.push(Part {
            title: "Lock step",
            about: "Blocks that ran beside their bit-exact model, every output compared in every clock.".to_owned(),
            command: format!(
                "posicast verify machine.toml --simulator {} --cycles {} --seed {}",
                self.simulator, self.lockstep.cycles, self.seed
            ),
            pictures: Vec::new(),
            more: self.blocks_table(),
        });
        parts.push(Part {
            title: "Area",
            about: "Resources of the shapers, estimated before place and route.".to_owned(),
            command: "posicast synth machine.toml".to_owned(),
            pictures: Vec::new(),
            more: self.area_table(),
        });
        Ok(parts)
    }

    fn commands_part(&self) -> Result<Part, Failure> {
        let panels: Vec<Panel> = self
            .rows()
            .flat_map(|(index, axis, tables)| {
                [
                    drawings::impulses(axis, tables, self.sample_hz()),
                    self.command_panel(index, axis),
                ]
            })
            .collect();
        Ok(Part {
            title: "Impulses and command",
            about: "The shaper convolves the command with its impulses: what goes in, and what comes out.".to_owned(),
            command: format!("posicast design machine.toml; {}", simulated(&self.command)),
            pictures: drawn(&panels)?,
            more: html! {},
        })
    }

    fn maps_part(&self) -> Result<Part, Failure> {
        let maps = self.rows().flat_map(|(_, axis, tables)| self.maps(axis, tables));
        let pictures = maps
            .map(|map| Ok(figure(&inline_map(&map)?)))
            .collect::<Result<Vec<Markup>, Failure>>()?;
        Ok(Part {
            title: "Residual over frequency and damping",
            about: "The machine may have any frequency and damping in the blue area: there the residual is within the tolerance. The dot \
                    is the mode of the machine file."
                .to_owned(),
            command: self.command.clone(),
            pictures,
            more: html! {},
        })
    }

    fn closed_loop_parts(&self, extra: &Extra) -> Result<Vec<Part>, Failure> {
        let parts = extra.closed_loop.iter().map(|(name, panels)| {
            let (title, about) = match *name {
                "plots/stage-move.svg" => (
                    "Closed loop: the move",
                    "The stage with its controller on the simulated machine: command, shaped command and load, and the error that the \
                     controller sees.",
                ),
                "plots/stage-vibration.svg" => (
                    "Closed loop: after the move",
                    "What is left of the vibration, also on machines that are 10 % slower and faster than the machine file says.",
                ),
                "plots/stage-steps.svg" => (
                    "Steps",
                    "What the drive gets: the rate of the steps over the move, and both lines in the tick that has most steps.",
                ),
                "plots/stage-circle.svg" => (
                    "Circle",
                    "How far the load is outside of a circle of two axes: with each shaper's own delay, and with delays made equal.",
                ),
                "plots/inline-vibration.svg" => (
                    "Through the inline shaper: after the move",
                    "What is left of the vibration once the steps have ended: with the steps of the controller, and with those of the \
                     inline shaper.",
                ),
                "plots/stage-contour.svg" => ("Contour", "How far the load is from the path of the contour."),
                _ => ("Closed loop: error tables", "Where the load comes to rest, with the error table and without it."),
            };
            Ok(Part {
                title,
                about: about.to_owned(),
                command: self.command.clone(),
                pictures: drawn(panels)?,
                more: html! {},
            })
        });
        parts.collect()
    }

    fn kinds_panels(&self) -> Vec<Panel> {
        let axes = self.kinds.iter().filter(|kinds| kinds.candidates.len() > 1);
        axes.map(|kinds| drawings::kinds(kinds, 100.0 * DEFAULT_BAND)).collect()
    }

    fn waves_part(&self) -> Option<Part> {
        let excerpt = self.waves.excerpt.as_ref()?;
        Some(Part {
            title: "One sample in the hardware",
            about: format!(
                "What the {} does between a strobe and the next result, clock by clock; signals that do not change in this time are \
                 left out. It is sample {} of the move, the one with the largest step. Words are in LSB.",
                self.waves.device, excerpt.sample
            ),
            command: "gtkwave wave/merged.gtkw".to_owned(),
            pictures: vec![excerpt::figure(excerpt)],
            more: html! {},
        })
    }
}

/// Converts the command of a run to one of `simulate`, which has no simulator.
fn simulated(run: &str) -> String {
    let mut words = Vec::new();
    let mut given = run.split(' ');
    while let Some(word) = given.next() {
        match word {
            "run" => words.push("simulate"),
            "--simulator" | "--cycles" | "--seed" => drop(given.next()),
            _ => words.push(word),
        }
    }
    words.join(" ")
}

#[cfg(test)]
mod tests {
    use super::simulated;

    #[test]
    fn a_simulation_has_the_moves_of_the_run() {
        let run = "posicast run machine.toml --move x=0.1 --simulator icarus --cycles 5 --seed 2 --command 'a b.csv'";
        assert_eq!(
            simulated(run),
            "posicast simulate machine.toml --move x=0.1 --command 'a b.csv'"
        );
    }
}
