//! Every hardware block at one size, for the rungs of the verification ladder that take each block once.
//!
//! The rows are those of `posicast verify` for a machine of two complete axes: the shapers in their top, each block
//! alone, the blocks that connect others, each component through its bus, its register bank alone, and three stages. Sizes
//! are those of the example stage where they matter for coverage; the whole stages have short ticks, so that a run
//! contains many.
//!
//! The kinds of blocks are those of the registry; a test of the command line checks that it contains every name of
//! `verify`.

use posicast_blocks::absolute_encoder::{
    AbsoluteEncoderConfig, AbsoluteFrame, AbsoluteLimits, AbsoluteProtocol, AbsoluteTimes, FrameCheck,
};
use posicast_blocks::axis_shaper::AxisShaperConfig;
use posicast_blocks::bus_component::BridgedBus;
use posicast_blocks::component::Component;
use posicast_blocks::divider::DividerConfig;
use posicast_blocks::linear_scale::ScaleRatio;
use posicast_blocks::pwm::{ActiveLow, BridgeMode, PwmConfig};
use posicast_blocks::segments::POSITION_FRACTION;
use posicast_blocks::shaper::ShaperConfig;
use posicast_blocks::sliding_mode::{Law, Settings};
use posicast_blocks::stage::Supervision;
use posicast_blocks::stage::{
    Follower, StageAbsolute, StageAxis, StageCapture, StageCompare, StageConfig, StageErrorTable, StageLoop,
    StageProbe, StageScale,
};
use posicast_blocks::step_generator::{StepGeneratorConfig, StepLinesActiveLow, StepMode, StepTimes};
use posicast_blocks::trace::TraceConfig;
use posicast_hdl::machine::AxisShaper;

use super::{BenchSizes, Block, benches};
use crate::Error;
use crate::bus_component::BusComponentBlock;
use crate::component::ComponentBlock;
use crate::error_table::ErrorTableBlock;
use crate::formal::refused;
use crate::shaper::MachineShapers;
use crate::shaper::{MOTION, tap_table};

/// Clocks per tick of the blocks that have ticks.
const TICK_CLOCKS: u64 = 5000;
/// Clocks of a PWM period in the components.
const PERIOD_CLOCKS: u32 = 2500;
/// Clocks of a PWM period in the stage.
const STAGE_PERIOD_CLOCKS: u32 = 80;
/// Smallest dead time and minimum pulse that a host can set, in clocks.
const FLOORS_CLOCKS: [u64; 2] = [25, 50];

/// Returns every block once, in the order of `posicast verify`.
///
/// # Errors
/// [`Error::Option`] if a size is refused, which would be a fault of this file.
pub fn library() -> Result<Vec<Box<dyn Block>>, Error> {
    let axis = |axis: &str, delays| -> Result<AxisShaper, Error> {
        Ok(AxisShaper {
            axis: axis.to_owned(),
            config: AxisShaperConfig::Taps(shaper(delays)?),
        })
    };
    let shapers = vec![axis("x", [38, 39, 77, 78])?, axis("y", [31, 32, 63, 64])?];
    let mut blocks: Vec<Box<dyn Block>> = vec![Box::new(MachineShapers::new("machine", shapers, Vec::new())?)];
    blocks.extend(benches(&library_sizes()?)?);
    Ok(blocks)
}

/// Returns the blocks of the library that have one of these names, or all of them without names.
///
/// # Errors
/// [`Error::Option`] for a name that no block has; as [`library`].
pub fn library_named(names: &[String]) -> Result<Vec<Box<dyn Block>>, Error> {
    let mut blocks = library()?;
    let is_known = |name: &&String| blocks.iter().any(|block| block.name() == *name);
    if let Some(unknown) = names.iter().find(|name| !is_known(name)) {
        return Err(Error::Option(format!("there is no block `{unknown}`")));
    }
    if !names.is_empty() {
        blocks.retain(|block| names.iter().any(|name| name == block.name()));
    }
    Ok(blocks)
}

