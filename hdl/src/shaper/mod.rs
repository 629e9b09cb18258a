//! The input shaper in hardware: `y[n] = saturate( (Σ c_i · x[n − d_i] + 2^(F−1)) >> F )`.
//!
//! The datasheet is `docs/shaper.md`, the reference `posicast_model::rtl::shaper`.
//!
//! One kernel serves all sizes, and a second one all shapers for commands in motion: with channels, handover and modulo
//! axes. A size is a type in RustHDL, so `sized_shaper!` and `sized_motion_shaper!` list the types and pick the one that a
//! [`ShaperConfig`] names.

mod channel_sums;
mod handover;
mod history;
mod kernel;
mod motion;
mod motion_pins;
mod product;
mod tap_banks;
mod weighted_sum;

use crate::emit::{self, EmitError, EmitOptions, Header, Module, Parameter};
use crate::simulation::{Pins, Simulated, SimulationError};
use kernel::Shaper;
use motion::MotionShaper;
use posicast_model::rtl::ClockedBlock;
use posicast_model::rtl::shaper::{ShaperConfig, ports};

/// Picks the kernel of the sizes that `$config` names and hands its type to the macro `$action`.
///
/// Each last arm is the largest size: [`ShaperConfig`] lets no other through.
macro_rules! sized_shaper {
    ($config:expr, $action:ident) => {
        match $config.word_bits() {
            16 => sized_shaper!(@ring $config, $action, 16, 0),
            24 => sized_shaper!(@ring $config, $action, 24, 1),
            _ => sized_shaper!(@ring $config, $action, 32, 1),
        }
    };
    (@ring $config:expr, $action:ident, $w:literal, $u:literal) => {
        match $config.ring_address_bits() {
            6 => sized_shaper!(@index $config, $action, $w, $u, 6),
            7 => sized_shaper!(@index $config, $action, $w, $u, 7),
            8 => sized_shaper!(@index $config, $action, $w, $u, 8),
            9 => sized_shaper!(@index $config, $action, $w, $u, 9),
            10 => sized_shaper!(@index $config, $action, $w, $u, 10),
            11 => sized_shaper!(@index $config, $action, $w, $u, 11),
            12 => sized_shaper!(@index $config, $action, $w, $u, 12),
            _ => sized_shaper!(@index $config, $action, $w, $u, 14),
        }
    };
    (@index $config:expr, $action:ident, $w:literal, $u:literal, $a:literal) => {
        match $config.tap_index_bits() {
            6 => $action!(Shaper<$w, { $w + 18 }, { $w + 18 + 6 }, $a, 6, 7, { 18 + 6 }, { 18 + $a }, $u>),
            _ => $action!(Shaper<$w, { $w + 18 }, { $w + 18 + 8 }, $a, 8, 9, { 18 + 8 }, { 18 + $a }, $u>),
        }
    };
}

