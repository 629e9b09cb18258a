//! The input shaper in hardware: `y[n] = saturate( (Σ c_i · x[n − d_i] + 2^(F−1)) >> F )`.
//!
//! The datasheet is `docs/shaper.md`, the reference `posicast_blocks::shaper`.
//!
//! One kernel serves all sizes of the plain shaper, and a second one all motion shapers, with channels, handover and
//! modulo axes. Each form of a kernel (one or two multipliers, one to three channels) is compiled at three sizes, from
//! which the emitter writes any: see `compiled`. The forms have the same sizes wherever possible, so that the parts are
//! compiled once.

mod channel_sums;
mod handover;
mod history;
mod kernel;
mod motion;
mod product;
mod tap_banks;
mod weighted_sum;

use crate::compiled::{self, Compiled};
use crate::emit::{self, EmitError, EmitOptions, Header, Module, Parameter};
use crate::simulation::{Simulated, SimulationError};
use kernel::Shaper;
use motion::MotionShaper;
use posicast_blocks::shaper::{ShaperConfig, moving, plain, ports};
use posicast_blocks::{ClockedBlock, port_notes};

/// The plain shaper with words of W bits, a ring buffer of 2^A samples, tables of 2^T taps, and one (U = 0) or two
/// (U = 1) multipliers.
macro_rules! shaper {
    ($w:literal, $a:literal, $t:literal, $u:literal) => {
        Compiled {
            sizes: &[$w, $a, $t],
            build: |config| {
                Box::new(Shaper::<
                    $w,
                    { $w + 18 },
                    { $w + 18 + $t },
                    $a,
                    $t,
                    { $t + 1 },
                    { 18 + $t },
                    { 18 + $a },
                    $u,
                >::new(config))
            },
        }
    };
}

/// The motion shaper with C channels; W, A and T as in the plain shaper.
macro_rules! motion_shaper {
    ($w:literal, $a:literal, $t:literal, $c:literal) => {
        Compiled {
            sizes: &[$w, $a, $t],
            build: |config| {
                Box::new(MotionShaper::<
                    $w,
                    { $w + 18 },
                    { $w + 19 + $t },
                    $a,
                    $t,
                    { $t + 1 },
                    { 18 + $t },
                    { 18 + $a },
                    $c,
                    { $c - 1 },
                >::new(config))
            },
        }
    };
}

/// A kernel compiled at three sizes, for one form.
type Sizes = [Compiled<ShaperConfig>; 3];

/// Width of the widest word for which one multiplier is enough.
const ONE_MULTIPLIER_BITS: u32 = 17;
const ONE_MULTIPLIER: Sizes = [shaper!(17, 14, 8, 0), shaper!(9, 15, 10, 0), shaper!(14, 11, 5, 0)];
const TWO_MULTIPLIERS: Sizes = [shaper!(32, 14, 8, 1), shaper!(24, 15, 10, 1), shaper!(29, 11, 5, 1)];
const ONE_CHANNEL: Sizes = [
    motion_shaper!(32, 14, 8, 1),
    motion_shaper!(24, 15, 10, 1),
    motion_shaper!(29, 11, 5, 1),
];
const TWO_CHANNELS: Sizes = [
    motion_shaper!(32, 14, 8, 2),
    motion_shaper!(24, 15, 10, 2),
    motion_shaper!(29, 11, 5, 2),
];
const THREE_CHANNELS: Sizes = [
    motion_shaper!(32, 14, 8, 3),
    motion_shaper!(24, 15, 10, 3),
    motion_shaper!(29, 11, 5, 3),
];

/// The compiled sizes of the form of kernel that `config` needs.
fn kernel(config: &ShaperConfig) -> &'static Sizes {
    match config.motion().map(|motion| motion.channels) {
        None if config.word_bits() <= ONE_MULTIPLIER_BITS => &ONE_MULTIPLIER,
        None => &TWO_MULTIPLIERS,
        Some(1) => &ONE_CHANNEL,
        Some(2) => &TWO_CHANNELS,
        Some(_) => &THREE_CHANNELS,
    }
}

/// The sizes W, A and T.
fn sizes(config: &ShaperConfig) -> [u32; 3] {
    [config.word_bits(), config.ring_address_bits(), config.tap_index_bits()]
}

/// The shaper in RustHDL's own simulator.
///
/// It runs at a compiled size that is large enough: ring buffer and tables may be larger and words wider, but the
/// outputs are the same.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds an error in the block, or where a position wraps at a width that is not
/// compiled.
pub fn simulate(config: &ShaperConfig) -> Result<Box<dyn ClockedBlock>, SimulationError> {
    let holding = simulated(config).ok_or(SimulationError::Size {
        block: "shaper",
        word_bits: config.word_bits(),
    })?;
    Ok(Box::new(Simulated::new(
        "shaper",
        (holding.build)(config),
        ports(config),
    )?))
}

