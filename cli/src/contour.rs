//! Options of a path of two axes.

use posicast_flow::contour::{Corners, PathOptions};
use std::path::PathBuf;

/// How bends of the path are passed.
#[derive(clap::Args, Default, Clone, Copy)]
pub(crate) struct CornerArgs {
    /// Bends of the path: how far it could cut a corner to pass it within the acceleration, in the unit of the first
    /// axis, which gives its speed (junction deviation); 0: stop at every bend [default: 0.01 mm, as grbl]
    #[arg(long, value_name = "LENGTH", requires = "contour", allow_negative_numbers = true)]
    corner_tolerance: Option<f64>,
    /// Angle in degrees above which a bend of the path is a stop; 180: the tolerance alone decides, as in the firmware
    /// of printers [default: 45]
    #[arg(long, value_name = "DEGREES", requires = "contour", allow_negative_numbers = true)]
    stop_angle: Option<f64>,
}

impl CornerArgs {
    pub(crate) fn corners(self) -> Corners {
        Corners {
            tolerance: self.corner_tolerance,
            stop_angle_deg: self.stop_angle,
        }
    }
}

/// The options `--contour`, and its sizes.
#[derive(clap::Args)]
pub(crate) struct ContourArgs {
    /// Path of the first two axes: circle, square, a CSV file of points x,y in the axes' units, or a G-code file
    /// (.gcode, .nc, .ngc, …). Shows how far each kind of shaper makes the axes leave it, instead of writing a
    /// waveform
    #[arg(long, value_name = "SHAPE|FILE", conflicts_with = "command")]
    contour: Option<String>,
    /// Radius of the circle, in the unit of the first axis [default: an eighth of the smaller travel, else 10 mm]
    #[arg(long, requires = "contour", allow_negative_numbers = true)]
    radius: Option<f64>,
    /// Side of the square, in the unit of the first axis [default: a quarter of the smaller travel, else 20 mm]
    #[arg(long, requires = "contour", allow_negative_numbers = true)]
    side: Option<f64>,
    /// With --contour: draw the errors over time into this SVG file
    #[arg(long, value_name = "FILE.svg", requires = "contour")]
    plot: Option<PathBuf>,
    #[command(flatten)]
    corners: CornerArgs,
}

impl ContourArgs {
    pub(crate) fn path(&self) -> PathOptions {
        PathOptions {
            contour: self.contour.clone(),
            radius: self.radius,
            side: self.side,
            plot: self.plot.clone(),
            corners: self.corners.corners(),
        }
    }
}
