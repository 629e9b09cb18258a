//! Bit-exact, cycle-accurate models of the hardware blocks, one file per block, with the block's name.
//!
//! A model, RustHDL's simulation and a Verilated module all have the same interface, [`ClockedBlock`], through which
//! lock step compares them.

pub mod absolute_encoder;
pub mod absolute_feedback;
pub mod axi_lite_bridge;
pub mod axis;
pub mod axis_shaper;
mod bridged;
pub mod bus_component;
pub mod capture;
pub mod cascade;
pub mod compare;
pub mod component;
pub mod composition;
pub mod divider;
pub mod divider_share;
pub mod drive_command;
pub mod encoder_generator;
pub mod error_table;
pub mod excitation;
pub mod group;
pub mod inline_axis;
pub mod inline_group;
pub mod inline_shaper;
pub mod lasting_deviation;
pub mod linear_scale;
pub mod link;
mod link_frames;
pub mod linked_stage;
mod moore;
mod ports;
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
pub mod shaper_tables;
pub mod sliding_mode;
pub mod spi_bridge;
pub mod stage;
pub mod step_generator;
pub mod time_base;
pub mod trace;
pub mod uart_bridge;
pub mod wishbone_bridge;
pub mod word;

pub use moore::{FOREVER, Moore, OutputKind};
pub(crate) use moore::{quiet_at_rest, show_each};
pub use ports::{DescribedPort, PortList, PortNote, PortRow, SizedPortRow, in_ascii, port_notes};
pub(crate) use ports::{clocked_block, ports};

/// The blocks with a datasheet, and their ports, which the table in `docs/NAME.md` shows.
pub const PORT_LISTS: &[(&str, PortList)] = &[
    ("absolute_encoder", absolute_encoder::PORTS),
    ("axi_lite_bridge", axi_lite_bridge::PORTS),
    ("axis", axis::PORTS),
    ("capture", capture::PORTS),
    ("compare", compare::PORTS),
    ("divider", divider::PORTS),
    ("drive_command", drive_command::PORTS),
    ("encoder_generator", encoder_generator::PORTS),
    ("error_table", error_table::PORTS),
    ("excitation", excitation::PORTS),
    ("inline_axis", inline_axis::PORTS),
    ("linear_scale", linear_scale::PORTS),
    ("pulse_counter", pulse_counter::PORTS),
    ("pwm", pwm::PORTS),
    ("segments", segments::PORTS),
    ("sliding_mode", sliding_mode::PORTS),
    ("spi_bridge", spi_bridge::PORTS),
    ("step_generator", step_generator::PORTS),
    ("trace", trace::PORTS),
    ("uart_bridge", uart_bridge::PORTS),
    ("wishbone_bridge", wishbone_bridge::PORTS),
];

/// As [`PORT_LISTS`], for lists with sizes.
pub const SIZED_PORT_LISTS: &[(&str, &[SizedPortRow])] = &[
    ("cascade", cascade::PORTS),
    ("shaper", shaper::plain::PORTS),
    ("shaper", shaper::moving::PORTS),
];

/// Direction of a port, seen from the block.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// Input: driven from outside.
    Input,
    /// Output: driven by the block.
    Output,
}

/// A port of a block. `clk` is not listed: every block has it, and a step is one of its cycles.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Port {
    /// Name, as in the Verilog.
    pub name: String,
    /// Direction.
    pub direction: Direction,
    /// Width in bits, 1..=64.
    pub width: u32,
    /// Whether the value is a two's complement number.
    pub signed: bool,
}

/// Why a block could not be stepped, for example because RustHDL's simulator did not settle.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct StepError(pub String);

/// A block with one clock and ports of at most 64 bits that can be stepped.
///
/// Values are raw bit patterns, right-aligned; bits above a port's width are zero.
pub trait ClockedBlock {
    /// The ports, inputs and outputs together, in the order of the Verilog's port list.
    fn ports(&self) -> &[Port];

    /// Simulates one clock cycle: applies `inputs` (one value per input port, in port order), writes the outputs just
    /// *before* the rising edge to `outputs` (one value per output port, in port order), then clocks.
    ///
    /// # Errors
    /// [`StepError`] where a simulator fails; a model never fails.
    fn step(&mut self, inputs: &[u64], outputs: &mut [u64]) -> Result<(), StepError>;

    /// Does the same without outputs, for callers that show them otherwise. `scratch` has a value per output port, and means nothing
    /// afterwards.
    ///
    /// # Errors
    /// Those of [`step`](Self::step).
    fn advance(&mut self, inputs: &[u64], scratch: &mut [u64]) -> Result<(), StepError> {
        self.step(inputs, scratch)
    }

    /// The composition, whose nets give access to the inside; `None` for simulators, and for blocks that are not compositions.
    fn composed(&self) -> Option<&composition::Composed> {
        None
    }
}
