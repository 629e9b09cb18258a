//! The driver changes the tables of an axis whose mode moves with its position, while the axis moves.

use crate::driver::bridge::Bridge;
use crate::driver::support::Driver;
use posicast_machine::machine_file::{self, Machine};
use posicast_machine::plan::design_machine;

/// Returns the example with a mode that falls along the travel of its first axis.
fn moving_machine() -> Machine {
    let text = include_str!("../../../examples/xy-stage.toml");
    let points =
        "moves_with = \"position\"\npoints = [[-0.1, 160.0, 0.1], [0.1, 100.0, 0.1]]\n[axis.family]\nnominal = 0.0\n";
    let (head, rest) = text.split_once("frequency_hz = 131.117015808451").unwrap();
    let rest = rest.split_once("damping = 0.157799065776\n").unwrap().1;
    machine_file::parse(
        "xy-stage.toml",
        &format!("{head}{points}{rest}").replacen("kind = \"zvd\"", "kind = \"zvd\"\ntolerance = 0.01", 1),
    )
    .unwrap()
}

#[test]
fn tables_follow_the_position() {
    let machine = moving_machine();
    let family = design_machine(&machine).unwrap().families.remove(0);
    let last = family.choose(family.nominal, 0.09);
    assert!(last >= family.nominal + 2);
    let driver = Driver::of(machine);
    let mut bridge = Bridge::new(&driver, "family.c", false);
    let said = bridge.talk(&[]);
    assert_eq!(said["tables"], family.members.len() as i64);
    assert_eq!(
        (said["in_use"], said["changes"]),
        (last as i64, (last - family.nominal) as i64),
        "{said:?}"
    );
    assert_eq!((said["loaded"], said["bank"]), (1, 0), "{said:?}");
    assert_eq!(said["from_nowhere"], 0, "{said:?}");
    assert_eq!((said["command"], said["causes"]), (90_000 * 256, 0), "{said:?}");
    let at = bridge.bench.plant(0).count();
    assert!((at - 90_000).abs() <= 1, "{at}");
}
