//! The machine of the campaign: the example's XY stage, ten times as fast in ticks, with every monitor on.
//!
//! | | example | here | why |
//! |---|---|---|---|
//! | tick | 5000 clocks | 1000 clocks | a case is 300 ticks long |
//! | PWM | 20 kHz | 100 kHz | two periods per tick, as there |
//! | modes | 131 and 93 Hz | ten times that | the shaper's delay is about 50 ticks |
//! | acceleration, jerk | 8 m/s², 400 m/s³ | 800 m/s², 400,000 m/s³ | 300 counts in 150 ticks |
//! | scale | none | on both axes, compared with the motor | to test its trip |
//! | compare, capture | none | on both axes | to test them in every case |
//! | monitors | off | all | to test them |

use posicast_blocks::component::Component;
use posicast_machine::hardware::{self, MachineStage};
use posicast_machine::machine_file::{
    self, AxisSection, CaptureEdge, CaptureSection, CompareDirection, CompareSection, LimitsSection, Machine, Scale,
    ScaleUse,
};
use posicast_machine::plan::design_machine;
use posicast_machine::plant::axis::{AxisPlant, PlantOptions};

use super::CampaignError;
use super::absolute;
use super::kind::{FaultRow, TABLE};
use super::{positions, steps};
use crate::stage_bench::StageBench;
use posicast_testbench::lockstep::Device;

/// Machine file of the example.
const EXAMPLE: &str = include_str!("../../machines/xy-stage.toml");
const SAMPLE_HZ: f64 = 50_000.0;
const PWM_HZ: f64 = 100_000.0;
const FASTER: f64 = 10.0;

/// Clocks per tick.
pub const TICK_CLOCKS: u64 = 1000;
/// Number of clocks of the lines' filters; the encoder's filter is the example's, with as many.
pub(super) const FILTER_CLOCKS: u64 = 8;
/// Ticks from applying the brake until it holds.
pub(super) const BRAKE_APPLY_TICKS: u64 = 2;
/// Number of ticks without a count under a command after which the encoder counts as lost.
pub(super) const LOST_TICKS: u64 = 10;
/// Ticks for which an axis with steps may deviate from its scale.
pub(super) const STALL_TICKS: u64 = 9;
/// Number of consecutive ticks for which the command may be clamped.
pub(super) const SATURATION_TICKS: u64 = 8;
const BRAKE_RELEASE_TICKS: u64 = 2;
pub(super) const TICK_S: f64 = 1.0 / SAMPLE_HZ;

/// The stage under test: its machine and its configuration.
#[derive(Debug, Clone)]
pub struct Bed {
    /// The machine.
    pub machine: Machine,
    /// Its stage.
    pub stage: MachineStage,
    /// Its blocks and registers.
    pub component: Component,
    /// The kinds of faults that are injected.
    pub rows: Vec<FaultRow>,
}

impl Bed {
    /// Makes the machine described above.
    ///
    /// # Errors
    /// [`CampaignError::Machine`] if the example can no longer be changed to it.
    pub fn new() -> Result<Self, CampaignError> {
        Self::of(|_| {})
    }

    /// Makes the machine with a change of its axes.
    ///
    /// # Errors
    /// [`CampaignError::Machine`] if the result is not a valid machine.
    pub fn of(change: impl Fn(&mut AxisSection)) -> Result<Self, CampaignError> {
        let failed = |reason: String| CampaignError::Machine(reason);
        let mut machine = machine_file::parse("xy-stage.toml", EXAMPLE).map_err(|error| failed(error.to_string()))?;
        machine.clock.sample_hz = SAMPLE_HZ;
        machine.capture = Some(CaptureSection {
            edge: CaptureEdge::Both,
            filter_s: 0.0,
        });
        for axis in &mut machine.axes {
            for mode in &mut axis.modes {
                mode.mode.frequency_hz *= FASTER;
            }
            if let Some(pwm) = &mut axis.pwm {
                pwm.frequency_hz = PWM_HZ;
            }
            axis.scale = Some(Scale {
                counts_per_unit: axis.counts_per_unit,
                usage: ScaleUse::Monitor,
                invert: false,
            });
            axis.limits = Some(limits(axis.limits.unwrap_or_default()));
            axis.compare = Some(compare(axis.counts_per_unit));
            change(axis);
        }
        let design = design_machine(&machine).map_err(|error| failed(error.to_string()))?;
        let stage = hardware::stage(&machine, &design).map_err(|error| failed(error.to_string()))?;
        let stage = stage.ok_or_else(|| failed("it has an axis without a loop".to_owned()))?;
        let component = Component::stage(&stage.config).map_err(|error| failed(error.to_string()))?;
        Ok(Self {
            machine,
            stage,
            component,
            rows: TABLE.into_iter().chain(positions::rows::of_encoders()).collect(),
        })
    }

    /// Makes the same machine with step inputs in place of its loops, and the faults of such a machine.
    ///
    /// # Errors
    /// Those of [`Bed::of`].
    pub fn with_steps() -> Result<Self, CampaignError> {
        Ok(Self {
            rows: steps::rows(),
            ..Self::of(steps::change)?
        })
    }

    /// Makes the same machine with absolute encoders, and the faults of such a machine.
    ///
    /// # Errors
    /// Those of [`Bed::of`].
    pub fn with_absolute_encoders() -> Result<Self, CampaignError> {
        Ok(Self {
            rows: absolute::rows(),
            ..Self::of(absolute::change)?
        })
    }

    /// Clocks of the filter of an axis's encoder; 0 without one.
    pub(super) fn encoder_filter_clocks(&self, axis: usize) -> u64 {
        let encoder = self.machine.axes[axis].encoder.as_ref();
        encoder.map_or(0, |encoder| encoder.filter_clocks.into())
    }

    /// A bench at reset, with the RTL beside it if `device` has one.
    ///
    /// # Errors
    /// Those of [`StageBench::new`].
    pub fn bench(&self, device: Option<Box<dyn Device>>, seed: u64) -> Result<StageBench, CampaignError> {
        let plant = |axis| AxisPlant::new(axis, &self.machine.clock, &PlantOptions::default());
        let plants: Result<Vec<_>, _> = self.machine.axes.iter().map(plant).collect();
        let plants = plants.map_err(|error| CampaignError::Machine(error.to_string()))?;
        Ok(StageBench::new(
            &self.stage.config,
            &self.component,
            plants,
            device,
            seed,
        )?)
    }
}

/// A compare of which every case writes the words anew.
fn compare(counts_per_unit: f64) -> CompareSection {
    CompareSection {
        spacing: 10.0 / counts_per_unit,
        positions: 1,
        first: 0.0,
        direction: CompareDirection::Both,
        hysteresis: 0.0,
        pulse_s: 1e-6,
    }
}

/// Limits with every monitor on.
fn limits(of_example: LimitsSection) -> LimitsSection {
    LimitsSection {
        acceleration: Some(800.0),
        jerk: Some(400_000.0),
        travel: Some([-0.01, 0.01]),
        stop_deceleration: Some(800.0),
        following_error: Some(30e-6),
        deviation: Some(60e-6),
        saturation_s: SATURATION_TICKS as f64 * TICK_S,
        encoder_lost_s: LOST_TICKS as f64 * TICK_S,
        brake_release_s: BRAKE_RELEASE_TICKS as f64 * TICK_S,
        brake_apply_s: BRAKE_APPLY_TICKS as f64 * TICK_S,
        line_filter_s: FILTER_CLOCKS as f64 / 50e6,
        ..of_example
    }
}
