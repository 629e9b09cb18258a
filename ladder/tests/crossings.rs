//! Checks the logic behind each asynchronous pin of the example's stage, on the netlist.

use posicast_hdl::emit::Module;
use posicast_ladder::crossings::{Crossing, crossings};
use posicast_machine::plan::design_machine;
use posicast_machine::{hardware, machine_file};
use posicast_testbench::blocks::Block;
use posicast_testbench::named_mutant::NamedMutant;
use posicast_testbench::stage::StageBlock;

/// The stage of the example with one axis, which Yosys reads in half the time.
fn modules() -> Vec<Module> {
    let text = include_str!("../../examples/xy-stage.toml");
    let machine = machine_file::parse("xy-stage.toml", text).unwrap();
    let mut config = hardware::stage(&machine, &design_machine(&machine).unwrap())
        .unwrap()
        .unwrap()
        .config;
    config.axes.truncate(1);
    StageBlock::new(&config, "stage").unwrap().modules().unwrap()
}

fn found(modules: &[Module]) -> Vec<Crossing> {
    let folder = tempfile::tempdir().unwrap();
    crossings(modules, folder.path()).unwrap()
}

/// Pins that are asynchronous on purpose, because they switch the gates off without a clock. The pin of the drive's fault passes a
/// register and the multiplexer of the self-test, then the synchroniser of the PWM.
const OTHERWISE: [&str; 3] = ["pll_locked", "x_drive_fault_n", "x_fault_n"];

#[test]
fn long_every_asynchronous_pin_has_one_synchroniser_and_nothing_beside_it() {
    let all = found(&modules());
    assert_eq!(all.len(), 11, "{all:?}");
    for crossing in &all {
        let otherwise = OTHERWISE.contains(&crossing.pin.as_str());
        assert_eq!(crossing.findings.is_empty(), !otherwise, "{crossing:?}");
        assert_eq!(crossing.synchronisers.len(), 1, "{crossing:?}");
    }
    // Only the fault latch and the gates read these pins.
    for pin in ["pll_locked", "x_fault_n"] {
        let crossing = all.iter().find(|crossing| crossing.pin == pin).unwrap();
        let is_the_latch = |finding: &String| finding.contains("pwm.guard");
        assert!(crossing.findings.iter().all(is_the_latch), "{crossing:?}");
    }

    let logic = |from: &str, to: &str| {
        let mutant = NamedMutant {
            name: "logic at a pin",
            module: None,
            from,
            to,
        };
        let all = found(&mutant.put_into(&modules()).unwrap());
        let wrong = all.iter().filter(|crossing| !crossing.findings.is_empty());
        let wrong: Vec<&str> = wrong.map(|crossing| crossing.pin.as_str()).collect();
        wrong
            .iter()
            .filter(|pin| !OTHERWISE.contains(pin))
            .map(|pin| (*pin).to_owned())
            .collect::<Vec<_>>()
    };
    // Logic before the first flip-flop, and a second reader of it.
    let gated = logic(
        "synchroniser_first <= pin;",
        "synchroniser_first <= pin & synchroniser_second;",
    );
    assert!(gated.contains(&"x_a".to_owned()), "{gated:?}");
    let read_twice = logic(
        "assign level = synchroniser_second;",
        "assign level = synchroniser_second | synchroniser_first;",
    );
    assert!(read_twice.contains(&"x_limit_plus_n".to_owned()), "{read_twice:?}");
}
