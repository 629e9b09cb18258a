//! The inline shaper behind registers: what a host sees of it, and that nothing a host does moves or stops an axis.

use posicast_blocks::composition::Composed;
use posicast_blocks::{ClockedBlock, Direction};
use posicast_closed_loop::inline_bench::InlineBench;
use posicast_closed_loop::linked_bench::Registered;
use posicast_machine::hardware::{Hardware, InlineHardware};
use posicast_machine::machine_file::{self, Machine};
use posicast_machine::plan::design_machine;

/// Pins of the drives.
const LINES: [&str; 8] = [
    "x_step",
    "x_direction",
    "y_step",
    "y_direction",
    "z_step",
    "z_direction",
    "drive_enable",
    "fault",
];

fn machine() -> Machine {
    let text = include_str!("../../examples/inline.toml");
    machine_file::parse("inline.toml", &format!("{text}[link]\nbaud = 3_000_000\n")).unwrap()
}

fn inline(machine: &Machine) -> InlineHardware {
    let design = design_machine(machine).unwrap();
    let hardware = Hardware::of(machine, &design).unwrap();
    hardware.inline().unwrap().unwrap().clone()
}

/// The bench of an inline shaper whose registers are known by name.
struct Named {
    hardware: InlineHardware,
    bench: InlineBench,
}

impl Named {
    fn new() -> Self {
        let hardware = inline(&machine());
        let mut bench = InlineBench::new(hardware.component.as_ref().unwrap(), 1).unwrap();
        bench.clocks(20_000).unwrap();
        Self { hardware, bench }
    }

    fn offset(&self, name: &str) -> u32 {
        let map = self.hardware.component.as_ref().unwrap().map();
        map.register(name).unwrap_or_else(|| panic!("{name}")).offset
    }

    fn read(&mut self, name: &str) -> i32 {
        let offset = self.offset(name);
        self.bench.read_at(offset).unwrap() as i32
    }

    fn write(&mut self, name: &str, word: u32) {
        let offset = self.offset(name);
        self.bench.write_at(offset, word).unwrap();
    }

    fn is_bypassed(&mut self) -> bool {
        self.read("status") & 4 != 0
    }

    /// Lets the controller give its steps, and the axes come to rest.
    fn rest(&mut self) {
        while !self.bench.rests() {
            self.bench.clocks(5_000).unwrap();
        }
        self.bench.clocks(5_000).unwrap();
        for _ in 0..600 {
            if self.bench.pin("settled") == 1 {
                return;
            }
            self.bench.clocks(5_000).unwrap();
        }
        panic!("never settled");
    }
}

#[test]
fn a_request_of_a_register_takes_effect_at_rest_and_gives_every_step() {
    let mut inline = Named::new();
    inline.rest();
    inline.bench.steps("x", 300).unwrap();
    inline.bench.clocks(200_000).unwrap();
    inline.write("bypass", 1);
    inline.bench.clocks(200_000).unwrap();
    assert!(!inline.is_bypassed(), "not while it moves");
    assert_eq!(inline.bench.pin("bypassed"), 0);
    inline.rest();
    inline.bench.clocks(20_000).unwrap();
    assert!(inline.is_bypassed());
    assert_eq!((inline.read("x_input_steps"), inline.read("x_given_steps")), (300, 300));

    // A step comes out within two ticks and some clocks.
    inline.bench.steps("x", -20).unwrap();
    inline.bench.clocks(20 * 2_500 + 3 * 5_000).unwrap();
    assert_eq!(inline.read("x_given_steps"), 280);
    // The pin is enough, too.
    inline.bench.set("bypass", 1).unwrap();
    inline.write("bypass", 0);
    inline.rest();
    inline.bench.clocks(20_000).unwrap();
    assert!(inline.is_bypassed());
    inline.bench.set("bypass", 0).unwrap();
    inline.bench.clocks(20_000).unwrap();
    assert!(!inline.is_bypassed());
    assert_eq!((inline.read("x_input_steps"), inline.read("x_given_steps")), (280, 280));
}

