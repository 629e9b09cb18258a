//! The posicast hardware blocks in RustHDL.
//!
//! A block's kernel is written once, in Rust. RustHDL's own simulator runs it (`simulate` of each block), and our typed
//! emitter writes its Verilog. Both are compared clock by clock with the bit-exact model of the same name in
//! `posicast_model::rtl`. No RustHDL type leaves this crate, except where [`emit::emit`] takes a block.
//!
//! | module | what it is |
//! |---|---|
//! | `kernel` | the macro that makes a kernel of its ports, registers, wires, parts and constants |
//! | `prelude` | what a kernel sees: RustHDL with its traps closed, and our leaves |
//! | `prim` | the leaves: blocks with Verilog of their own |
//! | [`shaper`] | the input shaper |
//! | [`cascade`] | the cascade of half sums |
//! | [`divider`] | counts and clocks to velocity, one bit per clock |
//! | [`pulse_counter`] | encoder signals to position, index and velocity |
//! | [`pwm`] | duty to the gates of a bridge, with dead time and fault path |
//! | [`sliding_mode`] | the controller: sliding mode, PD, PID |
//! | [`registers`] | register banks, from their description |
//! | [`time_base`], [`sample_select`], [`setting_banks`] | what stand-alone components have beside |
//! | [`component`] | the blocks that stand alone, each with its registers on a bus |
//! | [`segments`] | the command FIFO: segments of constant jerk to position, velocity and acceleration |
//! | [`pwm`] | duty to the gates of a bridge, with dead time and fault path |
//! | [`encoder_generator`] | quadrature at a set rate in the place of the encoder's pins |
//! | [`error_table`] | a measured error of screw or scale over position, taken from the position reference |
//! | [`excitation`] | a test signal on the position reference |
//! | [`axis`] | the supervisor of an axis: states, limits, brake, faults |
//! | [`drive_command`] | what the PWM is told: the controller's duty, or a manual one in direct mode |
//! | [`linear_scale`] | a motor's counts against a linear scale's: deviation, position, velocity |
//! | [`trace`] | a memory of what an axis did, tick by tick, around a trigger |
//! | [`machine`] | a machine's top module: the blocks of its axes, side by side |
//! | [`emit`](mod@emit) | the typed emitter: RustHDL's syntax tree as Verilog |

pub mod axis;
pub mod cascade;
mod compiled;
pub mod component;
pub mod divider;
pub mod divider_share;
pub mod drive_command;
pub mod emit;
pub mod encoder_generator;
pub mod error_table;
pub mod excitation;
pub mod group;
mod kernel;
pub mod linear_scale;
pub mod machine;
pub(crate) mod prelude;
pub(crate) mod prim;
pub mod pulse_counter;
pub mod pwm;
pub mod registers;
pub mod sample_select;
pub mod schedule;
pub mod segments;
pub mod setting_banks;
pub mod shaper;
mod simulation;
pub mod sliding_mode;
pub mod time_base;
pub mod trace;

pub use simulation::SimulationError;
