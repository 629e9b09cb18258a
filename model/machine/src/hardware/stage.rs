//! The stage of a machine: converts the axes of its file to the configuration of the hardware.

use super::axis::of_axis;
use super::error_table;
use crate::control::{
    ControlError, Derived, SupervisionError, TableBounds, gains, loop_lag_s, schedule_delay_s, supervision,
};
use crate::machine_file::{
    AxisSection, CaptureEdge, ClockSection, CompareDirection, CompareSection, Encoder, Machine, PwmMode, PwmSection,
    ScaleUse,
};
use crate::plan::{MachineDesign, TableFamily};
use posicast_blocks::absolute_encoder::AbsoluteEncoderConfigError;
use posicast_blocks::divider::{DividerConfig, DividerConfigError};
use posicast_blocks::error_table::ErrorTableConfigError;
use posicast_blocks::linear_scale::{ScaleRatio, ScaleRatioError};
use posicast_blocks::pwm::{ActiveLow, BridgeMode, PwmConfig, PwmConfigError};
use posicast_blocks::segments::POSITION_FRACTION;
use posicast_blocks::shaper::{ShaperConfig, ShaperConfigError, ShaperMotion};
use posicast_blocks::sliding_mode::{Law, Settings};
use posicast_blocks::stage::Supervision;
use posicast_blocks::stage::{
    Follower, StageAbsolute, StageAxis, StageCapture, StageCompare, StageConfig, StageErrorTable, StageLoop,
    StageProbe, StageScale, StageSchedule,
};
use posicast_blocks::step_generator::{StepGeneratorConfig, StepGeneratorConfigError};
use posicast_blocks::trace::{TraceConfig, TraceConfigError};

/// A stage, with the figures derived for its axes.
#[derive(Debug, Clone, PartialEq)]
pub struct MachineStage {
    /// Configuration of the stage.
    pub config: StageConfig,
    /// The loop of each axis; `None` on an axis with steps.
    pub loops: Vec<Option<TimedLoop>>,
    /// The table families of the axes whose modes move.
    pub families: Vec<TableFamily>,
}

/// The loop of an axis in the timing of its stage.
#[derive(Debug, Clone, PartialEq)]
pub struct TimedLoop {
    /// Lag of the loop in s.
    pub lag_s: f64,
    /// Gains of the controller, with the figures derived from them.
    pub derived: Derived,
}

impl MachineStage {
    /// Returns the index of the axis whose name clashes with another one's: the first axis that makes the stage `builds` if it is renamed.
    pub fn clashing_axis(&self, builds: impl Fn(&StageConfig) -> bool) -> usize {
        let renamed = |axis: &usize| {
            let mut config = self.config.clone();
            config.axes[*axis].name = "posicast".to_owned();
            builds(&config)
        };
        (0..self.config.axes.len()).find(renamed).unwrap_or(0)
    }
}

