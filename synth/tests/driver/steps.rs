//! The driver on an axis with steps: it is homed by its probe, gets the steps that its drive has lost, compares its position, and
//! probes.

use crate::driver::bridge::Bridge;
use crate::driver::support::Driver;
use posicast_closed_loop::stage_bench::StepWire;
use posicast_machine::machine_file::{self, Machine};

/// Count since reset from which on the probe touches.
const TOUCHES_AT: i32 = 1000;

/// The printer, with a probe, a scale of ten counts per step, a correction and a position compare on X, and with drives that are always at their steps.
fn machine() -> Machine {
    let text = include_str!("../../../examples/printer.toml");
    let tables = "[axis.probe]\nactive_low = true\nvelocity = 0.01\nwithin = 0.01\nretract = 0.001\n\
                  [axis.scale]\ncounts_per_unit = 800_000\n\
                  [axis.correction]\nfrom = 0.0001\nmost = 0.01\nvelocity = 0.01\n\
                  [axis.compare]\nspacing = 0.001\npositions = 10\npulse_s = 1e-6\n[axis.limits]";
    let text = text
        .replacen("[axis.limits]", tables, 1)
        .replacen("name = \"printer\"", "name = \"xy_stage\"", 1);
    let text = format!("{text}\n[capture]\nfilter_s = 1e-6\n");
    let mut machine = machine_file::parse("printer.toml", &text).unwrap();
    for axis in &mut machine.axes {
        axis.stepper = None;
    }
    machine
}

#[test]
fn an_axis_with_steps_is_homed_corrected_compared_and_probes() {
    let driver = Driver::of(machine());
    let mut bridge = Bridge::new(&driver, "steps.c", false);
    let said = bridge.talk_beside(&[], |bench| {
        let count = bench.net("x_count").unwrap() as u32 as i32;
        bench.set("capture_line", u64::from(count >= TOUCHES_AT)).unwrap();
        bench.break_step_wire(0, (200..240).contains(&count).then_some(StepWire::Cut));
    });
    // The contact is where the axis stood at reset; the hardware latches its count exactly.
    assert_eq!(
        (said["touches_first"], said["origin"], said["index_setup"]),
        (1, -1000, 0),
        "{said:?}"
    );
    assert!((said["homed_at"] - 1100).abs() <= 5, "{said:?}");
    // What the drive has not seen is what the scale shows, and what is given again.
    assert!((30..60).contains(&said["deviation"]), "{said:?}");
    assert_eq!((said["steps"], said["more_steps"]), (said["deviation"], 0), "{said:?}");
    assert_eq!(said["corrected"], said["steps"], "{said:?}");
    assert!(said["deviation_after"].abs() <= 1, "{said:?}");
    assert_eq!(said["position_after"], said["position"], "{said:?}");
    assert!(
        (said["scale"] - 10 * (said["count"] - said["steps"])).abs() <= 5,
        "{said:?}"
    );
    assert_eq!((said["row_passes"], said["list_passes"]), (5, 2), "{said:?}");
    // Armed, ready, upward, three entries.
    assert_eq!((said["list_state"], said["off_state"]), (0x0003_0023, 0), "{said:?}");
    let touched = i64::from(TOUCHES_AT) - said["origin_now"];
    assert!(
        (said["edge_x"] - touched).abs() <= 1 && said["edge_rises"] == 1,
        "{said:?}"
    );
    assert!((1..100).contains(&said["overrun"]), "{said:?}");
    assert_eq!(said["stands_at"], said["edge_x"] + said["overrun"], "{said:?}");
    assert_eq!((said["edge_y"], said["edges"]), (0, 0), "{said:?}");
    assert_eq!((said["limit"], said["homed"], said["causes"]), (5000, 1, 0), "{said:?}");
}