/// The sizes of the library.
///
/// # Errors
/// As [`library`].
pub fn library_sizes() -> Result<BenchSizes, Error> {
    let [dead_time, minimum_pulse] = FLOORS_CLOCKS;
    let pwm = PwmConfig::new(ActiveLow::default(), dead_time, minimum_pulse).map_err(refused)?;
    let tick = DividerConfig::new(TICK_CLOCKS).map_err(refused)?;
    let motion = shaper([38, 39, 77, 78])?.for_motion(MOTION).map_err(refused)?;
    let components = [
        Component::shaper(motion.clone()),
        Component::pulse_counter(tick, 8, false),
        Component::pwm(pwm, BridgeMode::HalfBridge, PERIOD_CLOCKS),
        Component::sliding_mode(&Settings::default(), Law::SlidingMode, false),
    ];
    let component = |component: Component| {
        let top = format!("{}_avalon", component.name());
        ComponentBlock::new(component, &top, "alone")
    };
    let components = components.map(|made| made.map(component).map_err(refused));
    let counter = Component::pulse_counter(tick, 8, false).map_err(refused)?;
    let on_bus = |bus: BridgedBus| {
        let names = [
            format!("{}_{}", counter.name(), bus.suffix()),
            format!("{}_inner", counter.name()),
        ];
        BusComponentBlock::new(counter.clone(), bus, &[], [&names[0], &names[1], ""])
    };
    let alone = "alone".to_owned();
    Ok(BenchSizes {
        prefix: String::new(),
        with_encoder: alone.clone(),
        with_controller: alone.clone(),
        tick,
        pwms: vec![(pwm, alone)],
        motion,
        axes: 2,
        settings: Settings::default(),
        components: components.into_iter().collect::<Result<_, _>>()?,
        buses: vec![
            on_bus(BridgedBus::AxiLite),
            on_bus(BridgedBus::Wishbone { pipelined: true }),
        ],
        stages: vec![stage()?, stage_with_steps()?, stage_with_absolute_encoders()?],
        inline: Some(crate::inline_shaper::example()?),
    })
}

/// Three impulses with two taps each, except the first: ZVD, as in the example stage.
fn shaper(delays: [u32; 4]) -> Result<ShaperConfig, Error> {
    let coefficients = [25431, 12000, 18787, 4000, 5318];
    let taps: Vec<(u32, i32)> = std::iter::once(0).chain(delays).zip(coefficients).collect();
    ShaperConfig::new(32, tap_table(16, &taps)?).map_err(refused)
}

/// Both edges, a few clocks long.
const CAPTURE: StageCapture = StageCapture {
    filter_clocks: 3,
    rises: true,
    falls: true,
};

/// Positions near where the axes of the tests move.
const COMPARE: StageCompare = StageCompare {
    first: -20,
    spacing: 4,
    positions: 12,
    rises: true,
    falls: true,
    hysteresis: 1,
    pulse_clocks: 3,
};

/// Two axes: one with trace memory and test signals, one that is controlled by a linear scale.
pub(crate) fn stage() -> Result<StageConfig, Error> {
    let x = StageAxis {
        error_table: Some(StageErrorTable {
            table: ErrorTableBlock::of_size(9, 6)?,
            on_measured: false,
        }),
        bring_up: Some(TraceConfig::new(256).map_err(refused)?),
        ..looped("x", None)?
    };
    let y = StageAxis {
        scale: Some(StageScale {
            ratio: ScaleRatio::new(1000.0, 2000.0).map_err(refused)?,
            closes_loop: true,
            invert: false,
        }),
        ..looped("y", None)?
    };
    with_shortest_tick(vec![x, y], None)
}

/// Two axes whose positions come over BiSS-C and over SSI; a line captures both.
pub(crate) fn stage_with_absolute_encoders() -> Result<StageConfig, Error> {
    let limits = AbsoluteLimits {
        largest_jump: 200,
        tolerated: 2,
    };
    let times = |pause_clocks, answer_clocks| AbsoluteTimes {
        half_period_clocks: 4,
        pause_clocks,
        answer_clocks,
    };
    let gray = AbsoluteFrame {
        gray: true,
        check: FrameCheck::EvenParity,
        ..AbsoluteFrame::ssi(14)
    };
    let encoder = |protocol, frame, times| -> Result<Option<StageAbsolute>, Error> {
        let encoder = AbsoluteEncoderConfig::new(protocol, frame, times, limits).map_err(refused)?;
        Ok(Some(StageAbsolute { encoder, offset: 100 }))
    };
    let biss = encoder(AbsoluteProtocol::BissC, AbsoluteFrame::biss_c(16), times(64, 48))?;
    let ssi = encoder(AbsoluteProtocol::Ssi, gray, times(32, 0))?;
    with_shortest_tick(vec![looped("x", biss)?, looped("y", ssi)?], Some(CAPTURE))
}