/// Why a machine has no stage. `axis` counts from 0.
#[derive(Debug, thiserror::Error)]
pub enum MachineStageError {
    /// The tick has a length that its divider does not support.
    #[error(transparent)]
    Tick(#[from] DividerConfigError),
    /// The shaper of an axis cannot be built.
    #[error("axis {axis}: {error}; a stage shapes position, velocity and acceleration")]
    Shaper {
        /// Index of the axis, from 0.
        axis: usize,
        /// The reason.
        error: ShaperConfigError,
    },
    /// The PWM of an axis cannot be built.
    #[error("{error}")]
    Pwm {
        /// Index of the axis, from 0.
        axis: usize,
        /// The reason.
        error: PwmConfigError,
    },
    /// The absolute encoder of an axis cannot be read.
    #[error("axis {axis}: {error}")]
    Encoder {
        /// Index of the axis, from 0.
        axis: usize,
        /// The reason.
        error: AbsoluteEncoderConfigError,
    },
    /// The step generator of an axis cannot be built.
    #[error("axis {axis}: {error}")]
    Steps {
        /// Index of the axis, from 0.
        axis: usize,
        /// The reason.
        error: StepGeneratorConfigError,
    },
    /// The scale of an axis has a ratio that cannot be built.
    #[error("axis {axis}: {error}")]
    Scale {
        /// Index of the axis, from 0.
        axis: usize,
        /// The reason.
        error: ScaleRatioError,
    },
    /// An error table.
    #[error("axis {axis}: {error}")]
    ErrorTable {
        /// Index of the axis, from 0.
        axis: usize,
        /// The reason.
        error: ErrorTableConfigError,
    },
    /// A trace memory.
    #[error("axis {axis}: {error}")]
    Trace {
        /// Index of the axis, from 0.
        axis: usize,
        /// The reason.
        error: TraceConfigError,
    },
    /// The controller of an axis has no valid gains.
    #[error("{error}")]
    Control {
        /// Index of the axis, from 0.
        axis: usize,
        /// The reason.
        error: ControlError,
    },
    /// The limits of an axis do not fit its supervisor.
    #[error("{error}")]
    Supervision {
        /// Index of the axis, from 0.
        axis: usize,
        /// The reason.
        error: SupervisionError,
    },
}

impl MachineStageError {
    /// Axis, from 0, and key of the machine file that cause the error.
    pub fn key(&self) -> (usize, String) {
        match self {
            Self::Tick(_) => (0, "clock.sample_hz".to_owned()),
            Self::Shaper { axis, .. } => (*axis, "axis.shaper".to_owned()),
            Self::Pwm { axis, .. } => (*axis, "axis.pwm".to_owned()),
            Self::Encoder { axis, .. } => (*axis, "axis.encoder".to_owned()),
            Self::Steps { axis, .. } => (*axis, "axis.steps".to_owned()),
            Self::Scale { axis, .. } => (*axis, "axis.scale.counts_per_unit".to_owned()),
            Self::ErrorTable { axis, .. } => (*axis, "axis.error_table.file".to_owned()),
            Self::Trace { axis, .. } => (*axis, "axis.trace.samples".to_owned()),
            Self::Control { axis, error } => (*axis, error.key()),
            Self::Supervision { axis, error } => (*axis, error.key().to_owned()),
        }
    }

    /// Remedy, if the text does not contain it.
    pub fn remedy(&self) -> Option<String> {
        match self {
            Self::Supervision { error, .. } => Some(error.remedy()),
            _ => None,
        }
    }
}

/// The stage of a machine; `None` unless every axis has encoder, PWM, drive and controller, or steps.
///
/// # Errors
/// [`MachineStageError`], which has the key to blame.
pub fn stage(machine: &Machine, design: &MachineDesign) -> Result<Option<MachineStage>, MachineStageError> {
    let mut axes = Vec::new();
    for (index, (axis, tables)) in machine.axes.iter().zip(&design.axes).enumerate() {
        let Some(follows) = Follows::of(index, axis, &machine.clock)? else {
            return Ok(None);
        };
        let motion = ShaperMotion {
            channels: 3,
            modulo: axis.modulo,
        };
        let family = design.family_of(index);
        let shaper = of_axis(machine.fixed_point.command_bits, (tables, family));
        let shaper = shaper.and_then(|plain| plain.for_motion(motion));
        let watched = supervision(axis, &machine.clock, TableBounds::of_axis(&tables.table, family));
        axes.push(Parts {
            axis,
            follows,
            shaper: shaper.map_err(|error| MachineStageError::Shaper { axis: index, error })?,
            scale: scale(axis).map_err(|error| MachineStageError::Scale { axis: index, error })?,
            error_table: error_table::of_axis(axis)
                .map_err(|error| MachineStageError::ErrorTable { axis: index, error })?,
            bring_up: trace(axis).map_err(|error| MachineStageError::Trace { axis: index, error })?,
            supervision: watched.map_err(|error| MachineStageError::Supervision { axis: index, error })?,
        });
    }
    let tick = DividerConfig::new(u64::from(machine.clock.clocks_per_sample()))?;
    let passes: Vec<(&ShaperConfig, u32)> = (axes.iter())
        .map(|parts| {
            let table = parts.error_table.as_ref();
            (&parts.shaper, table.map_or(0, |of| of.table.latency_clocks()))
        })
        .collect();
    let on_scale = axes
        .iter()
        .any(|parts| parts.scale.is_some_and(|scale| scale.closes_loop));
    let controls = axes.iter().any(|parts| matches!(parts.follows, Follows::Loop { .. }));
    let readings = axes.iter().filter_map(|parts| parts.follows.absolute());
    let reading_clocks = readings.map(StageAbsolute::reading_clocks).max().unwrap_or(0);
    let used_clocks = StageSchedule::of(&passes, controls, on_scale, reading_clocks).duty_clocks();
    let (mut loops, mut built) = (Vec::new(), Vec::new());
    for (index, parts) in axes.into_iter().enumerate() {
        let timed = timed_loop(&parts, machine, used_clocks)
            .map_err(|error| MachineStageError::Control { axis: index, error })?;
        built.push(parts.build(timed.as_ref(), &machine.clock));
        loops.push(timed);
    }
    Ok(Some(MachineStage {
        config: StageConfig {
            tick,
            axes: built,
            capture: machine.capture.map(|capture| StageCapture {
                filter_clocks: capture.filter_clocks(&machine.clock),
                rises: capture.edge != CaptureEdge::Falling,
                falls: capture.edge != CaptureEdge::Rising,
            }),
            machine_crc: machine.link.map(|link| link.machine_crc),
        },
        loops,
        families: design.families.clone(),
    }))
}

/// What is to follow the shaped position, before its gains are known.
enum Follows<'a> {
    Loop {
        pwm: &'a PwmSection,
        encoder: Encoder,
        absolute: Option<StageAbsolute>,
        config: PwmConfig,
    },
    Steps(StepGeneratorConfig),
}

