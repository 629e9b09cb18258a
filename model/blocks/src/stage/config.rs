//! Configuration of a stage.

use crate::absolute_encoder::AbsoluteEncoderConfig;
use crate::absolute_feedback::FEEDBACK_CLOCKS;
use crate::component::ComponentError;
use crate::composition::CompositionError;
use crate::divider::DividerConfig;
use crate::error_table::ErrorTableConfig;
use crate::group::MOST_AXES;
use crate::linear_scale::ScaleRatio;
use crate::pwm::{BridgeMode, PwmConfig};
use crate::registers::MapError;
use crate::schedule::{ScheduleConfig, ScheduleConfigError};
use crate::segments::POSITION_FRACTION;
use crate::shaper::ShaperConfig;
use crate::sliding_mode::{Law, Settings};
use crate::stage::Supervision;
use crate::step_generator::StepGeneratorConfig;
use crate::trace::TraceConfig;

use super::registers::AXIS_INTERRUPTS;
use super::schedule::StageSchedule;

/// A stage of one to four axes.
#[derive(Debug, Clone, PartialEq)]
pub struct StageConfig {
    /// Clocks per tick, for time base and divider.
    pub tick: DividerConfig,
    /// Its axes.
    pub axes: Vec<StageAxis>,
    /// The position capture of all axes, if there is one.
    pub capture: Option<StageCapture>,
    /// Contents of the register `MACHINE_CRC`, if it has one: the checksum of its machine file.
    pub machine_crc: Option<u32>,
}

/// The position capture of a stage: the settings after reset.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StageCapture {
    /// Clocks for which its line must have a new level.
    pub filter_clocks: u16,
    /// Whether a rising edge captures.
    pub rises: bool,
    /// Whether a falling one does.
    pub falls: bool,
}

/// One axis of a stage.
#[derive(Debug, Clone, PartialEq)]
pub struct StageAxis {
    /// Name of the axis, with which all its ports and registers begin.
    pub name: String,
    /// Its shaper, which has three channels.
    pub shaper: ShaperConfig,
    /// Whether it is a rotary axis, whose positions wrap.
    pub modulo: bool,
    /// What follows the shaped position.
    pub follower: Follower,
    /// Words of its supervisor.
    pub supervision: Supervision,
    /// The probe at which it is homed, in place of an index; only with steps.
    pub probe: Option<StageProbe>,
    /// Whether a host corrects missing steps by the scale; only with steps and a scale.
    pub corrects: bool,
    /// Its linear scale, if it has one.
    pub scale: Option<StageScale>,
    /// Its error table.
    pub error_table: Option<StageErrorTable>,
    /// Its position compare, if it has one.
    pub compare: Option<StageCompare>,
    /// Aids for bring-up, if it has them: trace memory, test signals, an internal encoder.
    pub bring_up: Option<TraceConfig>,
}

/// What makes an axis follow the shaped position.
#[derive(Debug, Clone, PartialEq)]
pub enum Follower {
    /// A controller, with an encoder and a PWM.
    Loop(Box<StageLoop>),
    /// The steps of a drive that has a loop of its own, or needs none.
    Steps(StepGeneratorConfig),
}

/// Controller, encoder and PWM of an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct StageLoop {
    /// The controller's settings after reset.
    pub settings: Settings,
    /// The controller's law after reset.
    pub law: Law,
    /// Build parameters of its PWM.
    pub pwm: PwmConfig,
    /// The PWM's mode.
    pub pwm_mode: BridgeMode,
    /// The PWM's period in clocks: 2 to 65,536, and a divisor of the tick.
    pub pwm_period_clocks: u32,
    /// Pulses of up to this many clocks on an encoder's line are ignored, 0 to 63.
    pub encoder_filter_clocks: u32,
    /// Whether the encoder's direction is reversed after reset.
    pub encoder_invert: bool,
    /// An absolute encoder in place of A, B and index.
    pub absolute: Option<StageAbsolute>,
}

/// The absolute encoder of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StageAbsolute {
    /// Protocol, frame, times and limits.
    pub encoder: AbsoluteEncoderConfig,
    /// Lowest 32 bits of the reading at which the axis is at 0, after reset.
    pub offset: u32,
}

impl StageAbsolute {
    /// Clocks from the tick to the position and velocity that belong to it, at the most.
    pub fn reading_clocks(&self) -> u32 {
        self.encoder.most_valid_clocks() as u32 + FEEDBACK_CLOCKS
    }
}

