//! `posicast host`: operates a stage, or looks at an inline shaper, through its serial line, its SPI lines, or a server in the network.

mod actions;
mod inline;
mod text;
mod way;

use self::way::Way;
use posicast_blocks::uart_bridge::BAUD;
use posicast_flow::Failure;
use posicast_flow::design::DesignReport;
use posicast_flow::machine;
use posicast_flow::moves::PerAxis;
use posicast_host::{HostError, HostedInline, HostedStage, Line as AnyLine, LinkError, LinkOptions};
use posicast_machine::hardware::StageHardware;
use posicast_machine::machine_file::Machine;
use posicast_taps::TapTable;
use std::path::{Path, PathBuf};
use std::time::Duration;

pub(crate) use self::inline::Document as InlineStatusDocument;
pub(crate) use self::text::Document as StatusDocument;

/// Operate a stage through its serial line, SPI or a network: show its state, move, home, record, load a shaper; of an inline shaper
/// show the state, switch the shaping, record, load a shaper
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  posicast host /dev/ttyUSB0 status --machine xy_stage/machine.toml
  posicast host /dev/ttyUSB0 move x=0.04,y=-0.02 --machine xy_stage/machine.toml
  posicast host /dev/ttyUSB0 home z --machine printer/machine.toml
  posicast host /dev/ttyUSB0 probe z -5 --speed 2 --machine mill/machine.toml
  posicast host /dev/ttyUSB0 compare scan on --machine line_scan/machine.toml
  posicast host /dev/ttyUSB0 trace x -o x.csv --shake 60 --machine xy_stage/machine.toml
  posicast host /dev/ttyUSB0 load x new.toml --machine xy_stage/machine.toml
  posicast host /dev/ttyUSB0 bypass on --machine router/machine.toml
  posicast host spi:///dev/spidev0.0 status --machine xy_stage/machine.toml
  posicast host udp://192.0.2.10:4210 status --machine xy_stage/machine.toml

Give the machine file from which the FPGA was built; for a serial line or SPI it has a table [link]. At a UDP address,
posicast_serve must run, from linux/ of the C driver.

An inline shaper has status, bypass, trace, load and table: its controller moves the axes.

Exit status: 1 the stage did not carry out the request, 2 bad input or another machine, 3 no port or no reply.")]
pub(crate) struct Args {
    /// Serial port, such as /dev/ttyUSB0 or COM3; an SPI device, such as spi:///dev/spidev0.0 or spi:///dev/spidev0.0?hz=1000000; or
    /// udp://HOST:PORT
    port: String,
    #[command(subcommand)]
    action: Action,
}

#[derive(clap::Subcommand)]
enum Action {
    /// Show states, causes and positions of all axes; of an inline shaper the counts of one clock. Changes nothing
    Status {
        #[command(flatten)]
        line: Line,
        /// Print one JSON document on standard output
        #[arg(long)]
        json: bool,
    },
    /// Switch on, move, and switch off
    Move {
        /// Distance from where the axis stands, in its unit: 40 for every axis, or x=40,y=-20
        #[arg(value_name = "DISTANCE", allow_negative_numbers = true)]
        distance: PerAxis,
        /// Largest speed, in the axis's unit per second: 100, or x=100,y=50 [default: the velocity limit]
        #[arg(long, value_name = "SPEED")]
        speed: Option<PerAxis>,
        #[command(flatten)]
        faults: Faults,
        /// Leave the axes on at the end. An axis with watchdog_s then stops by itself, because nobody kicks its watchdog
        #[arg(long)]
        hold: bool,
        #[command(flatten)]
        line: Line,
    },
    /// Switch on, home by the probe, and switch off; needs [axis.probe]
    Home {
        /// Name of the axis
        axis: String,
        #[command(flatten)]
        faults: Faults,
        /// Leave the axis on at the end. With watchdog_s it then stops by itself, because nobody kicks its watchdog
        #[arg(long)]
        hold: bool,
        #[command(flatten)]
        line: Line,
    },
    /// Switch on, move until the capture line has an edge, show where the axes were at it, and switch off; needs [capture]
    Probe {
        /// Name of the axis
        axis: String,
        /// Largest distance of the edge from where the axis stands, in its unit
        #[arg(allow_negative_numbers = true)]
        distance: f64,
        /// Speed, in the axis's unit per second: the overrun grows with its square
        #[arg(long, value_name = "SPEED")]
        speed: f64,
        #[command(flatten)]
        faults: Faults,
        /// Leave the axis on at the end. With watchdog_s it then stops by itself, because nobody kicks its watchdog
        #[arg(long)]
        hold: bool,
        #[command(flatten)]
        line: Line,
    },
    /// Arm the position compare of an axis, disarm it, or show its pulses; needs [axis.compare]
    Compare {
        /// Name of the axis
        axis: String,
        /// What to do
        #[arg(value_enum)]
        switch: CompareSwitch,
        /// Positions in place of the machine file's row, in the axis's unit: increasing, by 4 counts or more, 256 at most
        #[arg(long, value_name = "POSITIONS", value_delimiter = ',', allow_negative_numbers = true)]
        at: Vec<f64>,
        #[command(flatten)]
        line: Line,
    },
    /// Record signals of an axis, tick by tick; needs [axis.trace]
    Trace(TraceArgs),
    /// Load an axis's shaper from another machine file; it is used until the next reset
    Load {
        /// Name of the axis
        axis: String,
        /// Machine file with the new modes or shaper of this axis
        from: PathBuf,
        #[command(flatten)]
        line: Line,
    },
    /// Show the taps of an axis's shaper as the hardware has them
    Table {
        /// Name of the axis
        axis: String,
        /// Bank: 0 is the machine's, 1 and 2 are loaded ones [default: the one in use]
        #[arg(long, value_name = "BANK", value_parser = clap::value_parser!(u32).range(0..=2))]
        bank: Option<u32>,
        #[command(flatten)]
        line: Line,
    },
    /// End or begin the shaping of an inline shaper, to home and to probe; waits until all axes are settled
    Bypass {
        /// on: no shaping; off: shaping, unless the pin asks for none
        switch: Switch,
        #[command(flatten)]
        line: Line,
    },
}