impl<'a> Follows<'a> {
    /// Returns `None` where the axis has neither a complete loop nor steps.
    fn of(index: usize, axis: &'a AxisSection, clock: &ClockSection) -> Result<Option<Self>, MachineStageError> {
        if let Some(steps) = &axis.steps {
            let config = steps.generator(clock, POSITION_FRACTION);
            let config = config.map_err(|error| MachineStageError::Steps { axis: index, error })?;
            return Ok(Some(Self::Steps(config)));
        }
        let (Some(encoder), Some(pwm), Some(_), Some(_)) = (&axis.encoder, &axis.pwm, &axis.drive, &axis.controller)
        else {
            return Ok(None);
        };
        let absolute = absolute(axis, encoder, clock);
        Ok(Some(Self::Loop {
            pwm,
            encoder: *encoder,
            absolute: absolute.map_err(|error| MachineStageError::Encoder { axis: index, error })?,
            config: pwm_config(pwm, clock).map_err(|error| MachineStageError::Pwm { axis: index, error })?,
        }))
    }

    fn absolute(&self) -> Option<&StageAbsolute> {
        match self {
            Self::Loop { absolute, .. } => absolute.as_ref(),
            Self::Steps(_) => None,
        }
    }
}

/// The hardware of an absolute encoder, if the axis has one. The machine file's check makes sure that there is a largest velocity.
fn absolute(
    axis: &AxisSection,
    encoder: &Encoder,
    clock: &ClockSection,
) -> Result<Option<StageAbsolute>, AbsoluteEncoderConfigError> {
    let Some(section) = &encoder.absolute else {
        return Ok(None);
    };
    let velocity = axis.limits.and_then(|limits| limits.velocity).unwrap_or_default();
    Ok(Some(StageAbsolute {
        encoder: section.hardware(clock, velocity * axis.counts_per_unit)?,
        offset: section.offset,
    }))
}

/// The loop of an axis, with gains for its lag; `None` on an axis with steps.
fn timed_loop(parts: &Parts<'_>, machine: &Machine, used_clocks: u32) -> Result<Option<TimedLoop>, ControlError> {
    let Follows::Loop { pwm, .. } = &parts.follows else {
        return Ok(None);
    };
    let delay_s = schedule_delay_s(&machine.clock, pwm, used_clocks);
    let drive = parts.axis.drive.as_ref();
    let lag_s = drive.map_or(delay_s, |drive| loop_lag_s(drive, delay_s));
    let derived = gains(parts.axis, machine.clock, lag_s)?;
    Ok(Some(TimedLoop { lag_s, derived }))
}

struct Parts<'a> {
    axis: &'a AxisSection,
    follows: Follows<'a>,
    shaper: ShaperConfig,
    supervision: Supervision,
    scale: Option<StageScale>,
    error_table: Option<StageErrorTable>,
    bring_up: Option<TraceConfig>,
}

