//! Options of a run.

use crate::bench::Simulator;
use crate::contour::{Corners, PathOptions};
use crate::input;
use crate::moves::Motion;
use crate::text::shell_word;
use crate::verify::DEFAULT_SEED;
use std::path::{Path, PathBuf};

/// Options of a run and its output.
#[derive(Debug, Clone)]
pub struct Options {
    /// Machine file.
    pub machine: PathBuf,
    /// Output folder: new, empty, or written by posicast before; `None`: the machine's name.
    pub output: Option<PathBuf>,
    /// How the axes move.
    pub motion: Motion,
    /// Radius of the circle of the closed loop, in the unit of the first axis; `None`: chosen by the limits of the axes.
    pub radius: Option<f64>,
    /// Path of the closed loop in place of the circle: `circle`, `square`, a CSV file of points, or a G-code file.
    pub contour: Option<String>,
    /// How the axes pass bends of that path.
    pub corners: Corners,
    /// Simulator; `None`: Verilator, or if it is missing RustHDL's, which is the weaker check.
    pub simulator: Option<Simulator>,
    /// Clocks of the lock step; `None`: as many as the simulator does in some seconds.
    pub cycles: Option<u64>,
    /// Seed of the random stimuli.
    pub seed: u64,
}

impl Options {
    /// The path of the closed loop, in place of the circle.
    pub(super) fn path(&self) -> Option<PathOptions> {
        let contour = Some(self.contour.clone()?);
        Some(PathOptions {
            contour,
            radius: self.radius,
            corners: self.corners,
            ..PathOptions::default()
        })
    }

    /// The files that options name, beside the machine file.
    pub(super) fn files(&self) -> impl Iterator<Item = &Path> {
        let contour = self.contour.as_deref().map(Path::new);
        self.motion.command.as_deref().into_iter().chain(contour)
    }

    /// The command line that repeats the run in the output folder, which has the machine file and the files that options name.
    pub(super) fn command_line(&self) -> String {
        let mut words = vec!["posicast run machine.toml".to_owned()];
        words.extend(self.motion.command_line());
        let mut option =
            |name: &str, value: Option<String>| words.extend(value.map(|value| format!("--{name} {value}")));
        option("radius", self.radius.map(|radius| radius.to_string()));
        let contour = self.contour.as_deref().map(Path::new);
        option("contour", contour.map(|path| shell_word(&input::in_folder(path))));
        for (name, value) in self.corners.given() {
            option(name, Some(value.to_string()));
        }
        option("simulator", self.simulator.map(|simulator| simulator.to_string()));
        option("cycles", self.cycles.map(|cycles| cycles.to_string()));
        option("seed", (self.seed != DEFAULT_SEED).then(|| self.seed.to_string()));
        words.join(" ")
    }
}
