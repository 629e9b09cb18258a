//! The cascade of half sums in hardware: `y_k[n] = y_{k−1}[n] + y_{k−1}[n − d_k]`, rounded once at the end.
//!
//! The datasheet is `docs/cascade.md`, the reference `posicast_model::rtl::cascade`.
//!
//! One kernel serves all sizes. A size is a type in RustHDL, so `sized_cascade!` lists the types and picks the one that
//! a [`CascadeConfig`] names.

mod kernel;

use crate::emit::{self, EmitError, EmitOptions, Header, Module, Parameter};
use crate::simulation::{Pins, Simulated, SimulationError};
use kernel::Cascade;
use posicast_model::rtl::ClockedBlock;
use posicast_model::rtl::cascade::{CascadeConfig, pass_clocks, ports};

/// Picks the kernel of the sizes that `$config` names and hands its type to the macro `$action`.
///
/// Each last arm is the largest size: [`CascadeConfig`] lets no other through.
macro_rules! sized_cascade {
    ($config:expr, $action:ident) => {
        match $config.word_bits() {
            16 => sized_cascade!(@ring $config, $action, 16),
            24 => sized_cascade!(@ring $config, $action, 24),
            _ => sized_cascade!(@ring $config, $action, 32),
        }
    };
    (@ring $config:expr, $action:ident, $w:literal) => {
        match $config.ring_address_bits() {
            6 => sized_cascade!(@stages $config, $action, $w, 6),
            7 => sized_cascade!(@stages $config, $action, $w, 7),
            8 => sized_cascade!(@stages $config, $action, $w, 8),
            9 => sized_cascade!(@stages $config, $action, $w, 9),
            10 => sized_cascade!(@stages $config, $action, $w, 10),
            _ => sized_cascade!(@stages $config, $action, $w, 12),
        }
    };
    (@stages $config:expr, $action:ident, $w:literal, $a:literal) => {
        match $config.stage_index_bits() {
            2 => $action!(Cascade<$w, { $w + 4 }, $a, 2, { $a + 2 }>),
            3 => $action!(Cascade<$w, { $w + 8 }, $a, 3, { $a + 3 }>),
            _ => $action!(Cascade<$w, { $w + 16 }, $a, 4, { $a + 4 }>),
        }
    };
}

/// The cascade in RustHDL's own simulator.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds a fault in the block.
pub fn simulate(config: &CascadeConfig) -> Result<Box<dyn ClockedBlock>, SimulationError> {
    Ok(Box::new(Simulated::new("cascade", block(config), ports(config))?))
}

/// The cascade's Verilog, one module per file, the top last.
///
/// The top is called `PREFIX_cascade`, or `cascade` where `prefix` is empty.
///
/// # Errors
/// [`EmitError`] where `prefix` makes no Verilog name.
pub fn emit(config: &CascadeConfig, prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: "cascade".to_owned(),
        prefix: prefix.to_owned(),
        header: header(config),
    };
    emit::emit(block(config).as_ref(), &options)
}

fn block(config: &CascadeConfig) -> Box<dyn Pins> {
    macro_rules! boxed {
        ($cascade:ty) => {
            Box::new(<$cascade>::new(config))
        };
    }
    sized_cascade!(config, boxed)
}

fn header(config: &CascadeConfig) -> Header {
    let parameter = |name: &str, value: u32, meaning: &str| Parameter {
        name: name.to_owned(),
        value: value.to_string(),
        meaning: meaning.to_owned(),
    };
    let stages = config.stages();
    Header {
        about: "Cascade of half sums: y_k[n] = y_(k-1)[n] + y_(k-1)[n - d_k], y = (y_N + 2^(N-1)) >> N\n\
                strobe: x is a sample; start: begin anew, all samples before are x. Two clocks per stage."
            .to_owned(),
        parameters: vec![
            parameter("word_bits", config.word_bits(), "x and y, two's complement"),
            parameter("stages", stages, "N; their delays stand in the ROM"),
            parameter("ring_samples", 1 << config.ring_address_bits(), "delays up to this - 2"),
            parameter("pass_clocks", pass_clocks(stages), "from strobe to valid"),
        ],
    }
}
