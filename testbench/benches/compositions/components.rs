//! The blocks with a bus of their own: the host writes at the start and then reads once per 1000 clocks; the pins do
//! the rest.

use crate::pins::encoder;
use crate::{TICK_CLOCKS, Whole, stage};
use posicast_blocks::component::Component;
use posicast_blocks::divider::DividerConfig;
use posicast_blocks::pwm::BridgeMode;
use posicast_blocks::registers::RegisterMap;
use posicast_blocks::sliding_mode::Law;
use posicast_hdl::component::emit;

pub(crate) fn all() -> [Whole; 4] {
    let divider = DividerConfig::new(TICK_CLOCKS).unwrap();
    let axis = stage::config().axes.swap_remove(0);
    [
        whole(
            "pulse_counter",
            Component::pulse_counter(divider, 5, false).unwrap(),
            &[],
            |name, clock| {
                let [a, b] = encoder(clock);
                match name {
                    "a" => a,
                    "b" => b,
                    _ => 0,
                }
            },
        ),
        whole(
            "shaper",
            Component::shaper(axis.shaper.clone()).unwrap(),
            &[("control", "from_pins", 1)],
            |name, clock| {
                let tick = clock / TICK_CLOCKS;
                match (name, clock % TICK_CLOCKS) {
                    ("strobe", 100) => 1,
                    ("x_0", 100..) => 12_345 * tick,
                    ("x_1", 100..) => 12_345 << 8,
                    _ => 0,
                }
            },
        ),
        whole(
            "sliding_mode",
            Component::sliding_mode(&axis.closed_loop().unwrap().settings, Law::SlidingMode, false).unwrap(),
            &[("control", "from_pins", 1)],
            |name, clock| {
                let tick = clock / TICK_CLOCKS;
                match (name, clock % TICK_CLOCKS) {
                    ("start", 200) => 1,
                    ("position_reference", _) => (tick * 300) << 8,
                    ("position", _) => tick * 299,
                    ("velocity_reference", _) => 300 << 16,
                    ("velocity", _) => 299 << 16,
                    _ => 0,
                }
            },
        ),
        whole(
            "pwm",
            Component::pwm(axis.closed_loop().unwrap().pwm, BridgeMode::Unipolar, 2500).unwrap(),
            &[
                ("clear_trip", "", 0),
                ("control", "from_pins", 1),
                ("control", "enable", 1),
            ],
            |name, clock| match (name, clock % TICK_CLOCKS) {
                ("feed", 300) | ("fault_n" | "pll_locked", _) => 1,
                ("filtered_fault_n", _) => 3,
                ("duty", _) => clock / TICK_CLOCKS * 230,
                _ => 0,
            },
        ),
    ]
}

/// Builds a composition. `writes` holds the register, one of its fields or `None`, and the value; a later write keeps
/// the fields of an earlier one.
fn whole(
    name: &'static str,
    component: Component,
    writes: &[(&str, &str, u32)],
    pins: impl Fn(&str, u64) -> u64 + 'static,
) -> Whole {
    let mut words: Vec<(u64, u64)> = Vec::new();
    for write in writes {
        let (offset, data) = word(component.map(), *write);
        let before = words
            .iter()
            .rev()
            .find(|(at, _)| *at == offset)
            .map_or(0, |(_, data)| *data);
        words.push((offset, data | before));
    }
    let bus = move |name: &str, clock: u64| {
        let write = (clock % 20 == 10).then(|| words.get(clock as usize / 20)).flatten();
        match (name, write) {
            ("avs_write", write) => u64::from(write.is_some()),
            ("avs_address", Some((offset, _))) => *offset,
            ("avs_writedata", Some((_, data))) => *data,
            ("avs_byteenable", _) => 15,
            ("avs_read", _) => u64::from(clock % 1000 == 900),
            ("avs_address", None) => 0x20,
            _ => pins(name, clock),
        }
    };
    Whole {
        name,
        modules: emit(&component, name, name).unwrap(),
        model: component.model(1),
        input: Box::new(bus),
    }
}

/// Returns the offset and value of a register whose field has this value; its other fields have their reset values.
fn word(map: &RegisterMap, (register, field, value): (&str, &str, u32)) -> (u64, u64) {
    let register = map.register(register).unwrap();
    let field = register.fields.iter().find(|own| own.name == field);
    let data = field.map_or(0, |field| register.reset() & !field.mask() | value << field.low);
    (register.offset.into(), data.into())
}
