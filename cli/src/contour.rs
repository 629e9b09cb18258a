//! Options of a path of two axes.

use posicast_flow::contour::{Corners, PathOptions};
use std::path::PathBuf;

/// How bends of the path are passed.
#[derive(clap::Args, Default, Clone, Copy)]
pub(crate) struct CornerArgs {
    /// Junction deviation in the unit of the first axis: how far the path could cut a bend within the acceleration, which
    /// gives the speed there; 0: stop at every bend [default: 0.01 mm, as grbl]
    #[arg(long, value_name = "LENGTH", requires = "contour", allow_negative_numbers = true)]
    corner_tolerance: Option<f64>,
    /// Stop at bends of more than this angle in degrees; 180: the corner tolerance alone decides, as in the firmware of
    /// printers [default: 45]
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
    /// (.gcode, .nc, .ngc, …). Prints how far the load leaves it with each kind of shaper, instead of writing a
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
