//! The stage: one to four axes behind one Avalon-MM agent, from motion segments to the pins and back, without
//! software.
//!
//! ```text
//!            registers ── window 0: the stage; window 1 …: an axis each
//!                │
//! tick ─► time_base, schedule, divider, divider_share, group          one of each
//!                │
//!  per axis: segments ─► shaper ─► sliding_mode ─► drive_command ─► pwm ─► gates      with [axis.steps]: step_generator ─► lines
//!                │                  ▲  ▲
//!            axis (supervisor)      │  pulse_counter ◄─ encoder        with [axis.scale]: pulse_counter, linear_scale
//!                              setting_banks                           with [axis.trace]: trace, excitation, encoder_generator
//!                                                                      with an absolute encoder: absolute_encoder, absolute_feedback
//! ```
//!
//! A stage is a [`Component`]: blocks joined by names, from which the model here and the Verilog in
//! `posicast_hdl::component` are made. Inputs that the machine file fixes are tied to constants; what a host may want
//! to change while the machine runs is in registers, with the machine's values after reset.
//!
//! This folder contains only wiring: `axis` joins the blocks of an axis, `registers` defines what a host sees. The
//! datasheet is `docs/stage.md`.

mod absolute;
mod axis;
mod axis_settings;
mod axis_words;
mod bring_up;
mod capture;
mod compare;
mod config;
mod error_table;
mod registers;
mod schedule;
mod steps;
mod supervision;

pub use self::config::{
    Follower, StageAbsolute, StageAxis, StageCapture, StageCompare, StageConfig, StageError, StageErrorTable,
    StageLoop, StageProbe, StageScale,
};
pub use self::registers::{AXIS_INTERRUPTS, axis_interrupt_bit, axis_window};
pub(crate) use self::registers::{axis_register, driven_and_read};
pub use self::schedule::StageSchedule;
pub use self::supervision::Supervision;

use self::axis::{PLL_LOCKED, SHARED};
use super::component::{Component, ComponentPart, Wiring};
use super::composition::Part;
use super::registers::RegisterMap;

/// Pins that all axes share.
fn shared_pins(config: &StageConfig) -> Vec<&'static str> {
    let with_pwm = config.axes.iter().any(|axis| axis.closed_loop().is_some());
    let pll_locked = with_pwm.then_some(PLL_LOCKED);
    let capture = config.capture.map(|_| capture::PIN);
    ["emergency_stop_n"]
        .into_iter()
        .chain(pll_locked)
        .chain(capture)
        .collect()
}

/// Name of the component.
pub const STAGE: &str = "stage";

impl Component {
    /// The stage.
    ///
    /// # Errors
    /// [`StageError`] for no axis or more than four, for ticks that are too short, and for names that clash.
    pub fn stage(config: &StageConfig) -> Result<Self, StageError> {
        config.check()?;
        let map = RegisterMap::new(registers::stage(config))?;
        let mut blocks = vec![
            ComponentPart::TimeBase(config.tick),
            ComponentPart::Schedule(config.schedule()?),
            ComponentPart::DividerShare(config.axes.len()),
            ComponentPart::Divider(config.tick),
            ComponentPart::Group(config.axes.len()),
        ];
        blocks.extend(config.capture.map(|_| ComponentPart::Capture));
        for axis in &config.axes {
            let joined = axis::join(axis, config.tick.tick_clocks(), config.axes.len())?;
            blocks.push(ComponentPart::Joined(Box::new(joined)));
        }
        let blocks = blocks.into_iter().map(|block| (block.name().to_owned(), block));
        let wiring = Wiring {
            part: Box::new(|block, part| wire(config, block, part)),
            inputs: pins(config, &shared_pins(config), axis::input_pins),
            outputs: pins(config, &["tick"], axis::output_pins),
        };
        Ok(Self::joined(map, STAGE, blocks.collect(), wiring)?)
    }
}

/// The shared pins, then those of each axis.
fn pins(config: &StageConfig, shared: &[&str], of_axis: fn(&StageAxis) -> Vec<&'static str>) -> Vec<String> {
    let mut pins: Vec<String> = shared.iter().map(|pin| (*pin).to_owned()).collect();
    for axis in &config.axes {
        pins.extend(of_axis(axis).iter().map(|pin| format!("{}_{pin}", axis.name)));
    }
    pins
}

fn wire(config: &StageConfig, block: &ComponentPart, part: Part) -> Part {
    match block {
        ComponentPart::Divider(_) => part
            .on("busy", "divider_busy")
            .on("saturated", "divider_saturated")
            .on("overrun", "divider_overrun")
            .on("start", "divider_start")
            .on("done", "divider_done")
            .tied("clear_flags", 1),
        ComponentPart::DividerShare(_) => {
            let part = part.on("start", "divider_start").on("done", "divider_done");
            config.axes.iter().enumerate().fold(part, |part, (channel, axis)| {
                let net = |name: &str| format!("{}_{name}", axis.name);
                let part = part.on(&format!("quotient_valid_{channel}"), &net("quotient_valid"));
                let operands = ["steps", "elapsed"].map(|name| (format!("{name}_of_{channel}"), net(name)));
                operands.iter().fold(part, |part, (port, net)| match axis.absolute() {
                    Some(_) => part.tied(port, 0),
                    None => part.on(port, net),
                })
            })
        }
        ComponentPart::Group(_) => config.axes.iter().enumerate().fold(part, |part, (index, axis)| {
            let each = [
                "can_start",
                "wants_group_stop",
                "emergency_stop",
                "axis_start",
                "group_stop",
                "feed_hold",
                "rests",
                "hold_feed",
            ];
            each.iter().fold(part, |part, port| {
                part.on(&format!("{port}_{index}"), &format!("{}_{port}", axis.name))
            })
        }),
        ComponentPart::Capture => capture::wire(config, part),
        ComponentPart::Joined(joined) => {
            let ports = part.ports().to_vec();
            let own = ports.iter().filter(|port| !SHARED.contains(&port.name.as_str()));
            own.fold(part, |part, port| {
                part.on(&port.name, &format!("{}_{}", joined.name(), port.name))
            })
        }
        _ => part,
    }
}