/// What a position compare is to do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum CompareSwitch {
    /// Arm it, with no pulse counted
    On,
    /// Disarm it
    Off,
    /// Show it
    Show,
}

/// Whether there is to be no shaping.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Switch {
    On,
    Off,
}

#[derive(clap::Args)]
struct TraceArgs {
    /// Name of the axis
    axis: String,
    /// File for the trace: CSV, which posicast identify reads, or VCD
    #[arg(short, long, value_name = "FILE.csv|FILE.vcd")]
    output: PathBuf,
    /// Signals: one, two or four, separated by commas [default: command_position, shaped_position, captured_position and error; with
    /// --shake those that posicast identify needs; of an inline shaper input_position and output_position]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    signals: Vec<String>,
    /// Record a row every TICKS ticks [default: 1; with --shake and a scale 2]
    #[arg(long, value_name = "TICKS")]
    every: Option<u32>,
    /// Switch the axis on and shake it while recording, with a pseudo-random sequence of this amplitude in counts: at most limits.excitation
    /// of the machine file
    #[arg(long, value_name = "COUNTS")]
    shake: Option<f64>,
    /// Duration of a bit of the pseudo-random sequence in seconds
    #[arg(long, value_name = "SECONDS", default_value_t = 1.5e-3, requires = "shake")]
    bit: f64,
    #[command(flatten)]
    faults: Faults,
    /// Replace a file that posicast did not write, or that was changed since
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    line: Line,
}

#[derive(clap::Args)]
struct Faults {
    /// Clear the faults of the axes before they are switched on, once you have removed their causes
    #[arg(long)]
    clear_faults: bool,
}

/// The line to the stage.
#[derive(clap::Args)]
struct Line {
    /// Machine file from which the FPGA was built
    #[arg(long, value_name = "FILE")]
    machine: PathBuf,
    /// Baud rate of a serial line [default: that of the machine file]
    #[arg(long, value_parser = clap::value_parser!(u32).range(i64::from(*BAUD.start())..=i64::from(*BAUD.end())))]
    baud: Option<u32>,
    /// Time in milliseconds to wait for a reply, 1 to 10000; every request is sent up to five times
    #[arg(long, value_name = "MS", default_value_t = 100, value_parser = clap::value_parser!(u64).range(1..=10_000))]
    timeout: u64,
}

impl Action {
    fn line(&self) -> &Line {
        match self {
            Self::Status { line, .. }
            | Self::Move { line, .. }
            | Self::Home { line, .. }
            | Self::Compare { line, .. }
            | Self::Probe { line, .. }
            | Self::Load { line, .. }
            | Self::Table { line, .. }
            | Self::Bypass { line, .. } => line,
            Self::Trace(trace) => &trace.line,
        }
    }
}

