//! The driver on axes with absolute encoders over BiSS-C: they are not homed, and go on after one was lost.

use std::cell::Cell;

use crate::driver::bridge::Bridge;
use crate::driver::support::Driver;
use posicast_blocks::axis::Cause;
use posicast_machine::machine_file;
use posicast_machine::plant::axis::AbsoluteFault;

#[test]
fn an_axis_with_an_absolute_encoder_moves_without_homing() {
    let text = include_str!("../../../examples/measuring-arm.toml")
        .replacen("name = \"measuring_arm\"", "name = \"xy_stage\"", 1)
        .replacen("name = \"arm\"", "name = \"x\"", 1)
        .replacen("name = \"column\"", "name = \"y\"", 1);
    let driver = Driver::of(machine_file::parse("arm.toml", &text).unwrap());
    let mut bridge = Bridge::new(&driver, "absolute.c", false);
    let unplugged = Cell::new(false);
    let said = bridge.talk_beside(&[], |bench| {
        let fault = bench.net("x_state").unwrap() == 5;
        let far = bench.net("x_count").unwrap() as u32 as i32 > 5000;
        if far && !unplugged.replace(unplugged.get() || far) {
            bench.fault_absolute_encoder(0, Some(AbsoluteFault::Stuck(true)));
        }
        if fault {
            bench.fault_absolute_encoder(0, None);
        }
    });
    assert_eq!(
        (said["homed"], said["homed_when_lost"], said["homed_again"]),
        (1, 0, 1),
        "{said:?}"
    );
    assert!((said["position"] - 3000).abs() <= 2, "{said:?}");
    // 8 m of cable are 80 ns, 4 clocks there and back; the registers at both ends take the rest.
    assert!((4..=7).contains(&said["delay"]), "{said:?}");
    assert_ne!(said["causes"] & i64::from(Cause::EncoderError.bit()), 0, "{said:?}");
    assert_eq!(said["silent"], 1, "{said:?}");
    assert!((said["position_after"] - 1000).abs() <= 2, "{said:?}");
    assert_eq!(said["causes_after"], 0, "{said:?}");
}