#[test]
fn a_snapshot_has_the_counts_of_all_axes_in_one_clock() {
    let mut inline = Named::new();
    inline.bench.steps("x", 400).unwrap();
    inline.bench.steps("y", -400).unwrap();
    inline.bench.clocks(600_000).unwrap();
    inline.write("snapshot", 0);
    inline.bench.clocks(100_000).unwrap();
    let frozen = ["x_snapshot_input_steps", "y_snapshot_input_steps"].map(|name| inline.read(name));
    // Both axes step in the same clocks.
    assert_eq!(frozen[0], -frozen[1]);
    assert!(inline.read("x_input_steps") > frozen[0] && frozen[0] > 0, "{frozen:?}");
    inline.rest();
    inline.write("snapshot", 0);
    for (axis, steps) in [("x", 400), ("y", -400), ("z", 0)] {
        let words = ["input", "given", "owed"].map(|name| inline.read(&format!("{axis}_snapshot_{name}_steps")));
        assert_eq!(words, [steps, steps, 0], "{axis}");
    }
}

/// The example without registers, at the same pins.
struct Without {
    model: Composed,
    inputs: Vec<(String, u64)>,
    outputs: Vec<(String, u64)>,
}

impl Without {
    fn new() -> Self {
        let model = inline(&machine()).shaper.model(1);
        let of = |direction| {
            let ports = model.ports().iter().filter(move |port| port.direction == direction);
            ports.map(|port| (port.name.clone(), 0)).collect::<Vec<_>>()
        };
        let (inputs, outputs) = (of(Direction::Input), of(Direction::Output));
        Self { model, inputs, outputs }
    }

    fn clock(&mut self, pins: impl Fn(&str) -> u64) {
        for (name, level) in &mut self.inputs {
            *level = pins(name);
        }
        let inputs: Vec<u64> = self.inputs.iter().map(|(_, level)| *level).collect();
        let mut outputs = vec![0; self.outputs.len()];
        self.model.step(&inputs, &mut outputs).unwrap();
        for ((_, level), shown) in self.outputs.iter_mut().zip(outputs) {
            *level = shown;
        }
    }

    fn pin(&self, name: &str) -> u64 {
        self.outputs.iter().find(|(output, _)| output == name).unwrap().1
    }
}

/// A host that reads everything, clears flags and enables interrupts, then dies: the lines of the drives are those without registers,
/// clock by clock.
#[test]
fn a_host_that_looks_on_and_dies_changes_no_line_of_a_drive() {
    let mut inline = Named::new();
    let mut without = Without::new();
    let map = inline.hardware.component.as_ref().unwrap().map();
    let offsets: Vec<u32> = map.registers().iter().map(|register| register.offset).collect();
    let writes = ["snapshot", "interrupt_enable", "interrupt_state", "x_flags"].map(|name| inline.offset(name));
    let started = inline.bench.now();
    for _ in 0..started {
        without.clock(|name| u64::from(["enable", "emergency_stop_n"].contains(&name)));
    }
    inline.bench.steps("x", 200).unwrap();
    inline.bench.steps("y", -150).unwrap();
    inline.bench.steps("z", 90).unwrap();
    let mut given = 0;
    let mut before = 0;
    for clock in 0..1_500_000_u32 {
        // The host dies in the middle of the ride.
        let alive = clock < 400_000;
        let at = (clock / 2) as usize;
        let access = match clock % 2 {
            0 if alive && clock % 1_000 == 0 => [u64::from(writes[at / 500 % writes.len()]), 0, 1, 0xf, 0xffff_ffff],
            0 if alive => [offsets[at % offsets.len()].into(), 1, 0, 0xf, 0],
            _ => [0, 0, 0, 0xf, 0],
        };
        inline.bench.access(access).unwrap();
        without.clock(|name| inline.bench.input_level(name));
        for line in LINES {
            assert_eq!(inline.bench.pin(line), without.pin(line), "{line} in clock {clock}");
        }
        given += u32::from(without.pin("x_step") > before);
        before = without.pin("x_step");
    }
    assert_eq!(given, 200);
}
