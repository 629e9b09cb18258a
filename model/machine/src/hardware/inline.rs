//! The inline shaper of a machine whose commands come as step pulses.

use super::axis::of_axis;
use super::stage::trace;
use super::{HardwareError, NAME_KEY, SAMPLE_KEY};
use crate::machine_file::{AxisSection, BeyondLimits, ClockSection, InputSection, Machine, StepsSection};
use crate::plan::MachineDesign;
use posicast_blocks::component::Component;
use posicast_blocks::divider::DividerConfig;
use posicast_blocks::inline_axis::{INLINE_FRACTION, InlineAxisConfig, MOST_TICK_STEPS};
use posicast_blocks::inline_shaper::{INLINE_MOTION, InlineConfig, InlineError, InlineShaper, InlineShaperAxis};
use posicast_blocks::step_generator::StepGeneratorConfig;
use posicast_taps::TapTable;

/// Width of a position in bits.
const WORD_BITS: u32 = 32;
/// Ticks after the longest delay in which the last step comes out.
const LAST_TICKS: u64 = 1;
/// Key of the inputs' choice what to do beyond the limits, and of the velocity.
const VELOCITY_KEY: &str = "axis.limits.velocity";
const SHAPER_KEY: &str = "axis.shaper";

/// An inline shaper, with the figures of its axes.
#[derive(Debug, Clone, PartialEq)]
pub struct InlineHardware {
    /// The blocks, joined, without registers.
    pub shaper: InlineShaper,
    /// The same behind registers, if the machine file has a `[link]`: then this is what is built.
    pub component: Option<Component>,
    /// The figures of each axis.
    pub axes: Vec<InlineFigures>,
}

/// Figures of an axis of an inline shaper, for those who set a controller up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InlineFigures {
    /// Largest rate of the command that does not stop the axis, in steps per second.
    pub input_hz: f64,
    /// Largest rate of the drive's lines, in steps per second.
    pub output_hz: f64,
    /// Largest speed of the output over that of the input, Σ|c| / 2^F: 1 with positive taps.
    pub overshoot: f64,
    /// Delay of an even speed without shaping, in s.
    pub unshaped_s: f64,
    /// Delay of an even speed with shaping, in s.
    pub shaped_s: f64,
    /// Time from the last step of the command until the axis is settled, at most, in s.
    pub settle_s: f64,
}

/// The inline shaper of a machine; `None` if its commands do not come as step pulses.
///
/// # Errors
/// [`HardwareError`] with the key to blame.
pub(super) fn inline(machine: &Machine, design: &MachineDesign) -> Result<Option<InlineHardware>, HardwareError> {
    if machine.axes.iter().all(|axis| axis.input.is_none()) {
        return Ok(None);
    }
    let clock = &machine.clock;
    let tick_clocks = u64::from(clock.clocks_per_sample());
    let tick = DividerConfig::new(tick_clocks).map_err(|error| HardwareError::new(0, SAMPLE_KEY, error))?;
    let mut axes = Vec::new();
    for (index, (axis, tables)) in machine.axes.iter().zip(&design.axes).enumerate() {
        let (Some(input), Some(steps)) = (&axis.input, &axis.steps) else {
            // The reader of the machine file demands both on every axis.
            let reason = "an inline shaper needs [axis.input] and [axis.steps] on every axis";
            return Err(HardwareError::new(index, "axis.input", reason));
        };
        let shaper = of_axis(WORD_BITS, (tables, None)).and_then(|plain| plain.for_motion(INLINE_MOTION));
        let shaper = shaper.map_err(|error| HardwareError::new(index, SHAPER_KEY, error))?;
        let settle_ticks = u64::from(tables.table.longest_delay_samples()) + LAST_TICKS;
        let limit = limit_steps(axis, input, clock);
        let follower = InlineAxisConfig::new(limit, settle_ticks)
            .map_err(|error| HardwareError::new(index, SAMPLE_KEY, error))?
            .active_low(input.active_low);
        axes.push(InlineShaperAxis {
            name: axis.name.clone(),
            input: input.kind,
            filter_clocks: input.filter_clocks,
            follower,
            steps: lines(index, axis, (input, steps), &tables.table, clock)?,
            shaper,
            trace: trace(axis).map_err(|error| HardwareError::new(index, "axis.trace.samples", error))?,
        });
    }
    let config = InlineConfig { tick, axes };
    let shaper = InlineShaper::new(&config).map_err(|error| to_blame(&error))?;
    let component = machine
        .link
        .map(|link| Component::inline_shaper(&config, Some(link.machine_crc)));
    let component = component.transpose().map_err(|error| to_blame(&error))?;
    let built = match component {
        Some(_) => config.for_any_table(),
        None => config,
    };
    let figures = built.axes.iter().map(|axis| figures(&built, axis, clock)).collect();
    Ok(Some(InlineHardware {
        shaper,
        component,
        axes: figures,
    }))
}