impl StageAxis {
    /// Its controller, encoder and PWM; `None` on an axis with steps.
    pub fn closed_loop(&self) -> Option<&StageLoop> {
        match &self.follower {
            Follower::Loop(of) => Some(of),
            Follower::Steps(_) => None,
        }
    }

    /// As [`StageAxis::closed_loop`], to change it.
    pub fn closed_loop_mut(&mut self) -> Option<&mut StageLoop> {
        match &mut self.follower {
            Follower::Loop(of) => Some(of),
            Follower::Steps(_) => None,
        }
    }

    /// Its absolute encoder, if it has one.
    pub fn absolute(&self) -> Option<&StageAbsolute> {
        self.closed_loop()?.absolute.as_ref()
    }

    /// Whether a deviation from its scale acts only once it has lasted.
    pub fn deviation_lasts(&self) -> bool {
        self.scale.is_some() && self.supervision.deviation_ticks > 0
    }

    /// Its step generator; `None` on an axis with a controller.
    pub fn steps(&self) -> Option<&StepGeneratorConfig> {
        match &self.follower {
            Follower::Loop(_) => None,
            Follower::Steps(config) => Some(config),
        }
    }
}

/// The probe of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StageProbe {
    /// Whether its line is low while it touches.
    pub active_low: bool,
    /// Pulses of up to this many clocks on its line are ignored, 0 to 63.
    pub filter_clocks: u32,
}

/// The linear scale of an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StageScale {
    /// Ratio between its counts and the motor's.
    pub ratio: ScaleRatio,
    /// Whether the loop runs on the scale; else the scale is only compared.
    pub closes_loop: bool,
    /// Whether its direction is reversed after reset.
    pub invert: bool,
}

/// The position compare of an axis: the settings after reset. Positions are counts since reset.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StageCompare {
    /// The lowest position of the row.
    pub first: i32,
    /// Distance of two positions in counts, at least 1.
    pub spacing: u32,
    /// Number of positions.
    pub positions: u32,
    /// Whether a position that is passed upward gives a pulse.
    pub rises: bool,
    /// Whether one that is passed downward does.
    pub falls: bool,
    /// Counts from the edge after which the same position may give the next pulse.
    pub hysteresis: u16,
    /// Width of a pulse in clocks, 1 to 2^24 − 1.
    pub pulse_clocks: u32,
}

/// The error table of an axis.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StageErrorTable {
    /// The machine's table.
    pub table: ErrorTableConfig,
    /// Whether the error is looked up at the measured position; otherwise at the reference.
    pub on_measured: bool,
}

