//! The line of a probe: polarity, synchroniser and filter, in front of the pulse counter's index.
//!
//! The reference is `posicast_blocks::probe_line`.

use crate::axis::Line;
use crate::emit::{self, EmitError, EmitOptions, Header, Module, Parameter};
use crate::prelude::*;
use crate::simulation::{Simulated, SimulationError};
use posicast_blocks::probe_line::{PORTS, PROBE_CLOCKS, ports};
use posicast_blocks::{ClockedBlock, port_notes};

kernel! {
    struct ProbeLine;
    ports posicast_blocks::probe_line_ports;

    parts { line: Line }
    registers { primed: Bits<4> }
    constants { first_clock: Bits<4> = from_u64(1) }
    connect {
        line: filter_clocks;
    }
}

impl Logic for ProbeLine {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module probe_line");
        comment!("After reset, and without a filter, the level is");
        comment!("taken as it is");
        self.primed.d.next = (self.primed.q.val() << 1) | self.first_clock.val();
        self.line.ready.next = self.primed.q.val().get_bit(3) & self.filter_clocks.val().any();
        self.line.pin.next = self.probe.val() ^ self.active_low.val();
        self.touched.next = self.line.level.val();
    }
}

/// The line in RustHDL's own simulator.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds an error in the block.
pub fn simulate() -> Result<Box<dyn ClockedBlock>, SimulationError> {
    let block = Box::new(ProbeLine::default());
    Ok(Box::new(Simulated::new("probe_line", block, ports())?))
}

const NAME: &str = "probe_line";

/// Name of the last module that [`emit()`] writes.
pub fn name(prefix: &str) -> String {
    emit::shared_name(prefix, NAME)
}

/// Verilog of the line; [`name`] gives its name.
///
/// # Errors
/// [`EmitError`] where `prefix` is not a valid Verilog name.
pub fn emit(prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: NAME.to_owned(),
        prefix: prefix.to_owned(),
        header: Header {
            about: "The line of a probe: polarity, synchroniser and filter, in front of the pulse counter's index."
                .to_owned(),
            ports: port_notes(PORTS),
            parameters: vec![Parameter {
                name: "probe_clocks".to_owned(),
                value: PROBE_CLOCKS.to_string(),
                meaning: "from the line to touched, plus filter_clocks".to_owned(),
            }],
        },
    };
    emit::emit(&ProbeLine::default(), &options)
}
