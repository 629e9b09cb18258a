//! The hardware blocks of a machine: its own, with its settings, and the rest of the library at default sizes.

use crate::bench;
use crate::command::{self, Words};
use crate::design::DesignReport;
use crate::failure::Failure;
use crate::machine::of_hardware;
use posicast_hdl::machine::AxisShaper;
use posicast_model::hardware::{self, Hardware};
use posicast_model::machine_file::{AxisSection, Machine};
use posicast_model::rtl::cascade::CascadeConfig;
use posicast_model::rtl::divider::DividerConfig;
use posicast_model::rtl::group::MOST_AXES;
use posicast_model::rtl::pwm::{ActiveLow, PwmConfig};
use posicast_model::rtl::registers::RegisterMap;
use posicast_model::rtl::schedule::ScheduleConfig;
use posicast_model::rtl::shaper::{MOTION_WORD_BITS, ShaperConfig, ShaperMotion};
use posicast_model::rtl::trace::TraceConfig;
use posicast_testbench::blocks::{
    AxisBlock, Block, CascadeBlock, ComponentBlock, DividerBlock, DriveCommandBlock, EncoderGeneratorBlock,
    ExcitationBlock, LinearScaleBlock, MachineShapers, PartBlock, PulseCounterBlock, PwmBlock, RegistersBlock,
    SegmentsBlock, ShaperBlock, SlidingModeBlock, SmallPart, TraceBlock,
};
use std::path::Path;

/// Delays of the cascade that is compared by default, in samples.
const CASCADE_DELAYS_SAMPLES: [u32; 4] = [26, 31, 38, 62];
/// Word width of this cascade in bits.
const CASCADE_WORD_BITS: u32 = 32;
/// Dead time and minimum pulse of the PWM that is compared where no axis has one, in clocks.
const PWM_FLOORS_CLOCKS: [u64; 2] = [2, 1];
/// Size in words of the trace memory that is compared.
const TRACE_SAMPLES: u64 = 1024;
/// Clocks from the tick to the controllers, of the schedule that is compared.
const SCHEDULE_CLOCKS: u32 = 500;
/// The motion shaper that is compared where no axis has one: position, velocity and acceleration share a table.
const MOTION: ShaperMotion = ShaperMotion {
    channels: 3,
    modulo: false,
};

/// The machine's top module with its shapers.
pub(crate) fn shapers(machine: &Machine, shapers: Vec<AxisShaper>, words: &Words) -> Result<MachineShapers, Failure> {
    MachineShapers::new(&machine.name, shapers, command::on_the_ports(machine, words)).map_err(bench::failure)
}

/// The other blocks: none for a machine that has only shapers, else every block of the library. `path` is the machine
/// file.
pub(crate) fn others(
    report: &DesignReport<'_>,
    shapers: &[AxisShaper],
    components: Vec<ComponentBlock>,
    path: &Path,
) -> Result<Vec<Box<dyn Block>>, Failure> {
    let (machine, hardware) = (report.machine, &report.hardware);
    let mut blocks: Vec<Box<dyn Block>> = Vec::new();
    if !machine.axes.iter().any(AxisSection::has_loop) {
        return Ok(blocks);
    }
    let name = machine.name.as_str();
    let with_encoder = axes(machine, |axis| axis.encoder.is_some());
    let with_controller = axes(machine, |axis| axis.controller.is_some());
    blocks.push(Box::new(PulseCounterBlock::new(name, &with_encoder)));
    blocks.push(Box::new(DividerBlock::new(divider(hardware, path)?, name)));
    for (config, axes) in pwms(machine, path)? {
        blocks.push(Box::new(PwmBlock::new(config, name, &axes)));
    }
    blocks.push(Box::new(SlidingModeBlock::new(name, &with_controller)));
    blocks.push(Box::new(
        ShaperBlock::new(motion_shaper(shapers)?, name, "motion").map_err(bench::failure)?,
    ));
    let cascade = CascadeConfig::new(CASCADE_WORD_BITS, CASCADE_DELAYS_SAMPLES.to_vec()).map_err(Failure::because)?;
    blocks.push(Box::new(CascadeBlock::new(cascade, name)));
    blocks.push(Box::new(SegmentsBlock::new(name, "alone")));
    blocks.push(Box::new(AxisBlock::new(name, "alone")));
    blocks.push(Box::new(DriveCommandBlock::new(name, "alone")));
    let trace = TraceConfig::new(TRACE_SAMPLES).map_err(Failure::because)?;
    blocks.push(Box::new(TraceBlock::new(trace, name)));
    blocks.push(Box::new(LinearScaleBlock::new(name, "alone")));
    blocks.push(Box::new(EncoderGeneratorBlock::new(name, "alone")));
    blocks.push(Box::new(ExcitationBlock::new(name, "alone")));
    for part in parts(machine, hardware, path)? {
        blocks.push(Box::new(PartBlock::new(part, name)));
    }
    let mut maps: Vec<&RegisterMap> = Vec::new();
    for map in components.iter().map(|component| component.component().map()) {
        if !maps.iter().any(|other| other.name() == map.name()) {
            maps.push(map);
        }
    }
    for map in maps {
        blocks.push(Box::new(RegistersBlock::new(map.clone(), name)));
    }
    for component in components {
        blocks.push(Box::new(component));
    }
    Ok(blocks)
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

/// The small blocks that connect others, at the machine's sizes where these do not depend on a stage.
fn parts(machine: &Machine, hardware: &Hardware<'_>, path: &Path) -> Result<[SmallPart; 6], Failure> {
    let first = hardware.axes().iter().find_map(|axis| axis.control.as_ref());
    let axes = machine.axes.len().clamp(1, MOST_AXES);
    Ok([
        SmallPart::TimeBase(divider(hardware, path)?),
        SmallPart::Schedule(ScheduleConfig::new(SCHEDULE_CLOCKS).map_err(Failure::because)?),
        SmallPart::DividerShare(axes),
        SmallPart::Group(axes),
        SmallPart::SampleSelect {
            word_bits: *MOTION_WORD_BITS.end(),
            channels: MOTION.channels as usize,
        },
        SmallPart::SettingBanks(first.map_or_else(Default::default, |control| control.derived.settings)),
    ])
}

/// The distinct PWMs of the machine, each with the names of its axes; a default one where no axis has any.
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

/// Names of the axes for which `has` is true, or `alone` where there are none.
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

/// The divider for the machine's tick.
fn divider(hardware: &Hardware<'_>, path: &Path) -> Result<DividerConfig, Failure> {
    hardware.divider().map_err(|error| of_hardware(&error, path))
}

/// A motion shaper with the first axis's table, at the smallest size that holds it.
fn motion_shaper(shapers: &[AxisShaper]) -> Result<ShaperConfig, Failure> {
    let Some(first) = shapers.first() else {
        return Err(Failure::from(miette::miette!("the machine has no axis")));
    };
    let bits = first.config.word_bits().max(*MOTION_WORD_BITS.start());
    let plain = ShaperConfig::new(bits, first.config.table().clone()).map_err(Failure::because)?;
    let all_channels = plain.clone().for_motion(MOTION);
    let config = all_channels.or_else(|_| plain.for_motion(ShaperMotion { channels: 1, ..MOTION }));
    config.map_err(Failure::because)
}
