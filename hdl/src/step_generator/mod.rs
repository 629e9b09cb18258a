//! The step generator in hardware: from the position of every tick to the pulses of a drive with step inputs.
//!
//! The datasheet is `docs/step_generator.md`, the reference `posicast_blocks::step_generator`.
//!
//! One kernel serves all sizes. It is compiled at three sizes, from which the emitter writes any: see `compiled`.

mod interpolation;
mod kernel;
mod pulser;

use crate::compiled::{self, Compiled};
use crate::emit::{self, EmitError, EmitOptions, Header, Module, Parameter};
use crate::simulation::{Simulated, SimulationError};
use kernel::StepGenerator;
use posicast_blocks::step_generator::{LATENCY_CLOCKS, PORTS, StepGeneratorConfig, ports};
use posicast_blocks::{ClockedBlock, port_notes};

/// The step generator with an accumulator of A bits.
macro_rules! step_generator {
    ($a:literal) => {
        Compiled {
            sizes: &[$a],
            build: |config| Box::new(StepGenerator::<$a, { $a + 1 }>::new(config)),
        }
    };
}

const SIZES: [Compiled<StepGeneratorConfig>; 3] = [step_generator!(31), step_generator!(22), step_generator!(26)];

/// The step generator in RustHDL's own simulator.
///
/// It runs at a compiled size that is large enough: the accumulator may be wider, but the outputs are the same.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds an error in the block.
pub fn simulate(config: &StepGeneratorConfig) -> Result<Box<dyn ClockedBlock>, SimulationError> {
    let holding = simulated(config).ok_or(SimulationError::Size {
        block: "step_generator",
        word_bits: config.accumulator_bits(),
    })?;
    let block = (holding.build)(config);
    Ok(Box::new(Simulated::new("step_generator", block, ports())?))
}

/// The size at which [`simulate`] runs the step generator, as text, if it differs from its own.
pub fn simulated_as(config: &StepGeneratorConfig) -> Option<String> {
    match simulated(config)?.sizes {
        &[bits] if bits != config.accumulator_bits() => Some(format!("an accumulator of {bits} bits")),
        _ => None,
    }
}

fn simulated(config: &StepGeneratorConfig) -> Option<&'static Compiled<StepGeneratorConfig>> {
    compiled::holding(&SIZES, &[config.accumulator_bits()], false)
}

/// Name of the last module that [`emit()`] writes.
pub fn name(config: &StepGeneratorConfig, prefix: &str) -> String {
    emit::shared_name(prefix, &base_name(config))
}

fn base_name(config: &StepGeneratorConfig) -> String {
    let times = config.times();
    let low = config.lines_active_low();
    let polarity = [low.a, low.b].map(|low| if low { '1' } else { '0' });
    format!(
        "step_generator_{}_f{}_{}x{}x{}x{}_{}_{}{}_{}",
        config.tick_clocks(),
        config.fraction_bits(),
        times.pulse_clocks,
        times.space_clocks,
        times.direction_setup_clocks,
        times.direction_hold_clocks,
        config.mode().name(),
        polarity[0],
        polarity[1],
        config.owed_limit(),
    )
}

/// The step generator's Verilog, one module per file, the top last.
///
/// [`name`] gives the top's name; names have no prefix where `prefix` is empty.
///
/// # Errors
/// [`EmitError`] where `prefix` is not a valid Verilog name.
pub fn emit(config: &StepGeneratorConfig, prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: base_name(config),
        prefix: prefix.to_owned(),
        header: Header {
            about: "Step generator: from the position of every tick to the pulses of a drive with step inputs.\n\
                    At a tick the demanded steps are the position, rounded half up; nothing is ever lost."
                .to_owned(),
            ports: port_notes(PORTS),
            parameters: parameters(config),
        },
    };
    compiled::emit(&SIZES, config, &[config.accumulator_bits()], &options)
}

fn parameters(config: &StepGeneratorConfig) -> Vec<Parameter> {
    let times = config.times();
    let low = config.lines_active_low();
    let low = match (low.a, low.b) {
        (false, false) => "none",
        (true, false) => "a",
        (false, true) => "b",
        (true, true) => "a b",
    };
    vec![
        Parameter::new("tick_clocks", config.tick_clocks(), "from tick to tick"),
        Parameter::new("fraction_bits", config.fraction_bits(), "of position"),
        Parameter::new("mode", config.mode().name(), "what the lines show"),
        Parameter::new("active low lines", low, "off at high"),
        Parameter::new("pulse_clocks", times.pulse_clocks, "at least"),
        Parameter::new("space_clocks", times.space_clocks, "at least, from pulse to pulse"),
        Parameter::new(
            "direction_setup_clocks",
            times.direction_setup_clocks,
            "at least, from a change of direction to the next pulse",
        ),
        Parameter::new(
            "direction_hold_clocks",
            times.direction_hold_clocks,
            "at least, from the end of a pulse to a change of direction",
        ),
        Parameter::new("owed_limit", config.owed_limit(), "steps; more are a cause"),
        Parameter::new(
            "latency_clocks",
            LATENCY_CLOCKS,
            "from the demand of a step to its edge",
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emit::emit as emit_directly;
    use posicast_blocks::step_generator::{StepMode, StepTimes};

    #[test]
    fn a_step_generator_comes_out_as_if_its_size_were_compiled() {
        let kernel: Compiled<StepGeneratorConfig> = step_generator!(19);
        let times = StepTimes {
            pulse_clocks: 12,
            space_clocks: 13,
            direction_setup_clocks: 30,
            direction_hold_clocks: 5,
        };
        let config = StepGeneratorConfig::new(1000, 8, StepMode::UpDown, times, 50).unwrap();
        assert_eq!(kernel.sizes, &[config.accumulator_bits()]);
        let options = EmitOptions {
            top: base_name(&config),
            prefix: "m".to_owned(),
            header: Header {
                about: String::new(),
                ports: port_notes(PORTS),
                parameters: parameters(&config),
            },
        };
        let expected = emit_directly((kernel.build)(&config).as_ref(), &options).unwrap();
        let emitted = super::emit(&config, "m").unwrap();
        let bodies = |modules: &[Module]| -> Vec<String> {
            let of = |module: &Module| module.text.split_once("module ").map(|(_, body)| body.to_owned());
            modules.iter().filter_map(of).collect()
        };
        assert_eq!(bodies(&emitted), bodies(&expected));
    }
}
