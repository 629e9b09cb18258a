//! Compares RTL with the bit-exact models: stimuli, simulators, lock step, waveforms.
//!
//! ```text
//!  stimuli ──┬──► model  (posicast_blocks::ClockedBlock) ─┐
//!            │                                                ├─► lockstep ─► report, first mismatch with its clocks
//!            └──► device (verilator, icarus, RustHDL)  ───────┘       │
//!                                                                     └─► wave ─► *.vcd ─► diff ─► verdict
//! ```
//!
//! - [`verilator`] builds Verilog into a shared object, once per content, and runs it: the fast simulator.
//! - [`icarus`] runs the same Verilog in a second, independent, four-valued simulator.
//! - [`stimuli`] makes inputs: directed cases, seeded random mixtures, real motion; and counts what they reach.
//! - [`lockstep`] steps model and device side by side and compares every output in every clock.
//! - [`blocks`] is the list of hardware blocks, each with its Verilog, model, stimuli and coverage.
//! - [`campaign`] is the order of stimuli for a machine; [`recording`] records a real move as waveforms.
//! - [`register_tests`] checks over the bus that registers behave as described.
//! - [`asynchronous`] tests effects that no clock samples.
//! - [`crosssim`] compares the waveforms of two simulators.
//! - [`formal`] proves the properties of property files.
//! - [`replay`] plays a recording into model and RTL.
//! - [`named_mutant`] replaces a text of the Verilog by another: a deliberate fault.
//! - [`wave`] writes waveforms; the crate `wavecmp` compares two of them.
//! - [`vectors`] writes recorded clocks and a bench in Verilog that plays them, for people who have a block and no posicast.
//! - [`yosys`] runs scripts of Yosys and ABC.
//! - [`wording`] writes counts and times for people.

pub mod absolute_encoder;
pub mod asynchronous;
pub mod axi_lite_bridge;
pub mod axis;
pub mod blocks;
pub mod bus_component;
pub mod campaign;
pub mod capture;
pub mod cascade;
pub mod compare;
pub mod component;
pub mod crosssim;
pub mod divider;
pub mod drive_command;
pub mod encoder_generator;
mod error;
pub mod error_table;
pub mod excitation;
pub mod formal;
pub mod icarus;
pub mod inline_axis;
pub mod inline_shaper;
pub mod linear_scale;
pub mod linked_stage;
pub mod lockstep;
pub mod named_mutant;
pub mod parts;
mod patience;
pub mod pulse_counter;
pub mod pwm;
pub mod recording;
pub mod register_tests;
pub mod registers;
pub mod replay;
pub mod segments;
pub mod shaper;
pub mod shard;
pub mod sliding_mode;
pub mod spi_bridge;
pub mod stage;
pub mod step_generator;
pub mod stimuli;
mod tool;
pub mod trace;
pub mod uart_bridge;
pub mod vectors;
pub mod verilator;
pub mod wave;
pub mod wishbone_bridge;
pub mod yosys;

use blocks::registry::RegistryRow;

pub use error::{BlockError, Error, MissingTool};
pub use wavecmp::wording;

/// Every kind of block, in the order of `posicast verify`.
pub(crate) const REGISTRY: &[RegistryRow] = &[
    pulse_counter::ROW,
    divider::ROW,
    pwm::ROW,
    sliding_mode::ROW,
    shaper::ROW,
    cascade::ROW,
    segments::ROW,
    axis::ROW,
    drive_command::ROW,
    trace::ROW,
    linear_scale::ROW,
    error_table::ROW,
    encoder_generator::ROW,
    excitation::ROW,
    uart_bridge::ROW,
    spi_bridge::ROW,
    axi_lite_bridge::ROW,
    wishbone_bridge::ROW,
    step_generator::ROW,
    compare::ROW,
    absolute_encoder::ROW,
    capture::ROW,
    inline_axis::ROW,
    parts::ABSOLUTE_FEEDBACK,
    parts::TIME_BASE,
    parts::SCHEDULE,
    parts::DIVIDER_SHARE,
    parts::GROUP,
    parts::INLINE_GROUP,
    parts::LASTING_DEVIATION,
    parts::PROBE_LINE,
    parts::REALIGN,
    parts::SAMPLE_SELECT,
    parts::SETTING_BANKS,
    registers::ROW,
    component::ROW,
    stage::ROW,
    inline_shaper::ROW,
    linked_stage::inline::ROW,
    bus_component::ROW,
];
