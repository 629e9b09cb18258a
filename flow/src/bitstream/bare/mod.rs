//! A stage on a board without wires: stand-ins for its machine, and the lock step in which posicast's own host switches the axes on and moves
//! them, over the line, by the bits.
//!
//! ```text
//! HostedStage ─► bytes ─► uart_rx ─┬─► netlist of the bits ────────────► uart_tx, LED ─┐
//!             ◄─ bytes ◄───────────┼─► model of the stage ─► uart_tx, LED ─────────────┴─ equal in every clock?
//!                                  └── a, b ◄─ models of the stand-ins ◄─ gates
//! ```

mod line;

use self::line::BareLine;
use crate::failure::Failure;
use crate::machine::at_key;
use posicast_bitstream::BitstreamError;
use posicast_bitstream::behaviour::PinDifference;
use posicast_bitstream::boards::FpgaBoard;
use posicast_bitstream::network::Network;
use posicast_bitstream::top::stand_in::{StandIn, StandInDrive, StandInGates};
use posicast_host::{HostError, HostMove, HostedStage, Link, LinkOptions};
use posicast_machine::hardware::StageHardware;
use posicast_machine::machine_file::{AxisSection, DriveMode, LinkLine, Machine, PwmMode};
use posicast_testbench::linked_stage::LinkedStageBlock;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::Path;
use std::time::Duration;

/// Time of acceleration after which the move of an axis is at its middle, if nothing limits it, in s.
const ACCELERATION_S: f64 = 0.02;
/// Part of the travel that a move takes at most.
const PART_OF_TRAVEL: f64 = 0.5;
/// Fewest counts of a move that count as one.
const FEWEST_COUNTS: f64 = 16.0;
/// Counts by which an axis at rest may differ from its command: the PWM has steps, too.
const REST_COUNTS: f64 = 4.0;
/// What a stage needs on a board without wires.
pub(super) struct Bare<'a> {
    pub(super) machine: &'a Machine,
    pub(super) stage: &'a StageHardware,
    pub(super) stand_ins: Vec<StandIn>,
}

/// The moves of a stage whose machine is its stand-ins.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct BareReport {
    /// Clocks compared, from power-up.
    pub clocks: u64,
    /// Requests of the host that were answered.
    pub requests: u64,
    /// The axes and their moves.
    pub moves: Vec<BareMove>,
    /// Why the host stopped before the end; `None` if it came there.
    pub host_error: Option<String>,
    /// The first difference, at which the comparison ends.
    pub first: Option<PinDifference>,
}

/// The move of an axis.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct BareMove {
    /// Name of the axis.
    pub axis: String,
    /// Counts by which its command moved.
    pub command_counts: f64,
    /// Counts by which its encoder moved, as the host reads it.
    pub encoder_counts: f64,
}

impl BareMove {
    fn arrived(&self) -> bool {
        self.command_counts.abs() >= FEWEST_COUNTS && (self.command_counts - self.encoder_counts).abs() <= REST_COUNTS
    }
}

impl BareReport {
    /// Whether the bits equal the model in every clock, and every axis moved and arrived.
    pub(super) fn holds(&self) -> bool {
        let moved = !self.moves.is_empty() && self.moves.iter().all(BareMove::arrived);
        self.first.is_none() && self.host_error.is_none() && moved
    }
}

/// The stand-ins for a machine's axes, whose clock is the board's oscillator.
pub(super) fn stand_ins(machine: &Machine, path: &Path, board: &FpgaBoard) -> Result<Vec<StandIn>, Failure> {
    match machine.link.map(|link| link.line) {
        Some(LinkLine::Uart { .. }) => {}
        Some(LinkLine::Spi { .. }) => {
            let reason = format!(
                "--bare-board uses the serial line of {}, and this line is SPI",
                board.name
            );
            return Err(at_key(path, 0, "link.line", reason).or_help("write `line = \"uart\"` with `baud = 1_000_000`"));
        }
        None => {
            let reason =
                "--bare-board is for a stage, and this machine has shapers alone, whose top needs no wires in any case";
            return Err(at_key(path, 0, "link", reason).or_help("leave out --bare-board"));
        }
    }
    let axes = machine.axes.iter().enumerate();
    axes.map(|(index, axis)| stand_in(machine, axis, path, index)).collect()
}