fn to_blame(error: &InlineError) -> HardwareError {
    let key = match error {
        InlineError::Axes(_) => "axis",
        InlineError::Composition(_) | InlineError::Map(_) | InlineError::Component(_) => NAME_KEY,
        InlineError::Shaper { .. } => SHAPER_KEY,
        _ => SAMPLE_KEY,
    };
    HardwareError::new(0, key, error)
}

/// Largest number of steps of the input in a tick: those of the largest velocity, and one, because a tick may begin
/// just before a step.
fn limit_steps(axis: &AxisSection, input: &InputSection, clock: &ClockSection) -> u64 {
    let velocity = axis.limits.and_then(|limits| limits.velocity).unwrap_or(0.0);
    match input.beyond_limits {
        BeyondLimits::Pass => u64::from(MOST_TICK_STEPS),
        BeyondLimits::Stop => {
            let steps = velocity * axis.counts_per_unit / clock.sample_hz;
            ((steps * (1.0 + 1e-9)).floor() as u64 + 1).min(u64::from(MOST_TICK_STEPS))
        }
    }
}

/// Largest speed of a shaper's output over that of its input.
fn overshoot(table: &TapTable) -> f64 {
    let sum: f64 = table.taps().iter().map(|tap| f64::from(tap.coefficient.abs())).sum();
    sum / f64::from(1_u32 << table.coefficient_fraction())
}

/// The lines to the drive, checked: what the limit lets in must come out, with the overshoot of negative taps.
fn lines(
    index: usize,
    axis: &AxisSection,
    (input, steps): (&InputSection, &StepsSection),
    table: &TapTable,
    clock: &ClockSection,
) -> Result<StepGeneratorConfig, HardwareError> {
    let generator = steps.generator(clock, INLINE_FRACTION);
    let generator = generator.map_err(|error| HardwareError::new(index, "axis.steps", error))?;
    let overshoot = overshoot(table);
    let wanted = match input.beyond_limits {
        BeyondLimits::Stop => limit_steps(axis, input, clock) as f64,
        BeyondLimits::Pass => {
            let velocity = axis.limits.and_then(|limits| limits.velocity).unwrap_or(0.0);
            velocity * axis.counts_per_unit / clock.sample_hz
        }
    };
    // Rounding adds one unit of the position where taps are negative.
    let rounding = if overshoot > 1.0 { 1.0 } else { 0.0 };
    let units = f64::from(1_u32 << INLINE_FRACTION);
    let largest = f64::from(generator.largest_difference());
    if (wanted * overshoot * units + rounding).ceil() > largest {
        let per_s = |steps: f64| (steps * clock.sample_hz).round();
        let reason = format!(
            "axis `{}`: {} steps/s at limits.velocity, a step per tick more, and {:.2} times that behind the shaper: the lines of the \
             drive give {} steps/s",
            axis.name,
            per_s(wanted - 1.0).max(0.0),
            overshoot,
            per_s(largest / units)
        );
        let help = "lower limits.velocity or the microsteps, shorten pulse_s and space_s of [axis.steps] as far as the drive's datasheet \
                    allows, or choose a shaper of positive impulses";
        return Err(HardwareError::new(index, VELOCITY_KEY, reason).with_help(help.to_owned()));
    }
    Ok(generator)
}

fn figures(config: &InlineConfig, axis: &InlineShaperAxis, clock: &ClockSection) -> InlineFigures {
    let table = axis.shaper.table();
    let unshaped_s = f64::from(config.unshaped_clocks(axis)) / clock.frequency_hz;
    let output_steps = f64::from(axis.steps.largest_difference()) / f64::from(1_u32 << INLINE_FRACTION);
    let limit = f64::from(axis.follower.limit_steps());
    let owed_clocks = axis.steps.reversal_steps() * axis.steps.period_clocks();
    InlineFigures {
        input_hz: limit.min(output_steps / overshoot(table)) * clock.sample_hz,
        output_hz: output_steps * clock.sample_hz,
        overshoot: overshoot(table),
        unshaped_s,
        shaped_s: unshaped_s + table.mean_delay_samples() / clock.sample_hz,
        settle_s: unshaped_s
            + f64::from(axis.follower.settle_ticks() + 1) / clock.sample_hz
            + owed_clocks as f64 / clock.frequency_hz,
    }
}
