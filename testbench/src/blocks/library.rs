//! Every hardware block at one size: what the rungs of the verification ladder go through that take each block once.
//!
//! The rows are those of `posicast verify` for a machine of two complete axes: the shapers in their top, each block alone, the
//! blocks that join others, each component through its bus, its register bank alone, and a stage. Sizes are those of the
//! example stage where they matter for what is reached; the whole stage has short ticks, so that a run sees many.
//!
//! A new kind of block is a line here; a test of the command line insists that every name of `verify` is among them.

use posicast_hdl::machine::AxisShaper;
use posicast_model::control::Supervision;
use posicast_model::rtl::cascade::CascadeConfig;
use posicast_model::rtl::component::Component;
use posicast_model::rtl::divider::DividerConfig;
use posicast_model::rtl::linear_scale::ScaleRatio;
use posicast_model::rtl::pwm::{ActiveLow, BridgeMode, PwmConfig};
use posicast_model::rtl::schedule::ScheduleConfig;
use posicast_model::rtl::shaper::{ShaperConfig, ShaperMotion};
use posicast_model::rtl::sliding_mode::{Law, Settings};
use posicast_model::rtl::stage::{StageAxis, StageConfig, StageErrorTable, StageScale};
use posicast_model::rtl::trace::TraceConfig;
use posicast_model::taps::{Tap, TapTable};

use super::{
    AxisBlock, Block, CascadeBlock, ComponentBlock, DividerBlock, DriveCommandBlock, EncoderGeneratorBlock,
    ErrorTableBlock, ExcitationBlock, LinearScaleBlock, MachineShapers, PartBlock, PulseCounterBlock, PwmBlock,
    RegistersBlock, SegmentsBlock, ShaperBlock, SlidingModeBlock, SmallPart, StageBlock, TraceBlock,
};
use crate::Error;

/// Clocks per tick of the blocks that have one.
const TICK_CLOCKS: u64 = 5000;
/// Clocks of a PWM period in the components.
const PERIOD_CLOCKS: u32 = 2500;
/// Clocks of a PWM period in the stage.
const STAGE_PERIOD_CLOCKS: u32 = 80;
/// Position, velocity and acceleration.
const MOTION: ShaperMotion = ShaperMotion {
    channels: 3,
    modulo: false,
};
/// Dead time and minimum pulse that a host cannot go below, in clocks.
const FLOORS_CLOCKS: [u64; 2] = [25, 50];

/// Every block once, in the order of `posicast verify`.
///
/// # Errors
/// [`Error::Option`] where a size is refused: one of this file's, so a fault of the project.
pub fn library() -> Result<Vec<Box<dyn Block>>, Error> {
    let [dead_time, minimum_pulse] = FLOORS_CLOCKS;
    let pwm = PwmConfig::new(ActiveLow::default(), dead_time, minimum_pulse).map_err(refused)?;
    let tick = DividerConfig::new(TICK_CLOCKS).map_err(refused)?;
    let axis = |axis: &str, delays| -> Result<AxisShaper, Error> {
        Ok(AxisShaper {
            axis: axis.to_owned(),
            config: shaper(delays)?,
        })
    };
    let shapers = vec![axis("x", [38, 39, 77, 78])?, axis("y", [31, 32, 63, 64])?];
    let motion = shaper([38, 39, 77, 78])?.for_motion(MOTION).map_err(refused)?;
    let cascade = CascadeConfig::new(32, vec![26, 31, 38, 62]).map_err(refused)?;
    let trace = TraceConfig::new(1024).map_err(refused)?;
    let mut blocks: Vec<Box<dyn Block>> = vec![
        Box::new(MachineShapers::new("machine", shapers, Vec::new())?),
        Box::new(PulseCounterBlock::new("", "alone")),
        Box::new(DividerBlock::new(tick, "")),
        Box::new(PwmBlock::new(pwm, "", "alone")),
        Box::new(SlidingModeBlock::new("", "alone")),
        Box::new(ShaperBlock::new(motion.clone(), "", "motion")?),
        Box::new(CascadeBlock::new(cascade, "")),
        Box::new(SegmentsBlock::new("", "alone")),
        Box::new(AxisBlock::new("", "alone")),
        Box::new(DriveCommandBlock::new("", "alone")),
        Box::new(TraceBlock::new(trace, "")),
        Box::new(LinearScaleBlock::new("", "alone")),
        Box::new(ErrorTableBlock::new(ErrorTableBlock::of_size(9, 6)?, "", "9 entries")),
        Box::new(EncoderGeneratorBlock::new("", "alone")),
        Box::new(ExcitationBlock::new("", "alone")),
    ];
    let parts = [
        SmallPart::TimeBase(tick),
        SmallPart::Schedule(ScheduleConfig::new(500).map_err(refused)?),
        SmallPart::DividerShare(2),
        SmallPart::Group(2),
        SmallPart::SampleSelect {
            word_bits: 32,
            channels: 3,
        },
        SmallPart::SettingBanks(Settings::default()),
    ];
    blocks.extend(parts.map(|part| Box::new(PartBlock::new(part, "")) as Box<dyn Block>));
    let components = [
        Component::shaper(motion.clone()),
        Component::pulse_counter(tick, 8, false),
        Component::pwm(pwm, BridgeMode::HalfBridge, PERIOD_CLOCKS),
        Component::sliding_mode(&Settings::default(), Law::SlidingMode, false),
    ];
    for component in components {
        let component = component.map_err(refused)?;
        blocks.push(Box::new(RegistersBlock::new(component.map().clone(), component.name())));
        let top = format!("{}_avalon", component.name());
        blocks.push(Box::new(ComponentBlock::new(component, &top, "alone")));
    }
    blocks.push(Box::new(StageBlock::new(&stage()?, "stage").map_err(refused)?));
    Ok(blocks)
}

