//! The PWM in hardware: turns a duty into the gates of a bridge, with dead time, minimum pulse, fault path and
//! watchdog.
//!
//! The datasheet is `docs/pwm.md`, the reference `posicast_blocks::pwm`.

mod carrier;
mod command;
mod filtered_fault;
mod gates;
mod kernel;
mod leg;
mod timing;
mod trip;

use crate::emit::{self, EmitError, EmitOptions, Header, Module, Parameter};
use crate::simulation::{Simulated, SimulationError};
use kernel::Pwm;
use posicast_blocks::pwm::{PORTS, PwmConfig, ports};
use posicast_blocks::{ClockedBlock, port_notes};

/// The PWM in RustHDL's own simulator.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds an error in the block.
pub fn simulate(config: &PwmConfig) -> Result<Box<dyn ClockedBlock>, SimulationError> {
    let block = Box::new(Pwm::new(config));
    Ok(Box::new(Simulated::new("pwm", block, ports())?))
}

/// Name of the last module that [`emit()`] writes.
pub fn name(config: &PwmConfig, prefix: &str) -> String {
    emit::shared_name(prefix, &base_name(config))
}

fn base_name(config: &PwmConfig) -> String {
    let off = config.active_low();
    let off = [off.a_high, off.a_low, off.b_high, off.b_low].map(|level| if level { '1' } else { '0' });
    let off: String = off.iter().collect();
    let floors = [config.dead_time_floor_clocks(), config.minimum_pulse_floor_clocks()];
    let on_time_base = if config.is_on_time_base() { "_on_time_base" } else { "" };
    format!("pwm_{}x{}_{off}{on_time_base}", floors[0], floors[1])
}

/// The PWM's Verilog, one module per file, the top last.
///
/// [`name`] gives the top's name; names have no prefix where `prefix` is empty.
///
/// # Errors
/// [`EmitError`] where `prefix` is not a valid Verilog name.
pub fn emit(config: &PwmConfig, prefix: &str) -> Result<Vec<Module>, EmitError> {
    let off = config.active_low();
    let low = [
        (off.a_high, "a_high"),
        (off.a_low, "a_low"),
        (off.b_high, "b_high"),
        (off.b_low, "b_low"),
    ];
    let low: Vec<&str> = low.into_iter().filter(|(low, _)| *low).map(|(_, name)| name).collect();
    let low = if low.is_empty() {
        "none".to_owned()
    } else {
        low.join(" ")
    };
    let options = EmitOptions {
        top: base_name(config),
        prefix: prefix.to_owned(),
        header: Header {
            about: "PWM: turns a duty into the gates of a bridge, with dead time, minimum pulse, fault path and \
                watchdog.\n\
                    fault_n and pll_locked switch the pins off without a clock."
                .to_owned(),
            ports: port_notes(PORTS),
            parameters: vec![
                Parameter::new("active low pins", low, "on at low, off at high"),
                Parameter::new("dead time floor", config.dead_time_floor_clocks(), "clocks, at least 1"),
                Parameter::new(
                    "minimum pulse floor",
                    config.minimum_pulse_floor_clocks(),
                    "clocks, at least 1",
                ),
                Parameter::new(
                    "first start",
                    if config.is_on_time_base() {
                        "in phase"
                    } else {
                        "as it is"
                    }
                    .to_owned(),
                    "with the time base at sync, or without one",
                ),
            ],
        },
    };
    emit::emit(&Pwm::new(config), &options)
}
