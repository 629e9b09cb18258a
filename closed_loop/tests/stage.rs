//! The stage of the example machine with its simulated plants: a move over the bus, in the model and in lock step, and what its
//! datasheet promises.

use posicast_blocks::component::Component;
use posicast_blocks::segments::{self, Entry, NOTIFY};
use posicast_blocks::{Direction, Port, StepError};
use posicast_closed_loop::stage_bench::{StageBench, state};
use posicast_machine::machine_file::Machine;
use posicast_machine::plant::axis::PlantOptions;
use posicast_testbench::lockstep::{Device, TwoValued};

use crate::support::{XY, bench, machine, queue_move, stage, verilated};

/// Switches on, moves both axes by this many counts, and returns how long that took.
fn move_both(machine: &Machine, bench: &mut StageBench, counts: i32) -> u64 {
    assert!(bench.switch_on(20_000_000).unwrap());
    bench.record();
    let start = bench.now();
    for axis in 0..2 {
        queue_move(bench, machine, axis, counts);
    }
    bench.write("start", 3).unwrap();
    bench.clocks(20_000).unwrap();
    for axis in ["x", "y"] {
        assert_eq!(bench.field(axis, "status", "state").unwrap(), state::RUN);
    }
    for axis in ["x", "y"] {
        assert!(bench.wait(axis, state::HOLD, 20_000_000).unwrap());
    }
    bench.clocks(500_000).unwrap();
    bench.now() - start
}

#[test]
fn a_few_segments_and_one_bit_move_the_stage() {
    let machine = machine(XY);
    let mut bench = bench(&machine, &stage(&machine), &PlantOptions::default(), None, 1);
    move_both(&machine, &mut bench, 5000);
    for axis in 0..2 {
        let at = bench.plant(axis).count();
        assert!((at - 5000).abs() <= 2, "{at}");
    }
}

#[test]
fn lockstep_a_move_from_reset_to_standstill() {
    let machine = machine(XY);
    let stage = stage(&machine);
    let mut bench = bench(&machine, &stage, &PlantOptions::default(), Some(verilated(&stage)), 1);
    move_both(&machine, &mut bench, 200);
    assert_eq!(bench.mismatches(), (0, None));
}

/// A model as a device, whose first output is inverted in one clock.
struct OneWrongValue {
    device: TwoValued,
    clock: u64,
    wrong: u64,
}

impl Device for OneWrongValue {
    fn ports(&self) -> &[Port] {
        self.device.ports()
    }

    fn step(&mut self, inputs: &[u64], outputs: &mut [u64], unknown: &mut [u64]) -> Result<(), StepError> {
        self.device.step(inputs, outputs, unknown)?;
        outputs[0] ^= u64::from(self.clock == self.wrong);
        self.clock += 1;
        Ok(())
    }
}

#[test]
fn lockstep_one_wrong_value_is_found_in_its_clock() {
    let machine = machine(XY);
    let stage = stage(&machine);
    let model = || Component::stage(&stage.config).unwrap().model(1);
    // In the reset, at the tick and just after it, and within the quiet clocks before the next tick.
    for wrong in [1, 5_000, 5_003, 9_321] {
        let device = OneWrongValue {
            device: TwoValued(Box::new(model())),
            clock: 0,
            wrong,
        };
        let mut bench = bench(&machine, &stage, &PlantOptions::default(), Some(Box::new(device)), 1);
        bench.clocks(20_000).unwrap();
        let (differs, first) = bench.mismatches();
        let first = first.unwrap();
        assert_eq!((differs, first.time), (1, wrong));
        let text = first.to_string();
        let shown: Vec<&str> = text.lines().nth(1).unwrap().split_whitespace().skip(1).collect();
        let around: Vec<String> = (wrong.saturating_sub(6)..=wrong + 6)
            .map(|clock| clock.to_string())
            .collect();
        assert_eq!(shown, around);
    }
}

const DATASHEET: &str = include_str!("../../docs/stage.md");

/// Returns the cells of the rows of the datasheet's table under this heading.
fn rows(head: &str) -> Vec<Vec<String>> {
    let table = DATASHEET.split_once(head).unwrap().1.lines().skip(2);
    let rows = table.take_while(|line| line.starts_with('|'));
    rows.map(|row| {
        let cells = row.trim_matches('|').split('|');
        cells.map(|cell| cell.trim().replace('`', "")).collect()
    })
    .collect()
}

fn number(text: &str) -> u32 {
    let hexadecimal = text.strip_prefix("0x").map(|digits| u32::from_str_radix(digits, 16));
    hexadecimal.unwrap_or_else(|| text.parse()).unwrap()
}

/// Reads a register, or a field of one, such as `X_STATUS.state`.
fn look(bench: &mut StageBench, name: &str) -> u32 {
    let lower = name.to_lowercase();
    let Some((register, field)) = lower.split_once('.') else {
        return bench.read(&lower).unwrap();
    };
    let (axis, register) = register.split_once('_').unwrap();
    bench.field(axis, register, field).unwrap()
}

#[test]
fn the_first_move_of_the_datasheet_is_what_it_says() {
    let machine = machine(XY);
    let mut bench = bench(&machine, &stage(&machine), &PlantOptions::default(), None, 1);
    let rows = rows("| do | register or field | word | what it does |");
    assert!(rows.len() > 20, "{rows:?}");
    for row in rows {
        let [action, name, word, ..] = row.as_slice() else {
            panic!("{row:?}");
        };
        match action.as_str() {
            "wait" => bench.clocks(number(word).into()).unwrap(),
            "write" => bench.write(&name.to_lowercase(), number(word)).unwrap(),
            "read" => assert_eq!(look(&mut bench, name), number(word), "{row:?}"),
            "near" => {
                let apart = look(&mut bench, name).wrapping_sub(number(word)) as i32;
                assert!(apart.abs() <= 2, "{row:?}: {apart} apart");
            }
            "until" => {
                let mut steps = 0..2000;
                let arrives = steps.any(|_| {
                    bench.clocks(1000).unwrap();
                    look(&mut bench, name) == number(word)
                });
                assert!(arrives, "{row:?}");
            }
            "entry" => {
                let words: Vec<u32> = word.split(' ').map(number).collect();
                let jerk = u64::from(words[0]) | u64::from(words[1]) << 32;
                let entry = Entry {
                    ticks: words[3] & 0xff_ffff,
                    motion: segments::EntryMotion::Jerk(jerk as i64),
                    notify: words[3] & NOTIFY != 0,
                };
                assert_eq!(entry.words().as_slice(), words);
                bench.segment(&name[..1].to_lowercase(), &entry).unwrap();
            }
            other => panic!("`{other}` is no action"),
        }
    }
}

#[test]
fn the_datasheet_has_the_pins() {
    let component = Component::stage(&stage(&machine(XY)).config).unwrap();
    let rows = rows("## Pins\n\n").len();
    assert_eq!(rows, 0, "the table has moved");
    let table = self::rows("| port | | width | meaning |");
    for port in component.composition().ports() {
        let of_x = match port.name.strip_prefix("y_") {
            Some(pin) => format!("x_{pin}"),
            None => port.name.clone(),
        };
        let direction = match port.direction {
            Direction::Input => "in",
            Direction::Output => "out",
        };
        let row = [of_x.as_str(), direction, &port.width.to_string()];
        assert!(
            table.iter().any(|cells| cells.iter().take(3).eq(row)),
            "docs/stage.md lacks {row:?}"
        );
    }
}
