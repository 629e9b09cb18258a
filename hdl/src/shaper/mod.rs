//! The input shaper in hardware: `y[n] = saturate( (Σ c_i · x[n − d_i] + 2^(F−1)) >> F )`.
//!
//! The datasheet is `docs/shaper.md`, the reference `posicast_model::rtl::shaper`.
//!
//! One kernel serves all sizes. A size is a type in RustHDL, so `sized_shaper!` lists the types and picks the one that
//! a [`ShaperConfig`] names.

mod history;
mod kernel;
mod tap_banks;
mod weighted_sum;

use crate::emit::{self, EmitError, EmitOptions, Header, Module, Parameter};
use crate::simulation::{Pins, Simulated, SimulationError};
use kernel::Shaper;
use posicast_model::rtl::ClockedBlock;
use posicast_model::rtl::shaper::{ShaperConfig, pass_clocks, ports};

/// Picks the kernel of the sizes that `$config` names and hands its type to the macro `$action`.
///
/// Each last arm is the largest size: [`ShaperConfig`] lets no other through.
macro_rules! sized_shaper {
    ($config:expr, $action:ident) => {
        match $config.word_bits() {
            16 => sized_shaper!(@ring $config, $action, 16),
            24 => sized_shaper!(@ring $config, $action, 24),
            _ => sized_shaper!(@ring $config, $action, 32),
        }
    };
    (@ring $config:expr, $action:ident, $w:literal) => {
        match $config.ring_address_bits() {
            6 => sized_shaper!(@index $config, $action, $w, 6),
            7 => sized_shaper!(@index $config, $action, $w, 7),
            8 => sized_shaper!(@index $config, $action, $w, 8),
            9 => sized_shaper!(@index $config, $action, $w, 9),
            10 => sized_shaper!(@index $config, $action, $w, 10),
            11 => sized_shaper!(@index $config, $action, $w, 11),
            12 => sized_shaper!(@index $config, $action, $w, 12),
            _ => sized_shaper!(@index $config, $action, $w, 14),
        }
    };
    (@index $config:expr, $action:ident, $w:literal, $a:literal) => {
        match $config.tap_index_bits() {
            6 => $action!(Shaper<$w, { $w + 18 }, { $w + 18 + 6 }, $a, 6, 7, { 18 + 6 }, { 18 + $a }>),
            _ => $action!(Shaper<$w, { $w + 18 }, { $w + 18 + 8 }, $a, 8, 9, { 18 + 8 }, { 18 + $a }>),
        }
    };
}

/// The shaper in RustHDL's own simulator.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds a fault in the block.
pub fn simulate(config: &ShaperConfig) -> Result<Box<dyn ClockedBlock>, SimulationError> {
    Ok(Box::new(Simulated::new("shaper", block(config), ports(config))?))
}

/// The shaper's Verilog, one module per file, the top last.
///
/// The top is called `PREFIX_shaper`, or `shaper` where `prefix` is empty.
///
/// # Errors
/// [`EmitError`] where `prefix` makes no Verilog name.
pub fn emit(config: &ShaperConfig, prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: "shaper".to_owned(),
        prefix: prefix.to_owned(),
        header: header(config),
    };
    emit::emit(block(config).as_ref(), &options)
}

fn block(config: &ShaperConfig) -> Box<dyn Pins> {
    macro_rules! boxed {
        ($shaper:ty) => {
            Box::new(<$shaper>::new(config))
        };
    }
    sized_shaper!(config, boxed)
}

fn header(config: &ShaperConfig) -> Header {
    let taps = config.table().taps().len() as u32;
    let parameter = |name: &str, value: String, meaning: &str| Parameter {
        name: name.to_owned(),
        value,
        meaning: meaning.to_owned(),
    };
    let (words, fraction) = (config.word_bits(), config.coefficient_fraction());
    Header {
        about: "Input shaper: y[n] = saturate( (sum of c_i * x[n - d_i] + 2^(F-1)) >> F )\n\
                strobe: x is a sample; start: begin anew, all samples before are x. One tap per clock."
            .to_owned(),
        parameters: vec![
            parameter("word_bits", words.to_string(), "x and y, two's complement"),
            parameter(
                "coefficient_fraction",
                fraction.to_string(),
                "F; coefficients have 18 bits",
            ),
            parameter(
                "ring_samples",
                (1u32 << config.ring_address_bits()).to_string(),
                "delays up to this - 2",
            ),
            parameter("most_taps", config.most_taps().to_string(), "per bank"),
            parameter("machine_taps", taps.to_string(), "bank 0, ROM"),
            parameter(
                "pass_clocks",
                pass_clocks(taps).to_string(),
                "from strobe to valid in bank 0",
            ),
        ],
    }
}
