//! The stage of a machine: converts the axes of its file to the configuration of the hardware.

use super::axis::of_axis;
use super::error_table;
use crate::control::{
    ControlError, Derived, SupervisionError, TableBounds, gains, loop_lag_s, schedule_delay_s, supervision,
};
use crate::machine_file::{AxisSection, ClockSection, Encoder, Machine, PwmMode, PwmSection, ScaleUse};
use crate::plan::{MachineDesign, TableFamily};
use posicast_blocks::divider::{DividerConfig, DividerConfigError};
use posicast_blocks::error_table::ErrorTableConfigError;
use posicast_blocks::linear_scale::{ScaleRatio, ScaleRatioError};
use posicast_blocks::pwm::{ActiveLow, BridgeMode, PwmConfig, PwmConfigError};
use posicast_blocks::shaper::{ShaperConfig, ShaperConfigError, ShaperMotion};
use posicast_blocks::stage::Supervision;
use posicast_blocks::stage::{StageAxis, StageConfig, StageErrorTable, StageScale, StageSchedule};
use posicast_blocks::trace::{TraceConfig, TraceConfigError};

/// A stage, with the figures derived for its axes.
#[derive(Debug, Clone, PartialEq)]
pub struct MachineStage {
    /// Configuration of the stage.
    pub config: StageConfig,
    /// Lag of each axis's loop in s, with the timing of the stage.
    pub lags_s: Vec<f64>,
    /// Gains of each axis's controller, with the figures derived from them.
    pub derived: Vec<Derived>,
    /// The table families of the axes whose modes move.
    pub families: Vec<TableFamily>,
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

/// The stage of a machine; `None` unless every axis has encoder, PWM, drive and controller.
///
/// # Errors
/// [`MachineStageError`], which has the key to blame.
pub fn stage(machine: &Machine, design: &MachineDesign) -> Result<Option<MachineStage>, MachineStageError> {
    let mut axes = Vec::new();
    for (index, (axis, tables)) in machine.axes.iter().zip(&design.axes).enumerate() {
        let (Some(encoder), Some(pwm), Some(_), Some(_)) = (&axis.encoder, &axis.pwm, &axis.drive, &axis.controller)
        else {
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
            pwm,
            encoder: *encoder,
            shaper: shaper.map_err(|error| MachineStageError::Shaper { axis: index, error })?,
            scale: scale(axis).map_err(|error| MachineStageError::Scale { axis: index, error })?,
            error_table: error_table::of_axis(axis)
                .map_err(|error| MachineStageError::ErrorTable { axis: index, error })?,
            bring_up: trace(axis).map_err(|error| MachineStageError::Trace { axis: index, error })?,
            supervision: watched.map_err(|error| MachineStageError::Supervision { axis: index, error })?,
            config: pwm_config(pwm, &machine.clock).map_err(|error| MachineStageError::Pwm { axis: index, error })?,
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
    let used_clocks = StageSchedule::of(&passes, on_scale).duty_clocks();
    let (mut lags_s, mut derived, mut built) = (Vec::new(), Vec::new(), Vec::new());
    for (index, parts) in axes.into_iter().enumerate() {
        let delay_s = schedule_delay_s(&machine.clock, parts.pwm, used_clocks);
        let lag_s = parts
            .axis
            .drive
            .as_ref()
            .map_or(delay_s, |drive| loop_lag_s(drive, delay_s));
        let gains = gains(parts.axis, machine.clock, lag_s)
            .map_err(|error| MachineStageError::Control { axis: index, error })?;
        lags_s.push(lag_s);
        built.push(parts.build(&gains, &machine.clock));
        derived.push(gains);
    }
    Ok(Some(MachineStage {
        config: StageConfig {
            tick,
            axes: built,
            machine_crc: machine.link.map(|link| link.machine_crc),
        },
        lags_s,
        derived,
        families: design.families.clone(),
    }))
}

struct Parts<'a> {
    axis: &'a AxisSection,
    pwm: &'a PwmSection,
    encoder: Encoder,
    shaper: ShaperConfig,
    supervision: Supervision,
    scale: Option<StageScale>,
    error_table: Option<StageErrorTable>,
    bring_up: Option<TraceConfig>,
    config: PwmConfig,
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

fn trace(axis: &AxisSection) -> Result<Option<TraceConfig>, TraceConfigError> {
    let samples = axis.trace.map(|trace| u64::from(trace.samples));
    samples.map(TraceConfig::new).transpose()
}

impl Parts<'_> {
    fn build(self, derived: &Derived, clock: &ClockSection) -> StageAxis {
        StageAxis {
            name: self.axis.name.clone(),
            shaper: self.shaper,
            settings: derived.settings,
            law: derived.law,
            modulo: self.axis.modulo,
            pwm: self.config,
            pwm_mode: pwm_mode(self.pwm.mode),
            pwm_period_clocks: self.pwm.period_clocks(clock),
            encoder_filter_clocks: self.encoder.filter_clocks,
            encoder_invert: self.encoder.invert,
            supervision: self.supervision,
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
