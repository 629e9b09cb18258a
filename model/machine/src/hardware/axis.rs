//! The hardware of one axis: its shaper, the gains of its loop, its components.

use super::{HardwareError, PERIOD_KEY, SAMPLE_KEY, SHAPER_KEY, TimedLoop, pwm_config, pwm_mode};
use crate::control::{
    ControlSchedule, Derived, NoTravel, TableBounds, gains, loop_lag_s, no_travel, schedule_delay_s, supervision,
};
use crate::machine_file::{AxisSection, Machine, PwmMode};
use crate::plan::{AxisTables, TableFamily};
use posicast_blocks::axis_shaper::AxisShaperConfig;
use posicast_blocks::cascade::pass_clocks;
use posicast_blocks::component::{Component, ComponentError};
use posicast_blocks::divider::DividerConfig;
use posicast_blocks::shaper::{ShaperConfig, ShaperConfigError, ShaperMotion};
use posicast_blocks::stage::Supervision;
use posicast_shaper::design::Findings;

/// The tap table of an axis, and its table family where the modes of the axis move.
type Tables<'a> = (&'a AxisTables, Option<&'a TableFamily>);

/// The hardware of an axis.
#[derive(Debug, Clone)]
pub struct AxisHardware {
    /// The shaper in the machine's top module; the error gives the reason if it cannot be built or run at the sample rate.
    pub shaper: Result<AxisShaperConfig, HardwareError>,
    /// Its loop; `None` where it has no controller.
    pub control: Option<AxisLoop>,
}

/// The loop of an axis with a controller.
#[derive(Debug, Clone)]
pub struct AxisLoop {
    /// Lag of the loop, from the position to the drive's response, in s.
    pub lag_s: f64,
    /// The gains, with the figures derived from them.
    pub derived: Derived,
    /// The words of the axis's supervisor.
    pub supervision: Supervision,
    /// Whether the PWM has no pattern for a negative command.
    pub is_one_sided: bool,
    /// Whether only the position is shaped, and not velocity and acceleration.
    pub is_one_channel: bool,
    /// Set if the file does not state the travel of the axis.
    pub no_travel: Option<NoTravel>,
}

/// A component, and the axis that it belongs to.
#[derive(Debug, Clone)]
pub struct AxisComponent {
    /// Index of the axis, from 0.
    pub axis: usize,
    /// The block behind its own registers.
    pub component: Component,
}

impl AxisHardware {
    /// Decides the hardware of an axis. `of_stage` has lag and gains where the axis is part of a stage.
    pub(super) fn of(
        machine: &Machine,
        index: usize,
        axis: &AxisSection,
        tables: Tables<'_>,
        of_stage: Option<TimedLoop>,
    ) -> Result<Self, HardwareError> {
        let shaper = shaper(machine, index, axis, tables);
        let taps = shaper.as_ref().ok().and_then(AxisShaperConfig::taps);
        let control = control(machine, index, axis, tables, taps, of_stage)?;
        Ok(Self { shaper, control })
    }

    /// Makes the components of the axis.
    pub(super) fn components(
        &self,
        axis: &AxisSection,
        machine: &Machine,
        divider: impl Fn() -> Result<DividerConfig, HardwareError>,
    ) -> Result<Vec<Component>, HardwareError> {
        let refused = |error: ComponentError| {
            let key = match &error {
                ComponentError::Tick(_) => SAMPLE_KEY,
                ComponentError::Period(_) => PERIOD_KEY,
                _ => "axis",
            };
            HardwareError::new(0, key, error)
        };
        let top = self.shaper.as_ref().map_err(Clone::clone)?;
        let top = top.taps().map(|top| Component::shaper(component_shaper(axis, top)));
        let mut components: Vec<Component> = top.transpose().map_err(refused)?.into_iter().collect();
        // An absolute encoder is read by the stage alone.
        if let Some(encoder) = axis.encoder.as_ref().filter(|encoder| encoder.absolute.is_none()) {
            let divider = divider()?;
            components.push(Component::pulse_counter(divider, encoder.filter_clocks, encoder.invert).map_err(refused)?);
        }
        if let Some(pwm) = &axis.pwm {
            let config = pwm_config(pwm, &machine.clock).map_err(|error| HardwareError::new(0, "axis.pwm", error))?;
            let period_clocks = pwm.period_clocks(&machine.clock);
            components.push(Component::pwm(config, pwm_mode(pwm.mode), period_clocks).map_err(refused)?);
        }
        if let Some(control) = &self.control {
            let (settings, law) = (&control.derived.settings, control.derived.law);
            components.push(Component::sliding_mode(settings, law, axis.modulo).map_err(refused)?);
        }
        Ok(components)
    }
}

/// Creates the shaper of an axis in the machine's top module. The error gives the reason if it cannot be built, or
/// cannot run at the sample rate.
fn shaper(
    machine: &Machine,
    index: usize,
    axis: &AxisSection,
    tables: Tables<'_>,
) -> Result<AxisShaperConfig, HardwareError> {
    let unfit = |key: &str, reason: String| HardwareError::new(index, key, format!("axis `{}`: {reason}", axis.name));
    if let Findings::HalfSums(delays_s) = &tables.0.design.findings {
        return cascade_of(machine, delays_s).map_err(|(key, reason)| unfit(key, reason));
    }
    let plain = of_axis(machine.fixed_point.command_bits, tables);
    // Both need the motion shaper: the position of a modulo axis wraps, and a family hands over while the axis moves.
    let motion = ShaperMotion {
        channels: 1,
        modulo: axis.modulo,
    };
    let config = if axis.modulo || axis.family.is_some() {
        plain.and_then(|config| config.for_motion(motion))
    } else {
        plain
    };
    let config = config.map_err(|error| unfit("axis.shaper", error.to_string()))?;
    let available = machine.clock.clocks_per_sample();
    config
        .fits(u64::from(available))
        .map_err(|error| unfit(SAMPLE_KEY, error.to_string()))?;
    let Some(schedule) = schedule(axis, &config) else {
        return Ok(AxisShaperConfig::Taps(config));
    };
    schedule.fits(available).map_err(|error| {
        let step_clocks = pwm_step_clocks(machine);
        let largest_hz = schedule.largest_sample_hz(machine.clock.frequency_hz, step_clocks);
        unfit(SAMPLE_KEY, format!("{error}; allowed: up to {largest_hz} Hz"))
    })?;
    Ok(AxisShaperConfig::Taps(config))
}

