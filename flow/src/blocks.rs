//! The hardware blocks of a machine: its own, with its settings, and the rest of the library at default sizes.

use crate::bench;
use crate::command::{self, Words};
use crate::design::DesignReport;
use crate::failure::Failure;
use crate::machine::of_hardware;
use posicast_blocks::group::MOST_AXES;
use posicast_blocks::pwm::{ActiveLow, PwmConfig};
use posicast_blocks::shaper::{MOTION_WORD_BITS, ShaperConfig, ShaperMotion};
use posicast_hdl::machine::AxisShaper;
use posicast_machine::hardware;
use posicast_machine::machine_file::{AxisSection, Machine};
use posicast_testbench::blocks::{BenchSizes, Block, benches};
use posicast_testbench::component::ComponentBlock;
use posicast_testbench::shaper::MachineShapers;
use std::path::Path;

/// Dead time and minimum pulse of the PWM that is compared if no axis has one.
const PWM_FLOORS_CLOCKS: [u64; 2] = [2, 1];
/// The shaper for motion that is compared if no axis has one: position, velocity and acceleration share a table.
const MOTION: ShaperMotion = ShaperMotion {
    channels: 3,
    modulo: false,
};

/// The machine's top module with its shapers.
pub(crate) fn shapers(machine: &Machine, shapers: Vec<AxisShaper>, words: &Words) -> Result<MachineShapers, Failure> {
    MachineShapers::new(&machine.name, shapers, command::on_the_ports(machine, words)).map_err(bench::failure)
}

/// Returns the other blocks: none for a machine that has only shapers, otherwise every block of the library. `path` is
/// the machine file.
pub(crate) fn others(
    report: &DesignReport<'_>,
    shapers: &[AxisShaper],
    components: Vec<ComponentBlock>,
    path: &Path,
) -> Result<Vec<Box<dyn Block>>, Failure> {
    let (machine, hardware) = (report.machine, &report.hardware);
    if !machine.axes.iter().any(AxisSection::has_loop) {
        return Ok(Vec::new());
    }
    let first = hardware.axes().iter().find_map(|axis| axis.control.as_ref());
    let sizes = BenchSizes {
        prefix: machine.name.clone(),
        with_encoder: axes(machine, |axis| {
            axis.encoder.is_some_and(|encoder| encoder.absolute.is_none())
        }),
        with_controller: axes(machine, |axis| axis.controller.is_some()),
        tick: hardware.divider().map_err(|error| of_hardware(&error, path))?,
        pwms: pwms(machine, path)?,
        motion: motion_shaper(shapers)?,
        axes: machine.axes.len().clamp(1, MOST_AXES),
        settings: first.map_or_else(Default::default, |control| control.derived.settings),
        components,
        buses: Vec::new(),
        stages: Vec::new(),
        inline: None,
    };
    benches(&sizes).map_err(bench::failure)
}

/// The blocks of a folder in addition to the machine's top: each component, through its bus and its pins, and the
/// blocks in it, each alone.
pub(crate) fn of_components(components: Vec<ComponentBlock>) -> Result<Vec<Box<dyn Block>>, Failure> {
    let mut blocks: Vec<Box<dyn Block>> = Vec::new();
    for component in components {
        let inner = component.inner().map_err(bench::failure)?;
        blocks.push(Box::new(component));
        blocks.extend(inner);
    }
    Ok(blocks)
}

/// Returns the PWMs of the machine, each with the axes that use it; a default PWM if no axis has one.
fn pwms(machine: &Machine, path: &Path) -> Result<Vec<(PwmConfig, String)>, Failure> {
    let mut found: Vec<(PwmConfig, String)> = Vec::new();
    for axis in &machine.axes {
        let Some(pwm) = &axis.pwm else {
            continue;
        };
        let config =
            hardware::pwm_config(pwm, &machine.clock).map_err(|error| Failure::because(error).in_file(path))?;
        match found.iter_mut().find(|(other, _)| *other == config) {
            Some((_, axes)) => {
                axes.push_str(", ");
                axes.push_str(&axis.name);
            }
            None => found.push((config, axis.name.clone())),
        }
    }
    if found.is_empty() {
        let [dead_time, minimum_pulse] = PWM_FLOORS_CLOCKS;
        let config = PwmConfig::new(ActiveLow::default(), dead_time, minimum_pulse).map_err(Failure::because)?;
        found.push((config, "alone".to_owned()));
    }
    Ok(found)
}

/// Names of the axes for which `has` is true, or `alone` if there are none.
fn axes(machine: &Machine, has: impl Fn(&AxisSection) -> bool) -> String {
    let names: Vec<&str> = machine
        .axes
        .iter()
        .filter(|axis| has(axis))
        .map(|axis| axis.name.as_str())
        .collect();
    match names.as_slice() {
        [] => "alone".to_owned(),
        names => names.join(", "),
    }
}

/// A shaper for motion with the table of the first axis that has one, at the first size that holds it.
fn motion_shaper(shapers: &[AxisShaper]) -> Result<ShaperConfig, Failure> {
    let Some(first) = shapers.iter().find_map(|shaper| shaper.config.taps()) else {
        return Err(Failure::input("the machine has no axis with taps"));
    };
    let bits = first.word_bits().max(*MOTION_WORD_BITS.start());
    let plain = ShaperConfig::new(bits, first.table().clone()).map_err(Failure::because)?;
    let all_channels = plain.clone().for_motion(MOTION);
    let config = all_channels.or_else(|_| plain.for_motion(ShaperMotion { channels: 1, ..MOTION }));
    config.map_err(Failure::because)
}
