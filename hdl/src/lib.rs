//! The posicast hardware blocks in RustHDL.
//!
//! A block's kernel is written once, in Rust. RustHDL's own simulator runs it (`simulate` of each block), and our
//! typed emitter writes its Verilog. Both are compared clock by clock with the bit-exact model of the same name in
//! `posicast_blocks`. No RustHDL type leaves this crate, except that [`emit::emit`] takes a block.
//!
//! | module | what it is |
//! |---|---|
//! | `kernel` | the macro that makes everything of a kernel except its logic |
//! | `prelude` | the imports of every kernel: RustHDL without its traps, and our leaves |
//! | `prim` | the leaves: blocks with hand-written Verilog |
//! | [`shaper`] | the input shaper |
//! | [`cascade`] | the cascade of half sums |
//! | [`divider`] | the divider: counts and clocks to velocity, one bit per clock |
//! | [`pulse_counter`] | the pulse counter: encoder signals to position, index and velocity |
//! | [`absolute_encoder`] | the absolute encoder: readings of SSI and BiSS-C to a position |
//! | [`absolute_feedback`] | what an axis takes from it: count and velocity |
//! | [`pwm`] | the PWM: a duty to the gates of a bridge, with dead time and fault path |
//! | [`sliding_mode`] | the controller: sliding mode, PD, PID |
//! | [`registers`] | register banks, from their description |
//! | [`time_base`], [`sample_select`], [`setting_banks`] | additional blocks of stand-alone components |
//! | [`divider_share`], [`group`], [`schedule`] | blocks that the axes of a stage share |
//! | [`component`] | components: blocks that stand alone, each with its registers on a bus |
//! | [`segments`] | the command FIFO: segments of constant jerk to position, velocity and acceleration |
//! | [`encoder_generator`] | the internal encoder: quadrature at a set rate, in place of the pins |
//! | [`step_generator`] | the step generator: the position of every tick to the pulses of a drive with step inputs |
//! | [`compare`] | the position compare: a pulse when a count passes a position |
//! | [`inline_axis`], [`inline_group`] | an axis of the inline shaper, and what its axes share |
//! | [`inline_shaper`] | the inline shaper: from the steps of a controller to shaped steps for the drives |
//! | [`realign`] | what a host's correction of missing steps does in hardware |
//! | [`probe_line`] | the line of a probe, in front of the pulse counter's index |
//! | [`error_table`] | a measured error of screw or scale over position, taken from the position reference |
//! | [`excitation`] | a test signal on the position reference |
//! | [`axis`] | the supervisor of an axis: states, limits, brake, faults |
//! | [`drive_command`] | the drive command: the duty for the PWM, from the controller or, in direct mode, manual |
//! | [`linear_scale`] | the linear scale: compares motor and scale; deviation, position, velocity |
//! | [`lasting_deviation`] | what passes the deviation on to the supervisor once it has lasted |
//! | [`capture`] | the position capture: the positions of the axes at an edge of a probe |
//! | [`trace`] | the trace memory: records signals of an axis, tick by tick, around a trigger |
//! | [`uart_bridge`] | the bridge from a serial line to the registers |
//! | [`spi_bridge`] | the bridge from SPI to the registers |
//! | [`linked_stage`] | the stage with one of these bridges |
//! | [`axi_lite_bridge`], [`wishbone_bridge`] | the bridges from other buses to the registers |
//! | [`bus_component`] | a component with one of these bridges |
//! | [`machine`] | a machine's top module: the shapers of its axes, side by side |
//! | [`emit`](mod@emit) | the typed emitter, a crate of its own, with the documentation of the kernels |

pub mod absolute_encoder;
pub mod absolute_feedback;
pub mod axi_lite_bridge;
pub mod axis;
pub mod bus_component;
pub mod capture;
pub mod cascade;
pub mod compare;
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
pub mod inline_axis;
pub mod inline_group;
pub mod inline_shaper;
mod kernel;
pub mod lasting_deviation;
pub mod linear_scale;
mod link_frames;
pub mod linked_stage;
pub mod machine;
pub(crate) mod prelude;
pub(crate) mod prim;
pub mod probe_line;
pub mod pulse_counter;
pub mod pwm;
pub mod realign;
pub mod registers;
pub mod sample_select;
pub mod schedule;
pub mod segments;
pub mod setting_banks;
pub mod shaper;
mod simulation;
pub mod sliding_mode;
pub mod spi_bridge;
pub mod step_generator;
pub mod time_base;
pub mod trace;
pub mod uart_bridge;
pub mod wishbone_bridge;

pub use simulation::SimulationError;
