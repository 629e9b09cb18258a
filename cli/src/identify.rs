//! `posicast identify`: finds modes in a measured log, and writes a machine file with them.

use crate::new::KindFlags;
use crate::{output, render};
use posicast_flow::Failure;
use posicast_flow::compare::band;
use posicast_flow::identify::{LogExcitation, LogOptions, Options, identify, positive, sweep};
use posicast_identify::sweep::Sweep;
use std::path::PathBuf;

/// Find modes and their uncertainty in a measured log, suggest shapers, and write a machine file
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  posicast identify raw_data_x.csv                    an accelerometer's log of a printer's resonance test
  posicast identify raw_data_x.csv --plot x.svg -o printer.toml
  posicast identify raw_data_y.csv --machine printer.toml --axis y -o both.toml
  posicast identify step.csv --json                   columns time,command,response
  posicast identify stop.csv --columns time_ms,accel_x_g,-,-
                                                      the ringing after a stop, in a file without a usable header

The columns of a log, and what each method needs: docs/identify.md")]
pub(crate) struct Args {
    /// Log in CSV: time,accel_x,accel_y,accel_z in s and mm/s², or time,command,response
    log: PathBuf,
    /// Print one JSON document on standard output
    #[arg(long)]
    json: bool,
    /// Write a machine file with the modes found and the first shaper of the list
    #[arg(short, long, value_name = "MACHINE")]
    output: Option<PathBuf>,
    /// Take this machine file and put the modes into the axis that --axis names, instead of starting from a template
    #[arg(long, value_name = "MACHINE", requires = "output", conflicts_with_all = ["printer", "gantry", "joint", "crane"])]
    machine: Option<PathBuf>,
    /// Name of the axis in the machine file [default: the sensor's direction, or the first axis]
    #[arg(long, value_name = "NAME", requires = "output")]
    axis: Option<String>,
    #[command(flatten)]
    kind: KindFlags,
    /// Draw the fit, the shapers and the ringing into this SVG file
    #[arg(long, value_name = "FILE.svg")]
    plot: Option<PathBuf>,
    #[command(flatten)]
    excitation: ExcitationFlags,
    #[command(flatten)]
    log_flags: LogFlags,
    /// Judge the shapers after a jump of the acceleration by this much, in m/s² or rad/s²
    #[arg(long, value_name = "M/S2", default_value = "5", value_parser = positive)]
    acceleration: f64,
    /// Change of the frequencies in percent that a shaper must tolerate in addition to the modes' uncertainty
    #[arg(long, value_name = "PERCENT", default_value = "5", value_parser = band, allow_negative_numbers = true)]
    margin: f64,
    /// Replace a file that posicast did not write, or that was changed since; never one that this command reads
    #[arg(long)]
    force: bool,
}

/// What describes the excitation of an accelerometer's log.
#[derive(clap::Args)]
struct ExcitationFlags {
    /// Sweep of the resonance test: first and last frequency in Hz, Hz per second, mm/s² per Hz; and, if it cannot be estimated from the
    /// log, the square wave beside it, in mm/s² and s (a period of 0: none) [default: a sweep estimated from the log]
    #[arg(long, value_name = "START:END:RATE:ACCEL[:SWEEPING_ACCEL:SWEEPING_PERIOD]", value_parser = sweep)]
    sweep: Option<Sweep>,
    /// The excitation is unknown: look for modes in the spectrum alone, as if the excitation were even
    #[arg(long, conflicts_with = "sweep")]
    output_only: bool,
    /// The accelerometer's log shows a stop: look for modes in the ringing after it
    #[arg(long, conflicts_with_all = ["sweep", "output_only"])]
    ring_down: bool,
}

/// What the log's file leaves open.
#[derive(clap::Args)]
struct LogFlags {
    /// Names of the columns in order, replacing those of the header, such as time_ms,accel_x_g,-; `-` for an unused column
    #[arg(long, value_name = "NAME,NAME,…", value_delimiter = ',', allow_hyphen_values = true)]
    columns: Option<Vec<String>>,
    /// Samples per second, for a log without times or with jittering times
    #[arg(long, value_name = "HZ", value_parser = positive)]
    rate: Option<f64>,
    /// Direction of the accelerometer to use: x, y, z or the name of its column [default: the strongest]
    #[arg(long, value_name = "NAME")]
    direction: Option<String>,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let options = Options {
        log: args.log.clone(),
        output: args.output.clone(),
        machine: args.machine.clone(),
        axis: args.axis.clone(),
        kind: args.kind.kind(),
        plot: args.plot.clone(),
        excitation: LogExcitation {
            sweep: args.excitation.sweep,
            output_only: args.excitation.output_only,
            ring_down: args.excitation.ring_down,
        },
        log_options: LogOptions {
            columns: args.log_flags.columns.clone(),
            rate_hz: args.log_flags.rate,
            direction: args.log_flags.direction.clone(),
        },
        acceleration: args.acceleration,
        margin_percent: args.margin,
        force: args.force,
        form: output::form(args.json),
    };
    output::show(identify(&options)?, args.json, render::identify)
}
