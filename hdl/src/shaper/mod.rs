//! The input shaper in hardware: `y[n] = saturate( (Σ c_i · x[n − d_i] + 2^(F−1)) >> F )`.
//!
//! The datasheet is `docs/shaper.md`, the reference `posicast_model::rtl::shaper`.
//!
//! One kernel serves all sizes. A size is a type in RustHDL, so [`sized_shaper!`] lists the types and picks the one that
//! a [`ShaperConfig`] names.

mod history;
mod kernel;
mod tap_banks;
mod weighted_sum;

use crate::simulation::{Pins, Simulated, SimulationError};
use kernel::Shaper;
use posicast_model::rtl::ClockedBlock;
use posicast_model::rtl::shaper::{ShaperConfig, ports};

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
    macro_rules! boxed {
        ($shaper:ty) => {
            Box::new(<$shaper>::new(config))
        };
    }
    let block: Box<dyn Pins> = sized_shaper!(config, boxed);
    Ok(Box::new(Simulated::new("shaper", block, ports(config))?))
}
