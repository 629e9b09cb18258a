//! The list of blocks that are measured: a new block is a new row here.

use posicast_hdl::emit::Module;
use posicast_hdl::{
    axis, cascade, component, divider, drive_command, encoder_generator, excitation, linear_scale, pulse_counter, pwm,
    registers, segments, shaper, sliding_mode, trace,
};
use posicast_model::design::design_machine;
use posicast_model::hardware;
use posicast_model::machine_file;
use posicast_model::rtl::cascade::CascadeConfig;
use posicast_model::rtl::component::Component;
use posicast_model::rtl::divider::DividerConfig;
use posicast_model::rtl::pwm::{ActiveLow, BridgeMode, PwmConfig};
use posicast_model::rtl::shaper::{ShaperConfig, ShaperMotion};
use posicast_model::rtl::sliding_mode::{Law, Settings};
use posicast_model::rtl::trace::TraceConfig;
use posicast_model::taps::{Tap, TapTable};
use std::error::Error;

/// Budget of a block, by section 12 of the hardware's specification.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Budget {
    pub(crate) luts: u64,
    pub(crate) flip_flops: u64,
}

/// A block at one size.
pub(crate) struct Row {
    /// Name of the block.
    pub(crate) block: &'static str,
    /// Its size, where it has several.
    pub(crate) size: &'static str,
    /// Its Verilog modules, the top last.
    pub(crate) modules: Vec<Module>,
    pub(crate) budget: Option<Budget>,
    /// Why it exceeds its budget; for a block that does not, what takes most of the area.
    pub(crate) note: &'static str,
}

/// All blocks, in the order of the table.
pub(crate) fn rows() -> Result<Vec<Row>, Box<dyn Error>> {
    Ok(vec![
        Row {
            block: "pulse_counter",
            size: "all features",
            modules: pulse_counter::emit("")?,
            budget: Some(Budget {
                luts: 450,
                flip_flops: 300,
            }),
            note: "13 flip-flops are for differential pairs (three more synchronisers, a filter); they disappear if \
                   `differential` is tied low. A third of the LUTs is the one-pole filter.",
        },
        Row {
            block: "divider",
            size: "5000 clocks per tick",
            modules: divider::emit(&DividerConfig::new(5000)?, "")?,
            budget: Some(Budget {
                luts: 200,
                flip_flops: 150,
            }),
            note: "The 35-bit register and the remainder select between two or three sources.",
        },
        Row {
            block: "pwm",
            size: "all modes",
            modules: pwm::emit(&PwmConfig::new(ActiveLow::default(), 25, 50)?, "")?,
            budget: Some(Budget {
                luts: 300,
                flip_flops: 220,
            }),
            note: "One adder of 19 bits computes duty, limits and edges in turn; with its operand selection it takes \
                   161 LUT. 97 LUT compare positions with period, phase and trigger. The rest is fault path, leg and \
                   times.",
        },
        Row {
            block: "sliding_mode",
            size: "all laws",
            modules: sliding_mode::emit("")?,
            budget: None,
            note: "",
        },
        Row {
            block: "segments",
            size: "64 entries",
            modules: segments::emit("")?,
            budget: None,
            note: "",
        },
        Row {
            block: "axis",
            size: "",
            modules: axis::emit("")?,
            budget: None,
            note: "Words of 32 bits are compared byte by byte, one after the other: two soft limits, and three \
                   magnitudes with their limits.",
        },
        Row {
            block: "drive_command",
            size: "nothing tied",
            modules: drive_command::emit("")?,
            budget: None,
            note: "Two counters and two results belong to the self-test.",
        },
        Row {
            block: "linear_scale",
            size: "nothing tied",
            modules: linear_scale::emit("")?,
            budget: None,
            note: "With the machine's constants tied, it takes 269 LE with the loop on the scale, and 194 as a monitor. \
                   It has six registers of 32 bits.",
        },
        Row {
            block: "trace",
            size: "1024 samples",
            modules: trace::emit(&TraceConfig::new(1024)?, "")?,
            budget: None,
            note: "320 LUT select one of 16 signals of 32 bits; signals that are tied disappear.",
        },
        Row {
            block: "encoder_generator",
            size: "",
            modules: encoder_generator::emit("")?,
            budget: None,
            note: "Most of it is the sum of 64 bits; if `generated_count` is not used, a synthesiser keeps 34 of them.",
        },
        Row {
            block: "excitation",
            size: "",
            modules: excitation::emit("")?,
            budget: None,
            note: "The references of velocity and acceleration are 64 registers without logic. Without these, and with \
                   `amplitude_limit` and `modulo` tied, it takes 333 LE.",
        },
        Row {
            block: "shaper",
            size: "plain, 32 bits, ring 128",
            modules: shaper::emit(&shaper()?, "")?,
            budget: None,
            note: "",
        },
        Row {
            block: "shaper",
            size: "motion, 3 channels, 32 bits, ring 128",
            modules: shaper::emit(&shaper()?.for_motion(MOTION)?, "")?,
            budget: None,
            note: "",
        },
        cascade(16, 2, 62, "16 bits, 2 stages, ring 64")?,
        cascade(32, 4, 62, "32 bits, 4 stages, ring 64")?,
        cascade(32, 10, 62, "32 bits, 10 stages, ring 64")?,
        cascade(32, 5, 1000, "32 bits, 5 stages, ring 1024")?,
        bank(
            "of shaper, 3 channels",
            &Component::shaper(shaper()?.for_motion(MOTION)?)?,
        )?,
        bank(
            "of pulse_counter",
            &Component::pulse_counter(DividerConfig::new(5000)?, 8, false)?,
        )?,
        bank(
            "of pwm",
            &Component::pwm(
                PwmConfig::new(ActiveLow::default(), 25, 50)?,
                BridgeMode::HalfBridge,
                2500,
            )?,
        )?,
        bank(
            "of sliding_mode",
            &Component::sliding_mode(&Settings::default(), Law::SlidingMode, false)?,
        )?,
        stage("XY, whole", "")?,
        stage("XY, traces of 256 samples", "[axis.trace]\nsamples = 256\n\n")?,
    ])
}