fn stand_in(machine: &Machine, axis: &AxisSection, path: &Path, index: usize) -> Result<StandIn, Failure> {
    let needed = |key: &'static str| {
        let reason = format!("a stand-in for axis {} needs [{key}]", axis.name);
        at_key(path, index, key, reason)
    };
    if axis.scale.is_some() {
        let reason = format!("the stand-in for axis {} has no linear scale", axis.name);
        return Err(at_key(path, index, "axis.scale", reason).or_help("leave out [axis.scale], or --bare-board"));
    }
    let pwm = axis.pwm.as_ref().ok_or_else(|| needed("axis.pwm"))?;
    let drive = axis.drive.as_ref().ok_or_else(|| needed("axis.drive"))?;
    let gates = match pwm.mode {
        PwmMode::Direction => StandInGates::Direction,
        PwmMode::HalfBridge => StandInGates::HalfBridge,
        PwmMode::FullBridge | PwmMode::LockedAntiphase => StandInGates::Bridge,
    };
    let clock_hz = machine.clock.frequency_hz;
    let motion = match drive.mode {
        DriveMode::Velocity { full_scale_velocity } => {
            StandInDrive::Velocity(full_scale_velocity * axis.counts_per_unit / clock_hz)
        }
        DriveMode::Torque {
            equivalent_mass,
            force_constant,
            full_scale_a,
            ..
        } => {
            let acceleration = force_constant * full_scale_a / equivalent_mass;
            StandInDrive::Acceleration(acceleration * axis.counts_per_unit / clock_hz.powi(2))
        }
    };
    let reversed = axis.encoder.as_ref().is_some_and(|encoder| encoder.invert);
    StandIn::new(&axis.name, (gates, pwm.active_low), motion, reversed)
        .map_err(|error| at_key(path, index, "axis.drive", format!("axis {}: {error}", axis.name)))
}

impl Bare<'_> {
    /// Runs the netlist beside the models for at most `limit` clocks.
    pub(super) fn lock_step(
        &self,
        network: &Network,
        (block, board): (&LinkedStageBlock, &FpgaBoard),
        (limit, seed): (u64, u64),
        progress: &mut dyn FnMut(u64),
    ) -> Result<BareReport, BitstreamError> {
        let mut line = BareLine::new(self, network, (block, board), (limit, seed), progress)?;
        let options = LinkOptions {
            // Time passes in clocks: the line itself ends a wait.
            timeout: Duration::from_secs(86_400),
            attempts: 1,
        };
        let moved = self.move_all(Link::new(&mut line, options));
        let (requests, moves, host_error) = match moved {
            Ok((requests, moves)) => (requests, moves, None),
            Err(error) => (0, Vec::new(), Some(error.to_string())),
        };
        Ok(BareReport {
            clocks: line.clocks,
            requests,
            moves,
            host_error,
            first: line.first,
        })
    }

    /// Switches all axes on, moves them together, and reads where they are.
    fn move_all(&self, link: Link<&mut BareLine<'_>>) -> Result<(u64, Vec<BareMove>), HostError> {
        let mut host = HostedStage::open(link, self.machine, self.stage)?;
        let axes: Vec<usize> = (0..self.machine.axes.len()).collect();
        host.switch_on(&axes, false)?;
        let before = host.status()?;
        let moves = axes.iter().map(|axis| HostMove {
            axis: *axis,
            distance: distance(&self.machine.axes[*axis]),
            speed: None,
        });
        host.move_axes(&moves.collect::<Vec<_>>())?;
        let after = host.status()?;
        let moves = before.iter().zip(&after).map(|(before, after)| BareMove {
            axis: after.axis.clone(),
            command_counts: after.command - before.command,
            encoder_counts: after.position - before.position,
        });
        let moves = moves.collect();
        host.switch_off(&axes)?;
        Ok((host.link().statistics().answered, moves))
    }
}

/// Distance of the move of an axis, in its unit: short, and within its travel.
fn distance(axis: &AxisSection) -> f64 {
    let limits = axis.limits;
    let wanted = limits.and_then(|limits| limits.acceleration).unwrap_or(0.0) * ACCELERATION_S.powi(2);
    let [minus, plus] = limits.and_then(|limits| limits.travel).unwrap_or([-f64::MAX, f64::MAX]);
    let up = plus >= -minus;
    let most = PART_OF_TRAVEL * if up { plus } else { -minus };
    axis.unit.from_si(wanted.min(most) * if up { 1.0 } else { -1.0 })
}
