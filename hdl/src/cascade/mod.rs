//! The cascade of half sums in hardware: `y_k[n] = y_{k−1}[n] + y_{k−1}[n − d_k]`, rounded once at the end.
//!
//! The datasheet is `docs/cascade.md`, the reference `posicast_blocks::cascade`.
//!
//! One kernel serves all sizes. It is compiled at three sizes, from which the emitter writes any: see `compiled`.

mod kernel;

use crate::compiled::{self, Compiled};
use crate::emit::{EmitError, EmitOptions, Header, Module, Parameter};
use crate::simulation::{Simulated, SimulationError};
use kernel::Cascade;
use posicast_blocks::cascade::{CascadeConfig, PORTS, pass_clocks, ports};
use posicast_blocks::{ClockedBlock, port_notes};

/// The cascade with words of W bits, sums of S bits, ring buffers of 2^A samples and 2^I stages.
macro_rules! cascade {
    ($w:literal, $s:literal, $a:literal, $i:literal) => {
        Compiled {
            sizes: &[$w, $s, $a, $i],
            build: |config| Box::new(Cascade::<$w, $s, $a, $i, { $a + $i }>::new(config)),
        }
    };
}

const SIZES: [Compiled<CascadeConfig>; 3] = [cascade!(32, 48, 12, 4), cascade!(24, 52, 13, 6), cascade!(29, 34, 9, 3)];

/// The sizes W, S, A and I.
fn sizes(config: &CascadeConfig) -> [u32; 4] {
    [
        config.word_bits(),
        config.sum_bits(),
        config.ring_address_bits(),
        config.stage_index_bits(),
    ]
}

/// The cascade in RustHDL's own simulator.
///
/// It runs at a compiled size that is large enough: words may be wider and ring buffers larger, but the outputs are the
/// same.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds an error in the block.
pub fn simulate(config: &CascadeConfig) -> Result<Box<dyn ClockedBlock>, SimulationError> {
    let holding = simulated(config).ok_or(SimulationError::Size {
        block: "cascade",
        word_bits: config.word_bits(),
    })?;
    Ok(Box::new(Simulated::new(
        "cascade",
        (holding.build)(config),
        ports(config.word_bits() as usize),
    )?))
}

/// The sizes at which [`simulate`] runs the cascade, as text, if they differ from its own.
pub fn simulated_as(config: &CascadeConfig) -> Option<String> {
    match simulated(config)?.sizes {
        same if same == sizes(config) => None,
        &[word_bits, _, ring, index] => Some(format!(
            "words of {word_bits} bits, rings of {} samples, {} stages",
            1u32 << ring,
            1u32 << index
        )),
        _ => None,
    }
}

fn simulated(config: &CascadeConfig) -> Option<&'static Compiled<CascadeConfig>> {
    compiled::holding(&SIZES, &sizes(config), false)
}

/// The cascade's Verilog, one module per file, the top last.
///
/// The top is called `PREFIX_cascade`, or `cascade` where `prefix` is empty.
///
/// # Errors
/// [`EmitError`] where `prefix` is not a valid Verilog name.
pub fn emit(config: &CascadeConfig, prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: "cascade".to_owned(),
        prefix: prefix.to_owned(),
        header: header(config),
    };
    compiled::emit(&SIZES, config, &sizes(config), &options)
}

fn header(config: &CascadeConfig) -> Header {
    let stages = config.stages();
    Header {
        about: "Cascade of half sums: y_k[n] = y_(k-1)[n] + y_(k-1)[n - d_k], y = (y_N + 2^(N-1)) >> N\n\
                strobe: x is a sample; start: begin anew, all samples before are x. Two clocks per stage."
            .to_owned(),
        ports: port_notes(PORTS),
        parameters: vec![
            Parameter::new("word_bits", config.word_bits(), "x and y, two's complement"),
            Parameter::new("stages", stages, "N; their delays stand in the ROM"),
            Parameter::new("ring_samples", 1 << config.ring_address_bits(), "delays up to this - 2"),
            Parameter::new("pass_clocks", pass_clocks(stages), "from strobe to valid"),
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emit::emit as emit_directly;

    #[test]
    fn a_cascade_comes_out_as_if_its_size_were_compiled() {
        let kernel: Compiled<CascadeConfig> = cascade!(16, 24, 7, 3);
        let config = CascadeConfig::new(16, vec![3, 100, 7, 1, 2]).unwrap();
        assert_eq!(kernel.sizes, sizes(&config));
        let options = EmitOptions {
            top: "cascade".to_owned(),
            prefix: "m".to_owned(),
            header: header(&config),
        };
        let expected = emit_directly((kernel.build)(&config).as_ref(), &options).unwrap();
        assert_eq!(super::emit(&config, "m").unwrap(), expected);
    }
}