/// Reason why a stage cannot be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StageError {
    /// The number of axes is 0 or too large.
    #[error("a stage has 1 to {MOST_AXES} axes, not {0}")]
    Axes(usize),
    /// An axis's shaper does not shape velocity and acceleration.
    #[error(
        "the shaper of axis {axis} has {channels} channels of {word_bits} bits: a stage shapes position, velocity and \
         acceleration in words of 32 bits; use command_bits = 32, and delays of at most 4094 samples"
    )]
    Channels {
        /// Index of the axis.
        axis: String,
        /// Number of channels.
        channels: usize,
        /// Width of a word in bits.
        word_bits: u32,
    },
    /// The computations of a tick take longer than a tick.
    #[error("a tick of {available} clocks is too short: {schedule}; choose a lower sample rate or a faster clock")]
    Schedule {
        /// The computations with their clocks.
        schedule: StageSchedule,
        /// Clocks of a tick.
        available: u32,
    },
    /// The PWM's period does not divide the tick.
    #[error(
        "the PWM of axis {axis} has {period} clocks per period, which do not divide a tick of {tick}; change one of them"
    )]
    Period {
        /// Index of the axis.
        axis: String,
        /// Clocks of the PWM's period.
        period: u32,
        /// Clocks of a tick.
        tick: u32,
    },
    /// The readings of an absolute encoder take longer than a tick.
    #[error(
        "the encoder of axis {axis} takes {clocks} clocks from one reading to the next, and a tick has {tick}: choose a lower \
         sample rate, or a faster line"
    )]
    Reading {
        /// Name of the axis.
        axis: String,
        /// Clocks of a reading and its pause.
        clocks: u64,
        /// Clocks of a tick.
        tick: u32,
    },
    /// A step generator is built for other ticks or positions than those of the stage.
    #[error(
        "the step generator of axis {axis} is built for ticks of {tick_clocks} clocks and positions with {fraction_bits} \
         fraction bits: a stage with ticks of {tick} clocks has positions with {POSITION_FRACTION}; set \
         fixed_point.command_fraction = {POSITION_FRACTION}"
    )]
    Steps {
        /// Name of the axis.
        axis: String,
        /// Clocks per tick of the step generator.
        tick_clocks: u32,
        /// Fraction bits of its position.
        fraction_bits: u32,
        /// Clocks of the stage's tick.
        tick: u32,
    },
    /// The schedule block cannot be built.
    #[error(transparent)]
    ScheduleBlock(#[from] ScheduleConfigError),
    /// The register map has an error: the name of an axis clashes with others.
    #[error("the registers of the stage clash, rename an axis: {0}")]
    Map(#[from] MapError),
    /// The wiring has an error.
    #[error("the ports of the stage clash, rename an axis: {0}")]
    Composition(#[from] CompositionError),
    /// The component has an error.
    #[error("the stage's component: {0}")]
    Component(#[from] ComponentError),
}

impl StageConfig {
    /// The timing within a tick.
    pub fn timing(&self) -> StageSchedule {
        let passes: Vec<(&ShaperConfig, u32)> = (self.axes.iter())
            .map(|axis| {
                let table = axis.error_table.as_ref();
                (&axis.shaper, table.map_or(0, |of| of.table.latency_clocks()))
            })
            .collect();
        let scaled = self
            .axes
            .iter()
            .any(|axis| axis.scale.is_some_and(|scale| scale.closes_loop));
        let controls = self.axes.iter().any(|axis| axis.closed_loop().is_some());
        let readings = self.axes.iter().filter_map(StageAxis::absolute);
        let reading_clocks = readings.map(StageAbsolute::reading_clocks).max().unwrap_or(0);
        StageSchedule::of(&passes, controls, scaled, reading_clocks)
    }

    /// Bit of the interrupt of an axis's position compare in the interrupt registers. A stage of four axes has none left.
    pub fn compare_interrupt_bit(&self, axis: usize) -> Option<u32> {
        let first = (MOST_AXES - 1) * AXIS_INTERRUPTS.len();
        let has_compare = self.axes.get(axis).is_some_and(|axis| axis.compare.is_some());
        (has_compare && self.axes.len() < MOST_AXES).then_some((first + axis) as u32)
    }

    pub(super) fn schedule(&self) -> Result<ScheduleConfig, StageError> {
        Ok(ScheduleConfig::new(self.timing().control_clocks())?)
    }

    pub(super) fn check(&self) -> Result<(), StageError> {
        if !(1..=MOST_AXES).contains(&self.axes.len()) {
            return Err(StageError::Axes(self.axes.len()));
        }
        let tick = self.tick.tick_clocks();
        for axis in &self.axes {
            if axis.shaper.channels() != 3 || axis.shaper.word_bits() != 32 {
                return Err(StageError::Channels {
                    axis: axis.name.clone(),
                    channels: axis.shaper.channels(),
                    word_bits: axis.shaper.word_bits(),
                });
            }
            match &axis.follower {
                Follower::Steps(config)
                    if (config.tick_clocks(), config.fraction_bits()) != (tick, POSITION_FRACTION) =>
                {
                    return Err(StageError::Steps {
                        axis: axis.name.clone(),
                        tick_clocks: config.tick_clocks(),
                        fraction_bits: config.fraction_bits(),
                        tick,
                    });
                }
                Follower::Loop(of)
                    if !(2..=65_536).contains(&of.pwm_period_clocks) || !tick.is_multiple_of(of.pwm_period_clocks) =>
                {
                    return Err(StageError::Period {
                        axis: axis.name.clone(),
                        period: of.pwm_period_clocks,
                        tick,
                    });
                }
                Follower::Steps(_) | Follower::Loop(_) => {}
            }
            if let Some(of) = axis.absolute()
                && of.encoder.least_tick_clocks() > u64::from(tick)
            {
                return Err(StageError::Reading {
                    axis: axis.name.clone(),
                    clocks: of.encoder.least_tick_clocks(),
                    tick,
                });
            }
        }
        let schedule = self.timing();
        if schedule.duty_clocks() < tick {
            Ok(())
        } else {
            Err(StageError::Schedule {
                schedule,
                available: tick,
            })
        }
    }
}