fn refused(error: impl std::fmt::Display) -> Error {
    Error::Option(format!("the library's sizes: {error}"))
}

/// Three impulses, two taps each but the first: ZVD, in the manner of the example stage.
fn shaper(delays: [u32; 4]) -> Result<ShaperConfig, Error> {
    let coefficients = [25431, 12000, 18787, 4000, 5318];
    let delays = std::iter::once(0).chain(delays);
    let taps = delays.zip(coefficients).map(|(delay_samples, coefficient)| Tap {
        delay_samples,
        coefficient,
    });
    let table = TapTable::new(16, taps.collect()).map_err(refused)?;
    ShaperConfig::new(32, table).map_err(refused)
}

/// Two axes: one with trace memory, test signals and an error table, one whose loop is on a linear scale.
pub(crate) fn stage() -> Result<StageConfig, Error> {
    let axis = |name: &str| -> Result<StageAxis, Error> {
        Ok(StageAxis {
            name: name.to_owned(),
            shaper: shaper([2, 3, 5, 6])?.for_motion(MOTION).map_err(refused)?,
            settings: Settings::default(),
            law: Law::SlidingMode,
            modulo: false,
            pwm: PwmConfig::new(ActiveLow::default(), 2, 3).map_err(refused)?,
            pwm_mode: BridgeMode::Unipolar,
            pwm_period_clocks: STAGE_PERIOD_CLOCKS,
            encoder_filter_clocks: 2,
            encoder_invert: false,
            supervision: SUPERVISION,
            scale: None,
            error_table: None,
            bring_up: None,
        })
    };
    let x = StageAxis {
        error_table: Some(StageErrorTable {
            table: ErrorTableBlock::of_size(9, 6)?,
            on_measured: false,
        }),
        bring_up: Some(TraceConfig::new(256).map_err(refused)?),
        ..axis("x")?
    };
    let y = StageAxis {
        scale: Some(StageScale {
            ratio: ScaleRatio::new(1000.0, 2000.0).map_err(refused)?,
            closes_loop: true,
            invert: false,
        }),
        ..axis("y")?
    };
    let mut stage = StageConfig {
        tick: DividerConfig::new(TICK_CLOCKS).map_err(refused)?,
        axes: vec![x, y],
    };
    // The shortest tick that holds the schedule, in whole periods.
    let periods = stage.timing().duty_clocks() / STAGE_PERIOD_CLOCKS + 1;
    stage.tick = DividerConfig::new(u64::from(periods * STAGE_PERIOD_CLOCKS)).map_err(refused)?;
    Ok(stage)
}

/// Short delays, so that brake, limits and watches are met in a short run.
const SUPERVISION: Supervision = Supervision {
    off_causes: 0x00ff,
    brake_release_ticks: 1,
    brake_apply_ticks: 1,
    settle_ticks: 8,
    soft_limit_plus: 0,
    soft_limit_minus: 0,
    limits_after_homing: true,
    following_error_limit: 0,
    deviation_limit: 0,
    saturation_ticks: 3,
    lost_command: 50 << 12,
    lost_ticks: 3,
    watches_direction: true,
    watchdog_ticks: 0,
    filter_clocks: 3,
    stop_deceleration: 0,
    direct_limit: 30,
    direct_hold_ticks: 2,
    excitation_limit: 256,
};
