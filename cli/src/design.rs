//! `posicast design`: impulses, residuals, insensitivity and the tap table of every axis.

use crate::terminal::Terminal;
use crate::{output, render};
use posicast_flow::Failure;
use posicast_flow::compare::{band, compare};
use posicast_flow::design::{Options, design};
use posicast_flow::moves::PerAxis;
use std::path::PathBuf;

/// Print impulses, residuals, insensitivity and tap table of every axis
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  posicast design examples/xy-stage.toml --plot sensitivity.svg\n  \
                         posicast design examples/xy-stage.toml --compare --band 15"
)]
pub(crate) struct Args {
    /// Machine file
    machine: PathBuf,
    /// Print one JSON document on standard output
    #[arg(long)]
    json: bool,
    /// Draw the sensitivity curves into this SVG file
    #[arg(long, value_name = "FILE.svg")]
    plot: Option<PathBuf>,
    /// Replace a file that posicast did not write, or that was changed since; never one that this command reads
    #[arg(long, requires = "plot")]
    force: bool,
    /// Certify an upper bound of every axis's residual with integer taps, over the whole bands of its modes
    #[arg(long, conflicts_with = "compare")]
    certify: bool,
    /// Show what an optimal shaper gains from more duration: fewer taps or less residual, and at what delay
    #[arg(long, conflicts_with = "compare")]
    front: bool,
    /// Compare the fastest move of this distance and its shaper with an unshaped move whose jerk time is a mode's period;
    /// the distance is in the axis's unit: 40, or x=40,y=-20
    #[arg(
        long = "move",
        value_name = "DISTANCE",
        allow_negative_numbers = true,
        conflicts_with = "compare"
    )]
    distance: Option<PerAxis>,
    /// Compare every kind of shaper on each axis instead: duration, worst residual, taps
    #[arg(long, conflicts_with = "plot")]
    compare: bool,
    /// With --compare: frequency error that each mode may have, in percent
    #[arg(long, value_name = "PERCENT", default_value = "10", value_parser = band, requires = "compare", allow_negative_numbers = true)]
    band: f64,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    if args.compare {
        return output::show(compare(&args.machine, args.band)?, args.json, render::compare);
    }
    let options = Options {
        machine: args.machine.clone(),
        plot: args.plot.clone(),
        force: args.force,
        certify: args.certify,
        front: args.front,
        distance: args.distance.clone(),
        form: output::form(args.json),
    };
    output::show(design(&options, &Terminal)?, args.json, render::design)
}
