//! Tests the emitted Verilog of the stage through bus and pins against its data sheets alone: `docs/stage.md`, `axis.md`, `segments.md`,
//! `pulse_counter.md`, `pwm.md`, `drive_command.md` and `register-tables.md`.
//!
//! Model and Verilog share one composition, so a wrong wire in it is in both, and lock step cannot detect it. The expectations here are
//! numbers from the data sheets. [`caught`] puts wrong wires into the Verilog and requires that a check fails.

mod bed;
mod caught;
mod checks;
mod constants;

use self::bed::{Bed, modules};
use self::checks::CHECKS;

#[test]
fn the_stage_does_what_its_data_sheets_say() {
    let modules = modules();
    for (_, check) in CHECKS {
        check(&mut Bed::new(&modules));
    }
}
