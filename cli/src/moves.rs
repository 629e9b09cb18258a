//! Options of the motion of the axes in a simulation.

use posicast_flow::moves::{Motion, PerAxis};
use std::path::PathBuf;

/// The options `--command`, `--move` and `--speed`.
#[derive(clap::Args)]
pub(crate) struct MotionArgs {
    /// Command: a CSV file with columns time_s,position, in the axis's unit [default: a move of each axis]
    #[arg(long, value_name = "FILE.csv")]
    command: Option<PathBuf>,
    /// Distance of the move, in the axis's unit: 40, or x=40,y=-20 [default: far enough to reach the velocity limit, at least 5 mm or 5 mrad, at most half of the travel]
    #[arg(long = "move", value_name = "DISTANCE", allow_negative_numbers = true)]
    distance: Option<PerAxis>,
    /// Speed of the move, in the axis's unit per second: 100, or x=100,y=50 [default: the velocity limit]
    #[arg(long, value_name = "SPEED", allow_negative_numbers = true)]
    speed: Option<PerAxis>,
}

impl MotionArgs {
    pub(crate) fn motion(&self) -> Motion {
        Motion {
            command: self.command.clone(),
            distance: self.distance.clone(),
            speed: self.speed.clone(),
        }
    }
}
