//! Runs the driver on a RISC-V beside the stage: a core executes the unmodified C, takes the stage's interrupts, and
//! moves the machine.

mod core;
mod system;

use crate::driver::support::Driver;
use core::Core;
use posicast_machine::machine_file;
use system::{Firmware, HOME_FROM, INDEX_AT, Outcome, Step, System};

/// Largest number of clocks of a run, enough for the slowest bridge; the program takes about two thirds of it.
const MOST_CLOCKS: u64 = 4_000_000;

const MACHINE: &str = include_str!("machine.toml");

fn driver(text: &str) -> Driver {
    Driver::of(machine_file::parse("machine.toml", text).unwrap())
}

/// The home switch of X is pressed from a count on. In the step "fault" the drive of X fails half way, and is repaired
/// later.
fn run(system: &mut System, firmware: &Firmware, seed: u16) -> Outcome {
    system.run(firmware, seed, MOST_CLOCKS, &mut |system, step| {
        let count = system.count(0);
        system.set("x_home", count >= HOME_FROM);
        match step {
            "fault" if count < 15 => system.set("x_drive_fault_n", false),
            "mend" => system.set("x_drive_fault_n", true),
            _ => {}
        }
    })
}

/// `most_latency` is the largest number of clocks from the stage's interrupt to the handler.
fn check(system: &System, outcome: &Outcome, most_latency: u64) {
    let said = |name: &str| outcome.results[name];
    // The axis is homed by the index, which is exactly position 1000.
    assert_eq!(said("origin"), INDEX_AT - 1000, "{outcome:#?}");
    assert_eq!(said("home_events"), 1 << 6);
    // The shaped command ends on the commanded count, and the machine within one of it.
    let near = |name: &str, wanted: i64| assert!((said(name) - wanted).abs() <= 1, "{name}: {outcome:#?}");
    near("x_moved", 90 - said("origin"));
    near("y_moved", -70);
    // Each axis reports to the core once that it has arrived.
    assert_eq!(said("move_events"), 1 << 1 | 1 << 8);
    // X has a fault, because its PWM tripped; Y is stopped with it by the group stop.
    assert_eq!((said("fault_causes_x"), said("fault_causes_y")), (1 << 1, 1 << 14));
    // Each reports this to the core; the stop of Y is over before the fault of X is cleared.
    assert_eq!(said("fault_events"), 1 << 5 | 1 << 8 | 1 << 11);
    let stopped_at = said("stopped_at") / 256;
    assert!((-60..90).contains(&stopped_at), "{stopped_at}");
    // The fault is cleared, and the move continues.
    assert_eq!(said("left_causes"), 0);
    // The core was woken at every tick, and never without a reason. It responds soon.
    assert!(said("ticks") > 500 && said("nothing") == 0, "{outcome:#?}");
    assert!((1..=most_latency).contains(&outcome.longest_latency), "{outcome:#?}");
    near("x_again", -60 - said("origin"));
    near("y_again", 40);
    // The points of the path are reached to the last bit, and none is late: 50 counts there, 50 back.
    assert_eq!(
        (said("path_x"), said("path_y"), said("late")),
        (0, 0, 0),
        "{outcome:#?}"
    );
    let a_point = outcome.steps.iter().find(|step| step.name == "a point").unwrap();
    assert_eq!(
        a_point.reads + a_point.writes - a_point.in_interrupt,
        2 * 6,
        "{a_point:?}"
    );
    for (axis, wanted) in [-10, -10].into_iter().enumerate() {
        assert!(
            (system.count(axis) - wanted).abs() <= 1,
            "{axis}: {}",
            system.count(axis)
        );
    }
}

/// Returns the seeds of the bridge's waits: one, or one per case of `PROPTEST_CASES`, including 0 (no waits).
fn seeds() -> impl Iterator<Item = u16> {
    let wanted = std::env::var("PROPTEST_CASES")
        .ok()
        .and_then(|cases| cases.parse().ok());
    let cases = wanted.map_or(1, |cases: u32| cases.div_ceil(CASES_PER_RUN));
    let another = |seed: u16| seed.wrapping_mul(25_173).wrapping_add(13_849);
    let drawn = std::iter::successors(Some(0xace1), move |seed| Some(another(*seed)));
    let without_waits = (cases > 1).then_some(0);
    without_waits.into_iter().chain(drawn).take(cases as usize)
}

/// With `PROPTEST_CASES`, each further case takes about as long as one run.
const CASES_PER_RUN: u32 = 100;

/// Returns the tables of `docs/driver.md` from this run.
fn show(firmware: &Firmware, outcome: &Outcome) {
    println!(
        "{} bytes of program, {} of variables, {} of stack",
        firmware.text, firmware.data, outcome.results["stack"]
    );
    for (name, bytes) in &firmware.files {
        println!("{name}: {bytes}");
    }
    println!("step: clocks, ticks, reads, writes, those of interrupts among them");
    for step in outcome.steps.iter().filter(|step| !step.name.is_empty()) {
        let Step {
            name,
            clocks,
            ticks,
            reads,
            writes,
            in_interrupt,
        } = step;
        println!("{name}: {clocks}, {ticks}, {reads}, {writes}, {in_interrupt}");
    }
    println!(
        "{} clocks, {} outputs compared; from the line to the core at most {} clocks",
        outcome.clocks, outcome.compared, outcome.longest_latency
    );
}

#[test]
fn long_prop_a_riscv_works_the_stage_through_its_driver_however_slow_its_bus() {
    let driver = driver(MACHINE);
    let firmware = Firmware::build(&driver, &Core::picorv32(&driver));
    // This fits a small memory; the compiler's version changes it by some hundred bytes.
    assert!(
        firmware.text < 20_000 && firmware.data < 256,
        "{} {}",
        firmware.text,
        firmware.data
    );
    for seed in seeds() {
        let mut system = System::new(&driver, Core::picorv32(&driver));
        let outcome = run(&mut system, &firmware, seed);
        show(&firmware, &outcome);
        check(&system, &outcome, 99);
    }
}

/// The same program on a VexRiscv in a SoC of LiteX, with the stage as the package's module adds it.
#[test]
fn long_lockstep_a_soc_of_litex_works_the_stage_through_its_driver() {
    let driver = driver(MACHINE);
    let core = Core::litex(&driver);
    let firmware = Firmware::build(&driver, &core);
    let mut system = System::new(&driver, core);
    let outcome = run(&mut system, &firmware, 0);
    show(&firmware, &outcome);
    // Its handler is in C when it says so, behind caches.
    check(&system, &outcome, 250);
}

/// A comment in the machine file makes another checksum: the program reads that of the hardware, and touches nothing.
#[test]
fn lockstep_a_riscv_with_the_driver_of_another_machine_file_refuses_the_stage() {
    let [hardware, other] = [driver(MACHINE), driver(&format!("{MACHINE}# after the tuning\n"))];
    let checksum = |driver: &Driver| i64::from(driver.machine.link.unwrap().machine_crc as i32);
    let core = Core::picorv32(&hardware);
    let firmware = Firmware::build(&other, &core);
    let outcome = System::new(&hardware, core).run(&firmware, 0, MOST_CLOCKS, &mut |_, _| ());
    assert_eq!(
        (outcome.results["found"], outcome.results["wanted"]),
        (checksum(&hardware), checksum(&other))
    );
    assert_eq!(outcome.steps.iter().map(|step| step.writes).sum::<u64>(), 0);
}
