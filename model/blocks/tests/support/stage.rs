//! A stage of existing blocks: a time base and two axes, each of them a composition.

use posicast_blocks::axis::Axis;
use posicast_blocks::composition::{Composition, Part};
use posicast_blocks::divider::{Divider, DividerConfig};
use posicast_blocks::pulse_counter::PulseCounter;
use posicast_blocks::pwm::{ActiveLow, Pwm, PwmConfig};
use posicast_blocks::segments::Segments;
use posicast_blocks::setting_banks::SettingBanks;
use posicast_blocks::shaper::{Shaper, ShaperConfig, ShaperMotion};
use posicast_blocks::sliding_mode::{Gain, SettingRow, Settings, SlidingMode};
use posicast_blocks::time_base::TimeBase;
use posicast_blocks::{Direction, Moore, Port};
use posicast_taps::{Tap, TapTable};

/// A part: its name, its block, and the nets of ports that are not on the net of their own name.
pub(crate) type Joined = (String, Box<dyn Moore>, Vec<(String, String)>);

/// Joins blocks. A net without a driver is an input of the whole, a net without a reader an output.
pub(crate) fn join(blocks: Vec<Joined>) -> (Composition, Vec<Box<dyn Moore>>) {
    let (mut read, mut driven) = (Vec::new(), Vec::new());
    for (_, block, nets) in &blocks {
        let net = |port: &Port| {
            let renamed = nets.iter().find(|(name, _)| *name == port.name);
            renamed.map_or_else(|| port.name.clone(), |(_, net)| net.clone())
        };
        for port in block.ports() {
            match port.direction {
                Direction::Input => read.push(net(port)),
                Direction::Output => driven.push(net(port)),
            }
        }
    }
    let mut inputs: Vec<&str> = Vec::new();
    for net in &read {
        if !driven.contains(net) && !inputs.contains(&net.as_str()) {
            inputs.push(net);
        }
    }
    let outputs: Vec<&str> = driven
        .iter()
        .filter(|net| !read.contains(net))
        .map(String::as_str)
        .collect();
    let part = |(name, block, nets): &Joined| {
        let part = Part::new(name, block.ports());
        nets.iter().fold(part, |part, (port, net)| part.on(port, net))
    };
    let parts = blocks.iter().map(part).collect();
    let composition = Composition::new(parts, &inputs, &outputs).unwrap_or_else(|error| panic!("{error}"));
    (composition, blocks.into_iter().map(|(_, block, _)| block).collect())
}

fn joined(name: &str, block: impl Moore + 'static, nets: &[(&str, &str)]) -> Joined {
    let owned = |(port, net): &(&str, &str)| ((*port).to_owned(), (*net).to_owned());
    (name.to_owned(), Box::new(block), nets.iter().map(owned).collect())
}

pub(crate) fn shaper_config() -> ShaperConfig {
    let tap = |(delay_samples, coefficient)| Tap {
        delay_samples,
        coefficient,
    };
    let taps = [(0, 40_000), (3, 20_000), (5, 5536)].map(tap).to_vec();
    let motion = ShaperMotion {
        channels: 2,
        modulo: false,
    };
    let table = TapTable::new(16, taps).unwrap();
    ShaperConfig::new(32, table).unwrap().for_motion(motion).unwrap()
}

pub(crate) fn settings() -> Settings {
    let mut settings = Settings::default();
    settings.set_gain(
        SettingRow::Derivative,
        Gain::nearest(3.0, SettingRow::Derivative).unwrap(),
    );
    settings.set_limit(1000 << 12);
    settings
}

pub(crate) fn pwm_config() -> PwmConfig {
    PwmConfig::new(ActiveLow::default(), 2, 3).unwrap()
}

