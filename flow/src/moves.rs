//! The motion of the axes in a simulation: a command file, or a move of each axis.

use crate::failure::Failure;
use crate::input;
use crate::text::shell_word;
use posicast_machine::machine_file::{AxisSection, Machine};
use posicast_machine::motion::{AxisMove, AxisMoveError};
use std::path::PathBuf;
use std::str::FromStr;

/// How the axes move: the options `--command`, `--move` and `--speed`.
#[derive(Debug, Clone, Default)]
pub struct Motion {
    /// The command: a CSV file with columns `time_s` and `position`, in the axis's unit; `None`: a move of each axis.
    pub command: Option<PathBuf>,
    /// Distance of the move, in the axis's unit; `None`: a distance at which the axis reaches the velocity limit, at least 5 mm or 5 mrad,
    /// at most half of the travel.
    pub distance: Option<PerAxis>,
    /// Speed of the move, in the axis's unit per second; `None`: the velocity limit.
    pub speed: Option<PerAxis>,
}

impl Motion {
    /// The speed along a contour, in the unit of the first axis per second.
    pub(crate) fn along_contour(&self) -> Result<Option<f64>, Failure> {
        let refused =
            |option: &str, found: &str| Failure::input(format!("{option}: {found}")).with_help("leave it out");
        match (&self.distance, &self.speed) {
            (Some(_), _) => Err(refused("--move", "the contour defines where the axes go")),
            (None, Some(PerAxis::Named(_))) => Err(refused(
                "--speed",
                "a contour has one speed, along its path: give a number",
            )),
            (None, Some(PerAxis::All(speed))) => Ok(Some(*speed)),
            (None, None) => Ok(None),
        }
    }

    /// These options as words of a command line in the output folder, which has a copy of the command file.
    pub(crate) fn command_line(&self) -> Vec<String> {
        let command = self.command.as_deref();
        let command = command.map(|path| format!("--command {}", shell_word(&input::in_folder(path))));
        let figures = [("--move", &self.distance), ("--speed", &self.speed)];
        let figures = figures
            .into_iter()
            .filter_map(|(option, figures)| Some(format!("{option} {}", figures.as_ref()?.text())));
        command.into_iter().chain(figures).collect()
    }

    /// The move of each axis. If there is a command file, only the closed loop has moves.
    pub(crate) fn moves(&self, machine: &Machine, closed_loop: bool) -> Result<Vec<AxisMove>, Failure> {
        for (option, figures) in [("--move", &self.distance), ("--speed", &self.speed)] {
            let Some(figures) = figures else {
                continue;
            };
            if self.command.is_some() && !closed_loop {
                return Err(
                    Failure::input(format!("{option}: the command file defines how the axes move"))
                        .with_help(format!("leave out {option}, or --command")),
                );
            }
            figures.only_for(machine, option)?;
        }
        let of = |figures: &Option<PerAxis>, axis: &AxisSection| figures.as_ref().and_then(|figures| figures.of(axis));
        let axes = machine.axes.iter();
        axes.map(|axis| {
            let (distance, speed) = (of(&self.distance, axis), of(&self.speed, axis));
            AxisMove::new(axis, &machine.fixed_point, distance, speed).map_err(|error| {
                let option = match error {
                    AxisMoveError::Still { .. } | AxisMoveError::TooFast { .. } => "--speed",
                    _ => "--move",
                };
                Failure::input(format!("{option}, axis `{}`: {error}", axis.name))
            })
        })
        .collect()
    }
}

/// The default move of each axis.
pub(crate) fn by_default(machine: &Machine) -> Vec<AxisMove> {
    let axes = machine.axes.iter();
    axes.map(|axis| AxisMove::of_axis(axis, &machine.fixed_point)).collect()
}

/// A figure for every axis, or one for each axis that is named.
#[derive(Debug, Clone, PartialEq)]
pub enum PerAxis {
    /// The same figure for all axes.
    All(f64),
    /// Figures by the names of the axes.
    Named(Vec<(String, f64)>),
}

impl PerAxis {
    /// The figure for an axis, if there is one.
    #[must_use]
    pub fn of(&self, axis: &AxisSection) -> Option<f64> {
        match self {
            Self::All(figure) => Some(*figure),
            Self::Named(figures) => figures
                .iter()
                .find(|(name, _)| *name == axis.name)
                .map(|(_, figure)| *figure),
        }
    }

    /// As on the command line.
    fn text(&self) -> String {
        match self {
            Self::All(figure) => figure.to_string(),
            Self::Named(figures) => {
                let figures = figures.iter().map(|(name, figure)| format!("{name}={figure}"));
                figures.collect::<Vec<_>>().join(",")
            }
        }
    }

    /// Refuses names of axes that the machine does not have; `option` is the option with these names.
    ///
    /// # Errors
    /// [`Failure`] with the unknown name, and the names of the machine's axes.
    pub fn only_for(&self, machine: &Machine, option: &str) -> Result<(), Failure> {
        let Self::Named(figures) = self else {
            return Ok(());
        };
        let names: Vec<&str> = machine.axes.iter().map(|axis| axis.name.as_str()).collect();
        match figures.iter().find(|(name, _)| !names.contains(&name.as_str())) {
            None => Ok(()),
            Some((name, _)) => Err(Failure::input(format!("{option}: no axis `{name}`"))
                .with_help(format!("the axes are {}", names.join(", ")))),
        }
    }
}

impl FromStr for PerAxis {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |text: &str| {
            let figure = text.trim().parse::<f64>();
            figure.map_err(|_| format!("`{text}` is not a number; write 40 for every axis, or x=40,y=20"))
        };
        if !text.contains('=') {
            return number(text).map(Self::All);
        }
        let mut figures: Vec<(String, f64)> = Vec::new();
        for part in text.split(',') {
            let (name, figure) = part
                .split_once('=')
                .ok_or_else(|| format!("`{part}` names no axis; write x=40,y=20"))?;
            let name = name.trim().to_owned();
            if figures.iter().any(|(other, _)| *other == name) {
                return Err(format!("axis `{name}` is named twice"));
            }
            figures.push((name, number(figure)?));
        }
        Ok(Self::Named(figures))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_is_for_all_axes_or_for_named_ones() {
        assert_eq!("-4e-3".parse(), Ok(PerAxis::All(-0.004)));
        let named = PerAxis::Named(vec![("x".to_owned(), 40.0), ("y".to_owned(), -20.0)]);
        assert_eq!("x=40, y=-20".parse(), Ok(named));
        for (text, said) in [
            ("", "is not a number"),
            ("5mm", "`5mm` is not a number"),
            ("x=1,2", "`2` names no axis"),
            ("x=1,x=2", "axis `x` is named twice"),
            ("x=", "is not a number"),
        ] {
            let refused = text.parse::<PerAxis>().unwrap_err();
            assert!(refused.contains(said), "{text}: {refused}");
        }
    }
}
