//! Why a stage does not carry out a host's request.

use crate::LinkError;
use posicast_machine::motion::{AxisMoveError, PlanError};

/// Why a stage does not carry out a host's request.
#[derive(Debug, thiserror::Error)]
pub enum HostError {
    /// The link fails.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// There are registers, but they are not those of a stage.
    #[error("word 0 reads {found:#010x}, but a stage has {:#010x} (STGE): something else is at this port", u32::from_le_bytes(*b"STGE"))]
    NoStage {
        /// Word 0.
        found: u32,
    },
    /// There are registers, but they are not those of an inline shaper.
    #[error(
        "word 0 reads {found:#010x}, but an inline shaper has {:#010x} (INLN): something else is at this port",
        u32::from_le_bytes(*b"INLN")
    )]
    NoInlineShaper {
        /// Word 0.
        found: u32,
    },
    /// The registers have another version.
    #[error(
        "the hardware has version {}.{} of the registers, and this posicast needs {}.{}: use the posicast that generated it, or \
         generate it anew", .found >> 16, .found & 0xffff, .expected >> 16, .expected & 0xffff
    )]
    Version {
        /// Version of the stage.
        found: u32,
        /// Version of the machine file's stage.
        expected: u32,
    },
    /// The stage was made from another machine file.
    #[error(
        "the hardware was made from a machine file with the checksum {found:08x}, and this one has {expected:08x}: name the machine.toml of \
         the folder from which the FPGA was built, or generate and build it anew (every change of the file changes its checksum)"
    )]
    Machine {
        /// Checksum in the stage.
        found: u32,
        /// Checksum of the machine file.
        expected: u32,
    },
    /// A constant of the build differs.
    #[error(
        "{register} of the hardware is {found}, but the machine file gives {expected}: use the posicast that generated it, or \
         generate it anew"
    )]
    Constant {
        /// Name of the register.
        register: String,
        /// Value in the stage.
        found: u32,
        /// Value by the machine file.
        expected: u32,
    },
    /// The stage has no such register.
    #[error(
        "this hardware has no register {0}: its machine file lacks the part that has it ([axis.trace] for a trace)"
    )]
    NoRegister(String),
    /// An axis has a fault, or stops because of one.
    #[error("axis {axis} is in {state} because of {causes}: remove the cause, then clear the fault")]
    Fault {
        /// Name of the axis.
        axis: String,
        /// Its state.
        state: &'static str,
        /// Names of the causes.
        causes: String,
    },
    /// An axis moves.
    #[error("axis {0} is moving: wait until it stands still")]
    Busy(String),
    /// A change did not happen in time.
    #[error("axis {axis} is in {state} and did not {wanted} in time")]
    Late {
        /// Name of the axis.
        axis: String,
        /// The awaited change.
        wanted: &'static str,
        /// Its state.
        state: &'static str,
    },
    /// The shaping of an inline shaper did not end or begin in time.
    #[error("the shaping did not {wanted} in time, because an axis is not settled; the request stays: {remedy}")]
    Bypass {
        /// The awaited change.
        wanted: &'static str,
        /// What to do.
        remedy: &'static str,
    },
    /// The position compare of an axis cannot do what is asked.
    #[error("axis {axis} compares no positions: {what}")]
    Compare {
        /// Name of the axis.
        axis: String,
        /// The reason.
        what: String,
    },
    /// Time stands still in the stage.
    #[error("the registers answer, but their time stands still: does the hardware have a clock, or is it in reset?")]
    Standstill,
    /// A move does not fit the machine.
    #[error("axis {axis}: {source}")]
    Move {
        /// Name of the axis.
        axis: String,
        /// The reason.
        source: AxisMoveError,
    },
    /// A move cannot be planned.
    #[error("axis {axis}: {source}")]
    Plan {
        /// Name of the axis.
        axis: String,
        /// The reason.
        source: PlanError,
    },
    /// A move ends beyond the soft limits.
    #[error(
        "axis {axis}: the move ends at {end} counts since reset, beyond its soft limits of {minus} and {plus}: give a shorter one"
    )]
    Beyond {
        /// Name of the axis.
        axis: String,
        /// End of the move.
        end: f64,
        /// Lower limit.
        minus: f64,
        /// Upper limit.
        plus: f64,
    },
    /// The stage refused a request.
    #[error("axis {axis}: the stage refuses {what}")]
    Refused {
        /// Name of the axis.
        axis: String,
        /// What was refused, and what to do.
        what: &'static str,
    },
    /// An axis is too far off its scale to be corrected.
    #[error(
        "axis {axis} is {steps} steps off its scale, more than the {most} that are corrected: look for the cause, then home it"
    )]
    Deviates {
        /// Name of the axis.
        axis: String,
        /// Missing steps.
        steps: i32,
        /// Largest number that is corrected.
        most: u32,
    },
    /// Homing by a probe failed.
    #[error("axis {axis} was not homed: {what}")]
    Probe {
        /// Name of the axis.
        axis: String,
        /// What was missing.
        what: &'static str,
    },
    /// A probing move found nothing.
    #[error("axis {axis} found nothing: {what}")]
    NoEdge {
        /// Name of the axis.
        axis: String,
        /// What was missing.
        what: &'static str,
    },
    /// A trace was requested that the stage cannot record.
    #[error("{0}")]
    Trace(String),
    /// A tap table does not fit the stage.
    #[error("axis {axis}: {what}")]
    Table {
        /// Name of the axis.
        axis: String,
        /// What does not fit, and what to do.
        what: String,
    },
}