/// A stage behind a port.
type Port<'m> = HostedStage<'m, Box<dyn AnyLine>>;

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let line = args.action.line();
    let path = line.machine.as_path();
    let machine = machine::read(path)?.machine;
    let report = DesignReport::new(&machine, path)?;
    let stage = report
        .hardware
        .stage()
        .map_err(|error| machine::of_hardware(&error, path))?;
    let way = Way::of((&args.port, line.baud), &machine, path)?;
    let inline = report
        .hardware
        .inline()
        .map_err(|error| machine::of_hardware(&error, path))?;
    if let Action::Trace(trace) = &args.action {
        // Report errors of the file before the machine moves.
        actions::check_output(trace)?;
    }
    if let Some(component) = inline.and_then(|inline| inline.component.as_ref()) {
        return inline::run(&args.action, &machine, || {
            let link = way.open(options(line.timeout)).map_err(|error| failure(error.into()))?;
            HostedInline::open(link, &machine, component).map_err(|error| not_opened(&way, error))
        });
    }
    let stage = stage.ok_or_else(|| {
        Failure::input(format!("{}: the machine has no stage", path.display()))
            .with_help("give every axis encoder, PWM, drive and controller")
    })?;
    let open = || open(&way, line.timeout, &machine, stage);
    match &args.action {
        Action::Status { json, .. } => text::status(&mut open()?, *json),
        Action::Move {
            distance,
            speed,
            faults,
            hold,
            ..
        } => actions::move_axes(&machine, (distance, speed.as_ref()), [faults.clear_faults, *hold], open),
        Action::Home { axis, faults, hold, .. } => {
            actions::home(&machine, (axis, path), [faults.clear_faults, *hold], open)
        }
        Action::Probe {
            axis,
            distance,
            speed,
            faults,
            hold,
            ..
        } => actions::probe(
            &machine,
            (axis, path),
            (*distance, *speed),
            [faults.clear_faults, *hold],
            open,
        ),
        Action::Compare { axis, switch, at, .. } => actions::compare(&machine, (axis, path), (*switch, at), open),
        Action::Trace(trace) => actions::trace(&machine, trace, open),
        Action::Load { axis, from, .. } => {
            let load = |index, table: &TapTable| Ok(open()?.load_table(index, table));
            actions::load(&machine, axis, from, load)
        }
        Action::Table { axis, bank, .. } => {
            let index = axis_of(&machine, axis, path)?;
            let mut stage = open()?;
            let active = stage.status().map_err(failure)?[index].table_bank;
            let bank = bank.unwrap_or(active);
            let taps = stage.read_table(index, bank).map_err(failure)?;
            text::table(axis, (bank, active), &taps)
        }
        Action::Bypass { .. } => Err(Failure::input(format!(
            "{}: a stage has no `bypass`, which belongs to an inline shaper",
            path.display()
        ))
        .with_help(
            "load the shaper `none` with `posicast host PORT load`, or give the machine file of an inline shaper",
        )),
    }
}

fn options(timeout_ms: u64) -> LinkOptions {
    LinkOptions {
        timeout: Duration::from_millis(timeout_ms),
        ..LinkOptions::default()
    }
}

fn not_opened(way: &Way<'_>, error: HostError) -> Failure {
    match error {
        HostError::Link(LinkError::NoReply { .. } | LinkError::Line(_)) => {
            Failure::missing_tool(format!("{way}: {error}")).with_help(way.remedy())
        }
        error => failure(error),
    }
}

fn open<'m>(
    way: &Way<'_>,
    timeout_ms: u64,
    machine: &'m Machine,
    stage: &'m StageHardware,
) -> Result<Port<'m>, Failure> {
    let link = way.open(options(timeout_ms)).map_err(|error| failure(error.into()))?;
    HostedStage::open(link, machine, stage).map_err(|error| not_opened(way, error))
}

/// Converts an error of a call into a failure.
fn failure(error: HostError) -> Failure {
    match &error {
        HostError::Link(
            LinkError::Open { .. }
            | LinkError::Spi { .. }
            | LinkError::Server { .. }
            | LinkError::NoReply { .. }
            | LinkError::Line(_),
        ) => Failure::missing_tool(error),
        HostError::Fault { .. } => Failure::Check(format!("{error} (--clear-faults)")),
        HostError::Late { .. }
        | HostError::Refused { .. }
        | HostError::Probe { .. }
        | HostError::NoEdge { .. }
        | HostError::Deviates { .. }
        | HostError::Standstill
        | HostError::Bypass { .. } => Failure::Check(error.to_string()),
        _ => Failure::because(error),
    }
}

/// Index of the axis with this name.
fn axis_of(machine: &Machine, name: &str, path: &Path) -> Result<usize, Failure> {
    let found = machine.axes.iter().position(|axis| axis.name == name);
    found.ok_or_else(|| {
        let names: Vec<&str> = machine.axes.iter().map(|axis| axis.name.as_str()).collect();
        Failure::input(format!("{}: no axis `{name}`", path.display()))
            .with_help(format!("the axes are {}", names.join(", ")))
    })
}