/// An axis with a controller, and with this absolute encoder if there is one.
fn looped(name: &str, absolute: Option<StageAbsolute>) -> Result<StageAxis, Error> {
    Ok(StageAxis {
        name: name.to_owned(),
        shaper: shaper([2, 3, 5, 6])?.for_motion(MOTION).map_err(refused)?,
        modulo: false,
        follower: Follower::Loop(Box::new(StageLoop {
            settings: Settings::default(),
            law: Law::SlidingMode,
            pwm: PwmConfig::new(ActiveLow::default(), 2, 3).map_err(refused)?,
            pwm_mode: BridgeMode::Unipolar,
            pwm_period_clocks: STAGE_PERIOD_CLOCKS,
            encoder_filter_clocks: 2,
            encoder_invert: false,
            absolute,
        })),
        supervision: SUPERVISION,
        probe: None,
        corrects: false,
        compare: None,
        scale: None,
        error_table: None,
        bring_up: None,
    })
}

/// A stage of axes with controllers, whose tick is the shortest that is long enough for the schedule, in whole periods of the PWM.
fn with_shortest_tick(axes: Vec<StageAxis>, capture: Option<StageCapture>) -> Result<StageConfig, Error> {
    let mut stage = StageConfig {
        tick: DividerConfig::new(TICK_CLOCKS).map_err(refused)?,
        axes,
        capture,
        machine_crc: None,
    };
    let periods = stage.timing().duty_clocks() / STAGE_PERIOD_CLOCKS + 1;
    stage.tick = DividerConfig::new(u64::from(periods * STAGE_PERIOD_CLOCKS)).map_err(refused)?;
    Ok(stage)
}

/// Three axes with steps, one for each mode of the lines: with trace memory; with a linear scale that watches the steps and shows
/// which to correct; and with a probe, a position compare, and lines that are active low.
/// A line captures the positions of all of them.
pub(crate) fn stage_with_steps() -> Result<StageConfig, Error> {
    let times = StepTimes {
        pulse_clocks: 5,
        space_clocks: 6,
        direction_setup_clocks: 7,
        direction_hold_clocks: 4,
    };
    let axis = |name: &str, mode: StepMode, tick_clocks: u64| -> Result<StageAxis, Error> {
        let steps = StepGeneratorConfig::new(tick_clocks, POSITION_FRACTION, mode, times, 24).map_err(refused)?;
        Ok(StageAxis {
            name: name.to_owned(),
            shaper: shaper([2, 3, 5, 6])?.for_motion(MOTION).map_err(refused)?,
            modulo: false,
            follower: Follower::Steps(steps),
            supervision: SUPERVISION,
            probe: None,
            corrects: false,
            compare: None,
            scale: None,
            error_table: None,
            bring_up: None,
        })
    };
    let with_ticks = |tick_clocks: u64| -> Result<StageConfig, Error> {
        let x = StageAxis {
            bring_up: Some(TraceConfig::new(256).map_err(refused)?),
            ..axis("x", StepMode::StepDirection, tick_clocks)?
        };
        let y = StageAxis {
            scale: Some(StageScale {
                ratio: ScaleRatio::new(1000.0, 2000.0).map_err(refused)?,
                closes_loop: false,
                invert: false,
            }),
            corrects: true,
            supervision: Supervision {
                deviation_limit: 20,
                deviation_ticks: 3,
                ..SUPERVISION
            },
            ..axis("y", StepMode::UpDown, tick_clocks)?
        };
        let mut z = axis("z", StepMode::Quadrature, tick_clocks)?;
        z.compare = Some(COMPARE);
        z.probe = Some(StageProbe {
            active_low: true,
            filter_clocks: 3,
        });
        if let Follower::Steps(steps) = &mut z.follower {
            *steps = steps.active_low(StepLinesActiveLow { a: true, b: false });
        }
        Ok(StageConfig {
            tick: DividerConfig::new(tick_clocks).map_err(refused)?,
            axes: vec![x, y, z],
            capture: Some(CAPTURE),
            machine_crc: None,
        })
    };
    let schedule = with_ticks(TICK_CLOCKS)?.timing().duty_clocks();
    with_ticks(u64::from(schedule) + 1)
}

/// Short delays, so that brake, limits and monitors act within a short run.
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
    deviation_ticks: 0,
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