/// The cascade of half sums with these delays. The error has the key to blame, and the reason.
fn cascade_of(machine: &Machine, delays_s: &[f64]) -> Result<AxisShaperConfig, (&'static str, String)> {
    let config = super::cascade::config(machine, delays_s).map_err(|error| (SHAPER_KEY, error.to_string()))?;
    let (needed, available) = (pass_clocks(config.stages()), machine.clock.clocks_per_sample());
    if needed > available {
        let reason = format!(
            "a sample takes {needed} clocks with {} half sums, but there are {available}: lower the sample rate or raise the clock",
            config.stages()
        );
        return Err((SAMPLE_KEY, reason));
    }
    Ok(AxisShaperConfig::Cascade(config))
}

/// A plain shaper with room for all tables of an axis.
///
/// # Errors
/// [`ShaperConfigError`] where the shaper exceeds the sizes of the hardware.
pub(super) fn of_axis(word_bits: u32, (own, family): Tables<'_>) -> Result<ShaperConfig, ShaperConfigError> {
    let plain = ShaperConfig::new(word_bits, own.table.clone())?;
    match family {
        Some(family) => plain.with_room_for(family.longest_delay_samples(), family.most_taps()),
        None => Ok(plain),
    }
}

/// The shaper of an axis as a component. With a controller it also shapes velocity and acceleration, and can change
/// its table while the axis moves, as far as words and ring buffer allow.
fn component_shaper(axis: &AxisSection, top: &ShaperConfig) -> ShaperConfig {
    if axis.controller.is_none() {
        return top.clone();
    }
    let channels = |channels| {
        let motion = ShaperMotion {
            channels,
            modulo: axis.modulo,
        };
        top.clone().for_motion(motion)
    };
    channels(3).or_else(|_| channels(1)).unwrap_or_else(|_| top.clone())
}

/// Returns the times of the axis's blocks within a tick; `None` if its position is not measured, since there is no
/// deadline then.
fn schedule(axis: &AxisSection, top: &ShaperConfig) -> Option<ControlSchedule> {
    let shaper = component_shaper(axis, top);
    match (&axis.controller, &axis.encoder) {
        (Some(_), _) => Some(ControlSchedule::controlling(shaper.pass_clocks(shaper.most_products()))),
        (None, Some(_)) => Some(ControlSchedule::measuring()),
        (None, None) => None,
    }
}

/// The loop of an axis with a controller, with the lag and the gains of the stage, or else of its components.
fn control(
    machine: &Machine,
    index: usize,
    axis: &AxisSection,
    tables: Tables<'_>,
    top: Option<&ShaperConfig>,
    of_stage: Option<TimedLoop>,
) -> Result<Option<AxisLoop>, HardwareError> {
    let (Some(drive), Some(pwm), Some(_)) = (&axis.drive, &axis.pwm, &axis.controller) else {
        return Ok(None);
    };
    let component = top.map(|top| component_shaper(axis, top));
    let (lag_s, derived) = match of_stage {
        Some(TimedLoop { lag_s, derived }) => (lag_s, derived),
        None => {
            // A shaper that cannot be built counts as 0 clocks.
            let shape_clocks = component.as_ref().map_or(0, |c| c.pass_clocks(c.most_products()));
            let schedule = ControlSchedule::controlling(shape_clocks);
            let lag_s = loop_lag_s(drive, schedule_delay_s(&machine.clock, pwm, schedule.clocks()));
            let derived =
                gains(axis, machine.clock, lag_s).map_err(|error| HardwareError::new(index, &error.key(), &error))?;
            (lag_s, derived)
        }
    };
    let (own, family) = tables;
    let bounds = TableBounds::of_axis(&own.table, family);
    let supervision = supervision(axis, &machine.clock, bounds)
        .map_err(|error| HardwareError::new(index, error.key(), &error).with_help(error.remedy()))?;
    Ok(Some(AxisLoop {
        lag_s,
        derived,
        supervision,
        is_one_sided: pwm.mode == PwmMode::HalfBridge,
        is_one_channel: component.is_some_and(|shaper| shaper.channels() == 1),
        no_travel: no_travel(axis),
    }))
}

/// Returns the clocks that a sample must be a multiple of, so that it holds a whole number of periods of every axis's
/// PWM.
fn pwm_step_clocks(machine: &Machine) -> u64 {
    let periods = machine.axes.iter().filter_map(|axis| axis.pwm.as_ref());
    let periods = periods.map(|pwm| u64::from(pwm.period_clocks(&machine.clock)).max(1));
    // Each period divides the sample, which has at most a million clocks, and so does their least common multiple.
    periods.fold(1, |common, period| common / common_divisor(common, period) * period)
}

fn common_divisor(a: u64, b: u64) -> u64 {
    match b {
        0 => a,
        _ => common_divisor(b, a % b),
    }
}
