//! The driver's error tables on the stage: one takes effect after homing; another is loaded, read back, refused, and
//! switched off.

use crate::driver::bridge::Bridge;
use crate::driver::support::Driver;
use posicast_machine::machine_file::{self, Machine};

/// Returns the example, in which the screw of X is 20 µm too long over 100 mm.
fn machine() -> Machine {
    let text = include_str!("../../../examples/xy-stage.toml");
    let table = "[axis.error_table]\nfile = \"x.csv\"\n\n[axis.limits]";
    let text = text.replacen("[axis.limits]", table, 1);
    let csv = |_: &str| Ok("position,error\n-0.1,-0.00002\n0.1,0.00002\n".to_owned());
    machine_file::parse_beside("xy-stage.toml", &text, &csv).unwrap()
}

#[test]
fn lockstep_the_driver_loads_uses_and_reads_error_tables() {
    let driver = Driver::of(machine());
    let mut bridge = Bridge::new(&driver, "error_table.c", false);
    let said = bridge.talk(&[]);
    assert_eq!(
        (said["entries"], said["spacing"], said["first"]),
        (197, 1024, -100_000),
        "{said:?}"
    );
    // Nothing is corrected before homing.
    assert_eq!((said["not_homed"], said["counted_before"]), (0, 10_000), "{said:?}");
    // The error is 2 counts at 10,000: the axis goes back by them to the true position.
    assert_eq!(
        (said["weight"], said["error"], said["counted"]),
        (1024, 512, 9998),
        "{said:?}"
    );
    // The loaded table has 5 counts; between two entries, one of which is at a corner, the error is a little larger.
    assert!((said["error_loaded"] - 5 * 256).abs() <= 40, "{said:?}");
    assert_eq!(said["same"], 1, "{said:?}");
    assert_eq!((said["machine_first"], said["machine_last"]), (-5120, 5120), "{said:?}");
    assert_eq!(
        (said["error_refused"], said["error_off"], said["causes"]),
        (512, 0, 0),
        "{said:?}"
    );
}