/// The sizes at which [`simulate`] runs the shaper, as text, if they differ from its own.
pub fn simulated_as(config: &ShaperConfig) -> Option<String> {
    match simulated(config)?.sizes {
        same if same == sizes(config) => None,
        &[word_bits, ring, index] => Some(format!(
            "words of {word_bits} bits, a ring of {} samples, tables of {} taps",
            1u32 << ring,
            1u32 << index
        )),
        _ => None,
    }
}

/// The kernel that the simulation runs. A position that wraps needs a word of exactly its width.
fn simulated(config: &ShaperConfig) -> Option<&'static Compiled<ShaperConfig>> {
    let wraps = config.motion().is_some_and(|motion| motion.modulo);
    compiled::holding(kernel(config), &sizes(config), wraps)
}

/// Name of the last module that [`emit()`] writes; it contains a machine's table.
pub fn name(config: &ShaperConfig, prefix: &str) -> String {
    emit::own_name(prefix, &base_name(config))
}

fn base_name(config: &ShaperConfig) -> String {
    match config.motion() {
        None => "shaper".to_owned(),
        Some(motion) => format!("motion_shaper_{}x{}", config.word_bits(), motion.channels),
    }
}

/// The shaper's Verilog, one module per file, the top last.
///
/// [`name`] gives the top's name; names have no prefix where `prefix` is empty.
///
/// # Errors
/// [`EmitError`] where `prefix` is not a valid Verilog name.
pub fn emit(config: &ShaperConfig, prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: base_name(config),
        prefix: prefix.to_owned(),
        header: header(config),
    };
    compiled::emit(kernel(config), config, &sizes(config), &options)
}

fn header(config: &ShaperConfig) -> Header {
    let taps = config.table().taps().len() as u32;
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
            Parameter::new("channels", motion.channels, "share the table, outputs in one clock"),
            Parameter::new("modulo", modulo, "1: position wraps, no saturation"),
            Parameter::new(
                "longest_pass_clocks",
                config.pass_clocks(config.most_products()),
                "in a handover",
            ),
        ];
    }
    let parameters = vec![
        Parameter::new("word_bits", words, "x and y, two's complement"),
        Parameter::new("coefficient_fraction", fraction, "F; coefficients have 18 bits"),
        Parameter::new(
            "ring_samples",
            (1u32 << config.ring_address_bits()).to_string(),
            "delays up to this - 2",
        ),
        Parameter::new("most_taps", config.most_taps(), "per bank"),
        Parameter::new("machine_taps", taps, "bank 0, ROM"),
        Parameter::new(
            "pass_clocks",
            config.pass_clocks(taps * config.channels() as u32).to_string(),
            "from strobe to valid in bank 0",
        ),
    ];
    let ports = match config.motion() {
        None => port_notes(plain::PORTS),
        Some(_) => port_notes(moving::PORTS),
    };
    Header {
        about,
        ports,
        parameters: [parameters, of_motion].concat(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emit::emit as emit_directly;
    use posicast_blocks::shaper::ShaperMotion;
    use posicast_taps::{Tap, TapTable};

    fn table() -> TapTable {
        let tap = |(delay_samples, coefficient)| Tap {
            delay_samples,
            coefficient,
        };
        TapTable::new(9, [(0, -300), (1, 400), (60, 412)].map(tap).to_vec()).unwrap()
    }

    /// Tests one size of each form of kernel that is not among the compiled ones.
    #[test]
    fn each_form_comes_out_as_if_its_size_were_compiled() {
        let direct: [Compiled<ShaperConfig>; 5] = [
            shaper!(16, 6, 6, 0),
            shaper!(18, 13, 7, 1),
            motion_shaper!(24, 7, 8, 1),
            motion_shaper!(24, 12, 6, 2),
            motion_shaper!(32, 9, 6, 3),
        ];
        for (form, kernel) in direct.iter().enumerate() {
            let &[word, ring, index] = kernel.sizes else {
                panic!("three sizes")
            };
            let config = ShaperConfig::of_sizes(word, ring, index, table()).unwrap();
            for modulo in [false, true] {
                let mut config = config.clone();
                if let Some(channels) = form.checked_sub(1).filter(|channels| *channels > 0) {
                    let channels = channels as u32;
                    config = config.for_motion(ShaperMotion { channels, modulo }).unwrap();
                }
                let options = EmitOptions {
                    top: base_name(&config),
                    prefix: "m".to_owned(),
                    header: header(&config),
                };
                let expected = emit_directly((kernel.build)(&config).as_ref(), &options).unwrap();
                assert_eq!(super::emit(&config, "m").unwrap(), expected, "{config:?}");
            }
        }
    }
}