/// As `sized_shaper!`, for the shapers for motion: words of 24 and 32 bits, 1 to 3 channels, the largest ring for one.
macro_rules! sized_motion_shaper {
    ($config:expr, $action:ident) => {
        match $config.word_bits() {
            24 => sized_motion_shaper!(@channels $config, $action, 24),
            _ => sized_motion_shaper!(@channels $config, $action, 32),
        }
    };
    (@channels $config:expr, $action:ident, $w:literal) => {
        match ($config.channels(), $config.ring_address_bits()) {
            (1, 14) => sized_motion_shaper!(@index $config, $action, $w, 14, 1),
            (1, _) => sized_motion_shaper!(@ring $config, $action, $w, 1),
            (2, _) => sized_motion_shaper!(@ring $config, $action, $w, 2),
            _ => sized_motion_shaper!(@ring $config, $action, $w, 3),
        }
    };
    (@ring $config:expr, $action:ident, $w:literal, $c:literal) => {
        match $config.ring_address_bits() {
            6 => sized_motion_shaper!(@index $config, $action, $w, 6, $c),
            7 => sized_motion_shaper!(@index $config, $action, $w, 7, $c),
            8 => sized_motion_shaper!(@index $config, $action, $w, 8, $c),
            9 => sized_motion_shaper!(@index $config, $action, $w, 9, $c),
            10 => sized_motion_shaper!(@index $config, $action, $w, 10, $c),
            11 => sized_motion_shaper!(@index $config, $action, $w, 11, $c),
            _ => sized_motion_shaper!(@index $config, $action, $w, 12, $c),
        }
    };
    (@index $config:expr, $action:ident, $w:literal, $a:literal, $c:literal) => {
        match $config.tap_index_bits() {
            6 => $action!(MotionShaper<$w, { $w + 18 }, { $w + 19 + 6 }, $a, 6, 7, { 18 + 6 }, { 18 + $a }, $c, { $c - 1 }>),
            _ => $action!(MotionShaper<$w, { $w + 18 }, { $w + 19 + 8 }, $a, 8, 9, { 18 + 8 }, { 18 + $a }, $c, { $c - 1 }>),
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

/// The same kernel at sizes that no machine gets: words of 6 bits, a ring of 4 samples, tables of 4 taps.
///
/// Small enough that a proof holds memories and multiplier too. Of `config` only the table is used; it must have at most 4
/// taps and delays of at most 2 samples.
///
/// # Errors
/// As [`emit()`].
pub fn emit_small(config: &ShaperConfig) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: "shaper".to_owned(),
        prefix: String::new(),
        header: Header {
            about: "Input shaper of 6-bit words, 4 samples, 4 taps: for proofs alone.".to_owned(),
            parameters: Vec::new(),
        },
    };
    let block: Box<dyn Pins> = Box::new(Shaper::<6, 24, 26, 2, 2, 3, 20, 20, 0>::new(config));
    emit::emit(block.as_ref(), &options)
}

fn block(config: &ShaperConfig) -> Box<dyn Pins> {
    // A function per size: in one function all sizes would have room on the stack at once, and overflow it.
    macro_rules! boxed {
        ($shaper:ty) => {{
            fn build(config: &ShaperConfig) -> Box<dyn Pins> {
                Box::new(<$shaper>::new(config))
            }
            build(config)
        }};
    }
    match config.motion() {
        None => sized_shaper!(config, boxed),
        Some(_) => sized_motion_shaper!(config, boxed),
    }
}

fn header(config: &ShaperConfig) -> Header {
    let taps = config.table().taps().len() as u32;
    let parameter = |name: &str, value: String, meaning: &str| Parameter {
        name: name.to_owned(),
        value,
        meaning: meaning.to_owned(),
    };
    let (words, fraction) = (config.word_bits(), config.coefficient_fraction());
    let mut about = "Input shaper: y[n] = saturate( (sum of c_i * x[n - d_i] + 2^(F-1)) >> F )\n\
                     strobe: x is a sample; start: begin anew, all samples before are x. One tap per clock."
        .to_owned();
    let mut of_motion = Vec::new();
    if let Some(motion) = config.motion() {
        about.push_str(
            "\nx_0: position, x_1: velocity, x_2: acceleration. swap_how: 0 at once, 1 handover, 2 when settled.",
        );
        let modulo = u32::from(motion.modulo).to_string();
        of_motion = vec![
            parameter(
                "channels",
                motion.channels.to_string(),
                "share the table, outputs in one clock",
            ),
            parameter("modulo", modulo, "1: position wraps, no saturation"),
            parameter(
                "longest_pass_clocks",
                config.pass_clocks(config.most_products()).to_string(),
                "in a handover",
            ),
        ];
    }
    let parameters = vec![
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
            config.pass_clocks(taps * config.channels() as u32).to_string(),
            "from strobe to valid in bank 0",
        ),
    ];
    Header {
        about,
        parameters: [parameters, of_motion].concat(),
    }
}
