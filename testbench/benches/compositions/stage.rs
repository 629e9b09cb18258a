//! The XY stage of the example, with a host that moves it.

use crate::pins::encoder;
use crate::{TICK_CLOCKS, Whole};
use posicast_blocks::component::Component;
use posicast_blocks::segments::{Entry, EntryMotion};
use posicast_blocks::stage::StageConfig;
use posicast_hdl::component::emit;
use posicast_machine::hardware;
use posicast_machine::machine_file;
use posicast_machine::plan::design_machine;
use std::collections::HashMap;

/// Returns the configuration of the example.
pub(crate) fn config() -> StageConfig {
    let machine = machine_file::parse("xy-stage.toml", include_str!("../../../examples/xy-stage.toml")).unwrap();
    let stage = hardware::stage(&machine, &design_machine(&machine).unwrap());
    stage.unwrap().unwrap().config
}

pub(crate) fn stage() -> Whole {
    let component = Component::stage(&config()).unwrap();
    let writes = writes(&component);
    Whole {
        name: "stage",
        modules: emit(&component, "stage", "stage").unwrap(),
        model: component.model(1),
        input: Box::new(move |name, clock| input(&writes, name, clock)),
    }
}

/// Returns the address and the data per clock: both axes are cleared, switched on, and move back and forth by one
/// entry per tick.
fn writes(component: &Component) -> HashMap<u64, (u64, u64)> {
    let at = |register: &str| u64::from(component.map().register(register).unwrap().offset);
    let mut writes = HashMap::new();
    for (later, axis) in [(0, "x"), (1, "y")] {
        writes.insert(100 + later, (at(&format!("{axis}_clear_faults")), 0));
        writes.insert(500 + later, (at(&format!("{axis}_control")), 1));
        for tick in 2..20 {
            let jerk = [1i64, -1, -1, 1][tick as usize % 4] << 20;
            let entry = Entry {
                ticks: 1,
                motion: EntryMotion::Jerk(jerk),
                notify: false,
            };
            for (place, word) in (0..).zip(entry.words()) {
                let clock = tick * TICK_CLOCKS + 1000 + 10 * later + place;
                writes.insert(clock, (at(&format!("{axis}_segment")) + place, word.into()));
            }
        }
    }
    writes.insert(3 * TICK_CLOCKS + 2000, (at("start"), 3));
    writes
}

fn input(writes: &HashMap<u64, (u64, u64)>, name: &str, clock: u64) -> u64 {
    let written = writes.get(&clock);
    let [a, b] = encoder(clock);
    let [later_a, later_b] = encoder(clock + 140);
    match name {
        "avs_write" => written.is_some().into(),
        "avs_address" => written.map_or(0, |(address, _)| *address),
        "avs_writedata" => written.map_or(0, |(_, data)| *data),
        "avs_byteenable" => 15,
        "x_a" => a,
        "x_b" => b,
        "y_a" => later_a,
        "y_b" => later_b,
        line if line.ends_with("_n") || line.ends_with("_ready") || line == "pll_locked" => 1,
        _ => 0,
    }
}