/// The name of the stage's row.
pub(crate) const STAGE: &str = "stage";

/// The stage of the example machine, flattened: inputs that are tied by the machine file are folded. `traces` is
/// inserted before the controller of each axis.
fn stage(size: &'static str, traces: &str) -> Result<Row, Box<dyn Error>> {
    let controller = "[axis.controller]";
    let file = include_str!("../../../examples/xy-stage.toml").replace(controller, &format!("{traces}{controller}"));
    let machine = machine_file::parse("xy-stage.toml", &file)?;
    let stage = hardware::stage(&machine, &design_machine(&machine)?)?.ok_or("the example has no stage")?;
    Ok(Row {
        block: STAGE,
        size,
        modules: component::emit(&Component::stage(&stage.config)?, "xy_stage", "xy")?,
        budget: None,
        note: "",
    })
}

fn bank(size: &'static str, component: &Component) -> Result<Row, Box<dyn Error>> {
    Ok(Row {
        block: "registers",
        size,
        modules: vec![registers::emit(component.map(), "")?],
        budget: None,
        note: "",
    })
}

fn cascade(word_bits: u32, stages: usize, delay_samples: u32, size: &'static str) -> Result<Row, Box<dyn Error>> {
    let config = CascadeConfig::new(word_bits, vec![delay_samples; stages])?;
    Ok(Row {
        block: "cascade",
        size,
        modules: cascade::emit(&config, "")?,
        budget: None,
        note: "",
    })
}

/// Channels of an axis: position, velocity and acceleration.
const MOTION: ShaperMotion = ShaperMotion {
    channels: 3,
    modulo: false,
};

/// A shaper with six taps: ZVD digitised with two taps per impulse, 79 samples long.
fn shaper() -> Result<ShaperConfig, Box<dyn Error>> {
    let taps = [(0, 25431), (38, 12000), (39, 18787), (77, 4000), (78, 5317), (79, 1)];
    let tap = |(delay_samples, coefficient)| Tap {
        delay_samples,
        coefficient,
    };
    let table = TapTable::new(16, taps.map(tap).to_vec())?;
    Ok(ShaperConfig::new(32, table)?)
}