/// Returns an axis with ticks of this many clocks: its composition, and the models of its blocks.
pub(crate) fn axis(tick_clocks: u64) -> (Composition, Vec<Box<dyn Moore>>) {
    join(vec![
        joined(
            "segments",
            Segments::new(1),
            &[
                ("position", "command_position"),
                ("velocity", "command_velocity"),
                ("acceleration", "acceleration_reference"),
                ("valid", "segments_valid"),
                ("enable", "segments_enable"),
                ("preset", "segments_preset"),
                ("quick_stop", "segments_quick_stop"),
                ("restart", "segments_restart"),
                ("state", "segments_state"),
                ("empty", "segments_empty"),
                ("overflow", "segments_overflow"),
                ("underrun", "segments_underrun"),
                ("tick_missed", "segments_tick_missed"),
                ("out_of_range", "segments_out_of_range"),
                ("refused", "segments_refused"),
            ],
        ),
        joined(
            "shaper",
            Shaper::new(&shaper_config(), 1),
            &[
                ("strobe", "segments_valid"),
                ("start", "shaper_start"),
                ("x_0", "command_position"),
                ("x_1", "command_velocity"),
                ("y_0", "position_reference"),
                ("y_1", "velocity_reference"),
                ("overrun", "shaper_overrun"),
                ("saturated", "shaper_saturated"),
                ("busy", "shaper_busy"),
                ("refused", "shaper_refused"),
                ("bank", "shaper_bank"),
            ],
        ),
        joined(
            "counter",
            PulseCounter::new(),
            &[
                ("time_stamp", "edge_stamp"),
                ("mode", "line_mode"),
                ("swap", "line_swap"),
                ("illegal", "encoder_illegal"),
                ("disagreement", "encoder_disagreement"),
            ],
        ),
        joined(
            "divider",
            Divider::new(&DividerConfig::new(tick_clocks).unwrap()),
            &[
                ("start", "divide"),
                ("done", "quotient_valid"),
                ("busy", "divider_busy"),
                ("saturated", "divider_saturated"),
                ("overrun", "divider_overrun"),
            ],
        ),
        joined(
            "controller",
            SlidingMode::new(),
            &[
                ("start", "valid"),
                ("valid", "controlled"),
                ("overrun", "controller_overrun"),
            ],
        ),
        joined(
            "settings",
            SettingBanks::new(&settings()),
            &[("row", "setting_address")],
        ),
        joined(
            "pwm",
            Pwm::new(&pwm_config()),
            &[
                ("enable", "pwm_enable"),
                ("duty", "pwm_duty"),
                // This output depends on an input: `low` follows `low_water`.
                ("feed", "low"),
                ("sync", "tick"),
                ("mode", "pwm_mode"),
                ("filter_clocks", "fault_filter_clocks"),
                ("tripped", "pwm_tripped"),
                ("saturated", "pwm_saturated"),
                ("refused", "pwm_refused"),
            ],
        ),
        joined(
            "supervisor",
            Axis::new(),
            &[
                ("enable", "axis_enable"),
                ("start", "axis_start"),
                ("stop", "axis_stop"),
                ("state", "axis_state"),
                ("reference_position", "position_reference"),
                ("reference_velocity", "velocity_reference"),
            ],
        ),
    ])
}

/// Returns a time base and two axes with pins of their own; `make` makes a block of an axis.
pub(crate) fn stage(
    tick_clocks: u64,
    make: impl Fn((Composition, Vec<Box<dyn Moore>>)) -> Box<dyn Moore>,
) -> (Composition, Vec<Box<dyn Moore>>) {
    let time_base = TimeBase::new(&DividerConfig::new(tick_clocks).unwrap());
    let mut blocks = vec![joined("time_base", time_base, &[])];
    for name in ["x", "y"] {
        let axis = make(axis(tick_clocks));
        let own = |port: &Port| {
            let pins = ["a", "b", "z", "write", "axis_enable", "fault_n"].contains(&port.name.as_str());
            port.direction == Direction::Output || pins
        };
        let nets = axis.ports().iter().filter(|port| own(port));
        let nets = nets
            .map(|port| (port.name.clone(), format!("{name}_{}", port.name)))
            .collect();
        blocks.push((name.to_owned(), axis, nets));
    }
    join(blocks)
}
