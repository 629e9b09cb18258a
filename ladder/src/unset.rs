//! Proves that no value from before the reset reaches an output: two copies of a block begin in any two states, and agree after it.
//!
//! ```text
//!  inputs, any ─┬─► block without initial values, in any state ────────┬─► equal in every clock after the reset?
//!               └─► the same block, in any other state ────────────────┘    (Yosys: miter ─► ABC: register correspondence, PDR)
//! ```
//!
//! - Both are in reset in the first [`RESET_CLOCKS`] clocks; afterwards reset is an input like all others.
//! - A register without a reset, or one whose reset takes more clocks, may differ between the copies. If an output or the port of a
//!   memory depended on it, it would differ too. A simulation with `x` asks the same question, but only for some inputs, and an `if`
//!   over `x` makes it pessimistic.
//! - Memories, ROMs and multipliers are cut out as for [netlists](crate::netlist): their inputs are compared like outputs of the block,
//!   and their outputs are free, with the same value in both copies. This does not prove that a word of a memory is written before it
//!   is read; the second simulator checks it, since it starts with `x` in all of them.

use std::path::Path;
use std::time::Duration;

use posicast_hdl::emit::Module;
use posicast_system::scratch;

use posicast_testbench::Error;
use posicast_testbench::blocks::Block;
use posicast_testbench::crosssim::without_initial_values;

use crate::netlist::{EquivalenceVerdict, NetlistParts};
use crate::sides::Sides;

/// Clocks of the reset: a synchroniser of two flip-flops has taken its input after two.
pub const RESET_CLOCKS: u32 = 3;
/// Length in clocks of the longest difference that is searched for.
const SEARCHED_CLOCKS: u32 = 60;

/// The reset of the first clocks, and the outputs afterwards. What is not connected here is any value.
const AFTER_RESET: &str = "\
module after_reset (input wire clk, input wire rst);
    reg [1:0] clocks = 2'd0;
    wire over = clocks == 2'd3;
    wire differs;
    always @(posedge clk) clocks <= over ? 2'd3 : clocks + 2'd1;
    miter both (.in_clk(clk), .in_rst(rst | ~over), .trigger(differs));
    always @* assert(!(over & differs));
endmodule
";

/// Compares two copies of a block, as [`independent`].
///
/// # Errors
/// As [`independent`]; [`Error`] of the emitter where the block has no Verilog.
pub fn check(block: &dyn Block, limit: Duration) -> Result<EquivalenceVerdict, Error> {
    let temporary = std::env::temp_dir();
    let folder = scratch::Folder::new(scratch::PREFIX).map_err(Error::file(&temporary, "create a folder in"))?;
    independent(&block.top(), &NetlistParts::of(block.modules()?), folder.path(), limit)
}

/// Compares two copies of a block with the top module `top`, which has the inputs `clk` and `rst`, with files in `folder`. Each of
/// ABC's engines gets `limit` of processor time.
///
/// # Errors
/// [`Error::ToolMissing`] without Yosys or its ABC; [`Error::ToolFailed`] where Yosys refuses the Verilog; [`Error::File`] for the files.
pub fn independent(
    top: &str,
    parts: &NetlistParts,
    folder: &Path,
    limit: Duration,
) -> Result<EquivalenceVerdict, Error> {
    let sides = Sides::new(top, &parts.kept, folder)?;
    sides.write("after_reset.v", AFTER_RESET)?;
    let unset: Vec<Module> = parts.logic.iter().map(without_initial_values).collect();
    let files = sides.write_modules(&unset)?.join(" ");
    // No pass may give an unset register a value, nor merge registers of the copies: therefore no `opt`.
    let script = format!(
        "{}{}design -copy-from gold -as gold gold\ndesign -copy-from gate -as gate gate\n\
         miter -equiv -flatten gold gate miter\nread_verilog -formal after_reset.v\nhierarchy -top after_reset\nproc\nflatten\n\
         setundef -undriven -anyseq\ntechmap\ndffunmap\nabc -g AND -fast\nopt_clean\n\
         write_aiger -I -B -zinit -no-startoffset copies.aig\n",
        sides.side(&files, "gold"),
        sides.side(&files, "gate")
    );
    let doing = ["joining two copies", "comparing two copies after a reset"];
    sides.decide(("copies", &script), SEARCHED_CLOCKS, limit, doing)
}