fn scale(axis: &AxisSection) -> Result<Option<StageScale>, ScaleRatioError> {
    let Some(scale) = &axis.scale else {
        return Ok(None);
    };
    let closes_loop = scale.usage == ScaleUse::Position;
    let ratio = if closes_loop {
        ScaleRatio::new
    } else {
        ScaleRatio::for_monitor
    };
    let [motor, of_scale] =
        [axis.counts_per_unit, scale.counts_per_unit].map(|counts| axis.unit.counts_in_file(counts));
    let ratio = ratio(motor, of_scale)?;
    Ok(Some(StageScale {
        ratio,
        closes_loop,
        invert: scale.invert,
    }))
}

/// The hardware of `[axis.compare]`. The machine file's check makes sure that its positions are counts.
fn stage_compare(axis: &AxisSection, compare: &CompareSection, clock: &ClockSection) -> StageCompare {
    let counts = |length: f64| (length * axis.counts_per_unit).round();
    StageCompare {
        first: counts(compare.first) as i32,
        spacing: counts(compare.spacing).max(1.0) as u32,
        positions: compare.positions,
        rises: compare.direction != CompareDirection::Down,
        falls: compare.direction != CompareDirection::Up,
        hysteresis: compare.hysteresis_counts(axis.counts_per_unit),
        pulse_clocks: compare.pulse_clocks(clock),
    }
}

/// The memory of `[axis.trace]`.
pub(super) fn trace(axis: &AxisSection) -> Result<Option<TraceConfig>, TraceConfigError> {
    let samples = axis.trace.map(|trace| u64::from(trace.samples));
    samples.map(TraceConfig::new).transpose()
}

impl Parts<'_> {
    fn build(self, timed: Option<&TimedLoop>, clock: &ClockSection) -> StageAxis {
        let follower = match self.follows {
            Follows::Steps(config) => Follower::Steps(config),
            Follows::Loop {
                pwm,
                encoder,
                absolute,
                config,
            } => Follower::Loop(Box::new(StageLoop {
                settings: timed.map_or_else(Settings::default, |timed| timed.derived.settings),
                law: timed.map_or(Law::SlidingMode, |timed| timed.derived.law),
                pwm: config,
                pwm_mode: pwm_mode(pwm.mode),
                pwm_period_clocks: pwm.period_clocks(clock),
                encoder_filter_clocks: encoder.filter_clocks,
                encoder_invert: encoder.invert,
                absolute,
            })),
        };
        StageAxis {
            name: self.axis.name.clone(),
            shaper: self.shaper,
            modulo: self.axis.modulo,
            follower,
            supervision: self.supervision,
            probe: self.axis.probe.map(|probe| StageProbe {
                active_low: probe.active_low,
                filter_clocks: probe.filter_clocks(clock),
            }),
            corrects: self.axis.correction.is_some(),
            compare: self
                .axis
                .compare
                .map(|compare| stage_compare(self.axis, &compare, clock)),
            scale: self.scale,
            error_table: self.error_table,
            bring_up: self.bring_up,
        }
    }
}

/// The register value of a PWM mode.
pub fn pwm_mode(mode: PwmMode) -> BridgeMode {
    match mode {
        PwmMode::Direction => BridgeMode::Direction,
        PwmMode::HalfBridge => BridgeMode::HalfBridge,
        PwmMode::FullBridge => BridgeMode::Unipolar,
        PwmMode::LockedAntiphase => BridgeMode::Locked,
    }
}

/// Build parameters of an axis's PWM: all pins have one polarity, and the times of the file are the least that a
/// register accepts.
///
/// # Errors
/// [`PwmConfigError`] for a dead time or minimum pulse of more than 1023 clocks.
pub fn pwm_config(pwm: &PwmSection, clock: &ClockSection) -> Result<PwmConfig, PwmConfigError> {
    let low = pwm.active_low;
    let active_low = ActiveLow {
        a_high: low,
        a_low: low,
        b_high: low,
        b_low: low,
    };
    // The hardware has at least one clock of each.
    let floor = |clocks: u32| u64::from(clocks.max(1));
    PwmConfig::new(
        active_low,
        floor(pwm.dead_time_clocks(clock)),
        floor(pwm.minimum_pulse_clocks(clock)),
    )
}
